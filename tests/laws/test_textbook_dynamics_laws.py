"""The recursions as in the book equal those with fewer operations that are compiled, on random trees."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from support.random_models import KINDS, random_model
from ulna import algorithms as alg
from ulna.algorithms.dynamics.centroidal_recursion import (
    momentum_about_com,
    momentum_matrix_about_com,
    momentum_rate_about_com,
)
from ulna.compiler import trace
from ulna.model import Model
from ulna.spatial import Force
from ulna.typing import Floats

ROOTS = (None, "free_flyer", "planar", "spherical")


class State(NamedTuple):
    """A robot, a batch of two states, and forces on half of its bodies."""

    model: Model
    q: Floats
    v: Floats
    a: Floats
    external: list[Force | None]


@st.composite
def states(draw: st.DrawFn, mimics: int = 2) -> State:
    """Trees of joints of all kinds, still or on a moving root, with and without mimic joints."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    kinds = draw(st.lists(st.sampled_from(sorted(KINDS)), min_size=1, max_size=5))
    root = draw(st.sampled_from(ROOTS))
    model = random_model(rng, kinds, root=root, mimics=draw(st.integers(0, mimics)))
    q = alg.random(model, rng, (2,))
    v, a = rng.standard_normal((2, 2, model.nv))
    external = [Force(*rng.standard_normal((2, 2, 3))) if i % 2 else None for i in range(len(model.joints))]
    return State(model, q, v, a, external)


def close(actual: Floats, expected: Floats, tolerance: float = 1e-12) -> None:
    scale = max(1.0, float(np.abs(expected).max(initial=0.0)))
    np.testing.assert_allclose(actual, expected, rtol=0.0, atol=tolerance * scale)


@settings(max_examples=15, deadline=None, derandomize=True)
@given(states())
def test_inverse_dynamics_is_table_5_1(s: State) -> None:
    close(
        alg.inverse_dynamics(s.model, s.q, s.v, s.a, s.external), alg.rnea(s.model, s.q, s.v, s.a, s.external)
    )


@settings(max_examples=15, deadline=None, derandomize=True)
@given(states())
def test_the_mass_matrix_is_table_6_2(s: State) -> None:
    close(alg.mass_matrix(s.model, s.q), alg.crba(s.model, s.q))


@settings(max_examples=15, deadline=None, derandomize=True)
@given(states(mimics=0))
def test_forward_dynamics_is_table_7_1(s: State) -> None:
    """To 1e-12, or to the rounding of a solution with the mass matrix where that is larger."""
    expected = alg.aba(s.model, s.q, s.v, s.a, s.external)
    tolerance = max(1e-12, 1e-15 * float(np.linalg.cond(alg.crba(s.model, s.q)).max()))
    for f in (alg.forward_dynamics, alg.articulated_body_dynamics, alg.by_mass_matrix):
        close(f(s.model, s.q, s.v, s.a, s.external), expected, tolerance)


@settings(max_examples=3, deadline=None, derandomize=True)
@given(states())
def test_derivatives_of_inverse_dynamics_are_the_differentiated_recursion(s: State) -> None:
    found = alg.inverse_dynamics_derivatives(s.model, s.q, s.v, s.a, s.external)
    for actual, expected in zip(found, alg.rnea_derivatives(s.model, s.q, s.v, s.a, s.external), strict=True):
        close(actual, expected)


@settings(max_examples=3, deadline=None, derandomize=True)
@given(states(mimics=0))
def test_derivatives_of_forward_dynamics_are_those_of_its_inverse(s: State) -> None:
    """To 1e-12, or to the rounding of two solutions with the mass matrix where that is larger."""
    tolerance = max(1e-12, 1e-14 * float(np.linalg.cond(alg.crba(s.model, s.q)).max()))
    found = alg.forward_dynamics_derivatives(s.model, s.q, s.v, s.a, s.external)
    for actual, expected in zip(found, alg.aba_derivatives(s.model, s.q, s.v, s.a, s.external), strict=True):
        close(actual, expected, tolerance)


@settings(max_examples=15, deadline=None, derandomize=True)
@given(states())
def test_centroidal_dynamics_is_the_sum_over_bodies(s: State) -> None:
    m, q, v, a = s.model, s.q, s.v, s.a
    close(alg.centroidal_momentum(m, q, v), momentum_about_com(m, q, v))
    close(alg.centroidal_momentum_rate(m, q, v, a), momentum_rate_about_com(m, q, v, a))
    close(alg.centroidal_matrix(m, q), momentum_matrix_about_com(m, q))


@pytest.mark.parametrize("name", ["rnea", "crba", "aba"])
def test_the_recursions_of_the_book_can_be_traced(name: str) -> None:
    """They are generic in the scalar, like everything else, and cost more operations than what is compiled."""
    model = random_model(np.random.default_rng(1), ["revolute", "spherical", "prismatic"], mimics=0)
    rng = np.random.default_rng(2)
    q, *rest = alg.random(model, rng), *rng.standard_normal((2, model.nv))
    arrays = (q,) if name == "crba" else (q, *rest)
    efficient = {"rnea": alg.inverse_dynamics, "crba": alg.mass_matrix, "aba": alg.articulated_body_dynamics}[
        name
    ]
    shapes: dict[str, Any] = {key: x.shape for key, x in zip("qva", arrays, strict=False)}
    book, fewer = (
        trace(lambda *x, f=f: f(model, *x), name="f", **shapes) for f in (getattr(alg, name), efficient)
    )
    close(book(*arrays), getattr(alg, name)(model, *arrays))
    assert fewer.operations < book.operations
