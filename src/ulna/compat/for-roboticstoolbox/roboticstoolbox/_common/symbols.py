"""Numbers or SymPy expressions: telling them apart, simplifying them, and printing them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np


def is_symbol(value: Any) -> bool:
    """Whether it is a SymPy expression."""
    return hasattr(value, "free_symbols")


def has_symbols(values: Any) -> bool:
    """Whether an array, or a sequence, holds SymPy expressions."""
    entries = np.asarray(values, dtype=object) if not isinstance(values, np.ndarray) else values
    return entries.dtype == object and any(is_symbol(x) for x in entries.ravel())


def exact_entries(values: Any) -> Any:
    """An array beside symbols: whole numbers as integers, below 1e-15 as zero, so that products of it stay short.

    Args:
        values: Array of numbers or expressions.

    Returns:
        Array of objects of the same shape.
    """
    out = np.array(values, dtype=object)
    for place, x in np.ndenumerate(out):
        if not is_symbol(x):
            out[place] = 0 if abs(x) < 1e-15 else int(x) if float(x).is_integer() else x
    return out


def with_symbols(text: str, value: Any) -> str:
    """A number in a format, a symbol as it prints.

    Args:
        text: A format such as ".3g".
        value: A number or an expression [any].

    Returns:
        The text.
    """
    return str(value) if is_symbol(value) else format(value, text)


def is_nothing(value: Any, rotation: bool) -> bool:
    """Whether a transform is the identity: its value is exactly zero, or a symbolic angle of whole turns.

    Args:
        value: A number or an expression [rad or m].
        rotation: Whether it turns.

    Returns:
        Whether it is.
    """
    if not is_symbol(value):
        return bool(value == 0)
    import sympy

    short = sympy.simplify(value)
    return bool(short == 0 or (rotation and sympy.simplify(short / (2 * sympy.pi)).is_integer))


def quarter_turns(angle: Any) -> int | None:
    """How many quarter turns an angle is, 0 to 3; None when it is no known whole number of them."""
    if is_symbol(angle):
        import sympy

        count = sympy.simplify(2 * angle / sympy.pi)
        return int(count) % 4 if count.is_integer and count.is_number else None
    if not math.isfinite(angle):
        return None
    turns = angle / (math.pi / 2)
    quarters = round(turns)
    return quarters % 4 if abs(turns - quarters) * math.pi / 2 < 1e-9 else None


def shortened(values: Any) -> Any:
    """An array with its symbolic entries simplified, of numbers where none is left."""
    if values.dtype != object:
        return values
    if not has_symbols(values):
        return values.astype(float)
    import sympy

    out = np.array([sympy.simplify(x) for x in values.ravel()], dtype=object)
    return out.reshape(values.shape)
