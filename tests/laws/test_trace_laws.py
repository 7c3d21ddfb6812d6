"""Laws of the compiler on random graphs: compiled = interpreted, batch = stack of singles, derivative = slope."""

from __future__ import annotations

import dataclasses
import pickle
from importlib import import_module

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from support.random_functions import functions, inputs
from ulna.compiler import Function, Port, compile
from ulna.compiler.codegen.arithmetic import Arithmetic
from ulna.compiler.language.graph import Graph, Loop
from ulna.compiler.language.ops import TABLE

QUICK = settings(
    max_examples=40, deadline=None, derandomize=True, database=None, suppress_health_check=list(HealthCheck)
)


def without_contraction(monkeypatch, f: Function):
    """A kernel without fused multiplication and addition, whose every step rounds as NumPy's does."""
    jit = import_module("ulna.compiler.runtime.jit")
    separate = dataclasses.replace(jit.target(), arithmetic=Arithmetic(fused_multiply_add=False))
    with monkeypatch.context() as patch:
        patch.setattr(jit, "target", lambda: separate)
        kernel = compile(f)
        kernel.gufunc
    return kernel


def assert_same(got, expected, context: object) -> None:
    """Bit for bit, but for the sign of zero after a minimum of zeros, and the kind of nan."""
    for g, e in zip(got, expected, strict=True):
        assert g.shape == e.shape
        assert np.array_equal(g, e, equal_nan=True), (context, g, e)


@QUICK
@given(f=functions(exact=True))
def test_compiled_without_fusing_equals_interpreted_bit_for_bit(f):
    with pytest.MonkeyPatch.context() as monkeypatch:
        kernel = without_contraction(monkeypatch, f)
    for special in (False, True):
        columns = inputs(f, 19, special)
        expected = f(*columns)
        assert_same(kernel(*columns), expected, "batch")
        for odd in (
            np.asfortranarray,
            lambda c: np.flip(np.flip(c).copy()),
            lambda c: np.repeat(c, 2, -1)[..., ::2],
        ):
            strided = [odd(c) if c.ndim > 1 else c for c in columns]
            out = tuple(np.asfortranarray(np.zeros(e.shape)) for e in expected)
            assert_same(kernel(*strided, out=out), expected, "strided")
        assert_same(kernel(*(c[:5] for c in columns)), [e[:5] for e in expected], "few rows")
        singles = [kernel(*(c[k] for c in columns)) for k in range(19)]
        assert_same([np.stack(s) for s in zip(*singles, strict=True)], expected, "single")


@QUICK
@given(f=functions(smooth=True))
def test_compiled_agrees_with_interpreted_within_rounding(f):
    kernel = compile(f)
    columns = inputs(f, 21)
    expected = f(*columns)
    # What rounding may do is bounded by the largest number on the way, about, for sums and products.
    scale = largest(f, columns)
    batch = kernel(*columns)
    for k, (b, e) in enumerate(zip(batch, expected, strict=True)):
        assert np.abs(b - e).max() <= 1e-13 * scale, (k, b, e)
    for row in range(21):
        for s, b in zip(kernel(*(c[row] for c in columns)), batch, strict=True):
            assert np.abs(s - b[row]).max() <= 1e-13 * scale


def largest(f: Function, columns: list[np.ndarray]) -> float:
    """The largest absolute value of any node, times the largest slope that a later one can have."""
    numbers = tuple(i for i in f.graph.live(f.results) if not TABLE[f.graph.op[i]].is_condition)
    every = Function("all", f.graph, f.inputs, (Port("all", (len(numbers),)),), numbers)
    values = every(*columns)
    slopes = [np.abs(j(*columns)).max() for k in range(len(f.inputs)) for j in [every.jacobian(k)]]
    return float(max(1.0, np.abs(values).max())) * max(1.0, *slopes) * len(numbers)


