"""Loops in the lanes: every lane stops on its own, keeps its state, and sees the values around the loop."""

from __future__ import annotations

import numpy as np
import pytest
from trace_tools import same_bits

from ulna import numeric as nm
from ulna.compiler import compile, trace
from ulna.errors import TraceError


def collatz(x):
    """Steps of the Collatz sequence, whose length differs wildly from lane to lane."""

    def body(n, steps):
        half = n * 0.5
        even = half.floor() == half if hasattr(half, "floor") else np.floor(half) == half
        return nm.where(even, half, 3.0 * n + 1.0), steps + 1.0

    return nm.loop(lambda n, steps: n != 1.0, body, (x, 0.0 * x), 1000)[1]


def newton(a, tolerance):
    """A square root by Newton's method; captures `a` and `tolerance` from around the loop."""
    half = 0.5 * a
    return nm.loop(
        lambda x, n: abs(x * x - a) > tolerance * a, lambda x, n: (0.5 * x + half / x, n + 1.0), (a, 0.0), 60
    )


def triangle(n, scale):
    """Nested: sum over i < n of sum over j <= i of (i + scale * j)."""

    def outer(i, total):
        _, inner = nm.loop(lambda j, s: j <= i, lambda j, s: (j + 1.0, s + i + scale * j), (0.0, 0.0), 100)
        return i + 1.0, total + inner

    return nm.loop(lambda i, total: i < n, outer, (0.0, 0.0), 100)[1]


def triangle_by_hand(n: int, scale: float) -> float:
    return float(sum(i + scale * j for i in range(n) for j in range(i + 1)))


def equal_to_interpreter(f, *columns, ulp=0.0, **shapes):
    function = trace(f, **shapes)
    kernel = compile(function)
    expected = function(*columns)
    expected = expected if isinstance(expected, tuple) else (expected,)
    batch = kernel(*columns)
    batch = batch if isinstance(batch, tuple) else (batch,)
    for b, e in zip(batch, expected, strict=True):
        np.testing.assert_allclose(b, e, rtol=ulp * 2.3e-16, atol=0)
    for k in range(len(columns[0])):
        single = kernel(*(c[k] for c in columns))
        single = single if isinstance(single, tuple) else (single,)
        for s, e in zip(single, expected, strict=True):
            np.testing.assert_allclose(s, e[k], rtol=ulp * 2.3e-16, atol=0)
    return expected


def test_lanes_that_finish_at_different_times():
    x = np.arange(1.0, 60.0)
    (steps,) = equal_to_interpreter(collatz, x, x=())
    assert steps[26] == 111.0
    assert steps[0] == 0.0


@pytest.mark.parametrize("rows", [1, 2, 3, 7, 8, 9, 15, 16, 17, 20])
def test_any_number_of_rows(rows):
    kernel, x = compile(collatz, x=()), np.arange(1.0, rows + 1.0)
    assert kernel(x).tolist() == [kernel(v) for v in x]


def test_captured_values_and_several_results():
    a = np.geomspace(1e-6, 1e6, 21)
    root, count = equal_to_interpreter(newton, a, np.full(21, 1e-14), a=(), tolerance=(), ulp=2.0)
    np.testing.assert_allclose(root, np.sqrt(a), rtol=1e-13)
    assert count.max() < 60


def test_a_loop_in_a_loop():
    n, scale = np.arange(0.0, 12.0), np.linspace(-2.0, 3.0, 12)
    (total,) = equal_to_interpreter(triangle, n, scale, n=(), scale=(), ulp=8.0)
    np.testing.assert_allclose(total, [triangle_by_hand(int(i), s) for i, s in zip(n, scale, strict=True)])


def test_an_inner_loop_may_start_from_outer_values_and_use_the_middle_ones():
    def f(a):
        def body(i, s):
            j, t = nm.loop(lambda j, t: j < 3.0, lambda j, t: (j + 1.0, t + i), (a * 0.5, a), 5)
            return i + 1.0, s + t * j

        return nm.loop(lambda i, s: i < 4.0, body, (a, a), 10)[1]

    equal_to_interpreter(f, np.linspace(0.0, 3.9, 11), a=(), ulp=8.0)


