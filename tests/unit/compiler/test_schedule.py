"""The order in which graphs are written: everything before its use, once; and large graphs in parts."""

from __future__ import annotations

from importlib import import_module

import numpy as np
import pytest

from ulna import numeric as nm
from ulna.compiler import compile, trace
from ulna.compiler.codegen.register_pressure import low_pressure_steps, register_pressure
from ulna.compiler.codegen.scheduling import Sines, Store, made, parts, used
from ulna.compiler.language.ops import TABLE, Op

schedule = import_module("ulna.compiler.codegen.scheduling")


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
    for sizes in "_SIZES", "_LOOP_SIZES":
        monkeypatch.setattr(schedule, sizes, {False: request.param, True: 3 * request.param})
    monkeypatch.setattr(schedule, "_MAX_SINGLE_PART", 0)
    monkeypatch.setattr(schedule, "_MAX_WHOLE_BODY", {False: 0, True: 0})


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
    steps = low_pressure_steps(FUNCTION)
    _assert_complete(steps)
    traced = [step for piece in parts(FUNCTION, 1, 1) for step in piece]
    assert register_pressure(FUNCTION.graph, steps) <= register_pressure(FUNCTION.graph, traced)


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
    assert register_pressure(function.graph, traced) >= 8 * 7 // 2
    assert register_pressure(function.graph, low_pressure_steps(function)) <= 8 + 2


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


def _settled(q, x):
    """A loop between straight-line code, with sines, conditions and captured values in its body, and a loop in one."""
    early = q[3] < q[4]

    def smaller(w):
        return (nm.where(early, w * 0.5, w * 0.25),)

    def body(n, y, z):
        if x is None:
            inner = nm.loop(lambda w: w > 2.0, smaller, (z * z + 1.0,), 9)[0]
        else:
            inner = nm.where(early, x, y)
        late = y < z
        y, z = np.sin(y) * np.cos(z) + q[1], np.cos(y) * 0.5 + np.sin(q[2]) * inner
        return n + 1.0, nm.where(late, y, z), z + y * q[0]

    start = np.cos(q) * np.sin(q[::-1])
    n, y, z = nm.loop(lambda n, y, z: n < 3.0 + q[0], body, (0.0, start[0], start[1]), 9)
    return np.outer(np.sin(q) * y, np.cos(q) + z), n


@pytest.mark.parametrize("dtype", ["float64", "float32"])
@pytest.mark.parametrize("nested", [False, True])
def test_loops_in_parts_compute_what_the_interpreter_does(dtype, nested, small_parts):
    shapes = {"q": (5,)} if nested else {"q": (5,), "x": ()}
    f = trace((lambda q: _settled(q, None)) if nested else _settled, **shapes)
    kernel = compile(f, dtype)
    ir = kernel.ir(), kernel.ir(batch=True)
    assert "@one.1(" in ir[0] and "@block.1(" in ir[1]
    assert nested or all("call void @part" in text for text in ir)  # the body is in parts, too
    rng = np.random.default_rng(3)
    arrays = [rng.uniform(-1, 1, (21, *shape)).astype(dtype) for shape in shapes.values()]
    tolerance = 1e-13 if dtype == "float64" else 1e-5
    expected = f(*arrays)
    for got, wanted in zip(kernel(*arrays), expected, strict=True):
        np.testing.assert_allclose(got, wanted, rtol=tolerance, atol=tolerance)
    for got, wanted in zip(kernel(*(a[4] for a in arrays)), expected, strict=True):
        np.testing.assert_allclose(got, wanted[4], rtol=tolerance, atol=tolerance)


def test_gradients_through_loops_in_parts_compute_what_the_interpreter_does(small_parts):
    f = trace(lambda q, x: np.sum(_settled(q, x)[0]), q=(5,), x=()).value_and_gradient()
    assert f.tape_size and len(parts(f, 8, 1)) == len(parts(f, 1, 8)) == 1  # records are in one function
    kernel = compile(f)
    for text in kernel.ir(), kernel.ir(batch=True):
        assert "call void @part" in text
    rng = np.random.default_rng(4)
    q, x = rng.uniform(-1, 1, (21, 5)), rng.uniform(-1, 1, 21)
    expected = f(q, x)
    for got, wanted in zip(kernel(q, x), expected, strict=True):
        np.testing.assert_allclose(got, wanted, rtol=1e-12, atol=1e-12)
    for got, wanted in zip(kernel(q[4], x[4]), expected, strict=True):
        np.testing.assert_allclose(got, wanted[4], rtol=1e-12, atol=1e-12)
