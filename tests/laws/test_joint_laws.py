"""Every kind of joint obeys the same laws: pose, velocity and acceleration agree, and so do coordinates."""

from __future__ import annotations

import math
import pickle
import zlib

import numpy as np
import pytest

from ulna.compiler import trace
from ulna.errors import InputError
from ulna.model import (
    Circle,
    Composite,
    ConstantVelocity,
    Continuous,
    Cylindrical,
    Ellipsoid,
    Fixed,
    FreeFlyer,
    Helical,
    JointKind,
    Planar,
    PlanarCircle,
    Prismatic,
    Revolute,
    Rolling,
    Spherical,
    Translation,
    Universal,
)
from ulna.spatial import SE3, SO3, so3_exp

SKEW = (0.3, -0.5, 0.8)
TILT = SE3(so3_exp(np.array([0.4, -0.2, 0.9])), np.array([0.1, -0.3, 0.2]))

KINDS: dict[str, JointKind] = {
    "fixed": Fixed(),
    "revolute x": Revolute((1, 0, 0)),
    "revolute -y": Revolute((0, -1, 0)),
    "revolute z": Revolute((0, 0, 1)),
    "revolute": Revolute(SKEW),
    "revolute in a plane": Revolute((0, 3, 4)),
    "continuous z": Continuous((0, 0, 1)),
    "continuous": Continuous(SKEW),
    "prismatic -x": Prismatic((-1, 0, 0)),
    "prismatic": Prismatic(SKEW),
    "helical z": Helical((0, 0, 1), 0.2),
    "helical": Helical(SKEW, -0.7),
    "cylindrical z": Cylindrical(),
    "cylindrical": Cylindrical(SKEW),
    "universal": Universal(),
    "universal askew": Universal(SKEW, (1, 0.2, 0)),
    "constant velocity": ConstantVelocity(),
    "constant velocity with a distance": ConstantVelocity(0.07),
    "rolling": Rolling(0.02, 0.02),
    "rolling inside": Rolling(-0.3, 0.1),
    "translation": Translation(),
    "planar z": Planar(),
    "planar x": Planar((1, 0, 0)),
    "planar -y": Planar((0, -1, 0)),
    "planar": Planar(SKEW),
    "circle z": Circle(),
    "circle": Circle(SKEW),
    "planar circle": PlanarCircle(),
    "planar circle skew": PlanarCircle(SKEW),
    "ellipsoid": Ellipsoid(0.5, -0.3, 0.8),
    "ellipsoid of rotation": Ellipsoid(0.5, 0.2, 0.2),
    "sphere": Ellipsoid(0.4, 0.4, 0.4),
    "spherical": Spherical(),
    "free flyer": FreeFlyer(),
    "composite": Composite(
        (Revolute((1, 0, 0)), Prismatic(SKEW), Continuous((0, 1, 0))), (TILT, TILT, SE3.trans(0, 0, 1))
    ),
    "composite of many": Composite((Spherical(), Universal(SKEW, (0, 1, 0)), Planar()), (TILT, TILT, TILT)),
}
MOVING = [name for name, kind in KINDS.items() if kind.nv]

every = pytest.mark.parametrize("name", KINDS)
moving = pytest.mark.parametrize("name", MOVING)


def rng_of(name: str) -> np.random.Generator:
    return np.random.default_rng(zlib.crc32(name.encode()))


def samples(name: str, n: int = 12) -> tuple[JointKind, np.ndarray, np.ndarray]:
    """A kind with positions (n, nq) and velocities (n, nv): none, tiny, moderate and large steps."""
    kind, rng = KINDS[name], rng_of(name)
    q = kind.random(rng, size=(n,))
    v = rng.standard_normal((n, kind.nv))
    scale = np.resize([0.0, 1e-12, 1e-6, 1e-3, 0.1, 0.4, 1.0, 0.7], n)
    return kind, q, v * scale[:, None]


def poses(kind: JointKind, q: np.ndarray) -> np.ndarray:
    return kind.transform(q).matrix()


@every
def test_neutral_is_the_identity(name: str) -> None:
    kind = KINDS[name]
    neutral = kind.neutral()
    assert neutral.shape == (kind.nq,)
    expected = np.eye(4)
    if isinstance(kind, Composite):
        for place in kind.placements or ():
            expected = expected @ place.matrix()
    if isinstance(kind, Ellipsoid):
        expected[2, 3] = kind.radius_z  # it begins at the top
    if isinstance(kind, (ConstantVelocity, Rolling)):
        expected[2, 3] = kind.distance  # the moving frame is at the second centre
    np.testing.assert_allclose(poses(kind, neutral), expected, atol=1e-15)


