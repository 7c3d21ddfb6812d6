"""Derivatives through loops: equal to those of the loop written out, in every mode and layout."""

from __future__ import annotations

import numpy as np
import pytest

import ulna
from ulna import numeric as nm
from ulna.compiler import compile, trace
from ulna.errors import TraceError

STEPS = 12


def looped(x, a):
    """A damped pendulum; the length of the step is captured."""

    def body(i, q, v):
        v = v - a * (np.sin(q) + 0.1 * v)
        return i + 1.0, q + a * v, v

    _, q, v = nm.loop(lambda i, q, v: i < STEPS, body, (0.0, x[0], x[1]), STEPS)
    return q * q + v


def written_out(x, a):
    q, v = x
    for _ in range(STEPS):
        v = v - a * (np.sin(q) + 0.1 * v)
        q = q + a * v
    return q * q + v


def power(x, n):
    """x**(n + 1): lanes iterate differently often."""
    return nm.loop(lambda i, y: i < n, lambda i, y: (i + 1.0, y * x[0]), (0.0, x[0]), 40)[1] + x[1]


def of(result):
    return [np.asarray(r) for r in (result if isinstance(result, tuple) else (result,))]


DERIVATIVES = {
    "value_and_gradient": lambda rng, n: [],
    "hessian": lambda rng, n: [],
    "hvp": lambda rng, n: [rng.normal(size=(n, 2))],
    "jvp": lambda rng, n: [rng.normal(size=(n, 2)), rng.normal(size=n)],
    "vjp": lambda rng, n: [rng.normal(size=n)],
}


@pytest.mark.parametrize("name", DERIVATIVES)
def test_every_derivative_equals_that_of_the_loop_written_out(name):
    loop, plain = (trace(f, x=(2,), a=()) for f in (looped, written_out))
    rng = np.random.default_rng(0)
    x, a, rest = rng.normal(size=(11, 2)), rng.uniform(0.05, 0.3, size=11), DERIVATIVES[name](rng, 11)
    expected = of(getattr(plain, name)()(x, a, *rest))
    derived = getattr(loop, name)()
    kernel = compile(derived)
    for got in (of(derived(x, a, *rest)), of(kernel(x, a, *rest))):
        for g, e in zip(got, expected, strict=True):
            np.testing.assert_allclose(g, e, rtol=1e-12, atol=1e-13)
    for k in range(2):
        single = of(kernel(x[k], a[k], *(r[k] for r in rest)))
        for g, e in zip(single, expected, strict=True):
            np.testing.assert_allclose(g, e[k], rtol=1e-12, atol=1e-13)


def test_lanes_that_stop_at_different_times():
    f = trace(power, x=(2,), n=())
    n, x = np.array([0, 3, 1, 7, 2, 0, 5, 9, 4, 11, 6.0]), np.linspace(0.5, 1.5, 11)
    points = np.stack([x, x], axis=-1)
    derivative, second = (n + 1) * x**n, (n + 1) * n * x ** np.maximum(n - 1, 0)
    for g, h in ((f.jacobian(), f.hessian()), (compile(f.jacobian()), compile(f.hessian()))):
        np.testing.assert_allclose(g(points, n), np.stack([derivative, np.ones(11)], axis=-1), rtol=1e-14)
        np.testing.assert_allclose(h(points, n)[:, 0, 0], second, rtol=1e-13)
    assert compile(f.jacobian())([2.0, 0.0], 3.0).tolist() == [32.0, 1.0]
    rate = compile(f.jvp())
    np.testing.assert_allclose(rate(points, n, np.ones((11, 2)), np.zeros(11)), derivative + 1.0, rtol=1e-14)


def test_what_a_lane_would_compute_after_its_end_does_no_harm():
    """The body is outside of its domain one iteration later: nan there must not reach the derivative."""
    f = trace(
        lambda x: nm.loop(lambda v: v > 1.0, lambda v: (np.sqrt(v - 1.0) * x[0],), (x[1],), 9)[0], x=(2,)
    )
    x = np.array([[1.0, 3.0], [2.0, 1.5], [1.0, 0.5], [1.5, 20.0]])
    got = compile(f.vjp())(x, 1.0)
    h = 1e-6 * np.eye(2)
    expected = np.stack([(f(x + e) - f(x - e)) / 2e-6 for e in h], axis=-1)
    np.testing.assert_allclose(got, expected, rtol=1e-6, atol=1e-7)


