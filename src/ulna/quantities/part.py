"""The base of every group of methods of a robot: a model, and its kernels by name."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

import numpy as np

from ulna.checks.attributes import FixedAttributes
from ulna.model import Model


class KernelTable(Protocol):
    """The kernels of a model that check their inputs."""

    by_name: Any
    """Those of default options: an object with an attribute for each that is made."""

    by_options: dict[str, Any]
    """All of a name, by their options: `by_options[name][first][second]`."""

    make: Callable[..., Any]
    """`make(name, *options)` returns a kernel, and enters it in both tables."""


class Part(FixedAttributes):
    """A group of methods of a robot, such as `robot.constraints`; its groups share their kernels.

    Args:
        model: The robot's model.
        kernels: Kernels that check their inputs.
        searches: Solvers and checkers, by their options.
    """

    __slots__ = ("_by_options", "_kernel_table", "_kernels", "_searches", "model")

    model: Model
    """The robot's model."""
    _kernel_table: KernelTable
    """Makes kernels that check their inputs."""
    _kernels: Any
    """Those of default options that are made, as attributes."""
    _by_options: dict[str, Any]
    """All that are made: one dictionary for each option takes half as long as one of tuples."""
    _searches: dict[Any, Any]
    """Solvers of inverse kinematics and collision checkers, by their options."""

    def __init__(self, model: Model, kernels: KernelTable, searches: dict[Any, Any]) -> None:
        self.model, self._searches = model, searches
        self._kernel_table, self._kernels, self._by_options = kernels, kernels.by_name, kernels.by_options

    def _kernel(self, name: str, *options: Any) -> Any:
        """The kernel of all options, lists among them too, or of default ones."""
        try:
            kernel = self._by_options[name] if options else getattr(self._kernels, name)
            for value in options:
                kernel = kernel[value]
            return kernel
        except (AttributeError, KeyError, TypeError):
            pass  # an error of `make` is not raised from this one
        from ulna.quantities.direct_calls import call_directly  # imports threads

        made = self._kernel_table.make(name, *map(frozen, options))
        call_directly(type(self), name, type(self._kernels))
        return made

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.model, self._kernel_table, {})

    def __repr__(self) -> str:
        names = [name for name in dir(type(self)) if not name.startswith("_") and name != "model"]
        return f"<{type(self).__name__} of {self.model.name!r}: {', '.join(names)}>"


def frozen(value: Any) -> Any:
    """An option as a dictionary can keep it: tuples for lists and arrays."""
    is_array = isinstance(value, np.ndarray) and value.ndim > 0
    return tuple(value) if is_array or isinstance(value, list) else value
