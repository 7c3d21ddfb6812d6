"""xacro files -> URDF text, through the package `xacro` (the extra "xacro")."""

from __future__ import annotations

import io
import os
import re
import warnings
from collections.abc import Mapping
from functools import partial
from typing import Any, TextIO

from ulna.errors import FormatError, ModelWarning, nearest, needed
from ulna.files import open_regular
from ulna.formats.markup import read_file
from ulna.formats.resolve import Resolver
from ulna.system import forks
from ulna.system.callers import level_of_caller

_EXPANDING = forks.lock()
"""The package keeps its state in module globals; one expansion at a time."""


def expand_xacro(
    path: str | os.PathLike[str],
    arguments: Mapping[str, str] | None = None,
    resolver: Resolver | None = None,
) -> str:
    """The URDF text of a xacro file.

    A xacro file is a program: it evaluates Python expressions and reads other files. Expand only what you
    trust.

    Args:
        path: the file.
        arguments: values for its xacro:arg elements.
        resolver: finds the packages of `$(find name)`; by default around the file and in the ROS environment.

    Returns:
        The URDF text. Values for arguments that the file does not ask for have no effect; a warning (ModelWarning)
        names them.

    Raises:
        MissingExtra: the package xacro is not installed.
        FormatError: the file is missing, or does not expand.
    """
    read_file(path)
    file = str(path)
    with needed("xacro", "xacro", f"Expanding {file!r}"):
        import xacro as library
        from xacro import substitution_args
    xacro: Any = library
    find = partial(_folder_of_package, resolver or Resolver(path), file)
    given = {name: str(value) for name, value in (arguments or {}).items()}
    mappings = _Arguments(given)
    with _EXPANDING:
        original = substitution_args._eval_find
        # Its own search needs a ROS 2 installation. Ours also knows the folders above the file.
        substitution_args._eval_find = find
        xacro.open = _open_text  # its includes and tables
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", DeprecationWarning)
                document: Any = xacro.process_file(file, mappings=mappings)
        except FormatError:
            raise
        except Exception as error:  # the package raises whatever its parts raise
            raise _refusal(error, file) from error
        finally:
            substitution_args._eval_find = original
            del xacro.open
    _warn_of_unused(given, mappings.asked, file)
    return document.toxml()


class _Arguments(dict[str, str]):
    """Values of arguments, which notes what is asked for."""

    def __init__(self, values: Mapping[str, str]) -> None:
        super().__init__(values)
        self.asked: set[str] = set()

    def __contains__(self, name: object) -> bool:
        self.asked.add(str(name))
        return super().__contains__(name)

    def __getitem__(self, name: str) -> str:
        self.asked.add(name)
        return super().__getitem__(name)


def _warn_of_unused(given: Mapping[str, str], asked: set[str], file: str) -> None:
    """Warns (ModelWarning) of values for arguments that a file did not ask for."""
    for name in given:
        if name not in asked:
            meant = nearest(name, asked - set(given), 1)
            hint = (
                f"Did you mean {meant[0]!r}?"
                if meant
                else f"It asks for: {', '.join(sorted(asked)) or 'none'}."
            )
            warnings.warn(
                f"{file}: `xacro_args` has {name!r}, which the file does not ask for; it has no effect. {hint}",
                ModelWarning,
                stacklevel=level_of_caller(),
            )


def _folder_of_package(packages: Resolver, file: str, name: str) -> str:
    folder = packages.find_package(name)
    if folder is None:
        raise FormatError(
            f"there is no package {name!r} for $(find {name}).",
            file=file,
            fix="Set ROS_PACKAGE_PATH, or pass package_dirs=[folder of the packages].",
        )
    return folder


def _open_text(path: str) -> TextIO:
    """As `open(path)`, for regular files only."""
    return io.TextIOWrapper(open_regular(path))


def _refusal(error: Exception, file: str) -> FormatError:
    cause = error
    while isinstance(getattr(cause, "exc", None), Exception):
        cause = cause.exc  # type: ignore[attr-defined]
    if isinstance(cause, FormatError):
        return cause
    text = " ".join(str(error).split()).rstrip(".") or type(error).__name__
    line = re.search(r"line (\d{1,9})", text)
    fix = ""
    if "undefined substitution argument" in text.lower():
        fix = "Pass its value: xacro_args={'name': 'value'}."
    return FormatError(
        f"xacro does not expand it: {text}.", file=file, line=int(line.group(1)) if line else None, fix=fix
    )
