"""Joining, sampling and saving trajectories with what is no tolerance, number of rows or path."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from ulna import trajectory
from ulna.errors import InputError
from ulna.trajectory import Trajectory, concatenate, quintic


@pytest.fixture
def move() -> Trajectory:
    return quintic([0.0, 0.0], [1.0, 2.0], duration=2.0)


@pytest.mark.parametrize("tolerance", [float("nan"), float("inf"), -1.0, "a", None])
def test_a_tolerance_that_is_none_lets_no_jump_pass(move: Trajectory, tolerance: Any) -> None:
    with pytest.raises(InputError, match="`tolerance` is .*expected a finite jump of zero or more"):
        concatenate(move, move, tolerance=tolerance)
    with pytest.raises(InputError, match="jumps by"):
        concatenate(move, move)
    assert concatenate(move, move, tolerance=2.0).duration == 4.0


@pytest.mark.parametrize("options", [{"rate": 1e15}, {"rate": 1e308}, {"n": 10**12}])
def test_rows_that_do_not_fit_are_refused(move: Trajectory, options: dict[str, Any]) -> None:
    with pytest.raises(InputError, match=r"expected (at most 1e\+08|a whole number, from 2 to 1)"):
        move.sample(**options)


@pytest.mark.parametrize("path", [None, 3, b"move.csv"])
def test_what_is_no_path_is_refused(move: Trajectory, path: Any) -> None:
    with pytest.raises(InputError, match="`path` is .*expected a file name that ends in .npz or .csv"):
        move.save(path)
    with pytest.raises(InputError, match="`path` is .*expected a file name that ends in .npz or .csv"):
        trajectory.load(path)


def test_a_path_is_a_name_too(move: Trajectory, tmp_path: Path) -> None:
    for path in (tmp_path / "move.npz", str(tmp_path / "other.npz")):
        move.save(path)
        assert trajectory.load(path).duration == 2.0
