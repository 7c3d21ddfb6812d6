"""Checks of paths of files."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ulna.checks.values import short_repr
from ulna.errors import InputError, UnknownName


def checked_path(value: Any, what: str, suffixes: Sequence[str], name: str = "path") -> Path:
    """The path of a file with one of some suffixes.

    Args:
        value: What was passed.
        what: What kind of file it is, for messages.
        suffixes: Suffixes that it may have, such as ".png".
        name: The name of the argument, for messages.

    Returns:
        The path.

    Raises:
        InputError: It is no path.
        UnknownName: It ends otherwise.
    """
    if not isinstance(value, str | os.PathLike) or not isinstance(os.fspath(value), str):
        raise InputError(
            f"`{name}` is {short_repr(value)}; expected the path of a {what} ({', '.join(suffixes)})."
        )
    target = Path(value)
    if target.suffix.lower() not in suffixes:
        raise UnknownName(f"kind of {what}", target.suffix, suffixes, f"The path is {str(value)!r}.")
    return target
