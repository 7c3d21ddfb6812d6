"""Compiled functions of small objects that make a new result at every call, without the cost of a general call."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, final

import numpy as np

from pinocchio._containers.arrays import not_applicable
from pinocchio._spatial.random_numbers import STATE, Random
from ulna.compiler import compile as compile_function


@final
class BoundFunctions(dict[str, Any]):
    """Functions of arrays by their names, each compiled and bound when it is first used.

    Args:
        functions: For each name a function that can be traced, and the shapes of its arguments; or one of random
            numbers.
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

    def __missing__(self, name: str) -> Any:
        entry = self._functions[name]
        if isinstance(entry, Random):
            return self.setdefault(name, self._random(entry))
        function, *sizes = entry
        shapes: dict[str, Any] = {f"x{k}": size for k, size in enumerate(sizes)}
        kernel = compile_function(function, **shapes)
        result = np.zeros(kernel.function.outputs[0].shape)
        call = kernel.into(result, returns=(0,), otherwise=self._otherwise, holder=self._holder)
        return self.setdefault(name, call)  # another thread may have made it meanwhile

    def _random(self, entry: Random) -> Any:
        kernel = compile_function(entry.of_state, state=STATE.shape)
        result = np.zeros(kernel.function.outputs[0].shape)
        return kernel.into(result, STATE, returns=(0,), trailing_inputs=[STATE], holder=self._holder)


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
