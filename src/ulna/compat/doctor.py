"""Examines a script: which names of libraries it uses, and which of them the compatibility packages do not offer."""

from __future__ import annotations

import ast
import importlib
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, final

from ulna.compat.packages import FOLDERS, modules
from ulna.errors import FormatError, InputError
from ulna.files import read_regular


@final
@dataclass(frozen=True)
class Finding:
    """A name of a library that a script uses.

    Attributes:
        line: Where it does so first.
        name: The dotted name, from the package on.
        offered: Whether the compatibility package has it.
        hint: What to use instead, if it does not.
    """

    line: int
    name: str
    offered: bool
    hint: str = ""


def examine(path: str | Path) -> list[Finding]:
    """The names of libraries that a script uses, in the order of their lines; the script is read, not run.

    What is reached through an instance (`robot.fkine`) cannot be known from the text and is not listed.

    Raises:
        InputError: If the file cannot be read.
        FormatError: If it is not Python.
    """
    file = Path(path)
    try:
        tree = ast.parse(read_regular(file), str(file))
    except OSError as error:
        raise InputError(f"{file} cannot be read: {error.strerror}.") from None
    except (SyntaxError, ValueError) as error:
        # ValueError: null characters
        message, line = getattr(error, "msg", None) or str(error), getattr(error, "lineno", None)
        raise FormatError(f"not Python: {message}", file=str(file), line=line) from None
    known_modules = {module for library in FOLDERS for module in modules(library)}
    used: dict[str, int] = {}
    for line, name in sorted(_used(tree, frozenset(known_modules))):
        used.setdefault(name, line)
    for folder in FOLDERS.values():
        if str(folder) not in sys.path:
            sys.path.insert(0, str(folder))
    return [Finding(line, name, *_is_offered(name)) for name, line in used.items()]


def _used(tree: ast.AST, known_modules: frozenset[str]) -> Iterator[tuple[int, str]]:
    """Lines and dotted names."""
    meaning: dict[str, str] = {}  # of the names in the script
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                if alias.name.split(".")[0] in known_modules:
                    meaning[alias.asname or alias.name.split(".")[0]] = (
                        alias.name if alias.asname else alias.name.split(".")[0]
                    )
                    yield node.lineno, alias.name
        elif isinstance(node, ast.ImportFrom) and node.module and node.module.split(".")[0] in known_modules:
            for alias in node.names:
                if alias.name != "*":
                    meaning[alias.asname or alias.name] = f"{node.module}.{alias.name}"
                yield node.lineno, node.module if alias.name == "*" else f"{node.module}.{alias.name}"
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute):
            parts: list[str] = []
            at: ast.AST = node
            while isinstance(at, ast.Attribute):
                parts.insert(0, at.attr)
                at = at.value
            if isinstance(at, ast.Name) and at.id in meaning:
                yield node.lineno, ".".join([meaning[at.id], *parts])


def _is_offered(name: str) -> tuple[bool, str]:
    parts = name.split(".")
    value: Any = None
    for count in range(len(parts), 0, -1):
        try:
            value = importlib.import_module(".".join(parts[:count]))
            break
        except ModuleNotFoundError:
            continue
        except ImportError as error:
            return False, str(error)
    if value is None:
        return False, ""
    for part in parts[count:]:
        try:
            value = getattr(value, part)
        except AttributeError as error:
            return False, str(error)
    return True, ""


def report(path: str | Path, findings: Sequence[Finding]) -> str:
    """What `ulna doctor` prints.

    Args:
        path: The script.
        findings: The names that it uses.

    Returns:
        Lines of text.
    """
    missing = [f for f in findings if not f.offered]
    head = f"{path}: {len(findings)} names of libraries, {len(findings) - len(missing)} offered."
    lines = [f"  line {f.line}: {f.name} is not offered. {f.hint}".rstrip() for f in missing]
    return "\n".join([head, *lines])
