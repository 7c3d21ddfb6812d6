"""Checks of single arguments: numbers, flags, texts, choices, functions, robots."""

from __future__ import annotations

import math
import reprlib
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from ulna.errors import InputError, UnknownName

MAX_LENGTH = 1e15
"""The longest length [m]: a screen counts in numbers of 32 bits, whose squares end soon after."""

_SHORT = reprlib.Repr()
_SHORT.maxother = _SHORT.maxstring = _SHORT.maxlong = 80


def number(
    name: str,
    value: Any,
    expected: str = "a finite number",
    above: float = -math.inf,
    least: float = -math.inf,
    most: float = math.inf,
) -> float:
    """A finite number within bounds.

    Args:
        name: The name of the argument, for the message.
        value: What was passed.
        expected: What was expected, for the message.
        above: What it must exceed.
        least: What it must not be below.
        most: What it must not exceed.

    Returns:
        The number.

    Raises:
        InputError: it is no such number.
    """
    try:
        out = value if type(value) is float else real_number(value)  # the usual kind costs nothing
    except (TypeError, ValueError, OverflowError):
        out = math.nan
    if not (math.isfinite(out) and above < out and least <= out <= most):
        raise InputError(f"`{name}` is {short_repr(value)}; expected {expected}.")
    return out


def length(name: str, value: Any) -> float:
    """A length above zero, at most `MAX_LENGTH`.

    Args:
        name: The name of the argument, for the message.
        value: What was passed.

    Returns:
        The length [m].

    Raises:
        InputError: it is no such length.
    """
    return number(name, value, "a length above zero [m]", above=0.0, most=MAX_LENGTH)


def duration(name: str, value: Any) -> float:
    """A time above zero.

    Args:
        name: The name of the argument, for the message.
        value: What was passed.

    Returns:
        The time [s].

    Raises:
        InputError: it is no such time.
    """
    return number(name, value, "a time above zero [s]", above=0.0)


def step_count(span: Any, dt: Any, most: int) -> tuple[float, int]:
    """A span of time, and how many steps it has.

    Args:
        span: The time [s].
        dt: The step [s].
        most: The largest number of steps.

    Returns:
        The time [s], and the number of steps of about `dt`, at least 1.

    Raises:
        InputError: the times are not above zero, or the steps are more than `most`.
    """
    total, step = duration("duration", span), duration("dt", dt)
    if not total / step <= most:
        raise InputError(
            f"`duration` is {total:g} s and `dt` {step:g} s, {total / step:.3g} steps; expected at most {most:.0e}."
        )
    return total, max(1, round(total / step))


def fraction(name: str, value: Any) -> float:
    """A number from 0 to 1.

    Args:
        name: The name of the argument, for the message.
        value: What was passed.

    Returns:
        The number [-].

    Raises:
        InputError: it is no such number.
    """
    return number(name, value, "a number from 0 to 1", least=0.0, most=1.0)


def count(name: str, value: Any, least: int = 1, most: int | None = None) -> int:
    """A whole number within bounds.

    Args:
        name: The name of the argument, for the message.
        value: What was passed.
        least: The least.
        most: The largest; None for no bound.

    Returns:
        The number.

    Raises:
        InputError: it is no such number.
    """
    whole = isinstance(value, int | np.integer) and not isinstance(value, bool)
    if not whole or value < least or (most is not None and value > most):
        span = f"{least} or more" if most is None else f"from {least} to {most}"
        raise InputError(f"`{name}` is {short_repr(value)}; expected a whole number, {span}.")
    return int(value)


def flag(name: str, value: Any) -> bool:
    """A truth value; 1 and 0 are accepted, too.

    Args:
        name: The name of the argument, for the message.
        value: What was passed.

    Returns:
        True or False.

    Raises:
        InputError: it is something else.
    """
    if not (isinstance(value, bool | int | np.bool_ | np.integer) and value in (0, 1)):
        raise InputError(f"`{name}` is {short_repr(value)}; expected True or False.")
    return bool(value)


def text(name: str, value: Any) -> str:
    """A text; a number is converted.

    Args:
        name: The name of the argument, for the message.
        value: What was passed.

    Returns:
        The text.

    Raises:
        InputError: it is something else.
    """
    if not isinstance(value, str | int | float | np.number) or isinstance(value, bool):
        raise InputError(f"`{name}` is {short_repr(value)}; expected words (a str).")
    return str(value)


def function(name: str, value: Any) -> Any:
    """Something that can be called.

    Args:
        name: The name of the argument, for the message.
        value: What was passed.

    Returns:
        The same.

    Raises:
        InputError: it cannot be called.
    """
    if not callable(value):
        raise InputError(f"`{name}` is {short_repr(value)}; expected a function.")
    return value


def one_of(kind: str, value: Any, choices: Iterable[str]) -> Any:
    """One of some names.

    Args:
        kind: What it names, for the message.
        value: What was passed.
        choices: The valid names.

    Returns:
        The name.

    Raises:
        UnknownName: it is none of them; the nearest is offered.
    """
    names = tuple(choices)
    if not (isinstance(value, str) and value in names):
        raise UnknownName(kind, value if isinstance(value, str) else short_repr(value), names)
    return value


def names(name: str, value: Any) -> tuple[str, ...]:
    """Several names.

    Args:
        name: The name of the argument, for the message.
        value: What was passed.

    Returns:
        The names.

    Raises:
        InputError: it is a single name, or something among it is none.
    """
    try:
        out = () if isinstance(value, str | bytes) else tuple(value)
        is_list = not isinstance(value, str | bytes | Mapping) and all(
            isinstance(one, str | int) for one in out
        )  # numbers are refused with advice
    except TypeError:
        out, is_list = (), False
    if not is_list:
        single = f", such as [{value!r}]" if isinstance(value, str) else ""
        raise InputError(f"`{name}` is {short_repr(value)}; expected names in a list{single}.")
    return out


def generator(name: str, value: Any) -> np.random.Generator:
    """A generator of random numbers.

    Args:
        name: The name of the argument, for the message.
        value: A seed, a generator, or None for other numbers each time.

    Returns:
        The generator.

    Raises:
        InputError: it is none of these.
    """
    try:
        return np.random.default_rng(value)
    except (TypeError, ValueError):
        raise InputError(
            f"`{name}` is {short_repr(value)}; expected a whole number of zero or more, a generator of NumPy, or None."
        ) from None


def checked_robot(robot: Any) -> Any:
    """`robot`, when it is one.

    Raises:
        InputError: It is none.
    """
    if not hasattr(robot, "link_poses"):
        raise InputError(f"`robot` is {short_repr(robot)}; expected a Robot, such as ulna.load(...) returns.")
    return robot


def real_number(value: Any) -> float:
    """A number, of whatever kind: not one that is written, nor True or False."""
    if isinstance(value, bool | np.bool_ | str | bytes):
        raise TypeError
    return float(value)


def short_repr(value: Any) -> str:
    """A value as text in messages, not longer than a line."""
    return _SHORT.repr(value)
