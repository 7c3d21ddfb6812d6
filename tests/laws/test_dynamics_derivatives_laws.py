"""The derivatives of dynamics are derivatives: by differences along the tangent space, and by our own AD."""

from __future__ import annotations

import numpy as np
import pytest

from support.derivatives import by_configuration, by_vector
from support.random_models import KINDS, random_model
from ulna import algorithms as alg
from ulna.algorithms import random
from ulna.algorithms.derivatives.centroidal import centroidal_derivatives, com_velocity_derivatives
from ulna.algorithms.derivatives.forward_dynamics import forward_dynamics_derivatives
from ulna.algorithms.derivatives.inverse_dynamics import inverse_dynamics_derivatives
from ulna.algorithms.dynamics.centroidal_recursion import momentum_about_com, momentum_rate_about_com
from ulna.compiler import trace
from ulna.model import Model
from ulna.spatial import Force
from ulna.typing import Floats

TREES: dict[str, dict] = {
    "every_kind": {"mimics": 2},
    "floating": {
        "root": "free_flyer",
        "kinds": ("revolute", "universal", "prismatic"),
        "joints": 8,
        "mimics": 3,
    },
    "sliding": {"root": "planar", "kinds": ("revolute", "spherical"), "joints": 6},
    "bush": {"kinds": ("revolute", "continuous", "prismatic"), "joints": 9, "branching": 1.0, "mimics": 2},
}


class Case:
    """A robot, a state, and forces on half of its bodies."""

    def __init__(self, name: str) -> None:
        rng = np.random.default_rng(100 + sorted([*KINDS, *TREES]).index(name))
        if name in TREES:
            self.model: Model = random_model(rng, **TREES[name])
        else:
            self.model = random_model(rng, ["revolute", name, "revolute", name, "revolute"], branching=0.0)
        self.q = random(self.model, rng)
        self.v, self.a = rng.standard_normal((2, self.model.nv))
        self.external = [
            Force(*rng.standard_normal((2, 3))) if i % 2 else None for i in range(len(self.model.joints))
        ]


@pytest.fixture(scope="module", params=[*TREES, *KINDS])
def case(request: pytest.FixtureRequest) -> Case:
    return Case(request.param)


def close(actual: Floats, expected: Floats, tolerance: float = 1e-9) -> None:
    scale = max(1.0, float(np.abs(expected).max(initial=0.0)))
    np.testing.assert_allclose(actual, expected, rtol=0.0, atol=tolerance * scale)


def test_inverse_dynamics_by_differences(case: Case) -> None:
    model, q, v, a, external = case.model, case.q, case.v, case.a, case.external
    by_q, by_v, M = inverse_dynamics_derivatives(model, q, v, a, external)
    close(by_q, by_configuration(model, q, lambda x: alg.rnea(model, x, v, a, external)).T)
    close(by_v, by_vector(v, lambda x: alg.rnea(model, q, x, a, external)).T)
    close(M, by_vector(a, lambda x: alg.rnea(model, q, v, x, external)).T)


def test_forward_dynamics_follows_from_inverse(case: Case) -> None:
    """Differentiating tau = ID(q, v, FD(q, v, tau)) by each argument."""
    model, q, v, a, external = case.model, case.q, case.v, case.a, case.external
    tau = alg.rnea(model, q, v, a, external)
    by_q, by_v, by_tau = forward_dynamics_derivatives(model, q, v, tau, external)
    tau_q, tau_v, M = inverse_dynamics_derivatives(model, q, v, a, external)
    close(M @ by_tau, np.eye(model.nv))
    close(M @ by_q, -tau_q)
    close(M @ by_v, -tau_v)


def test_traced_equals_floats(case: Case) -> None:
    model = case.model
    sizes = {"q": (model.nq,), "v": (model.nv,), "a": (model.nv,)}
    for f in (inverse_dynamics_derivatives, forward_dynamics_derivatives):
        traced = trace(lambda q, v, a, f=f: f(model, q, v, a, case.external), **sizes)
        given = case.q, case.v, case.a
        for mine, other in zip(traced(*given), f(model, *given, case.external), strict=True):
            close(mine, other, 1e-8 if f is forward_dynamics_derivatives else 1e-11)


def test_batches_equal_single_states(case: Case) -> None:
    model, rng = case.model, np.random.default_rng(0)
    q = random(model, rng, (3, 2))
    v, a = rng.standard_normal((2, 2, model.nv))
    for f in (inverse_dynamics_derivatives, forward_dynamics_derivatives):
        whole = f(model, q, v, a)
        single = f(model, q[1, 1], v[1], a[1])
        for mine, other in zip(whole, single, strict=True):
            assert mine.shape == (3, 2, model.nv, model.nv)
            close(mine[1, 1], other)


@pytest.mark.parametrize("name", ["every_kind", "floating", "sliding"])
def test_automatic_differentiation_agrees(name: str) -> None:
    case = Case(name)
    model = case.model
    traced = trace(lambda v, a: alg.rnea(model, case.q.astype(object), v, a), v=(model.nv,), a=(model.nv,))
    by_q, by_v, M = inverse_dynamics_derivatives(model, case.q, case.v, case.a)
    close(traced.jacobian("v")(case.v, case.a), by_v)
    close(traced.jacobian("a")(case.v, case.a), M)
    assert by_q.any()


def test_mass_matrix_is_symmetric_and_quadratic_terms_are_skew(case: Case) -> None:
    """M is symmetric; for joints without quasi-velocities Christoffel's symbols give dtau/dv + its transpose = 2 dM/dt."""
    model, q, v = case.model, case.q, case.v
    by_v, M = inverse_dynamics_derivatives(model, q, v, 0.0 * v)[1:]
    close(M, M.T)
    if any(joint.kind.nv != joint.kind.nq or joint.kind.name == "planar" for joint in model.joints):
        return
    rate = by_configuration(model, q, lambda x: inverse_dynamics_derivatives(model, x, v, v)[2])
    close(by_v + by_v.T, 2.0 * np.tensordot(v, rate, 1))


def test_centroidal_momentum_by_differences(case: Case) -> None:
    model, q, v, a = case.model, case.q, case.v, case.a
    dh_dq, dF_dq, dF_dv, dF_da = centroidal_derivatives(model, q, v, a)
    close(dh_dq, by_configuration(model, q, lambda x: momentum_about_com(model, x, v)).T)
    close(dF_dq, by_configuration(model, q, lambda x: momentum_rate_about_com(model, x, v, a)).T)
    close(dF_dv, by_vector(v, lambda x: momentum_rate_about_com(model, q, x, a)).T)
    close(dF_da, by_vector(a, lambda x: momentum_rate_about_com(model, q, v, x)).T)
    close(dF_da @ v, momentum_about_com(model, q, v))
    mass = sum(float(body.mass) for body in model.inertias)
    by_q, by_v = com_velocity_derivatives(model, q, v)
    close(by_q, dh_dq[:3] / mass)
    close(by_v, dF_da[:3] / mass)


def test_no_joints() -> None:
    from ulna.model import ModelBuilder

    model = ModelBuilder("rock").add_link("rock").build()
    nothing = np.zeros(0)
    for f in (inverse_dynamics_derivatives, forward_dynamics_derivatives):
        assert [x.shape for x in f(model, nothing, nothing, nothing)] == [(0, 0)] * 3
    assert [x.shape for x in centroidal_derivatives(model, nothing, nothing, nothing)] == [(6, 0)] * 4
    assert [x.shape for x in com_velocity_derivatives(model, nothing, nothing)] == [(3, 0)] * 2
