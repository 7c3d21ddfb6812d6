"""What trajectories refuse, and what the message names."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ulna.trajectory as tr
from ulna.errors import InputError, ShapeError, UnknownName
from ulna.spatial import SE3
from ulna.trajectory.compose import Retimed

POINTS = np.array([(0.0, 0.0), (1.0, 2.0), (3.0, 1.0)])
START, END = SE3.identity(), SE3(np.eye(3), np.array([1.0, 2.0, 3.0]))
PAIR = SE3(np.stack([np.eye(3)] * 2), np.array([(0.0, 0, 0), (1.0, 0, 0)]))

REFUSED: list[tuple[Callable[[], Any], type[Exception], str]] = [
    (
        lambda: tr.blended(POINTS, 0.1, velocity=1.0, kind="parabola"),
        UnknownName,
        "kind of blend.*'parabolic'",
    ),
    (lambda: tr.blended(POINTS, 0.1, velocity=1.0, ends="hlaf"), UnknownName, "kind of end.*'half'"),
    (lambda: tr.blended(POINTS, 0.1, velocity=1.0, ends="half"), InputError, 'expected kind="quintic"'),
    (lambda: tr.blended(POINTS[[0, 0, 1]], 0.1, velocity=1.0), InputError, "points"),
    (lambda: tr.blended(POINTS, 0.0, velocity=1.0), InputError, "blend"),
    (lambda: tr.blended(POINTS, 5.0, [1.0, 1.0]), InputError, "segment"),
    (
        lambda: tr.circle(START, (0, 0, 1), (1, 0, 0), 1.0, duration=1.0, orientation="turn"),
        UnknownName,
        "'turning'",
    ),
    (lambda: tr.pose_spline([START, END], [0.0, 1.0], interpolation="screwy"), UnknownName, "'screw'"),
    (
        lambda: tr.pose_spline([START, END], 1.0, through="no"),
        InputError,
        "`through` is .no.; expected True or False",
    ),
    (lambda: tr.pose_line(START, START, velocity=1.0, acceleration=1.0), InputError, "are the same pose"),
    (lambda: tr.pose_line(START, END), InputError, "neither was given"),
    (lambda: tr.pose_line(START, END, velocity=1.0), InputError, "expected two limits"),
    (lambda: tr.pose_line(PAIR, END, duration=1.0), ShapeError, r"\(4, 4\), one pose"),
    (lambda: tr.follow(tr.quintic(0.0, 1.0, 1.0), None, q0=[0.0]), InputError, "expected one of poses"),  # type: ignore[arg-type]
    (lambda: tr.follow(None, None, q0=[0.0]), InputError, "`trajectory` is None"),  # type: ignore[arg-type]
    (lambda: tr.load("motion.txt"), InputError, r"ends in \.npz or \.csv"),
    (lambda: tr.load("nothing.npz"), InputError, "There is no file 'nothing.npz'"),
]


@pytest.mark.parametrize(("call", "error", "text"), REFUSED, ids=[text for *_, text in REFUSED])
def test_it_is_refused(call: Callable[[], Any], error: type[Exception], text: str) -> None:
    with pytest.raises(error, match=text):
        call()


def test_files_that_are_no_trajectories(tmp_path: Path) -> None:
    folder = tmp_path / "folder.npz"
    folder.mkdir()
    with pytest.raises(InputError, match="cannot be read"):
        tr.load(folder)
    with pytest.raises(InputError, match=r"cannot be read: File name too long\.$"):
        tr.load(300 * "x" + ".csv")
    (tmp_path / "text.npz").write_text("this is no archive")
    with pytest.raises(InputError, match=r"is no \.npz file"):
        tr.load(tmp_path / "text.npz")
    np.savez(tmp_path / "other.npz", a=np.zeros(3))
    with pytest.raises(InputError, match="expected a trajectory that `save` wrote"):
        tr.load(tmp_path / "other.npz")
    motion = tr.quintic(np.zeros(2), np.ones(2), 1.5)
    tr.save(motion, tmp_path / "motion.npz")
    with np.load(tmp_path / "motion.npz") as archive:
        content = dict(archive)
    for name, wrong in (
        ("times", content["times"][::-1]),
        ("coefficients", content["coefficients"][:, :, :1]),
    ):
        np.savez(tmp_path / "wrong.npz", **(content | {name: wrong}))
        with pytest.raises(InputError, match=r"wrong\.npz"):
            tr.load(tmp_path / "wrong.npz")
    loaded = tr.load(tmp_path / "motion.npz")
    np.testing.assert_array_equal(loaded(0.7), motion(0.7))


@pytest.mark.parametrize("factor", [2.0, 0.5, -1.0, -3.0])
def test_a_path_is_stretched_and_turned_round(factor: float) -> None:
    path = tr.concatenate(
        tr.quintic(np.zeros(2), np.ones(2), 1.0), tr.quintic(np.ones(2), np.array([1.0, 3.0]), 0.5)
    )
    slow = Retimed.evenly(path, factor)
    assert slow.duration == pytest.approx(path.duration * abs(factor))
    for t in np.linspace(0.0, slow.duration, 8)[1:-1]:
        at = t / factor if factor > 0 else path.duration + t / factor
        q, v, a = path.state(at)
        position, velocity, acceleration = slow.state(t)
        np.testing.assert_allclose(position, q, atol=1e-12)
        np.testing.assert_allclose(velocity, v / factor, atol=1e-12)
        np.testing.assert_allclose(acceleration, a / factor**2, atol=1e-12)
    again = Retimed.evenly(slow, 2.0)
    np.testing.assert_allclose(again(0.4), slow(0.2), atol=1e-12)