@every
def test_the_pose_is_a_rigid_motion(name: str) -> None:
    kind, q, _ = samples(name)
    r = kind.transform(q).rotation
    np.testing.assert_allclose(np.swapaxes(r, -1, -2) @ r, np.broadcast_to(np.eye(3), r.shape), atol=5e-15)
    np.testing.assert_allclose(np.linalg.det(r), 1.0, atol=5e-15)


@moving
def test_the_motion_subspace_is_the_derivative_of_the_pose(name: str) -> None:
    kind, q, _ = samples(name)
    h = 1e-5
    for at in q:
        pose = kind.transform(at)
        columns = kind.motion_subspace(at)
        assert len(columns) == kind.nv
        for k, column in enumerate(columns):
            step = np.zeros(kind.nv)
            step[k] = h
            forward = pose.inverse() @ kind.transform(kind.integrate(at, step))
            backward = pose.inverse() @ kind.transform(kind.integrate(at, -step))
            twist = (forward.log().vector() - backward.log().vector()) / (2 * h)
            np.testing.assert_allclose(column.vector(), twist, atol=1e-9)


@moving
def test_elementary_joints_in_a_row_are_the_joint(name: str) -> None:
    kind, q, _ = samples(name)
    parts = kind.elementary_joints(TILT)
    pose = SE3.identity()
    for part in parts:
        position = part.ratio * q[..., part.start_q : part.start_q + part.kind.nq]
        pose = pose @ part.placement @ part.kind.transform(position)
        for column in part.kind.motion_subspace(position):
            assert column.vector().shape == (6,)  # constant: no batch axes
    np.testing.assert_allclose(pose.matrix(), (TILT @ kind.transform(q)).matrix(), atol=5e-15)
    assert {k for part in parts for k in range(part.start_v, part.start_v + part.kind.nv)} == set(
        range(kind.nv)
    )


@moving
def test_the_bias_is_the_derivative_of_the_motion_subspace(name: str) -> None:
    kind, q, v = samples(name)
    h = 1e-5

    def twist(at: np.ndarray, v: np.ndarray) -> np.ndarray:
        return sum((s.vector() * x for s, x in zip(kind.motion_subspace(at), v, strict=True)), np.zeros(6))

    for at, rate in zip(q, v, strict=True):
        ahead, behind = (twist(kind.integrate(at, rate * s), rate) for s in (h, -h))
        np.testing.assert_allclose(kind.bias(at, rate).vector(), (ahead - behind) / (2 * h), atol=1e-9)


@moving
def test_the_rates_of_coordinates_are_the_derivative_of_integrate(name: str) -> None:
    kind, q, v = samples(name)
    h = 1e-6
    ahead, behind = (kind.integrate(q, s * v) for s in (h, -h))
    np.testing.assert_allclose(kind.coordinate_rates(q, v), (ahead - behind) / (2 * h), atol=2e-9)


@every
def test_integrating_nothing_stays(name: str) -> None:
    kind, q, v = samples(name)
    np.testing.assert_array_equal(kind.integrate(q, 0.0 * v), q)


@every
def test_difference_undoes_integrate(name: str) -> None:
    kind, q, v = samples(name)
    np.testing.assert_allclose(kind.difference(q, kind.integrate(q, v)), v, rtol=1e-13, atol=3e-15)


@every
def test_integrate_undoes_difference(name: str) -> None:
    kind, q, _ = samples(name)
    other = kind.random(rng_of(name + "other"), size=(len(q),))
    reached = kind.integrate(q, kind.difference(q, other))
    np.testing.assert_allclose(poses(kind, reached), poses(kind, other), atol=2e-14)
    np.testing.assert_allclose(kind.difference(reached, other), 0.0, atol=1e-13)


@every
def test_difference_turns_back_when_swapped(name: str) -> None:
    kind, q, _ = samples(name)
    other = kind.random(rng_of(name + "other"), size=(len(q),))
    np.testing.assert_allclose(kind.difference(q, other), -kind.difference(other, q), atol=1e-13)
    np.testing.assert_allclose(kind.squared_distance(q, other), kind.squared_distance(other, q), atol=1e-13)


