"""Laws of kinematics, on a random robot with every kind of joint, one per kind, and mimic joints."""

from __future__ import annotations

import numpy as np
import pytest

from support.derivatives import along, by_configuration, by_vector
from support.random_models import KINDS, random_model
from ulna import algorithms as alg
from ulna.model import Model
from ulna.spatial import (
    SE3,
    Motion,
    matrix_to_eul,
    matrix_to_euler,
    matrix_to_rpy,
    so3_log,
)
from ulna.typing import Floats

REFERENCES = ("world", "local", "local_world_aligned")


class Case:
    """A robot, frames of it, and a state."""

    def __init__(self, name: str) -> None:
        seed = sorted([*KINDS, *TREES]).index(name)
        rng = np.random.default_rng(seed)
        if name in TREES:
            self.model: Model = random_model(rng, **TREES[name])
        else:
            self.model = random_model(rng, ["revolute", name, "revolute", name, "revolute"], branching=0.0)
        self.q = alg.random(self.model, rng)
        self.v, self.a = rng.standard_normal((2, self.model.nv))
        self.frames = [self.model.frame(n) for n in ("tip", "side")]
        self.rng = rng


TREES: dict[str, dict] = {
    "every_kind": {"mimics": 2},
    "floating": {
        "root": "free_flyer",
        "kinds": ("revolute", "universal", "prismatic"),
        "joints": 8,
        "mimics": 3,
    },
    "sliding": {"root": "planar", "kinds": ("revolute", "spherical"), "joints": 6},
}


@pytest.fixture(scope="module", params=[*TREES, *KINDS])
def case(request: pytest.FixtureRequest) -> Case:
    return Case(request.param)


def close(actual: Floats, expected: Floats, tolerance: float = 1e-9) -> None:
    scale = max(1.0, float(np.abs(expected).max(initial=0.0)))
    np.testing.assert_allclose(actual, expected, rtol=0.0, atol=tolerance * scale)


def twist_of(rate: Floats, T: SE3, reference: str) -> Floats:
    """The twist, in `reference`, of a frame at T whose homogeneous matrix changes at `rate`."""
    inverse = T.inverse().matrix()
    W = inverse @ rate if reference == "local" else rate @ inverse
    linear = rate[:3, 3] if reference == "local_world_aligned" else W[:3, 3]
    return np.array([*linear, W[2, 1], W[0, 2], W[1, 0]])


@pytest.mark.parametrize("reference", REFERENCES)
def test_jacobian_is_the_derivative_of_the_pose(case: Case, reference: str) -> None:
    for frame in case.frames:
        rates = by_configuration(
            case.model, case.q, lambda q, f=frame: alg.frame_pose(case.model, q, f).matrix()
        )
        T = alg.frame_pose(case.model, case.q, frame)
        expected = np.stack([twist_of(rate, T, reference) for rate in rates], axis=-1)
        close(alg.frame_jacobian(case.model, case.q, frame, reference), expected)


@pytest.mark.parametrize("reference", REFERENCES)
def test_jacobian_dot_is_the_derivative_of_the_jacobian(case: Case, reference: str) -> None:
    for frame in case.frames:
        expected = along(
            case.model, case.q, case.v, lambda q, f=frame: alg.frame_jacobian(case.model, q, f, reference)
        )
        close(alg.frame_jacobian_dot(case.model, case.q, case.v, frame, reference), expected)


@pytest.mark.parametrize("reference", REFERENCES)
def test_hessian_is_the_derivative_of_the_jacobian(case: Case, reference: str) -> None:
    frame = case.frames[0]
    expected = by_configuration(
        case.model, case.q, lambda q: alg.frame_jacobian(case.model, q, frame, reference)
    )
    H = alg.frame_hessian(case.model, case.q, frame, reference)
    close(H, expected)
    rate = alg.frame_jacobian_dot(case.model, case.q, case.v, frame, reference)
    close(np.tensordot(case.v, H, 1), rate, 1e-12)


@pytest.mark.parametrize("reference", REFERENCES)
def test_velocity_is_jacobian_times_v(case: Case, reference: str) -> None:
    for frame in case.frames:
        V = alg.frame_velocity(case.model, case.q, case.v, frame, reference).vector()
        close(V, alg.frame_jacobian(case.model, case.q, frame, reference) @ case.v, 1e-13)


