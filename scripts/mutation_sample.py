#!/usr/bin/env python
"""How good the tests are: tries random small changes of `src/` and counts which of them the tests notice.

    scripts/mutation_sample.py --map tests/unit --jobs 2   # once: which tests run which line; the rest goes to pytest
    scripts/mutation_sample.py --count 60 --seed 1     # then: a sample; run it again to go on where it stopped
    scripts/mutation_sample.py --count 60 --show 5     # what survived, as changes of the source

Run it with the environment's Python (`.venv/bin/python`). All it makes lies in `out/mutation`, which Git ignores.
Mutants that nothing can notice are listed with their reason in `scripts/mutation/equivalent.txt`.
"""

from __future__ import annotations

import argparse
import difflib
import json
import queue
import shutil
import tempfile
from collections import Counter
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import asdict
from pathlib import Path

from mutation import choice, coverage_map, sampling, trial
from mutation.mutant import Mutant


def main(words: list[str] | None = None) -> int:
    """Reads the arguments, builds the map or tries a sample; returns the number of mutants that survived."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=60, help="how many mutants the sample has")
    parser.add_argument(
        "--seed", type=int, default=0, help="which sample; a longer one begins with the shorter"
    )
    parser.add_argument("--jobs", type=int, default=1, help="how many are tried at the same time")
    parser.add_argument("--only", metavar="PATH", help="a file or folder: mutants of these sources alone")
    parser.add_argument(
        "--show", type=int, default=0, metavar="N", help="show N survivors of the results; try nothing"
    )
    parser.add_argument(
        "--budget", type=float, default=60.0, help="seconds of tests per round for one mutant"
    )
    parser.add_argument(
        "--map", nargs="+", metavar="TESTS", help="trace these tests (`--jobs` at a time) for the map"
    )
    parser.add_argument("--again", action="store_true", help="try survivors again, after tests were added")
    parser.add_argument(
        "--tests", nargs="+", metavar="TESTS", help="try these tests alone, as pytest names them"
    )
    parser.add_argument(
        "--root", type=Path, default=Path(__file__).resolve().parents[1], help="the repository"
    )
    options = parser.parse_args(words)
    root = options.root.resolve()
    folder = root / "out" / "mutation"
    if options.map:
        coverage_map.build(root, folder, options.map, options.jobs)
        return 0
    only = (root / options.only).resolve() if options.only else root / "src"
    files = [only] if only.is_file() else list(sampling.all_files(only))
    if not files:
        parser.error(
            f"there are no Python files in {only}; --only takes a file or folder of src/, as src/ulna/ik"
        )
    chosen = sampling.sample(root, files, options.count, options.seed)
    results = _Results(folder / "results.json")
    if options.show:
        _show([mutant for mutant in chosen if results.status(mutant) == "survived"][: options.show], root)
    else:
        open_ones = ("", "survived", "untested") if options.again else ("",)
        left = [mutant for mutant in chosen if results.status(mutant) in open_ones]
        _try(left, results, root, folder, options)
    return _summary(chosen, results)


class _Results:
    """The verdicts so far, in a file that is whole at any time."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._all = self._read()
        self._equivalent = _equivalent(Path(trial.__file__).with_name("equivalent.txt"))

    def _read(self) -> dict[str, dict]:
        return json.loads(self._path.read_text()) if self._path.exists() else {}

    def status(self, mutant: Mutant) -> str:
        """The verdict on a mutant, empty where there is none yet."""
        if (mutant.path, mutant.change) in self._equivalent:
            return "equivalent"
        return self._all.get(mutant.key, {}).get("status", "")

    def add(self, mutant: Mutant, verdict: trial.Verdict) -> None:
        """Notes a verdict and writes the file."""
        self._all = self._read() | {mutant.key: asdict(verdict)}  # another run may have added some
        self._path.parent.mkdir(parents=True, exist_ok=True)
        beside = self._path.with_suffix(".new")
        beside.write_text(json.dumps(self._all, indent=1))
        beside.replace(self._path)


def _equivalent(file: Path) -> set[tuple[str, str]]:
    """The file and change of each mutant that is known to change nothing: lines `path | change | reason`."""
    rows = [line.split(" | ") for line in file.read_text().splitlines() if line and not line.startswith("#")]
    return {(path, change) for path, change, _ in rows}


def _try(
    chosen: list[Mutant], results: _Results, root: Path, folder: Path, options: argparse.Namespace
) -> None:
    """Tries mutants and prints a line for each."""
    covered, judge = coverage_map.CoverageMap(root, folder), trial.Judge()
    planned = [
        (mutant, [options.tests] if options.tests else choice.stages(mutant, covered, root, options.budget))
        for mutant in chosen
    ]
    places = Path(tempfile.mkdtemp(prefix="mutation-"))
    free: queue.SimpleQueue[trial.Sandbox] = queue.SimpleQueue()
    for job in range(min(options.jobs, len(planned))):
        free.put(trial.Sandbox(root, places / str(job), *trial.user_cache()))

    def one(plan: tuple[Mutant, list[list[str]]]) -> tuple[Mutant, trial.Verdict]:
        sandbox = free.get()
        try:
            return plan[0], judge.verdict(*plan, sandbox, covered.seconds)
        finally:
            free.put(sandbox)

    try:
        with ThreadPoolExecutor(options.jobs) as pool:
            for done in as_completed([pool.submit(one, plan) for plan in planned]):
                mutant, verdict = done.result()
                results.add(mutant, verdict)
                by = verdict.test or f"{verdict.tests} tests"
                print(f"{verdict.status:9} {verdict.seconds:4.0f} s  {mutant.name}  [{by}]", flush=True)
    finally:
        shutil.rmtree(places, ignore_errors=True)


def _show(survivors: list[Mutant], root: Path) -> None:
    """Prints survivors as changes of the source."""
    for mutant in survivors:
        source = (root / mutant.path).read_bytes()
        before, after = source.decode().splitlines(), mutant.applied(source).decode().splitlines()
        print(
            "\n".join(difflib.unified_diff(before, after, mutant.path, mutant.kind, n=6, lineterm="")), "\n"
        )


def _summary(chosen: list[Mutant], results: _Results) -> int:
    """Prints how many mutants were caught; returns how many survived."""
    counts = Counter(results.status(mutant) or "not tried" for mutant in chosen)
    print(
        ", ".join(f"{count} {status}" for status, count in sorted(counts.items()))
        + f", of {len(chosen)} in all"
    )
    noticed = counts["caught"] + counts["timed out"]
    judged = noticed + counts["survived"] + counts["untested"]
    if judged:
        print(f"{noticed} of {judged} that change something were noticed: {100 * noticed / judged:.1f} %")
    return counts["survived"] + counts["untested"]


if __name__ == "__main__":
    raise SystemExit(main() > 0)
