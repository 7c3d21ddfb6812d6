"""Files that are whole or absent, and files that no other user can change."""

from __future__ import annotations

import errno
import os
import re
import stat
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from ulna.errors import MissingFolder

# no links followed; a pipe that stands in a file's place is not waited for
_READING = os.O_RDONLY | sum(getattr(os, name, 0) for name in ("O_NOFOLLOW", "O_NONBLOCK", "O_BINARY"))

_TEMPORARY = re.compile(r"\.ulna-[0-9a-f]{8}(\..*)?", re.DOTALL)
_STALE = 86400.0  # s without a change after which such a file is of a process that ended
_cleaned: set[Path] = set()


@contextmanager
def replacing(target: str | os.PathLike[str]) -> Iterator[Path]:
    """A path to write to, beside `target`, which takes its place at the end; after an error it is removed.

    A reader, and whoever looks after a crash, finds the old file, the new one or none, never a part. So it is after a
    loss of power, too: the content is on the disk (`os.fsync`) before the file gets its name. What a killed process
    left beside is removed by the first write of a process into that folder, a day later or more.

    Raises:
        MissingFolder: There is no folder to write it to.
        OSError: It cannot be written; `target` is as it was.
    """
    place = Path(os.path.realpath(target))
    if place.is_dir():
        raise IsADirectoryError(None, "It is a folder", str(target))
    if place.exists() and not place.is_file():  # a device or a pipe is written to, never replaced
        yield place
        return
    if not place.parent.is_dir():
        given = Path(target).parent
        raise MissingFolder(str(place.parent if given.is_dir() else given), os.fspath(target))
    _remove_stale(place.parent)
    beside = place.with_name(f".ulna-{os.urandom(4).hex()}{place.suffix}")
    try:
        beside.touch()  # before the work that may be long
        yield beside
        _sync(beside)
        if place.exists():
            with suppress(OSError):
                os.chmod(beside, stat.S_IMODE(place.stat().st_mode))
        os.replace(beside, place)
    finally:
        with suppress(OSError):
            beside.unlink(missing_ok=True)


def _sync(path: Path) -> None:
    """Has the content of a file written to the disk, where the file system supports it."""
    descriptor = os.open(path, os.O_RDWR | getattr(os, "O_CLOEXEC", 0))
    try:
        os.fsync(descriptor)
    except OSError as error:
        if error.errno not in (errno.EINVAL, errno.ENOTSUP):
            raise
    finally:
        os.close(descriptor)


def _remove_stale(folder: Path) -> None:
    """Removes files that `replacing` made in a folder and that nothing has written to for a day; once per process."""
    if folder in _cleaned:
        return
    _cleaned.add(folder)
    with suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            if _TEMPORARY.fullmatch(entry.name) is None:
                continue
            with suppress(OSError):
                status = entry.stat(follow_symlinks=False)
                if stat.S_ISREG(status.st_mode) and time.time() - status.st_mtime > _STALE:
                    os.unlink(entry.path)


def save_figure(figure: Any, path: Any) -> None:
    """Writes a figure of Matplotlib to a file, atomically, or to an open one.

    Args:
        figure: The figure.
        path: The path, or an open file.
    """
    if not isinstance(path, str | os.PathLike):
        figure.savefig(path)
        return
    target = Path(path)
    if not target.suffix:  # as Matplotlib completes names
        target = Path(f"{target}.{figure.canvas.get_default_filetype()}")
    with replacing(target) as place:
        figure.savefig(place)


def is_private(status: os.stat_result) -> bool:
    """Whether a file or folder belongs to this user, and nobody else may write to it."""
    if not hasattr(os, "getuid"):  # Windows: the profile folder's access list guards it
        return True
    return status.st_uid == os.getuid() and not status.st_mode & (stat.S_IWGRP | stat.S_IWOTH)


def read_private(path: Path, most: int = -1) -> bytes | None:
    """The content of a regular file that only this user can change.

    Args:
        path: The file.
        most: The largest number of bytes that are read; -1 for all.

    Returns:
        The bytes; None where there is no such file.
    """
    try:
        return _read(path, most)
    except OSError:
        return None


def _read(path: Path, most: int) -> bytes | None:
    """The content of a regular file that only this user can change; None where it is another file, or none at all.

    Raises:
        OSError: It cannot be read.
    """
    try:
        descriptor = os.open(path, _READING)
    except OSError as error:
        if error.errno in (errno.ENOENT, errno.ELOOP, errno.ENXIO):  # none, a link, a socket
            return None
        raise
    with os.fdopen(descriptor, "rb") as file:
        status = os.fstat(descriptor)
        return file.read(most) if stat.S_ISREG(status.st_mode) and is_private(status) else None


def write_private(path: Path, content: bytes, keep: bool = False) -> None:
    """Writes a file that only this user can read.

    Args:
        path: The file.
        content: Its bytes.
        keep: Whether a file that is there already stays.

    Raises:
        OSError: It cannot be written; what was there is as it was.
    """
    import tempfile  # slow to import, and needed only here

    descriptor, beside = tempfile.mkstemp(dir=path.parent, prefix="new-")
    try:
        with os.fdopen(descriptor, "wb") as file:
            file.write(content)
        if keep and hasattr(os, "link"):
            with suppress(FileExistsError):
                os.link(beside, path)  # atomic, and fails where another process was first
        else:
            os.replace(beside, path)
    finally:
        with suppress(OSError):
            os.unlink(beside)


def secret(folders: list[Path], name: str, size: int = 32) -> bytes | None:
    """This user's random key, from the first folder that can keep it; made at first use, and anew when damaged.

    Processes that make it at the same time all get the one that was there first.

    Args:
        folders: Where it may be stored, in order of preference.
        name: Its file name.
        size: Its length in bytes.

    Returns:
        The key; None where no folder can store it.
    """
    for folder in folders:
        try:
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            if not is_private(os.lstat(folder)):
                continue
            path = folder / name
            for keep in (True, False, None):  # what is damaged is replaced; what cannot be read now is not
                content = _read(path, size + 1)
                if content is not None and len(content) == size:
                    return content
                if keep is not None:
                    write_private(path, os.urandom(size), keep)
        except OSError:
            continue
    return None
