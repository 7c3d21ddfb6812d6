"""What every part of `Robot` stands on: a model, and its kernels by name."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, final

import numpy as np

from ulna import kernels
from ulna.compiler.language.scalar import Value
from ulna.errors import TraceError
from ulna.model import Model


@final
class Plain(dict[str, Any]):
    """The checked kernels of a model without options, by name; each is made when it is first asked for.

    A look into a dictionary is all that a call costs beyond the kernel.
    """

    __slots__ = ("model",)

    def __init__(self, model: Model) -> None:
        self.model = model

    def __missing__(self, name: str) -> Any:
        kernel = self[name] = kernels.kernel(self.model, name, checked=True)
        return kernel


class Part(ABC):
    """A group of methods of a robot."""

    __slots__ = ()

    model: Model
    _plain: Plain

    @abstractmethod
    def __init__(self, model: Model) -> None: ...

    @abstractmethod
    def _checked(self, name: str, **options: Any) -> Any:
        """The kernel of that name and options, which checks its inputs."""


def only_numbers(what: str, advice: str, *values: Any) -> None:
    """Refuses traced values in what cannot be compiled.

    Args:
        what: The method, such as "robot.distance".
        advice: What to do instead.
        values: Its arrays.

    Raises:
        TraceError: If one of them holds a traced value.
    """
    for value in values:
        is_object = isinstance(value, np.ndarray) and value.dtype.kind == "O"
        if is_object and any(isinstance(v, Value) for v in value.flat):
            raise TraceError(
                f"{what} takes numbers only, so it cannot be part of a compiled function. {advice}"
            )


def key_of(value: Any) -> Any:
    """An option as a dictionary can keep it."""
    return tuple(value) if isinstance(value, (list, np.ndarray)) else value
