"""No two modules need each other: imports inside functions and for type checkers count, in compatibility packages, too."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path

SOURCE = Path(__file__).parents[2] / "src"


def module_files() -> dict[str, Path]:
    """The file of each module; the root of a compatibility package is its own folder, which goes on the path."""
    modules: dict[str, Path] = {}
    for file in (SOURCE / "ulna").rglob("*.py"):
        parts = file.relative_to(SOURCE).with_suffix("").parts
        roots = [k for k, part in enumerate(parts) if part.startswith("for-")]
        parts = parts[roots[0] + 1 :] if roots else parts
        modules[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = file
    return modules


def statements(node: ast.AST) -> Iterator[ast.stmt]:
    """All statements in a node, at any depth; expressions, most of a tree, hold none."""
    for name in ("body", "orelse", "finalbody", "handlers", "cases"):
        inside = getattr(node, name, ())
        for child in inside if isinstance(inside, list) else ():
            if isinstance(child, ast.stmt):
                yield child
            yield from statements(child)


def imported(module: str, file: Path, modules: dict[str, Path]) -> set[str]:
    """The modules of this project that a module imports, anywhere in its file."""
    package = module if file.name == "__init__.py" else module.rpartition(".")[0]
    names: set[str] = set()
    for node in statements(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = package.split(".")[: len(package.split(".")) - node.level + 1] if node.level else []
            base += node.module.split(".") if node.module else []
            for alias in node.names:
                inner = ".".join([*base, alias.name])
                names.add(inner if inner in modules else ".".join(base))
    return {name for name in names if name in modules and name != module}


def cycles(graph: dict[str, set[str]]) -> list[set[str]]:
    """The sets of nodes that reach each other; nodes that reach none of the rest are removed first."""
    reach: dict[str, set[str]] = {}
    left = {node: set(targets) for node, targets in graph.items()}
    while free := [node for node, targets in left.items() if not targets & left.keys()]:
        for node in free:
            del left[node]
    for node in left:
        reached, todo = set(), [node]
        while todo:
            new = (left[todo.pop()] & left.keys()) - reached
            reached |= new
            todo += new
        reach[node] = reached
    components: list[set[str]] = []
    for node in left:
        if node in reach[node] and not any(node in one for one in components):
            components.append({other for other in reach[node] if node in reach[other]})
    return components


@cache
def present_cycles() -> list[set[str]]:
    """The cycles among the modules of this project."""
    modules = module_files()
    return cycles({name: imported(name, file, modules) for name, file in modules.items()})


def test_modules_do_not_import_each_other() -> None:
    assert not present_cycles()


def test_imports_are_found_wherever_they_stand() -> None:
    text = """
import a
def f():
    if x:
        pass
    else:
        import b
    try:
        import c
    except E:
        import d
    finally:
        import e
    with y:
        for z in w:
            import g
    match x:
        case 1:
            import h
class C:
    def f(self):
        while x:
            import i
"""
    found = [n.names[0].name for n in statements(ast.parse(text)) if isinstance(n, ast.Import)]
    assert sorted(found) == list("abcdeghi")


def test_cycles_are_found() -> None:
    graph = {"a": {"b"}, "b": {"c"}, "c": {"b", "d"}, "d": set(), "e": {"a"}, "f": {"g"}, "g": {"f"}}
    assert sorted(map(sorted, cycles(graph))) == [["b", "c"], ["f", "g"]]
