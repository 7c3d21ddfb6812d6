"""Derivatives of a chain's pose of any order: those of the Jacobian, the Hessian and each other, by differences and by symbols."""

from __future__ import annotations

import numpy as np
import pytest

from ulna.algorithms import jacobian_partials
from ulna.errors import InputError
from ulna.formats.ets import ET, ETS
from ulna.robot import Robot


def _arm() -> Robot:
    """Turns about all axes, with a slide between them."""
    parts = (
        ET.rz(), ET.tx(0.3), ET.rx(0.4), ET.ry(), ET.tz(0.5), ET.tx(limits=(0.0, 1.0)), ET.ty(0.2), ET.rx(flip=True),
        ET.tz(0.1),
    )  # fmt: skip
    return Robot(ETS(parts).model("arm"))


def test_first_and_second_order_are_jacobian_and_hessian() -> None:
    arm, q = _arm(), np.array([0.3, -0.7, 0.4, 1.1])
    J = arm.jacobian(q)
    np.testing.assert_array_equal(jacobian_partials(J, 1), J)
    np.testing.assert_allclose(jacobian_partials(J, 2), arm.hessian(q), atol=1e-15)


@pytest.mark.parametrize("order", [3, 4, 5])
def test_each_order_is_the_derivative_of_the_one_below(order: int) -> None:
    arm, q, h = _arm(), np.array([0.3, -0.7, 0.4, 1.1]), 1e-5

    def below(at: np.ndarray) -> np.ndarray:
        return jacobian_partials(arm.jacobian(at), order - 1)

    differences = np.stack([(below(q + h * e) - below(q - h * e)) / (2.0 * h) for e in np.eye(4)])
    found = jacobian_partials(arm.jacobian(q), order)
    assert found.shape == (4,) * (order - 1) + (6, 4)
    np.testing.assert_allclose(found, differences, atol=1e-9)


def test_third_order_by_symbols() -> None:
    sympy = pytest.importorskip("sympy")
    a, b = sympy.symbols("a b")
    x, y = sympy.cos(a) + 2 * sympy.cos(a + b), sympy.sin(a) + 2 * sympy.sin(a + b)
    at = {a: sympy.Rational(3, 10), b: sympy.Rational(-7, 10)}
    arm = Robot(ETS((ET.rz(), ET.tx(1.0), ET.rz(), ET.tx(2.0))).model("arm"))
    found = jacobian_partials(arm.jacobian([0.3, -0.7]), 3)
    for index in np.ndindex(2, 2, 2):
        by = [(a, b)[i] for i in index]
        wanted = [float(sympy.diff(p, *by).subs(at)) for p in (x, y)]
        np.testing.assert_allclose(found[index[0], index[1], :2, index[2]], wanted, atol=1e-14)
    np.testing.assert_array_equal(found[..., 2:, :], 0.0)  # the plane stays the plane


@pytest.mark.parametrize("order", [0, -1, 2.5])
def test_refuses_what_is_no_order(order: float) -> None:
    with pytest.raises(InputError, match="order"):
        jacobian_partials(np.zeros((6, 2)), order)  # type: ignore[arg-type]
