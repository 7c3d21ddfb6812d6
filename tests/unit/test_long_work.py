"""Long work shows how far it is, and Ctrl-C ends it."""

from __future__ import annotations

import io
import signal
import subprocess
import sys
import threading
import types
from collections.abc import Iterator

import numpy as np
import pytest

import ulna
from ulna.collision import covering
from ulna.compiler import compile
from ulna.compiler.procedures import procedure
from ulna.compiler.runtime import differentiate, jit
from ulna.ik import solve
from ulna.planning import Planner
from ulna.sim import dynamic, simulate
from ulna.system import progress as module


@pytest.fixture
def heard(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[tuple[str, str]]]:
    monkeypatch.setattr(module, "_DELAY", 0.0)
    monkeypatch.setattr(module, "_INTERVAL", 0.0)
    out: list[tuple[str, str]] = []

    def listen(what: str, how_far: str) -> None:
        out.append((what, how_far))

    module.watch(listen)
    yield out
    module.unwatch(listen)


@pytest.fixture(scope="module")
def ur5() -> ulna.Robot:
    return ulna.load("ur5", visuals="simple")


@pytest.mark.parametrize("with_start", [False, True])
def test_batches_of_inverse_kinematics(
    ur5: ulna.Robot, heard: list[tuple[str, str]], monkeypatch: pytest.MonkeyPatch, with_start: bool
) -> None:
    Q = ur5.random_configuration(1000, seed=1)
    T = ur5.fk(Q).reshape(10, 100, 4, 4)
    q0 = Q.reshape(10, 100, 6) + 0.1 if with_start else None
    whole = ur5.ik(T, q0)
    assert heard == []
    monkeypatch.setattr(solve, "_PART", 300)
    parts = ur5.ik(T, q0)
    assert heard[-1] == ("Inverse kinematics", "")
    assert parts.q.shape == (10, 100, 6)
    assert parts.success.mean() == whole.success.mean() == 1.0
    if with_start:
        np.testing.assert_array_equal(parts.q, whole.q)
        one_start = ur5.ik(T, Q[0])
        assert one_start.success.all()
    for wrong in (np.zeros((1000, 3, 3)), np.zeros((1000, 4, 4))):
        with pytest.raises(ulna.errors.InputError):
            ur5.ik(wrong, q0)


def test_many_plans(ur5: ulna.Robot, heard: list[tuple[str, str]]) -> None:
    planner = Planner(ur5)
    for threads in (1, 2):
        plans = planner.plan_all(np.zeros(6), np.full((3, 6), 0.1), threads=threads)
        assert all(plans)
        assert heard[-1] == ("Planning", "")
        heard.clear()


