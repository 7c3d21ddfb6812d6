"""Gradients with values, Hessians, and products with them: against mpmath, differences, and each other."""

from __future__ import annotations

import numpy as np
import pytest

import ulna
from ulna import linalg, numeric
from ulna.compiler import compile, trace
from ulna.errors import InputError, ShapeError, UnknownName


def bent(x, y):
    """A number from most smooth operations."""
    r = np.sqrt(x @ x + 1.0)
    s = np.sin(x[0] * y) / r + np.arctan2(x[1], r) * np.exp(-x[2])
    return s * s + np.log(r) * x[1] + numeric.where(x[0] > y, x[2] ** 3, np.cos(x[2]) * x[0])


def test_hessian_gradient_and_products_against_mpmath():
    mpmath = pytest.importorskip("mpmath")
    m = mpmath.mp

    def plain(a, b, c):
        y = m.mpf("0.25")
        r = m.sqrt(a * a + b * b + c * c + 1)
        s = m.sin(a * y) / r + m.atan2(b, r) * m.exp(-c)
        return s * s + m.log(r) * b + (c**3 if a > y else m.cos(c) * a)

    kernel = compile(bent, x=(3,), y=())
    rng = np.random.default_rng(0)
    for x in rng.normal(size=(4, 3)):
        with mpmath.workdps(50):
            orders = np.eye(3, dtype=int)
            point = [m.mpf(float(v)) for v in x]
            gradient = [float(m.diff(plain, point, tuple(map(int, o)))) for o in orders]
            hessian = [[float(m.diff(plain, point, tuple(map(int, a + b)))) for a in orders] for b in orders]
        value, slope = kernel.value_and_gradient("x")(x, 0.25)
        assert value == kernel(x, 0.25)
        np.testing.assert_allclose(slope, gradient, rtol=1e-13, atol=1e-14)
        H = kernel.hessian("x")(x, 0.25)
        np.testing.assert_array_equal(H, H.T)
        np.testing.assert_allclose(H, hessian, rtol=1e-12, atol=1e-13)
        d = rng.normal(size=3)
        np.testing.assert_allclose(kernel.hvp("x")(x, 0.25, d), np.dot(hessian, d), rtol=1e-12, atol=1e-13)


def test_hessians_of_several_outputs_have_a_block_for_each():
    f = trace(lambda q, v: (np.array([q[0] * q[1] * v, np.sin(q[1])]), q[0] ** 3), q=(2,), v=())
    vector, number = f.hessian("q")([0.5, 0.25], 2.0)
    np.testing.assert_allclose(vector, [[[0, 2], [2, 0]], [[0, 0], [0, -np.sin(0.25)]]], rtol=1e-15)
    np.testing.assert_allclose(number, [[3.0, 0], [0, 0]], rtol=1e-15)
    assert [(p.name, p.shape) for p in f.hessian().outputs] == [
        ("d2out0_dq2", (2, 2, 2)),
        ("d2out1_dq2", (2, 2)),
    ]
    square = trace(lambda m: (m @ m)[0, 1], m=(2, 2)).hessian()
    assert square.outputs[0].shape == (2, 2, 2, 2)
    assert square(np.ones((2, 2)))[0, 0, 0, 1] == 1.0


def test_kernels_pass_on_their_type_and_whether_they_check():
    kernel = ulna.compile(lambda x, d_x: (x**3).sum() * d_x, dtype=np.float32, checked=True, x=(3,), d_x=())
    x, d = np.array([1, 2, 3], np.float32), np.ones(3, np.float32)
    product = kernel.hvp("x")
    assert [p.name for p in product.function.inputs] == ["x", "d_x", "d_d_x"]
    assert product(x, 2.0, d).dtype == np.float32
    np.testing.assert_allclose(product(x, 2.0, d), 12 * x)
    with pytest.raises(ulna.errors.NonFiniteError):
        product(x, np.nan, d)
    np.testing.assert_allclose(kernel.vjp()(x, 2.0, 1.0)[0], 6 * x**2)
    np.testing.assert_allclose(kernel.jvp()(x, 2.0, d, 0.0), (6 * x**2).sum())


def test_what_is_no_number_has_no_gradient():
    vector = compile(lambda x: x * x, x=(3,))
    pair = trace(lambda x: (x[0], x[1]), x=(3,))
    with pytest.raises(
        ShapeError, match=r"has shape \(3,\); expected \(\)\. A gradient is that of a single number"
    ):
        vector.value_and_gradient()
    with pytest.raises(ShapeError, match="product with the Hessian is that of a single number"):
        vector.hvp()
    with pytest.raises(InputError, match=r"returns 2 outputs; expected one\. A product with the Hessian"):
        pair.hvp()
    with pytest.raises(UnknownName, match="No input named 'y'"):
        vector.hessian("y")


@pytest.fixture(scope="module")
def costs():
    robot = ulna.load("panda")
    goal = np.array([0.4, 0.2, 0.3])

    def manipulability(q):
        J = robot.jacobian(q)
        return numeric.sqrt(linalg.determinant(J @ J.T))

    def path(x):
        steps = x[1:] - x[:-1]
        return (
            sum((robot.fk(q)[:3, 3] - goal) @ (robot.fk(q)[:3, 3] - goal) for q in x) + (steps * steps).sum()
        )

    def torques(q, v, a):
        tau = robot.inverse_dynamics(q, v, a)
        return tau @ tau

    def distance(q):
        d = robot.fk(q)[:3, 3] - goal
        return numeric.sqrt(d @ d)

    def energy(q, v):
        return robot.kinetic_energy(q, v)

    kernels = [ulna.compile(f, robot) for f in (manipulability, torques, distance, energy)]
    return robot, [*kernels, ulna.compile(path, robot, x=(20, 7))]


def test_a_gradient_takes_at_most_three_times_the_operations(costs):
    """The cheap gradient [Griewank & Walther 2008, section 3.3]; products with the Hessian at most nine times."""
    for kernel in costs[1]:
        both, product = kernel.function.value_and_gradient(), kernel.function.hvp()
        assert both.operations <= 3.05 * kernel.operations, kernel
        assert product.operations <= 9.0 * kernel.operations, kernel


def test_derivatives_of_robots_against_differences(costs):
    robot, kernels = costs
    rng, h = np.random.default_rng(3), 1e-5
    for f in (kernel.function for kernel in kernels[:-1]):  # interpreted, which takes no compilation
        q = robot.random_configuration(seed=4)
        rest = [rng.normal(size=p.shape) for p in f.inputs[1:]]
        steps = h * np.eye(robot.nq)
        gradient, H = f.jacobian(), f.hessian()(q, *rest)
        differences = (gradient(q + steps, *rest) - gradient(q - steps, *rest)) / (2 * h)
        np.testing.assert_allclose(H, differences, rtol=1e-6, atol=1e-6 * abs(H).max())
        d = rng.normal(size=robot.nv)
        np.testing.assert_allclose(f.hvp()(q, *rest, d), H @ d, rtol=1e-9, atol=1e-10 * abs(H).max())
        np.testing.assert_allclose(f.value_and_gradient()(q, *rest)[1], gradient(q, *rest), rtol=1e-12)
