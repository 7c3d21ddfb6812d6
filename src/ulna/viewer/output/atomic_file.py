"""Files that are there whole or not at all: each is written beside its place, and takes it when all went well."""

from __future__ import annotations

import os
import secrets
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from ulna.checks.values import short_repr
from ulna.errors import InputError, UnknownName


def checked_path(path: Any, what: str, suffixes: Sequence[str]) -> Path:
    """The path of a file of one of some kinds, told by how its name ends.

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
    """A path to write to, which becomes `target` at the end, with the folders that it needs; nothing when that fails.

    Raises:
        InputError: It cannot be written.
    """
    place = Path(os.path.realpath(target))
    beside = place.with_name(f".{secrets.token_hex(4)}{place.suffix}")
    try:
        try:
            place.parent.mkdir(parents=True, exist_ok=True)
            if place.is_dir():
                raise IsADirectoryError(None, "It is a folder")
            beside.touch()  # before the work that may be long
            yield beside
            os.replace(beside, place)
        finally:
            with suppress(OSError):
                beside.unlink(missing_ok=True)
    except OSError as error:
        raise InputError(f"Cannot write the {what} {str(target)!r}: {error.strerror or error}.") from error
