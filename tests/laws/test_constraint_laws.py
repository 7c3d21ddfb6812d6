"""Laws of constraints: derivatives of each other, the equations of motion, impacts, redundancy, a linkage by hand."""

from __future__ import annotations

import numpy as np
import pytest

from support.derivatives import along
from support.random_models import random_model, random_pose
from ulna import algorithms as alg
from ulna.algorithms import Proximal, Stabilisation
from ulna.model import (
    Constraint,
    FrameContact,
    FrameLoop,
    Model,
    ModelBuilder,
    PointContact,
    PointLoop,
    Revolute,
)
from ulna.model.constraint import frame_pairs
from ulna.robot import Robot
from ulna.spatial import SE3, Inertia
from ulna.typing import Floats

SEEDS = range(3)


def tree(seed: int) -> Model:
    kinds = [
        "revolute",
        "universal",
        "prismatic",
        "revolute",
        "spherical",
        "helical",
        "continuous",
        "revolute",
    ]
    return random_model(np.random.default_rng(seed), kinds, root="free_flyer" if seed % 2 else None, mimics=1)


def held(seed: int) -> list[Constraint]:
    """One constraint of each kind, on different bodies."""
    rng = np.random.default_rng(100 + seed)
    return [
        PointContact("tip", tuple(rng.uniform(-0.2, 0.2, 3))),
        FrameLoop("side", "link1", random_pose(rng), random_pose(rng)),
        PointLoop("tip", "link2", (0.1, 0.0, 0.2), (0.0, -0.3, 0.1)),
        FrameContact("side", random_pose(rng)),
    ]


def state(model: Model, seed: int) -> tuple[Floats, Floats, Floats]:
    rng = np.random.default_rng(seed)
    return alg.random(model, rng), *rng.standard_normal((2, model.nv))


def close(actual: Floats, expected: Floats, tolerance: float = 1e-9) -> None:
    scale = max(1.0, float(np.abs(expected).max(initial=0.0)))
    np.testing.assert_allclose(actual, expected, rtol=0.0, atol=tolerance * scale)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_velocity_is_the_rate_of_the_error(seed: int) -> None:
    """Of points everywhere; of frames where they are closed."""
    model = tree(seed)
    q, v, _ = state(model, seed)
    for given in held(seed):
        constraint, anchors = given, None
        if constraint.is_contact:
            anchors = Robot(model).constraint_anchors(q, [constraint])
        elif constraint.size == 6:
            (a, pose_a), (b, _) = constraint.ends()
            here = alg.frame_pose(model, q, model.frame(a)) @ pose_a
            there = alg.frame_pose(model, q, model.frame(b)).inverse() @ here
            constraint = FrameLoop(a, b, pose_a, there)
        found = frame_pairs(model, [constraint])
        rate = along(model, q, v, lambda x, f=found, at=anchors: alg.constraint_error(model, x, at, f))
        close(alg.constraint_velocity(model, q, v, found), rate, 1e-7)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_bias_is_the_rate_of_the_velocity(seed: int) -> None:
    model = tree(seed)
    q, v, _ = state(model, seed)
    for constraint in held(seed):
        found = frame_pairs(model, [constraint])
        rate = along(model, q, v, lambda x, f=found: alg.constraint_velocity(model, x, v, f))
        close(alg.constraint_bias(model, q, v, found), rate, 1e-7)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("mu", [0.0, 1e-8])
def test_the_equations_of_motion_hold(seed: int, mu: float) -> None:
    model = tree(seed)
    q, v, tau = state(model, seed)
    found = frame_pairs(model, held(seed)[:1])
    pull = Stabilisation(np.eye(4)[None], np.array([[9.0, 2.0]]))
    motion = alg.constrained_dynamics(model, q, v, tau, found, None, pull, Proximal(mu=mu))
    J = alg.constraint_jacobian(model, q, found)
    c, e = J @ v, alg.constraint_error(model, q, pull.anchors, found)
    close(J @ motion.a + alg.constraint_bias(model, q, v, found) + 2.0 * c + 9.0 * e, 0.0 * e, 1e-8)
    close(alg.inverse_dynamics(model, q, v, motion.a), tau + J.T @ motion.forces, 1e-8)
    assert motion.residual < 1e-8


