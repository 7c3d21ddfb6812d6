"""Solvers of inverse kinematics as objects: each answers as the robot's method of its name does, and with its own steps."""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using


@pytest.fixture(scope="module")
def rtb() -> Iterator[Any]:
    with using("roboticstoolbox"):
        yield importlib.import_module("roboticstoolbox")


def test_a_solver_answers_as_the_method_of_its_name(rtb: Any) -> None:
    panda = rtb.models.Panda()
    goal, q0 = panda.fkine(panda.qr + 0.05), panda.qr
    rounds = {}
    for kind, options in (("LM", {}), ("NR", {"pinv": True}), ("GN", {"pinv": True}), ("QP", {"kj": 1.0})):
        mine = getattr(rtb, f"IK_{kind}")(**options).solve(panda.ets(), goal, q0)
        robots = getattr(panda, f"ikine_{kind}")(goal, q0=q0, **options)
        assert mine.success and robots.success
        np.testing.assert_array_equal(mine.q, robots.q)  # the same steps, to the last bit
        assert mine.iterations == robots.iterations
        rounds[kind] = mine.q
    assert np.abs(rounds["QP"] - rounds["LM"]).max() > 1e-9


def test_an_answer_is_true_where_it_was_found(rtb: Any) -> None:
    panda = rtb.models.Panda()
    reached = panda.ikine_LM(panda.fkine(panda.qr), q0=panda.qr)
    far = panda.fkine(panda.qr)
    far.t[0] += 9.0
    missed = panda.ikine_LM(far, q0=panda.qr, slimit=1, ilimit=2)
    assert bool(reached) is True and bool(missed) is False
    assert reached.success and not missed.success


def test_goals_in_the_plane_are_reached(rtb: Any) -> None:
    """Two links of 1 m reach a position by either elbow; with an angle that fits neither there is no answer."""
    arm = rtb.ETS2(rtb.ET2.R() * rtb.ET2.tx(1.0) * rtb.ET2.R() * rtb.ET2.tx(1.0))
    q = np.array([0.4, 0.9])
    goal = arm.eval(q)
    whole = arm.ikine_LM(goal, q0=[0.2, 0.5], joint_limits=False)
    assert whole.success
    np.testing.assert_allclose(arm.eval(whole.q), goal, atol=1e-3)
    turned = goal.copy()
    turned[:2, :2] = np.eye(2)
    assert not arm.ikine_LM(turned, q0=[0.2, 0.5], slimit=3, joint_limits=False).success
    placed = arm.ikine_LM(turned, q0=[0.2, 0.5], mask=[1, 1, 0], joint_limits=False)
    assert placed.success
    np.testing.assert_allclose(arm.eval(placed.q)[:2, 2], goal[:2, 2], atol=1e-3)