@pytest.mark.parametrize("reference", REFERENCES)
def test_acceleration_is_the_derivative_of_the_twist(case: Case, reference: str) -> None:
    """J a + (dJ/dt) v: spatial in "world" and "local", classical in "local_world_aligned"."""
    q, v, a = case.q, case.v, case.a
    for frame in case.frames:
        A = alg.frame_acceleration(
            case.model, q, v, a, frame, reference, classical=reference == "local_world_aligned"
        )
        J = alg.frame_jacobian(case.model, q, frame, reference)
        dJ = alg.frame_jacobian_dot(case.model, q, v, frame, reference)
        close(A.vector(), J @ a + dJ @ v, 1e-13)


def test_classical_acceleration_is_that_of_the_point(case: Case) -> None:
    """The second derivative of the frame's origin along a motion with acceleration a at t = 0."""
    frame = case.frames[0]

    def velocity(t: float) -> Floats:
        q = alg.integrate(case.model, case.q, t * case.v + 0.5 * t * t * case.a)
        # to first order in t the velocity along that curve is v + t a (plus the bracket of v with itself: 0)
        return alg.frame_velocity(case.model, q, case.v + t * case.a, frame).linear

    h = 1e-4
    expected = (velocity(h) - velocity(-h)) / (2.0 * h)
    A = alg.frame_acceleration(case.model, case.q, case.v, case.a, frame, classical=True)
    close(A.linear, expected, 1e-6)


def test_no_acceleration_leaves_the_drift(case: Case) -> None:
    frame = case.frames[0]
    zero = np.zeros(case.model.nv)
    for reference in REFERENCES:
        drift = alg.frame_acceleration(case.model, case.q, case.v, None, frame, reference)
        assert drift == alg.frame_acceleration(case.model, case.q, case.v, zero, frame, reference)


def test_references_are_related_by_adjoints(case: Case) -> None:
    for frame in case.frames:
        T = alg.frame_pose(case.model, case.q, frame)
        world, local, aligned = (alg.frame_jacobian(case.model, case.q, frame, r) for r in REFERENCES)
        close(world, T.adjoint() @ local, 1e-12)
        close(aligned, SE3(T.rotation, np.zeros(3)).adjoint() @ local, 1e-12)


def test_joint_jacobians_hold_every_frames_columns(case: Case) -> None:
    J = alg.joint_jacobians(case.model, case.q)
    plain = [j for j in case.model.joints if j.mimic is None]
    followed = {j.mimic.source for j in case.model.joints if j.mimic is not None}
    for frame in case.frames:
        support = case.model.support(frame.joint)
        own = alg.frame_jacobian(case.model, case.q, frame, "world")
        for joint in plain:
            index = case.model.joints.index(joint)
            columns = slice(joint.idx_v, joint.idx_v + joint.nv)
            if index in followed:
                continue  # the columns of its mimic joints are added, wherever they stand
            close(own[:, columns], J[:, columns] if index in support else np.zeros((6, joint.nv)), 1e-13)


@pytest.mark.parametrize("reference", ["world", "local", "local_world_aligned"])
def test_jacobians_of_frames_follow_from_the_columns_of_joints(case: Case, reference: str) -> None:
    if any(joint.mimic is not None for joint in case.model.joints):
        return  # their columns are not distinguished
    J, poses = alg.joint_jacobians(case.model, case.q), alg.joint_poses(case.model, case.q)
    for frame in case.frames:
        T = poses[frame.joint] if frame.joint >= 0 else SE3.identity()
        found = alg.frame_jacobian_of(case.model, J, T, frame, reference)  # type: ignore[arg-type]
        close(found, alg.frame_jacobian(case.model, case.q, frame, reference), 1e-12)  # type: ignore[arg-type]


