"""Derivatives, forward and reverse, of every operation, against mpmath's numerical ones with 50 digits."""

from __future__ import annotations

import numpy as np
import pytest

from ulna import numeric as nm
from ulna.compiler import Function, compile, trace
from ulna.compiler.language.ops import TABLE, Op
from ulna.errors import UnknownName

mpmath = pytest.importorskip("mpmath")
ONE = {
    Op.NEG: (lambda x: -x, lambda x: -x),
    Op.ABS: (abs, abs),
    Op.SQRT: (np.sqrt, mpmath.sqrt),
    Op.SIN: (np.sin, mpmath.sin),
    Op.COS: (np.cos, mpmath.cos),
    Op.TAN: (np.tan, mpmath.tan),
    Op.ASIN: (lambda x: np.arcsin(x * 0.25), lambda x: mpmath.asin(x * 0.25)),
    Op.ACOS: (lambda x: np.arccos(x * 0.25), lambda x: mpmath.acos(x * 0.25)),
    Op.EXP: (np.exp, mpmath.exp),
    Op.LOG: (np.log, mpmath.log),
    Op.EXPM1: (np.expm1, mpmath.expm1),
    Op.SINH: (np.sinh, mpmath.sinh),
    Op.LOG1P: (lambda x: np.log1p(x * 0.25), lambda x: mpmath.log1p(x * 0.25)),
    Op.ERF: (nm.erf, mpmath.erf),
    Op.FLOOR: (lambda x: np.floor(x) * x, lambda x: mpmath.floor(x) * x),
}
TWO = {
    Op.ADD: (lambda x, y: x + y, lambda x, y: x + y),
    Op.SUB: (lambda x, y: x - y, lambda x, y: x - y),
    Op.MUL: (lambda x, y: x * y, lambda x, y: x * y),
    Op.DIV: (lambda x, y: x / y, lambda x, y: x / y),
    Op.MIN: (nm.minimum, lambda x, y: min(x, y)),
    Op.MAX: (nm.maximum, lambda x, y: max(x, y)),
    Op.ATAN2: (np.arctan2, mpmath.atan2),
    Op.SELECT: (
        lambda x, y: nm.where((x < y) & ~(x * y < 0.0), x * x * y, y * y - x),
        lambda x, y: x * x * y if x < y and x * y >= 0 else y * y - x,
    ),
    Op.LT: (lambda x, y: nm.where(x < y, x, 0.0) * y, lambda x, y: (x if x < y else 0) * y),
    Op.EQ: (lambda x, y: nm.where(x == y, x, x * y), lambda x, y: x if x == y else x * y),
}
POINTS_1 = (-3.3, -1.25, -0.4, 0.3, 0.7, 1.9, 3.6)
POINTS_2 = ((0.3, 0.7), (-0.8, 1.9), (2.2, -1.1), (-2.5, -0.3), (3.0, 1.5))


def along(f, point, direction) -> float:
    """The derivative of an mpmath function along a direction."""
    with mpmath.workdps(50):
        start = [mpmath.mpf(p) for p in point]
        return float(mpmath.diff(lambda t: f(*(s + t * d for s, d in zip(start, direction, strict=True))), 0))


def both_ways(f: Function, *point: float) -> tuple[np.ndarray, np.ndarray]:
    """The gradient of a function of numbers by a forward and by a reverse sweep, compiled."""
    forward, reverse = compile(f.jvp()), compile(f.vjp())
    eye = np.eye(len(point))
    one = np.array([forward(*point, *row) for row in eye])
    return one, np.atleast_1d(reverse(*point, 1.0))


@pytest.mark.parametrize("op", ONE, ids=lambda op: op.name)
def test_operations_of_one_argument(op):
    f, exact = ONE[op]
    function = trace(lambda x: f(x), x=())
    for x in POINTS_1:
        if op in (Op.SQRT, Op.LOG) and x < 0:
            continue
        expected = along(exact, [x], [1])
        for got in both_ways(function, x):
            np.testing.assert_allclose(got, [expected], rtol=4e-15, atol=1e-15, err_msg=f"{op.name} at {x}")


@pytest.mark.parametrize("op", TWO, ids=lambda op: op.name)
def test_operations_of_two_arguments(op):
    f, exact = TWO[op]
    function = trace(lambda x, y: f(x, y), x=(), y=())
    for x, y in POINTS_2:
        expected = [along(exact, [x, y], [1, 0]), along(exact, [x, y], [0, 1])]
        for got in both_ways(function, x, y):
            np.testing.assert_allclose(
                got, expected, rtol=4e-15, atol=1e-15, err_msg=f"{op.name} at {x}, {y}"
            )


def test_every_operation_with_a_derivative_is_tested():
    derived = {row.op for row in TABLE if any(p is not None for p in row.partials)}
    assert derived <= set(ONE) | set(TWO)


def busy(q, v):
    """All kinds of operations, sharing parts."""
    r = np.sqrt(q @ q + 1.0)
    s = np.sin(q * v[0]) / r
    return np.array(
        [s[0] * v[1] + np.exp(-r), nm.where(q[1] < v[0], s[1], np.arctan2(v[1], r)), q[2] ** 3]
    ), r * v