def test_spheres_that_cover_links(heard: list[tuple[str, str]], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(covering.cache, "read", lambda key: None)
    monkeypatch.setattr(covering.cache, "write", lambda key, content: None)
    arm = ulna.load(
        "<robot name='one'><link name='base'/><link name='bar'><collision><geometry><box size='0.1 0.1 0.3'/></geometry>"
        "</collision></link><joint name='j' type='continuous'><parent link='base'/><child link='bar'/></joint></robot>"
    )
    steps: list[int] = []
    covering.fit(arm, most=4, progress=lambda done, of: steps.append(done))
    assert steps and heard == []
    covering.fit(arm, most=4)
    assert heard[-1] == ("Covering links with spheres", "")


def test_compilation_of_a_procedure(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    heard: list[tuple[str, str]] = []
    monkeypatch.delenv("ULNA_QUIET", raising=False)
    monkeypatch.setattr(jit, "_LOOPS_SPEED", 1e-3)
    monkeypatch.setattr(jit, "_cached_object", lambda key: None)
    monkeypatch.setattr(jit, "watchers", [lambda what, how_far: heard.append((what, how_far))])

    @procedure
    def third(x: int) -> int:
        return x // 3

    assert third(12) == 4
    assert heard[0][0] == "Compiling third" and heard[-1] == ("Compiling third", "")
    assert "compiling third, about" in capsys.readouterr().err


def test_derivatives_with_many_sweeps(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    heard: list[tuple[str, str]] = []

    def interrupt(what: str, how_far: str) -> None:
        heard.append((what, how_far))
        if how_far:
            signal.raise_signal(signal.SIGINT)

    kernel = compile(lambda q: np.stack([np.sin(q[0]) * q[1], q[0] ** 3 * q[2]]), name="wave", q=(3,))
    monkeypatch.delenv("ULNA_QUIET", raising=False)
    monkeypatch.setattr(differentiate, "_SECONDS", 10.0)
    monkeypatch.setattr(jit, "watchers", [interrupt])
    with pytest.raises(KeyboardInterrupt):
        kernel.jacobian()
    assert heard == [("Differentiating wave", heard[0][1])] or heard[-1] == ("Differentiating wave", "")
    assert "differentiating wave (2 sweeps over" in capsys.readouterr().err
    monkeypatch.setattr(jit, "watchers", [lambda what, how_far: heard.append((what, how_far))])
    for derive, said in (
        (kernel.hessian, "8 sweeps over"),
        (kernel.vjp, "one sweep over"),
        (kernel.jacobian, "2 sweeps over"),
    ):
        derivative = derive()
        assert heard[-1] == ("Differentiating wave", "")
        assert said in capsys.readouterr().err
    q = np.array([0.3, -0.4, 0.7])
    np.testing.assert_allclose(
        derivative(q), [[np.cos(0.3) * -0.4, np.sin(0.3), 0.0], [3 * 0.09 * 0.7, 0.0, 0.027]]
    )
    monkeypatch.setattr(differentiate, "_SECONDS", 1.5e-5)
    heard.clear()
    kernel.jacobian()
    assert heard == []


def test_simulations(ur5: ulna.Robot, heard: list[tuple[str, str]], monkeypatch: pytest.MonkeyPatch) -> None:
    short = simulate(ur5, ur5.neutral, duration=0.05)
    assert heard == []
    monkeypatch.setattr(dynamic, "_PROGRESS_STEPS", 10)
    long = simulate(ur5, ur5.neutral, duration=0.05)
    np.testing.assert_array_equal(long.q, short.q)
    assert heard[-1] == ("Simulating", "")


def test_it_is_printed_where_somebody_reads_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("ULNA_QUIET", raising=False)

    class Cell(io.StringIO):  # as the error stream below a cell, which is no terminal
        pass

    for place, printed in (("ipykernel.iostream", True), ("io", False)):
        monkeypatch.setattr(Cell, "__module__", place)
        monkeypatch.setattr(sys, "stderr", Cell())
        assert module._notebook() is printed
        assert not module._terminal()
    monkeypatch.setattr(Cell, "__module__", "ipykernel.iostream")
    monkeypatch.setenv("ULNA_QUIET", "1")
    assert not module._notebook()


def test_it_leaves_an_empty_output_below_a_cell(monkeypatch: pytest.MonkeyPatch) -> None:
    shown: list[str] = []

    class Handle:
        def update(self, data: dict[str, str], *, raw: bool) -> None:
            shown.append(data["text/plain"])

    def display(data: dict[str, str], *, raw: bool, display_id: bool) -> Handle:
        shown.append(data["text/plain"])
        return Handle()

    monkeypatch.setitem(sys.modules, "IPython", types.ModuleType("IPython"))
    monkeypatch.setitem(sys.modules, "IPython.display", types.SimpleNamespace(display=display))
    monkeypatch.setattr(module, "_notebook", lambda: True)
    monkeypatch.setattr(module, "_DELAY", 0.0)
    monkeypatch.setattr(module, "_INTERVAL", 0.0)
    reached = threading.Event()

    def listen(what: str, how_far: str) -> None:
        if how_far == "2 of 3":
            reached.set()

    module.watch(listen)
    try:
        with module.progress("Loading") as report:
            report(2, 3)
            assert reached.wait(120.0)
    finally:
        module.unwatch(listen)
    assert shown[-2:] == ["Loading: 2 of 3", ""]


@pytest.mark.slow
def test_ctrl_c_ends_a_batch() -> None:
    program = """
import os, signal, threading, numpy as np, ulna
robot = ulna.load("panda", visuals="simple")
T = robot.fk(robot.random_configuration(100_000, seed=1))
robot.ik(T[:1000])
T = np.tile(T, (100, 1, 1))
try:
    threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    robot.ik(T)
except KeyboardInterrupt:
    print("ended")
"""
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, timeout=600, check=False
    )
    assert done.stdout == "ended\n", done.stderr
