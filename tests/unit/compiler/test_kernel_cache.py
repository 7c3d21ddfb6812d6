"""The cache of kernels: found again, never believed when damaged or foreign, harmless when it cannot work."""

from __future__ import annotations

import dataclasses
import errno
import hashlib
import multiprocessing
import os
import subprocess
import sys
import tempfile
import time
import warnings
from pathlib import Path

import numpy as np
import pytest

from ulna import disk_cache as cache
from ulna.compiler import compile
from ulna.compiler.runtime import jit, object_layout
from ulna.errors import CacheWarning

FAST = object_layout.fast_call_works()
CODES = 2 if FAST else 1  # of a kernel: of its single call, where that is fast, and of batches
POSIX = pytest.mark.skipif(not hasattr(os, "getuid"), reason="needs owners and modes")


@pytest.fixture
def place(tmp_path, monkeypatch):
    """An empty cache folder of our own; warnings may come again. What all kernels share is compiled before."""
    compile(lambda x: x, x=(2,))(np.ones((3, 2)))
    folder = tmp_path / "kernels"
    monkeypatch.setenv("ULNA_CACHE", str(folder))
    monkeypatch.setattr(cache, "_warned", set())
    return folder


@pytest.fixture
def compilations(monkeypatch):
    """The IR texts that LLVM really gets."""
    seen: list[str] = []
    original = jit.optimised

    def spy(ir: str, passes: jit.Passes, machine):
        seen.append(ir)
        return original(ir, passes, machine)

    monkeypatch.setattr(jit, "optimised", spy)
    return seen


def use() -> None:
    """Compiles a small kernel, single and batch, and checks what it computes."""
    kernel = compile(lambda x: x * 3.0 + 0.5, x=(2,))
    assert kernel(np.array([1.0, 2.0])).tolist() == [3.5, 6.5]
    assert kernel(np.ones((20, 2)))[19].tolist() == [3.5, 3.5]


def entries(place: Path) -> list[Path]:
    return sorted(p for p in place.iterdir() if len(p.name) == 64)


def test_the_second_time_nothing_is_compiled(place, compilations):
    use()
    assert len(compilations) == CODES
    use()
    assert len(compilations) == CODES
    assert len(entries(place)) == CODES
    if hasattr(os, "getuid"):
        assert place.stat().st_mode & 0o777 == 0o700
        assert all(p.stat().st_mode & 0o777 == 0o600 for p in entries(place))


_CHILD = """
import sys
from ulna.compiler import compile
from ulna.compiler.runtime import jit, object_layout
import numpy as np
def refuse(ir, passes, machine):
    raise SystemExit("compiled")
if sys.argv[1] == "refuse":
    jit.optimised = refuse
kernel = compile(lambda x: np.sin(x) * 3.0, x=(2,))
print(repr(kernel(np.ones(2)).tolist()), repr(kernel(np.ones((20, 2)))[7].tolist()), kernel.function.fingerprint)
"""


def child(*arguments: str, **environment: str) -> str:
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", _CHILD, *arguments],
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    return done.stdout + done.stderr


def test_another_process_compiles_nothing_and_hashes_do_not_depend_on_its_seed(place):
    first = child("compile", PYTHONHASHSEED="1")
    second = child("refuse", PYTHONHASHSEED="77")
    assert first.startswith("[2.52")
    assert first == second


@pytest.mark.parametrize("damage", ["flip", "cut", "empty", "head", "longer"])
def test_a_damaged_entry_is_compiled_and_written_again(place, compilations, damage):
    use()
    good = {p: p.read_bytes() for p in entries(place)}
    for path, data in good.items():
        middle = len(data) // 2
        bad = {
            "flip": data[:middle] + bytes([data[middle] ^ 1]) + data[middle + 1 :],
            "cut": data[:middle],
            "empty": b"",
            "head": b"x" + data[1:],
            "longer": data + b"\0",
        }[damage]
        path.write_bytes(bad)
    use()
    assert len(compilations) == 2 * CODES
    assert {p: p.read_bytes() for p in entries(place)} == good
    use()
    assert len(compilations) == 2 * CODES


