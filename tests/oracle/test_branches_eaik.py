"""All solutions against EAIK and IK-Geo: the same sets, on known arms and on random ones of their classes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import ulna
from support.random_arms import CLOSED, model_of
from ulna.formats.dh import model_from_dh, revolute
from ulna.ik.analytic import Arm, arm_of
from ulna.ik.analytic.chain import movable
from ulna.model import Model
from ulna.typing import Floats

eaik = pytest.importorskip("eaik.IK_HP")
ik_geo = pytest.importorskip("ik_geo")

_AGREED = 1e-5


def _arm(model: Model) -> Arm:
    end = model.frame(model.tool)
    return arm_of(model, end, movable(model, end), model.neutral)


def _offsets(arm: Arm) -> tuple[Floats, Floats]:
    """Directions (6, 3) and steps from axis to axis (7, 3): the notation of both peers."""
    points = [np.zeros(3), *(axis.line.point for axis in arm.axes), arm.end.translation]
    return np.array([axis.line.direction for axis in arm.axes]), np.diff(points, axis=0)


def _goals(arm: Arm, T: Floats) -> tuple[Floats, Floats]:
    """The peers know no rotation of the tool: the goal's rotation without it, and its position."""
    return T[:3, :3] @ arm.end.rotation.T, T[:3, 3]


def _eaik(arm: Arm) -> Any:
    H, P = _offsets(arm)
    peer = eaik.HPRobot(H, P)
    assert peer.hasKnownDecomposition()

    def solve(T: Floats) -> Floats:
        goal = np.eye(4)
        goal[:3, :3], goal[:3, 3] = _goals(arm, T)
        return np.array(peer.IK(goal).Q).reshape(-1, 6)

    return solve


def _ik_geo(arm: Arm, name: str) -> Any:
    H, P = _offsets(arm)
    peer = getattr(ik_geo.Robot, name)(H.tolist(), P.tolist())

    def solve(T: Floats) -> Floats:
        R, p = _goals(arm, T)
        return np.array([q for q, _ in peer.get_ik(R.T.tolist(), p.tolist())])  # takes columns.reshape(-1, 6)

    return solve


def _compare(model: Model, solve: Any, count: int, seed: int, all_of_theirs: bool = True) -> int:
    """Theirs that reach the pose are ours; ours are as many as the distinct ones of theirs, or more. Returns our count."""
    robot = ulna.Robot(model)
    Q = np.random.default_rng(seed).uniform(-np.pi, np.pi, (count, 6))
    T = robot.fk(Q)
    found = robot.ik_all(T, limits=False)
    assert found.complete
    for i in range(count):
        theirs = solve(T[i])
        theirs = theirs[np.abs(robot.fk(theirs) - T[i]).max(axis=(-2, -1)) < 1e-7] if len(theirs) else theirs
        ours = found[i].q
        gap = np.abs((theirs[:, None] - ours[None] + np.pi) % (2.0 * np.pi) - np.pi).max(axis=-1)
        assert (gap.min(axis=1) < _AGREED).all(), "a solution of theirs is not among ours"
        matched = (gap.min(axis=0) < _AGREED).sum() if len(theirs) else 0
        assert not all_of_theirs or matched == len(ours), "we have solutions that they have not"
    return int(found.count.sum())


def _puma560() -> Model:
    """Joint figures of the Puma 560 as published by Corke & Armstrong-Helouvry 1994."""
    rows = [
        revolute(d=0.0, a=0.0, alpha=np.pi / 2),
        revolute(d=0.0, a=0.4318, alpha=0.0),
        revolute(d=0.15005, a=0.0203, alpha=-np.pi / 2),
        revolute(d=0.4318, a=0.0, alpha=np.pi / 2),
        revolute(d=0.0, a=0.0, alpha=-np.pi / 2),
        revolute(d=0.0, a=0.0, alpha=0.0),
    ]
    return model_from_dh(rows)


def _abb() -> Model:
    """An arm like the ABB IRB 120: offset elbow, spherical wrist."""
    rows = [
        revolute(d=0.29, a=0.0, alpha=-np.pi / 2),
        revolute(d=0.0, a=0.27, alpha=0.0, offset=-np.pi / 2),
        revolute(d=0.0, a=0.07, alpha=-np.pi / 2),
        revolute(d=0.302, a=0.0, alpha=np.pi / 2),
        revolute(d=0.0, a=0.0, alpha=-np.pi / 2),
        revolute(d=0.072, a=0.0, alpha=0.0),
    ]
    return model_from_dh(rows)


def _ur5() -> Model:
    return ulna.load("ur5").model


@pytest.mark.parametrize("make", [_ur5, _puma560, _abb], ids=["ur5", "puma560", "irb120"])
def test_known_arms_have_the_solutions_of_eaik(make: Any) -> None:
    model = make()
    assert _compare(model, _eaik(_arm(model)), 200, 0) > 800


def test_a_ur5_has_the_solutions_of_ik_geo() -> None:
    model = _ur5()
    _compare(model, _ik_geo(_arm(model), "three_parallel_two_intersecting"), 200, 1)


UNKNOWN_TO_EAIK = ("spherical 2 3 4", "spherical 3 4 5, 1 parallel 2", "parallel 1 2 3", "parallel 4 5 6")


@pytest.mark.parametrize("name", [name for name in CLOSED if name not in UNKNOWN_TO_EAIK])
def test_random_arms_have_the_solutions_of_eaik(name: str) -> None:
    rng = np.random.default_rng(21)
    model = model_of(CLOSED[name](rng), rng)
    _compare(model, _eaik(_arm(model)), 40, 2, all_of_theirs=False)
