"""Laws of constraints on SE(3) and of damped dynamics: what is computed is the derivative of what it should be."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pytest

from support.derivatives import along, by_configuration, by_vector
from support.random_models import random_model, random_pose
from ulna import algorithms as alg
from ulna.algorithms.constraints.bound_response import BoundResponse, bound_response
from ulna.algorithms.constraints.damped_dynamics import Damped, DampedMotion, damped_dynamics, damped_impact
from ulna.algorithms.constraints.dynamics_derivatives import bound_terms
from ulna.algorithms.constraints.frame_errors import constraint_twists, frame_of, relative_motion
from ulna.model import Model
from ulna.model.constraint import End, FramePair
from ulna.typing import Floats

SEEDS = range(2)
KINDS = ["revolute", "universal", "prismatic", "revolute", "spherical", "helical", "continuous", "revolute"]
GAINS = np.array([[7.0, 2.0], [5.0, 3.0], [0.0, 1.0], [4.0, 0.0], [2.0, 2.0]])


class Derivatives(NamedTuple):
    """Those of accelerations and forces by q and v."""

    a_q: Floats
    a_v: Floats
    f_q: Floats
    f_v: Floats


def bound_derivatives(response: BoundResponse) -> Derivatives:
    n = len(response.a_tau)
    changes = response.W @ response.B
    a, f = changes[:n], changes[n:]
    return Derivatives(a[:, :n], a[:, n:], f[:, :n] + response.X_q, f[:, n:])


def tree(seed: int) -> Model:
    return random_model(np.random.default_rng(seed), KINDS, root="free_flyer" if seed % 2 else None, mimics=1)


def frame_pairs(model: Model, seed: int) -> list[FramePair]:
    """Points and frames, held in the world and to each other, along either axes, on one branch and on two."""
    rng = np.random.default_rng(100 + seed)
    last = len(model.joints) - 1

    def end(joint: int) -> End:
        return End(joint, random_pose(rng))

    return [
        FramePair(end(last), end(-1), 3, local=True),
        FramePair(end(last - 1), end(1), 3, local=False),
        FramePair(end(2), end(last), 6, local=True),
        FramePair(end(-1), end(3), 3, local=True),
        FramePair(end(last - 2), end(-1), 6, local=False),
    ]


def state(model: Model, seed: int) -> tuple[Floats, ...]:
    rng = np.random.default_rng(seed)
    return alg.random(model, rng), *rng.standard_normal((3, model.nv))


def close(actual: Floats, expected: Floats, tolerance: float) -> None:
    scale = max(1.0, float(np.abs(expected).max(initial=0.0)))
    np.testing.assert_allclose(actual, expected, rtol=0.0, atol=tolerance * scale)


def solved(
    model: Model, found: list[FramePair], q: Floats, v: Floats, tau: Floats, wanted: Floats, damped: Damped
) -> DampedMotion:
    owner = [i for i, frame_pair in enumerate(found) for _ in range(frame_pair.size)]
    twists = constraint_twists(model, q, v, found)
    pull = GAINS[owner, 1] * twists.velocity + GAINS[owner, 0] * twists.error
    return damped_dynamics(model, q, v, tau, twists.J, twists.bias + pull - wanted, damped)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_bias_in_local_axes_is_the_rate_of_the_velocity(seed: int) -> None:
    model = tree(seed)
    q, v, _, _ = state(model, seed)
    frame_pair = frame_pairs(model, seed)[2]
    assert frame_pair.local and frame_pair.size == 6
    twists = constraint_twists(model, q, v, [frame_pair])
    close(twists.velocity, twists.J @ v, 1e-12)
    close(
        twists.bias, along(model, q, v, lambda x: constraint_twists(model, x, v, [frame_pair]).velocity), 1e-8
    )


@pytest.mark.parametrize("seed", SEEDS)
def test_spatial_accelerations_meet(seed: int) -> None:
    """Along the world's axes J a + k'' is the difference of the spatial accelerations at the first frame."""
    model = tree(seed)
    q, v, a, _ = state(model, seed)
    frame_pair = FramePair(
        frame_pairs(model, seed)[2].first, frame_pairs(model, seed)[2].second, 6, local=False
    )
    twists = constraint_twists(model, q, v, [frame_pair])
    assert frame_pair.second is not None
    origin = alg.frame_pose(model, q, frame_of(frame_pair.first)).translation
    one, other = (
        alg.frame_acceleration(model, q, v, a, frame_of(end), "world")
        for end in (frame_pair.first, frame_pair.second)
    )
    linear = one.linear - other.linear + np.cross(one.angular - other.angular, origin)
    close(twists.J @ a + twists.bias, np.concatenate([linear, one.angular - other.angular]), 1e-9)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_error_of_a_frame_is_its_logarithm(seed: int) -> None:
    model = tree(seed)
    q, v, _, _ = state(model, seed)
    for frame_pair in frame_pairs(model, seed):
        assert frame_pair.second is not None
        T = alg.frame_pose(model, q, frame_of(frame_pair.first))
        between = alg.frame_pose(model, q, frame_of(frame_pair.second)).inverse() @ T
        e = constraint_twists(model, q, v, [frame_pair]).error
        axes = np.eye(3) if frame_pair.local else T.rotation.T
        if frame_pair.size == 6:
            close(np.concatenate([axes @ e[:3], axes @ e[3:]]), between.log().vector(), 1e-12)
        else:
            close(axes @ e, between.rotation.T @ between.translation, 1e-12)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_motion_of_the_second_frame_in_the_first_one(seed: int) -> None:
    """The place of a point, its velocity and acceleration are rates of each other; so are twist and its rate."""
    model = tree(seed)
    q, v, a, _ = state(model, seed)
    for frame_pair in frame_pairs(model, seed)[1:3]:
        motion = relative_motion(model, q, v, a, frame_pair)
        close(motion.velocity, motion.J @ v, 1e-12)

        def parts(x: Floats, frame_pair: FramePair = frame_pair) -> Floats:
            at_rest = relative_motion(model, x, v, 0.0 * a, frame_pair)
            return np.concatenate([at_rest.place, at_rest.velocity], axis=-1)

        rates = along(model, q, v, parts)
        if frame_pair.size == 3:
            close(motion.velocity, rates[:3], 1e-8)
        close(motion.acceleration, rates[frame_pair.size :] + motion.J @ a, 1e-8)


