"""Laws of rotations, poses, twists, wrenches and inertias, sampled near their singular points on purpose."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ulna
from ulna import spatial as sp
from ulna.compiler import trace
from ulna.numeric import apply, cross, dot, skew
from ulna.spatial import SE3, SO3, Force, Inertia, Motion


def law(*strategies: Any) -> Any:
    """Forty samples, the same in every run."""
    return lambda f: settings(max_examples=40, deadline=None, derandomize=True)(given(*strategies)(f))


EPS = np.finfo(float).eps
ANGLES = [0.0, 1e-300, 1e-12, 1e-9, 1e-7, 1e-5, 1e-3, 0.0316, 0.1, 0.1999, 0.2001, 0.5, 1.0, 2.0, 3.0]
NEAR_PI = [np.pi - d for d in (1e-3, 1e-5, 1e-7, 1e-9, 1e-12, 1e-15)]
DIRECTIONS = [
    *np.eye(3),
    *-np.eye(3),
    [1, 1, 0],
    [0, 1, -1],
    [1, 1e-9, 0],
    [1, 2, 3],
    [-3, 2, -1],
    [1e-7, -1, 1e-3],
]

component = st.floats(-1.0, 1.0, allow_subnormal=False)
vectors = st.tuples(component, component, component).map(np.array)
angles = st.one_of(st.sampled_from(ANGLES + NEAR_PI), st.floats(0.0, np.pi - 1e-9))


@st.composite
def rotation_vectors(draw: st.DrawFn) -> np.ndarray:
    d = np.array(draw(st.one_of(st.sampled_from([np.array(d, float) for d in DIRECTIONS]), vectors)))
    n = np.linalg.norm(d)
    return (d / n if n > 1e-3 else np.array([0.0, 0.0, 1.0])) * draw(angles)


@st.composite
def poses(draw: st.DrawFn) -> SE3:
    return SE3(sp.so3_exp(draw(rotation_vectors())), draw(vectors))


@st.composite
def inertias(draw: st.DrawFn) -> Inertia:
    root = np.array([draw(vectors) for _ in range(3)])
    return Inertia(draw(st.floats(0.01, 10.0)), draw(vectors), root @ root.T + 0.1 * np.eye(3))


def pairs(kind: type) -> st.SearchStrategy:
    return st.builds(kind, vectors, vectors)


def close(a: object, b: object, tolerance: float = 1e-13) -> None:
    a, b = np.asarray(a, float), np.asarray(b, float)
    np.testing.assert_allclose(a, b, rtol=tolerance, atol=tolerance)


# the groups


@law(poses(), poses(), poses())
def test_poses_form_a_group(a: SE3, b: SE3, c: SE3) -> None:
    close((a @ b) @ c, a @ (b @ c))
    close(a @ SE3.identity(), a)
    close(SE3.identity() @ a, a)
    close(a @ a.inverse(), np.eye(4))
    close((a @ b).inverse(), b.inverse() @ a.inverse())


@law(poses(), poses(), vectors)
def test_poses_act_on_points_as_matrices_do(a: SE3, b: SE3, p: np.ndarray) -> None:
    close(a @ p, (a.matrix() @ np.append(p, 1.0))[:3])
    close((a @ b) @ p, a @ (b @ p))
    close(a.inverse() @ (a @ p), p)


@law(rotation_vectors())
def test_so3_exp_makes_rotations(w: np.ndarray) -> None:
    r = sp.so3_exp(w)
    close(r.T @ r, np.eye(3), 4 * EPS)
    close(np.linalg.det(r), 1.0)
    close(r @ w, w)
    close(np.trace(r), 1 + 2 * np.cos(np.linalg.norm(w)))
    close(sp.so3_exp(-w), r.T, 0.0)


# exponential and logarithm


@law(rotation_vectors())
def test_so3_log_undoes_exp(w: np.ndarray) -> None:
    back = sp.so3_log(sp.so3_exp(w))
    np.testing.assert_allclose(back, w, rtol=1e-14, atol=4 * EPS * np.linalg.norm(w) + 1e-305)


@pytest.mark.parametrize("direction", DIRECTIONS)
def test_so3_log_of_half_turns_is_a_half_turn_about_the_axis(direction: list[float]) -> None:
    axis = np.array(direction, float) / np.linalg.norm(direction)
    w = sp.so3_log(2 * np.outer(axis, axis) - np.eye(3))
    close(np.linalg.norm(w), np.pi)
    close(abs(w @ axis), np.pi)


@pytest.mark.parametrize("angle", [np.pi + 1e-9, 3.5, 5.0, 2 * np.pi - 1e-6, 7.0, 100.0])
@pytest.mark.parametrize("direction", DIRECTIONS[::3])
def test_so3_log_is_the_shortest_vector(angle: float, direction: list[float]) -> None:
    axis = np.array(direction, float) / np.linalg.norm(direction)
    w = sp.so3_log(sp.so3_exp(angle * axis))
    assert np.linalg.norm(w) <= np.pi + 4 * EPS
    close(sp.so3_exp(w), sp.so3_exp(angle * axis))


@law(rotation_vectors(), vectors)
def test_se3_log_undoes_exp(w: np.ndarray, v: np.ndarray) -> None:
    twist = np.concatenate([v, w])
    close(sp.se3_exp(twist).log().vector(), twist, 1e-13)
    close(SE3.exp(Motion(v, w)), sp.se3_exp(twist), 0.0)
    close(sp.se3_log(SE3.exp(twist)).vector(), twist, 1e-13)


@law(poses())
def test_se3_exp_undoes_log(a: SE3) -> None:
    close(SE3.exp(a.log()), a)


@law(rotation_vectors(), vectors)
def test_se3_exp_is_the_exponential_of_the_matrix(w: np.ndarray, v: np.ndarray) -> None:
    linalg = pytest.importorskip("scipy.linalg")
    m = np.zeros((4, 4))
    m[:3, :3], m[:3, 3] = skew(w), v
    close(SE3.exp(Motion(v, w)), linalg.expm(m))


@law(poses(), poses(), st.floats(0.0, 1.0))
def test_interpolation_starts_ends_and_keeps_its_pace(a: SE3, b: SE3, t: float) -> None:
    for straight in (False, True):
        close(a.interpolate(b, 0.0, straight), a)
        close(a.interpolate(b, 1.0, straight), b)
        angle = a.distance(b)[1]
        np.testing.assert_allclose(a.distance(a.interpolate(b, t, straight))[1], t * angle, atol=1e-12)
    close(a.interpolate(b, t, True).translation, (1 - t) * a.translation + t * b.translation)


# Jacobians


def central(f: object, x: np.ndarray, h: float = 1e-5) -> np.ndarray:
    """Derivative by central differences of fourth order, error about 1e-11."""
    columns = []
    for e in np.eye(len(x)) * h:
        near, far = f(x + e) - f(x - e), f(x + 2 * e) - f(x - 2 * e)  # type: ignore[operator]
        columns.append((8 * near - far) / (12 * h))
    return np.stack(columns, axis=-1)


@law(rotation_vectors())
def test_so3_jacobians_are_derivatives_of_exp(w: np.ndarray) -> None:
    r = sp.so3_exp(w)
    left = central(lambda x: sp.so3_log(sp.so3_exp(x) @ r.T), w)
    right = central(lambda x: sp.so3_log(r.T @ sp.so3_exp(x)), w)
    close(sp.so3_left_jacobian(w), left, 1e-9)
    close(sp.so3_right_jacobian(w), right, 1e-9)


@law(rotation_vectors(), vectors)
def test_se3_jacobians_are_derivatives_of_exp(w: np.ndarray, v: np.ndarray) -> None:
    x = np.concatenate([v, w])
    a = sp.se3_exp(x)
    left = central(lambda y: (sp.se3_exp(y) @ a.inverse()).log().vector(), x)
    right = central(lambda y: (a.inverse() @ sp.se3_exp(y)).log().vector(), x)
    close(sp.se3_left_jacobian(x), left, 1e-9)
    close(sp.se3_right_jacobian(x), right, 1e-9)


@law(rotation_vectors(), vectors)
def test_jacobians_and_their_inverses_cancel(w: np.ndarray, v: np.ndarray) -> None:
    x = np.concatenate([v, w])
    close(sp.so3_left_jacobian(w) @ sp.so3_left_jacobian_inverse(w), np.eye(3), 1e-14)
    close(sp.so3_right_jacobian(w) @ sp.so3_right_jacobian_inverse(w), np.eye(3), 1e-14)
    close(sp.se3_left_jacobian(x) @ sp.se3_left_jacobian_inverse(x), np.eye(6), 1e-13)
    close(sp.se3_right_jacobian(x) @ sp.se3_right_jacobian_inverse(x), np.eye(6), 1e-13)
    close(sp.so3_left_jacobian(w), sp.so3_exp(w) @ sp.so3_right_jacobian(w))
    close(sp.se3_left_jacobian(x), sp.se3_exp(x).adjoint() @ sp.se3_right_jacobian(x))


# frames, duals, inertias


@law(poses(), pairs(Motion), pairs(Motion), pairs(Force))
def test_actions_keep_power_and_brackets(a: SE3, m: Motion, n: Motion, f: Force) -> None:
    close(a.act(m).dot(a.act(f)), m.dot(f), 1e-12)
    close(a.act(m.cross(n)), a.act(m).cross(a.act(n)), 1e-12)
    close(a.act(m.cross(f)), a.act(m).cross(a.act(f)), 1e-12)
    close(m.cross(n), -n.cross(m))
    close(m.cross(n).dot(f), -n.dot(m.cross(f)), 1e-12)


@law(poses(), poses(), pairs(Motion), pairs(Force), inertias())
def test_actions_compose_and_are_undone(a: SE3, b: SE3, m: Motion, f: Force, i: Inertia) -> None:
    for item in (m, f, i):
        close((a @ b).act(item), a.act(b.act(item)), 1e-12)
        close(a.act_inverse(a.act(item)), item, 1e-12)
        close(a.act_inverse(item), a.inverse().act(item), 1e-12)
    close(a.adjoint() @ m.vector(), a.act(m))
    close(a.dual_adjoint() @ f.vector(), a.act(f))
    close(a.dual_adjoint(), np.linalg.inv(a.adjoint()).T, 1e-12)


@law(pairs(Motion), pairs(Motion), pairs(Motion), pairs(Force))
def test_brackets_are_matrices_and_obey_jacobi(a: Motion, b: Motion, c: Motion, f: Force) -> None:
    close(a.cross_matrix() @ b.vector(), a.cross(b))
    close(-a.cross_matrix().T @ f.vector(), a.cross(f))
    close(a.cross(b.cross(c)) + b.cross(c.cross(a)) + c.cross(a.cross(b)), np.zeros(6))


@law(poses(), rotation_vectors(), vectors)
def test_action_is_conjugation_of_exp(a: SE3, w: np.ndarray, v: np.ndarray) -> None:
    close(a @ SE3.exp(Motion(v, w)) @ a.inverse(), SE3.exp(a.act(Motion(v, w))), 1e-12)


@law(poses(), inertias(), pairs(Motion), pairs(Motion))
def test_inertia_is_a_symmetric_map_and_keeps_energy(a: SE3, i: Inertia, m: Motion, n: Motion) -> None:
    close(i.matrix() @ m.vector(), i.apply(m))
    close(i.matrix(), i.matrix().T, 0.0)
    close(n.dot(i.apply(m)), m.dot(i.apply(n)), 1e-12)
    close(a.act(i).apply(a.act(m)), a.act(i.apply(m)), 1e-11)
    close(a.act(i).kinetic_energy(a.act(m)), i.kinetic_energy(m), 1e-11)
    x = a.inverse().adjoint()
    close(a.act(i), x.T @ i.matrix() @ x, 1e-11)


@law(inertias(), inertias(), inertias())
def test_inertias_add_like_their_matrices(a: Inertia, b: Inertia, c: Inertia) -> None:
    close(a + b, a.matrix() + b.matrix(), 1e-11)
    close((a + b) + c, a + (b + c), 1e-11)
    close(a + Inertia.zero(), a, 1e-12)
    close(Inertia.from_parameters(a.parameters()), a, 1e-10)
    close((a + b).parameters(), a.parameters() + b.parameters(), 1e-11)


# quaternions and angles


@law(rotation_vectors(), rotation_vectors(), vectors)
def test_quaternions_are_rotations(u: np.ndarray, w: np.ndarray, v: np.ndarray) -> None:
    p, q = sp.quat_exp(u), sp.quat_exp(w)
    close(np.linalg.norm(q), 1.0)
    close(sp.quat_xyzw_to_matrix(q), sp.so3_exp(w))
    close(sp.quat_xyzw_to_matrix(sp.quat_multiply(p, q)), sp.so3_exp(u) @ sp.so3_exp(w))
    close(sp.quat_rotate(q, v), sp.so3_exp(w) @ v)
    close(sp.quat_multiply(q, sp.quat_conjugate(q)), [0, 0, 0, 1])
    np.testing.assert_allclose(sp.quat_log(q), w, rtol=1e-14, atol=4 * EPS * np.linalg.norm(w) + 1e-305)
    close(sp.quat_log(-3.7 * q), sp.quat_log(q), 1e-14)


@law(st.lists(st.floats(-1, 1, allow_subnormal=False), min_size=4, max_size=4))
def test_matrix_to_quat_finds_every_quaternion(values: list[float]) -> None:
    q = np.array(values)
    n = np.linalg.norm(q)
    q = q / n if n > 1e-3 else np.array([0.0, 0.0, 0.0, 1.0])
    back = sp.matrix_to_quat_xyzw(sp.quat_xyzw_to_matrix(q))
    assert back[3] >= 0
    close(min(np.abs(back - q).max(), np.abs(back + q).max()), 0.0, 1e-15 * 4)


@law(rotation_vectors(), rotation_vectors(), st.floats(0, 1))
def test_slerp_is_interpolation_of_rotations(u: np.ndarray, w: np.ndarray, t: float) -> None:
    between = sp.quat_slerp(sp.quat_exp(u), sp.quat_exp(w), t)
    a, b = SO3.exp(u), SO3.exp(w)
    if a.distance(b) < np.pi - 1e-6:  # at a half turn both ways are the shortest
        close(sp.quat_xyzw_to_matrix(between), a.interpolate(b, t), 1e-8)


SEQUENCES = [a + b + c for a in "xyz" for b in "xyz" for c in "xyz" if b not in (a, c)]
SINGULAR = [
    0.0,
    1e-15,
    1e-12,
    1e-8,
    1e-4,
    0.3,
    np.pi / 2 - 1e-8,
    np.pi / 2 - 1e-15,
    np.pi / 2,
    -np.pi / 2,
    np.pi,
]


@pytest.mark.parametrize("axes", SEQUENCES)
def test_euler_angles_come_back_as_the_same_rotation_everywhere(axes: str) -> None:
    grid = np.array(np.meshgrid([0.7, -2.9, 0.0], SINGULAR, [0.4, 3.1, 0.0], indexing="ij")).reshape(3, -1).T
    r = sp.euler_to_matrix(grid, axes)
    back = sp.matrix_to_euler(r, axes)
    close(sp.euler_to_matrix(back, axes), r, 3e-14)
    low, high = (0.0, np.pi) if axes[0] == axes[2] else (-np.pi / 2, np.pi / 2)
    assert (back[:, 1] >= low).all()
    assert (back[:, 1] <= high).all()
    assert (np.abs(back) <= np.pi).all()


@pytest.mark.parametrize("axes", SEQUENCES)
def test_euler_angles_come_back_as_themselves_away_from_singular_poses(axes: str) -> None:
    rng = np.random.default_rng(3)
    middle = rng.uniform(0.1, 3.0, 50) if axes[0] == axes[2] else rng.uniform(-1.4, 1.4, 50)
    given_angles = np.stack([rng.uniform(-3.1, 3.1, 50), middle, rng.uniform(-3.1, 3.1, 50)], axis=-1)
    close(sp.matrix_to_euler(sp.euler_to_matrix(given_angles, axes), axes), given_angles, 1e-13)


@pytest.mark.parametrize("axes", SEQUENCES)
def test_euler_rates_make_the_angular_velocity(axes: str) -> None:
    x = np.array([0.4, 0.9, -1.3])
    r = sp.euler_to_matrix(x, axes)
    derivative = central(lambda y: sp.so3_log(sp.euler_to_matrix(y, axes) @ r.T), x)
    close(sp.euler_rate_matrix(x, axes), derivative, 1e-9)
    close(sp.euler_rate_matrix(x, axes) @ sp.euler_rate_matrix_inverse(x, axes), np.eye(3))
    rates, h = np.array([0.7, -1.1, 0.4]), 1e-6
    ahead, behind = (sp.euler_rate_matrix(x + t * rates, axes) for t in (h, -h))
    close(sp.euler_rate_matrix_dot(x, rates, axes), (ahead - behind) / (2.0 * h), 1e-8)


@pytest.mark.parametrize("name", ["rpy", "eul"])
def test_named_angles_agree_with_their_rates(name: str) -> None:
    to_matrix, rates = getattr(sp, f"{name}_to_matrix"), getattr(sp, f"{name}_rate_matrix")
    x = np.array([0.4, 0.9, -1.3])
    r = to_matrix(x)
    close(rates(x), central(lambda y: sp.so3_log(to_matrix(y) @ r.T), x), 1e-9)
    close(rates(x) @ getattr(sp, f"{name}_rate_matrix_inverse")(x), np.eye(3))
    close(getattr(sp, f"matrix_to_{name}")(r), x)


@law(rotation_vectors())
def test_angle_and_axis_come_back(w: np.ndarray) -> None:
    angle, axis = sp.matrix_to_angle_axis(sp.so3_exp(w))
    assert 0.0 <= angle <= np.pi
    close(np.linalg.norm(axis), 1.0)
    close(angle * axis, w)
    close(sp.angle_axis_to_matrix(angle, axis), sp.so3_exp(w))


@pytest.mark.parametrize("dtype", ["float64", "float32"])
def test_the_axis_of_no_turn_is_x_in_either_precision(dtype: str) -> None:
    angle, axis = ulna.compile(sp.matrix_to_angle_axis, rotation=(3, 3), dtype=dtype)(np.eye(3))
    assert angle == 0.0 and axis.tolist() == [1.0, 0.0, 0.0]


# batches, traces and symbols: the same source

MAPS = {
    "so3_exp": (sp.so3_exp, "w"),
    "so3_log": (lambda w: sp.so3_log(sp.so3_exp(w)), "w"),
    "so3_left_jacobian": (sp.so3_left_jacobian, "w"),
    "so3_right_jacobian": (sp.so3_right_jacobian, "w"),
    "so3_left_jacobian_inverse": (sp.so3_left_jacobian_inverse, "w"),
    "so3_right_jacobian_inverse": (sp.so3_right_jacobian_inverse, "w"),
    "se3_exp": (lambda x: sp.se3_exp(x).matrix(), "x"),
    "se3_log": (lambda x: sp.se3_log(sp.se3_exp(x)).vector(), "x"),
    "se3_left_jacobian": (sp.se3_left_jacobian, "x"),
    "se3_right_jacobian_inverse": (sp.se3_right_jacobian_inverse, "x"),
    "quat_exp": (sp.quat_exp, "w"),
    "quat_log": (lambda w: sp.quat_log(sp.quat_exp(w)), "w"),
    "quat": (lambda w: sp.matrix_to_quat_xyzw(sp.so3_exp(w)), "w"),
    "quat_rotate": (lambda x: sp.quat_rotate(sp.quat_exp(x[..., 3:]), x[..., :3]), "x"),
    "rpy": (sp.rpy_to_matrix, "w"),
    "rpy back": (lambda w: sp.matrix_to_rpy(sp.rpy_to_matrix(0.4 * w)), "w"),
    "eul": (sp.eul_to_matrix, "w"),
    "eul back": (lambda w: sp.matrix_to_eul(sp.eul_to_matrix(w)), "w"),
    "rpy rates": (sp.rpy_rate_matrix, "w"),
    "rpy rates changing": (lambda w: sp.rpy_rate_matrix_dot(w, w + 0.3), "w"),
    "rpy rates inverse": (lambda w: sp.rpy_rate_matrix_inverse(0.4 * w), "w"),
    "angle axis": (lambda w: sp.angle_axis_to_matrix(w[..., 0], np.array([0.6, 0.0, 0.8])), "w"),
    "angle axis back": (lambda w: sp.matrix_to_angle_axis(sp.so3_exp(w))[1], "w"),
    "inverse": (lambda x: sp.se3_exp(x).inverse().matrix(), "x"),
    "adjoint": (lambda x: sp.se3_exp(x).adjoint(), "x"),
    "dual_adjoint": (lambda x: sp.se3_exp(x).dual_adjoint(), "x"),
    "cross_matrix": (lambda x: Motion(x[..., :3], x[..., 3:]).cross_matrix(), "x"),
    "interpolate": (lambda x: SE3.rx(0.3).interpolate(sp.se3_exp(x), 0.3).matrix(), "x"),
    "inertia": (lambda x: sp.se3_exp(x).act(Inertia.from_box(2.0, [1, 2, 3])).matrix(), "x"),
    "joined": (
        lambda x: (sp.se3_exp(x).act(Inertia.from_sphere(2.0, 1)) + Inertia.from_point(1)).parameters(),
        "x",
    ),
    "momentum": (
        lambda x: Inertia.from_box(2.0, [1, 2, 3]).apply(Motion(x[..., :3], x[..., 3:])).vector(),
        "x",
    ),
}


def samples(kind: str) -> np.ndarray:
    rng = np.random.default_rng(11)
    w = rng.standard_normal((7, 3))
    w *= (np.array([0.3, 1e-9, 0.1, 1e-4, 1.7, 2.9, np.pi - 1e-7]) / np.linalg.norm(w, axis=-1))[:, None]
    return w if kind == "w" else np.concatenate([rng.standard_normal((7, 3)), w], axis=-1)


@pytest.mark.parametrize("name", MAPS)
def test_a_batch_is_a_stack_of_singles(name: str) -> None:
    f, kind = MAPS[name]
    x = samples(kind)
    singles = np.stack([f(row) for row in x])
    close(f(x), singles, 1e-15)
    close(f(x.reshape(7, 1, -1)), singles[:, None], 1e-15)
    assert f(x[:0]).shape == (0, *singles.shape[1:])


@pytest.mark.parametrize("name", MAPS)
def test_a_trace_computes_what_floats_do(name: str) -> None:
    f, kind = MAPS[name]
    x = samples(kind)
    close(trace(f, x=x.shape[1])(x), f(x), 1e-14)


@pytest.mark.parametrize("name", [n for n in MAPS if n not in ("angle axis back", "eul back")])
def test_traced_derivatives_are_finite_and_right(name: str) -> None:
    f, kind = MAPS[name]
    x = samples(kind)
    x = np.concatenate([x[:-1], np.zeros((1, x.shape[1]))])  # derivatives of the logarithm jump at half turns
    derivative = trace(f, x=x.shape[1]).jacobian()(x)
    assert np.isfinite(derivative).all()
    for row, d in zip(x, derivative, strict=True):
        close(d, central(f, row, 1e-4), 1e-8)


@pytest.mark.parametrize("name", ["so3_log", "se3_log", "quat"])
def test_traced_logarithms_have_finite_derivatives_at_half_turns(name: str) -> None:
    f, kind = MAPS[name]
    x = np.zeros((3, 3 if kind == "w" else 6))
    x[:, -3:] = np.pi * np.eye(3)
    assert np.isfinite(trace(f, x=x.shape[1]).jacobian()(x)).all()


# SymPy takes minutes over cases inside the conditions of cases, so logarithms are given plain symbols, below.
NESTED = ("so3_log", "se3_log", "quat", "angle axis back", "interpolate")


@pytest.mark.parametrize("name", [n for n in MAPS if n not in NESTED])
def test_symbols_pass_through(name: str) -> None:
    sympy = pytest.importorskip("sympy")
    f, kind = MAPS[name]
    x = samples(kind)[4]
    symbols = np.array(sympy.symbols(f"x:{len(x)}"), dtype=object)
    result, expected = f(symbols), f(x)
    assert result.dtype == object
    assert result.shape == expected.shape
    values = sympy.lambdify(list(symbols), list(result.flat), modules="math", cse=True)(*x)
    close(np.reshape(values, expected.shape), expected, 1e-14)


@pytest.mark.parametrize("f", [sp.so3_log, sp.matrix_to_quat_xyzw, sp.matrix_to_rpy, sp.matrix_to_eul])
def test_a_matrix_of_symbols_passes_through(f: Any) -> None:
    sympy = pytest.importorskip("sympy")
    symbols = np.array(sympy.symbols("r:9"), dtype=object).reshape(3, 3)
    evaluate = sympy.lambdify(list(symbols.flat), list(f(symbols)), modules="math", cse=True)
    for w in ([0.1, 2.0, 0.3], [3.0, 0.1, 0.0], [0.0, 0.0, 1e-5]):
        r = sp.so3_exp(np.array(w))
        close(evaluate(*r.flat), f(r), 1e-14)


def test_the_rotation_about_x_is_what_a_book_prints() -> None:
    sympy = pytest.importorskip("sympy")
    q = sympy.Symbol("q")
    expected = sympy.Matrix([[1, 0, 0], [0, sympy.cos(q), -sympy.sin(q)], [0, sympy.sin(q), sympy.cos(q)]])
    assert sympy.nsimplify(sympy.Matrix(SO3.rx(q).matrix)) == expected
    turned = sp.angle_axis_to_matrix(q, np.array([1.0, 0.0, 0.0]))
    assert sympy.nsimplify(sympy.simplify(sympy.Matrix(turned) - expected)) == sympy.zeros(3)


COSTS = {
    "compose": (
        lambda r, p, s, t: (SE3(r, p) @ SE3(s, t)).matrix(),
        {"r": (3, 3), "p": 3, "s": (3, 3), "t": 3},
        63,
    ),
    "invert": (lambda r, p: SE3(r, p).inverse().matrix(), {"r": (3, 3), "p": 3}, 18),
    "act on a twist": (
        lambda r, p, v, w: SE3(r, p).act(Motion(v, w)).vector(),
        {"r": (3, 3), "p": 3, "v": 3, "w": 3},
        42,
    ),
    "act back": (
        lambda r, p, v, w: SE3(r, p).act_inverse(Force(v, w)).vector(),
        {"r": (3, 3), "p": 3, "v": 3, "w": 3},
        42,
    ),
    "turn about x": (lambda q: sp.angle_axis_to_matrix(q, np.array([1.0, 0.0, 0.0])), {"q": ()}, 3),
    "turn inertia": (
        lambda r, i: SE3(r, np.zeros(3)).act(Inertia(1.0, np.zeros(3), i)).inertia,
        {"r": (3, 3), "i": (3, 3)},
        75,
    ),
    "so3_exp": (sp.so3_exp, {"w": 3}, 60),
    "so3_log": (sp.so3_log, {"r": (3, 3)}, 66),
    "se3_log": (lambda r, p: SE3(r, p).log().vector(), {"r": (3, 3), "p": 3}, 118),
    "se3_left_jacobian_inverse": (sp.se3_left_jacobian_inverse, {"x": 6}, 132),
}


@pytest.mark.parametrize("name", COSTS)
def test_inner_loops_stay_cheap(name: str) -> None:
    f, shapes, budget = COSTS[name]
    assert trace(f, **shapes).operations <= budget


# small identities


@law(vectors, vectors, vectors)
def test_numeric_helpers_agree_with_each_other(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> None:
    close(cross(a, b), apply(skew(a), b))
    close(dot(a, cross(b, c)), np.linalg.det([a, b, c]), 1e-12)


@law(poses(), st.floats(1e-12, 1e-7))
def test_projection_undoes_a_small_disturbance(a: SE3, size: float) -> None:
    m = a.matrix()
    disturbed = m + size * np.outer([1, -1, 0.5, 0], [0.3, 1, -1, 0])
    assert SO3.project(disturbed[:3, :3]).distance(a.so3()) <= 3 * size
    close(SO3.project(m[:3, :3]), m[:3, :3])
