"""Solvers of inverse kinematics as objects: each answers as the robot's method of its name does, and with its own steps."""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from support.shelf import worn


@pytest.fixture(scope="module")
def rtb() -> Iterator[Any]:
    with worn("roboticstoolbox"):
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
