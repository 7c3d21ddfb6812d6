"""What every group of methods of a robot stands on: a model, and its kernels by name."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ulna.model import Model


class Part:
    """A group of methods of a robot, such as `robot.constraints`; its groups share their kernels.

    Args:
        model: The robot's model.
        kernels: Kernels that check their inputs, by name or (name, option, ...).
        searches: Solvers and checkers, by their options.
    """

    __slots__ = ("_kernels", "_searches", "model")

    model: Model
    """The robot's model."""
    _kernels: Mapping[Any, Any]
    """Kernels that check their inputs, by name or (name, option, ...); each is made when it is first asked for."""
    _searches: dict[Any, Any]
    """Solvers of inverse kinematics and collision checkers, by their options."""

    def __init__(self, model: Model, kernels: Mapping[Any, Any], searches: dict[Any, Any]) -> None:
        self.model, self._kernels, self._searches = model, kernels, searches

    def _kernel(self, name: str, *options: Any) -> Any:
        """The kernel of these options, lists among them too."""
        return self._kernels[(name, *map(frozen, options))]

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.model, self._kernels, {})

    def __repr__(self) -> str:
        names = [name for name in dir(type(self)) if not name.startswith("_") and name != "model"]
        return f"<{type(self).__name__} of {self.model.name!r}: {', '.join(names)}>"


def frozen(value: Any) -> Any:
    """An option as a dictionary can keep it: tuples for lists and arrays."""
    return tuple(value) if isinstance(value, (list, np.ndarray)) else value