def check_jacobian(f: Function, wrt: int, *point: np.ndarray) -> None:
    """Against central differences of sixth order of the interpreted function."""
    got = f.jacobian(wrt)(*point)
    got = got if isinstance(got, tuple) else (got,)
    h, weights = 1e-2, {1: 3 / 4, 2: -3 / 20, 3: 1 / 60}
    columns = []
    for e in np.eye(point[wrt].size):
        column = None
        for k, w in weights.items():
            ends = []
            for sign in (1, -1):
                moved = list(point)
                moved[wrt] = point[wrt] + sign * k * h * e.reshape(point[wrt].shape)
                value = f(*moved)
                ends.append(value if isinstance(value, tuple) else (value,))
            part = [w * (a - b) / h for a, b in zip(*ends, strict=True)]
            column = part if column is None else [c + p for c, p in zip(column, part, strict=True)]
        columns.append(column)
    for k, g in enumerate(got):
        expected = np.stack([c[k] for c in columns], axis=-1).reshape(g.shape)
        np.testing.assert_allclose(g, expected, rtol=1e-8, atol=1e-9)


def test_jacobians_by_either_sweep():
    q, v = np.array([0.3, -0.8, 1.1]), np.array([0.9, -0.4])
    f = trace(busy, q=(3,), v=(2,))
    check_jacobian(f, 0, q, v)
    check_jacobian(f, 1, q, v)
    norm = trace(lambda q: np.sqrt(q @ q), q=(9,))  # one output, nine inputs: the reverse sweep
    check_jacobian(norm, 0, np.linspace(1, 2, 9))
    spread = trace(lambda x: np.array([np.sin(x * k) for k in range(1, 8)]), x=())  # forward
    check_jacobian(spread, 0, np.array(0.6))
    square = trace(lambda m: m @ m, m=(2, 2))
    check_jacobian(square, 0, np.arange(4.0).reshape(2, 2))


def test_shapes_and_names():
    f = trace(busy, q=(3,), v=(2,))
    j = f.jacobian("v")
    assert [(p.name, p.shape) for p in j.outputs] == [("dout0_dv", (3, 2)), ("dout1_dv", (2, 2))]
    assert [p.name for p in f.jvp().inputs] == ["q", "v", "d_q", "d_v"]
    assert [p.shape for p in f.vjp().inputs] == [(3,), (2,), (3,), (2,)]
    assert [(p.name, p.shape) for p in f.vjp().outputs] == [("bar_q", (3,)), ("bar_v", (2,))]
    assert trace(lambda x: x * x, x=()).jacobian().outputs[0].shape == ()
    twice = trace(lambda x: np.sin(x), x=()).jvp().jvp()
    assert [p.name for p in twice.inputs] == ["x", "d_x", "d_d_x", "d_d_d_x"]
    assert twice(0.5, 1.0, 1.0, 0.0) == pytest.approx(-np.sin(0.5), rel=1e-15)
    with pytest.raises(UnknownName, match="No input named 'w'"):
        f.jacobian("w")
    for wrong in (2, -1):
        with pytest.raises(UnknownName, match="No input named"):
            f.jacobian(wrong)


def test_forward_and_reverse_agree():
    f = trace(busy, q=(3,), v=(2,))
    rng = np.random.default_rng(1)
    q, v, dq, dv = (rng.normal(size=(20, n)) for n in (3, 2, 3, 2))
    out = compile(f.jvp())(q, v, dq, dv)
    bars = [rng.normal(size=o.shape) for o in out]
    back = compile(f.vjp())(q, v, *bars)
    left = sum((o * b).sum(-1) for o, b in zip(out, bars, strict=True))
    right = (back[0] * dq).sum(-1) + (back[1] * dv).sum(-1)
    np.testing.assert_allclose(left, right, rtol=1e-12)


def test_second_derivatives():
    f = trace(lambda q: np.sin(q[0]) * q[1] ** 2 + np.exp(q[0] * q[1]), q=(2,))
    hessian = compile(f.jacobian().jacobian())
    x, y = 0.4, -0.7
    e = np.exp(x * y)
    cross = 2 * np.cos(x) * y + e * (1 + x * y)
    expected = [[-np.sin(x) * y * y + y * y * e, cross], [cross, 2 * np.sin(x) + x * x * e]]
    np.testing.assert_allclose(hessian([x, y]), expected, rtol=1e-14)


def test_what_does_not_depend_has_a_derivative_of_zero_and_costs_nothing():
    f = trace(lambda q, v: (np.array([1.5, v[0], v[0] * v[1]]), v[1]), q=(2,), v=(2,))
    j = f.jacobian("q")
    assert j.operations == 0
    assert [r.tolist() for r in j([1.0, 2.0], [3.0, 4.0])] == [[[0, 0]] * 3, [0, 0]]
    assert f.jacobian("v")([1.0, 2.0], [3.0, 4.0])[0].tolist() == [[0, 0], [1, 0], [4, 3]]


