"""Atomic writes: a file is written beside its destination and renamed when it is complete."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ulna.checks.values import short_repr
from ulna.errors import InputError, UnknownName
from ulna.system.storage import replacing


def checked_path(path: Any, what: str, suffixes: Sequence[str]) -> Path:
    """The path of a file with one of some suffixes.

    Args:
        path: What was passed.
        what: What kind of file it is, for messages.
        suffixes: Suffixes that it may have, such as ".png".

    Returns:
        The path.

    Raises:
        InputError: It is no path.
        UnknownName: It ends otherwise.
    """
    if not isinstance(path, str | os.PathLike) or not isinstance(os.fspath(path), str):
        raise InputError(
            f"`path` is {short_repr(path)}; expected the path of a {what} ({', '.join(suffixes)})."
        )
    target = Path(path)
    if target.suffix.lower() not in suffixes:
        raise UnknownName(f"kind of {what}", target.suffix, suffixes, f"The path is {str(path)!r}.")
    return target


@contextmanager
def atomic_write(target: Path, what: str) -> Iterator[Path]:
    """A temporary path to write to; it is renamed to `target` at the end, or removed if writing fails.

    Args:
        target: The path of the file; folders that are missing are made.
        what: What kind of file it is, for messages.

    Yields:
        The temporary path.

    Raises:
        InputError: The file cannot be written.
    """
    try:
        Path(os.path.realpath(target)).parent.mkdir(parents=True, exist_ok=True)
        with replacing(target) as temporary:
            yield temporary
    except OSError as error:
        raise InputError(f"Cannot write the {what} {str(target)!r}: {error.strerror or error}.") from error
