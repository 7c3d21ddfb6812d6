"""The order in which graphs are written: everything before its use, once; and large graphs in parts."""

from __future__ import annotations

from importlib import import_module

import numpy as np
import pytest

from ulna import numeric as nm
from ulna.compiler import compile, trace
from ulna.compiler.codegen.register_pressure import few_alive, most_alive
from ulna.compiler.language.ops import TABLE, Op
from ulna.compiler.language.scheduling import Sines, Store, made, parts, used

schedule = import_module("ulna.compiler.language.scheduling")


def _mixed(q, x):
    """Sines of sines, a condition that is used late, an output twice, one that is an input, one that is constant."""
    late = q[0] < x
    y = np.sin(q) * np.cos(q[::-1]) + np.sin(np.cos(q) * x)
    for _ in range(6):
        y = y * y[::-1] + np.cos(q) * 0.25 - y[0] / (2.0 + x * x)
    z = np.outer(y, y + x)
    return nm.where(late, z[0], z[1]), z + z.T, q[::-1], np.array([2.0, 0.0, y[3], y[3]]), x * x


FUNCTION = trace(_mixed, q=(5,), x=())


@pytest.fixture(params=[1, 7, 40])
def small_parts(request, monkeypatch):
    """Parts of a few instructions."""
    monkeypatch.setattr(schedule, "_SIZES", {False: request.param, True: 3 * request.param})
    monkeypatch.setattr(schedule, "_MAX_SINGLE_PART", 0)


def _assert_complete(steps):
    """Everything is made once and before it is used, and all results are stored."""
    g = FUNCTION.graph
    known = {index for index in range(len(g)) if g.op[index] in (Op.CONST, Op.BOOL)}
    written: dict[tuple[int, int], int] = {}
    for step in steps:
        assert set(used(g, step)) <= known
        if isinstance(step, Store):
            for j, value in enumerate(step.values, step.start):
                assert (step.port, j) not in written
                written[step.port, j] = value
        else:
            new = [index for index in made(g, step) if TABLE[g.op[index]].arity or g.op[index] == Op.INPUT]
            assert not known.intersection(new)
            known.update(new)
    places = [(k, j) for k, port in enumerate(FUNCTION.outputs) for j in range(port.size)]
    assert [written[place] for place in places] == list(FUNCTION.results)


def test_the_order_with_few_values_alive_is_complete():
    steps = few_alive(FUNCTION)
    _assert_complete(steps)
    traced = [step for piece in parts(FUNCTION, 1, 1) for step in piece]
    assert most_alive(FUNCTION.graph, steps) <= most_alive(FUNCTION.graph, traced)


def test_what_is_made_early_and_used_late_is_made_late():
    """Products of all pairs, then their sums in order: on demand only one product waits."""

    def f(x):
        products = [a * b for k, a in enumerate(x) for b in x[:k]]
        total = products[0]
        for p in products[1:]:
            total = np.sqrt(total + p)
        return total

    function = trace(f, x=(8,))
    traced = [step for piece in parts(function, 1, 1) for step in piece]
    assert most_alive(function.graph, traced) >= 8 * 7 // 2
    assert most_alive(function.graph, few_alive(function)) <= 8 + 2


@pytest.mark.parametrize(("lanes", "pack"), [(1, 8), (1, 1), (4, 1), (8, 1)])
def test_everything_is_made_once_and_before_it_is_used(lanes, pack, small_parts):
    pieces = parts(FUNCTION, lanes, pack)
    assert len(pieces) > 1 and all(pieces)
    _assert_complete([step for piece in pieces for step in piece])


def test_sines_of_one_sample_are_taken_together():
    (steps,) = parts(trace(np.sin, q=(11,)), 1, 8)
    assert [len(step.arguments) for step in steps if isinstance(step, Sines)] == [8, 3]


@pytest.mark.parametrize("dtype", ["float64", "float32"])
def test_parts_compute_what_the_whole_computes(dtype, small_parts):
    kernel = compile(FUNCTION, dtype)
    assert "@one.1(" in kernel.ir() and "@block.1(" in kernel.ir(batch=True)
    rng = np.random.default_rng(3)
    q, x = rng.uniform(-1, 1, (21, 5)).astype(dtype), rng.uniform(-1, 1, 21).astype(dtype)
    tolerance = 1e-13 if dtype == "float64" else 1e-5
    expected = FUNCTION(q, x)
    for got, wanted in zip(kernel(q, x), expected, strict=True):
        np.testing.assert_allclose(got, wanted, rtol=tolerance, atol=tolerance)
    for got, wanted in zip(kernel(q[4], x[4]), expected, strict=True):
        np.testing.assert_allclose(got, wanted[4], rtol=tolerance, atol=tolerance)


def test_parts_may_write_over_their_inputs(small_parts):
    kernel = compile(lambda q, p: (np.cumsum(q * p), q[::-1] + np.sin(p)), q=(6,), p=(6,))
    q, p = np.random.default_rng(0).standard_normal((2, 19, 6))
    expected = kernel(q, p)
    kernel(q, p, out=(q, p))
    np.testing.assert_array_equal(q, expected[0])
    np.testing.assert_array_equal(p, expected[1])


def test_a_function_with_a_loop_stays_whole(small_parts):
    f = trace(lambda q: nm.loop(lambda x: x > 1.0, lambda x: (x * 0.5,), (q[0] + q[1],), 20)[0] * q, q=(9,))
    assert f.has_loops and len(parts(f, 8, 1)) == len(parts(f, 1, 8)) == 1
    np.testing.assert_array_equal(compile(f)(np.ones(9)), np.ones(9))