@pytest.mark.parametrize("seed", SEEDS)
def test_too_many_constraints_are_kept_in_the_sense_of_least_squares(seed: int) -> None:
    """No force reduces what remains of the errors, and the forces have no part that causes no motion."""
    model = tree(seed)
    q, v, tau = state(model, seed)
    found = frame_pairs(model, held(seed))
    motion = alg.constrained_dynamics(model, q, v, tau, found)
    J = alg.constraint_jacobian(model, q, found)
    left = J @ motion.a + alg.constraint_bias(model, q, v, found)
    assert motion.residual == pytest.approx(np.abs(left).max(), rel=1e-6)
    close(J.T @ left / np.abs(J.T).sum(axis=1).max(), 0.0 * tau, 1e-5)
    f = motion.forces
    close(np.linalg.pinv(J.T, rcond=1e-10) @ (J.T @ f), f, 1e-4)
    close(alg.inverse_dynamics(model, q, v, motion.a), tau + J.T @ f, 1e-6)


@pytest.mark.parametrize("seed", SEEDS)
def test_axes_choose_how_forces_are_written_and_nothing_else(seed: int) -> None:
    model = tree(seed)
    q, v, tau = state(model, seed)
    world = alg.constrained_dynamics(model, q, v, tau, frame_pairs(model, [PointContact("tip")]))
    local = alg.constrained_dynamics(
        model, q, v, tau, frame_pairs(model, [PointContact("tip", axes="local")])
    )
    close(local.a, world.a)
    close(alg.frame_pose(model, q, model.frame("tip")).rotation @ local.forces, world.forces)


@pytest.mark.parametrize("seed", SEEDS)
def test_impacts_lose_energy_and_nothing_rebounds(seed: int) -> None:
    model = tree(seed)
    q, v, _ = state(model, seed)
    found = frame_pairs(model, held(seed)[:1])
    J, M = alg.constraint_jacobian(model, q, found), alg.mass_matrix(model, q)
    for restitution in (0.0, 0.6):
        impact = alg.impulse_dynamics(model, q, v, found, np.array([restitution]))
        close(J @ impact.v, -restitution * (J @ v), 1e-8)
        close(M @ (impact.v - v), J.T @ impact.impulses, 1e-8)
        assert alg.kinetic_energy(model, q, impact.v) < alg.kinetic_energy(model, q, v)
    full = alg.impulse_dynamics(model, q, v, found, np.array([1.0])).v
    close(alg.kinetic_energy(model, q, full), alg.kinetic_energy(model, q, v), 1e-8)


@pytest.mark.parametrize("seed", SEEDS)
def test_repeating_it_changes_nothing(seed: int) -> None:
    model = tree(seed)
    q, v, tau = state(model, seed)
    once = alg.constrained_dynamics(model, q, v, tau, frame_pairs(model, [PointContact("tip")]))
    twice = frame_pairs(model, [PointContact("tip"), PointContact("tip")])
    shared = alg.constrained_dynamics(model, q, v, tau, twice)
    close(shared.a, once.a)
    close(shared.forces, 0.5 * np.tile(once.forces, 2), 1e-6)
    direct = alg.constrained_dynamics(model, q, v, tau, twice, settings=Proximal(mu=0.0))
    close(direct.a, once.a)
    close(direct.forces[:3] + direct.forces[3:], once.forces)


