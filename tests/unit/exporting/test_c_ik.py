"""Inverse kinematics as C: solutions within limits, near a start, the nearest out of reach, and refusals."""

from __future__ import annotations

import ctypes
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ulna
from support.c_library import STRICT, gcc, library
from ulna.model import with_tool
from ulna.spatial import SE3


class Report(ctypes.Structure):
    """`panda_ik_report`."""

    _fields_ = (
        ("steps", ctypes.c_int),
        ("start", ctypes.c_int),
        ("position", ctypes.c_double),
        ("rotation", ctypes.c_double),
    )


class Options(ctypes.Structure):
    """`panda_ik_options`."""

    _fields_ = (("position", ctypes.c_double), ("rotation", ctypes.c_double), ("attempts", ctypes.c_int))


Solve = Callable[..., tuple[int, Any, Report]]


@pytest.fixture(scope="module")
def solve(panda: ulna.Robot, tmp_path_factory: pytest.TempPathFactory) -> Solve:
    place = ulna.export(panda, "ik", to="c", path=tmp_path_factory.mktemp("c") / "ik")
    lib = library(place)

    def run(T: Any, q0: Any = None, options: Options | None = None) -> tuple[int, Any, Report]:
        T, q, report = np.ascontiguousarray(T, dtype=float), np.full(7, np.nan), Report()
        start = None if q0 is None else np.ascontiguousarray(q0, dtype=float)
        code = lib.panda_ik(
            ctypes.c_void_p(T.ctypes.data),
            None if start is None else ctypes.c_void_p(start.ctypes.data),
            None if options is None else ctypes.byref(options),
            ctypes.c_void_p(q.ctypes.data),
            ctypes.byref(report),
        )
        return code, q, report

    return run


def test_inverse_kinematics_finds_configurations_within_the_limits(panda: ulna.Robot, solve: Solve) -> None:
    rng, limits = np.random.default_rng(8), panda.limits
    for q in limits.lower + (limits.upper - limits.lower) * rng.random((100, 7)):
        T = panda.fk(q)
        code, found, report = solve(T)
        assert code == 1 and limits.contains(found)
        assert np.linalg.norm(panda.fk(found)[:3, 3] - T[:3, 3]) == pytest.approx(report.position, abs=1e-12)
        assert report.position <= 1e-6 and report.rotation <= 1.01e-6 and report.steps >= 1


def test_inverse_kinematics_stays_near_a_start(panda: ulna.Robot, solve: Solve) -> None:
    q = panda.configurations["qr"]
    for step in np.random.default_rng(9).uniform(-0.02, 0.02, (20, 7)):
        code, found, report = solve(panda.fk(q + step), q)
        assert code == 1 and report.start == 0 and abs(found - q).max() < 0.2


def test_inverse_kinematics_out_of_reach_returns_the_nearest(panda: ulna.Robot, solve: Solve) -> None:
    T = panda.fk(panda.configurations["qr"])
    T[:3, 3] = (3.0, 0.0, 0.3)
    code, found, report = solve(T, options=Options(1e-6, 1e-6, 50))
    assert code == 0 and panda.limits.contains(found)
    assert np.linalg.norm(panda.fk(found)[:3, 3] - T[:3, 3]) == pytest.approx(report.position, abs=1e-12)
    assert report.position == pytest.approx(panda.ik(T).position_error, rel=0.05)


def test_inverse_kinematics_refuses_what_is_no_pose(panda: ulna.Robot, solve: Solve) -> None:
    T = panda.fk(panda.configurations["qr"])
    endless = T.copy()
    endless[0, 3] = np.inf
    for wrong in (T * 2.0, T.T, np.zeros((4, 4)), np.full((4, 4), np.nan), endless):
        code, q, _ = solve(wrong)
        assert code == -1 and np.isnan(q).all()
    for options in (
        Options(0, 1, 9),
        Options(1, -1, 9),
        Options(1, np.nan, 9),
        Options(1, 1, 0),
        Options(np.inf, 1, 9),
    ):
        assert solve(T, None, options)[0] == -2
    assert solve(T, np.full(7, np.inf))[0] == -2
    assert solve(T, None, Options(1.0, 4.0, 1))[0] == 1


@pytest.mark.parametrize(
    "options",
    [
        {"joints": ["panda_joint1", "panda_joint2", "panda_joint4"], "mask": "position"},
        {"mask": "position+z"},
    ],
    ids=["some joints", "a direction"],
)
def test_searches_of_parts_of_a_pose_compile_without_warnings(
    panda: ulna.Robot, tmp_path: Path, options: dict[str, Any]
) -> None:
    place = ulna.export(panda, "ik", to="c", path=tmp_path / "x", **options)
    assert gcc(*STRICT, "-O1", *place.glob("*.c"), "-o", tmp_path / "test", "-lm").stderr == ""
    ran = subprocess.run([tmp_path / "test"], capture_output=True, text=True, timeout=600, check=False)
    assert ran.returncode == 0, ran.stdout


def test_both_hands_of_a_humanoid(tmp_path: Path) -> None:
    g1 = ulna.load("g1")
    hands = ["left_rubber_hand", "right_rubber_hand"]
    place = ulna.export(g1, "ik", to="c", path=tmp_path / "x", name="g", frame=hands)
    header = (place / "g.h").read_text()
    assert "frames left_rubber_hand, right_rubber_hand, in this order." in header and "T[32]" in header
    assert gcc(*STRICT, "-O1", *place.glob("*.c"), "-o", tmp_path / "test", "-lm").stderr == ""
    ran = subprocess.run([tmp_path / "test"], capture_output=True, text=True, timeout=600, check=False)
    assert ran.returncode == 0, ran.stdout


def test_names_of_frames_do_not_end_the_comment(tmp_path: Path) -> None:
    ur5, name = ulna.load("ur5").model, "a*/ b /*c\u00e4"
    robot = ulna.Robot(with_tool(ur5, ur5.tool, SE3.trans(0.0, 0.0, 0.1), name))
    header = ulna.export(robot, "ik", to="c", path=tmp_path / "x", name="g", frame=name) / "g.h"
    assert "a* / b / *c?" in header.read_text("ascii")
    done = gcc(*STRICT, "-fsyntax-only", header)
    assert done.returncode == 0, done.stderr
