"""Tracing: what becomes of NumPy's functions, what is refused and how it says so, calls of traced functions, counts."""

from __future__ import annotations

import copy
import math
import pickle

import numpy as np
import pytest

from ulna import numeric as nm
from ulna.compiler import Port, compile, trace
from ulna.compiler.language.scalar import Condition, Scalar
from ulna.errors import InputError, ShapeError, TraceError

TRUTH = r"A traced value has no truth: `if`, `and`, `or`.*Use ulna\.numeric\.where.*combine conditions with & \| ~"
NUMBER = r"A traced value has no number yet.*Use np\.sin and the like"


@pytest.mark.parametrize(
    ("f", "message"),
    [
        (lambda x: 1.0 if x else 2.0, TRUTH),
        (lambda x: x if x > 0.0 else -x, TRUTH),
        (lambda x: (x > 0.0) and (x < 1.0), TRUTH),
        (lambda x: not x, TRUTH),
        (lambda x: max(x, 1.0), TRUTH),
        (lambda x: np.minimum(x, 1.0), TRUTH),
        (lambda x: np.sign(x), TRUTH),
        (lambda x: np.clip(np.array([x]), 0.0, 1.0), TRUTH),
        (lambda x: np.array([x, x]) < 1.0, TRUTH),
        (lambda x: x in [1.0, 2.0], TRUTH),
        (lambda x: float(x), NUMBER),
        (lambda x: int(x), NUMBER),
        (lambda x: round(x), NUMBER),
        (lambda x: math.sin(x), NUMBER),
        (lambda x: np.array([x, 1.0], dtype=float), NUMBER),
        (lambda x: [1.0, 2.0][x], NUMBER),
        (lambda x: np.linalg.inv(np.array([[x]])), "Traced values cannot do this: .* ulna.linalg solves small systems"),
        (lambda x: np.arcsinh(x), "Traced values cannot do this: .* no callable arcsinh method. They know .* np.sqrt, sin, "),
        (lambda x: np.arctan2(1.0, x), "Traced values cannot do this: .*'arctan2'.* numeric.arctan2 any"),
        (lambda x: np.hypot(2, x), "Traced values cannot do this: .*np.hypot takes traced values first"),
        (lambda x: np.isnan(np.array([x])), "Traced values cannot do this: .*'isnan' not supported"),
        (lambda x: x * 1j, "Traced values cannot do this: .*'Scalar' and 'complex'"),
        (lambda x: x.ndim, "Traced values cannot do this: .* no attribute .ndim.. They know"),
        (lambda x: pickle.dumps(x), "cannot be pickled or copied out of its trace; pickle the Function"),
        (lambda x: copy.deepcopy(x), "cannot be pickled or copied"),
        (lambda x: "text", r"A traced function met 'text' of type str; expected a real number"),
        (lambda x: None, r"met None of type NoneType; expected a real number"),
        (lambda x: np.array([x, 1j]), r"met 1j of type complex; expected a real number"),
        (lambda x: {x.index: x}, r"of type dict; expected a real number"),
        (lambda x: [x, np.zeros(2)], r"returned a list of arrays of different shapes; return a tuple"),
        (lambda x: nm.where(x > 0.0, "a", x), r"met 'a' of type str; expected a real number"),
    ],
)  # fmt: skip
def test_what_cannot_be_traced_says_what_to_do_instead(f, message):
    with pytest.raises(TraceError, match=message):
        trace(f, x=())


def test_functions_of_math_on_traced_arrays_say_what_to_use():
    with pytest.raises(TraceError, match=r"Traced values cannot do this: .* They know .* np\.sqrt, sin, "):
        trace(lambda x: math.sin(x), x=(2,))


def test_functions_that_numpy_lacks_are_named_as_those_of_numeric():
    with pytest.raises(TraceError) as caught:
        trace(lambda x: np.arcsinh(x), x=())
    known = str(caught.value).split("np.")[1].split(", and ")
    assert all(hasattr(np, name) for name in known[0].split(", "))
    others = known[1].split(" of ulna.numeric")[0].replace(" and ", ", ").split(", ")
    assert "erf" in others and all(hasattr(nm, name) for name in others)


