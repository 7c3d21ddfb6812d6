"""Runs a script with compatibility packages in place of the libraries it imports, in a new process."""

from __future__ import annotations

import itertools
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from ulna.checks.former_names import former_keywords
from ulna.compat.packages import FOLDERS, environment, library_of
from ulna.errors import InputError


@former_keywords(words="arguments")
def run(arguments: Sequence[str], only: Sequence[str] = ()) -> int:
    """Runs `python arguments...` with compatibility packages on the path.

    The script is `__main__` of a fresh Python: arguments, tracebacks, pickling and spawned children behave as ever.
    Where the system can, this process becomes that Python, so that signals reach it and no second process waits.

    Args:
        arguments: What would follow `python`: its options, then a script, `-m` and a module, `-c` and a program, or
            `-`; and arguments, which are passed on as they are.
        only: Compatibility packages to put on the path; all when empty.

    Returns:
        The exit code, where this process does not become the other one.

    Raises:
        InputError: If there is no such script, or an option of Python would hide the packages.
        UnknownName: If there is no such compatibility package.
    """
    _check(arguments)
    libraries = list(dict.fromkeys(library_of(name) for name in only)) or list(FOLDERS)
    variables = environment(libraries)
    command = [sys.executable, *arguments]
    if os.name == "posix":
        sys.stdout.flush()
        sys.stderr.flush()
        os.execve(sys.executable, command, variables)
    return subprocess.run(command, env=variables, check=False).returncode


def split(arguments: Sequence[str]) -> tuple[list[str], list[str]]:
    """Separates the options of `ulna run` from what would follow `python`.

    argparse cannot do this: it would parse `-m`, `-c` and options of the script, too.
    """
    options, rest = [], list(arguments)
    while rest:
        name, value, _ = rest[0].partition("=")
        if rest[0] == "--":
            return options, rest[1:]
        if rest[0] not in ("-h", "--help") and not (len(name) > 2 and "--only".startswith(name)):
            break
        options.append(rest.pop(0))
        if name not in ("-h", "--help") and not value and rest:
            options.append(rest.pop(0))
    return options, rest


def _check(arguments: Sequence[str]) -> None:
    """Checks that Python can run the arguments, and with the compatibility packages.

    Raises:
        InputError: See `run`.
    """
    for k, argument in enumerate(arguments):
        if k and arguments[k - 1] in ("-W", "-X", "--check-hash-based-pycs"):
            continue  # the value of that option
        if not argument.startswith("-"):
            if not Path(argument).exists():
                raise InputError(
                    f"There is no file {argument!r}. Expected: ulna run script.py, ulna run -m module, "
                    "ulna run -c 'code', or ulna run - for a program from the standard input."
                )
            return
        if argument.startswith("--"):
            continue
        letters = list(itertools.takewhile(lambda letter: letter not in "mcWX", argument[1:]))
        hiding = next((letter for letter in letters if letter in "EI"), "")
        if hiding:
            raise InputError(
                f"`ulna run {argument}`: -{hiding} makes Python ignore PYTHONPATH, by which it finds Ulna's packages. "
                "Leave it out."
            )
        if argument == "-" or argument[1 + len(letters) : 2 + len(letters)] in ("m", "c"):
            return
    raise InputError(
        "`ulna run` needs a program: ulna run script.py, ulna run -m module or ulna run -c 'code'."
    )
