"""Runs programs written for Pinocchio without a screen, on the package and on Pinocchio, and says how each ended.

`python client_programs.py FOLDER [--steps N] [--seconds S]` runs every program of a folder on both, prints a table, and fails
where one ends on Pinocchio and not on the package. Loops that wait with `time.sleep` or loop_rate_limiters end after so many
steps, questions are answered by an empty line, no browser is opened, and matplotlib draws into memory.
"""

from __future__ import annotations

import argparse
import builtins
import os
import runpy
import signal
import subprocess
import sys
import threading
import time
import webbrowser
from collections.abc import Iterator
from pathlib import Path
from types import FrameType
from typing import Any, NoReturn

sys.path.insert(0, str(Path(__file__).parents[2]))

from support.two_pythons import variables

_LIBRARIES = ("site-packages", "ulna", "lib/python")
"""Parts of the paths of files that wait for separate servers, not for a loop of the program."""


class Enough(BaseException):
    """A program has run for as many steps, or as long, as it was given."""


def limited(steps: int) -> Iterator[None]:
    """Counts the steps of a loop; raises Enough after the last."""
    for _ in range(steps):
        yield
    raise Enough


def without_a_screen(steps: int) -> None:
    """Replaces what waits for time or for a person."""
    count, sleep = limited(steps), time.sleep

    def step(*_: Any, **__: Any) -> str:
        next(count)
        return ""

    def wait(seconds: float) -> None:
        caller = sys._getframe(1).f_code.co_filename
        in_program = threading.current_thread() is threading.main_thread()
        if in_program and not any(part in caller for part in _LIBRARIES):
            step()
        else:
            sleep(seconds)

    time.sleep, builtins.input = wait, step
    webbrowser.open = lambda *_, **__: False
    try:
        from loop_rate_limiters import RateLimiter
    except ImportError:
        return
    RateLimiter.sleep = step


def run(program: Path, steps: int, seconds: float) -> None:
    """Runs a program in this process; prints "ended" as its last line unless it raised.

    Args:
        program: The file.
        steps: After how many steps its loop ends.
        seconds: After how long it ends [s].
    """

    def stop(_: int, __: FrameType | None) -> NoReturn:
        raise Enough

    signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    sys.argv = [str(program)]
    sys.path.insert(0, str(program.parent))
    os.chdir(program.parent)
    without_a_screen(steps)
    try:
        runpy.run_path(str(program), run_name="__main__")
    except Enough:
        pass
    except SystemExit as end:
        if end.code:
            raise
    print("\nended", flush=True)
    os._exit(0)  # servers and viewers of the program do not keep it


def outcome(program: Path, real: bool, steps: int = 30, seconds: float = 60.0) -> str:
    """How a program ends: "" where it does, else the last line of what it raised.

    Args:
        program: The file.
        real: Whether `pinocchio` is the real one.
        steps: After how many steps its loop ends.
        seconds: After how long it ends [s].
    """
    words = [str(program), "--here", "--steps", str(steps), "--seconds", str(seconds)]
    done = subprocess.run(
        [sys.executable, __file__, *words],
        env=variables(None if real else "pinocchio", MPLBACKEND="Agg", ULNA_HEADLESS="1"),
        stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False, timeout=10 * seconds + 60,
    )  # fmt: skip
    if done.stdout.rstrip().endswith("ended"):
        return ""
    lines = [line for line in done.stderr.splitlines() if line.strip() and not line.startswith(" ")]
    return lines[-1] if lines else f"exit status {done.returncode}"


def main() -> None:
    """Runs the programs of a folder on both packages."""
    parser = argparse.ArgumentParser()
    parser.add_argument("programs", type=Path)
    parser.add_argument("--here", action="store_true", help="run one program in this process")
    parser.add_argument("--steps", type=int, default=30)
    parser.add_argument("--seconds", type=float, default=60.0)
    args = parser.parse_args()
    if args.here:
        run(args.programs.absolute(), args.steps, args.seconds)
    folder = args.programs.absolute()
    both = wrong = 0
    for program in sorted(folder.rglob("*.py")) if folder.is_dir() else [folder]:
        theirs, own = (outcome(program, real, args.steps, args.seconds) for real in (True, False))
        both, wrong = both + (not theirs and not own), wrong + (not theirs and bool(own))
        print(
            f"{program.name:50} Pinocchio: {theirs[:60] or 'ended':62} package: {own[:90] or 'ended'}",
            flush=True,
        )
    print(f"{both} end on both, {wrong} on Pinocchio alone.")
    sys.exit(wrong > 0)


if __name__ == "__main__":
    main()
