"""The operations on numbers and lanes: what they take and return, and what NumPy makes of them.

One row an operation. `kind` says which elements it takes and what it returns:

| kind | arguments | result |
|---|---|---|
| `arithmetic` | two numbers or lanes of the same elements, int or real | the same |
| `integer` | two of int | int |
| `bits` | two of int or of bool | the same |
| `real` | real numbers or lanes | the same |
| `comparison` | two of the same elements | bool |
| `reduction` | lanes | one number of their element |
| `mask_reduction` | a mask | bool or int, as the name says |
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from ulna.compiler.language import ops
from ulna.data_classes import dataclass


@dataclass(frozen=True)
class Row:
    """An operation: how many arguments, of what kind, and its value by NumPy."""

    arity: int
    kind: str
    numpy: Callable[..., Any]


_MASK = 2**64 - 1


def wrapped(value: int) -> np.int64:
    """An integer modulo 2^64, as two's complement."""
    value &= _MASK
    return np.int64(value - 2**64 if value >= 2**63 else value)


def minimum(a: Any, b: Any) -> Any:
    """b where it is smaller, else a; so nan in a stays, and nan in b does not count.

    Args:
        a: Numbers.
        b: Numbers.

    Returns:
        Numbers, of the shape () or (lanes,).
    """
    return np.where(b < a, b, a)


def maximum(a: Any, b: Any) -> Any:
    """b where it is larger, else a; so nan in a stays, and nan in b does not count.

    Args:
        a: Numbers.
        b: Numbers.

    Returns:
        Numbers, of the shape () or (lanes,).
    """
    return np.where(b > a, b, a)


def by_halves(combine: Callable[[Any, Any], Any]) -> Callable[[Any], Any]:
    """A reduction of lanes: the lower half meets the upper one until one number is left."""

    def reduction(x: Any) -> Any:
        while len(x) > 1:
            x = combine(x[: len(x) // 2], x[len(x) // 2 :])
        return x[0]

    return reduction


def _first(mask: Any) -> np.int64:
    return np.int64(np.argmax(mask) if mask.any() else len(mask))


_ELEMENTARY: dict[str, Any] = {row.c: row for row in ops.TABLE if row.c and not row.llvm}
"""The elementary functions, by their names in C and in the module `math`: those of the language."""

TABLE: dict[str, Row] = {
    "add": Row(2, "arithmetic", np.add),
    "sub": Row(2, "arithmetic", np.subtract),
    "mul": Row(2, "arithmetic", np.multiply),
    "minimum": Row(2, "arithmetic", minimum),
    "maximum": Row(2, "arithmetic", maximum),
    "neg": Row(1, "arithmetic", np.negative),
    "abs": Row(1, "arithmetic", np.abs),
    "floordiv": Row(2, "integer", lambda a, b: wrapped(int(a) // int(b))),
    "mod": Row(2, "integer", lambda a, b: wrapped(int(a) % int(b))),
    "shl": Row(2, "integer", lambda a, b: np.left_shift(a, np.bitwise_and(b, 63))),
    "shr": Row(2, "integer", lambda a, b: np.right_shift(a, np.bitwise_and(b, 63))),
    "and": Row(2, "bits", np.bitwise_and),
    "or": Row(2, "bits", np.bitwise_or),
    "xor": Row(2, "bits", np.bitwise_xor),
    "not": Row(1, "bits", np.invert),
    "div": Row(2, "real", np.divide),
    "sqrt": Row(1, "real", np.sqrt),
    "floor": Row(1, "real", np.floor),
    "ceil": Row(1, "real", np.ceil),
    **{name: Row(row.arity, "real", row.numpy) for name, row in _ELEMENTARY.items()},
    "lt": Row(2, "comparison", np.less),
    "le": Row(2, "comparison", np.less_equal),
    "gt": Row(2, "comparison", np.greater),
    "ge": Row(2, "comparison", np.greater_equal),
    "eq": Row(2, "comparison", np.equal),
    "ne": Row(2, "comparison", np.not_equal),
    "where": Row(3, "selection", np.where),
    "sum_of": Row(1, "reduction", by_halves(np.add)),
    "least_of": Row(1, "reduction", by_halves(minimum)),
    "greatest_of": Row(1, "reduction", by_halves(maximum)),
    "any_of": Row(1, "mask_reduction", np.any),
    "all_of": Row(1, "mask_reduction", np.all),
    "count_of": Row(1, "mask_reduction", lambda mask: np.int64(np.count_nonzero(mask))),
    "first_of": Row(1, "mask_reduction", _first),
}


def _numpy_only(name: str) -> Callable[..., Any]:
    """A function of the language, as Python calls it outside of a procedure."""

    def function(*arguments: Any) -> Any:
        return TABLE[name].numpy(*arguments)

    function.__name__ = function.__qualname__ = name
    return function


any_of, all_of, count_of, first_of = map(_numpy_only, ("any_of", "all_of", "count_of", "first_of"))
sum_of, least_of, greatest_of = map(_numpy_only, ("sum_of", "least_of", "greatest_of"))


def lane_numbers(count: int, element: type = np.int64) -> Any:
    """The lanes 0, 1, 2, ...

    Args:
        count: How many lanes, a constant.
        element: `int`, `f32` or `f64`.

    Returns:
        Lanes, outside of a procedure an array, shape (count,).
    """
    return np.arange(count, dtype=element)


def broadcast(value: Any, count: int) -> Any:
    """A number in every lane.

    Args:
        value: The number.
        count: How many lanes, a constant.

    Returns:
        Lanes, outside of a procedure an array, shape (count,).
    """
    return np.full(count, value)


FUNCTIONS: dict[Any, str] = {
    abs: "abs", min: "minimum", max: "maximum", np.minimum: "minimum", np.maximum: "maximum", np.abs: "abs",
    math.sqrt: "sqrt", np.sqrt: "sqrt", math.floor: "floor_int", np.floor: "floor", np.ceil: "ceil",
    np.where: "where",
    any_of: "any_of", all_of: "all_of", count_of: "count_of", first_of: "first_of", sum_of: "sum_of",
    least_of: "least_of", greatest_of: "greatest_of",
    **{row.numpy: name for name, row in _ELEMENTARY.items()},
    **{getattr(math, name): name for name in _ELEMENTARY},
}  # fmt: skip
"""The Python functions that procedures may call, and the operations they are."""