def test_mistakes_of_the_function_itself_stay_what_they_are():
    with pytest.raises(TypeError, match="must be an iterable") as caught:
        trace(lambda x: [*None], x=())  # type: ignore[misc]
    assert not isinstance(caught.value, TraceError)


def test_storing_into_a_float_array_is_refused():
    def f(x):
        out = np.zeros(3)
        out[1] = x
        return out

    with pytest.raises((TraceError, ValueError, TypeError)) as caught:
        trace(f, x=())
    causes = [caught.value, caught.value.__cause__]
    assert any("build arrays with ulna.numeric.vector or matrix" in str(c) for c in causes)


def test_values_of_another_trace_are_refused():
    kept = []
    trace(lambda x: kept.append(x) or x, x=())
    for f in (
        lambda y: y + kept[0],
        lambda y: kept[0],
        lambda y: nm.where(y < 1.0, kept[0], y),
        lambda y: kept[0] * 2.0,
    ):
        with pytest.raises(TraceError, match="another trace is used here; pass it as an argument"):
            trace(f, y=())


def test_arithmetic_with_non_numbers_is_a_type_error():
    for f in (
        lambda x: x + "a",
        lambda x: x * None,
        lambda x: 2j - x,
        lambda x: (x > 1.0) + 1.0,
        lambda x: x & True,
    ):
        with pytest.raises(TypeError):
            trace(f, x=())
    with pytest.raises(TypeError, match="unhashable"):
        trace(lambda x: {x}, x=())


def test_rules_are_checked():
    with pytest.raises(ValueError, match="rules='loose'; expected 'relaxed' or 'exact'"):
        trace(lambda x: x, x=(), rules="loose")
    assert trace(lambda x: x * 0.0, x=()).operations == 0
    assert trace(lambda x: x * 0.0, x=(), rules="exact").operations == 1


NUMPY = {
    "matmul": lambda m, v: m @ v,
    "chain": lambda m, v: m @ m.T @ v,
    "cross": lambda m, v: np.cross(m[0], v),
    "einsum": lambda m, v: np.einsum("ij,j->i", m, v),
    "stack": lambda m, v: np.stack([v, m[0]]),
    "concatenate": lambda m, v: np.concatenate([v, m[:, 0]]),
    "sum": lambda m, v: m.sum(axis=0) + v.sum(),
    "prod": lambda m, v: np.prod(v),
    "cumsum": lambda m, v: np.cumsum(v),
    "trace": lambda m, v: np.trace(m),
    "outer": lambda m, v: np.outer(v, v),
    "dot": lambda m, v: np.dot(v, m),
    "block": lambda m, v: np.block([[m, v[:, None]], [v[None], np.ones((1, 1))]]),
    "functions": lambda m, v: (
        np.sin(v)
        + np.cos(v) * np.sqrt(np.abs(v))
        + np.exp(-np.square(v))
        + np.hypot(v, 1.0)
        + np.arctan(v)
        + np.tan(v)
        + np.deg2rad(v)
        + np.rad2deg(v)
        + np.radians(v)
        + np.degrees(v)
        + np.floor(v)
        + np.ceil(v)
        + np.conjugate(v)
        + np.absolute(v)
        + np.negative(v)
        + np.positive(v)
        + np.power(v, 2)
    ),
    "inverse functions": lambda m, v: (
        np.arcsin(v * 0.1) + np.arccos(v * 0.1) + np.log(v * v) + np.arctan2(v, m[0])
    ),
    "scalars of numpy": lambda m, v: np.float64(2.0) * v[0] + v[1] * np.float32(0.5) - np.int64(3) / v[2],
    "numbers on the left": lambda m, v: 2.0 - v + 1 / v + 3 * v + 2.0**v + True * v,
    "in place": lambda m, v: _in_place(m),
    "nested lists": lambda m, v: [[v[0], 1], [2.0, v[1]]],
    "numeric": lambda m, v: nm.vector(
        nm.dot(v, m[0]), *nm.cross(v, m[1]), *nm.apply(m, v), *nm.skew(v).reshape(-1)
    ),
    "elementwise": lambda m, v: nm.where(
        nm.less(v, m[0]), nm.minimum(v, 0.5), nm.maximum(m[0], nm.clip(v, -1, 1))
    ),
    "remainder": lambda m, v: v % 0.75 + v // 0.5 + np.floor_divide(v, 2.0) + np.mod(v, 3.0),
}