def test_contradictions_are_met_halfway_with_forces_that_are_finite() -> None:
    model = tree(0)
    q, v, tau = state(model, 0)
    found = frame_pairs(model, [PointContact("tip"), PointContact("tip")])
    here = alg.frame_pose(model, q, model.frame("tip")).matrix()
    apart = np.stack([here, here])
    apart[0, 0, 3] += 0.1
    middle = here.copy()
    middle[0, 3] += 0.05
    gains = np.array([[100.0, 20.0]] * 2)
    motion = alg.constrained_dynamics(model, q, v, tau, found, None, Stabilisation(apart, gains))
    one = alg.constrained_dynamics(model, q, v, tau, found[:1], None, Stabilisation(middle[None], gains[:1]))
    close(motion.a, one.a, 1e-6)
    assert motion.residual == pytest.approx(5.0, rel=1e-5)  # kp times 0.05 m
    assert motion.iterations == 50.0
    close(motion.forces[:3] + motion.forces[3:], one.forces, 1e-5)
    assert np.abs(motion.forces).max() <= np.abs(one.forces).max()


def test_what_is_clamped_does_not_accelerate() -> None:
    model = tree(0)
    q, v, tau = state(model, 0)
    names = [link for link in model.link_names if model.frame(link).joint >= 0]
    found = frame_pairs(model, [FrameContact(name) for name in names])
    motion = alg.constrained_dynamics(model, q, 0.0 * v, tau, found)
    close(motion.a, 0.0 * v, 1e-6)
    assert np.isfinite(motion.forces).all()


@pytest.mark.parametrize("mu", [0.0, 1e-8])
def test_what_cannot_move_needs_no_force(mu: float) -> None:
    """A point on the only axis: it stays anyway, and asked to go elsewhere it says that it cannot."""
    builder = (
        ModelBuilder("wheel").add_link("ground").add_link("wheel", Inertia.from_box(1.0, (0.1, 0.2, 0.3)))
    )
    model = builder.add_joint("axle", Revolute((0, 0, 1)), "ground", "wheel").build()
    found = frame_pairs(model, [PointContact("wheel")])
    pull = Stabilisation(SE3.trans(0.5, 0.0, 0.0).matrix()[None], np.array([[4.0, 4.0]]))
    q, v, tau = np.array([0.3]), np.array([2.0]), np.array([0.7])
    motion = alg.constrained_dynamics(model, q, v, tau, found, None, pull, Proximal(mu=mu))
    close(motion.a, alg.forward_dynamics(model, q, v, tau))
    assert (motion.forces == 0.0).all()
    assert motion.residual == pytest.approx(2.0)


def test_without_rounds_later_constraints_come_first() -> None:
    model = tree(0)
    q, v, tau = state(model, 0)
    found = frame_pairs(model, [PointContact("tip"), PointContact("tip")])
    anchors = np.stack([SE3.trans(0.1, 0.0, 0.0).matrix(), np.eye(4)])
    gains = np.array([[100.0, 20.0]] * 2)
    direct = Proximal(mu=0.0)
    both = alg.constrained_dynamics(model, q, v, tau, found, None, Stabilisation(anchors, gains), direct)
    last = alg.constrained_dynamics(model, q, v, tau, found[1:], None, Stabilisation(anchors[1:], gains[1:]))
    close(both.a, last.a, 1e-8)
    assert (both.forces[:3] == 0.0).all()
    assert both.residual == pytest.approx(10.0)


# ------------------------------------------------------------------------------------------------- linkages


def four_bar(crank: float, coupler: float, rocker: float, ground: float) -> Robot:
    """Bars in the x-z plane; at zero all hang along -z, each with its mass in its middle."""
    builder = ModelBuilder("four-bar").add_link("ground")
    spot = {"crank": ("ground", SE3.identity()), "coupler": ("crank", SE3.trans(0.0, 0.0, -crank))}
    spot["rocker"] = ("ground", SE3.trans(ground, 0.0, 0.0))
    for name, length in (("crank", crank), ("coupler", coupler), ("rocker", rocker)):
        inertia = Inertia.from_com(
            length, (0.0, 0.0, -0.5 * length), np.diag([1.0, 1.0, 1e-3]) * length**3 / 12.0
        )
        builder.add_link(name, inertia)
        builder.add_joint(f"{name}_joint", Revolute((0, 1, 0)), spot[name][0], name, spot[name][1])
    builder.add_frame("coupler_end", "coupler", SE3.trans(0.0, 0.0, -coupler))
    builder.add_frame("rocker_end", "rocker", SE3.trans(0.0, 0.0, -rocker))
    return Robot(builder.build())


