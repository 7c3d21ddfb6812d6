"""Elementary functions in SIMD lanes: error in ULP, and NumPy's values at zeros, infinities, NaN and ends."""

from __future__ import annotations

import subprocess
import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from lane_tools import NUMPY, compiled, worst_ulp, worst_ulp_extended

from ulna.compiler.codegen.elementary import OPERATIONS, elementary_ir
from ulna.compiler.language.ops import TABLE

mpmath = pytest.importorskip("mpmath")
LIMIT = 0.9
EXACT = {op: getattr(mpmath, op) for op in OPERATIONS if op != "atan2"}
NUMPY_NAME = {row.op.name.lower(): row.numpy for row in TABLE}
SHAPES = [(1, "double"), (4, "double"), (8, "double"), (1, "float"), (16, "float")]


@cache
def function(op, lanes, dtype):
    arguments = 2 if op == "atan2" else 1
    return compiled(elementary_ir(op, lanes, dtype), lanes, dtype, arguments)


def samples(op, dtype, size, rng):
    """Arguments over the whole domain of an operation, with more of them where errors are largest."""
    double = dtype == "double"
    tens = 300 if double else 37
    near_one = 1 - 10.0 ** rng.uniform(-16 if double else -7, 0, size)
    parts = {
        "tan": [rng.uniform(-a, a, size) for a in (0.8, 4.0, 1e4)] + [10.0 ** rng.uniform(-tens, tens, size)],
        "asin": [
            rng.uniform(-1, 1, size),
            rng.uniform(0.49, 0.51, size),
            near_one,
            10.0 ** rng.uniform(-tens, 0, size),
        ],
        "exp": [
            rng.uniform(-1, 1, size),
            rng.uniform(-745, 709, size) if double else rng.uniform(-103, 88, size),
        ],
        "log": [rng.uniform(0.4, 3, size), 10.0 ** rng.uniform(-tens - (23 if double else 7), tens, size)],
        "expm1": [
            rng.uniform(-1, 1, size),
            rng.uniform(-45, 709 if double else 88, size),
            rng.choice([-1, 1], size) * 10.0 ** rng.uniform(-tens, 0, size),
        ],
        "log1p": [
            rng.uniform(-1, 3, size),
            -near_one[near_one < 1 - 1e-7],
            10.0 ** rng.uniform(-tens, tens, size),
            -(10.0 ** rng.uniform(-tens, 0, size)),
        ],
    }
    parts["erf"] = [
        rng.uniform(-1, 1, size),
        rng.uniform(0.7, 1.2, size),
        rng.uniform(-6.5, 6.5, size),
        10.0 ** rng.uniform(-tens, 0, size),
    ]
    parts["sinh"] = parts["expm1"]
    parts["acos"] = parts["asin"]
    return np.concatenate(parts[op]).astype(NUMPY[dtype])


def pairs(dtype, size, rng):
    """Arguments (y, x) of all magnitudes and quadrants, with more of them where a reduction switches."""
    tens = 150 if dtype == "double" else 18
    y, x = rng.normal(size=(2, 4, size))
    y[1] *= 10.0 ** rng.uniform(-30, 18, size)
    y[2], x[2] = y[2] * 10.0 ** rng.uniform(-tens, tens, size), x[2] * 10.0 ** rng.uniform(-tens, tens, size)
    y[3] = x[3] * rng.uniform(0.4, 1.1, size)
    return y.ravel().astype(NUMPY[dtype]), x.ravel().astype(NUMPY[dtype])


@pytest.mark.parametrize(("lanes", "dtype"), SHAPES)
@pytest.mark.parametrize("op", [op for op in OPERATIONS if op != "atan2"])
def test_error(op, lanes, dtype):
    x = samples(op, dtype, 60, np.random.default_rng(lanes))
    with mpmath.workprec(1200):
        assert worst_ulp(function(op, lanes, dtype)(x)[0], EXACT[op], dtype, x) <= LIMIT


@pytest.mark.parametrize(("lanes", "dtype"), SHAPES)
def test_error_of_atan2(lanes, dtype):
    y, x = pairs(dtype, 60, np.random.default_rng(lanes))
    with mpmath.workprec(200):
        assert worst_ulp(function("atan2", lanes, dtype)(y, x)[0], mpmath.atan2, dtype, y, x) <= LIMIT