def test_a_good_entry_under_a_wrong_name_is_not_believed(place, compilations):
    kernels = [lambda x: x + 1.0, lambda x: x + 2.0]
    for f in kernels:
        compile(f, x=())(0.0 if FAST else np.zeros(20))
    one, two = entries(place)
    one.write_bytes(two.read_bytes())
    two.write_bytes(two.read_bytes())
    assert [compile(f, x=())(0.0) for f in kernels] == [1.0, 2.0]
    assert len(compilations) == 3


def test_an_unreadable_entry_is_compiled_anew(place, compilations, monkeypatch):
    use()

    class Failing:
        def __init__(self, descriptor: int, mode: str) -> None:
            os.close(descriptor)

        def __enter__(self):
            return self

        def __exit__(self, *_: object) -> None:
            return None

        def read(self, most: int) -> bytes:
            raise OSError(errno.EIO, "Input/output error")

    original = os.fdopen
    monkeypatch.setattr(os, "fdopen", lambda d, mode: Failing(d, mode) if mode == "rb" else original(d, mode))
    monkeypatch.setattr(os, "fstat", lambda d: os.lstat(entries(place)[0]))
    with pytest.warns(CacheWarning, match="key"):
        use()
    assert len(compilations) == 2 * CODES


@POSIX
@pytest.mark.parametrize("mode", [0o777, 0o770, 0o702])
def test_a_folder_that_others_can_write_is_refused(place, compilations, mode):
    use()
    place.chmod(mode)
    with pytest.warns(
        CacheWarning, match=r"is not used, because others could put code there.*chmod 700"
    ) as caught:
        use()
    assert len(compilations) == 2 * CODES
    assert len([w for w in caught if w.category is CacheWarning]) == 1, "once is enough"


@POSIX
def test_a_folder_of_another_user_is_refused(place, compilations, monkeypatch):
    use()
    monkeypatch.setattr(os, "getuid", lambda: 12345)
    with pytest.warns(CacheWarning, match="owned by you"):
        use()
    assert len(compilations) == 2 * CODES


@POSIX
def test_an_entry_that_others_can_write_is_not_believed(place, compilations):
    use()
    for path in entries(place):
        path.chmod(0o666)
    use()
    assert len(compilations) == 2 * CODES


@POSIX
def test_a_link_as_an_entry_is_not_followed(place, compilations, tmp_path):
    use()
    for number, path in enumerate(entries(place)):
        elsewhere = tmp_path / str(number)
        path.rename(elsewhere)
        path.symlink_to(elsewhere)
    use()
    assert len(compilations) == 2 * CODES
    assert not any(p.is_symlink() for p in entries(place)), "replaced by real entries"


@POSIX
def test_a_link_as_the_folder_is_refused(place, tmp_path):
    real = tmp_path / "real"
    real.mkdir(mode=0o700)
    place.symlink_to(real)
    with pytest.warns(CacheWarning, match="must be a real folder"):
        use()
    assert list(real.iterdir()) == []


def test_a_folder_as_an_entry_is_harmless(place):
    use()
    for path in entries(place):
        path.unlink()
        path.mkdir()
    with pytest.warns(CacheWarning, match="cannot be written"):
        use()


def test_a_file_where_the_folder_should_be(place, compilations):
    place.write_text("something else")
    with pytest.warns(
        CacheWarning, match=r"cannot be made.*Set ULNA_CACHE to a folder you can write, or to 0"
    ):
        use()
    assert len(compilations) == CODES
    assert place.read_text() == "something else"


def test_a_folder_that_cannot_be_written_warns_once(place, compilations, monkeypatch):
    def refuse(*args: object, **options: object):
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr(tempfile, "mkstemp", refuse)
    with pytest.warns(
        CacheWarning, match=r"cannot be written \(Permission denied\); kernels are compiled anew"
    ) as caught:
        use()
        use()
    assert len(compilations) == 2 * CODES
    assert len([w for w in caught if w.category is CacheWarning]) == 1


