"""Jacobians as NumPy arrays whose pseudoinverse is computed by a kernel.

Scripts write `np.linalg.pinv(J) @ v`. NumPy lets a class of arrays say what its functions mean for them (NEP 18), so
`pinv` and `inv` of a Jacobian take 1 us instead of 25. Of those whose condition is not far from losing the rank, and in
everything else, NumPy has its way.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from ulna.compiler import compile
from ulna.linalg import pseudoinverse

_MAX_CONDITION = 1e8  # the greatest condition number at which the kernel is as accurate as NumPy
_MAX_COLUMNS = 12  # compiling larger matrices takes too long


class Jacobian(np.ndarray):
    """An array like any other in what it shows, does and is pickled as."""

    __array_priority__ = -1.0  # type: ignore[assignment]  # plain arrays come first

    def __array_function__(self, func: Any, types: Any, args: Any, kwargs: Any) -> Any:
        """The meaning of a function of NumPy's."""
        if (func is np.linalg.pinv or func is np.linalg.inv) and len(args) == 1 and not kwargs:
            return _inverse(func, np.ascontiguousarray(args[0]))
        return super().__array_function__(func, types, args, kwargs)

    def __array_wrap__(self, array: Any, context: Any = None, return_scalar: bool = False) -> Any:
        """What is computed with it: plain arrays and numbers."""
        return array[()] if return_scalar else array

    def __reduce_ex__(self, protocol: Any) -> Any:
        """What is pickled: a plain array, which loads without this package."""
        return self.view(np.ndarray).__reduce_ex__(protocol)


Jacobian.__name__ = "array"  # the name that NumPy prints


def _inverse(func: Any, J: np.ndarray) -> Any:
    shape = J.shape
    is_matrix = (
        J.dtype == np.float64 and len(shape) == 2 and 0 < min(shape) <= 6 and max(shape) <= _MAX_COLUMNS
    )
    if is_matrix and (shape[0] == shape[1] or func is np.linalg.pinv):
        inverse, condition = _kernel(shape)(J)
        if condition < _MAX_CONDITION:
            return inverse
    return func(J)


@cache
def _kernel(shape: tuple[int, int]) -> Any:
    return compile(pseudoinverse, a=shape)