def like_numpy(got, expected):
    """NaN where NaN; else the same sign, and at most one ULP apart."""
    np.testing.assert_array_equal(np.isnan(got), np.isnan(expected))
    number = ~np.isnan(got)
    got, expected = got[number], expected[number]
    np.testing.assert_array_equal(np.signbit(got), np.signbit(expected))
    equal = got == expected
    assert (np.abs(got[~equal] - expected[~equal]) <= np.spacing(np.abs(expected[~equal]))).all()


def extremes(dtype):
    kind = np.finfo(NUMPY[dtype])
    x = [
        0.0,
        1.0,
        0.5,
        2.0,
        0.3,
        0.9,
        3.0,
        89.0,
        104.0,
        710.0,
        746.0,
        1000.0,
        1e10,
        1e20,
        1e38,
        np.inf,
        np.nan,
    ]
    x += [float(v) for v in (kind.max, kind.tiny, kind.smallest_subnormal, 1 - kind.epsneg, 1 + kind.eps)]
    return np.array([*x, *(-v for v in x)], NUMPY[dtype])


@pytest.mark.parametrize(("lanes", "dtype"), SHAPES)
@pytest.mark.parametrize("op", [op for op in OPERATIONS if op != "atan2"])
def test_special_values(op, lanes, dtype):
    x = extremes(dtype)
    with np.errstate(all="ignore"):
        # NumPy's own functions of float32 may be more than an ULP off.
        expected = NUMPY_NAME[op](x.astype(np.float64)).astype(NUMPY[dtype])
    like_numpy(function(op, lanes, dtype)(x)[0], expected)


@pytest.mark.parametrize(("lanes", "dtype"), SHAPES)
def test_special_values_of_atan2(lanes, dtype):
    y, x = (v.ravel() for v in np.meshgrid(extremes(dtype), extremes(dtype)))
    with np.errstate(all="ignore"):
        expected = np.arctan2(y.astype(np.float64), x.astype(np.float64)).astype(NUMPY[dtype])
    like_numpy(function("atan2", lanes, dtype)(y, x)[0], expected)


def test_exact_points():
    for op, x, value in (("exp", 0.0, 1.0), ("log", 1.0, 0.0), ("acos", 1.0, 0.0), ("acos", -1.0, np.pi)):
        assert function(op, 8, "double")(np.array([x]))[0][0] == value
    assert function("atan2", 8, "double")(np.array([-0.0]), np.array([-1.0]))[0][0] == -np.pi


def test_an_unknown_operation_is_refused():
    with pytest.raises(ValueError, match="'cosh': one of tan, asin"):
        elementary_ir("cosh", 8, "double")


@pytest.mark.slow
def test_committed_constants_are_those_of_the_fit():
    script = Path(__file__).parents[3] / "scripts" / "fit_elementary.py"
    done = subprocess.run([sys.executable, script, "--check"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.slow
@pytest.mark.skipif(np.finfo(np.longdouble).nmant < 63, reason="needs an extended-precision longdouble")
@pytest.mark.parametrize(("lanes", "dtype"), [(8, "double"), (16, "float")])
@pytest.mark.parametrize("op", OPERATIONS)
def test_dense_sweep(op, lanes, dtype):
    rng = np.random.default_rng(9)
    wider = np.longdouble if dtype == "double" else np.float64
    if not isinstance(NUMPY_NAME[op], np.ufunc):  # none of more precision
        x = samples(op, dtype, 10_000, rng)
        with mpmath.workprec(200):
            assert worst_ulp(function(op, lanes, dtype)(x)[0], EXACT[op], dtype, x) <= LIMIT
        return
    if op == "atan2":
        arguments, exact = pairs(dtype, 200_000, rng), np.arctan2
    else:
        x = samples(op, dtype, 200_000, rng)
        arguments, exact = (x[np.abs(x) < 1e4] if op == "tan" else x,), NUMPY_NAME[op]
    expected = exact(*(a.astype(wider) for a in arguments))
    assert worst_ulp_extended(function(op, lanes, dtype)(*arguments)[0], expected, dtype) <= LIMIT
