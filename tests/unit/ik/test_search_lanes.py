"""Searches in 1, 2, 4 or 8 lanes: each finds configurations that reach the goals; other numbers are refused."""

from __future__ import annotations

import numpy as np
import pytest

from ulna import load
from ulna.compiler import compile
from ulna.errors import InputError
from ulna.ik import search
from ulna.ik.arguments import default_start, problem_of, shift_of


@pytest.fixture(scope="module")
def panda():
    robot = load("panda")
    return robot, problem_of(robot.model, [robot.tool], None, None)


@pytest.mark.parametrize("lanes", [1, 2, 4])
def test_every_number_of_lanes_reaches_the_goals(panda, lanes):
    robot, problem = panda
    kernel = compile(search.multi_start(problem, lanes))
    rng, nq = np.random.default_rng(lanes), robot.nq
    start, shift = default_start(problem), shift_of(0, problem)
    for _ in range(20):
        T = robot.fk(robot.random_configuration(seed=int(rng.integers(2**30))))
        raw = kernel(T, start, shift, np.array([1e-12, 1e-12, 0.0, 8000.0 / lanes]))
        assert raw[nq] == 1.0
        np.testing.assert_allclose(robot.fk(raw[:nq]), T, atol=3e-6)


def test_other_numbers_of_lanes_are_refused(panda):
    with pytest.raises(InputError, match="`lanes` is 3; expected 1, 2, 4 or 8"):
        search.multi_start(panda[1], 3)