@pytest.mark.parametrize("rounds", [1, 3])
@pytest.mark.parametrize("seed", SEEDS)
def test_rounds_are_those_of_the_proximal_point_algorithm(seed: int, rounds: int) -> None:
    model = tree(seed)
    q, v, _, tau = state(model, seed)
    found, mu = frame_pairs(model, seed)[:2], 0.3
    wanted = np.arange(6.0)
    motion = solved(model, found, q, v, tau, wanted, Damped(mu, 0.0, 0.0, rounds))
    twists = constraint_twists(model, q, v, found)
    owner = [0] * 3 + [1] * 3
    g = twists.bias + GAINS[owner, 1] * twists.velocity + GAINS[owner, 0] * twists.error - wanted
    M, h = alg.mass_matrix(model, q), alg.bias_forces(model, q, v)
    G = twists.J @ np.linalg.solve(M, twists.J.T)
    b = -(twists.J @ np.linalg.solve(M, tau - h) + g)
    f: Any = np.zeros(6)
    for _ in range(rounds):
        before, f = f, np.linalg.solve(G + mu * np.eye(6), b + mu * f)
    close(motion.forces, f, 1e-9)
    close(M @ motion.a + h, tau + twists.J.T @ f, 1e-9)
    assert int(motion.rounds) == rounds
    close(motion.change, np.abs(f - before).max(), 1e-9)
    close(motion.residual, mu * motion.change, 1e-9)


