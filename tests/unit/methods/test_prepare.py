"""`robot.prepare` and `ulna prepare`: kernels compiled ahead by other processes."""

from __future__ import annotations

import contextlib
import os
import pickle
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ulna
from support.long_robots import long_robot
from ulna import cli, disk_cache
from ulna.errors import InputError, ModelError, UnknownName
from ulna.methods.background_compilation import Preparation
from ulna.model import Revolute

LONG = 120.0  # s; a guard against hanging


def pendulum(length: float = 0.3) -> ulna.Robot:
    """A small robot; another length makes other code."""
    return hinged(ulna.Inertia(1.0, np.array([0.0, 0.0, -length]), np.eye(3) * 0.01))


def hinged(inertia: ulna.Inertia | None = None) -> ulna.Robot:
    builder = ulna.ModelBuilder("pendulum").add_link("base").add_link("bob", inertia)
    builder.add_joint("hinge", Revolute((0.0, 1.0, 0.0)), "base", "bob")
    return ulna.Robot(builder.build())


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "cache"
    monkeypatch.setenv("ULNA_CACHE", str(folder))
    return folder


def test_workers_compile_and_this_process_only_loads(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from ulna.compiler.runtime import jit

    robot, compiled = pendulum(0.31), []
    original = jit._object
    monkeypatch.setattr(jit, "_object", lambda *given: compiled.append(given) or original(*given))
    preparation = robot.prepare("fk", "mass_matrix", workers=1)
    assert preparation.wait(LONG) and set(preparation.done) == {"fk", "mass_matrix"}
    assert (
        preparation.pending == ()
        and preparation.errors == {}
        and set(preparation.seconds) == set(preparation.done)
    )
    assert "2 of 2" in repr(preparation)
    robot.fk([0.1])
    robot.fk(np.zeros((5, 1)))
    robot.mass_matrix([0.1])
    robot.mass_matrix(np.zeros((5, 1)))
    assert compiled == [] and len(disk_cache.entries(place)) > 4


def test_what_was_prepared_before_needs_no_worker(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert pendulum(0.32).prepare("fk", workers=1).wait(LONG)
    monkeypatch.setattr(Preparation, "_new_process", lambda self: pytest.fail("a worker was started"))
    again = pendulum(0.32).prepare("fk", workers=1)
    assert again.wait(LONG) and again.done == ("fk",) and list(again.as_ready()) == ["fk"]


@pytest.mark.parametrize("cache", ["0", "on"])
def test_without_workers_a_thread_compiles(cache: str, place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    if cache == "0":
        monkeypatch.setenv("ULNA_CACHE", "0")
    monkeypatch.setattr(Preparation, "_new_process", lambda self: pytest.fail("a worker was started"))
    robot = pendulum(0.33)
    assert robot.prepare("fk", workers=4 if cache == "0" else 0).wait(LONG)
    assert hasattr(robot._kernels, "fk")


@pytest.mark.parametrize("program", ["import sys; sys.exit(1)", "import sys; sys.stdin.buffer.read(5)", None])
def test_workers_that_fail_cost_only_time(program: Any, place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from ulna.methods import background_compilation as module

    if program is None:
        monkeypatch.setattr(sys, "executable", str(place / "nothing"))
    else:
        monkeypatch.setattr(module, "_WORKER", program)
    made = pendulum(0.34).prepare("fk", "gravity_forces", workers=2)
    assert made.wait(LONG) and set(made.done) == {"fk", "gravity_forces"}


def test_mistakes_raise_at_once_and_name_the_nearest(place: Path) -> None:
    robot = pendulum(0.35)
    with pytest.raises(UnknownName, match="mass_matrx.*'mass_matrix'"):
        robot.prepare("fk", "mass_matrx")
    with pytest.raises(UnknownName, match="'bobb'.*'bob'"):
        robot.prepare("fk", frame="bobb")
    with pytest.raises(UnknownName, match="'bobb'.*'bob'"):
        robot.prepare("fk", frame=["base", "bobb"])
    with pytest.raises(UnknownName, match="option of fk.*'refrence'"):
        robot.prepare("fk", refrence="local")
    with pytest.raises(UnknownName, match="'lokal'.*'local'"):
        robot.prepare("jacobian", reference="lokal")
    with pytest.raises(InputError, match=r"`names` holds \['fk'\]; expected names one after the other"):
        robot.prepare(["fk"])  # type: ignore[arg-type]
    for workers in (-1, 1.5, "two"):
        with pytest.raises(InputError, match="workers.*expected a whole number"):
            robot.prepare("fk", workers=workers)  # type: ignore[arg-type]


def test_kernels_that_cannot_be_made_raise_only_where_they_were_named(place: Path) -> None:
    robot = hinged()
    named = robot.prepare("forward_dynamics", "fk", workers=0)
    with pytest.raises(ModelError, match="hinge"):
        named.wait(LONG)
    assert named.done == ("fk",) and set(named.errors) == {"forward_dynamics"}
    daily = robot.prepare(workers=0)
    assert daily.wait(LONG) and "forward_dynamics" in daily.errors and "fk" in daily.done


def test_options_reach_the_kernels_that_have_them(place: Path) -> None:
    robot = pendulum(0.36)
    assert robot.prepare("fk", "jacobian", "gravity_forces", frame="base", reference="local", workers=0).wait(
        LONG
    )
    assert "base" in robot._by_options["fk"] and "local" in robot._by_options["jacobian"]["base"]


def test_cancelled_preparations_end_their_workers(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from ulna.methods import background_compilation as module

    monkeypatch.setattr(module, "_WORKER", "import sys, time; sys.stdin.buffer.read(5); time.sleep(1000)")
    preparation = pendulum(0.37).prepare("fk", workers=1)
    assert not preparation.wait(0.05)
    preparation.cancel()
    assert preparation.wait(LONG) and preparation.done == ()
    began = time.monotonic()
    while any(process.poll() is None for process in preparation._processes):
        assert time.monotonic() < began + LONG
        time.sleep(0.01)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
def test_a_forked_child_does_not_wait_for_workers_of_its_parent(
    place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from ulna.methods import background_compilation as module

    monkeypatch.setattr(module, "_WORKER", "import sys, time; sys.stdin.buffer.read(5); time.sleep(1000)")
    preparation = pendulum(0.38).prepare("fk", workers=1)
    child = os.fork()
    if child == 0:
        code = 1
        try:
            code = 0 if preparation.wait(LONG) and preparation._processes == [] else 1
        finally:
            os._exit(code)
    assert os.waitpid(child, 0)[1] == 0
    assert preparation.pending == ("fk",)  # still at work here
    preparation.cancel()


@pytest.mark.slow
def test_kernels_that_loop_over_joints_are_prepared(place: Path) -> None:
    robot = ulna.Robot(long_robot(1000))
    preparation = robot.prepare("inverse_dynamics", workers=0)
    assert preparation.wait(LONG) and preparation.done == ("inverse_dynamics",)


def test_the_task_of_a_worker_makes_kernels(place: Path) -> None:
    from ulna.methods.prepare_method import _Maker

    make = pickle.loads(pickle.dumps(_Maker(pendulum(0.39), {"frame": "bob"})))
    make("fk")
    with pytest.raises(InputError, match="mask"):  # one joint meets no whole pose
        make("ik")
    assert "bob" in make.robot._by_options["fk"]


def test_the_command_shows_what_is_ready(place: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["prepare", "ur5", "--kernel", "fk,gravity_forces", "--workers", "0"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("1 of 2: fk, ") and lines[1].startswith("2 of 2: gravity_forces, ")
    assert str(place) in lines[-1]


def test_the_command_refuses_what_it_cannot_do(
    place: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert cli.main(["prepare", "ur5", "--kernel", "fkk"]) == 2
    assert "Did you mean 'fk'" in capsys.readouterr().err
    monkeypatch.setenv("ULNA_CACHE", "0")
    assert cli.main(["prepare", "ur5"]) == 2
    assert "The cache is off" in capsys.readouterr().err


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_ctrl_c_ends_the_command_and_its_workers(place: Path) -> None:
    code = (
        "import ulna.methods.background_compilation as m; m._WORKER = 'import sys; sys.stdin.buffer.read()';"
        "import ulna.cli, sys; sys.exit(ulna.cli.main(['prepare', 'ur5', '--kernel', 'fk,jacobian']))"
    )
    program = subprocess.Popen(
        [sys.executable, "-c", code], stderr=subprocess.PIPE, start_new_session=True, text=True
    )
    began = time.monotonic()
    while Path("/proc/self/task").exists() and not _children(program.pid) and time.monotonic() < began + LONG:
        time.sleep(0.05)
    time.sleep(0.2)
    program.send_signal(signal.SIGINT)
    _, errors = program.communicate(timeout=LONG)
    assert program.returncode == 130 and "Traceback" not in errors, errors
    with pytest.raises(ProcessLookupError):  # the whole group has ended
        began = time.monotonic()
        while time.monotonic() < began + LONG:
            os.killpg(program.pid, 0)
            time.sleep(0.05)


def _children(pid: int) -> list[str]:
    found = []
    for task in Path(f"/proc/{pid}/task").glob("*/children"):
        with contextlib.suppress(OSError):
            found += task.read_text().split()
    return found