def _in_place(m):
    m = m.copy()
    m[0] += m[1]
    m[1, 2] *= 3.0
    return m


@pytest.mark.parametrize("name", NUMPY)
def test_functions_of_numpy_on_traced_arrays(name):
    f = NUMPY[name]
    rng = np.random.default_rng(3)
    m, v = rng.normal(size=(3, 3)), rng.normal(size=3)
    function = trace(f, m=(3, 3), v=(3,))
    expected = np.asarray(f(m, v), float)
    assert function.outputs[0].shape == expected.shape
    np.testing.assert_allclose(function(m, v), expected, rtol=1e-13, atol=1e-13)
    np.testing.assert_allclose(compile(function)(m, v), expected, rtol=1e-13, atol=1e-13)


def test_conditions_combine():
    def f(x):
        a, b = x > 0.0, x < 2.0
        return np.array([a & b, a | b, ~a, a & True, False | b, a & np.bool_(False)], dtype=object)

    function = trace(f, x=())
    assert function(1.0).tolist() == [1, 1, 0, 1, 1, 0]
    assert function(3.0).tolist() == [0, 1, 0, 1, 0, 0]
    assert compile(function)([1.0, 3.0]).tolist() == [[1, 1, 0, 1, 1, 0], [0, 1, 0, 1, 0, 0]]


def test_values_show_what_they_are():
    shown = []
    trace(lambda x: shown.extend([repr(x), repr(np.sin(x)), repr(x < 1.0)]) or x, x=())
    assert shown == ["<traced input #0>", "<traced sin #1>", "<traced lt #3>"]


def test_ports_names_and_signature():
    f = trace(lambda q, m: (m @ q, q[0]), q=3, m=(2, 3), name="both")
    assert f.inputs == (Port("q", (3,)), Port("m", (2, 3)))
    assert f.outputs == (Port("out0", (2,)), Port("out1", ()))
    assert f.signature == "(3),(2,3)->(2),()"
    assert f.name == "both"
    assert trace(lambda q: q, q=2).outputs == (Port("out", (2,)),)


def test_a_function_evaluates_floats_by_interpretation_with_any_leading_axes():
    f = trace(lambda q, x: (q * x, q.sum()), q=(3,), x=())
    q, x = np.arange(6.0).reshape(2, 1, 3), np.arange(4.0)
    first, second = f(q, x)
    np.testing.assert_array_equal(first, q * x[:, None])
    np.testing.assert_array_equal(second, np.broadcast_to(q.sum(-1), (2, 4)))
    assert isinstance(f([1, 2, 3], 2)[1], float)
    assert f(np.zeros((0, 3)), 1.0)[0].shape == (0, 3)
    with pytest.raises(TypeError, match=r"<lambda>|lambda\(q, x\) takes 2 arguments; 1 were given"):
        f(q)
    with pytest.raises(ShapeError, match=r"`q` has shape \(4,\); expected \(..., 3\)"):
        f(np.zeros(4), 1.0)


def test_calls_inside_another_trace_share_nodes():
    unit = trace(lambda v: v / np.sqrt(v @ v), v=(3,))
    f = trace(lambda a: unit(a) + unit(a) * 2.0, a=(3,))
    assert f.operation_counts == {"add": 5, "div": 3, "mul": 6, "sqrt": 1}
    a = np.array([3.0, 4.0, 12.0])
    np.testing.assert_allclose(compile(f)(a), 3 * a / 13, rtol=1e-15)
    scalar = trace(lambda x: (x * 2.0, x + 1.0), x=())
    inner = trace(lambda y: nm.where(scalar(y)[0] < 3.0, *scalar(y)), y=())
    assert [inner(1.0), inner(5.0)] == [2.0, 6.0]
    assert isinstance(Scalar, type)


