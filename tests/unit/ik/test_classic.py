"""robot.ik_classic: the solvers of the textbooks."""

import numpy as np
import pytest

import ulna
from ulna.compiler import compile
from ulna.errors import InputError, UnknownName
from ulna.ik.arguments import problem_of
from ulna.ik.classic import DAMPING, bounded_move, move
from ulna.ik.problem import errors
from ulna.spatial import so3_log

METHODS = sorted(DAMPING)


@pytest.fixture(scope="module")
def panda():
    return ulna.load("panda")


@pytest.fixture(scope="module")
def goals(panda):
    return panda.fk(panda.random_configuration(150, seed=8))


@pytest.mark.parametrize("method", METHODS)
def test_every_method_meets_its_goals_within_the_limits(panda, goals, method):
    solution = panda.ik_classic(goals, method)
    assert solution.success.mean() > (0.9 if DAMPING[method] < 0.1 and method != "sugihara" else 0.97)
    met = solution.success
    assert np.abs(panda.fk(solution.q[met]) - goals[met]).max() < 2e-6
    assert panda.limits.contains(solution.q[met]).all()
    single = panda.ik_classic(goals[0], method)
    np.testing.assert_allclose(single.q, solution.q[0], atol=1e-6)
    assert (single.success, single.restarts) == (solution.success[0], solution.restarts[0])


def _one_move(robot, method, damping):
    """dq at q0 as the solver computes it, compiled."""
    problem = problem_of(robot.model, [robot.tool], None, None, radian=1.0, by_angle=True)

    def f(T, q):
        at = errors(problem, q, [T], np.zeros(2))
        return bounded_move(problem, q, at, damping, None) if method == "qp" else move(at, method, damping)

    return compile(f, T=(4, 4), q=(robot.nq,))


@pytest.mark.parametrize("method", METHODS)
def test_a_step_is_the_published_one(panda, goals, method):
    q0 = np.array(panda.configurations["qr"])
    kernel = _one_move(panda, method, DAMPING[method])
    pose, J = panda.fk(q0), panda.jacobian(q0)
    for T in goals[:20]:
        e = np.concatenate([T[:3, 3] - pose[:3, 3], so3_log(T[:3, :3] @ pose[:3, :3].T)])
        energy = 0.5 * e @ e
        weight = {"wampler": 1e-4, "chan": energy, "sugihara": energy + 1e-4, "qp": energy}.get(method)
        if weight is None:
            expected = np.linalg.pinv(J) @ e
        else:
            expected = np.linalg.solve(J.T @ J + weight * np.eye(7), J.T @ e)
        found = kernel(T, q0)
        inside = panda.limits.contains(q0 + expected)
        if method != "qp" or inside:
            np.testing.assert_allclose(found, expected, rtol=1e-7, atol=1e-9)
        else:
            assert panda.limits.contains(q0 + found, 1e-12)


def test_null_motion_keeps_away_from_limits_and_seeks_manipulability(panda):
    goals = panda.fk(panda.random_configuration(1000, seed=9))
    plain = panda.ik_classic(goals, "chan", searches=1)
    away = panda.ik_classic(goals, "chan", limit_gain=1.0, iterations=60, searches=1)
    dexterous = panda.ik_classic(goals, "chan", manipulability_gain=5.0, searches=1)
    assert away.success.sum() > plain.success.sum() + 20
    both = plain.success & dexterous.success
    assert both.sum() > 400
    assert panda.manipulability(dexterous.q[both]).mean() > 1.02 * panda.manipulability(plain.q[both]).mean()


def test_the_quadratic_program_stays_within_limits_on_the_way(panda, goals):
    solution = panda.ik_classic(goals, "qp", searches=1)
    assert panda.limits.contains(solution.q, 1e-12).all()


def test_out_of_reach_and_wrong_input(panda, goals):
    far = goals[0].copy()
    far[:3, 3] += 4.0
    solution = panda.ik_classic(far, searches=3)
    assert not solution.success and solution.restarts == 3 and "stays" in solution.reason
    with pytest.raises(UnknownName, match="chan"):
        panda.ik_classic(far, "chen")
    with pytest.raises(InputError, match="searches"):
        panda.ik_classic(far, searches=0)
    with pytest.raises(InputError, match="influence"):
        panda.ik_classic(far, influence=0.0)
    with pytest.raises(InputError, match="not a rotation"):
        panda.ik_classic(far * 2.0)
