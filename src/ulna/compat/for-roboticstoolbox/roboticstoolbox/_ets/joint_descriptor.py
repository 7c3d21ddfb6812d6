"""Arguments of transforms: names of joints such as "q1", "-theta2", "A1_", offsets, and the former name `eta`."""

from __future__ import annotations

import math
import re
import warnings
from typing import Any

from roboticstoolbox._common.symbols import is_symbol
from ulna.errors import InputError

_MINUS = ("-", "\u2212")


def parse_joint(text: str) -> tuple[int | None, bool]:
    """The number and the direction that the name of a joint says: its first digits, and a leading minus.

    Args:
        text: The name. With an underscore at its end it counts from one, else from zero.

    Returns:
        The number of the joint, None without digits; and whether the joint is flipped.

    Raises:
        InputError: The name counts from one and its number is zero.
    """
    match = re.search(r"\d+", text)
    if match is None:
        return None, text[:1] in _MINUS
    number = int(match.group())
    if text.endswith("_"):
        if number == 0:
            raise InputError(
                f"The joint name {text!r} ends with '_', so it counts from 1; expected 1 or more."
            )
        number -= 1
    return number, text[:1] in _MINUS


def shown_name(text: str) -> str:
    """The name of a joint as it is printed: without the underscore that only says where counting begins."""
    return text[:-1] if text.endswith("_") and re.search(r"\d", text) else text


def shown_offset(offset: Any, rotation: bool) -> str:
    """The offset of a joint as it is printed after its name: " + 30°", " - a", or nothing.

    Args:
        offset: The offset [rad or m], a number or a symbol.
        rotation: Whether the joint turns, so that it is printed in degrees.

    Returns:
        The text.
    """
    if is_symbol(offset):
        text = str(offset)
        return f" - {text[1:]}" if text.startswith("-") else f" + {text}"
    if offset == 0:
        return ""
    value = math.degrees(offset) if rotation else offset
    return f" {'+' if value >= 0 else '-'} {abs(value):.4g}{'°' if rotation else ''}"


def current_name(param: Any, eta: Any) -> Any:
    """The constant, by its name `param` or by its former name `eta`.

    Args:
        param: The value of `param`.
        eta: The value of `eta`; None where it was not passed.

    Returns:
        The one that was passed.
    """
    if eta is None:
        return param
    warnings.warn("`eta` is the former name of the argument `param`", DeprecationWarning, stacklevel=3)
    return eta