def test_a_full_disk_leaves_no_half_entry(place, compilations, monkeypatch):
    class Full:
        def __init__(self, descriptor: int) -> None:
            self.descriptor = descriptor

        def __enter__(self):
            return self

        def __exit__(self, *_: object) -> None:
            os.close(self.descriptor)

        def write(self, data: bytes) -> int:
            os.write(self.descriptor, data[:100])
            raise OSError(errno.ENOSPC, "No space left on device")

    original = os.fdopen
    monkeypatch.setattr(os, "fdopen", lambda d, mode: Full(d) if mode == "wb" else original(d, mode))
    with pytest.warns(CacheWarning, match="No space left on device"):
        use()
    assert list(place.iterdir()) == []
    monkeypatch.setattr(os, "fdopen", original)
    use()
    assert len(entries(place)) == CODES


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs /dev/full")
def test_a_really_full_device_warns(place, monkeypatch):
    place.mkdir(mode=0o700)
    (place / "new-full").symlink_to("/dev/full")
    monkeypatch.setattr(
        tempfile,
        "mkstemp",
        lambda dir, prefix: (os.open("/dev/full", os.O_WRONLY), str(place / "new-full")),
    )
    with pytest.warns(CacheWarning, match="No space left"):
        use()
    assert list(place.iterdir()) == []


def test_a_warning_made_an_error_does_not_break_later_work(place, monkeypatch):
    place.write_text("")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(CacheWarning):
            use()
        use()


def test_off(place, compilations, monkeypatch):
    monkeypatch.setenv("ULNA_CACHE", "0")
    use()
    use()
    assert len(compilations) == 2 * CODES
    assert cache.folder() is None
    assert cache.clear() == 0
    assert not place.exists()


def test_where_the_folder_is(monkeypatch, tmp_path):
    monkeypatch.setenv("ULNA_CACHE", "~/somewhere")
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("USERPROFILE", str(tmp_path))
    assert cache.folder() == tmp_path / "somewhere"
    monkeypatch.delenv("ULNA_CACHE")
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    assert cache.folder() == tmp_path / ".cache" / "ulna"
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    assert cache.folder() == tmp_path / "xdg" / "ulna"
    monkeypatch.setattr(sys, "platform", "darwin")
    assert cache.folder() == tmp_path / "Library" / "Caches" / "ulna"
    monkeypatch.setattr(sys, "platform", "win32")
    monkeypatch.setenv("LOCALAPPDATA", str(tmp_path / "local"))
    assert cache.folder() == tmp_path / "local" / "ulna"


def test_a_user_without_a_home_can_compile(place, compilations, monkeypatch):
    def homeless(path: Path) -> Path:
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.delenv("ULNA_CACHE")
    monkeypatch.setattr(Path, "expanduser", homeless)
    with pytest.warns(CacheWarning, match="this user has no home folder"):
        use()
    assert len(compilations) == CODES


def _fill(start, folder: str, failures) -> None:
    os.environ["ULNA_CACHE"] = folder
    warnings.simplefilter("error")
    start.wait()
    try:
        for k in range(8):
            kernel = compile(lambda x, k=k: x * float(k + 2) + 0.25, x=(2,))
            if kernel(np.ones(2)).tolist() != [k + 2.25] * 2 or kernel(np.ones((20, 2)))[3, 0] != k + 2.25:
                failures.put(f"kernel {k}")
    except BaseException as error:
        failures.put(repr(error))


def test_processes_that_fill_the_cache_at_once_agree(place):
    context = multiprocessing.get_context("spawn")
    start, failures = context.Barrier(4), context.Queue()
    children = [context.Process(target=_fill, args=(start, str(place), failures)) for _ in range(4)]
    for process in children:
        process.start()
    for process in children:
        process.join(600)
    assert [p.exitcode for p in children] == [0] * 4
    assert failures.empty()
    assert len(entries(place)) == (19 if FAST else 9)  # the codes of each kernel, and what all share
    assert [p for p in place.iterdir() if p.name.startswith("new-")] == []


