"""Which tests try a mutant: those that run its line, then those that run its file, that name it, that import it."""

from __future__ import annotations

import ast
import re
from functools import lru_cache
from pathlib import Path

from mutation.coverage_map import CoverageMap
from mutation.imports import distances
from mutation.mutant import Mutant

FUNCTIONS, FILES = 12, 2  # how many test functions and files are tried where the map knows nothing
IMPORTING = 4  # how many of the files that import the mutated one with the fewest imports between are tried
_OF_SOURCES = ["tests/architecture/test_frozen_data.py"]  # which read the sources that are imported
_OTHER = ("browser", "architecture", "fuzz")  # folders of tests that try no single line


def stages(mutant: Mutant, covered: CoverageMap, root: Path, budget: float) -> list[list[str]]:
    """The tests to try, in up to ten rounds; each round takes about `budget` seconds at most.

    First the quickest of the tests that run the mutated lines, then more of these and of the tests that run the file,
    then the test functions and files that name what is mutated, the files that import it, then tests that read sources.
    """
    if mutant.function_lines is not None:
        exact = covered.of_lines(mutant.path, mutant.line, mutant.last_line)
    else:
        exact = covered.of_lines(mutant.path, *(mutant.signature_of or (0, -1)))
    module = _module(mutant.path)

    def order(test: str) -> tuple[bool, int, float]:
        words = set(re.split(r"\W|_", test))
        return module[-1] not in words, -len(words.intersection(module)), covered.seconds(test)

    if len(exact) < 12:  # what a fixture runs for all tests of a function is noted at the first of them
        exact |= covered.of_functions(exact)
    near = _within(sorted(exact, key=order), covered, budget, least=3)
    first = near[:12]
    second = near[12:] + _within(sorted(covered.of_file(mutant.path) - exact, key=order), covered, budget / 2)
    by_name = named(mutant, root)  # these and the following: tests that are newer than the map
    tried = set(by_name[-1])
    by_import = [[file] for file in importing(mutant, root) if file not in tried]
    rounds = [first, second, *by_name, *by_import]
    if mutant.function_lines is None:
        rounds.append([test for test in _OF_SOURCES if (root / test).exists()])
    return [tests for tests in rounds if tests]


def _within(tests: list[str], covered: CoverageMap, budget: float, least: int = 1) -> list[str]:
    """The first of `tests` that take about `budget` seconds together; `least` of them in any case."""
    chosen, spent = [], 0.0
    for test in tests:
        spent += covered.seconds(test)
        if len(chosen) >= least and spent > budget:
            break
        chosen.append(test)
    return chosen


def named(mutant: Mutant, root: Path) -> list[list[str]]:
    """The test functions, then the files, that name most of a mutant: its path, the function around it, its module."""
    module = _module(mutant.path)
    inner, others = _names((root / mutant.path).read_text(), mutant.line)
    files, functions = [], []
    compatibility = "compat" in Path(mutant.path).parts
    for file, words, tests in _test_words(root):
        if compatibility and "compat" not in Path(file).parts:
            continue
        own = Path(file).stem.removeprefix("test_").split("_")
        place = 6 * (module[-1] in own or module[-1] == "_".join(own))
        place += 4 * len(set(module[:-1]).intersection([*Path(file).parts, *own]))
        defined = min(4, sum(name in words for name in others))
        files.append((-place - 4 * len(words.intersection(inner)) - defined, file))
        for test, inside in tests.items():
            near = len(inside.intersection(inner)) + (module[-1] in test.split("_"))
            if place >= 6 or near:
                defined = min(4, sum(name in inside for name in others))
                functions.append((-place - 6 * near - defined, f"{file}::{test}"))
    best = [test for _, test in sorted(functions)[:FUNCTIONS]]
    count = 2 * FILES if compatibility else FILES  # whose tests run scripts, which name little
    return [best, [file for score, file in sorted(files)[:count] if score <= -4]]


def importing(mutant: Mutant, root: Path) -> list[str]:
    """The test files that import the mutated file with the fewest imports between, those that name more of it first."""
    inner, others = _names((root / mutant.path).read_text(), mutant.line)
    words_of = {file: words for file, words, _ in _test_words(root)}
    nearest: dict[str, int] = {}
    for file, distance in distances(root, mutant.path).items():
        for test in [file] if file in words_of else _tests_beside(file, words_of):
            nearest[test] = min(distance, nearest.get(test, distance))

    def order(file: str) -> tuple[int, int]:
        words = words_of[file]
        return nearest[file], -4 * len(words.intersection(inner)) - len(words & others)

    return sorted(nearest, key=order)[:IMPORTING]


def _tests_beside(script: str, words_of: dict[str, set[str]]) -> list[str]:
    """The test files in the folder of a script that name it."""
    path = Path(script)
    return [
        file for file, words in words_of.items() if Path(file).parent == path.parent and path.stem in words
    ]


def _module(path: str) -> tuple[str, ...]:
    """The dotted name of a source file, as a package is imported: compatibility packages begin at their own name."""
    parts = Path(path).with_suffix("").parts
    start = next((i + 1 for i, part in enumerate(parts) if part.startswith("for-")), 1)
    return tuple(part.strip("_") for part in parts[start:] if part != "__init__")


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
def _test_words(root: Path) -> list[tuple[str, set[str], dict[str, set[str]]]]:
    """The test files, the words in each and in the scripts beside it that it runs, and those in each test function."""
    found = []
    for path in sorted((root / "tests").rglob("test_*.py")):
        if set(_OTHER).isdisjoint(path.relative_to(root).parts):
            text = path.read_text()
            tree = ast.parse(text)
            scripts = (p for p in path.parent.glob("*.py") if p.stem[:5] != "test_" and p.name in text)
            words = {
                word.strip("_")
                for script in (path, *scripts)
                for word in re.findall(r"\w+", script.read_text())
            }
            tests = {
                node.name: _identifiers(node)
                for node in tree.body
                if isinstance(node, ast.FunctionDef) and node.name.startswith("test_")
            }
            found.append((path.relative_to(root).as_posix(), words, tests))
    return found


def _identifiers(tree: ast.AST) -> set[str]:
    """The names that a piece of source uses."""
    names = (getattr(node, "attr", getattr(node, "id", getattr(node, "name", ""))) for node in ast.walk(tree))
    return {str(name).strip("_") for name in names}
