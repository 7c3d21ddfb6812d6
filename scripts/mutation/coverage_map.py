"""Which tests run which line: builds the map by a traced run of the tests, and answers from it."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

from coverage import Coverage, CoverageData

CONFIG = """[run]
source = {source}
data_file = {data}
parallel = true
sigterm = true
context = ${{MUTATION_TEST-}}
disable_warnings = module-not-measured, no-data-collected, module-not-imported, already-imported
"""


def build(root: Path, folder: Path, arguments: list[str], jobs: int) -> None:
    """Runs the tests that `arguments` (of pytest) select under coverage and adds what they run to the map in `folder`.

    The map is added to, so it can be built folder by folder, and a build that was stopped leaves what it found by
    then. Child processes of the tests are traced, too.
    """
    folder.mkdir(parents=True, exist_ok=True)
    config, data = folder / "coverage.ini", folder / "lines"
    config.write_text(CONFIG.format(source=root / "src", data=data))
    # where a test of xdist calls this, the tests here are not that worker's
    inherited = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST_XDIST")}
    environment = {
        **inherited,
        "COVERAGE_PROCESS_START": str(config),
        "MUTATION_NOTES": str(folder / "notes.jsonl"),
        "PYTHONPATH": os.pathsep.join([str(Path(__file__).resolve().parents[1]), str(root / "src")]),
    }
    workers = ["-n", str(jobs), "--dist", "worksteal"] if jobs > 1 else []
    command = [sys.executable, "-m", "pytest", "-q", "--tb=no", "-p", "mutation.plugin", *workers, *arguments]
    subprocess.run(command, cwd=root, env=environment, check=False)
    combined = Coverage(data_file=data, config_file=str(config))
    combined.load()  # what earlier builds found, which combining would overwrite
    combined.combine(strict=False)
    combined.save()
    for damaged in folder.glob("lines.*"):  # of children that were killed while they wrote
        damaged.unlink()


class CoverageMap:
    """The tests that ran each line when the map was built, without those that did not pass."""

    def __init__(self, root: Path, folder: Path) -> None:
        self._root = root
        self._data: CoverageData | None = None
        if (folder / "lines").exists():
            self._data = CoverageData(folder / "lines")
            self._data.read()
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
        """How long a test took in the traced run, about [s]."""
        return self._seconds.get(test, 0.0)

    def of_lines(self, path: str, first: int, last: int) -> set[str]:
        """The tests that ran a line from `first` to `last` of a file."""
        contexts = self._contexts(path)
        return {test for line in range(first, last + 1) for test in contexts.get(line, ())}

    def of_functions(self, tests: set[str]) -> set[str]:
        """All tests of the test functions, with any parameters, that some of their tests belong to."""
        functions = {test.partition("[")[0] for test in tests if "[" in test}
        return {test for test in self._seconds if test.partition("[")[0] in functions}

    def of_file(self, path: str) -> set[str]:
        """The tests that ran any line of a file."""
        return {test for tests in self._contexts(path).values() for test in tests}

    def _contexts(self, path: str) -> dict[int, list[str]]:
        if self._data is None:
            return {}
        lines = self._data.contexts_by_lineno(str(self._root / path))
        return {line: [test for test in tests if test in self._seconds] for line, tests in lines.items()}
