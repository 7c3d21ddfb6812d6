"""Names that are imported when first used, so that `import pinocchio` loads no viewer.

They are declared once, in `lazy_exports.pyi`, which type checkers read as it is:

- `from MODULE import NAME as NAME` declares a name of that module, and of `pinocchio` a public submodule;
- `NAME = BASE` declares another name of the module of BASE;
- `StdVec_NAME = StdVec[KIND]` declares the class of lists with entries of that kind;
- `NAME: Any` declares a name of the package coal, or that package.
"""

from __future__ import annotations

import ast
import importlib
import inspect
from functools import cache
from pathlib import Path
from typing import Any

from pinocchio._containers.arguments import check_methods, checked
from pinocchio._containers.documentation import describe_all
from pinocchio._containers.typed_lists import typed_list

_COAL = ("coal", "hppfcl")


@cache
def lazy_names() -> dict[str, str]:
    """The module of each name that is imported when first used; for classes of lists, `StdVec[KIND]`."""
    source = Path(__file__).with_name("lazy_exports.pyi").read_text(encoding="utf-8")
    module_of: dict[str, str] = {}
    names: dict[str, str] = {}
    for node in ast.parse(source).body:
        if isinstance(node, ast.ImportFrom):
            module_of |= dict.fromkeys((alias.name for alias in node.names), str(node.module))
            names |= {alias.name: str(node.module) for alias in node.names if alias.asname}
        elif isinstance(node, ast.Assign):
            base = ast.unparse(node.value)
            names[ast.unparse(node.targets[0])] = base if "[" in base else module_of[base]
        elif isinstance(node, ast.AnnAssign):
            names[ast.unparse(node.target)] = "coal"
    return names


def load_lazy_name(name: str) -> Any:
    """The object that a name of `lazy_names` stands for."""
    module = lazy_names()[name]
    if module == "coal":
        from ulna.collision.narrow import coal

        return coal() if name in _COAL else getattr(coal(), name)
    if module == "pinocchio":
        return importlib.import_module(f"pinocchio.{name}")
    if module.startswith("StdVec["):
        return typed_list(name, module.removeprefix("StdVec[").removesuffix("]"))
    value = getattr(importlib.import_module(module), name)
    check_methods([value])
    value = checked(value) if inspect.isfunction(value) else value
    describe_all([value])
    return value
