"""Constrained dynamics, Delassus matrix and impacts against Pinocchio: arm, quadruped, humanoid; contacts and loops."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

pin = pytest.importorskip("pinocchio")

from support.pinocchio_models import Twin, from_pinocchio  # noqa: E402
from ulna import algorithms as alg  # noqa: E402
from ulna.algorithms import Proximal  # noqa: E402
from ulna.model import Constraint, FrameContact, FrameLoop, PointContact, PointLoop  # noqa: E402
from ulna.model.constraint import frame_pairs  # noqa: E402
from ulna.robots import example_robot_data  # noqa: E402
from ulna.typing import Floats  # noqa: E402

FEET = {
    "panda": (["panda_hand"], FrameContact),
    "solo12": (["FL_FOOT", "FR_FOOT", "HL_FOOT", "HR_FOOT"], PointContact),
    "talos": (["left_sole_link", "right_sole_link"], FrameContact),
}
AXES = {"local_world_aligned": pin.LOCAL_WORLD_ALIGNED, "local": pin.LOCAL}


@cache
def twin(name: str) -> Twin:
    if example_robot_data.share_folder() is None:
        pytest.skip("example-robot-data is not installed")
    urdf = str(example_robot_data.files(name)[0])
    if name == "panda":
        return from_pinocchio(pin.buildModelFromUrdf(urdf))
    return from_pinocchio(pin.buildModelFromUrdf(urdf, pin.JointModelFreeFlyer()))


def name_of(t: Twin, name: str) -> str:
    """The twin's name of a frame of Pinocchio's."""
    return f"{t.pin.getFrameId(name)}:{name}"


def contacts(name: str, axes) -> list[Constraint]:
    feet, kind = FEET[name]
    return [kind(name_of(twin(name), foot), axes=axes) for foot in feet]


def theirs(t: Twin, constraints: list[Constraint], gains: tuple[float, float] = (0.0, 0.0)):
    """Pinocchio's models and data of the same constraints, with anchors at the origin of the world."""
    models, datas = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
    for constraint in constraints:
        kind = pin.ContactType.CONTACT_3D if constraint.size == 3 else pin.ContactType.CONTACT_6D
        ends = []
        for name, placement in constraint.ends():
            frame = t.pin.frames[int(name.split(":")[0])]
            ends += [frame.parentJoint, frame.placement * pin.SE3(placement.matrix())]
        model = pin.RigidConstraintModel(kind, t.pin, *ends, AXES[constraint.axes])
        model.m_baumgarte_parameters.Kp, model.m_baumgarte_parameters.Kd = gains
        models.append(model)
        datas.append(models[len(models) - 1].createData())
    data = t.pin.createData()
    pin.initConstraintDynamics(t.pin, data, models, datas)
    return data, models, datas


def state(t: Twin, seed: int = 1) -> tuple[Floats, Floats, Floats]:
    rng = np.random.default_rng(seed)
    return alg.random(t.model, rng), *rng.standard_normal((2, t.model.nv))


def close(actual: Floats, expected: Floats, tolerance: float = 1e-10) -> None:
    scale = max(1.0, float(np.abs(expected).max(initial=0.0)))
    np.testing.assert_allclose(actual, expected, rtol=0.0, atol=tolerance * scale)


def at_rest(t: Twin, q: Floats, v: Floats, found) -> Floats:
    """The velocity nearest to `v` that keeps the constraints, where all accelerations of a point agree."""
    return alg.impulse_dynamics(t.model, q, v, found).v


def forces_of(datas) -> Floats:
    return np.concatenate([_force(data) for data in datas])


def _force(data) -> Floats:
    return np.array(data.contact_force.vector)


def ours_in_six(constraints: list[Constraint], forces: Floats) -> Floats:
    """Pinocchio shows also the force of a point as six numbers."""
    parts, start = [], 0
    for constraint in constraints:
        part = forces[start : start + constraint.size]
        parts.append(np.concatenate([part, np.zeros(6 - constraint.size)]))
        start += constraint.size
    return np.concatenate(parts)


@pytest.mark.parametrize("axes", AXES)
@pytest.mark.parametrize("name", FEET)
def test_contacts(name: str, axes) -> None:
    t = twin(name)
    constraints = contacts(name, axes)
    found = frame_pairs(t.model, constraints)
    q, v, tau = state(t)
    v = at_rest(t, q, v, found)
    data, models, datas = theirs(t, constraints)
    settings = pin.ProximalSettings(1e-14, 1e-9, 20)
    expected = pin.constraintDynamics(t.pin, data, t.q(q), t.v(v), t.v(tau), models, datas, settings)
    motion = alg.constrained_dynamics(t.model, q, v, tau, found)
    close(t.v(motion.a), expected)
    close(ours_in_six(constraints, motion.forces), forces_of(datas))
    jacobian = pin.getConstraintsJacobian(t.pin, data, models, datas)
    close(alg.constraint_jacobian(t.model, q, found), t.columns(jacobian))


