"""Runs a script on a compatibility package and on the package it stands for, each in its own interpreter."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import ulna
from ulna.compat.packages import FOLDERS, environment


def variables(package: str | None, **others: str) -> dict[str, str]:
    """The variables of a process that imports a compatibility package, or the library it stands for.

    It imports the very Ulna that is under test, whichever one is installed, and nothing else by PYTHONPATH.

    Args:
        package: The compatibility package; None for the library.
        others: Further variables.
    """
    plain = {**os.environ, "PYTHONPATH": str(Path(ulna.__file__).parents[1]), **others}
    return environment([package] if package else [], plain)


def both(script: Path, folder: Path, *arguments: str, package: str = "pinocchio") -> tuple[Any, Any]:
    """What a script writes with Ulna's compatibility package, and what with the original.

    Args:
        script: Called with the file to write its answers to, then `arguments`; it writes {"file": path of the
            package, "answers": anything}, by `json.dumps`, which runs in C (`json.dump` does not).
        folder: For the two files.
        arguments: Further arguments of the script.
        package: Which compatibility package.

    Returns:
        The answers of both.
    """
    answers = []
    for is_ours in (True, False):
        target = folder / f"{'ulna' if is_ours else 'original'}.json"
        command = [sys.executable, str(script), str(target), *arguments]
        chosen = variables(package if is_ours else None)
        done = subprocess.run(command, env=chosen, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        written = json.loads(target.read_text(encoding="utf-8"))
        assert (str(FOLDERS[package]) in written["file"]) == is_ours
        answers.append(written["answers"])
    return answers[0], answers[1]


def printed(lines: str, package: str = "pinocchio") -> tuple[str, str]:
    """What lines of Python print with Ulna's compatibility package, and what with the original.

    Args:
        lines: The lines.
        package: Which compatibility package.

    Returns:
        The output of both.
    """
    own, theirs = (
        subprocess.run(
            [sys.executable, "-c", lines], env=variables(chosen), capture_output=True, text=True, check=True
        )
        for chosen in (package, None)
    )
    return own.stdout, theirs.stdout