@QUICK
@given(f=functions())
def test_any_graph_compiles_and_agrees_on_where_it_is_nan(f):
    """With every operation and loops: no crash, right shapes, and equality where rounding cannot have decided."""
    kernel = compile(f)
    columns = inputs(f, 18, special=True)
    for g, e in zip(kernel(*columns), f(*columns), strict=True):
        assert g.shape == e.shape
    assert kernel(*(c[:0] for c in columns))[0].shape[0] == 0


@QUICK
@given(f=functions(exact=True))
def test_single_precision_equals_interpretation_in_single_precision(f):
    with pytest.MonkeyPatch.context() as monkeypatch:
        jit = import_module("ulna.compiler.runtime.jit")
        separate = dataclasses.replace(jit.target(), arithmetic=Arithmetic(fused_multiply_add=False))
        monkeypatch.setattr(jit, "target", lambda: separate)
        kernel = compile(f, np.float32)
        columns = inputs(f, 18, dtype=np.float32)
        got = kernel(*columns)
    interpret = import_module("ulna.compiler.language.interpreter").interpret
    single = pickle.loads(pickle.dumps(f.graph))
    for graph in graphs_of(single):
        graph.data = [np.float32(d) if isinstance(d, float) else d for d in graph.data]
    flat = [c.reshape(18, -1)[:, k] for c in columns for k in range(int(np.prod(c.shape[1:])))]
    values = interpret(single, flat, f.results)
    flat_got = np.concatenate([g.reshape(18, -1) for g in got], axis=1)
    for k, v in enumerate(values):
        assert flat_got.dtype == np.float32
        if not any(isinstance(d, Loop) for d in f.graph.data):  # the interpreter's loops hold doubles
            assert np.array_equal(flat_got[:, k], np.broadcast_to(v, 18), equal_nan=True)


def graphs_of(graph: Graph) -> list[Graph]:
    found = [graph]
    for data in graph.data:
        if isinstance(data, Loop):
            found += graphs_of(data.graph)
    return found


@QUICK
@given(f=functions())
def test_functions_survive_pickling_with_their_fingerprint(f):
    twin = pickle.loads(pickle.dumps(f))
    assert twin.fingerprint == f.fingerprint
    columns = inputs(f, 5, special=True)
    assert_same(twin(*columns), f(*columns), "pickled")


@QUICK
@given(f=functions(smooth=True), seed=st.integers(0, 1000))
def test_forward_reverse_and_slope_agree(f, seed):
    rng = np.random.default_rng(seed)
    point = [rng.uniform(-1.0, 1.0, p.shape) for p in f.inputs]
    direction = [rng.uniform(-1.0, 1.0, p.shape) for p in f.inputs]
    forward = f.jvp()(*point, *direction)
    weights = [rng.uniform(-1.0, 1.0, np.shape(o)) for o in forward]
    reverse = f.vjp()(*point, *weights)
    reverse = reverse if isinstance(reverse, tuple) else (reverse,)
    left = sum(float(np.sum(o * w)) for o, w in zip(forward, weights, strict=True))
    right = sum(float(np.sum(b * d)) for b, d in zip(reverse, direction, strict=True))
    scale = largest(f, [p[None] for p in point])
    assert abs(left - right) <= 1e-12 * scale
    rows = [f.jacobian(k)(*point) for k in range(len(f.inputs))]
    for k, o in enumerate(forward):
        total = sum(np.tensordot(r[k], d, d.ndim) for r, d in zip(rows, direction, strict=True))
        assert np.abs(total - o).max() <= 1e-12 * scale


@QUICK
@given(f=functions())
def test_equal_graphs_in_another_order_of_making_have_one_meaning(f):
    """Copying a function into a new graph changes nothing it computes."""
    copy_into = import_module("ulna.compiler.language.function").copy_into
    g = Graph(relaxed=f.graph.relaxed)
    flat = [g.input() for p in f.inputs for _ in range(p.size)]
    twin = Function(
        "twin", g, f.inputs, f.outputs, tuple(copy_into(g, f.graph, f.results, flat)), single=False
    )
    assert twin.operations <= f.operations
    columns = inputs(f, 9, special=True)
    assert_same(twin(*columns), f(*columns), "copied")