def test_three_levels_with_sines_inside():
    def f(x):
        def middle(i, s):
            def inner(j, t):
                def innermost(k, u):
                    return k + 1.0, u + np.sin(k * x + j) * np.cos(i)

                return j + 1.0, t + nm.loop(lambda k, u: k < 2.0 + j, innermost, (0.0, 0.0), 9)[1]

            return i + 1.0, s + nm.loop(lambda j, t: j < i, inner, (0.0, 0.0), 9)[1]

        return nm.loop(lambda i, s: i < 4.0, middle, (0.0, 0.0), 9)[1]

    function = trace(f, x=())
    x = np.linspace(-2.0, 2.0, 13)
    np.testing.assert_allclose(compile(function)(x), function(x), rtol=1e-13)
    np.testing.assert_allclose([compile(function)(v) for v in x], function(x), rtol=1e-13)


def test_the_limit_ends_a_loop():
    for limit in (0, 1, 5):
        kernel = compile(lambda x, m=limit: nm.loop(lambda n: True, lambda n: (n + 1.0,), (x,), m)[0], x=())
        assert kernel(0.5) == 0.5 + limit
        assert kernel(np.full(11, 0.5)).tolist() == [0.5 + limit] * 11


def test_a_loop_whose_condition_never_holds():
    kernel = compile(lambda x: nm.loop(lambda n: n < -1e9, lambda n: (n + 1.0,), (x,), 10)[0], x=())
    assert kernel(3.0) == 3.0
    assert kernel(np.arange(9.0)).tolist() == np.arange(9.0).tolist()


def test_nan_and_inf_in_one_lane_leave_the_others_alone():
    def halve(x):
        return nm.loop(lambda v, n: v > 1.0, lambda v, n: (v * 0.5, n + 1.0), (x, 0.0), 30)

    function = trace(halve, x=())
    x = np.array([8.0, np.nan, np.inf, 5.0, -np.inf, 1e300, 0.0, 3.0, 2.0])
    for got, expected in zip(compile(function)(x), function(x), strict=True):
        assert same_bits(got, expected).all()
    assert function(x)[1].tolist() == [3, 0, 30, 3, 0, 30, 0, 2, 1]


def test_a_lane_that_is_done_does_not_change_where_its_body_would_make_nan():
    kernel = compile(lambda x: nm.loop(lambda v: v > 0.0, lambda v: (np.sqrt(v) - 1.0,), (x,), 20)[0], x=())
    x = np.array([0.25, 9.0, 100.0, -5.0, 1e8])
    assert np.isfinite(kernel(x)).all()
    assert kernel(x).tolist() == [kernel(v) for v in x]


def test_sines_shared_between_the_condition_and_the_body():
    def f(x, y):
        return nm.loop(
            lambda v, n: np.sin(v) < y, lambda v, n: (v + 0.1 * np.cos(v) + 0.05 + np.sin(v) * 0.01, n + 1.0), (x, 0.0), 99
        )[0]  # fmt: skip

    equal_to_interpreter(f, np.linspace(0, 1, 12), np.linspace(0.2, 0.9, 12), x=(), y=(), ulp=100.0)


def test_conditions_in_the_state_count_as_numbers():
    def f(x):
        return nm.loop(lambda c, n: c < 0.5, lambda c, n: (n > 3.0, n + 1.0), (x > 100.0, x), 50)[1]

    equal_to_interpreter(f, np.arange(0.0, 9.0), x=())


def test_conditions_may_be_captured():
    def f(x):
        high = x > 2.0
        return nm.loop(lambda n: (n < 5.0) & high, lambda n: (nm.where(high, n + 1.0, -1.0),), (x,), 50)[0]

    equal_to_interpreter(f, np.arange(0.0, 9.0), x=())