def test_a_loop_in_a_loop():
    def f(x):
        def outer(i, total):
            def inner(j, s):
                return j + 1.0, np.sin(s) + x[1] * i

            _, s = nm.loop(lambda j, s: j <= i, inner, (0.0, total * x[0]), 9)
            return i + 1.0, total + s

        return nm.loop(lambda i, total: i < 4.0, outer, (0.0, x[1]), 9)[1]

    def plain(x):
        total = x[1]
        for i in range(4):
            s = total * x[0]
            for _ in range(i + 1):
                s = np.sin(s) + x[1] * i
            total = total + s
        return total

    loop, expected = trace(f, x=(2,)), trace(plain, x=(2,))
    x = np.random.default_rng(1).normal(size=(9, 2))
    for name in ("jacobian", "hessian"):
        derived = getattr(loop, name)()
        for got in (derived(x), compile(derived)(x)):
            np.testing.assert_allclose(got, getattr(expected, name)()(x), rtol=1e-12, atol=1e-12)
    tangent = loop.jvp()
    for got in (tangent(x, x), compile(tangent)(x, x)):
        np.testing.assert_allclose(got, expected.jvp()(x, x), rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("limit", [1100, 1_100_000])
def test_long_loops_keep_few_states(limit):
    """The logistic map: 2,200 numbers and more do not fit in a record, so loops of loops are recorded."""

    def f(x, n):
        return nm.loop(lambda i, y: i < n, lambda i, y: (i + 1.0, x * y * (1.0 - y)), (0.0, 0.3), limit)[1]

    kernel = compile(trace(f, x=(), n=()).value_and_gradient())
    x, y, slope = 2.8, 0.3, 0.0
    for _ in range(1090):
        y, slope = x * y * (1.0 - y), y * (1.0 - y) + x * (1.0 - 2.0 * y) * slope
    np.testing.assert_allclose(kernel(x, 1090.0), (y, slope), rtol=1e-12)
    assert kernel(x, 0.0) == (0.3, 0.0)
    assert kernel([x, 2.5], [1090.0, 1.0])[1].tolist() == pytest.approx([slope, 0.21])


@pytest.mark.parametrize("limit", [1000, 1364, 1365, 1366, 2047, 2049, 5000])
def test_second_derivatives_of_long_loops(limit):
    """Cotangents have more numbers than the state: their record must fit, too."""

    def f(x):
        return nm.loop(
            lambda y, n: n < 50.0, lambda y, n: (x[0] * np.sin(y) + x[1], n + 1.0), (x[0], 0.0), limit
        )[0]

    def plain(x):
        y = x[0]
        for _ in range(50):
            y = x[0] * np.sin(y) + x[1]
        return y

    x = np.array([0.7, 0.3])
    expected = trace(plain, x=(2,)).hessian()(x)
    np.testing.assert_allclose(trace(f, x=(2,)).hessian()(x), expected, rtol=1e-10, atol=1e-12)


def test_the_limit_ends_a_long_loop_exactly():
    f = trace(lambda x: nm.loop(lambda y: True, lambda y: (y + x,), (x,), 2503)[0], x=())
    assert compile(f.value_and_gradient())(1.0) == (2504.0, 2504.0)
    assert f.jvp()(1.0, 1.0) == 2504.0


def test_two_loops_and_a_state_that_does_not_depend():
    def f(x):
        a, _ = nm.loop(lambda a, k: k < 5.0, lambda a, k: (a * x[0] + k, k + 1.0), (x[1], 0.0), 9)
        b, _ = nm.loop(lambda b, k: k < 3.0, lambda b, k: (b * a - b, k + 1.0), (1.0, 0.0), 9)
        return np.array([a * b, b])

    def plain(x):
        a, b = x[1], 1.0
        for k in range(5):
            a = a * x[0] + k
        for _ in range(3):
            b = b * a - b
        return np.array([a * b, b])

    loop, expected = trace(f, x=(2,)), trace(plain, x=(2,))
    x = np.array([0.4, -0.7])
    for name in ("jacobian", "hessian"):
        np.testing.assert_allclose(
            compile(getattr(loop, name)())(x), getattr(expected, name)()(x), rtol=1e-12, atol=1e-12
        )
    back = compile(loop.vjp())(x, [0.3, 0.8])
    np.testing.assert_allclose(back, expected.vjp()(x, [0.3, 0.8]), rtol=1e-12)


def test_conditions_around_and_in_a_loop():
    def f(x):
        high = x[0] > 0.5
        y = nm.loop(
            lambda i, y: i < 3.0, lambda i, y: (i + 1.0, nm.where(high, y * y, y + x[1])), (0.0, x[0]), 5
        )[1]
        return nm.where(x[1] > 0.0, y, np.sqrt(x[1]))

    gradient = compile(trace(f, x=(2,)).jacobian())
    np.testing.assert_allclose(gradient([0.9, 1.0]), [8 * 0.9**7, 0.0], rtol=1e-14)
    np.testing.assert_allclose(gradient([0.25, 1.0]), [1.0, 3.0], rtol=1e-14)


def test_derivatives_of_a_function_that_is_itself_one():
    f = trace(looped, x=(2,), a=())
    again = compile(f.vjp().jvp())  # forward over reverse, by hand
    x, d = np.array([0.4, -0.3]), np.array([1.0, 0.5])
    expected = f.hvp()(x, 0.2, d)
    np.testing.assert_allclose(again(x, 0.2, 1.0, d, 0.0, 0.0)[0], expected, rtol=1e-12)
    np.testing.assert_allclose(f.jacobian().jacobian()(x, 0.2), f.hessian()(x, 0.2), rtol=1e-12)
    with pytest.raises(TraceError, match="Take the second derivative forward: hessian, hvp, or jvp of vjp"):
        f.vjp().vjp()


def test_a_rollout_of_a_robot():
    robot = ulna.load("panda")
    speed, goal = np.linspace(0.1, 0.7, 7), np.array([0.4, 0.2, 0.3])

    def miss(q, v):
        end = nm.loop(
            lambda i, *q: i < 20.0, lambda i, *q: (i + 1.0, *(np.array(q) + 0.05 * v)), (0.0, *q), 20
        )
        p = robot.fk(np.array(end[1:]))[:3, 3]
        return (p - goal) @ (p - goal)

    kernel = ulna.compile(miss, robot)
    q, h = robot.configurations["ready"], 1e-6 * np.eye(7)
    differences = (kernel(q, speed + h) - kernel(q, speed - h)) / 2e-6
    np.testing.assert_allclose(kernel.jacobian("v")(q, speed), differences, rtol=1e-6, atol=1e-8)


def test_loops_without_a_useful_limit_are_refused_with_what_to_do():
    f = trace(lambda x: nm.loop(lambda v: v < 9.0, lambda v: (v * x,), (x,), 2**50)[0], x=())
    for derive in (f.jacobian, f.jvp, f.vjp):
        with pytest.raises(
            TraceError, match=r"1125899906842624 iterations.*smallest `limit`.*implicit function theorem"
        ):
            derive()


def test_records_belong_to_what_a_function_is():
    f = trace(looped, x=(2,), a=())
    names = {g.fingerprint for g in (f, f.jvp(), f.vjp(), f.jacobian())}
    assert len(names) == 4
    import pickle

    assert pickle.loads(pickle.dumps(f.vjp())).fingerprint == f.vjp().fingerprint
    assert f.vjp().draw().startswith("<svg")


def _recurring(x):
    _, y = nm.loop(lambda k, y: k < 4.0, lambda k, y: (k + 1.0, 1.0 / (1.0 + y * y)), (0.0, x[0]), limit=10)
    return y


def _two_states(x):
    def following(y, z, k):
        return 1.0 / (1.0 + z + y * y), z + y * y, k + 1.0

    y, z, _ = nm.loop(lambda y, z, k: k < 4.0, following, (x[0], 0.5 * x[0], 0.0), limit=10)
    return y + z


def _captured(x):
    y, _ = nm.loop(lambda y, k: k < 4.0, lambda y, k: (x[0] / (1.0 + y * y), k + 1.0), (x[0], 0.0), limit=10)
    return y


@pytest.mark.parametrize("f", [_recurring, _two_states, _captured])
def test_third_and_fourth_derivatives_of_loops_whose_cotangents_read_kept_values(f):
    kernel, x, h = compile(f, x=(1,)), np.array([0.7]), 1e-4
    hessian = kernel.hessian()
    third = hessian.jacobian()
    difference = (np.ravel(hessian(x + h)) - np.ravel(hessian(x - h))) / (2.0 * h)
    np.testing.assert_allclose(np.ravel(third(x)), difference, rtol=1e-6)
    np.testing.assert_allclose(
        np.ravel(third(x)), np.ravel(kernel.jacobian().jacobian().jacobian()(x)), rtol=1e-12
    )
    fourth = np.ravel(third.jacobian()(x))
    difference = (np.ravel(third(x + h)) - np.ravel(third(x - h))) / (2.0 * h)
    np.testing.assert_allclose(fourth, difference, rtol=1e-5)


def _twice(f):
    return lambda x: nm.loop(lambda i, y: i < 2.0, lambda i, y: (i + 1.0, f(y)), (0.0, x), 3)[1]


def _two_states(x):
    def body(i, a, b):
        return i + 1.0, np.log(a), np.sqrt(b) + a

    _, a, b = nm.loop(lambda i, a, b: i < 2.0, body, (0.0, x, x - 2.0), 3)
    return nm.where(x > 1.5, a, x * x) + nm.where(x > 4.0, b, 2.0 * x)


BESIDE_A_WHERE = {
    "the side that is not taken": (lambda x: nm.where(x > 1.5, _twice(np.log)(x), x * x), (-1.0, 0.0, 2.0)),
    "different conditions for two states": (_two_states, (-1.0, 2.0, 7.0)),
    "a state that nothing depends on": (
        lambda x: nm.loop(
            lambda i, y, z: i < 2.0, lambda i, y, z: (i + 1.0, y * y, np.log(y)), (0.0, x, x), 3
        )[1],
        (0.0, 1.5, 0.0),
    ),
    "a captured value": (
        lambda x: nm.where(x > 0.0, _twice(lambda y: y + np.sqrt(x))(x), 3.0 * x * x),
        (-1.0, 0.0, 2.0),
    ),
    "a loop in a loop": (
        lambda x: nm.where(x > 1.5, _twice(lambda y: _twice(np.sqrt)(y) + np.log(x))(x), x * x),
        (-1.0, 0.0, 2.0),
    ),
}


@pytest.mark.parametrize("case", BESIDE_A_WHERE)
def test_cotangents_that_do_not_count_never_become_nan(case):
    """The sweep back multiplied their zeros by partials that are infinite or nan there."""
    f, points = BESIDE_A_WHERE[case]
    f, x = trace(f, x=()), np.array(points)
    slope, tangent = f.vjp(), f.jvp()
    np.testing.assert_allclose(slope(x, 1.0), tangent(x, 1.0), rtol=1e-14)
    np.testing.assert_array_equal(np.isnan(slope(x, 1.0)), np.zeros(3, dtype=bool))
    kernel = compile(f.value_and_gradient())
    for got in (kernel(x), tuple(zip(*(kernel(number) for number in x), strict=True))):
        np.testing.assert_allclose(got[0], f(x), rtol=1e-14)
        np.testing.assert_allclose(got[1], tangent(x, 1.0), rtol=1e-14)
    h = 1e-5
    second = (tangent(x + h, 1.0) - tangent(x - h, 1.0)) / (2.0 * h)
    smooth = np.isfinite(second) & (np.abs(second) < 1e3)
    assert smooth.sum() >= 2
    np.testing.assert_allclose(compile(f.hvp())(x, 1.0)[smooth], second[smooth], rtol=1e-6, atol=1e-6)


def test_a_loop_without_iterations_has_the_derivatives_of_its_start():
    f = trace(lambda x: nm.loop(lambda y: y > 0.0, lambda y: (np.sin(y),), (x[0] * x[1],), 0)[0], x=(2,))
    x = np.array([[2.0, 3.0], [-1.0, 0.5]])
    np.testing.assert_array_equal(compile(f)(x), x[:, 0] * x[:, 1])
    for name in ("jacobian", "value_and_gradient"):
        np.testing.assert_array_equal(of(compile(getattr(f, name)())(x))[-1], x[:, ::-1])
    np.testing.assert_array_equal(compile(f.hessian())(x[0]), [[0.0, 1.0], [1.0, 0.0]])
