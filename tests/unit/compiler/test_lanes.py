"""Races: one sample in all lanes, and lanes that look at each other."""

import dataclasses
import pickle

import numpy as np
import pytest

from ulna import numeric
from ulna.compiler import compile, trace
from ulna.compiler.codegen.arithmetic import Arithmetic
from ulna.compiler.forms.lanes import choose, in_any_lane, lane, least
from ulna.compiler.runtime import jit
from ulna.errors import TraceError

LANES = 8


def _first_below(a):
    """Every lane halves its own number; the first below the bound wins."""

    def halve(x, n):
        return 0.5 * x, n + 1.0

    start = a[0] + 0.7 * lane(LANES)
    x, n = numeric.loop(lambda x, n: ~in_any_lane(x < a[1]), halve, (start, 0.0), 60)
    winner = least(numeric.where(x < a[1], lane(LANES), float(LANES)))
    return numeric.vector(choose(lane(LANES) == winner, x), n, winner)


def _expected(a):
    x, n = a[0] + 0.7 * np.arange(LANES), 0
    while not (x < a[1]).any() and n < 60:
        x, n = 0.5 * x, n + 1
    winner = int(np.argmax(x < a[1]))
    return [x[winner], n, winner]


@pytest.fixture(scope="module")
def samples():
    return np.random.default_rng(5).uniform((-3.0, 0.1), (9.0, 2.0), size=(37, 2))


@pytest.mark.parametrize("dtype", ["float64", "float32"])
def test_single_calls_batches_and_the_interpreter_agree_with_the_plain_computation(samples, dtype):
    function = trace(_first_below, lanes=LANES, a=(2,))
    kernel = compile(function, dtype=dtype)
    expected = np.array([_expected(a) for a in samples])
    near = {"rtol": 1e-14 if dtype == "float64" else 1e-5}
    np.testing.assert_allclose(function(samples), expected, rtol=1e-14)
    np.testing.assert_allclose(kernel(samples), expected, **near)
    np.testing.assert_allclose(kernel(samples[::2][:, ::-1][:, ::-1]), expected[::2], **near)
    np.testing.assert_allclose([kernel(a.astype(dtype)) for a in samples], expected, **near)


def test_a_kernel_with_lanes_can_be_pickled(samples):
    kernel = compile(trace(_first_below, lanes=LANES, a=(2,)))
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(kernel))(samples), kernel(samples))


def test_a_number_that_is_nan_does_not_win():
    def f(a):
        return least(numeric.where(lane(4) < 2.0, float("nan"), lane(4) * a[0]))

    assert compile(trace(f, lanes=4, a=(1,)))([3.0]) == 6.0


def test_what_a_function_with_lanes_cannot_do_raises():
    with pytest.raises(TraceError, match="lanes=8"):
        lane(LANES)
    function = trace(_first_below, lanes=LANES, a=(2,))
    with pytest.raises(TraceError, match="8 lanes and takes numbers only"):
        trace(lambda a: function(a), a=(2,))
    across = trace(lambda a: least(a[0] + lane(2)), lanes=2, a=(1,))
    with pytest.raises(TraceError, match="reductions across lanes"):
        across.jacobian()


def test_a_single_lane_needs_no_reductions(samples):
    def first_below(a):
        x, n = numeric.loop(
            lambda x, n: ~in_any_lane(x < a[1]), lambda x, n: (0.5 * x, n + 1.0), (a[0], 0.0), 60
        )
        return numeric.vector(choose(lane(1) == least(lane(1)), x), n)

    function = trace(first_below, lanes=1, a=(2,))
    assert not {"any", "least"} & set(function.operation_counts)
    np.testing.assert_array_equal(compile(function)(samples), function(samples))
    assert (function(samples)[:, 1] != function(samples)[0, 1]).any()  # each sample of a batch goes its way


@pytest.mark.parametrize("lanes", [2, 4, 8])
def test_the_least_number_without_an_instruction_for_it(lanes, monkeypatch):
    target = dataclasses.replace(jit.target(), arithmetic=Arithmetic(minimum_number=False))
    monkeypatch.setattr(jit, "target", lambda: target)

    def f(a):
        x = sum(numeric.where(lane(lanes) == float(k), a[k], 0.0) for k in range(lanes))
        return numeric.vector(least(numeric.where(x > 0.0, x, float("nan"))), least(x))

    kernel = compile(trace(f, lanes=lanes, a=(lanes,)))
    assert "vector.reduce.fmin" not in kernel.ir()
    for a in np.random.default_rng(lanes).normal(size=(20, lanes)):
        positive = a[a > 0.0]
        np.testing.assert_array_equal(kernel(a), [positive.min() if positive.size else np.nan, a.min()])


@pytest.mark.parametrize("dtype", ["float64", "float32"])
def test_minimum_and_maximum_by_comparisons(monkeypatch, dtype):
    target = dataclasses.replace(jit.target(), arithmetic=Arithmetic(minimum=False))
    monkeypatch.setattr(jit, "target", lambda: target)
    kernel = compile(lambda a, b: (numeric.minimum(a, b), numeric.maximum(a, b)), a=(4,), b=(4,), dtype=dtype)
    assert "minimum" not in kernel.ir() and "maximum" not in kernel.ir(batch=True)
    a, b = np.array([1.0, 2.0, np.nan, 3.0]), np.array([2.0, -np.inf, 1.0, np.nan])
    for rows in ((), (9,)):
        left, right = np.broadcast_to(a, (*rows, 4)), np.broadcast_to(b, (*rows, 4))
        least, greatest = kernel(left.astype(dtype), right.astype(dtype))
        np.testing.assert_array_equal(least, np.minimum(left, right))
        np.testing.assert_array_equal(greatest, np.maximum(left, right))
