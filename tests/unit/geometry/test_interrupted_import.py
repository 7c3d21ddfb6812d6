"""Ctrl-C while trimesh is imported is not lost, though trimesh catches every exception as it is imported."""

from __future__ import annotations

import _thread
import sys
import threading
from pathlib import Path

import pytest

from support.patience import patient
from ulna.geometry.meshes import read_pieces

wait_until = patient(0.01)
MODULE = """
import pathlib, time
started = pathlib.Path(__file__).with_name("started")
try:
    started.touch()
    while not started.with_name("go on").exists():
        time.sleep(0.01)
except BaseException:  # as trimesh does
    pass
"""


def test_ctrl_c_during_the_import(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "trimesh.py").write_text(MODULE)
    (tmp_path / "part.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    for name in [n for n in sys.modules if n.split(".")[0] == "trimesh"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.syspath_prepend(str(tmp_path))

    def interrupt() -> None:
        wait_until((tmp_path / "started").exists)
        _thread.interrupt_main()
        (tmp_path / "go on").touch()

    threading.Thread(target=interrupt, daemon=True).start()
    try:
        with pytest.raises(KeyboardInterrupt):
            read_pieces(str(tmp_path / "part.obj"))
    finally:
        sys.modules.pop("trimesh", None)
