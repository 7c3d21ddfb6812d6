"""Runs a script with the faces before the packages they stand for, in a Python of its own."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from ulna.errors import InputError
from ulna.faces.shelves import SHELVES, environment, shelf_of


def run(words: Sequence[str], only: Sequence[str] = ()) -> int:
    """Runs `python words...` with faces on the path; returns its exit code.

    The script is `__main__` of a fresh Python: arguments, tracebacks, pickling and spawned children behave as ever.
    Where the system can, this process becomes that Python, so that signals reach it and no second process waits.

    Args:
        words: What would follow `python`: a script and its arguments, or `-m` and a module.
        only: Faces to put on the path; all when empty.

    Raises:
        InputError: If there is no such script.
        UnknownName: If there is no such face.
    """
    if not words:
        raise InputError("`ulna run` needs a script: ulna run script.py.")
    if not words[0].startswith("-") and not Path(words[0]).is_file():
        raise InputError(
            f"There is no file {words[0]!r}. Expected: ulna run script.py, or ulna run -m module."
        )
    shelves = list(dict.fromkeys(shelf_of(name) for name in only)) or list(SHELVES)
    variables = environment(shelves)
    command = [sys.executable, *words]
    if os.name == "posix":
        sys.stdout.flush()
        sys.stderr.flush()
        os.execve(sys.executable, command, variables)
    return subprocess.run(command, env=variables, check=False).returncode