def test_rounds_end_when_what_is_left_is_small_enough() -> None:
    model = tree(0)
    q, v, _, tau = state(model, 0)
    found = frame_pairs(model, 0)[:1]
    for change, residual in ((1e-6, 0.0), (0.0, 1e-6)):
        motion = solved(model, found, q, v, tau, np.zeros(3), Damped(1e-2, change, residual, 200))
        assert 1 < motion.rounds < 200
        assert motion.change <= change or motion.residual <= residual * (1.0 + 1e-6)


@pytest.mark.parametrize("rounds", [1, 3])
@pytest.mark.parametrize("seed", SEEDS)
def test_derivatives_of_damped_dynamics(seed: int, rounds: int) -> None:
    """By v and tau after any rounds; by q after one, or after as many as leave nothing."""
    model = tree(seed)
    q, v, _, tau = state(model, seed)
    found, mu = frame_pairs(model, seed), 0.5
    wanted = np.linspace(-1.0, 1.0, sum(frame_pair.size for frame_pair in found))
    damped = Damped(mu, 0.0, 0.0, rounds)

    def f(q: Floats, v: Floats, tau: Floats) -> Floats:
        motion = solved(model, found, q, v, tau, wanted, damped)
        return np.concatenate([motion.a, motion.forces], axis=-1)

    here = solved(model, found, q, v, tau, wanted, damped)
    terms = bound_terms(model, q, v, here.a, here.forces, GAINS, wanted, found)
    response = bound_response(terms, mu, rounds)
    derived = bound_derivatives(response)
    close(np.vstack([derived.a_v, derived.f_v]), by_vector(v, lambda x: f(q, x, tau)).T, 1e-8)
    close(np.vstack([response.a_tau, response.f_tau]), by_vector(tau, lambda x: f(q, v, x)).T, 1e-8)
    if rounds == 1:
        close(
            np.vstack([derived.a_q, derived.f_q]), by_configuration(model, q, lambda x: f(x, v, tau)).T, 1e-6
        )


@pytest.mark.parametrize("seed", SEEDS)
def test_derivatives_of_impacts(seed: int) -> None:
    model = tree(seed)
    q, v, _, _ = state(model, seed)
    found, damped = frame_pairs(model, seed), Damped(0.5, 0.0, 0.0, 1)

    def f(q: Floats, v: Floats) -> Floats:
        twists = constraint_twists(model, q, v, found)
        jump = damped_impact(model, q, twists.J, 1.3 * twists.velocity, damped)
        return np.concatenate([jump.a, jump.forces], axis=-1)

    jump, impulses = f(q, v)[: model.nv], f(q, v)[model.nv :]
    terms = bound_terms(model, q, 1.3 * v + jump, jump, impulses, GAINS, 0.0 * impulses, found, impact=True)
    terms = terms._replace(g_q=terms.c_q, g_v=1.3 * terms.J, r_v=0.0 * terms.r_v)
    derived = bound_derivatives(bound_response(terms, 0.5))
    close(np.vstack([derived.a_q, derived.f_q]), by_configuration(model, q, lambda x: f(x, v)).T, 1e-6)
    close(np.vstack([derived.a_v, derived.f_v]), by_vector(v, lambda x: f(q, x)).T, 1e-8)


@pytest.mark.parametrize("seed", SEEDS)
def test_an_impact_of_frames_leaves_them_at_rest(seed: int) -> None:
    model = tree(seed)
    q, v, _, _ = state(model, seed)
    found = frame_pairs(model, seed)[:2]
    twists = constraint_twists(model, q, v, found)
    impact = damped_impact(model, q, twists.J, 1.3 * twists.velocity, Damped(0.0, 0.0, 0.0, 1))
    close(twists.J @ (v + impact.a), -0.3 * twists.velocity, 1e-9)
    close(alg.mass_matrix(model, q) @ impact.a, twists.J.T @ impact.forces, 1e-9)