@every
def test_motion_between_two_positions_is_uniform(name: str) -> None:
    kind, q, v = samples(name)
    end = kind.integrate(q, v)
    np.testing.assert_allclose(poses(kind, kind.interpolate(q, end, 0.0)), poses(kind, q), atol=1e-15)
    np.testing.assert_allclose(poses(kind, kind.interpolate(q, end, 1.0)), poses(kind, end), atol=1e-14)
    half = kind.interpolate(q, end, 0.5)
    np.testing.assert_allclose(kind.difference(q, half), v / 2, rtol=1e-12, atol=3e-15)
    fractions = np.linspace(0.0, 1.0, len(q))
    each = np.stack([kind.interpolate(a, b, t) for a, b, t in zip(q, end, fractions, strict=True)])
    np.testing.assert_allclose(kind.interpolate(q, end, fractions), each, atol=1e-15)


@every
def test_normalize_keeps_the_pose_and_settles(name: str) -> None:
    kind, q, _ = samples(name)
    spoiled = q.copy()
    for i, c in enumerate(kind.coordinates):
        if c.unit == "":
            spoiled[:, i] *= 1.7
    fine = kind.normalize(spoiled)
    np.testing.assert_allclose(poses(kind, fine), poses(kind, q), atol=1e-14)
    np.testing.assert_allclose(kind.normalize(fine), fine, atol=1e-15)


@every
def test_random_positions_lie_within_the_limits(name: str) -> None:
    kind, rng = KINDS[name], rng_of(name)
    assert kind.random(rng).shape == (kind.nq,)
    free = kind.random(rng, size=(200, 3))
    assert free.shape == (200, 3, kind.nq)
    counted = [i for i, c in enumerate(kind.coordinates) if c.unit]
    low, high = np.full(kind.nq, 0.2), np.full(kind.nq, 0.3)
    bounded = kind.random(rng, low, high, (500,))
    assert (bounded[:, counted] >= 0.2).all()
    assert (bounded[:, counted] <= 0.3).all()
    for i in counted:
        c = kind.coordinates[i]
        assert free[..., i].min() >= c.low
        assert free[..., i].max() <= c.high
        assert free[..., i].max() - free[..., i].min() > 0.9 * (c.high - c.low)
        one_sided = kind.random(rng, low, np.full(kind.nq, np.inf), (500,))[:, i]
        assert one_sided.min() >= 0.2
        assert one_sided.max() <= 0.2 + (c.high - c.low)
        one_sided = kind.random(rng, np.full(kind.nq, -np.inf), high, (500,))[:, i]
        assert one_sided.max() <= 0.3
        assert one_sided.min() >= 0.3 - (c.high - c.low)
    np.testing.assert_allclose(kind.normalize(free), free, atol=1e-15)


def test_random_rotations_are_spread_evenly() -> None:
    # over all rotations the mean of the rotation matrices is zero, and that of the squared entries is 1/3
    q = Spherical().random(np.random.default_rng(1), size=(40000,))
    r = Spherical().transform(q).rotation
    np.testing.assert_allclose(r.mean(axis=0), 0.0, atol=0.015)
    np.testing.assert_allclose((r * r).mean(axis=0), 1 / 3, atol=0.015)


def numerical(kind: JointKind, f, x, step) -> np.ndarray:
    """Central differences of f(x moved by step(x, d)), one column for each direction."""
    h, columns = 1e-6, []
    for k in range(kind.nv):
        d = np.zeros(kind.nv)
        d[k] = h
        columns.append((f(step(x, d)) - f(step(x, -d))) / (2 * h))
    return np.stack(columns, axis=-1)


@moving
def test_derivatives_of_integrate(name: str) -> None:
    kind, q, v = samples(name)
    by_q, by_v = kind.integrate_derivatives(q, v)
    assert by_q.shape == by_v.shape == (len(q), kind.nv, kind.nv)
    for i, (at, rate) in enumerate(zip(q, v, strict=True)):
        end = kind.integrate(at, rate)
        moved_q = numerical(kind, lambda x: kind.difference(end, kind.integrate(x, rate)), at, kind.integrate)  # noqa: B023
        moved_v = numerical(kind, lambda x: kind.difference(end, kind.integrate(at, x)), rate, np.add)  # noqa: B023
        np.testing.assert_allclose(by_q[i], moved_q, atol=2e-9)
        np.testing.assert_allclose(by_v[i], moved_v, atol=2e-9)