LOOP: list[Constraint] = [PointLoop("coupler_end", "rocker_end")]


def closed(lengths: tuple[float, float, float, float], theta: Floats) -> Floats:
    """The configurations with a crank angle `theta`, (..., 3): two circles meet below the line of the pivots."""
    crank, coupler, rocker, ground = lengths
    x, z = -crank * np.sin(theta), -crank * np.cos(theta)
    dx, dz = ground - x, -z
    far = np.hypot(dx, dz)
    along_line = (far**2 + coupler**2 - rocker**2) / (2.0 * far)
    height = np.sqrt(coupler**2 - along_line**2)
    ex, ez = x + (along_line * dx + height * dz) / far, z + (along_line * dz - height * dx) / far
    absolute = np.arctan2(-(ex - x), -(ez - z))
    return np.stack([theta, absolute - theta, np.arctan2(-(ex - ground), -ez)], axis=-1)


@pytest.mark.parametrize("lengths", [(0.4, 0.9, 0.7, 0.8), (0.5, 1.0, 0.5, 1.0)])
@pytest.mark.parametrize("theta", [0.3, -0.8])
def test_a_four_bar_moves_as_its_one_coordinate_says(lengths: tuple[float, ...], theta: float) -> None:
    """m(x) x'' + m'(x) x'^2 / 2 + U'(x) = work of the crank's torque, with m and U along the closed linkage."""
    robot = four_bar(*lengths)
    step = 1e-3
    at = theta + step * np.arange(-4, 5)
    q = closed(lengths, at)  # type: ignore[arg-type]
    close(robot.constraint_error(q, LOOP), np.zeros((9, 3)), 1e-12)
    weights = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0.0, 4 / 5, -1 / 5, 4 / 105, -1 / 280]) / step
    tangents = np.linalg.solve(
        np.concatenate(
            [robot.constraint_jacobian(q, LOOP)[:, [0, 2]], np.tile([[[1.0, 0, 0]]], (9, 1, 1))], 1
        ),
        np.tile([[0.0], [0.0], [1.0]], (9, 1, 1)),
    )[..., 0]
    close(weights @ q, tangents[4], 1e-8)
    m = np.einsum("ni,nij,nj->n", tangents, robot.mass_matrix(q), tangents)
    slope, pull = weights @ m, weights @ robot.potential_energy(q)
    rate, torque = 1.7, 0.6
    expected = (torque - 0.5 * slope * rate**2 - pull) / m[4]
    motion = robot.constrained_dynamics(q[4], rate * tangents[4], [torque, 0.0, 0.0], LOOP)
    assert motion.a[0] == pytest.approx(expected, rel=1e-8)
    assert motion.forces[1] == pytest.approx(0.0, abs=1e-9)  # across the plane there is nothing to hold
    assert motion.residual < 1e-10


def test_a_parallelogram_is_a_pendulum() -> None:
    """Derived by hand: (I1 + I3 + m2 l^2) x'' = -(m1 / 2 + m3 / 2 + m2) g l sin x, with bars of 1 kg/m."""
    l, base = 0.5, 1.0
    robot = four_bar(l, base, l, base)
    x, rate = 0.4, 2.0
    q = np.array([x, -0.5 * np.pi - x, x])  # the coupler stays level
    assert np.abs(robot.constraint_error(q, LOOP)).max() < 1e-12
    inertia = 2.0 * l**3 / 3.0 + base * l**2
    expected = -(l + base) * 9.81 * l * np.sin(x) / inertia
    motion = robot.constrained_dynamics(q, [rate, -rate, rate], np.zeros(3), LOOP)
    np.testing.assert_allclose(motion.a, [expected, -expected, expected], rtol=1e-9)
