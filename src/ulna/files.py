"""Reading the files that users name: only regular files, because a pipe or a device may never end."""

from __future__ import annotations

import errno
import os
import stat
from typing import BinaryIO

_KINDS = (
    (stat.S_ISFIFO, "a pipe (FIFO)"),
    (stat.S_ISSOCK, "a socket"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
)

_ADVICE = "only regular files are read; save what it delivers to a file and name that"


def special_kind(path: str | os.PathLike[str]) -> str:
    """What kind of special file a path leads to ("a pipe (FIFO)", ...); "" for regular files, folders and nothing."""
    try:
        return _kind(os.stat(path).st_mode)
    except (OSError, ValueError):  # ValueError: a name with a null character
        return ""


def reject_special_files(path: str | os.PathLike[str]) -> None:
    """Refuse a path that leads to a pipe, a socket or a device; any other path passes, also one to nothing.

    Raises:
        OSError: it leads to such a file; `strerror` says so.
    """
    kind = special_kind(path)
    if kind:
        raise _refusal(kind, path)


def open_regular(path: str | os.PathLike[str]) -> BinaryIO:
    """A regular file, open for reading bytes. It never waits for another process to write.

    Raises:
        OSError: there is no such file, it may not be read, or it is a folder, a pipe, a socket or a device.
    """
    reject_special_files(path)  # before opening, which has effects on some devices
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    descriptor = os.open(path, flags | getattr(os, "O_CLOEXEC", 0))
    try:
        mode = os.fstat(descriptor).st_mode  # another file may have taken its place since
        if stat.S_ISDIR(mode):
            raise IsADirectoryError(errno.EISDIR, "it is a folder", os.fspath(path))
        if _kind(mode):
            raise _refusal(_kind(mode), path)
    except BaseException:
        os.close(descriptor)
        raise
    return os.fdopen(descriptor, "rb")


def read_regular(path: str | os.PathLike[str], most: int = -1) -> bytes:
    """The content of a regular file.

    Args:
        path: The file.
        most: The largest number of bytes that are read; -1 for all.

    Returns:
        The bytes.

    Raises:
        OSError: as for `open_regular`.
    """
    with open_regular(path) as file:
        return file.read(most)


def _kind(mode: int) -> str:
    return next((words for is_kind, words in _KINDS if is_kind(mode)), "")


def _refusal(kind: str, path: str | os.PathLike[str]) -> OSError:
    advice = _ADVICE
    if os.fspath(path) in ("/dev/stdin", "/dev/fd/0", "/proc/self/fd/0"):
        advice += ", or pass the text: ulna.load(sys.stdin.read())"
    return OSError(errno.EINVAL, f"it is {kind}, and {advice}", os.fspath(path))
