"""How large a function may be before it is refused instead of compiled for minutes."""

from __future__ import annotations

import os
from typing import NoReturn

from ulna.errors import InputError, TooLargeError

_MAX_NODES = 3_000_000


def most_operations() -> float:
    """How many operations a function may have: 3 million, or what the environment variable ULNA_MOST_OPERATIONS says.

    Raises:
        InputError: it is no whole number.
    """
    setting = os.environ.get("ULNA_MOST_OPERATIONS", "").strip()
    if not setting:
        return _MAX_NODES
    if not setting.isdecimal():
        raise InputError(
            f"ULNA_MOST_OPERATIONS is {setting!r}; expected a whole number such as {_MAX_NODES}, or 0 for no limit."
        )
    return int(setting) or float("inf")


def raise_too_large(what: str, seconds: float = 0.0, memory: float = 0.0) -> NoReturn:
    """Says that a function is too large, and what can be done.

    Args:
        what: What is too large, and how large it is.
        seconds: How long it would take to compile [s]; 0 where that is not known.
        memory: How much memory that would need [byte].

    Raises:
        TooLargeError: Always.
    """
    cost = f", which take about {seconds:.0f} s and {memory / 1e9:.1f} GB to compile" if seconds else ""
    raise TooLargeError(
        f"{what}{cost}; the limit is {most_operations():,}. Set the environment variable ULNA_MOST_OPERATIONS to a "
        "greater number (0 for no limit) to compile it anyway. Matrices and derivatives grow with the square or "
        "the cube of the number of joints, inverse_dynamics and forward_dynamics with the number itself; "
        "robot.lock(...) takes joints out."
    )
