"""No function is written twice: bodies that are equal but for the names of arguments and variables are one function."""

from __future__ import annotations

import ast
from collections import defaultdict
from pathlib import Path

import ulna

SOURCE = Path(ulna.__file__).parent
LEAST = 25
"""Nodes of the syntax tree from which on a body counts."""
PINOCCHIO, TOOLBOX = "compat/for-pinocchio/pinocchio", "compat/for-roboticstoolbox/roboticstoolbox"
ALLOWED = {
    # Procedures cannot be arguments of procedures, so the loop around them is written for each.
    frozenset(
        {
            "recursions/_procedures/columns.py: all_wrenches_out",
            "recursions/_procedures/columns.py: turn_columns",
        }
    ),
    frozenset(
        {"recursions/_procedures/frames.py: frame_poses", "recursions/_procedures/frames.py: frame_jacobian"}
    ),
    # Classes without a common base, whose methods have documentation of their own.
    frozenset({f"{TOOLBOX}/_ets/ets.py: fkine"}),
    frozenset({"errors.py: __init__"}),
    frozenset(f"{PINOCCHIO}/visualize/meshcat_visualizer.py: {name}" for name in ("addBox", "addEllipsoid")),
}
"""Copies that stay, and why."""


class _Numbered(ast.NodeTransformer):
    """Replaces names by numbers in the order of their first use."""

    def __init__(self) -> None:
        self.numbers: dict[str, str] = {}

    def _number(self, name: str) -> str:
        return self.numbers.setdefault(name, f"v{len(self.numbers)}")

    def visit_Name(self, node: ast.Name) -> ast.Name:
        node.id = self._number(node.id)
        return node

    def visit_arg(self, node: ast.arg) -> ast.arg:
        node.arg, node.annotation = self._number(node.arg), None
        return node


def _body(function: ast.FunctionDef) -> list[ast.stmt]:
    return function.body[1:] if ast.get_docstring(function) is not None else function.body


def _kinds_of(function: ast.FunctionDef) -> tuple[type, ...]:
    """The kinds of the nodes of its body but annotations of arguments: the same in functions of the same shape, and quickly listed."""
    kinds: list[type] = []
    waiting: list[ast.AST] = [*_body(function)]
    while waiting:
        node = waiting.pop()
        kinds.append(type(node))
        if not isinstance(node, ast.arg):
            waiting.extend(ast.iter_child_nodes(node))
    return tuple(kinds)


def shape_of(function: ast.FunctionDef) -> str | None:
    """The body and the arguments of a function without its names; None for a short one."""
    body = _body(function)
    if sum(1 for statement in body for _ in ast.walk(statement)) < LEAST:
        return None
    bare = ast.FunctionDef(name="f", args=function.args, body=body, decorator_list=[], lineno=1, col_offset=0)
    copy = ast.parse(ast.unparse(ast.fix_missing_locations(ast.Module([bare], []))))
    return ast.dump(_Numbered().visit(copy))


def copies(sources: dict[str, str]) -> set[frozenset[str]]:
    kinds: dict[tuple[type, ...], list[tuple[str, ast.FunctionDef]]] = defaultdict(list)
    for name, text in sources.items():
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.FunctionDef):
                kinds[_kinds_of(node)].append((f"{name}: {node.name}", node))
    groups: dict[str, list[str]] = defaultdict(list)
    for alike in kinds.values():
        for title, node in alike if len(alike) > 1 else ():
            shape = shape_of(node)
            if shape is not None:
                groups[shape].append(title)
    return {frozenset(group) for group in groups.values() if len(group) > 1}


def test_no_function_is_written_twice() -> None:
    sources = {
        p.relative_to(SOURCE).as_posix(): p.read_text(encoding="utf-8") for p in sorted(SOURCE.rglob("*.py"))
    }
    same = copies(sources)
    assert not same - ALLOWED, "make one function of these"
    assert not ALLOWED - same, "these are one by now: take them out of the list"


def test_names_and_docstrings_do_not_hide_a_copy() -> None:
    first = 'def f(a, b):\n    """One."""\n    c = a * b + a / b - 3 * a\n    return [c + x for x in range(int(b))]\n'
    second = "def g(x, y):\n    z = x * y + x / y - 3 * x\n    return [z + k for k in range(int(y))]\n"
    assert copies({"one.py": first, "two.py": second}) == {frozenset({"one.py: f", "two.py: g"})}
    assert copies({"one.py": first, "two.py": second.replace("3", "4")}) == set()
