"""Every operation compiled, one by one, against NumPy: single calls, batches, doubles, floats, odd numbers."""

from __future__ import annotations

import numpy as np
import pytest
from trace_tools import grid, same_bits, ulps

from ulna import numeric as nm
from ulna.compiler import compile, trace
from ulna.compiler.language.ops import TABLE, Op

EXACT = {
    "neg": (1, lambda x: -x),
    "abs": (1, lambda x: abs(x)),
    "sqrt": (1, np.sqrt),
    "floor": (1, np.floor),
    "ceil": (1, np.ceil),
    "add": (2, lambda x, y: x + y),
    "sub": (2, lambda x, y: x - y),
    "mul": (2, lambda x, y: x * y),
    "div": (2, lambda x, y: x / y),
    "lt": (2, lambda x, y: x < y),
    "le": (2, lambda x, y: x <= y),
    "gt": (2, lambda x, y: x > y),
    "ge": (2, lambda x, y: x >= y),
    "eq": (2, lambda x, y: x == y),
    "ne": (2, lambda x, y: x != y),
    "min": (2, nm.minimum),
    "max": (2, nm.maximum),
    "and": (2, lambda x, y: (x < y) & (x < 1.0)),
    "or": (2, lambda x, y: (x < y) | (y <= x)),
    "not": (2, lambda x, y: ~(x < y)),
    "where": (2, lambda x, y: nm.where(x < y, x, y)),
    "where of conditions": (2, lambda x, y: nm.where(x < y, x < 1.0, y < 1.0)),
    "square": (1, np.square),
    "clip": (1, lambda x: nm.clip(x, -1.0, 1.0)),
}
CLOSE = {
    "power": (1, lambda x: x**3),
    "sin": (1, np.sin),
    "cos": (1, np.cos),
    "tan": (1, np.tan),
    "asin": (1, np.arcsin),
    "acos": (1, np.arccos),
    "atan": (1, np.arctan),
    "exp": (1, np.exp),
    "log": (1, np.log),
    "expm1": (1, np.expm1),
    "log1p": (1, np.log1p),
    "sinh": (1, np.sinh),
    "tanh": (1, np.tanh),
    "cosh": (1, np.cosh),
    "erf": (1, nm.erf),
    "atan2": (2, np.arctan2),
}
ORDINARY = tuple(np.linspace(-4.0, 4.0, 23)) + (1e-5, -1e-9, 30.0, -700.0, 1e6)


def inputs(count: int, dtype: type) -> list[np.ndarray]:
    special = grid(count, dtype=dtype)
    ordinary = grid(count, ORDINARY, dtype)
    return [np.concatenate([a, b]) for a, b in zip(special, ordinary, strict=True)]


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("name", EXACT)
def test_exact_operations_equal_numpy_bit_for_bit(name, dtype):
    count, f = EXACT[name]
    shapes = dict.fromkeys(["x", "y"][:count], ())
    kernel = compile(trace(f, name="f", rules="exact", **shapes), dtype)
    columns = inputs(count, dtype)
    with np.errstate(all="ignore"):
        expected = np.asarray(f(*columns)).astype(dtype)
    batch = kernel(*columns)
    single = np.array([kernel(*row) for row in zip(*columns, strict=True)])
    assert batch.dtype == single.dtype == dtype
    for got in (batch, single):
        good = same_bits(got, expected)
        if name in ("min", "max", "clip"):  # of zeros of either sign NumPy returns any
            good = good | (got == expected)
        at = np.argmin(good)
        assert good.all(), (name, [c[at] for c in columns], got[at], expected[at])


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("name", CLOSE)
def test_functions_are_within_some_ulp_of_numpy_and_agree_at_odd_numbers(name, dtype):
    count, f = CLOSE[name]
    shapes = dict.fromkeys(["x", "y"][:count], ())
    kernel = compile(trace(f, name="f", **shapes), dtype)
    columns = inputs(count, dtype)
    with np.errstate(all="ignore"):
        expected = f(*columns)
    batch = kernel(*columns)
    single = np.array([kernel(*row) for row in zip(*columns, strict=True)])
    assert batch.dtype == single.dtype == dtype
    for got in (batch, single):
        assert ulps(got, expected) <= 4.0
        zero = expected == 0.0
        assert np.array_equal(np.signbit(got[zero]), np.signbit(expected[zero]))


def test_minimum_and_maximum_pass_nan_on():
    kernel = compile(lambda x, y: np.array([nm.minimum(x, y), nm.maximum(x, y)]), x=(), y=())
    assert np.isnan(kernel(np.nan, 1.0)).all()
    assert np.isnan(kernel(1.0, np.nan)).all()
    assert np.isnan(kernel(np.full(9, np.nan), np.ones(9))).all()


