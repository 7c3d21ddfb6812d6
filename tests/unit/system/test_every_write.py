"""Every file that Ulna writes is the old one or a new one, complete, when a step of writing fails."""

from __future__ import annotations

import errno
import io
import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import ulna
from ulna.compiler import trace
from ulna.trajectory import quintic
from ulna.viewer.output.png import write_png


def _trajectory() -> ulna.trajectory.Trajectory:
    return quintic(np.zeros(2), np.ones(2), 1.0)


WRITERS: dict[str, Callable[[Path], object]] = {
    "a.npz": lambda path: _trajectory().save(path),
    "a.csv": lambda path: _trajectory().save(path),
    "a.svg": lambda path: trace(lambda q: q * 2.0, q=(2,)).draw(str(path)),
    "a.png": lambda path: write_png(path, np.zeros((4, 4, 3), np.uint8)),
    "plot.png": lambda path: _trajectory().plot(path=str(path)),
}


def _full(*_: object, **__: object) -> None:
    raise OSError(errno.ENOSPC, "No space left on device")


@pytest.mark.parametrize("name", WRITERS)
@pytest.mark.parametrize("old", [b"old", None])
@pytest.mark.parametrize("step", ["replace", "open", "touch"])
def test_a_full_disk_leaves_the_old_file(tmp_path: Path, monkeypatch, name, old, step):
    if name == "plot.png":
        pytest.importorskip("matplotlib")
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
        else:
            patched.setattr(io, "open", failing)
            patched.setattr("builtins.open", failing)
        with pytest.raises((OSError, ValueError), match="No space"):
            WRITERS[name](target)
    assert [p.name for p in tmp_path.iterdir()] == ([name] if old is not None else [])
    assert old is None or target.read_bytes() == old
