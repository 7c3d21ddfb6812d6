"""Files that are whole or absent, the user's key, and objects that are examined before they are loaded."""

from __future__ import annotations

import errno
import hashlib
import os
import signal
import stat
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ulna import disk_cache
from ulna.compiler import compile
from ulna.compiler.runtime import jit
from ulna.compiler.runtime.object_file import is_sound
from ulna.system import folders, storage

POSIX = pytest.mark.skipif(not hasattr(os, "getuid"), reason="needs owners and modes")


@pytest.fixture
def place(tmp_path, monkeypatch) -> Path:
    """An empty cache folder, and an empty folder for state, of our own."""
    compile(lambda x: x, x=(2,))
    monkeypatch.setenv("ULNA_CACHE", str(tmp_path / "cache"))
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    return tmp_path


def _stored() -> Any:
    """Compiles a kernel, and stores one object: of its single call, or of batches where there is no fast call."""
    kernel = compile(lambda x: x * 3.0 + 0.5, x=(2,))
    kernel(np.ones(2) if kernel.is_fast else np.ones((20, 2)))
    return kernel


def _object(place: Path) -> tuple[Path, bytes]:
    """The entry of a kernel in the cache, and the object file in it."""
    _stored()
    (path,) = (p for p in (place / "cache").iterdir() if len(p.name) == 64)
    content = disk_cache.read(path.name)
    assert content is not None
    return path, content


# the key ------------------------------------------------------------------------------------------------


@POSIX
def test_the_key_is_the_users_alone(place):
    path, _ = _object(place)
    key = place / "state" / "ulna" / "cache-key"
    assert stat.S_IMODE(key.stat().st_mode) == 0o600
    assert len(key.read_bytes()) == 32
    assert [p.name for p in key.parent.iterdir()] == ["cache-key"]
    assert not (path.parent / "cache-key").exists()


def test_a_forged_entry_is_not_loaded(place):
    path, content = _object(place)
    forged = b"\x7fELF" + bytes(400)
    magic = disk_cache._MAGIC
    for seal in (
        hashlib.sha256(path.name.encode() + forged).digest(),
        hashlib.blake2b(path.name.encode() + forged, digest_size=32).digest(),
        hashlib.blake2b(path.name.encode() + forged, key=bytes(32), digest_size=32).digest(),
    ):
        path.write_bytes(magic + seal + forged)
        assert disk_cache.read(path.name) is None
    _stored()
    assert disk_cache.read(path.name) == content


@POSIX
@pytest.mark.parametrize("damage", ["short", "long", "empty", "open", "link", "pipe", "gone"])
def test_a_damaged_key_costs_compilations_only(place, damage):
    path, content = _object(place)
    key = place / "state" / "ulna" / "cache-key"
    before = key.read_bytes()
    if damage in ("short", "long", "empty"):
        key.write_bytes({"short": b"x", "long": bytes(99), "empty": b""}[damage])
    elif damage == "open":
        key.chmod(0o666)
    else:
        key.unlink()
    if damage == "link":
        key.symlink_to(place / "elsewhere")
    if damage == "pipe":
        os.mkfifo(key)
    assert disk_cache.read(path.name) is None
    _object(place)
    assert len(key.read_bytes()) == 32 != before
    assert disk_cache.read(path.name) == content


def test_without_a_folder_for_state_the_key_is_in_the_cache_folder(place, monkeypatch):
    (place / "file").write_text("")
    monkeypatch.setenv("XDG_STATE_HOME", str(place / "file"))
    path, _ = _object(place)
    assert len((path.parent / "cache-key").read_bytes()) == 32


