"""Elementary functions without FMA, 128-bit integers and minimum instructions: below 1 ULP over the whole range."""

from __future__ import annotations

from functools import cache

import llvmlite.binding as llvm
import numpy as np
import pytest
from lane_tools import NUMPY, compiled, module_text, worst_ulp
from test_elementary import EXACT, NUMPY_NAME, like_numpy, pairs, samples
from test_sincos import nearest_to_multiples

from ulna.compiler.codegen.arithmetic import Arithmetic
from ulna.compiler.codegen.elementary import OPERATIONS, elementary_ir
from ulna.compiler.codegen.sincos import BOUND, sincos_ir

mpmath = pytest.importorskip("mpmath")
PLAIN = Arithmetic(fused_multiply_add=False, wide_integers=False, minimum_number=False)
SHAPES = [(1, "double"), (2, "double"), (8, "double"), (1, "float"), (4, "float")]
LIMIT = 0.95


@cache
def function(op, lanes, dtype):
    if op == "sincos":
        return compiled(sincos_ir(lanes, dtype, PLAIN), lanes, dtype, results=2)
    return compiled(elementary_ir(op, lanes, dtype, PLAIN), lanes, dtype, 2 if op == "atan2" else 1)


def check_sincos(lanes, dtype, x):
    x = np.unique(np.asarray(x).astype(NUMPY[dtype]))
    x = np.concatenate([x, -x])
    s, c = function("sincos", lanes, dtype)(x)
    with mpmath.workprec(1300):
        assert worst_ulp(s, mpmath.sin, dtype, x) <= LIMIT
        assert worst_ulp(c, mpmath.cos, dtype, x) <= LIMIT


@pytest.mark.parametrize(("lanes", "dtype"), SHAPES)
def test_sines_of_moderate_and_of_all_arguments(lanes, dtype):
    rng = np.random.default_rng(lanes)
    tops = (0.8, 4.0, 100.0, BOUND[dtype])
    k = np.unique(np.geomspace(1, BOUND[dtype], 40).round())
    multiples = (k * (np.pi / 4)).astype(NUMPY[dtype])
    exponents = np.arange(-1074, 1024, 23) if dtype == "double" else np.arange(-149, 128, 5)
    parts = [*(rng.uniform(0, top, 40) for top in tops), multiples, np.nextafter(multiples, 0)]
    check_sincos(lanes, dtype, np.concatenate([*parts, np.ldexp(1.0, exponents), np.ldexp(1.1, exponents)]))


@pytest.mark.parametrize(("lanes", "dtype"), [(2, "double"), (1, "float")])
def test_sines_of_the_hardest_arguments(lanes, dtype):
    bits, top = (53, 1023) if dtype == "double" else (24, 127)
    exponents = [*range(-bits - 1, 30 - bits), *range(30 - bits, top - bits + 1, 31)]
    with mpmath.workprec(1300):
        hard = [x for e in exponents for x in nearest_to_multiples(e, bits)]
    known = 6381956970095103.0 * 2.0**797 if dtype == "double" else 16367173 * 2.0**72
    check_sincos(lanes, dtype, [*hard, known])


@pytest.mark.parametrize(("lanes", "dtype"), SHAPES)
def test_sines_of_zeros_infinities_and_denormals(lanes, dtype):
    tiny = np.finfo(NUMPY[dtype]).smallest_subnormal
    x = np.array([0.0, -0.0, tiny, -3 * tiny, np.inf, -np.inf, np.nan], NUMPY[dtype])
    s, c = function("sincos", lanes, dtype)(x)
    np.testing.assert_array_equal(s[:4], x[:4])
    np.testing.assert_array_equal(np.signbit(s[:4]), np.signbit(x[:4]))
    np.testing.assert_array_equal(c[:4], np.ones(4))
    assert np.isnan(s[4:]).all() and np.isnan(c[4:]).all()


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


@pytest.mark.parametrize("dtype", ["double", "float"])
def test_values_at_zeros_infinities_and_ends_are_those_of_numpy(dtype):
    kind = np.finfo(NUMPY[dtype])
    ends = np.array(
        [0.0, 1.0, 0.5, kind.tiny, kind.smallest_subnormal, kind.max, np.inf, np.nan], NUMPY[dtype]
    )
    ends = np.concatenate([ends, -ends])
    for op in EXACT:
        if op == "tan":
            continue
        with np.errstate(all="ignore"):
            like_numpy(function(op, 2 if dtype == "double" else 1, dtype)(ends)[0], NUMPY_NAME[op](ends))
    y, x = (part.ravel() for part in np.meshgrid(ends, ends))
    like_numpy(function("atan2", 1, dtype)(y, x)[0], np.arctan2(y, x))


def test_no_instruction_that_is_missing_is_written():
    functions = [sincos_ir(2, "double", PLAIN), sincos_ir(2, "float", PLAIN)]
    functions += [elementary_ir(op, 2, dtype, PLAIN) for op in OPERATIONS for dtype in ("double", "float")]
    text = module_text(*functions)
    llvm.parse_assembly(text).verify()
    assert "llvm.fma" not in text and "i128" not in text
