"""Compares the signatures of the package with the overloads of Pinocchio, position by position.

`python signatures.py overloads.json out.json`, with the package: what differs, as [path, what, parameters].
"""

from __future__ import annotations

import inspect
import json
import re
import sys
from collections.abc import Iterator
from functools import reduce
from typing import Any

import pinocchio as pin

NAMELESS = re.compile(r"arg\d+|object|int|self")


def resolved(path: str) -> Any:
    """What a path names, None where there is no such thing."""
    try:
        return reduce(getattr, path.split("."), pin)
    except AttributeError:
        return None


def is_method(path: str) -> bool:
    """Whether a path names a function that takes an object first."""
    owner, _, name = path.rpartition(".")
    cls = resolved(owner) if owner else None
    if not inspect.isclass(cls):
        return False
    return not isinstance(inspect.getattr_static(cls, name, None), (staticmethod, classmethod))


def compared(path: str) -> bool:
    """Whether a path names what users call by its name."""
    name = path.rpartition(".")[2]
    if name.startswith("__") and name not in ("__init__", "__call__"):
        return False
    return (
        not path.startswith(("StdVec", "StdMap")) and not name.startswith(("load", "save")) and name != "id"
    )


def differences(path: str, parameters: list[list[Any]]) -> Iterator[str]:
    """What differs between one overload and the function of the package."""
    constructor = path.endswith(".__init__")
    function = resolved(path.removesuffix(".__init__") if constructor else path)
    taken = parameters[1:] if constructor or is_method(path) else parameters
    names = [name for name, *_ in taken]
    required = sum(default is None for *_, default in taken)
    orders = getattr(function.__init__ if constructor else function, "orders", None)
    if orders is not None:
        if not any(order[: len(names)] == names for order in orders):
            yield "names"
        return
    signature = inspect.signature(function)
    if is_method(path) and not constructor:
        signature = signature.replace(parameters=list(signature.parameters.values())[1:])
    try:
        by_position = signature.bind(*names).arguments
        signature.bind(*names[:required])
    except TypeError:
        yield "count"
        return
    if any(NAMELESS.fullmatch(name) for name in names):
        return
    try:
        by_name = signature.bind(**{name: name for name in names}).arguments
    except TypeError:
        yield "names"
        return
    if by_position != by_name:
        yield "order"
    for name, _, default in taken:
        if default is not None and not same_default(default, signature.parameters[name].default):
            yield f"default of {name}"


def same_default(text: str, own: Any) -> bool:
    """Whether a default is what the text of another one says."""
    last = text.replace("pinocchio.pinocchio_pywrap_default.", "pin.")
    try:
        return bool(eval(last, {"pin": pin}) == own)
    except (SyntaxError, NameError, ValueError, AttributeError, TypeError):
        return False


def main() -> None:
    """Writes what differs, and how many overloads were compared."""
    with open(sys.argv[1], encoding="utf-8") as file:
        overloads = json.load(file)
    found, count = [], 0
    for path, ways in overloads.items():
        owner = resolved(path.removesuffix(".__init__"))
        if not compared(path) or owner is None:
            continue
        if not getattr(owner, "__module__", "").startswith("pinocchio") or path.startswith("CollisionObject"):
            continue  # coal's own
        for parameters in ways:
            count += 1
            found += [[path, what, [p[0] for p in parameters]] for what in differences(path, parameters)]
    with open(sys.argv[2], "w", encoding="utf-8") as out:
        out.write(json.dumps({"file": pin.__file__, "count": count, "differences": found}))


if __name__ == "__main__":
    main()