def test_a_call_may_mix_numbers_and_traced_values():
    f = trace(lambda a, b: a * b[0] + b[1], a=(), b=(2,))
    g = trace(lambda x: f(x, [3.0, 1]) + f(2.0, np.array([x, 0.0])), x=())
    assert g(5.0) == 16.0 + 10.0
    assert g.operations == 4


def test_a_trace_within_a_trace_is_apart():
    def f(x):
        inside = trace(lambda y: nm.loop(lambda v: v < 5.0, lambda v: (v + y,), (y,), 20)[0], y=())
        return inside(x) + nm.loop(lambda v: v < x, lambda v: (v + 1.0,), (0.0,), 20)[0]

    assert compile(f, x=())(2.0) == 6.0 + 2.0


def test_symbols_pass_through():
    sympy = pytest.importorskip("sympy")
    x, y = sympy.symbols("x y", real=True)
    f = trace(
        lambda q: np.array([np.sin(q[0]) * q[1], q[0] / q[1] - 2.0, np.sqrt(q[0]) + np.cos(q[0] * 1.0)]),
        q=(2,),
    )
    got = f(np.array([x, y], dtype=object))
    expected = [sympy.sin(x) * y, x / y - 2, sympy.sqrt(x) + sympy.cos(x)]
    assert [sympy.nsimplify(sympy.simplify(g - e)) for g, e in zip(got, expected, strict=True)] == [0, 0, 0]
    assert sympy.simplify(trace(lambda a: a * a - a, a=())(x) - (x**2 - x)) == 0
    g = trace(lambda q: np.arctan2(q[0], q[1]) + np.exp(q[0]), q=(2,))
    assert sympy.simplify(g(np.array([x, y], dtype=object)) - (sympy.atan2(x, y) + sympy.exp(x))) == 0
    h = trace(lambda a: np.arcsin(a) + np.arccos(a) + np.log(a) + np.tan(a) + abs(a) + np.floor(a), a=())
    assert h(x) == sympy.asin(x) + sympy.acos(x) + sympy.log(x) + sympy.tan(x) + sympy.Abs(x) + sympy.floor(x)
    branches = trace(lambda a: nm.where((a < 1.0) & ~(a == 0.5), nm.minimum(a, 0.25), 2.0), a=())
    got = branches(x)
    assert [got.subs(x, v) for v in (0.0, 0.75, 0.5, 3.0)] == [0.0, 0.25, 2.0, 2.0]
    loop = trace(lambda a: nm.loop(lambda v: v < 1.0, lambda v: (v + 1.0,), (a,), 5)[0], a=())
    with pytest.raises(TraceError, match="has a loop cannot be evaluated on Symbol"):
        loop(x)


def test_symbols_pass_through_what_is_written_with_numeric():
    sympy = pytest.importorskip("sympy")
    x = sympy.symbols("x", real=True)
    assert nm.minimum(x, 1.0) == sympy.Min(x, 1.0)
    assert nm.where(x < 1.0, x, 2.0) == sympy.Piecewise((x, x < 1.0), (2.0, True))


def test_operation_counts():
    f = trace(lambda q: np.sin(q[0]) * np.cos(q[0]) + q[1] ** 3 - nm.minimum(q[0], 2.0), q=(2,))
    assert f.operation_counts == {"add": 1, "cos": 1, "min": 1, "mul": 3, "sin": 1, "sub": 1}
    assert f.operations == 8
    dead = trace(lambda q: (np.exp(q), q)[1], q=(2,))
    assert dead.operations == 0