@pytest.mark.parametrize("name", FEET)
def test_delassus_matrix(name: str) -> None:
    t = twin(name)
    constraints = contacts(name, "local")
    q, _, _ = state(t)
    data, models, datas = theirs(t, constraints)
    expected = pin.computeDelassusMatrix(t.pin, data, t.q(q), models, datas)
    close(alg.delassus_matrix(t.model, q, frame_pairs(t.model, constraints)), expected)


@pytest.mark.parametrize("restitution", [0.0, 0.3])
@pytest.mark.parametrize("name", FEET)
def test_impacts(name: str, restitution: float) -> None:
    t = twin(name)
    constraints = contacts(name, "local_world_aligned")
    found = frame_pairs(t.model, constraints)
    q, v, _ = state(t)
    J = alg.constraint_jacobian(t.model, q, found)
    data = t.pin.createData()
    expected = pin.impulseDynamics(t.pin, data, t.q(q), t.v(v), J[:, t.order], restitution, 0.0)
    impact = alg.impulse_dynamics(t.model, q, v, found, np.full(len(found), restitution))
    close(t.v(impact.v), expected)
    close(impact.impulses, np.array(data.impulse_c))


@pytest.mark.parametrize("damping", [0.0, 0.2])
@pytest.mark.parametrize("name", FEET)
def test_a_custom_jacobian(name: str, damping: float) -> None:
    t = twin(name)
    q, v, tau = state(t)
    rng = np.random.default_rng(7)
    J, drift = rng.standard_normal((4, t.model.nv)), rng.standard_normal(4)
    data = t.pin.createData()
    expected = pin.forwardDynamics(
        t.pin, data, t.q(q), t.v(v), t.v(tau), np.ascontiguousarray(J[:, t.order]), drift, damping
    )
    motion = alg.forward_dynamics_with_jacobian(t.model, q, v, tau, J, drift, damping)
    close(t.v(motion.a), expected)
    close(motion.forces, np.array(data.lambda_c))


@pytest.mark.parametrize("axes", AXES)
@pytest.mark.parametrize("kind", [PointLoop, FrameLoop])
def test_loops_between_two_legs(kind, axes) -> None:
    """Held together where they are, so that the loop is closed."""
    t = twin("talos")
    q, v, tau = state(t)
    a, b = name_of(t, "left_sole_link"), name_of(t, "gripper_right_base_link")
    T = alg.frame_pose(t.model, q, t.model.frame(b)).inverse() @ alg.frame_pose(t.model, q, t.model.frame(a))
    constraints: list[Constraint] = [
        FrameLoop(a, b, placement_b=T, axes=axes)
        if kind is FrameLoop
        else PointLoop(a, b, point_b=tuple(T.translation), axes=axes)
    ]
    found = frame_pairs(t.model, constraints)
    close(alg.constraint_error(t.model, q, None, found), np.zeros(found[0].size))
    v = at_rest(t, q, v, found)
    data, models, datas = theirs(t, constraints)
    settings = pin.ProximalSettings(1e-14, 1e-9, 20)
    expected = pin.constraintDynamics(t.pin, data, t.q(q), t.v(v), t.v(tau), models, datas, settings)
    motion = alg.constrained_dynamics(t.model, q, v, tau, found)
    close(t.v(motion.a), expected)
    close(ours_in_six(constraints, motion.forces), forces_of(datas))


def test_redundant_contacts_give_the_acceleration_of_the_proximal_solver() -> None:
    """Four feet of which three say all there is to say about a rigid trunk, at rest: 24 rows of which 18 count."""
    t = twin("solo12")
    constraints: list[Constraint] = [FrameContact(name_of(t, foot)) for foot in FEET["solo12"][0]]
    found = frame_pairs(t.model, constraints)
    q, v, tau = state(t)
    data, models, datas = theirs(t, constraints)
    settings = pin.ProximalSettings(
        1e-13, 1e-4, 50
    )  # with less, its forces lose digits where they are not unique
    expected = pin.constraintDynamics(t.pin, data, t.q(q), t.v(0.0 * v), t.v(tau), models, datas, settings)
    motion = alg.constrained_dynamics(t.model, q, 0.0 * v, tau, found)
    close(t.v(motion.a), expected, 1e-8)
    close(ours_in_six(constraints, motion.forces), forces_of(datas), 1e-6)
    assert motion.residual < 1e-8


def test_stabilisation_by_a_point() -> None:
    t = twin("solo12")
    constraints = contacts("solo12", "local_world_aligned")
    found = frame_pairs(t.model, constraints)
    q, v, tau = state(t)
    data, models, datas = theirs(t, constraints, (30.0, 4.0))
    expected = pin.constraintDynamics(t.pin, data, t.q(q), t.v(v), t.v(tau), models, datas)
    pull = alg.Stabilisation(np.broadcast_to(np.eye(4), (4, 4, 4)), np.tile([30.0, 4.0], (4, 1)))
    close(t.v(alg.constrained_dynamics(t.model, q, v, tau, found, None, pull, Proximal(mu=0.0)).a), expected)
