"""The overloads of Pinocchio's functions, read from the signatures that its documentation strings begin with.

`python overloads.py out.json`, with the real package: for each name, as a path from `pinocchio`, its overloads, a list
of parameters each: name, type, and the text of its default, or None.
"""

from __future__ import annotations

import inspect
import json
import re
import sys
from collections.abc import Iterator
from typing import Any

SUBMODULES = ("rpy", "cholesky", "liegroups", "linalg", "serialization")
_HEAD = re.compile(r"^([A-Za-z_]\w*)\((.*)\) -> (.+?) :$", re.MULTILINE)
_PARAMETER = re.compile(
    r"\(([\w.: ]+)\)(\w+)(?:=((?:[^\[\],(]|\((?![\w.]+\)\w)(?:[^()]*)\)|\[(?!,))*))?", re.MULTILINE
)


def read(text: str | None) -> list[list[list[str | None]]]:
    """The overloads that a documentation string lists, each once."""
    found: list[list[list[str | None]]] = []
    for match in _HEAD.finditer(text or ""):
        parameters: list[list[str | None]] = [
            [name, kind, default.strip() if default else None]
            for kind, name, default in _PARAMETER.findall(match[2])
        ]
        if parameters not in found:
            found.append(parameters)
    return found


def functions(pin: Any) -> Iterator[tuple[str, Any]]:
    """All public functions and methods that are written in C++, by their paths."""
    binding = type(pin.rnea)
    owners = [("", pin), *((f"{name}.", getattr(pin, name)) for name in SUBMODULES)]
    owners += [(f"{name}.", getattr(pin, name)) for name in dir(pin) if inspect.isclass(getattr(pin, name))]
    for path, owner in owners:
        for name in sorted(dir(owner)):
            member = getattr(owner, name, None)
            if isinstance(member, binding):
                yield path + name, member


def main() -> None:
    """Writes the overloads."""
    import pinocchio as pin

    found = {path: read(function.__doc__) for path, function in functions(pin)}
    with open(sys.argv[1], "w", encoding="utf-8") as out:
        out.write(json.dumps({path: overloads for path, overloads in found.items() if overloads}))


if __name__ == "__main__":
    main()
