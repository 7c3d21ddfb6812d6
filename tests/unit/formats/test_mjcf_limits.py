"""MuJoCo compiles files that are not trusted in a separate process: nothing in a file can stop or fill this one."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
import warnings
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

import ulna
from ulna.errors import FormatError
from ulna.formats import mjcf_child
from ulna.formats.mjcf_child import _CompilerProcess
from ulna.formats.mjcf_loops import loops_from_mjcf

pytest.importorskip("mujoco")

ARM = """<mujoco model="arm"><worldbody><body name="a" pos="0 0 1"><joint name="j" axis="0 1 0" range="-90 90"/>
<geom name="g" type="capsule" fromto="0 0 0 0 0 -0.5" size="0.02"/><site name="tip" pos="0 0 -0.5"/></body></worldbody></mujoco>"""
ENDLESS = ARM.replace(
    "</worldbody>", '<replicate count="1000000000"><geom size="0.1"/></replicate></worldbody>'
)


def load(source: str | Path) -> ulna.Robot:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return ulna.load(source)


def test_a_trusted_file_is_the_same_robot() -> None:
    here, there = ulna.load(ARM, trusted=True), ulna.load(ARM)
    assert here.model == there.model
    assert np.isfinite(there.fk([0.3])).all()
    assert loops_from_mjcf(ARM) == loops_from_mjcf(ARM, trusted=True) == ()


def test_a_huge_height_field_is_refused_for_its_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    field = '<asset><hfield name="h" nrow="100000" ncol="100000" size="1 1 1 1"/></asset>'
    monkeypatch.setattr(mjcf_child, "MEMORY", 2**30)
    with pytest.raises(FormatError, match=r"more than 1 GiB.*trusted=True"):
        ulna.load(ARM.replace("<worldbody>", field + "<worldbody>"))
    assert load(ARM).nq == 1


def test_an_endless_replication_is_stopped(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mjcf_child, "SECONDS", 1.5)
    with pytest.raises(FormatError, match=r"still compiling it after 1\.5 s.*trusted=True"):
        ulna.load(ENDLESS)
    monkeypatch.setattr(mjcf_child, "SECONDS", 60.0)
    assert load(ARM).nq == 1


def test_a_model_of_too_many_parts_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mjcf_child, "ELEMENTS", 50)
    many = ARM.replace("</worldbody>", '<replicate count="60"><geom size="0.1"/></replicate></worldbody>')
    with pytest.raises(FormatError, match="bodies, joints, geoms and the like; expected at most 50"):
        ulna.load(many)
    assert len(ulna.load(many, trusted=True).model.links[0].visuals) == 60


def test_text_that_is_not_utf8_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.xml").write_bytes(ARM.replace("tip", "tête").encode("latin-1"))
    with pytest.raises(FormatError, match=r"a\.xml:2: the text is not UTF-8\. Save the file as UTF-8"):
        ulna.load(tmp_path / "a.xml")
    (tmp_path / "b.xml").write_bytes("<mujocoinclude><!-- ä --></mujocoinclude>".encode("latin-1"))
    (tmp_path / "c.xml").write_text(ARM.replace("<worldbody>", '<include file="b.xml"/><worldbody>'))
    with pytest.raises(FormatError, match=r"b\.xml:1: the text is not UTF-8"):
        ulna.load(tmp_path / "c.xml")
    with pytest.raises(FormatError, match="not UTF-8"):
        ulna.load(ARM.replace("tip", "\ud800"))
    assert "tête" in load(ARM.replace("tip", "tête")).model.frame_names


@pytest.mark.parametrize("trusted", [False, True])
def test_entities_are_refused(tmp_path: Path, trusted: bool) -> None:
    entity = '<!DOCTYPE mujoco [<!ENTITY a "0.1">]>'
    with pytest.raises(FormatError, match="declares entities, which Ulna does not follow"):
        ulna.load(entity + ARM, trusted=trusted)
    with pytest.raises(FormatError, match="declares an external DTD"):
        ulna.load('<!DOCTYPE mujoco SYSTEM "m.dtd">' + ARM, trusted=trusted)
    (tmp_path / "part.xml").write_text(entity + "<mujocoinclude/>")
    (tmp_path / "a.xml").write_text(ARM.replace("<worldbody>", '<include file="part.xml"/><worldbody>'))
    with pytest.raises(FormatError, match=r"part\.xml:1: the document type"):
        ulna.load(tmp_path / "a.xml", trusted=trusted)
    assert load("<!DOCTYPE mujoco>" + ARM).nq == 1


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no FIFOs")
@pytest.mark.parametrize(
    "asset",
    [
        '<asset><mesh name="m" file="p"/></asset>',
        '<asset><texture name="t" type="2d" file="p"/></asset>',
        '<asset><hfield name="h" file="p" size="1 1 1 1"/></asset>',
        '<compiler meshdir="sub"/><asset><mesh name="m" file="q.stl"/></asset>',
    ],
)
@pytest.mark.parametrize("trusted", [False, True])
def test_pipes_among_the_assets_are_refused(asset: str, trusted: bool, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "p")
    (tmp_path / "sub").mkdir()
    os.mkfifo(tmp_path / "sub" / "q.stl")
    (tmp_path / "a.xml").write_text(ARM.replace("<worldbody>", asset + "<worldbody>"))
    with pytest.raises(FormatError, match=r"is a pipe \(FIFO\), and only regular files are read"):
        ulna.load(tmp_path / "a.xml", trusted=trusted)


def test_a_ring_of_includes_ends(tmp_path: Path) -> None:
    (tmp_path / "b.xml").write_text('<mujocoinclude><include file="b.xml"/></mujocoinclude>')
    (tmp_path / "a.xml").write_text(ARM.replace("<worldbody>", '<include file="b.xml"/><worldbody>'))
    with pytest.raises(FormatError, match="MuJoCo refuses it"):
        ulna.load(tmp_path / "a.xml")


def test_one_process_serves_several_files_and_is_replaced_when_it_is_gone(tmp_path: Path) -> None:
    load(ARM)
    first = _CompilerProcess._waiting
    assert first is not None
    with pytest.raises(FormatError, match="MuJoCo refuses it"):
        ulna.load("<mujoco><nothing/></mujoco>")
    load(ARM)
    assert _CompilerProcess._waiting is first
    first._process.kill()
    assert load(ARM).nq == 1
    assert _CompilerProcess._waiting is not first


def test_texts_name_files_from_the_working_directory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    load(ARM)  # the process is there, with another working directory
    monkeypatch.chdir(tmp_path)
    (tmp_path / "part.xml").write_text('<mujocoinclude><option gravity="0 0 -1"/></mujocoinclude>')
    robot = load(ARM.replace("<worldbody>", '<include file="part.xml"/><worldbody>'))
    assert robot.model.gravity.tolist() == [0.0, 0.0, -1.0]


def test_threads_compile_at_the_same_time() -> None:
    texts = [ARM.replace('"arm"', f'"arm{i}"') for i in range(6)]
    with ThreadPoolExecutor(3) as pool:
        assert [r.model.name for r in pool.map(ulna.load, texts)] == [f"arm{i}" for i in range(6)]


def test_an_interrupt_ends_the_process(monkeypatch: pytest.MonkeyPatch) -> None:
    started: list[subprocess.Popen] = []

    class Recorded(subprocess.Popen):
        def __init__(self, *args: object, **named: object) -> None:
            super().__init__(*args, **named)  # type: ignore[arg-type, call-overload]
            started.append(self)
            threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT)).start()

    mjcf_child._end_waiting()
    monkeypatch.setattr(subprocess, "Popen", Recorded)
    with pytest.raises(KeyboardInterrupt):
        ulna.load(ENDLESS)
    assert len(started) == 1 and started[0].poll() is not None


SCRIPT = """
import os, sys
{before}
import ulna
from ulna.formats.mjcf_child import _CompilerProcess
print(ulna.load({arm!r}).nq, _CompilerProcess._waiting._process.pid, flush=True)
{after}
"""


@pytest.mark.skipif(os.name != "posix", reason="closes descriptors and forks")
@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("os.close(0)", ""),
        ("os.close(0); os.close(2)", ""),
        ("sys.modules.pop('__main__')", ""),
        (
            "",
            f"pid = os.fork()\nif pid == 0: print(ulna.load({ARM!r}).nq, flush=True); os._exit(0)\nos.waitpid(pid, 0)",
        ),
        ("", "os._exit(0)"),
    ],
    ids=["no-stdin", "no-stderr", "no-main", "fork", "sudden-end"],
)
def test_odd_programs_load_too_and_leave_no_process(before: str, after: str) -> None:
    script = SCRIPT.format(before=before, after=after, arm=ARM)
    done = subprocess.run(
        [sys.executable, "-"], input=script, capture_output=True, text=True, timeout=600, check=False
    )
    words = done.stdout.split()
    assert words[0] == "1", done.stderr
    assert len(words) == (3 if "fork" in after else 2)
    if os.path.isdir("/proc"):
        deadline = time.monotonic() + 300.0
        while _runs(int(words[1])) and time.monotonic() < deadline:
            time.sleep(0.05)
        assert not _runs(int(words[1]))


def _runs(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False