def test_poses_and_velocities_of_all_joints_and_frames(case: Case) -> None:
    model, q, v = case.model, case.q, case.v
    poses, twists = alg.joint_poses(model, q), alg.joint_velocities(model, q, v)
    assert len(poses) == len(twists) == len(model.joints)
    for frame, T in zip(model.frames, alg.frame_poses(model, q, model.frames), strict=True):
        alone = alg.frame_pose(model, q, frame)
        assert alone.is_close(T, 1e-13)
        if frame.joint >= 0:
            assert T.is_close(poses[frame.joint] @ frame.placement, 1e-13)
            V = frame.placement.act_inverse(twists[frame.joint])
            assert V.is_close(alg.frame_velocity(model, q, v, frame, "local"), 1e-13)
        else:
            assert frame.placement == T
            assert alg.frame_velocity(model, q, v, frame) == Motion.zero()
            assert alg.frame_acceleration(model, q, v, case.a, frame) == Motion.zero()
            assert not alg.frame_jacobian(model, q, frame).any()


def test_derivatives_of_velocity_and_acceleration(case: Case) -> None:
    model, q, v, a, frame = case.model, case.q, case.v, case.a, case.frames[0]

    def V(q: Floats, v: Floats) -> Floats:
        return alg.frame_velocity(model, q, v, frame, "local").vector()

    def A(q: Floats, v: Floats, a: Floats) -> Floats:
        return alg.frame_acceleration(model, q, v, a, frame, "local").vector()

    by_q, by_v = alg.frame_velocity_derivatives(model, q, v, frame)
    close(by_q, by_configuration(model, q, lambda x: V(x, v)).T)
    close(by_v, by_vector(v, lambda x: V(q, x)).T)
    by_q, by_v, by_a = alg.frame_acceleration_derivatives(model, q, v, a, frame)
    close(by_q, by_configuration(model, q, lambda x: A(x, v, a)).T)
    close(by_v, by_vector(v, lambda x: A(q, x, a)).T)
    close(by_a, by_vector(a, lambda x: A(q, v, x)).T)


AXES = ["all", "trans", "rot", (True, False, True, False, False, True)]


@pytest.mark.parametrize("axes", AXES, ids=str)
def test_manipulability_and_its_gradient(case: Case, axes: object) -> None:
    for frame in case.frames:
        rows = {"all": slice(6), "trans": slice(3), "rot": slice(3, 6)}.get(str(axes), [0, 2, 5])
        J = alg.frame_jacobian(case.model, case.q, frame)[rows]
        s = np.linalg.svd(J, compute_uv=False)
        volume = np.prod(s) if J.shape[0] <= J.shape[1] else 0.0
        scale = float(s[0]) ** J.shape[0]
        m = alg.manipulability(case.model, case.q, frame, axes=axes)
        assert abs(m - volume) < 1e-12 * max(1.0, scale)
        gradient = alg.manipulability_gradient(case.model, case.q, frame, axes)
        assert gradient.shape == (case.model.nv,)
        if J.shape[0] > J.shape[1] or s[-1] < 0.1 * s[0]:  # so near the kink, differences say nothing
            assert np.isfinite(gradient).all()
            continue
        expected = by_configuration(
            case.model, case.q, lambda q, f=frame: np.asarray(alg.manipulability(case.model, q, f, axes=axes))
        )
        np.testing.assert_allclose(gradient, expected, rtol=0.0, atol=1e-7 * max(1.0, scale))


def test_singular_values_measure_manipulability(case: Case) -> None:
    frame = case.frames[0]
    s = np.linalg.svd(alg.frame_jacobian(case.model, case.q, frame)[:3], compute_uv=False)
    smallest = s[2] if case.model.nv >= 3 else 0.0
    least = alg.manipulability(case.model, case.q, frame, "minimum_singular_value", "trans")
    assert abs(least - smallest) < 1e-12
    ratio = alg.manipulability(case.model, case.q, frame, "inverse_condition", "trans")
    assert abs(ratio - smallest / s[0]) < 1e-12


def _angles(R: Floats, representation: str) -> Floats:
    if representation == "rpy/zyx":
        return matrix_to_rpy(R)
    if representation == "rpy/xyz":
        return matrix_to_euler(R, "xyz")[..., ::-1]
    return matrix_to_eul(R) if representation == "eul" else so3_log(R)


