"""Elementary transforms as text, as the Toolbox prints them."""

from __future__ import annotations

import math
from typing import Any

from roboticstoolbox._common.poses import describe
from roboticstoolbox._common.symbols import is_nothing, is_symbol
from roboticstoolbox._ets.joint_descriptor import shown_offset


def transform_text(et: Any, q: str = "q") -> str:
    """A transform as text.

    Args:
        et: The transform.
        q: Name of a joint that has none.

    Returns:
        The text.
    """
    if et._T is not None:
        return describe(et._T)
    if et.isjoint:
        name = q if et._joint_name is None else et._joint_name
        return f"{et.kind}({name}{shown_offset(et.offset, et.isrotation)})"
    if is_symbol(et.param):
        return f"{et.kind}({et.param})"
    if et.isrotation:
        return f"{et.kind}({et.param * (180.0 / math.pi):.4g}°)"
    return f"{et.kind}({et.param:.4g})"


def transform_repr(et: Any) -> str:
    """A transform as a call that makes it."""
    parts = []
    if et.param is not None:
        parts.append(f"param={et.param}")
    if et._T is not None:
        parts.append(f"T={et._T!r}")
    if et.jindex is not None:
        parts.append(f"jindex={et.jindex}")
    if et.isflip:
        parts.append(f"flip={et.isflip}")
    if not is_nothing(et.offset, False):
        parts.append(f"offset={et.offset}")
    if et.qlim is not None:
        parts.append(f"qlim={et.qlim!r}")
    return f"{type(et).__name__}.{et.kind}({', '.join(parts)})"
