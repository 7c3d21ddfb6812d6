"""A robot answers for its constraints by name: batches, anchors and gains, forces and friction, refusals, simulation."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest

import ulna
from support.random_models import random_model
from ulna import algorithms as alg
from ulna.algorithms import Proximal
from ulna.errors import DtypeError, InputError, NonFiniteError, ShapeError, UnknownName
from ulna.model import FrameContact, FrameLoop, PointContact, PointLoop
from ulna.model.constraint import frame_pairs
from ulna.robots.panda import panda
from ulna.sim import simulate
from ulna.spatial import SE3

CONSTRAINTS = [PointContact("tip", (0.1, 0.0, 0.0)), PointLoop("side", "link0", axes="local")]


@pytest.fixture(scope="module")
def robot() -> ulna.Robot:
    kinds = ["revolute", "revolute", "prismatic", "revolute"]
    return ulna.Robot(random_model(np.random.default_rng(3), kinds, root="free_flyer", branching=0.0))


@pytest.fixture(scope="module")
def state(robot: ulna.Robot) -> tuple[np.ndarray, ...]:
    rng = np.random.default_rng(4)
    return robot.random_configuration((2, 3), seed=1), *rng.standard_normal((2, 2, 3, robot.nv))


def test_compiled_equals_plain_and_batches_are_stacks(robot: ulna.Robot, state) -> None:
    q, v, tau = state
    found = frame_pairs(robot.model, CONSTRAINTS)
    plain = alg.constrained_dynamics(robot.model, q, v, tau, found)
    motion = robot.constrained_dynamics(q, v, tau, CONSTRAINTS)
    for ours, expected in zip(motion, plain, strict=True):
        np.testing.assert_allclose(ours, expected, rtol=1e-6, atol=1e-7)
    one = robot.constrained_dynamics(q[1, 2], v[1, 2], tau[1, 2], CONSTRAINTS)
    np.testing.assert_allclose(one.a, motion.a[1, 2], rtol=1e-9, atol=1e-9)
    impact = robot.impulse_dynamics(q, v, CONSTRAINTS, restitution=[0.5, 0.0])
    expected = alg.impulse_dynamics(robot.model, q, v, found, np.array([0.5, 0.0]))
    np.testing.assert_allclose(impact.v, expected.v, rtol=1e-8, atol=1e-8)
    assert robot.impulse_dynamics(q, v, CONSTRAINTS).impulses.shape == (2, 3, 6)
    J = robot.constraint_jacobian(q, CONSTRAINTS)
    np.testing.assert_allclose(
        robot.delassus_matrix(q, CONSTRAINTS),
        J @ robot.inverse_mass_matrix(q) @ np.swapaxes(J, -1, -2),
        atol=1e-9,
    )
    c = robot.constraint_velocity(q, v, CONSTRAINTS)
    np.testing.assert_allclose(c, (J @ v[..., None])[..., 0], atol=1e-12)
    own = robot.forward_dynamics_with_jacobian(q, v, tau, J, robot.constraint_bias(q, v, CONSTRAINTS))
    np.testing.assert_allclose(own.a, motion.a, rtol=1e-6, atol=1e-6)
    soft = robot.forward_dynamics_with_jacobian(q, v, tau, J, c, compliance=0.3)
    yielded = (J @ soft.a[..., None])[..., 0] + c + 0.3 * soft.forces
    np.testing.assert_allclose(yielded, 0.0 * c, atol=1e-8)


def test_anchors_and_gains(robot: ulna.Robot, state) -> None:
    q, v, tau = state
    anchors = robot.constraint_anchors(q[0, 0], CONSTRAINTS)
    assert anchors.shape == (1, 4, 4)
    assert np.abs(robot.constraint_error(q[0, 0], CONSTRAINTS, anchors)[:3]).max() < 1e-14
    e, c = robot.constraint_error(q, CONSTRAINTS, anchors), robot.constraint_velocity(q, v, CONSTRAINTS)
    J, k = robot.constraint_jacobian(q, CONSTRAINTS), robot.constraint_bias(q, v, CONSTRAINTS)
    for given in (anchors, [anchors[0]], anchors[:, :3, 3], [anchors[0, :3, 3]]):
        a = robot.constrained_dynamics(q, v, tau, CONSTRAINTS, anchors=given, kp=[16.0, 0.0], kd=3.0).a
        left = (J @ a[..., None])[..., 0] + k + 3.0 * c
        np.testing.assert_allclose(left[..., :3], -16.0 * e[..., :3], atol=1e-6)
        np.testing.assert_allclose(left[..., 3:] + 0.0 * e[..., 3:], 0.0 * e[..., 3:], atol=1e-6)
    critical = robot.constrained_dynamics(q, v, tau, CONSTRAINTS, anchors=anchors, kp=4.0).a
    same = robot.constrained_dynamics(q, v, tau, CONSTRAINTS, anchors=anchors, kp=4.0, kd=[4.0, 4.0]).a
    np.testing.assert_array_equal(critical, same)
    braked = robot.constrained_dynamics(q, v, tau, CONSTRAINTS[:1], kd=2.0).a  # needs no anchors
    left = (J[..., :3, :] @ braked[..., None])[..., 0] + k[..., :3] + 2.0 * c[..., :3]
    np.testing.assert_allclose(left, 0.0 * left, atol=1e-8)


def test_forces_and_friction_act_too(robot: ulna.Robot, state) -> None:
    q, v, tau = (x[0, 0] for x in state)
    push = {"link2": np.arange(6.0)}
    chosen = [PointContact("tip")]
    motion = robot.constrained_dynamics(q, v, tau, chosen, push, friction=True)
    J = robot.constraint_jacobian(q, chosen)
    free = robot.forward_dynamics(q, v, tau + J.T @ motion.forces, push, friction=True)
    np.testing.assert_allclose(motion.a, free, atol=1e-8)
    wrench = np.concatenate([motion.forces, np.zeros(3)])
    same = robot.forward_dynamics(q, v, tau, {"link2": np.arange(6.0), "tip": wrench}, friction=True)
    np.testing.assert_allclose(motion.a, same, atol=1e-8)


def test_every_choice_has_another_kernel(robot: ulna.Robot, state) -> None:
    """Also when the choices are made of the same values."""
    q, v, tau = (x[0, 0] for x in state)
    tip = PointContact("tip")
    plain = robot.constrained_dynamics(q, v, tau, tip)  # one alone need not be in a list
    rubbed = robot.constrained_dynamics(q, v, tau, [tip], friction=True)
    braked = robot.constrained_dynamics(q, v, tau, [tip], kd=1.0)
    direct = robot.constrained_dynamics(q, v, tau, [tip], solver=Proximal(mu=0.0))
    assert np.abs(plain.a - rubbed.a).max() > 1e-3
    assert np.abs(plain.a - braked.a).max() > 1e-3
    np.testing.assert_allclose(plain.a, direct.a, atol=1e-8)
    np.testing.assert_array_equal(plain.a, robot.constrained_dynamics(q, v, tau, (tip,)).a)


def test_invalid_constraints_are_refused(robot: ulna.Robot, state) -> None:
    q, v, tau = (x[0, 0] for x in state)

    def ask(*constraints: Any, **options: Any) -> Any:
        return robot.constrained_dynamics(q, v, tau, list(constraints), **options)

    tip = PointContact("tip")
    with pytest.raises(UnknownName, match="Did you mean 'tip'"):
        ask(PointContact("tipp"))
    with pytest.raises(InputError, match="expected a list of PointContact"):
        ask("tip")
    with pytest.raises(InputError, match="`constraints` is 7; expected a list"):
        robot.constrained_dynamics(q, v, tau, 7)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="`constraints` is empty.*forward_dynamics"):
        ask()
    with pytest.raises(InputError, match="frames of one body"):
        ask(PointLoop("tip", "tip"))
    with pytest.raises(ShapeError, match=r"`point` has shape \(2,\)"):
        PointContact("tip", (0.0, 1.0))  # type: ignore[arg-type]
    with pytest.raises(InputError, match="finite"):
        PointContact("tip", (0.0, np.nan, 1.0))
    with pytest.raises(InputError, match="expected one SE3"):
        FrameContact("tip", np.eye(4))  # type: ignore[arg-type]
    with pytest.raises(InputError, match="expected the name of a frame"):
        FrameLoop("tip", 3)  # type: ignore[arg-type]
    with pytest.raises(UnknownName, match="local_world_aligned"):
        PointContact("tip", axes="world")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="`kp` pulls contacts to their anchors"):
        ask(tip, kp=1.0)
    with pytest.raises(InputError, match="without a gain"):
        ask(tip, anchors=np.zeros((1, 3)))
    with pytest.raises(InputError, match="`kp` is -1"):
        ask(tip, kp=-1.0, anchors=np.zeros((1, 3)))
    with pytest.raises(ShapeError, match="one number, or one for each of 1"):
        ask(tip, kd=[1.0, 2.0])
    with pytest.raises(ShapeError, match=r"anchors\[0\]"):
        ask(FrameContact("tip"), kp=1.0, anchors=np.zeros((1, 3)))
    with pytest.raises(ShapeError, match="one for each of 1 contacts"):
        ask(tip, kp=1.0, anchors=np.zeros((2, 3)))
    with pytest.raises(InputError, match="only against anchors"):
        robot.constraint_error(q, [tip])
    with pytest.raises(InputError, match="no contact"):
        robot.constraint_anchors(q, [PointLoop("tip", "link0")])
    with pytest.raises(InputError, match=r"in \[0, 1\]"):
        robot.impulse_dynamics(q, v, [tip], restitution=1.5)
    with pytest.raises(ShapeError, match="m from 1"):
        robot.forward_dynamics_with_jacobian(q, v, tau, np.zeros(robot.nv), np.zeros(1))
    with pytest.raises(ShapeError, match="drift"):
        robot.forward_dynamics_with_jacobian(q, v, tau, np.zeros((2, robot.nv)), np.zeros(3))
    with pytest.raises(NonFiniteError):
        robot.constrained_dynamics(q, np.nan * v, tau, [tip])
    with pytest.raises(InputError, match="`solver` is 'direct'"):
        ask(tip, solver="direct")
    with pytest.raises(DtypeError, match="`kp`"):
        ask(tip, kp="stiff", anchors=np.zeros((1, 3)))
    with pytest.raises(DtypeError, match="`point`"):
        PointContact("tip", "here")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="no joint moves"):
        ulna.Robot(panda()).delassus_matrix(np.zeros(7), [FrameContact("panda_link0")])


@pytest.mark.parametrize(
    "wrong", [{"mu": -1e-8}, {"tolerance": 0.0}, {"iterations": 0}, {"mu": np.nan}, {"mu": "a"}]
)
def test_invalid_solvers_are_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(InputError, match=next(iter(wrong))):
        Proximal(**wrong)


def test_equal_constraints_share_their_kernel(robot: ulna.Robot) -> None:
    assert PointContact("tip", [0, 0, 1]) == PointContact("tip", (0.0, 0.0, 1.0))  # type: ignore[arg-type]
    assert FrameContact("tip", SE3.rx(0.1)) != FrameContact("tip", SE3.rx(0.2))
    assert PointContact("tip") != PointLoop("tip", "side")
    loop = FrameLoop("tip", "side", SE3.rx(0.1))
    assert pickle.loads(pickle.dumps(loop)) == loop
    kernel = robot.kernel("delassus_matrix", constraints=[loop])
    assert kernel is robot.kernel("delassus_matrix", constraints=(FrameLoop("tip", "side", SE3.rx(0.1)),))


def test_one_iteration_leaves_the_constraints_yielding(robot: ulna.Robot, state) -> None:
    q, v, tau = (x[0, 0] for x in state)
    chosen = [PointContact("tip")]
    soft = robot.constrained_dynamics(q, v, tau, chosen, solver=Proximal(mu=0.1, iterations=1))
    r = 0.1 * np.trace(robot.delassus_matrix(q, chosen)) / 3.0
    left = robot.constraint_jacobian(q, chosen) @ soft.a + robot.constraint_bias(q, v, chosen)
    np.testing.assert_allclose(left, -r * soft.forces, atol=1e-9)
    assert soft.residual == pytest.approx(np.abs(left).max())


def test_inside_a_function_of_the_user(robot: ulna.Robot, state) -> None:
    q, v, tau = (x[0, 0] for x in state)
    own = ulna.compile(lambda q, v, tau: robot.constrained_dynamics(q, v, tau, CONSTRAINTS).a, robot)
    np.testing.assert_allclose(
        own(q, v, tau), robot.constrained_dynamics(q, v, tau, CONSTRAINTS).a, rtol=1e-9, atol=1e-9
    )


def test_symbols_pass_through() -> None:
    """Without rounds, a pendulum on a wall: what holds its tip bears the weight that its axle does not."""
    sympy = pytest.importorskip("sympy")
    model = (
        ulna.ModelBuilder("rod").add_link("wall").add_link("rod", ulna.Inertia.from_point(2.0, (0, 0, -0.5)))
    )
    model.add_joint("axle", ulna.model.Revolute((0, 1, 0)), "wall", "rod")
    rod = model.add_frame("end", "rod", SE3.trans(0.0, 0.0, -1.0)).build()
    x = sympy.Symbol("x", positive=True)
    q = np.array([x], dtype=object)
    G = alg.delassus_matrix(rod, q, frame_pairs(rod, [PointContact("end")]))
    assert sympy.simplify(G[0, 0] - sympy.cos(x) ** 2 / 0.5) == 0


def test_a_simulated_contact_stays_and_a_free_foot_falls() -> None:
    robot = ulna.Robot(random_model(np.random.default_rng(1), ["revolute"] * 2, root="free_flyer", mimics=0))
    q = robot.random_configuration(seed=0)
    contact = [PointContact("tip")]
    anchors = robot.constraint_anchors(q, contact)
    for method in ("euler", "rk4"):
        run = simulate(robot, q, duration=0.2, dt=1e-3, method=method, constraints=contact, friction=None)
        assert np.abs(robot.constraint_error(run["q"], contact, anchors)).max() < 2e-3
    energy = robot.mechanical_energy(run["q"], run["v"])
    assert np.ptp(energy) < 1e-6
    free = simulate(robot, q, duration=0.2, dt=1e-3)
    assert np.abs(robot.constraint_error(free["q"][-1], contact, anchors)).max() > 0.1
    with pytest.raises(InputError, match="`kp` is -1"):
        simulate(robot, q, duration=0.1, constraints=contact, kp=-1.0)


def test_anchors_are_one_pose_or_point_for_each_contact(robot: ulna.Robot, state) -> None:
    """Numbers, texts and generators raised errors of Python; matrices that are no rotations were taken."""
    q, v, tau = (x[0, 0] for x in state)
    frame, point = FrameContact("tip"), PointContact("tip")

    def ask(contacts: Any, anchors: Any, kp: Any = 1.0, kd: Any = None) -> Any:
        return robot.constraints.forward_dynamics(q, v, tau, contacts, anchors=anchors, kp=kp, kd=kd).a

    anchors = robot.constraints.anchors(q, [frame])
    for wrong in (5, "tip", {"tip": anchors[0]}, ulna.SE3(anchors[0])):
        with pytest.raises(InputError, match="expected one anchor for each contact"):
            ask([frame], wrong)
    for wrong in (np.zeros((1, 4, 4)), [np.ones((4, 4))], np.diag([1.0, 1.0, -1.0, 1.0])[None]):
        with pytest.raises(InputError, match="`anchors` is not a rotation"):
            ask([frame], wrong)
    np.testing.assert_array_equal(ask([frame], (T for T in anchors)), ask([frame], anchors))
    both = [np.tile(anchors[0], (3, 1, 1)), np.zeros((2, 3))]
    with pytest.raises(ShapeError, match="`anchors` .* leading axes that broadcast"):
        ask([frame, point], both)
    with pytest.raises(ShapeError, match="`kd` .* leading axes that broadcast"):
        ask([frame], anchors, np.ones((3, 1)), np.ones((2, 1)))
