"""Writes docs/quantities.md, the page of a robot's methods, from the declarations of quantities.

Run: python scripts/quantities_page.py [--check | --write]

`--check` exits with 1 where the page differs from what would be written.
"""

from __future__ import annotations

import inspect
import sys
from pathlib import Path
from typing import Any

import ulna
from ulna.methods.former_names import FormerNames
from ulna.quantities.documentation import cited
from ulna.quantities.part import Part

PAGE = Path(__file__).parents[1] / "docs" / "quantities.md"
HEAD = """# What a robot can be asked

What is used daily is a method of the robot; the rest is in groups. `help(robot.fk)` has arguments, shapes, units,
errors, the source, and for the most used methods an example. Each quantity has a kernel, `robot.kernel(name)`. Shapes
are those of one configuration; batch axes come before them.

This page is made from the declarations in `src/ulna/quantities`, by `python scripts/quantities_page.py --write`.
"""
FORMER = """
## Former names

They are not listed by `dir(robot)` any more, and stay: each is the very function of its group.

| former name | now |
|---|---|
"""


def sentence(member: Any) -> str:
    """The first paragraph of a docstring, without the source in brackets."""
    text = inspect.getdoc(inspect.unwrap(member)) or ""
    return cited(" ".join(text.split("\n\n")[0].split()))[0].replace("|", "\\|")


def row(name: str, member: Any) -> str:
    """The row of a method or property: call, what it is, shape and unit of the result, kernel."""
    quantity = getattr(member, "quantity", None)
    call = (
        f"{name}({', '.join(list(inspect.signature(member).parameters)[1:])})" if callable(member) else name
    )
    result, kernel = (quantity.result, f"`{quantity.name}`") if quantity else ("", "")
    return f"| `{call}` | {sentence(member)} | {result} | {kernel} |"


def table(kind: type) -> str:
    """The rows of a class, in the order of its bases and of what is written there."""
    rows = [
        row(name, member)
        for cls in kind.__mro__
        if cls not in (object, Part, FormerNames)
        for name, member in vars(cls).items()
        if not name.startswith("_") and (inspect.isfunction(member) or isinstance(member, property))
    ]
    return "\n".join(["| method | what it is | result | kernel |", "|---|---|---|---|", *rows, ""])


def page() -> str:
    """The whole page."""
    robot = ulna.load("panda", visuals="simple")
    parts = {name: getattr(robot, name) for name in dir(robot) if not name.startswith("_")}
    groups = {name: type(part) for name, part in parts.items() if isinstance(part, Part)}
    text = HEAD + "\n## The robot\n\n" + table(ulna.Robot)
    for name, kind in groups.items():
        text += f"\n## robot.{name}\n\n{(inspect.getdoc(kind) or '').split(chr(10) * 2)[0]}\n\n{table(kind)}"
    homes = {id(member): f"robot.{g}.{n}" for g, kind in groups.items() for n, member in vars(kind).items()}
    rows = [
        f"| `robot.{name}` | `{homes[id(member)]}` |"
        for name, member in vars(FormerNames).items()
        if not name.startswith("_")
    ]
    return (
        text
        + FORMER
        + "\n".join([*rows, '| `robot.parameters("inertia")` | `robot.parameters["inertia"]` |', ""])
    )


def main() -> None:
    """Write the page, or compare it."""
    if "--write" in sys.argv:
        PAGE.write_text(page(), encoding="utf-8")
    elif "--check" in sys.argv:
        if PAGE.read_text(encoding="utf-8") != page():
            sys.exit(f"{PAGE.name} is out of date: run python scripts/quantities_page.py --write")
    else:
        print(page())


if __name__ == "__main__":
    main()
