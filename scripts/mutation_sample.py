#!/usr/bin/env python
"""How good the tests are: tries random small changes of `src/` and counts which of them the tests notice.

    scripts/mutation_sample.py --map tests/unit --jobs 2   # once: which tests call which function
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
import time
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
        "--limit", type=float, default=300.0, help="seconds a round may take beyond the time the map expects"
    )
    parser.add_argument("--minutes", type=float, default=float("inf"), help="begin no mutant after that time")
    parser.add_argument(
        "--map", nargs="+", metavar="TESTS", help="run these tests (`--jobs` at a time) for the map"
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
        with _Trial(results, root, folder, options) as trials:
            while left and not trials.over:
                trials.run(left)
                left = trials.refuted(chosen)
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

    def unconfirmed(self, mutant: Mutant) -> str:
        """The test that caught a mutant where it was not yet tried without; empty for others."""
        verdict = self._all.get(mutant.key, {})
        return "" if verdict.get("confirmed", True) else verdict["test"]

    def confirm(self, mutant: Mutant) -> None:
        """Notes that the test that caught a mutant passes without it."""
        self.add(mutant, trial.Verdict(**self._all[mutant.key] | {"confirmed": True}))

    def forget(self, mutant: Mutant) -> None:
        """Takes a verdict back."""
        self._all = {key: verdict for key, verdict in self._read().items() if key != mutant.key}
        self._write()

    def add(self, mutant: Mutant, verdict: trial.Verdict) -> None:
        """Notes a verdict and writes the file."""
        self._all = self._read() | {mutant.key: asdict(verdict)}  # another run may have added some
        self._write()

    def _write(self) -> None:
        self._path.parent.mkdir(parents=True, exist_ok=True)
        beside = self._path.with_suffix(".new")
        beside.write_text(json.dumps(self._all, indent=1))
        beside.replace(self._path)


def _equivalent(file: Path) -> set[tuple[str, str]]:
    """The file and change of each mutant that is known to change nothing: lines `path | change | reason`."""
    rows = [line.split(" | ") for line in file.read_text().splitlines() if line and not line.startswith("#")]
    return {(path, change) for path, change, _ in rows}


class _Trial:
    """Tries mutants, `--jobs` at a time, each in a sandbox."""

    def __init__(self, results: _Results, root: Path, folder: Path, options: argparse.Namespace) -> None:
        self._results, self._root, self._options = results, root, options
        self._covered, self._judge = coverage_map.CoverageMap(root, folder), trial.Judge()
        self._places = Path(tempfile.mkdtemp(prefix="mutation-"))
        self._free: queue.SimpleQueue[trial.Sandbox] = queue.SimpleQueue()
        unsound: set[str] = set()
        for job in range(options.jobs):
            place = self._places / str(job)
            self._free.put(trial.Sandbox(root, place, *trial.user_cache(), unsound, options.limit))
        self._end = time.monotonic() + 60 * options.minutes

    def __enter__(self) -> _Trial:
        return self

    def __exit__(self, *_: object) -> None:
        shutil.rmtree(self._places, ignore_errors=True)

    @property
    def over(self) -> bool:
        """Whether no further mutant is to be begun."""
        return time.monotonic() > self._end

    def run(self, chosen: list[Mutant]) -> None:
        """Tries mutants and prints a line for each."""
        with ThreadPoolExecutor(self._options.jobs) as pool:
            for done in as_completed([pool.submit(self._verdict, mutant) for mutant in chosen]):
                mutant, verdict = done.result()
                if verdict is None:
                    continue
                self._results.add(mutant, verdict)
                by = verdict.test or f"{verdict.tests} tests"
                print(f"{verdict.status:9} {verdict.seconds:4.0f} s  {mutant.name}  [{by}]", flush=True)

    def refuted(self, chosen: list[Mutant]) -> list[Mutant]:
        """The mutants whose test fails without them, too; the verdict on the others is confirmed."""
        waiting = {mutant: test for mutant in chosen if (test := self._results.unconfirmed(mutant))}
        sandbox = self._free.get()
        failing = self._judge.refuted(sorted(set(waiting.values())), sandbox, self._covered.seconds)
        self._free.put(sandbox)
        for mutant, test in waiting.items():
            if test in failing:
                self._results.forget(mutant)
            else:
                self._results.confirm(mutant)
        return [mutant for mutant, test in waiting.items() if test in failing]

    def _verdict(self, mutant: Mutant) -> tuple[Mutant, trial.Verdict | None]:
        if self.over:
            return mutant, None
        tests = self._options.tests
        rounds = [tests] if tests else choice.stages(mutant, self._covered, self._root, self._options.budget)
        sandbox = self._free.get()
        try:
            return mutant, self._judge.verdict(mutant, rounds, sandbox, self._covered.seconds)
        finally:
            self._free.put(sandbox)


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
