"""Numbers that were passed as arguments, as arrays."""

from __future__ import annotations

from typing import Any

import numpy as np

from roboticstoolbox._common.errors import WrongShape, WrongType
from ulna.checks.arrays import real_array
from ulna.checks.masked import check_not_masked
from ulna.errors import InputError, excerpt
from ulna.typing import Floats


def numbers(name: str, value: Any) -> Floats:
    """The numbers of an argument, an array of any shape.

    Args:
        name: Name of the argument, for messages.
        value: What was passed.

    Returns:
        Array (...).

    Raises:
        WrongType: It holds something else than real numbers: None, text, complex numbers.
        InputError: Entries are masked.
    """
    if value is None:
        raise WrongType(f"`{name}` is None; expected numbers.")
    if type(value) is not np.ndarray:
        check_not_masked(name, value)
    try:
        return real_array(name, value)
    except InputError:
        raise WrongType(f"`{name}` is {excerpt(repr(value))}; expected numbers.") from None


def number(name: str, value: Any) -> float:
    """One number: a scalar, or an array of one entry.

    Args:
        name: Name of the argument, for messages.
        value: What was passed.

    Returns:
        The number [any].

    Raises:
        WrongType: It holds no numbers.
        WrongShape: It holds another count of them.
    """
    out = value if isinstance(value, (int, float)) else numbers(name, value)
    if not isinstance(out, (int, float)):
        if out.size != 1:
            raise WrongShape(name, out.shape, "one number")
        return float(out.item())
    return float(out)


def vector(name: str, value: Any, size: int) -> Floats:
    """A copy of the numbers of an argument, (size,); a row or a column will do, and a number for an array of one.

    Args:
        name: Name of the argument, for messages.
        value: What was passed.
        size: Number of entries.

    Returns:
        Array (size,).

    Raises:
        WrongType: It holds no numbers.
        WrongShape: It holds another count of them.
    """
    out = np.array(numbers(name, value))
    if out.shape not in ((size,), (1, size), (size, 1)) and (out.ndim or size != 1):
        raise WrongShape(name, out.shape, f"({size},)")
    return out.reshape(size)


def greatest(name: str, value: Any) -> Any:
    """A greatest speed or torque, or several, as it was passed.

    Args:
        name: Name of the argument, for messages.
        value: What was passed; None for no limit.

    Returns:
        What was passed.

    Raises:
        WrongType: It holds no numbers.
        InputError: A number is below 0, or nan.
    """
    if value is not None and not (numbers(name, value) >= 0.0).all():
        raise InputError(f"`{name}` is {excerpt(repr(value))}; expected numbers not below 0, or None.")
    return value
