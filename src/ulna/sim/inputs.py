"""Checks of what users pass to simulations and viewers: numbers, flags, words, choices, functions, robots."""

from __future__ import annotations

import math
import reprlib
from collections.abc import Iterable
from typing import Any

import numpy as np

from ulna.errors import InputError, NonFiniteError, ShapeError, UnknownName
from ulna.typing import Floats

FARTHEST = 1e15
"""The longest length [m]: a screen counts in numbers of 32 bits, whose squares end soon after."""

_SHORT = reprlib.Repr()
_SHORT.maxother = _SHORT.maxstring = _SHORT.maxlong = 80


def finite(name: str, value: Any, expected: str = "numbers") -> Floats:
    """A copy of finite numbers, in whatever shape.

    Raises:
        InputError, NonFiniteError: They are not, or rows differ in length.
    """
    try:
        given = np.asarray(value)
        if given.dtype.kind not in "fiu" and given.size:
            given = np.array([_real(x) for x in np.asarray(value, dtype=object).flat]).reshape(given.shape)
        out = np.array(given, dtype=float)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"`{name}` is {told(value)}; expected {expected}.") from None
    if not math.isfinite(np.vdot(out, out)) and not np.isfinite(out).all():  # a quick look first
        where = tuple(int(i) for i in np.argwhere(~np.isfinite(out))[0])
        raise NonFiniteError(name, where, float(out[where]), "Look where it comes from.")
    return out


def numbers(name: str, value: Any, *shape: int | None, mend: str = "") -> Floats:
    """As `finite`, of a shape, None for any length.

    Raises:
        InputError, ShapeError, NonFiniteError: They are not.
    """
    out = finite(name, value)
    if out.shape != shape and (
        len(shape) != out.ndim or any(n not in (None, m) for n, m in zip(shape, out.shape, strict=True))
    ):
        wanted = str(tuple("n" if n is None else n for n in shape)).replace("'", "")
        raise ShapeError(name, out.shape, wanted if shape else "one number", mend)
    return out


def lengths(name: str, value: Any, *shape: int | None, mend: str = "") -> Floats:
    """As `numbers`, for lengths [m] that a screen can show.

    Raises:
        InputError, ShapeError, NonFiniteError: They are not.
    """
    out = numbers(name, value, *shape, mend=mend)
    if out.size and max(out.max(), -out.min()) > FARTHEST:
        raise InputError(
            f"`{name}` reaches as far as {np.abs(out).max():g} m; expected at most {FARTHEST:g} m."
        )
    return out


def factors(name: str, value: Any, *count: int) -> Floats:
    """Factors above zero along each axis, shape (*count, 3), from these, (3,), or one number.

    Raises:
        InputError, ShapeError, NonFiniteError: They are not.
    """
    out = finite(name, value, "a factor, or one along each axis")
    if out.shape not in ((), (3,), (*count, 3)):
        raise ShapeError(name, out.shape, f"{(*count, 3)}, (3,), or one number")
    if out.size and not (out.min() > 0.0 and out.max() <= FARTHEST):
        raise InputError(f"`{name}` is {told(value)}; expected factors above zero, at most {FARTHEST:g}.")
    return np.array(np.broadcast_to(out, (*count, 3)))


def number(
    name: str,
    value: Any,
    expected: str = "a finite number",
    above: float = -math.inf,
    least: float = -math.inf,
    most: float = math.inf,
) -> float:
    """A finite number above `above`, from `least` to `most`.

    Raises:
        InputError: It is none; it was `expected`.
    """
    try:
        out = value if type(value) is float else _real(value)  # the usual kind costs nothing
    except (TypeError, ValueError, OverflowError):
        out = math.nan
    if not (math.isfinite(out) and above < out and least <= out <= most):
        raise InputError(f"`{name}` is {told(value)}; expected {expected}.")
    return out


def length(name: str, value: Any) -> float:
    """A length above zero [m]."""
    return number(name, value, "a length above zero [m]", above=0.0, most=FARTHEST)


def duration(name: str, value: Any) -> float:
    """A time above zero [s]."""
    return number(name, value, "a time above zero [s]", above=0.0)


def steps(span: Any, dt: Any, most: int) -> tuple[float, int]:
    """A span of time [s], and how many steps of about `dt` [s] it has.

    Raises:
        InputError: They are not above zero, or the steps are more than `most`.
    """
    whole, each = duration("duration", span), duration("dt", dt)
    if not whole / each <= most:
        raise InputError(
            f"`duration` is {whole:g} s and `dt` {each:g} s, {whole / each:.3g} steps; expected at most {most:.0e}."
        )
    return whole, max(1, round(whole / each))


def share(name: str, value: Any) -> float:
    """A number from 0 to 1."""
    return number(name, value, "a number from 0 to 1", least=0.0, most=1.0)


def count(name: str, value: Any, least: int = 1, most: int | None = None) -> int:
    """A whole number from `least` on, up to `most`."""
    whole = isinstance(value, int | np.integer) and not isinstance(value, bool)
    if not whole or value < least or (most is not None and value > most):
        span = f"{least} or more" if most is None else f"from {least} to {most}"
        raise InputError(f"`{name}` is {told(value)}; expected a whole number, {span}.")
    return int(value)


def flag(name: str, value: Any) -> bool:
    """True or False; 1 and 0 serve, too."""
    if not (isinstance(value, bool | int | np.bool_ | np.integer) and value in (0, 1)):
        raise InputError(f"`{name}` is {told(value)}; expected True or False.")
    return bool(value)


def words(name: str, value: Any) -> str:
    """Words; a number is written out."""
    if not isinstance(value, str | int | float | np.number) or isinstance(value, bool):
        raise InputError(f"`{name}` is {told(value)}; expected words (a str).")
    return str(value)


def function(name: str, value: Any) -> Any:
    """Something to call."""
    if not callable(value):
        raise InputError(f"`{name}` is {told(value)}; expected a function.")
    return value


def one_of(kind: str, value: Any, choices: Iterable[str]) -> Any:
    """One of some names.

    Raises:
        UnknownName: It is none of them; the nearest is offered.
    """
    names = tuple(choices)
    if not (isinstance(value, str) and value in names):
        raise UnknownName(kind, value if isinstance(value, str) else told(value), names)
    return value


def checked_robot(robot: Any) -> Any:
    """`robot`, when it is one.

    Raises:
        InputError: It is none.
    """
    if not hasattr(robot, "link_poses"):
        raise InputError(f"`robot` is {told(robot)}; expected a Robot, such as ulna.load(...) gives.")
    return robot


def _real(value: Any) -> float:
    """A number, of whatever kind: not one that is written, nor True or False."""
    if isinstance(value, bool | np.bool_ | str | bytes):
        raise TypeError
    return float(value)


def told(value: Any) -> str:
    """A value as messages tell of it: not longer than a line."""
    return _SHORT.repr(value)