def test_the_fingerprint_is_that_of_what_is_computed():
    def made(f, **shapes):
        return trace(f, **shapes).fingerprint

    base = made(lambda x, y: x * 2.0 + y, x=(), y=())
    assert base == made(lambda a, b: 2.0 * a + b + 0.0, a=(), b=())
    assert base != made(lambda x, y: x * 2.5 + y, x=(), y=())
    assert base != made(lambda x, y: y * 2.0 + x, x=(), y=())
    assert made(lambda x: x * 1.0, x=()) != made(lambda x: -0.0 + x * 2.0, x=())
    assert made(lambda x: np.array([x, 0.0]), x=()) != made(lambda x: np.array([x, -0.0]), x=())

    def loop(limit, step):
        return lambda x: nm.loop(lambda v: v < 5.0, lambda v: (v + step,), (x,), limit)[0]

    assert made(loop(5, 1.0), x=()) == made(loop(np.int64(5), 1), x=())
    assert made(loop(5, 1.0), x=()) != made(loop(6, 1.0), x=())
    assert made(loop(5, 1.0), x=()) != made(loop(5, 2.0), x=())


def test_numbers_are_conditions_as_for_numpy():
    mask = np.array([1, 0, -2])
    kernel = compile(trace(lambda x: nm.where(mask, x, 0.5) + nm.where(0.0, x[0], 1.0), x=(3,)))
    assert kernel([4.0, 5.0, 6.0]).tolist() == [5.0, 1.5, 7.0]


def test_conditions_are_compared_by_what_they_say():
    """As objects they always differed, and a `where` took its other side."""
    same = {
        "==": lambda a, b: a == b,
        "!=": lambda a, b: a != b,
        "^": lambda a, b: a ^ b,
        "== True": lambda a, b: (a == True) & (np.True_ != b),  # noqa: E712
        "^ False": lambda a, b: False ^ (a ^ b),
    }
    x = np.array([[a, b] for a in (-1.0, 1.0) for b in (-1.0, 1.0)])
    for name, f in same.items():
        kernel = compile(trace(lambda x, f=f: nm.where(f(x[0] > 0.0, x[1] > 0.0), 1.0, 0.0), x=(2,)))
        expected = [float(f(bool(a > 0.0), bool(b > 0.0))) for a, b in x]
        assert kernel(x).tolist() == expected, name
    for wrong in (
        lambda x: (x > 0.0) == 1.0,
        lambda x: {x > 0.0: 1.0}[x > 0.0],
        lambda x: (x > 0.0) in [1, 2],
    ):
        with pytest.raises(TraceError, match="Condition"):
            trace(wrong, x=())


def test_comparisons_are_traced_as_conditions():
    kinds = []
    trace(lambda x: kinds.append(type(x < 1.0)) or x, x=())
    assert kinds == [Condition]


def test_interpretation_refuses_what_kernels_refuse() -> None:
    """Complex numbers lost their imaginary part, masks were ignored, and other errors were those of NumPy."""
    f = trace(lambda q, k: q * k, q=(3,), k=())
    kernel = compile(f)
    one = np.ones(3)
    for arguments in (
        (one * 1j, 2.0),
        (np.ma.array(one, mask=[0, 1, 0]), 2.0),
        (one, None),
        (one, "2"),
        ([[1.0], [1.0, 2.0]], 1.0),
        (np.ones((2, 3)), one),
        (np.ones(4), 1.0),
    ):
        with pytest.raises(InputError) as expected:
            kernel(*arguments)
        with pytest.raises(type(expected.value)) as raised:
            f(*arguments)
        assert str(raised.value).partition(";")[0] == str(expected.value).partition(";")[0]
    numbers_as_objects = f(np.array([1, 2, 3], dtype=object), np.float32(2.0))
    assert numbers_as_objects.dtype == float and numbers_as_objects.tolist() == [2.0, 4.0, 6.0]


@pytest.mark.parametrize("lanes", [0, -1, 3, True, 2.0, "8", None])
def test_lanes_are_a_power_of_two(lanes) -> None:
    with pytest.raises(InputError, match="`lanes` is "):
        trace(lambda q: q * 2.0, lanes=lanes, q=(2,))
