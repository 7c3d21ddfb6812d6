"""Atomic writes: a file is written beside its destination and renamed when it is complete."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ulna.errors import InputError
from ulna.system.storage import replacing


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
