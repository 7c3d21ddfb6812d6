"""Chains of elementary transforms as text: tz(0.333) Rz(q0) Rx(-90 deg) ..., read step by step."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from typing import NamedTuple

from ulna.errors import InputError, excerpt

NAMES = ("rx", "ry", "rz", "tx", "ty", "tz")
"""The elementary transforms: turns about and shifts along an axis."""

_STEP = re.compile(r"[\s*]*([A-Za-z]{2})\s*\(([^()]*)\)[\s*]*")
_MAX_DIGITS = 6  # of a joint's number
_JOINT = re.compile(r"(-?)\s*q_?(\d*)")
_NUMBER = r"(\d+(?:\.\d*)?|\.\d+)"
_PI = re.compile(rf"(-?)\s*(?:{_NUMBER}\s*(?:\*\s*)?)?(?:pi|π)\s*(?:/\s*{_NUMBER})?")
_DEGREES = ("degrees", "degree", "deg", "°")


class Step(NamedTuple):
    """An elementary transform as a text names it."""

    name: str
    """"rx", "ry", "rz", "tx", "ty" or "tz"."""
    value: float | None
    """The constant angle [rad] or distance [m]; None for a joint."""
    index: int | None = None
    """Which joint coordinate it is; None for the next one."""
    flip: bool = False
    """Whether the joint coordinate counts backwards."""


def parse_steps(text: str) -> Iterator[Step]:
    """The steps that a text describes.

    Raises:
        InputError: A step cannot be read; says which.
    """
    position = 0
    if not text.strip():
        raise InputError('The chain is empty; expected steps such as "tz(0.333) Rz(q0) Rx(-90 deg)".')
    while position < len(text):
        step = _STEP.match(text, position)
        if step is None or step.group(1).lower() not in NAMES:
            word = text[position : position + 200].strip()[:20]
            raise InputError(
                f"The chain cannot be read at {word!r} (character {position}); "
                "expected Rx, Ry, Rz, tx, ty or tz with an argument in brackets, such as Rz(q0) or tx(0.3)."
            )
        yield _parse_step(step.group(1).lower(), step.group(2).strip(), step.group(0).strip(" *\t\n"))
        position = step.end()


def _parse_step(name: str, argument: str, step: str) -> Step:
    joint = _JOINT.fullmatch(argument)
    if joint and len(joint.group(2)) > _MAX_DIGITS:
        raise InputError(f"{excerpt(step)}: there is no joint of that number; expected q, q0, q1, ...")
    if joint:
        return Step(name, None, int(joint.group(2)) if joint.group(2) else None, bool(joint.group(1)))
    unit = next((word for word in _DEGREES if argument.endswith(word)), "")
    if unit and name[0] != "r":
        raise InputError(f"{excerpt(step)}: a distance is in metres, not degrees.")
    pi = _PI.fullmatch(argument)
    try:
        if pi:
            sign, factor, divisor = pi.groups()
            value = math.pi * float(factor or 1) / float(divisor or 1) * (-1.0 if sign else 1.0)
        else:
            number = float(argument[: len(argument) - len(unit)])
            value = math.radians(number) if unit else number
    except (ValueError, ZeroDivisionError):
        raise InputError(
            f"{excerpt(step)}: {excerpt(argument)!r} is neither a number (0.5, 90 deg, pi/2) nor a joint (q, q0, -q0)."
        ) from None
    return Step(name, value)
