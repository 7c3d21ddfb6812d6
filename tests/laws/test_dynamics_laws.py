"""Laws of dynamics on random trees with every kind of joint: inverses, projections, energy, momentum."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from support.derivatives import along, by_configuration
from support.random_models import KINDS, random_model
from ulna import algorithms as alg
from ulna.algorithms.dynamics.centroidal_recursion import momentum_about_com, momentum_rate_about_com
from ulna.compiler import compile, trace
from ulna.model import Model, with_gravity
from ulna.spatial import Force, Inertia
from ulna.typing import Floats

TREES: dict[str, dict] = {
    "every_kind": {"mimics": 2},
    "floating": {"root": "free_flyer", "kinds": ("revolute", "universal", "prismatic"), "joints": 7, "mimics": 0},
    "floating_mimic": {"root": "free_flyer", "kinds": ("revolute", "prismatic"), "joints": 5, "mimics": 3},
    "sliding": {"root": "planar", "kinds": ("revolute", "spherical"), "joints": 6, "mimics": 0},
    "bush": {"kinds": ("revolute", "continuous", "prismatic"), "joints": 9, "branching": 1.0, "mimics": 0},
}  # fmt: skip


class Case:
    """A robot, a batch of three states, and forces on half of its bodies."""

    def __init__(self, name: str) -> None:
        rng = np.random.default_rng(500 + sorted([*KINDS, *TREES]).index(name))
        if name in TREES:
            self.model: Model = random_model(rng, **TREES[name])
        else:
            self.model = random_model(rng, ["revolute", name, "revolute", name], branching=0.0, mimics=0)
        self.q = alg.random(self.model, rng, (3,))
        self.v, self.a = rng.standard_normal((2, 3, self.model.nv))
        self.external = [
            Force(*rng.standard_normal((2, 3, 3))) if i % 2 else None for i in range(len(self.model.joints))
        ]
        self.has_mimics = any(joint.mimic for joint in self.model.joints)


@pytest.fixture(scope="module", params=[*TREES, *KINDS])
def case(request: pytest.FixtureRequest) -> Case:
    return Case(request.param)


def close(actual: Floats, expected: Floats, tolerance: float = 1e-10) -> None:
    scale = max(1.0, float(np.abs(expected).max(initial=0.0)))
    np.testing.assert_allclose(actual, expected, rtol=0.0, atol=tolerance * scale)


def times(matrix: Floats, v: Floats) -> Floats:
    return (matrix @ v[..., None])[..., 0]


def turned(matrix: Floats) -> Floats:
    return np.swapaxes(matrix, -1, -2)


def test_inverse_dynamics_is_the_sum_over_bodies(case: Case) -> None:
    m, q, v, a, external = case.model, case.q, case.v, case.a, case.external
    close(alg.inverse_dynamics(m, q, v, a, external), alg.rnea(m, q, v, a, external))
    close(alg.bias_forces(m, q, v, external), alg.rnea(m, q, v, 0.0 * a, external))
    close(alg.static_torque(m, q, external), alg.rnea(m, q, 0.0 * v, 0.0 * a, external))
    close(alg.gravity_forces(m, q), alg.rnea(m, q, 0.0 * v, 0.0 * a))


def test_forward_after_inverse_is_the_identity(case: Case) -> None:
    m, q, v, a, external = case.model, case.q, case.v, case.a, case.external
    tau = alg.inverse_dynamics(m, q, v, a, external)
    close(alg.forward_dynamics(m, q, v, tau, external), a, 1e-8)
    close(alg.by_mass_matrix(m, q, v, tau, external), a, 1e-8)
    if not case.has_mimics:
        close(alg.aba(m, q, v, tau, external), a, 1e-8)


def test_columns_of_the_mass_matrix_are_torques(case: Case) -> None:
    m, q = case.model, case.q
    M, rest = alg.mass_matrix(m, q), alg.gravity_forces(m, q)
    for k, unit in enumerate(np.eye(m.nv)):
        close(M[..., k], alg.inverse_dynamics(m, q, None, unit) - rest)
    np.testing.assert_array_equal(M, turned(M))
    assert np.linalg.eigvalsh(M).min() > 0.0
    close(alg.inverse_mass_matrix(m, q) @ M, np.broadcast_to(np.eye(m.nv), M.shape), 1e-8)


def test_coriolis_matrix(case: Case) -> None:
    m, q, v = case.model, case.q[0], case.v[0]
    C = alg.coriolis_matrix(m, q, v)
    close(times(C, v), alg.bias_forces(m, q, v) - alg.gravity_forces(m, q))
    rate = along(m, q, v, lambda there: alg.mass_matrix(m, there))
    close(rate - C, C.T, 1e-8)


def test_coriolis_matrix_is_that_of_the_christoffel_symbols() -> None:
    """Where v is the rate of q: C_ij = sum over k of (dM_ij/dq_k + dM_ik/dq_j - dM_jk/dq_i) v_k / 2."""
    m = random_model(np.random.default_rng(1), ["revolute", "prismatic", "helical", "universal", "revolute"])
    rng = np.random.default_rng(2)
    q, v = alg.random(m, rng), rng.standard_normal(m.nv)
    slope = by_configuration(m, q, lambda there: alg.mass_matrix(m, there))  # [k, i, j]
    expected = 0.5 * (
        np.einsum("kij,k->ij", slope, v) + np.einsum("jik,k->ij", slope, v) - np.einsum("ijk,k->ij", slope, v)
    )
    close(alg.coriolis_matrix(m, q, v), expected, 1e-8)


def test_power_is_the_rate_of_energy(case: Case) -> None:
    m, q, v, a = case.model, case.q[0], case.v[0], case.a[0]
    M, rest = alg.mass_matrix(m, q), alg.gravity_forces(m, q)
    close(alg.kinetic_energy(m, case.q, case.v), 0.5 * np.einsum("ni,nij,nj->n", case.v, alg.mass_matrix(m, case.q), case.v))  # fmt: skip
    close(rest, by_configuration(m, q, lambda there: alg.potential_energy(m, there)), 1e-8)
    by_place = along(m, q, v, lambda there: alg.mechanical_energy(m, there, v))
    close(v @ alg.inverse_dynamics(m, q, v, a), by_place + v @ M @ a, 1e-8)


def test_energy_counts_what_hangs(case: Case) -> None:
    m, q = case.model, case.q
    g = np.array([1.0, -2.0, 3.0])
    weight = -alg.total_mass(m) * (alg.center_of_mass(m, q) @ g)
    close(alg.potential_energy(with_gravity(m, g), q), weight)


def test_centre_of_mass(case: Case) -> None:
    m, q, v, a = case.model, case.q, case.v, case.a
    names = (None, *{m.joint_names[0], m.joint_names[len(m.joints) // 2], m.joint_names[-1]})
    for name in names:
        bodies = m.subtree(-1 if name is None else m.joint_index(name))
        mass = sum(m.inertias[i].mass for i in bodies)
        poses = alg.joint_poses(m, q)
        c = sum(m.inertias[i].mass * (poses[i] @ m.inertias[i].com) for i in bodies) / mass
        assert alg.total_mass(m, name) == pytest.approx(mass)
        close(alg.center_of_mass(m, q, name), c)
        J = alg.center_of_mass_jacobian(m, q, name)
        close(turned(J[0]), by_configuration(m, q[0], lambda there, n=name: alg.center_of_mass(m, there, n)), 1e-8)  # fmt: skip
        velocity = alg.center_of_mass_velocity(m, q, v, name)
        close(velocity, times(J, v))
        rate = along(
            m, q[0], v[0], lambda there, n=name: times(alg.center_of_mass_jacobian(m, there, n), v[0])
        )
        close(alg.center_of_mass_acceleration(m, q, v, a, name)[0], rate + J[0] @ a[0], 1e-8)


def test_centroidal_momentum(case: Case) -> None:
    m, q, v, a = case.model, case.q, case.v, case.a
    close(alg.centroidal_momentum(m, q, v), momentum_about_com(m, q, v))
    close(alg.centroidal_momentum_rate(m, q, v, a), momentum_rate_about_com(m, q, v, a))
    A, dA = alg.centroidal_matrix(m, q), alg.centroidal_matrix_dot(m, q, v)
    close(times(A, v), alg.centroidal_momentum(m, q, v))
    close(times(dA, v) + times(A, a), alg.centroidal_momentum_rate(m, q, v, a))
    poses, g = alg.joint_poses(m, q), alg.center_of_mass(m, q)
    whole = sum(
        Inertia(body.mass, body.com - g, body.inertia).about_origin()
        for T, own in zip(poses, m.inertias, strict=True)
        for body in (T.act(own),)
    )
    close(alg.centroidal_inertia(m, q), whole)
    close(dA[0], along(m, q[0], v[0], lambda there: alg.centroidal_matrix(m, there)), 1e-8)


@pytest.mark.parametrize("seed", range(3))
def test_a_model_with_mimic_joints_is_the_projection_of_the_free_one(seed: int) -> None:
    rng = np.random.default_rng(seed)
    root = (None, "free_flyer", None)[seed]
    m = random_model(rng, ["revolute", "prismatic", "spherical", "helical"], joints=6, mimics=3, root=root)
    free, B = freed(m)
    q, v, a = alg.random(m, rng), *rng.standard_normal((2, m.nv))
    q_free = np.concatenate([q, *(j.q_of(q) for j in m.joints if j.mimic)])
    close(alg.mass_matrix(m, q), B.T @ alg.mass_matrix(free, q_free) @ B)
    close(alg.inverse_dynamics(m, q, v, a), B.T @ alg.inverse_dynamics(free, q_free, B @ v, B @ a))
    close(alg.coriolis_matrix(m, q, v), B.T @ alg.coriolis_matrix(free, q_free, B @ v) @ B)
    close(alg.centroidal_matrix(m, q), alg.centroidal_matrix(free, q_free) @ B)
    close(alg.center_of_mass_jacobian(m, q), alg.center_of_mass_jacobian(free, q_free) @ B)
    close(alg.kinetic_energy(m, q, v), alg.kinetic_energy(free, q_free, B @ v))


def freed(m: Model) -> tuple[Model, Floats]:
    """The model with its mimic joints free, their coordinates at the end, and B: v_free = B v."""
    joints, nq, nv, rows = [], m.nq, m.nv, [np.eye(m.nv)]
    for joint in m.joints:
        if joint.mimic is None:
            joints.append(joint)
            continue
        row = np.zeros((1, m.nv))
        row[0, joint.idx_v] = joint.mimic.multiplier
        rows.append(row)
        joints.append(replace(joint, mimic=None, idx_q=nq, idx_v=nv))
        nq, nv = nq + 1, nv + 1
    free = replace(m, joints=tuple(joints), configurations={})
    drives = sorted(m.joints, key=lambda joint: joint.mimic is not None)
    armature = np.array([x for joint in drives for x in joint.armature])
    free.__dict__["armature"] = armature  # the model gathers it in the order of the joints, not of v
    return free, np.concatenate(rows)


@pytest.mark.parametrize("seed", range(3))
def test_the_drives_of_mimic_joints_do_their_work_at_the_source(seed: int) -> None:
    rng = np.random.default_rng(seed)
    m = random_model(rng, ["revolute", "prismatic", "helical", "spherical"], joints=5, mimics=3)
    assert any(joint.mimic is not None and joint.armature[0] > 0.0 for joint in m.joints)
    v = rng.standard_normal(m.nv)
    own = {joint: joint.v_of(v) for joint in m.joints}
    close(
        sum(j.armature @ x**2 for j, x in own.items()), v @ (m.armature * v)
    )  # twice the energy of the drives
    close(sum(j.damping @ x**2 for j, x in own.items()), v @ (m.damping * v))  # the power of viscous friction
    for k in range(
        m.nv
    ):  # the power of dry friction, one velocity at a time: its direction is that of the source
        e = v[k] * np.eye(m.nv)[k]
        close(sum(j.friction @ abs(j.v_of(e)) for j in m.joints), m.friction @ abs(e))


FUNCTIONS = {
    "inverse": alg.inverse_dynamics,
    "forward": alg.forward_dynamics,
    "bias": alg.bias_forces,
    "gravity": alg.gravity_forces,
    "mass": alg.mass_matrix,
    "inverse mass": alg.inverse_mass_matrix,
    "coriolis": alg.coriolis_matrix,
    "energy": alg.mechanical_energy,
    "com": alg.center_of_mass,
    "com acceleration": alg.center_of_mass_acceleration,
    "com jacobian": alg.center_of_mass_jacobian,
    "centroidal": alg.centroidal_matrix,
    "centroidal dot": alg.centroidal_matrix_dot,
    "momentum": alg.centroidal_momentum,
    "momentum rate": alg.centroidal_momentum_rate,
}
ARGUMENTS = {"gravity": 1, "mass": 1, "inverse mass": 1, "com": 1, "com jacobian": 1, "centroidal": 1} | {
    name: 2 for name in ("bias", "coriolis", "energy", "centroidal dot", "momentum")
}


@pytest.mark.parametrize("name", FUNCTIONS)
@pytest.mark.parametrize("tree", ["floating_mimic", "sliding"])
def test_compiled_equals_plain(tree: str, name: str) -> None:
    made = Case(tree)
    arrays = [made.q, made.v, made.a][: ARGUMENTS.get(name, 3)]
    shapes = {n: x.shape[-1:] for n, x in zip("qva", arrays, strict=False)}
    expected = FUNCTIONS[name](made.model, *arrays)
    traced = trace(lambda *x: FUNCTIONS[name](made.model, *x), name="f", **shapes)
    close(traced(*arrays), expected, 1e-9)
    if name in ("forward", "momentum rate"):
        close(compile(traced)(*arrays), expected, 1e-9)


def test_both_methods_of_forward_dynamics_agree_when_traced() -> None:
    made = Case("sliding")
    arrays = (made.q, made.v, made.a)
    shapes = {n: x.shape[-1:] for n, x in zip("qva", arrays, strict=True)}
    expected = alg.aba(made.model, *arrays)
    for f in (alg.aba, alg.by_mass_matrix):
        close(trace(lambda *x, f=f: f(made.model, *x), name="f", **shapes)(*arrays), expected, 1e-9)


BUDGET = {"inverse": 630, "bias": 605, "gravity": 120, "mass": 390, "inverse mass": 735, "forward": 1210, "coriolis": 1600, "com": 80}  # fmt: skip


@pytest.mark.parametrize("name", BUDGET)
def test_the_price_of_the_panda(name: str) -> None:
    """Scalar operations of one evaluation; a change that makes the arm's dynamics dearer must say so."""
    from ulna.robots.panda import panda

    model = panda()
    shapes = dict(zip("qva", [(7,)] * ARGUMENTS.get(name, 3), strict=False))
    assert trace(lambda *x: FUNCTIONS[name](model, *x), name="f", **shapes).operations <= BUDGET[name]
