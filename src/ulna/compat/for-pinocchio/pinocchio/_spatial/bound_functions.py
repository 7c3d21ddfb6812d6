"""Compiled functions of small objects that make a new result at every call, without the cost of a general call."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, final

import numpy as np

from pinocchio._containers.arguments import checked
from pinocchio._containers.arrays import not_applicable
from pinocchio._spatial.random_numbers import STATE, Random
from ulna.compiler import compile as compile_function
from ulna.compiler.runtime.typed_calls import typed_calls
from ulna.typing import Floats

Row = tuple[tuple[type, ...], Callable[[], Any]]
_AS_THEY_ARE = (np.ndarray, float, np.float64, int)
"""Types of arguments that hold no array in a slot."""


@final
class BoundFunctions(dict[str, Any]):
    """Functions of arrays by their names, each compiled and bound when it is first used.

    Args:
        functions: For each name a function that can be traced, and the shapes of its arguments; or one of random
            numbers. A second result, where there is one, is above zero where the first one holds.
        holder: The class that results are instances of, one with a single slot; None for arrays.
        exact: Whether the answer is NotImplemented for arguments that are not exactly arrays of their shapes, which are
            converted otherwise.
    """

    def __init__(
        self, functions: Mapping[str, tuple[Any, ...]], holder: type | None = None, exact: bool = False
    ) -> None:
        super().__init__()
        self._functions, self._holder = functions, holder
        self._otherwise = not_applicable if exact else None
        self._kernels: dict[str, Any] = {}

    def __missing__(self, name: str) -> Any:
        entry = self._functions[name]
        if isinstance(entry, Random):
            return self.setdefault(name, self._random(entry))
        call = _bound(self.kernel(name), otherwise=self._otherwise, holder=self._holder)
        return self.setdefault(name, call)  # another thread may have made it meanwhile

    def kernel(self, name: str) -> Any:
        """The compiled function of that name, not bound."""
        if name not in self._kernels:
            self._kernels[name] = compiled(self._functions, name)
        return self._kernels[name]

    def row(self, name: str, *kinds: type, holder: Any = ...) -> Row:
        """A row of `called_directly`: the function of these types.

        Args:
            name: The name of the function.
            *kinds: The types of the arguments: classes with one slot that holds an array, `np.ndarray`, or numbers.
            holder: The class of results, where it is not the usual one: one with a single slot, float or bool; None
                for arrays.

        Returns:
            The types, and what makes the bound kernel.
        """
        if isinstance(self._functions[name], Random):
            return (), lambda: self[name]
        holders = [None if kind in _AS_THEY_ARE else kind for kind in kinds]
        chosen = self._holder if holder is ... else holder
        return kinds, lambda: _bound(
            self.kernel(name), otherwise=not_applicable, holder=chosen, input_holders=holders
        )

    def _random(self, entry: Random) -> Any:
        kernel = compile_function(entry.of_state, state=STATE.shape)
        result = np.zeros(kernel.function.outputs[0].shape)
        return kernel.into(result, STATE, returns=(0,), trailing_inputs=[STATE], holder=self._holder)


def _bound(kernel: Any, **options: Any) -> Any:
    """A kernel that returns a new result at every call."""
    targets = [np.zeros(output.shape) for output in kernel.function.outputs]
    condition = None if len(targets) == 1 else 1
    return kernel.into(*targets, returns=(0,), condition=condition, **options)


def compiled(functions: Mapping[str, tuple[Any, ...]], name: str) -> Any:
    """Compiles one function of a table.

    Args:
        functions: Functions by name, each with the shapes of its arguments.
        name: The name.

    Returns:
        The kernel.
    """
    function, *sizes = functions[name]
    shapes: dict[str, Any] = {f"x{k}": size for k, size in enumerate(sizes)}
    return compile_function(function, **shapes)


def copies_of(array: Floats, holder: type) -> Row:
    """A row of `called_directly` without arguments: new instances that hold a copy of an array.

    Args:
        array: The array (...).
        holder: The class of the instances, one with a single slot.

    Returns:
        No types, and what makes the bound kernel.
    """

    def make() -> Any:
        kernel = compile_function(lambda x: x * 1.0, x=array.shape)
        return _bound(kernel, otherwise=not_applicable, holder=holder, trailing_inputs=[array])

    return (), make


def directly(*rows: Row) -> Callable[[Any], Any]:
    """Decorates a function of a module; see `called_directly`."""
    return lambda function: called_directly(function, *rows)


def called_directly(function: Any, *rows: Row, is_method: bool = False, in_place: int = 0) -> Any:
    """A function whose calls with arguments of known types run no Python; see `typed_calls`.

    Args:
        function: The function.
        *rows: The types, and what makes the kernel; see `BoundFunctions.row`.
        is_method: Whether it is a method of a class.
        in_place: Of a method that changes its instance, the size of the array that this holds [byte].

    Returns:
        What stands for it, its other arguments checked.
    """
    made = typed_calls(checked(function), dict(rows), is_method, in_place)
    made.arguments_checked = True  # type: ignore[attr-defined]
    return made


def without_gaps(function: Any, *arrays: Any) -> Any:
    """Calls an exact function with copies of arrays that are views with gaps, such as `M.rotation`.

    Args:
        function: One of `BoundFunctions` that are exact.
        *arrays: Its arguments, as a user passed them (...).

    Returns:
        Its result; NotImplemented where an argument is no array of the right shape.
    """
    try:
        return function(*[x if x.flags.c_contiguous else x.copy() for x in arrays])
    except AttributeError:  # of what is no array
        return NotImplemented
