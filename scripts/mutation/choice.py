"""Which tests try a mutant: those that run its line, then those that run its file, then those that name it."""

from __future__ import annotations

import ast
import re
from functools import lru_cache
from pathlib import Path

from mutation.coverage_map import CoverageMap
from mutation.mutant import Mutant

FILES = 5  # test files that are tried where the map knows nothing
_OTHER = ("browser", "architecture", "fuzz")  # folders of tests that try no single line


def stages(mutant: Mutant, covered: CoverageMap, root: Path, budget: float) -> list[list[str]]:
    """The tests to try, in up to three rounds; each round takes about `budget` seconds at most.

    First the quickest of the tests that run the mutated lines, then more of these and of the tests that run the file,
    then the test files that name what is mutated.
    """
    if mutant.function_lines is not None:
        exact = covered.of_lines(mutant.path, mutant.line, mutant.last_line)
    else:
        exact = covered.of_lines(mutant.path, *(mutant.signature_of or (0, -1)))
    own = Path(mutant.path).stem.strip("_")

    def order(test: str) -> tuple[bool, float]:
        return own not in test, covered.seconds(test)

    near = _within(sorted(exact, key=order), covered, budget)
    first = near[:12]
    second = near[12:] + _within(sorted(covered.of_file(mutant.path) - exact, key=order), covered, budget / 2)
    rounds = [first, second]
    if len(first) < 12:
        rounds.append(
            [
                file
                for file in named(mutant, root)
                if not all(t.startswith(f"{file}::") for t in first) or not first
            ]
        )
    return [tests for tests in rounds if tests]


def _within(tests: list[str], covered: CoverageMap, budget: float) -> list[str]:
    """The first of `tests` that take about `budget` seconds together."""
    chosen, spent = [], 0.0
    for test in tests:
        spent += covered.seconds(test)
        if chosen and spent > budget:
            break
        chosen.append(test)
    return chosen


def named(mutant: Mutant, root: Path) -> list[str]:
    """The test files that name most of a mutant: its path, the function around it, what its module defines."""
    module = _module(mutant.path)
    inner, others = _names((root / mutant.path).read_text(), mutant.line)
    scores = []
    for file, words in _test_words(root):
        mirror = Path(mutant.path).stem.strip("_") in Path(file).stem
        folder = sum(part in Path(file).parts for part in module[1:-1] + module[:1])
        score = 6 * mirror + 3 * folder + 4 * sum(name in words for name in inner)
        score += min(4, sum(name in words for name in others))
        scores.append((-score, file))
    return [file for score, file in sorted(scores)[:FILES] if score <= -4]


def _module(path: str) -> tuple[str, ...]:
    """The dotted name of a source file, as a package is imported: compatibility packages begin at their own name."""
    parts = Path(path).with_suffix("").parts
    start = next((i + 1 for i, part in enumerate(parts) if part.startswith("for-")), 1)
    return tuple(part.strip("_") for part in parts[start:])


def _names(source: str, line: int) -> tuple[list[str], set[str]]:
    """The functions and classes around a line, and all others that the source defines."""
    inner, others = [], set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef) and node.name[:2] != "__":
            name = node.name.strip("_")
            others.add(name)
            if node.lineno <= line <= (node.end_lineno or node.lineno):
                inner.append(name)
    return inner, others


@lru_cache
def _test_words(root: Path) -> list[tuple[str, set[str]]]:
    """The test files and the words in each, and in the scripts beside it that it runs."""
    found = []
    for path in sorted((root / "tests").rglob("test_*.py")):
        if set(_OTHER).isdisjoint(path.relative_to(root).parts):
            text = path.read_text()
            scripts = (p for p in path.parent.glob("*.py") if p.stem[:5] != "test_" and p.name in text)
            words = set(re.findall(r"\w+", "\n".join([text, *(script.read_text() for script in scripts)])))
            found.append((path.relative_to(root).as_posix(), words))
    return found