def test_the_state_may_swap():
    kernel = compile(lambda x, y: nm.loop(lambda a, b: a < b, lambda a, b: (b, a), (x, y), 7), x=(), y=())
    assert kernel(1.0, 2.0) == (2.0, 1.0)
    assert kernel(3.0, 2.0) == (3.0, 2.0)


def test_two_loops_one_after_the_other_and_a_discarded_result():
    def f(x):
        a, _ = nm.loop(lambda a, b: a < 10.0, lambda a, b: (a * 1.5, b + 1.0), (x, 0.0), 50)
        return nm.loop(lambda c: c > a * 0.1, lambda c: (c * 0.5,), (a,), 50)[0]

    equal_to_interpreter(f, np.linspace(0.5, 20.0, 15), x=(), ulp=4.0)


def test_single_precision():
    kernel = compile(trace(newton, a=(), tolerance=()), np.float32)
    root, count = kernel(np.linspace(1, 9, 17, dtype=np.float32), np.float32(1e-6))
    assert root.dtype == np.float32
    np.testing.assert_allclose(root, np.sqrt(np.linspace(1, 9, 17)), rtol=2e-6)
    assert count.max() < 60


def test_plain_numbers_and_batches_run_through_the_same_loop():
    assert newton(2.0, 1e-14)[0] == pytest.approx(2**0.5, rel=1e-14)
    assert collatz(np.arange(1.0, 9.0)).tolist() == [0, 1, 7, 2, 5, 8, 16, 3]
    assert triangle(4.0, 2.0) == triangle_by_hand(4, 2.0)


def test_a_traced_function_with_a_loop_may_be_used_in_another_trace():
    root = trace(lambda a: newton(a, 1e-14)[0], a=())
    kernel = compile(lambda x: root(x * x + 1.0) + root(x + 5.0), x=())
    x = np.linspace(0.0, 3.0, 12)
    np.testing.assert_allclose(kernel(x), np.sqrt(x * x + 1) + np.sqrt(x + 5), rtol=1e-13)


def test_a_traced_function_may_be_used_in_the_body_of_a_loop():
    step = trace(lambda x, a: 0.5 * (x + a / x), x=(), a=())
    kernel = compile(
        lambda a: nm.loop(lambda x: abs(x * x - a) > 1e-13 * a, lambda x: (step(x, a),), (a,), 40)[0], a=()
    )
    np.testing.assert_allclose(kernel(np.linspace(1, 5, 11)), np.sqrt(np.linspace(1, 5, 11)), rtol=1e-12)


def test_operations_count_the_body_once():
    function = trace(lambda x: nm.loop(lambda v: v < 9.0, lambda v: (v * 2.0 + 1.0,), (x,), 50)[0], x=())
    assert function.operation_counts == {"add": 1, "lt": 1, "mul": 1}


def test_errors_of_loops_say_what_is_wrong():
    with pytest.raises(
        TraceError, match="The body of a loop returned 1 values; expected a tuple of 2 numbers"
    ):
        trace(lambda x: nm.loop(lambda a, b: a < b, lambda a, b: (a,), (x, x), 5)[0], x=())
    with pytest.raises(TraceError, match="The body of a loop returned Scalar; expected a tuple of 1 numbers"):
        trace(lambda x: nm.loop(lambda a: a < 1.0, lambda a: a, (x,), 5)[0], x=())
    with pytest.raises(TraceError, match="The condition of a loop returned Scalar; expected a comparison"):
        trace(lambda x: nm.loop(lambda a: a, lambda a: (a,), (x,), 5)[0], x=())
    with pytest.raises(
        TraceError, match=r"state of a traced loop holds an array; expected numbers\. Unpack it"
    ):
        trace(lambda q: nm.loop(lambda a, n: n < 3.0, lambda a, n: (a * 2, n + 1), (q, 0.0), 5)[0], q=(3,))


def test_a_value_that_leaves_its_loop_is_refused():
    kept = []

    def f(x):
        nm.loop(lambda a: a < 1.0, lambda a: (kept.append(a) or a + 1.0,), (x,), 5)
        return kept[0] + x

    with pytest.raises(TraceError, match="traced value of another trace"):
        trace(f, x=())
