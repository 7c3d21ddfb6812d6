"""How many imports lie between a source file and the test files that use it."""

from __future__ import annotations

import ast
from collections import defaultdict, deque
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path


@lru_cache
def distances(root: Path, path: str) -> dict[str, int]:
    """The test files that import a source file, directly or through others, with the number of imports between.

    Args:
        root: The repository.
        path: The source file in it.

    Returns:
        The distance of each test file that can be reached.
    """
    users = _users(root)
    reached = {path: 0}
    waiting = deque([path])
    while waiting:
        file = waiting.popleft()
        for user in users.get(file, ()):
            if user not in reached:
                reached[user] = reached[file] + 1
                waiting.append(user)
    return {file: distance for file, distance in reached.items() if file.startswith("tests/")}


@lru_cache
def _users(root: Path) -> dict[str, set[str]]:
    """For each source file the files that import it; a module brings what its packages import."""
    modules = {
        name: path.relative_to(root).as_posix() for path in _sources(root) for name in [_name(root, path)]
    }
    users: dict[str, set[str]] = defaultdict(set)
    for path in (*_sources(root), *sorted((root / "tests").rglob("*.py"))):
        file = path.relative_to(root).as_posix()
        for name in _imported(path):
            if name in modules and modules[name] != file:
                users[modules[name]].add(file)
    return users


def _sources(root: Path) -> Iterator[Path]:
    return (path for path in sorted((root / "src").rglob("*.py*")) if path.suffix in (".py", ".pyi"))


def _name(root: Path, path: Path) -> str:
    """The dotted name of a module; compatibility packages are imported from folders `for-...`."""
    parts = path.relative_to(root / "src").with_suffix("").parts
    start = next((i + 1 for i, part in enumerate(parts) if part.startswith("for-")), 0)
    return ".".join(part for part in parts[start:] if part != "__init__")


def _imported(path: Path) -> Iterator[str]:
    """The dotted names that a file imports, anywhere in it; of `from a import b` both a and a.b; texts may be names."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield alias.name
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            yield node.module
            for alias in node.names:
                yield f"{node.module}.{alias.name}"
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):  # imported when first used
            yield node.value.partition(":")[0]