def test_processes_that_make_the_key_at_once_get_the_same(tmp_path):
    found: list[bytes | None] = []
    gate = threading.Barrier(8)

    def make() -> None:
        gate.wait()
        found.append(storage.secret([tmp_path / "state"], "key"))

    threads = [threading.Thread(target=make) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 8
    assert len(set(found)) == 1


def test_a_key_that_cannot_be_read_now_is_kept(tmp_path, monkeypatch):
    made = storage.secret([tmp_path], "key")

    def refuse(*_: object) -> int:
        raise OSError(errno.EMFILE, "Too many open files")

    with monkeypatch.context() as patched:
        patched.setattr(os, "open", refuse)
        assert storage.secret([tmp_path], "key") is None
    assert storage.secret([tmp_path], "key") == made


# objects ------------------------------------------------------------------------------------------------


def test_what_llvm_makes_is_sound_and_what_is_cut_is_not(place):
    _, content = _object(place)
    triple = jit.target().triple
    assert is_sound(content, triple)
    for length in range(0, len(content), 7):
        assert not is_sound(content[:length], triple) or length >= len(content) - 64
    assert not is_sound(b"", triple)
    other = "aarch64" if triple.startswith("x86_64") else "x86_64"
    assert not is_sound(content, f"{other}-unknown-linux-gnu")


def test_a_signed_cache_entry_without_machine_code_is_compiled_anew(place):
    path, content = _object(place)
    disk_cache.write(path.name, b"\x7fELF" + bytes(300))
    kernel = _stored()
    assert kernel(np.array([1.0, 2.0])).tolist() == [3.5, 6.5]
    assert disk_cache.read(path.name) == content


# files --------------------------------------------------------------------------------------------------


def test_a_file_is_replaced_at_the_end(tmp_path):
    target = tmp_path / "a.txt"
    target.write_text("old")
    target.chmod(0o640)
    with storage.replacing(target) as place:
        place.write_text("new")
        assert target.read_text() == "old"
    assert target.read_text() == "new"
    assert stat.S_IMODE(target.stat().st_mode) == 0o640
    assert list(tmp_path.iterdir()) == [target]


@pytest.mark.parametrize("step", ["write", "replace"])
def test_a_failure_leaves_the_old_file_and_nothing_else(tmp_path, monkeypatch, step):
    target = tmp_path / "a.txt"
    target.write_text("old")

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    if step == "replace":
        monkeypatch.setattr(os, "replace", full)
    with pytest.raises(OSError, match="No space"), storage.replacing(target) as place:
        place.write_text("half")
        if step == "write":
            full()
    assert target.read_text() == "old"
    assert list(tmp_path.iterdir()) == [target]


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs SIGKILL")
def test_a_process_killed_while_it_writes_leaves_the_old_file(tmp_path):
    target = tmp_path / "a.txt"
    target.write_text("old")
    text = (
        "import os, signal, sys\nfrom ulna.system.storage import replacing\n"
        "with replacing(sys.argv[1]) as place:\n"
        "    place.write_text('half')\n"
        "    os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    done = subprocess.run([sys.executable, "-c", text, str(target)], timeout=600, check=False)
    assert done.returncode == -signal.SIGKILL
    assert target.read_text() == "old"


# platforms ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("platform", "variables", "cache", "state"),
    [
        ("linux", {}, "~/.cache/ulna", "~/.local/state/ulna"),
        ("linux", {"XDG_CACHE_HOME": "/c", "XDG_STATE_HOME": "/s"}, "/c/ulna", "/s/ulna"),
        ("darwin", {}, "~/Library/Caches/ulna", "~/Library/Application Support/ulna"),
        ("win32", {"LOCALAPPDATA": "/local"}, "/local/ulna", "/local/ulna-state"),
        ("win32", {}, "~/AppData/Local/ulna", "~/AppData/Local/ulna-state"),
    ],
)
def test_folders_of_each_platform(monkeypatch, platform, variables, cache, state):
    monkeypatch.setattr(sys, "platform", platform)
    for name in ("XDG_CACHE_HOME", "XDG_STATE_HOME", "LOCALAPPDATA"):
        monkeypatch.delenv(name, raising=False)
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    assert (folders.cache_folder(), folders.state_folder()) == (cache, state)


def test_the_cache_works_without_owners_and_hard_links(place, monkeypatch):
    monkeypatch.delattr(os, "getuid")  # Windows
    monkeypatch.delattr(os, "link")
    path, content = _object(place)
    assert disk_cache.read(path.name) == content
