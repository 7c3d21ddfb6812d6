"""Which tests run which line: builds the map by a run of the tests on marked sources, and answers from it."""

from __future__ import annotations

import difflib
import hashlib
import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections import defaultdict
from functools import lru_cache
from pathlib import Path

from coverage import CoverageData

from mutation import marks


def build(root: Path, folder: Path, arguments: list[str], jobs: int) -> None:
    """Runs the tests that `arguments` (of pytest) select on marked sources and adds what they call to the map.

    The map is added to, so it can be built folder by folder. Child processes of the tests count, too. Each version of
    the sources has its part of the map, with a copy of the sources, so that line numbers are found again after the
    sources changed. Marks are of functions: that a line is in the map of a test says that its function was called.
    """
    part = _part(root, folder)
    with tempfile.TemporaryDirectory(prefix="mutation-") as place:
        copy, hits = Path(place) / "src", Path(place) / "hits"
        functions = marks.mark(root / "src", copy)
        # where a test of xdist calls this, the tests here are not that worker's
        inherited = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST_XDIST")}
        environment = {
            **inherited,
            "MUTATION_HITS": str(hits),
            "MUTATION_NOTES": str(folder / "notes.jsonl"),
            "PYTHONPATH": os.pathsep.join([str(copy), str(Path(__file__).resolve().parents[1])]),
        }
        workers = ["-n", str(jobs), "--dist", "worksteal"] if jobs > 1 else ["-p", "no:xdist"]
        command = [sys.executable, "-m", "pytest", "-q", "--tb=no", "-p", "no:cacheprovider"]
        subprocess.run(
            [*command, "-p", "mutation.plugin", *workers, *arguments], cwd=root, env=environment, check=False
        )
        data = CoverageData(part / "lines")
        data.read()
        marks.collect(functions, hits, root / "src", data)
        data.write()


def _part(root: Path, folder: Path) -> Path:
    """The folder of the map of the sources as they are now, with a copy of them."""
    digest = hashlib.sha256()
    for file in sorted((root / "src").rglob("*.py")):
        digest.update(f"{file.relative_to(root)} {hashlib.sha256(file.read_bytes()).hexdigest()}".encode())
    part = folder / "maps" / digest.hexdigest()[:12]
    if not (part / "src").exists():
        part.mkdir(parents=True, exist_ok=True)
        shutil.copytree(root / "src", part / "src", ignore=shutil.ignore_patterns("__pycache__"))
    return part


class CoverageMap:
    """The tests that ran each line when the map was built, without those that did not pass."""

    def __init__(self, root: Path, folder: Path) -> None:
        self._root = root
        self._parts: list[tuple[CoverageData, Path]] = []
        for lines in sorted(folder.glob("maps/*/lines")):
            data = CoverageData(lines)
            data.read()
            self._parts.append((data, lines.parent))
        self._contexts = lru_cache(maxsize=64)(self._read_contexts)
        self._seconds: dict[str, float] = defaultdict(float)
        failed = set()
        notes = folder / "notes.jsonl"
        for line in notes.read_text().splitlines() if notes.exists() else []:
            test, seconds, outcome = json.loads(line)
            self._seconds[test] = max(self._seconds[test], seconds)
            if outcome == "failed":
                failed.add(test)
        for test in failed:
            del self._seconds[test]

    def seconds(self, test: str) -> float:
        """How long a test took when the map was built, about [s]."""
        return self._seconds.get(test, 0.0)

    def of_lines(self, path: str, first: int, last: int) -> set[str]:
        """The tests that called a function with a line from `first` to `last` of a file."""
        contexts = self._contexts(path)
        return {test for line in range(first, last + 1) for test in contexts.get(line, ())}

    def of_functions(self, tests: set[str]) -> set[str]:
        """All tests of the test functions, with any parameters, that some of their tests belong to."""
        functions = {test.partition("[")[0] for test in tests if "[" in test}
        return {test for test in self._seconds if test.partition("[")[0] in functions}

    def of_file(self, path: str) -> set[str]:
        """The tests that ran any line of a file."""
        return {test for tests in self._contexts(path).values() for test in tests}

    def _read_contexts(self, path: str) -> dict[int, set[str]]:
        """The tests of each line of a file as it is now."""
        found: dict[int, set[str]] = defaultdict(set)
        for data, part in self._parts:
            lines = data.contexts_by_lineno(str(self._root / path))
            places = _places(part / path, self._root / path) if lines else {}
            for line, tests in lines.items():
                if line in places:
                    found[places[line]].update(test for test in tests if test in self._seconds)
        return found


def _places(before: Path, after: Path) -> dict[int, int]:
    """Where the lines of a file are now that are in an earlier version of it, too."""
    if not before.exists():
        return {}
    lines = [file.read_text().splitlines() for file in (before, after)]
    blocks = difflib.SequenceMatcher(None, *lines, autojunk=False).get_matching_blocks()
    return {a + k + 1: b + k + 1 for a, b, size in blocks for k in range(size)}
