"""Runs a script on a face and on the package it stands for, each in a Python of its own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

from ulna.compat.packages import FOLDERS, environment


def both(script: Path, folder: Path, *words: str, shelf: str = "pinocchio") -> tuple[Any, Any]:
    """What a script answers on the face, and what on the real package.

    Args:
        script: Called with the file to write its answers to, then `words`; it writes {"file": where the package
            lies, "answers": anything}.
        folder: For the two files.
        words: What else the script is given.
        shelf: Where the face lies.
    """
    plain = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    found = []
    for faced, variables in ((True, environment([shelf], plain)), (False, plain)):
        target = folder / f"{'face' if faced else 'real'}.json"
        command = [sys.executable, str(script), str(target), *words]
        done = subprocess.run(command, env=variables, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        told = json.loads(target.read_text(encoding="utf-8"))
        assert (str(FOLDERS[shelf]) in told["file"]) == faced
        found.append(told["answers"])
    return found[0], found[1]
