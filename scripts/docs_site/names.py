"""Names in texts that the reference describes: where a link from them leads."""

from __future__ import annotations

import re
from functools import cache

import ulna

_NAME = re.compile(r"(ulna|robot)\.(\w+(?:\.\w+)*)(?:\([^<>`\\]*\))?")


@cache
def groups() -> dict[str, type]:
    """The groups of a robot's methods: names and classes."""
    from ulna.quantities.part import Part

    robot = ulna.load("panda", visuals="simple")
    parts = {name: getattr(robot, name) for name in dir(robot) if not name.startswith("_")}
    return {name: type(part) for name, part in parts.items() if isinstance(part, Part)}


def target(code: str) -> str | None:
    """The full name of what a piece of code names, as the reference lists it.

    Args:
        code: Such as "ulna.load", "robot.fk(q)" or "robot.centroidal.momentum".

    Returns:
        Such as "ulna.Robot.fk"; None where the code is no single name.
    """
    found = _NAME.fullmatch(code)
    if found is None:
        return None
    first, _, rest = found[2].partition(".")
    if found[1] == "ulna":
        return f"ulna.{found[2]}"
    if first in groups():
        home = f"{groups()[first].__module__}.{groups()[first].__qualname__}"
        return f"{home}.{rest}" if rest else home
    return f"ulna.Robot.{first}" if not rest else None
