"""Marks in a copy of the sources: each function notes that it was called, so a run of tests says which call which."""

from __future__ import annotations

import ast
import shutil
from collections import defaultdict
from pathlib import Path

from coverage import CoverageData

_MARK = '__import__("mutation_mark").hit({number})'
_MODULE = '''"""Notes which functions are called while a test runs."""
import os

seen, place = set(), None


def start(test):
    """A test begins; also called in child processes, which know it from their environment."""
    seen.clear()
    if test:
        _write("T" + test)


def hit(number):
    """A function is called."""
    if number not in seen:
        seen.add(number)
        _write(str(number))


def _write(text):
    global place
    if place is None:
        name = f"{os.environ['MUTATION_HITS']}.{os.getpid()}"
        place = os.open(name, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o600)
    os.write(place, f"{text}\\n".encode())


def _forked():
    global place
    place = None
    start(os.environ.get("MUTATION_TEST", ""))


os.register_at_fork(after_in_child=_forked)
start(os.environ.get("MUTATION_TEST", ""))
'''


def mark(sources: Path, copy: Path) -> list[tuple[str, int, int]]:
    """Writes a copy of sources whose functions call `mutation_mark.hit` with their number.

    Functions that are compiled from their text (files with `@procedure`) stay as they are.

    Args:
        sources: A folder of Python files.
        copy: Where the copy is made; the module `mutation_mark` is written into it.

    Returns:
        The path (within `sources`), first and last line of each marked function, by number.
    """
    shutil.copytree(sources, copy, ignore=shutil.ignore_patterns("__pycache__"))
    (copy / "mutation_mark.py").write_text(_MODULE)
    functions: list[tuple[str, int, int]] = []
    for file in sorted(sources.rglob("*.py")):
        text = file.read_text()
        path = file.relative_to(sources)
        if "@procedure" not in text and "_procedures" not in path.parts:
            (copy / path).write_text(_marked(text, path.as_posix(), functions))
    return functions


def _marked(text: str, path: str, functions: list[tuple[str, int, int]]) -> str:
    """A source with its functions marked; these are added to `functions`."""
    lines = text.split("\n")
    found = [n for n in ast.walk(ast.parse(text)) if isinstance(n, ast.FunctionDef | ast.AsyncFunctionDef)]
    for node in sorted(found, key=lambda n: -n.lineno):  # from below, so that places above stay
        is_documented = ast.get_docstring(node, clean=False) is not None
        body = node.body[1:] if is_documented else node.body
        if not body or body[0].lineno == node.lineno or _is_empty(body):
            continue
        first = body[0]
        number = len(functions)
        functions.append((path, node.lineno, node.end_lineno or node.lineno))
        decorators = getattr(first, "decorator_list", None)
        row = (decorators[0].lineno if decorators else first.lineno) - 1
        space = lines[row][: len(lines[row]) - len(lines[row].lstrip())]
        # On a separate line only where it must be, so that the lines keep their numbers.
        simple = isinstance(
            first, ast.Expr | ast.Assign | ast.AnnAssign | ast.AugAssign | ast.Return | ast.Raise | ast.Assert
        )
        lines[row] = (
            f"{space}{_MARK.format(number=number)}" + ("; " if simple else f"\n{space}") + lines[row].lstrip()
        )
    return "\n".join(lines)


def _is_empty(body: list[ast.stmt]) -> bool:
    return len(body) == 1 and isinstance(body[0], ast.Expr) and isinstance(body[0].value, ast.Constant)


def collect(functions: list[tuple[str, int, int]], hits: Path, root: Path, data: CoverageData) -> None:
    """Adds what was noted to the map: the lines of each called function, by test.

    Args:
        functions: What `mark` returned.
        hits: The files' name without its ending, the process's number.
        root: The folder of the sources that were marked.
        data: The map.
    """
    for file in sorted(hits.parent.glob(f"{hits.name}.*")):
        test, called = "", defaultdict(set)
        for line in file.read_text().splitlines():
            if line.startswith("T"):
                test = line[1:]
            elif test and line.isdigit():
                called[test].add(int(line))
        for name, numbers in called.items():
            rows: dict[str, set[int]] = defaultdict(set)
            for path, first, last in (functions[k] for k in numbers):
                rows[str(root / path)].update(range(first, last + 1))
            data.set_context(name)
            data.add_lines(rows)
        file.unlink()
