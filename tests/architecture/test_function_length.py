"""Functions are short: at most 40 lines besides their docstring."""

from __future__ import annotations

import ast
from pathlib import Path

import ulna

SOURCE = Path(ulna.__file__).parent
MOST = 40


def length(function: ast.FunctionDef | ast.AsyncFunctionDef) -> int:
    """The lines of a function, without its docstring."""
    lines = (function.end_lineno or 0) - function.lineno + 1
    if ast.get_docstring(function) is not None:
        docstring = function.body[0]
        lines -= (docstring.end_lineno or 0) - docstring.lineno + 1
    return lines


def test_functions_are_short() -> None:
    found = {}
    for path in sorted(SOURCE.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and length(node) > MOST:
                found[f"{path.relative_to(SOURCE).as_posix()}: {node.name}"] = length(node)
    assert not found, f"split these functions, which have more than {MOST} lines: {found}"


def test_the_docstring_does_not_count() -> None:
    source = 'def f(a,\n      b):\n    """One.\n\n    Two.\n    """\n    return a\n'
    function = ast.parse(source).body[0]
    assert isinstance(function, ast.FunctionDef)
    assert length(function) == 3
