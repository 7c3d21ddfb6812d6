"""Keeps compiled kernels on disk: content-addressed, verified before use, private to the user.

The key of an entry is the hash of everything that decides its bytes (IR, LLVM version, processor, options), so a
stale entry is never found. An entry carries a hash of its name and content under a random key of this user, is written
beside its place and renamed, and is read only from a folder that nobody else can write. Whatever goes wrong costs a
compilation, never a wrong result.

The folder is `$ULNA_CACHE`, else the platform's cache folder; `ULNA_CACHE=0` turns the cache off.
"""

from __future__ import annotations

import contextlib
import hashlib
import hmac
import os
import stat
import time
import warnings
from pathlib import Path

from ulna.errors import CacheWarning
from ulna.system import storage
from ulna.system.folders import cache_folder, expanded, state_folder

_MAGIC = b"ulna kernel 3\n"
_LIMIT = 512 * 2**20  # bytes the folder may hold before the entries unused for longest go
_warned: set[str] = set()


def folder() -> Path | None:
    """The cache folder, or None where the cache is off."""
    chosen = os.environ.get("ULNA_CACHE", "")
    if chosen == "0":
        return None
    chosen = chosen or cache_folder()
    try:
        return expanded(chosen)
    except RuntimeError:  # a user without a home, as in some containers
        _warn(
            f"The kernel cache {chosen} cannot be found, because this user has no home folder; kernels are compiled "
            "anew in each process. Set ULNA_CACHE to a folder you can write, or to 0 for none."
        )
        return None


def key(*parts: str | bytes) -> str:
    """The name of the entry that `parts` decide."""
    h = hashlib.sha256()
    for part in parts:
        data = part.encode() if isinstance(part, str) else part
        h.update(len(data).to_bytes(8, "little") + data)
    return h.hexdigest()


def read(name: str) -> bytes | None:
    """The content of an entry, or None where there is none that can be trusted."""
    place = _usable()
    if place is None:
        return None
    path, secret = place / name, _secret(place)
    data = storage.read_private(path)
    if data is None or secret is None:
        return None
    head = len(_MAGIC) + 32
    content = data[head:]
    if data[: len(_MAGIC)] != _MAGIC or not hmac.compare_digest(
        data[len(_MAGIC) : head], _seal(secret, name, content)
    ):
        with contextlib.suppress(OSError):  # damaged: remove it, so that a sound one is written
            path.unlink()
        return None
    with contextlib.suppress(OSError):
        os.utime(path)
    return content


def write(name: str, content: bytes) -> None:
    """Stores an entry; a failure warns once and has no further effect.

    Args:
        name: Its file name.
        content: Its bytes.
    """
    place = _usable()
    if place is None:
        return
    try:
        secret = _secret(place)
        if secret is None:
            raise OSError(None, "its key can be neither read nor made")
        storage.write_private(place / name, _MAGIC + _seal(secret, name, content) + content)
        if hash(content) % 64 == 0:
            prune(place)
    except OSError as error:
        _warn(f"The kernel cache {place} cannot be written ({error.strerror or error}); kernels are compiled anew in "
              "each process. Make it writable, or set ULNA_CACHE to another one, or to 0 for none.")  # fmt: skip


def _seal(secret: bytes, name: str, content: bytes) -> bytes:
    """What an entry must carry to be believed: content under a wrong name is as bad as damaged content."""
    return hashlib.blake2b(name.encode() + content, key=secret, digest_size=32).digest()


def _secret(place: Path) -> bytes | None:
    """The user's key of seals: in the folder for state, or in the cache folder where there is no such folder."""
    folders = [place]
    with contextlib.suppress(RuntimeError):
        folders.insert(0, expanded(state_folder()))
    return storage.secret(folders, "cache-key")


def clear() -> int:
    """Removes every entry; returns how many."""
    place = folder()
    count = 0
    if place is not None and place.is_dir():
        for path in entries(place):
            with contextlib.suppress(OSError):
                path.unlink()
                count += 1
    return count


def entries(place: Path) -> list[Path]:
    """The files of a cache folder that are ours: entries and abandoned temporary files."""
    names = (p for p in place.iterdir() if p.is_file() and not p.is_symlink())
    return sorted(p for p in names if p.name.startswith("new-") or (len(p.name) == 64 and p.suffix == ""))


def prune(place: Path, limit: int = _LIMIT) -> None:
    """Removes the entries unused for longest until the folder is small enough.

    Args:
        place: The folder.
        limit: The largest number of bytes that stay.
    """
    files = []
    for path in entries(place):
        with contextlib.suppress(OSError):
            status = path.stat()
            if path.name.startswith("new-") and status.st_mtime < time.time() - 3600:
                path.unlink()
            else:
                files.append((status.st_mtime, status.st_size, path))
    total = sum(size for _, size, _ in files)
    for _, size, path in sorted(files):
        if total <= limit:
            break
        with contextlib.suppress(OSError):
            path.unlink()
            total -= size


def _usable() -> Path | None:
    """The folder, made if need be, if it belongs to this user alone."""
    place = folder()
    if place is None:
        return None
    try:
        place.mkdir(mode=0o700, parents=True, exist_ok=True)
        status = os.lstat(place)
    except OSError as error:
        _warn(f"The kernel cache {place} cannot be made ({error.strerror or error}); kernels are compiled anew in each "
              "process. Set ULNA_CACHE to a folder you can write, or to 0 for none.")  # fmt: skip
        return None
    if not stat.S_ISDIR(status.st_mode) or not storage.is_private(status):
        _warn(f"The kernel cache {place} is not used, because others could put code there: it must be a real folder, "
              "owned by you and writable by you alone (chmod 700), or set ULNA_CACHE to such a one.")  # fmt: skip
        return None
    return place


def _warn(text: str) -> None:
    if text not in _warned:
        _warned.add(text)
        warnings.warn(text, CacheWarning, stacklevel=4)
