"""Long work shows how far it is, and Ctrl-C ends it."""

from __future__ import annotations

import io
import subprocess
import sys
from collections.abc import Iterator

import numpy as np
import pytest

import ulna
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


def test_simulations(ur5: ulna.Robot, heard: list[tuple[str, str]], monkeypatch: pytest.MonkeyPatch) -> None:
    short = simulate(ur5, ur5.neutral, duration=0.05)
    assert heard == []
    monkeypatch.setattr(dynamic, "_LONG", 10)
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
        assert module._terminal() is printed
    monkeypatch.setattr(Cell, "__module__", "ipykernel.iostream")
    monkeypatch.setenv("ULNA_QUIET", "1")
    assert not module._terminal()


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