def test_a_key_depends_on_every_part_and_on_where_they_part():
    assert cache.key("ab", "c") != cache.key("a", "bc")
    assert cache.key("ab", "c") == cache.key(b"ab", b"c")
    assert len(cache.key("x")) == 64


def test_an_entry_of_another_processor_is_another_entry(place, compilations, monkeypatch):
    use()
    here = jit.target()
    monkeypatch.setattr(jit, "target", lambda: dataclasses.replace(here, features=here.features + ","))
    use()
    assert len(compilations) == 2 * CODES


def test_prune_keeps_what_was_used_last(place):
    place.mkdir(mode=0o700)
    names = [hashlib.sha256(bytes([k])).hexdigest() for k in range(6)]
    for name in names:
        cache.write(name, b"x" * 1000)
    for age, name in enumerate(names):
        os.utime(place / name, (1e9 + age, 1e9 + age))
    assert cache.read(names[0]) == b"x" * 1000, "which makes it the one used last"
    other = place / "notes.txt"
    other.write_text("not ours")
    fresh, stale = place / "new-fresh", place / "new-stale"
    fresh.write_bytes(b"")
    stale.write_bytes(b"")
    os.utime(stale, (time.time() - 7200,) * 2)
    cache.prune(place, limit=3 * 1100)
    assert sorted(p.name for p in entries(place)) == sorted([names[0], names[4], names[5]])
    assert fresh.exists()
    assert other.exists()
    assert not stale.exists()


def test_clear_removes_what_is_ours_only(place):
    use()
    other = place / "notes.txt"
    other.write_text("not ours")
    assert cache.clear() == CODES
    assert [p.name for p in place.iterdir()] == ["notes.txt"]
    use()


def test_clear_without_a_folder(place):
    assert cache.clear() == 0


@pytest.fixture
def slow(monkeypatch):
    """Every compilation takes longer than a moment."""
    monkeypatch.setattr(jit, "_ANNOUNCE_FROM", 0.0)
    monkeypatch.delenv("ULNA_QUIET", raising=False)


def test_a_long_compilation_is_announced_once(place, slow, capsys):
    use()
    said = capsys.readouterr()
    assert said.out == ""
    lines = said.err.splitlines()
    assert len(lines) == CODES  # one call, and a batch
    assert "compiling lambda (4 operations)" in lines[0] and "next time" in lines[0]
    use()
    assert capsys.readouterr().err == ""  # out of the cache


def test_a_long_compilation_can_be_kept_quiet(place, slow, capsys, monkeypatch):
    monkeypatch.setenv("ULNA_QUIET", "1")
    use()
    monkeypatch.delenv("ULNA_QUIET")
    monkeypatch.setattr(sys, "stderr", None)  # as in a program without a console
    compile(lambda x: x * 7.0 + 0.5, x=(2,))
    assert capsys.readouterr().err == ""


def test_short_compilations_say_nothing(place, capsys, monkeypatch):
    monkeypatch.delenv("ULNA_QUIET", raising=False)
    use()
    assert capsys.readouterr().err == ""


@POSIX
def test_an_empty_home_is_no_home(monkeypatch, tmp_path):
    import pwd

    for name in ("ULNA_CACHE", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setenv("HOME", "")
    assert cache.folder() == Path(pwd.getpwuid(os.getuid()).pw_dir) / ".cache" / "ulna"
    monkeypatch.setenv("ULNA_CACHE", "~/kernels")
    assert cache.folder() == Path(pwd.getpwuid(os.getuid()).pw_dir) / "kernels"

    def nobody(uid):
        raise KeyError(uid)

    monkeypatch.setattr(pwd, "getpwuid", nobody)
    with pytest.warns(CacheWarning, match="no home folder"):
        assert cache.folder() is None
    monkeypatch.setenv("HOME", str(tmp_path))
    assert cache.folder() == tmp_path / "kernels"
