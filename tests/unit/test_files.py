"""Pipes, sockets and devices are refused wherever a file is read, at once, and the message says what to do."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import threading
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ulna
from support.patience import patient
from ulna import disk_cache as cache
from ulna.errors import FormatError, InputError, ModelWarning, UlnaError
from ulna.files import open_regular, read_regular, special_kind
from ulna.geometry.meshes import read_pieces

pytestmark = pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no FIFOs")


def within(seconds: float, call: Callable[[], Any]) -> Any:
    """What a call returns or raises, or a failure if it does not come back."""
    found: list[Any] = []

    def run() -> None:
        try:
            found.append((True, call()))
        except BaseException as error:
            found.append((False, error))

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    thread.join(seconds)
    assert found, "the call waits for the pipe"
    good, value = found[0]
    if not good:
        raise value
    return value


@pytest.fixture
def fifo(tmp_path: Path) -> Callable[[str], str]:
    def make(name: str) -> str:
        os.mkfifo(tmp_path / name)
        return str(tmp_path / name)

    return make


def test_regular_files_are_read_and_others_are_not(tmp_path: Path, fifo: Callable[[str], str]) -> None:
    (tmp_path / "a").write_bytes(b"abc")
    assert read_regular(tmp_path / "a") == b"abc"
    assert read_regular(tmp_path / "a", 2) == b"ab"
    with open_regular(tmp_path / "a") as file:
        assert file.readline() == b"abc"
    with pytest.raises(OSError, match="pipe"):
        within(300, lambda: read_regular(fifo("pipe")))
    with pytest.raises(OSError, match="device"):
        within(300, lambda: read_regular("/dev/zero"))
    with socket.socket(socket.AF_UNIX) as server:
        place = os.path.relpath(tmp_path / "s")
        server.bind(place if len(place) < 100 else str(tmp_path / "s"))
        with pytest.raises(OSError, match="socket"):
            read_regular(tmp_path / "s")
    with pytest.raises(IsADirectoryError):
        read_regular(tmp_path)
    with pytest.raises(FileNotFoundError):
        read_regular(tmp_path / "none")
    assert special_kind(tmp_path / "none") == special_kind(tmp_path) == special_kind("\0") == ""


def test_a_pipe_that_takes_a_files_place_is_refused_after_opening(
    fifo: Callable[[str], str], monkeypatch: pytest.MonkeyPatch
) -> None:
    place = fifo("late")
    monkeypatch.setattr("ulna.files.reject_special_files", lambda path: None)
    before = len(os.listdir("/proc/self/fd")) if os.path.isdir("/proc/self/fd") else 0
    with pytest.raises(OSError, match="pipe"):
        within(300, lambda: read_regular(place))
    if before:
        assert patient()(lambda: len(os.listdir("/proc/self/fd")) <= before)


@pytest.mark.parametrize("ending", ["urdf", "xml", "mjcf", "xacro"])
def test_robots_are_not_read_from_pipes(ending: str, fifo: Callable[[str], str]) -> None:
    place = fifo(f"robot.{ending}")
    with pytest.raises(FormatError, match=r"pipe \(FIFO\), and only regular files are read; save what it"):
        within(300, lambda: ulna.load(place))


def test_srdf_trajectories_scripts_and_meshes_are_not_read_from_pipes(fifo: Callable[[str], str]) -> None:
    from ulna import trajectory
    from ulna.compat.doctor import examine
    from ulna.viewer.mesh.mesh_files import load_mesh

    for place, call, error in (
        (fifo("a.srdf"), lambda p: ulna.load("panda", visuals="simple", srdf=Path(p)), FormatError),
        (fifo("a.csv"), trajectory.load, InputError),
        (fifo("a.npz"), trajectory.load, InputError),
        (fifo("a.py"), examine, InputError),
        (fifo("a.stl"), load_mesh, InputError),
        (fifo("b.stl"), read_pieces, InputError),
    ):
        with pytest.raises(error, match="pipe"):
            within(300, lambda call=call, place=place: call(place))


def test_an_included_pipe_is_refused(tmp_path: Path, fifo: Callable[[str], str]) -> None:
    pytest.importorskip("xacro")
    fifo("part.xacro")
    outer = tmp_path / "robot.xacro"
    outer.write_text(
        '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">'
        '<xacro:include filename="part.xacro"/><link name="a"/></robot>'
    )
    with pytest.raises(FormatError, match="pipe"):
        within(300, lambda: ulna.load(outer))
    (tmp_path / "part.xacro").unlink()
    (tmp_path / "part.xacro").write_text('<robot><link name="b"/></robot>')
    outer.write_text(outer.read_text().replace('<link name="a"/>', ""))
    assert ulna.load(outer).model.link_names == ("b",)


def test_a_mesh_that_names_a_pipe_as_its_material_is_read_without_it(
    tmp_path: Path, fifo: Callable[[str], str]
) -> None:
    pytest.importorskip("trimesh")
    fifo("a.mtl")
    mesh = tmp_path / "a.obj"
    mesh.write_text("mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    assert np.array_equal(within(300, lambda: read_pieces(str(mesh)))[0].triangles, [[0, 1, 2]])
    (tmp_path / "a.mtl").unlink()
    (tmp_path / "a.mtl").write_text("newmtl m\nKd 1 0 0\n")
    assert tuple(read_pieces(str(mesh))[0].source.visual.material.diffuse[:3]) == (255, 0, 0)


def test_a_mesh_of_a_urdf_that_is_a_pipe_counts_as_missing(
    tmp_path: Path, fifo: Callable[[str], str]
) -> None:
    place = fifo("a.stl")
    text = f'<robot name="r"><link name="a"><visual><geometry><mesh filename="{place}"/></geometry></visual></link></robot>'
    with pytest.warns(ModelWarning, match="not found"):
        robot = within(300, lambda: ulna.load(text))
    assert robot.model.links[0].visuals[0].shape.missing


def test_a_pipe_in_the_place_of_a_cache_entry_is_passed_over(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ULNA_CACHE", str(tmp_path / "kernels"))
    name = cache.key("some kernel")
    cache.write(name, b"content")
    assert cache.read(name) == b"content"
    (tmp_path / "kernels" / name).unlink()
    os.mkfifo(tmp_path / "kernels" / name)
    assert within(300, lambda: cache.read(name)) is None
    cache.write(name, b"content")
    assert cache.read(name) == b"content"


def test_the_message_about_standard_input_says_what_to_do() -> None:
    script = "import ulna; ulna.load('/dev/stdin', root='free_flyer')"
    done = subprocess.run(
        [sys.executable, "-c", script], input=b"<robot/>", capture_output=True, timeout=600, check=False
    )
    assert b"/dev/stdin: the file cannot be read" in done.stderr
    assert b"or pass the text: ulna.load(sys.stdin.read())" in done.stderr


def test_devices_are_refused() -> None:
    with warnings.catch_warnings(), pytest.raises(UlnaError, match="device"):
        warnings.simplefilter("error")
        within(300, lambda: ulna.load("/dev/zero"))
