"""A folder that is written atomically, and that replaces only a folder that was written by an export."""

from __future__ import annotations

import json
import os
import secrets
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ulna.errors import InputError
from ulna.files import read_regular

MANIFEST = "ulna_export.json"
"""The file that lists what was written."""


@contextmanager
def atomic_folder(path: str | os.PathLike[str], about: dict[str, Any]) -> Iterator[Path]:
    """An empty folder to write to, beside `path`, which takes its place at the end; after an error it is removed.

    A folder that is there is replaced if it is empty, or has nothing but the files of an earlier export.

    Args:
        path: The folder.
        about: What the list of files says beside their names.

    Yields:
        The folder to write to.

    Raises:
        InputError: `path` is a file, or a folder with other files.
        OSError: It cannot be written; what is at `path` is as it was.
    """
    place = Path(os.path.realpath(path))
    check_replaceable(place)
    place.parent.mkdir(parents=True, exist_ok=True)
    beside = place.with_name(f".ulna-{secrets.token_hex(4)}")
    former = beside.with_name(beside.name + ".former")
    try:
        beside.mkdir()
        yield beside
        listed = sorted(p.relative_to(beside).as_posix() for p in beside.rglob("*") if p.is_file())
        text = json.dumps({**about, "files": [*listed, MANIFEST]}, indent=2)
        (beside / MANIFEST).write_text(text + "\n", encoding="utf-8")
        check_replaceable(place)
        if place.exists():
            os.replace(place, former)
        try:
            os.replace(beside, place)
        except BaseException:
            if former.exists():
                os.replace(former, place)
            raise
    finally:
        shutil.rmtree(beside, ignore_errors=True)
        if place.exists():
            shutil.rmtree(former, ignore_errors=True)


def check_replaceable(place: Path) -> None:
    """Refuses a place that holds anything but an earlier export.

    Args:
        place: A path.

    Raises:
        InputError: It is a file, or a folder with files that no export wrote.
    """
    if not place.exists():
        return
    if not place.is_dir():
        raise InputError(f"`path` {str(place)!r} is a file; expected a folder, or a name for a new one.")
    listed = _listed(place)
    other = [p for p in sorted(place.rglob("*")) if p.is_file() or p.is_symlink()]
    names = [p.relative_to(place).as_posix() for p in other]
    foreign = [name for name in names if name not in listed]
    if foreign:
        raise InputError(
            f"The folder {str(place)!r} has {foreign[0]!r}, which no export wrote, and would be replaced as a whole. "
            "Name another folder, such as one inside it."
        )


def _listed(place: Path) -> set[str]:
    """The files that an earlier export wrote into a folder."""
    try:
        content = json.loads(read_regular(place / MANIFEST, 2**22))
        return {name for name in content["files"] if isinstance(name, str)}
    except (OSError, ValueError, LookupError, TypeError):
        return set()