def test_comparisons_with_nan_are_false_but_not_equal_is_true():
    kernel = compile(
        lambda x, y: np.array([x < y, x <= y, x > y, x >= y, x == y, x != y], dtype=object), x=(), y=()
    )
    for x, y in ((np.nan, 1.0), (1.0, np.nan), (np.nan, np.nan)):
        assert kernel(x, y).tolist() == [0, 0, 0, 0, 0, 1]
        assert kernel(np.full(17, x), np.full(17, y)).tolist() == [[0, 0, 0, 0, 0, 1]] * 17


def test_where_passes_on_the_chosen_branch_only():
    kernel = compile(lambda x: nm.where(x > 0.0, np.sqrt(x), 0.0 * x), x=())
    assert kernel(-4.0) == 0.0
    assert kernel(np.array([4.0, -4.0] * 8)).tolist() == [2.0, 0.0] * 8


def test_where_mixes_truth_values_and_numbers():
    kernel = compile(lambda x: np.array([nm.where(x < 1.0, True, 0.5), nm.where(x < 1.0, x > 0.0, 2)]), x=())
    assert kernel(0.0).tolist() == [1.0, 0.0]
    assert kernel(3.0).tolist() == [0.5, 2.0]


def test_modulo_has_the_sign_of_the_divisor():
    kernel = compile(lambda x: np.array([x % 3.0, x % -3.0]), x=())
    for x in (7.0, -7.0, 0.5, -0.5, 6.0):
        assert kernel(x).tolist() == [np.mod(x, 3.0), np.mod(x, -3.0)]


@pytest.mark.parametrize("exponent", [0, 1, 2, 5, -1, -3, 0.5, 1.5, -0.5, 2.7])
def test_powers(exponent):
    kernel = compile(lambda x: (x + 0.0) ** exponent + 0.0 * x, x=())
    x = np.linspace(0.1, 7.0, 40)
    np.testing.assert_allclose(kernel(x), x**exponent, rtol=2e-15)


def test_powers_of_one_half_use_the_square_root():
    counts = [trace(lambda x, e=e: x**e, x=()).operation_counts for e in (0.5, 1.5, -0.5, 2.5)]
    assert counts == [{"sqrt": 1}, {"mul": 1, "sqrt": 1}, {"div": 1, "sqrt": 1}, {"mul": 2, "sqrt": 1}]


@pytest.mark.parametrize("exponent", [100.0, -71.0, 65])
def test_large_whole_powers_keep_the_sign(exponent):
    x = np.array([-1.5, -0.9, 0.4, 1.2, -1.0, 1.0])
    np.testing.assert_allclose(compile(lambda x: x**exponent, x=())(x), x**exponent, rtol=1e-13)


def test_powers_of_two_traced_values_are_as_numpy_has_them():
    special = [-2.5, -2.0, -0.3, 0.0, 0.5, 1.0, 2.0, 3.0, np.inf, np.nan]
    a, b = (axis.ravel() for axis in np.meshgrid(special, [-np.inf, -1.0, *special]))
    with np.errstate(all="ignore"):
        expected = a**b
    kernel = compile(lambda a, b: a**b, a=(), b=())
    np.testing.assert_allclose(kernel(a, b), expected, rtol=1e-14)
    np.testing.assert_allclose([kernel(x, y) for x, y in zip(a, b, strict=True)], expected, rtol=1e-14)
    with np.errstate(all="ignore"):
        np.testing.assert_allclose(compile(lambda b: (-2.0) ** b, b=())(b), (-2.0) ** b, rtol=1e-14)
        np.testing.assert_allclose(compile(lambda b: 0.0**b, b=())(b), 0.0**b, rtol=1e-14)
    slope = kernel.jacobian("a")
    np.testing.assert_allclose(slope([-2.0, 2.0], [3.0, 0.5]), [12.0, 0.5 / np.sqrt(2.0)], rtol=1e-14)
    np.testing.assert_allclose(kernel.jacobian("b")(2.0, 3.0), 8.0 * np.log(2.0), rtol=1e-14)


def test_a_power_with_the_traced_value_above():
    kernel = compile(lambda x: 2.0**x, x=())
    np.testing.assert_allclose(kernel(np.linspace(-3, 3, 20)), 2.0 ** np.linspace(-3, 3, 20), rtol=2e-15)


def test_the_table_stands_in_the_order_of_the_operations():
    assert [row.op for row in TABLE] == list(Op)
    for row in TABLE:
        if row.partials:
            assert len(row.partials) == row.arity


def test_constants_are_exported_exactly_in_both_formats():
    values = [0.1, -0.0, 1e300, 5e-324, np.inf, -np.inf, np.nan]
    for dtype in (np.float64, np.float32):
        kernel = compile(
            trace(lambda x: np.array([x * 0.0 + v if False else v for v in values]), x=()), dtype
        )
        with np.errstate(over="ignore"):
            expected = np.array(values).astype(dtype)
        assert same_bits(kernel(1.0), expected).all()
        assert same_bits(kernel(np.ones(20)), np.tile(expected, (20, 1))).all()
