"""What the algorithms refuse, and what they say."""

from __future__ import annotations

import numpy as np
import pytest

from ulna import algorithms as alg
from ulna.compiler import trace
from ulna.errors import InputError, TraceError, UnknownName
from ulna.model import Model, ModelBuilder, Revolute


@pytest.fixture(scope="module")
def arm() -> Model:
    builder = ModelBuilder("arm").add_link("a").add_link("b")
    return builder.add_joint("j", Revolute((0, 0, 1)), "a", "b").build()


def test_an_unknown_reference_names_the_nearest(arm: Model) -> None:
    q, b = np.zeros(1), arm.frame("b")
    for f in (
        lambda r: alg.frame_jacobian(arm, q, b, r),
        lambda r: alg.frame_jacobian_dot(arm, q, q, b, r),
        lambda r: alg.frame_hessian(arm, q, b, r),
        lambda r: alg.frame_velocity(arm, q, q, b, r),
        lambda r: alg.frame_acceleration(arm, q, q, q, b, r),
    ):
        with pytest.raises(UnknownName, match="'local_world_aligned'"):
            f("local_world_alligned")


def test_an_unknown_representation_names_the_nearest(arm: Model) -> None:
    for f in (alg.analytical_jacobian, lambda m, q, b, r: alg.analytical_jacobian_dot(m, q, q, b, r)):
        with pytest.raises(UnknownName, match="'rpy/xyz'"):
            f(arm, np.zeros(1), arm.frame("b"), "rpy/xzy")


def test_unknown_measures_and_axes(arm: Model) -> None:
    q, b = np.zeros(1), arm.frame("b")
    with pytest.raises(UnknownName, match="'yoshikawa'"):
        alg.manipulability(arm, q, b, "yosikawa")
    with pytest.raises(UnknownName, match="'trans'"):
        alg.manipulability(arm, q, b, axes="trams")
    for axes in ((True, False), (False,) * 6):
        with pytest.raises(InputError, match="six truth values"):
            alg.manipulability_gradient(arm, q, b, axes)


def test_singular_values_cannot_be_traced(arm: Model) -> None:
    with pytest.raises(TraceError, match=r"np\.linalg\.svd"):
        trace(lambda q: alg.manipulability(arm, q, arm.frame("b"), "inverse_condition"), q=(1,))