@moving
def test_derivatives_of_difference(name: str) -> None:
    kind, q, v = samples(name)
    other = kind.integrate(q, v)
    by_0, by_1 = kind.difference_derivatives(q, other)
    assert by_0.shape == by_1.shape == (len(q), kind.nv, kind.nv)
    for i, (a, b) in enumerate(zip(q, other, strict=True)):
        moved_0 = numerical(kind, lambda x: kind.difference(x, b), a, kind.integrate)  # noqa: B023
        moved_1 = numerical(kind, lambda x: kind.difference(a, x), b, kind.integrate)  # noqa: B023
        np.testing.assert_allclose(by_0[i], moved_0, atol=5e-9)
        np.testing.assert_allclose(by_1[i], moved_1, atol=5e-9)


@every
def test_a_batch_is_a_stack_of_singles(name: str) -> None:
    kind, q, v = samples(name, 6)
    other = kind.random(rng_of(name + "other"), size=(6,))
    grid = (2, 3)
    for f, args in (
        (kind.transform, (q,)),
        (kind.bias, (q, v)),
        (kind.integrate, (q, v)),
        (kind.difference, (q, other)),
        (kind.normalize, (q,)),
        (kind.squared_distance, (q, other)),
        (lambda *a: kind.integrate_derivatives(*a)[0], (q, v)),
        (lambda *a: kind.integrate_derivatives(*a)[1], (q, v)),
        (lambda *a: kind.difference_derivatives(*a)[0], (q, other)),
        (lambda *a: kind.difference_derivatives(*a)[1], (q, other)),
    ):
        whole = np.asarray(f(*args))
        singles = np.stack([np.asarray(f(*(a[i] for a in args))) for i in range(6)])
        np.testing.assert_allclose(np.broadcast_to(whole, singles.shape), singles, atol=1e-15)
        two_axes = np.asarray(f(*(a.reshape(*grid, -1) for a in args)))
        expected = singles.reshape(*grid, *singles.shape[1:])
        np.testing.assert_allclose(np.broadcast_to(two_axes, expected.shape), expected, atol=1e-15)
    for k, column in enumerate(kind.motion_subspace(q)):
        singles = np.stack([kind.motion_subspace(at)[k].vector() for at in q])
        np.testing.assert_allclose(np.broadcast_to(column.vector(), singles.shape), singles, atol=1e-15)


@every
def test_symbols_give_the_same_as_numbers(name: str) -> None:
    kind, q, v = samples(name, 6)
    sympy = pytest.importorskip("sympy")
    symbols = sympy.symbols(f"q:{kind.nq} v:{kind.nv}") if kind.nq else ()
    at = np.array(symbols[: kind.nq], dtype=object)
    rate = np.array(symbols[kind.nq :], dtype=object)
    values = dict(zip(symbols, [*q[4], *v[4]], strict=True))

    def number(array: np.ndarray) -> np.ndarray:
        return np.array([float(sympy.sympify(x).subs(values)) for x in array.ravel()]).reshape(array.shape)

    np.testing.assert_allclose(number(kind.transform(at).matrix()), poses(kind, q[4]), atol=1e-14)
    bias = number(kind.bias(at, rate).vector())
    np.testing.assert_allclose(bias, kind.bias(q[4], v[4]).vector(), atol=1e-14)
    np.testing.assert_allclose(number(kind.integrate(at, rate)), kind.integrate(q[4], v[4]), atol=1e-14)
    for symbolic, numeric in zip(kind.motion_subspace(at), kind.motion_subspace(q[4]), strict=True):
        np.testing.assert_allclose(number(symbolic.vector()), numeric.vector(), atol=1e-14)


@moving
def test_traces_give_the_same_as_numbers(name: str) -> None:
    kind, q, v = samples(name)
    other = kind.random(rng_of(name + "other"), size=(len(q),))
    for f, args, widths in (
        (lambda q: kind.transform(q).matrix(), (q,), {"q": kind.nq}),
        (lambda q, v: kind.bias(q, v).vector(), (q, v), {"q": kind.nq, "v": kind.nv}),
        (kind.integrate, (q, v), {"q": kind.nq, "v": kind.nv}),
        (kind.difference, (q, other), {"q0": kind.nq, "q1": kind.nq}),
        (kind.normalize, (q,), {"q": kind.nq}),
        (lambda q, v: np.stack(kind.integrate_derivatives(q, v)), (q, v), {"q": kind.nq, "v": kind.nv}),
        (
            lambda q0, q1: np.stack(kind.difference_derivatives(q0, q1)),
            (q, other),
            {"q0": kind.nq, "q1": kind.nq},
        ),
    ):
        traced = trace(f, **{label: (n,) for label, n in widths.items()})(*args)
        singles = np.stack([f(*(a[i] for a in args)) for i in range(len(q))])
        np.testing.assert_allclose(traced, singles, rtol=1e-13, atol=1e-13)