@pytest.mark.parametrize("representation", ["rpy/xyz", "rpy/zyx", "eul", "exp"])
def test_analytical_jacobian_is_the_derivative_of_position_and_angles(
    case: Case, representation: str
) -> None:
    model, frame = case.model, case.frames[0]
    q = _far_from_singular(case, representation)
    T = alg.frame_pose(model, q, frame)
    base = _angles(T.rotation, representation)

    def coordinates(x: Floats) -> Floats:
        T = alg.frame_pose(model, x, frame)
        angles = _angles(T.rotation, representation)
        if representation != "exp":
            angles = base + np.remainder(angles - base + np.pi, 2.0 * np.pi) - np.pi
        return np.concatenate([T.translation, angles], axis=-1)

    expected = by_configuration(model, q, coordinates).T
    close(alg.analytical_jacobian(model, q, frame, representation), expected, 1e-7)
    v = 0.3 * case.v  # the numerical derivative has its limits, too
    rate = along(model, q, v, lambda x: alg.analytical_jacobian(model, x, frame, representation))
    close(alg.analytical_jacobian_dot(model, q, v, frame, representation), rate, 1e-7)


def _far_from_singular(case: Case, representation: str) -> Floats:
    for _ in range(200):
        q = alg.random(case.model, case.rng)
        R = alg.frame_pose(case.model, q, case.frames[0]).rotation
        cosine = {"rpy/xyz": R[0, 2], "rpy/zyx": R[2, 0], "eul": R[2, 2], "exp": -0.5 * (np.trace(R) - 1.0)}
        if abs(cosine[representation]) < 0.7:
            return q
    raise AssertionError("this robot is always near a singular set of angles; choose another seed")


def test_batch_equals_singles(case: Case) -> None:
    model, frame, rng = case.model, case.frames[0], case.rng
    q = alg.random(model, rng, (2, 3))
    v, a = rng.standard_normal((2, 2, 3, model.nv))
    functions = {
        "pose": lambda q, v, a: alg.frame_pose(model, q, frame).matrix(),
        "still": lambda q, v, a: alg.frame_pose(model, q, model.frames[0]).matrix(),
        "still twist": lambda q, v, a: alg.frame_velocity(model, q, v, model.frames[0]).vector(),
        "velocity": lambda q, v, a: alg.frame_velocity(model, q, v, frame).vector(),
        "acceleration": lambda q, v, a: alg.frame_acceleration(model, q, v, a, frame, "world", True).vector(),
        "jacobian": lambda q, v, a: alg.frame_jacobian(model, q, frame, "local"),
        "joint jacobians": lambda q, v, a: alg.joint_jacobians(model, q),
        "jacobian dot": lambda q, v, a: alg.frame_jacobian_dot(model, q, v, frame),
        "hessian": lambda q, v, a: alg.frame_hessian(model, q, frame),
        "analytical": lambda q, v, a: alg.analytical_jacobian(model, q, frame, "exp"),
        "analytical dot": lambda q, v, a: alg.analytical_jacobian_dot(model, q, v, frame, "eul"),
        "manipulability": lambda q, v, a: np.asarray(alg.manipulability(model, q, frame, axes="trans")),
        "gradient": lambda q, v, a: alg.manipulability_gradient(model, q, frame, "trans"),
        "derivatives": lambda q, v, a: alg.frame_acceleration_derivatives(model, q, v, a, frame)[0],
        "integrate": lambda q, v, a: alg.integrate(model, q, v),
        "neighbour": lambda q, v, a: alg.interpolate(model, q, alg.integrate(model, q, 0.3 * v), 0.4),
        "normalize": lambda q, v, a: alg.normalize(model, 1.5 * q),
        "steps": lambda q, v, a: alg.integrate_derivatives(model, q, v)[1],
    }
    for name, f in functions.items():
        batch = f(q, v, a)
        singles = np.stack([[f(q[i, j], v[i, j], a[i, j]) for j in range(3)] for i in range(2)])
        assert batch.shape == singles.shape, name
        np.testing.assert_allclose(
            batch, singles, rtol=0.0, atol=1e-12 * max(1.0, np.abs(singles).max()), err_msg=name
        )


def test_batches_broadcast_against_each_other(case: Case) -> None:
    v = case.rng.standard_normal((4, 1, case.model.nv))
    q = alg.random(case.model, case.rng, (3,))
    assert alg.frame_velocity(case.model, q, v, case.frames[0]).vector().shape == (4, 3, 6)
    assert alg.frame_jacobian_dot(case.model, q, v, case.frames[0]).shape == (4, 3, 6, case.model.nv)
    assert alg.integrate(case.model, q, v).shape == (4, 3, case.model.nq)
