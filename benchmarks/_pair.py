"""Workers in separate Python processes that take turns, so that a drifting machine hits all alike."""

from __future__ import annotations

import json
import os
import statistics
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence


def environments(library: str) -> tuple[dict[str, str], dict[str, str]]:
    """The variables of a worker that imports a compatibility package, and of one that imports the library itself.

    Both import the Ulna that this process imports: PYTHONPATH is passed on, without folders of compatibility packages.

    Args:
        library: Its name in `ulna.compat.packages.FOLDERS`.
    """
    from ulna.compat.packages import FOLDERS, environment  # not in workers of the library itself

    path = os.environ.get("PYTHONPATH", "").split(os.pathsep)
    folders = {os.path.realpath(folder) for folder in FOLDERS.values()}
    rest = [entry for entry in path if entry and os.path.realpath(entry) not in folders]
    plain = {**os.environ, "PYTHONPATH": os.pathsep.join(rest)}
    return environment([library], plain), plain


def in_turns(
    command: Sequence[str], environments: Mapping[str, Mapping[str, str]], rounds: int
) -> dict[str, dict[str, float]]:
    """Medians of what each worker answers: `{who: {title: value}}`.

    Args:
        command: A script of the benchmarks and its words, run once in each environment; it calls `answer_rounds`.
        environments: The variables of each worker.
        rounds: How often each is asked.
    """
    running = {
        who: subprocess.Popen(
            [sys.executable, *command],
            env=dict(env),
            text=True,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
        )
        for who, env in environments.items()
    }
    found: dict[str, list[dict[str, float]]] = {who: [] for who in running}
    for _ in range(rounds):
        for who, process in running.items():
            assert process.stdin is not None and process.stdout is not None
            process.stdin.write("\n")
            process.stdin.flush()
            line = process.stdout.readline()
            if not line:
                raise SystemExit(f"The worker {who!r} ended with {process.wait()}.")
            found[who].append(json.loads(line))
    for process in running.values():
        process.communicate()
    return {
        who: {title: statistics.median(a[title] for a in answers) for title in answers[0]}
        for who, answers in found.items()
    }


def answer_rounds(prepare: Callable[[], Callable[[], Mapping[str, float]]]) -> None:
    """Answers each line of standard input with what is measured, until there are no more.

    What `prepare`, or a library, prints goes to standard error.
    """
    out = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    measure = prepare()
    for _ in sys.stdin:
        print(json.dumps(measure()), file=out, flush=True)