@every
def test_a_kind_is_a_value(name: str) -> None:
    kind = KINDS[name]
    copy = pickle.loads(pickle.dumps(kind))
    assert copy == kind
    assert hash(copy) == hash(kind)
    assert all(kind != other for label, other in KINDS.items() if label != name)
    assert kind.nq == len(kind.coordinates)
    assert kind.nv == len(kind.rates)
    assert kind.describe()


@pytest.mark.parametrize("axis", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, -1), (-1, 0, 0)])
def test_a_straight_axis_leaves_exact_zeros_and_ones(axis: tuple[float, float, float]) -> None:
    r = Revolute(axis).transform(np.array([0.7])).rotation
    assert np.count_nonzero(r) == 5
    assert np.count_nonzero(r == 1.0) == 1
    assert r[np.abs(axis).argmax(), np.abs(axis).argmax()] == 1.0


@pytest.mark.parametrize("turn", [0.0, 1.0, math.pi, -math.pi, 3.2, -3.2, 7.0, 100 * math.pi + 0.1, -1e-300])
def test_a_continuous_joint_goes_the_shorter_way(turn: float) -> None:
    kind = Continuous((0, 0, 1))
    d = kind.difference(np.array([0.0]), np.array([turn]))[0]
    assert -math.pi < d <= math.pi
    assert math.sin(d) == pytest.approx(math.sin(turn), abs=1e-13)
    assert math.cos(d) == pytest.approx(math.cos(turn), abs=1e-13)
    if abs(turn) < math.pi:
        assert d == turn


@pytest.mark.parametrize("kind", [Spherical(), FreeFlyer()], ids=["spherical", "free flyer"])
@pytest.mark.parametrize("short_of", [1e-3, 1e-6, 1e-9, 1e-12])
def test_differences_next_to_a_half_turn(kind: JointKind, short_of: float) -> None:
    rng = np.random.default_rng(3)
    q = kind.random(rng, size=(8,))
    v = rng.standard_normal((8, kind.nv))
    v[:, -3:] *= ((math.pi - short_of) / np.linalg.norm(v[:, -3:], axis=1))[:, None]
    np.testing.assert_allclose(kind.difference(q, kind.integrate(q, v)), v, atol=1e-12)
    flipped = kind.integrate(q, v)
    flipped[:, -4:] *= -1.0
    np.testing.assert_allclose(kind.difference(q, flipped), v, atol=1e-12)


def test_a_constant_velocity_joint_bends_without_twist() -> None:
    """The rotation vector has no z entry, so a shaft that is turned on one side turns as far on the other."""
    q = np.random.default_rng(5).uniform(-2.0, 2.0, (50, 2))
    pose = ConstantVelocity(0.1).transform(q)
    quaternion = SO3.from_matrix(pose.rotation).quat_xyzw()
    x, y = 0.5 * q.T
    expected = np.stack([np.sin(x) * np.cos(y), np.sin(y), 0.0 * x, np.cos(x) * np.cos(y)], axis=-1)
    sign = np.sign((quaternion * expected).sum(axis=-1, keepdims=True))
    np.testing.assert_allclose(sign * quaternion, expected, atol=1e-12)


def test_a_distance_must_be_finite() -> None:
    with pytest.raises(InputError, match="`distance` is nan; expected a finite number"):
        ConstantVelocity(math.nan)


@pytest.mark.parametrize("radii", [(0.03, 0.05), (-0.3, 0.1), (0.1, -0.3)])
def test_a_rolling_joint_does_not_slip(radii: tuple[float, float]) -> None:
    """The point of the moving cylinder that touches the fixed one stands still."""
    kind = Rolling(*radii)
    for q in np.random.default_rng(6).uniform(-2.0, 2.0, (20, 1)):
        T = kind.transform(q)
        contact = T.rotation.T @ (T.translation * (kind.radius_fixed / kind.distance - 1.0))
        (s,) = kind.motion_subspace(q)
        assert np.linalg.norm(contact) == pytest.approx(abs(kind.radius_moving))
        np.testing.assert_allclose(s.linear + np.cross(s.angular, contact), 0.0, atol=1e-15)


@pytest.mark.parametrize(
    ("radii", "message"), [((math.inf, 1.0), "`radius_fixed` is inf"), ((0.1, -0.1), "add up to zero")]
)
def test_centres_of_a_rolling_joint_are_apart(radii: tuple[float, float], message: str) -> None:
    with pytest.raises(InputError, match=f"Rolling: .*{message}"):
        Rolling(*radii)
