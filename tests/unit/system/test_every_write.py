"""Every file that Ulna writes is the old one or a new one, complete, when a step of writing fails."""

from __future__ import annotations

import errno
import io
import os
import pickle
import signal
import subprocess
import sys
import textwrap
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import ulna
from support.patience import patient
from ulna.compiler import trace
from ulna.errors import InputError, MissingFolder
from ulna.system import storage
from ulna.trajectory import quintic
from ulna.viewer.output.png import write_png
from ulna.viewer.output.video import write_video


def _trajectory() -> ulna.trajectory.Trajectory:
    return quintic(np.zeros(2), np.ones(2), 1.0)


def _pictures() -> list[np.ndarray]:
    return [np.full((32, 32, 3), 60 * k, np.uint8) for k in range(4)]


def _page(path: Path) -> None:
    from ulna.viewer.page.html_file import write_html
    from ulna.viewer.scene import Scene

    write_html(path, Scene())


def _demo(path: Path) -> None:
    from ulna.demo import demo

    demo(headless=True, output=str(path), size=(64, 48))


WRITERS: dict[str, Callable[[Path], object]] = {
    "a.npz": lambda path: _trajectory().save(path),
    "a.csv": lambda path: _trajectory().save(path),
    "a.svg": lambda path: trace(lambda q: q * 2.0, q=(2,)).draw(str(path)),
    "a.png": lambda path: write_png(path, np.zeros((4, 4, 3), np.uint8)),
    "film.mp4": lambda path: write_video(path, _pictures(), 10.0),
    "film.gif": lambda path: write_video(path, _pictures(), 10.0),
    "page.html": _page,
    "demo.png": _demo,
    "plot.png": lambda path: _trajectory().plot(path=str(path)),
}


SLOW = ("demo.png", "page.html")


MAKE_FOLDERS = ("a.png", "film.mp4", "film.gif", "page.html", "demo.png")
"""What pictures, films and pages of the viewer are: folders that are missing are made."""


def _full(*_: object, **__: object) -> None:
    raise OSError(errno.ENOSPC, "No space left on device")


NEEDS = {"plot.png": "matplotlib", "film.mp4": "imageio_ffmpeg", "film.gif": "PIL", "page.html": "viser"}


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=pytest.mark.slow if n in SLOW else ()) for n in WRITERS]
)
@pytest.mark.parametrize("old", [b"old", None])
@pytest.mark.parametrize("step", ["replace", "open", "touch", "sync"])
def test_a_full_disk_leaves_the_old_file(tmp_path: Path, monkeypatch, name, old, step):
    pytest.importorskip(NEEDS.get(name, "numpy"))
    if (name, step) == ("film.mp4", "open"):
        pytest.skip("FFmpeg opens the file: see below")
    target = tmp_path / name
    WRITERS[name](target)  # compiles and imports what it needs
    target.unlink()
    if old is not None:
        target.write_bytes(old)
    original = io.open

    def failing(file, mode="r", *rest, **options):
        opened = original(file, mode, *rest, **options)
        if "w" in mode and str(file).startswith(str(tmp_path)):
            opened.write("ha" if "b" not in mode else b"ha")
            opened.close()
            _full()
        return opened

    with monkeypatch.context() as patched:
        if step == "replace":
            patched.setattr(os, "replace", _full)
        elif step == "touch":
            patched.setattr(Path, "touch", _full)
        elif step == "sync":
            patched.setattr(os, "fsync", _full)
        else:
            patched.setattr(io, "open", failing)
            patched.setattr("builtins.open", failing)
        with pytest.raises((OSError, ValueError), match="No space"):
            WRITERS[name](target)
    assert [p.name for p in tmp_path.iterdir()] == ([name] if old is not None else [])
    assert old is None or target.read_bytes() == old


def _run(text: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    head = "import os, resource, signal, sys\nimport numpy as np\n"
    return subprocess.run(
        [sys.executable, "-c", head + textwrap.dedent(text), *arguments],
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )


@pytest.mark.skipif(not hasattr(signal, "SIGXFSZ"), reason="needs limits of file sizes")
def test_a_film_that_ffmpeg_cannot_write_leaves_the_old_one(tmp_path):
    pytest.importorskip("imageio_ffmpeg")
    target = tmp_path / "film.mp4"
    target.write_bytes(b"old")
    done = _run(
        """
        from ulna.viewer.output.video import write_video
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))
        chance = np.random.default_rng(0)
        try:
            write_video(sys.argv[1], (chance.integers(0, 255, (64, 64, 3), np.uint8) for _ in range(20)), 10.0)
        except ValueError as error:
            print(error)
        """,
        str(target),
    )
    assert "Cannot write the film" in done.stdout, done.stdout + done.stderr
    assert [p.name for p in tmp_path.iterdir()] == ["film.mp4"]
    assert target.read_bytes() == b"old"


KILLED = {
    "film.mp4": """
        from ulna.viewer.output.video import write_video
        def pictures():
            for k in range(100):
                yield np.full((64, 64, 3), k, np.uint8)
            os.kill(os.getpid(), signal.SIGKILL)
        write_video(sys.argv[1], pictures(), 10.0)
        """,
    "page.html": """
        from pathlib import Path
        from ulna.viewer.page.html_file import write_html
        from ulna.viewer.scene import Scene
        whole = Path.write_text
        def half(path, text, **how):
            whole(path, text[: len(text) // 2], **how)
            os.kill(os.getpid(), signal.SIGKILL)
        Path.write_text = half
        write_html(sys.argv[1], Scene())
        """,
}


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs SIGKILL")
@pytest.mark.parametrize("name", KILLED)
def test_a_killed_process_leaves_the_old_file_and_what_it_left_is_removed(tmp_path, monkeypatch, name):
    pytest.importorskip(NEEDS[name])
    target, strange = tmp_path / name, tmp_path / ".other.mp4"
    target.write_bytes(b"old")
    strange.write_bytes(b"not ours")
    done = _run(KILLED[name], str(target))
    assert done.returncode == -signal.SIGKILL, done.stderr
    assert target.read_bytes() == b"old"
    [left] = [p for p in tmp_path.iterdir() if p not in (target, strange)]
    assert left.name.startswith(".ulna-")
    monkeypatch.setattr(storage, "_cleaned", set())
    write_png(tmp_path / "a.png", np.zeros((4, 4, 3), np.uint8))
    assert left.exists()  # it may be of a process that still writes

    def removed() -> bool:
        for path in [p for p in (left, strange) if p.exists()]:
            os.utime(path, (1e9, 1e9))
        storage._cleaned.clear()
        write_png(tmp_path / "a.png", np.zeros((4, 4, 3), np.uint8))
        return not left.exists()

    assert patient()(removed)  # FFmpeg may still write what it got
    assert strange.exists()


@pytest.mark.parametrize("name", [name for name in WRITERS if name not in MAKE_FOLDERS])
def test_a_folder_that_is_missing_is_named(tmp_path: Path, name: str) -> None:
    pytest.importorskip(NEEDS.get(name, "numpy"))
    (tmp_path / "file").touch()
    for folder in (tmp_path / "results", tmp_path / "file"):
        with pytest.raises(MissingFolder) as caught:
            WRITERS[name](folder / name)
        assert str(folder / name) in str(caught.value) and f"no folder {str(folder)!r}. Make it" in str(
            caught.value
        )
        assert isinstance(caught.value, InputError) and isinstance(caught.value, FileNotFoundError)
        assert str(pickle.loads(pickle.dumps(caught.value))) == str(caught.value)
    assert [path.name for path in tmp_path.iterdir()] == ["file"]