def test_an_input_as_the_output_and_the_same_output_twice():
    f = trace(lambda q: (q, np.array([q[0], q[0] * 2.0])), q=(3,))
    first, second = f.jacobian()(np.zeros(3))
    assert first.tolist() == np.eye(3).tolist()
    assert second.tolist() == [[1, 0, 0], [2, 0, 0]]
    twice = trace(lambda x: (np.sin(x), np.sin(x)), x=())
    assert twice.vjp()(0.5, 1.0, 10.0) == pytest.approx(11 * np.cos(0.5), rel=1e-15)


def test_at_ties_and_corners_one_side_is_taken_and_never_both():
    for f in (nm.minimum, nm.maximum):
        function = trace(lambda x, y, f=f: f(x, y), x=(), y=())
        assert float(function.jacobian("x")(1.0, 1.0)) + float(function.jacobian("y")(1.0, 1.0)) == 1.0
    assert trace(lambda x: abs(x), x=()).jacobian()(0.0) == 1.0


def test_the_branch_that_is_not_taken_may_be_outside_its_domain():
    """sqrt(-1) is nan on the branch not taken: the derivative of the other one is not harmed."""
    f = trace(lambda x: nm.where(x > 0.0, np.sqrt(x), -x), x=())
    for got in both_ways(f, -4.0):
        np.testing.assert_array_equal(got, [-1.0])


def test_many_branches_none_of_which_harms_the_others():
    def f(x, y):
        a = nm.where(x > 0.0, np.sqrt(x) * np.log(x), np.sqrt(-x))  # nan on either side
        b = nm.where(y > x, nm.where(x > 0.0, np.log(x) + a, a * y), y / (y - y))
        return a * b + nm.where(x > 0.0, np.log(x) * y, x)

    def plain(x, y):
        a = mpmath.sqrt(x) * mpmath.log(x) if x > 0 else mpmath.sqrt(-x)
        b = mpmath.log(x) + a if x > 0 else a * y
        return a * b + (mpmath.log(x) * y if x > 0 else x)

    function = trace(f, x=(), y=())
    for x, y in ((-2.0, 1.0), (1.5, 2.5), (-0.5, 0.25)):
        expected = [along(plain, [x, y], [1, 0]), along(plain, [x, y], [0, 1])]
        for got in both_ways(function, x, y):
            np.testing.assert_allclose(got, expected, rtol=1e-14, atol=1e-15)


def test_the_rotation_angle_has_a_gradient_at_zero():
    """The textbook trap: the root of a sum of squares, replaced near zero."""

    def sinc(w):
        squared = w @ w
        angle = np.sqrt(squared)
        return nm.where(squared < 1e-12, 1.0 - squared / 6.0, np.sin(angle) / angle)

    gradient = compile(trace(sinc, w=(3,)).vjp())
    assert gradient(np.zeros(3), 1.0).tolist() == [0.0, 0.0, 0.0]
    w = np.array([0.3, -0.2, 0.5])
    angle = np.sqrt(w @ w)
    expected = w / angle * (np.cos(angle) / angle - np.sin(angle) / angle**2)
    np.testing.assert_allclose(gradient(w, 1.0), expected, rtol=1e-13)


def test_a_norm_has_the_gradient_zero_at_zero():
    for f in (
        lambda x: np.sqrt(x @ x),
        lambda x: np.hypot(x[0], x[1]) * np.exp(x[2]),
        lambda x: np.sqrt(x[0] ** 2),
    ):
        function = trace(f, x=(3,))
        at_zero, beside = np.zeros(3), np.array([0.6, -0.8, 0.0])
        assert function.jacobian()(at_zero).tolist() == [0.0, 0.0, 0.0]
        assert function.jvp()(at_zero, np.ones(3)) == 0.0
        assert np.isfinite(function.hessian()(at_zero)).all()
        np.testing.assert_allclose(function.jacobian()(beside)[0], 0.6 / function(beside))
        assert np.isnan(function.jacobian()([np.nan, 1.0, 0.0])[0])


def test_ends_of_domains_have_the_limits_as_derivatives():
    for f, x, limit in (
        (np.sqrt, 0.0, np.inf),
        (np.arccos, 1.0, -np.inf),
        (np.arccos, -1.0, -np.inf),
        (np.arcsin, 1.0, np.inf),
        (np.log, 0.0, np.inf),
    ):
        function = trace(lambda x, f=f: f(x), x=())
        assert function.jacobian()(x) == limit
        assert compile(function.vjp())(x, 1.0) == limit


def test_a_constant_loop_beside_does_not_hinder():
    f = trace(
        lambda x, n: np.sin(x) * nm.loop(lambda v: v < n, lambda v: (v * 2.0,), (1.0,), 50)[0], x=(), n=()
    )
    for got in (f.jacobian("x")(0.3, 100.0), compile(f.jacobian("x"))(0.3, 100.0)):
        assert got == pytest.approx(128.0 * np.cos(0.3), rel=1e-15)


def test_derivatives_of_exact_functions_stay_exact():
    f = trace(lambda x: x * 0.0 + np.floor(x), x=(), rules="exact")
    assert f.jvp().graph.relaxed is False
