"""The paired sine and cosine in SIMD lanes: error in ULP over the whole range, special values, hard cases."""

from __future__ import annotations

import subprocess
import sys
from functools import cache
from pathlib import Path

import llvmlite.binding as llvm
import numpy as np
import pytest
from lane_tools import NUMPY, compiled, module_text, worst_ulp, worst_ulp_extended

from ulna.compiler.codegen.sincos import BOUND, sincos_ir

mpmath = pytest.importorskip("mpmath")
SHAPES = [
    (1, "double"),
    (3, "double"),
    (4, "double"),
    (8, "double"),
    (1, "float"),
    (8, "float"),
    (16, "float"),
]
NATIVE = [(1, "double"), (8, "double"), (16, "float")]


@cache
def sincos(lanes, dtype):
    return compiled(sincos_ir(lanes, dtype), lanes, dtype, results=2)


@pytest.fixture(autouse=True)
def _precision():
    with mpmath.workprec(1300):  # enough to reduce the largest double
        yield


def check(lanes, dtype, x, limit=1.0):
    with np.errstate(over="ignore"):
        x = np.asarray(x).astype(NUMPY[dtype])
    x = np.unique(x[np.isfinite(x)])
    x = np.concatenate([x, -x])
    s, c = sincos(lanes, dtype)(x)
    assert worst_ulp(s, mpmath.sin, dtype, x) <= limit
    assert worst_ulp(c, mpmath.cos, dtype, x) <= limit


def nearest_to_multiples(exponent, bits):
    """The floats m 2^exponent, m of `bits` bits, nearest to multiples of pi/2, from a continued fraction.

    Kahan's search; Muller, Elementary Functions, 3rd ed., section 11.3.
    """
    found, fraction = [], mpmath.ldexp(1, exponent) * 2 / mpmath.pi
    p0, q0, p1, q1 = 0, 1, 1, 0
    while True:
        a = int(mpmath.floor(fraction))
        p0, q0, p1, q1 = p1, q1, a * p1 + p0, a * q1 + q0
        if q1 >= 2**bits:
            return found
        for m in (
            q1,
            *(q1 * k for k in (2, 3) if q1 * k < 2**bits),
            *((q1 + q0,) if q1 + q0 < 2**bits else ()),
        ):
            if m >= 2 ** (bits - 1):
                found.append(float(m) * 2.0**exponent)
        fraction = 1 / (fraction - a)


@pytest.mark.parametrize(("lanes", "dtype"), SHAPES)
def test_moderate_arguments(lanes, dtype):
    rng = np.random.default_rng(lanes)
    check(
        lanes,
        dtype,
        np.concatenate([rng.uniform(0, top, 60) for top in (0.8, 4.0, 100.0, BOUND[dtype])]),
        0.85,
    )


@pytest.mark.parametrize(("lanes", "dtype"), NATIVE)
def test_near_multiples_of_quarter_pi(lanes, dtype):
    k = np.unique(np.geomspace(1, BOUND[dtype], 80).round())
    x = (k * (np.pi / 4)).astype(NUMPY[dtype])
    check(lanes, dtype, np.concatenate([x, np.nextafter(x, 0), np.nextafter(x, np.inf)]), 0.85)


@pytest.mark.parametrize(("lanes", "dtype"), NATIVE)
def test_hardest_arguments(lanes, dtype):
    bits, top = (53, 1023) if dtype == "double" else (24, 127)
    exponents = [*range(-bits - 1, 30 - bits), *range(30 - bits, top - bits + 1, 31)]
    hard = [x for e in exponents for x in nearest_to_multiples(e, bits)]
    assert len(hard) > 10
    known = [
        6381956970095103.0 * 2.0**797,
        5319372648326541.0 * 2.0**-48,
        float.fromhex("0x1.921fb54442d18p+1"),
    ]
    known += [float.fromhex("0x1.921fb54442d18p+0"), 16367173 * 2.0**72, float.fromhex("0x1.921fb6p+1")]
    check(lanes, dtype, [*hard, *known])


@pytest.mark.parametrize(("lanes", "dtype"), NATIVE)
def test_whole_range_of_exponents(lanes, dtype):
    exponents = np.arange(-1074, 1024, 13) if dtype == "double" else np.arange(-149, 128, 3)
    check(lanes, dtype, np.concatenate([np.ldexp(1.0, exponents), np.ldexp(1.1, exponents)]))


@pytest.mark.parametrize(("lanes", "dtype"), SHAPES)
def test_tiny_arguments_are_exact(lanes, dtype):
    kind = np.finfo(NUMPY[dtype])
    x = np.array(
        [kind.smallest_subnormal, 3 * kind.smallest_subnormal, kind.tiny, 1.5 * kind.tiny], NUMPY[dtype]
    )
    x = np.concatenate([x, -x])
    s, c = sincos(lanes, dtype)(x)
    np.testing.assert_array_equal(s, x)
    np.testing.assert_array_equal(c, np.ones_like(x))


@pytest.mark.parametrize(("lanes", "dtype"), SHAPES)
def test_special_values(lanes, dtype):
    s, c = sincos(lanes, dtype)(np.array([0.0, -0.0, np.inf, -np.inf, np.nan, 1.0], NUMPY[dtype]))
    assert s[0] == 0.0 and not np.signbit(s[0])
    assert s[1] == 0.0 and np.signbit(s[1])
    np.testing.assert_array_equal(c[:2], [1.0, 1.0])
    assert np.isnan(s[2:5]).all() and np.isnan(c[2:5]).all()
    assert s[5] == pytest.approx(np.sin(1.0)) and c[5] == pytest.approx(np.cos(1.0))


@pytest.mark.parametrize(("lanes", "dtype"), [(8, "double"), (16, "float")])
def test_a_lane_does_not_depend_on_its_neighbours(lanes, dtype):
    rng = np.random.default_rng(5)
    x = rng.uniform(-10, 10, lanes).astype(NUMPY[dtype])
    alone = sincos(1, dtype)(x)
    for neighbour in (x[0], NUMPY[dtype](1e9), NUMPY[dtype](np.inf), NUMPY[dtype](np.nan)):
        mixed = x.copy()
        mixed[0::3] = neighbour
        beside = sincos(lanes, dtype)(mixed)
        for one, other in zip(alone, beside, strict=True):
            keep = np.arange(lanes) % 3 != 0
            np.testing.assert_array_equal(one[keep], other[keep])


def test_scalar_and_vector_functions_share_a_module():
    text = module_text(*(sincos_ir(lanes, dtype) for lanes, dtype in SHAPES))
    module = llvm.parse_assembly(text)
    module.verify()
    assert {f.name for f in module.functions} >= {
        "ulna.sincos.f64",
        "ulna.sincos.v8f64",
        "ulna.sincos.v16f32",
    }


def test_an_unknown_format_is_refused():
    with pytest.raises(ValueError, match="half"):
        sincos_ir(8, "half")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="lanes=0"):
        sincos_ir(0, "double")


def test_committed_constants_are_those_of_the_fit():
    script = Path(__file__).parents[3] / "scripts" / "fit_sincos.py"
    done = subprocess.run([sys.executable, script, "--check"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.slow
@pytest.mark.skipif(np.finfo(np.longdouble).nmant < 63, reason="needs an extended-precision longdouble")
@pytest.mark.parametrize(("lanes", "dtype"), NATIVE)
def test_dense_sweep(lanes, dtype):
    rng = np.random.default_rng(7)
    wider = np.longdouble if dtype == "double" else np.float64
    for top in (0.8, 4.0, 100.0, 1e4, BOUND[dtype]):
        x = rng.uniform(-top, top, 500_000).astype(NUMPY[dtype])
        s, c = sincos(lanes, dtype)(x)
        assert worst_ulp_extended(s, np.sin(x.astype(wider)), dtype) <= 0.85
        assert worst_ulp_extended(c, np.cos(x.astype(wider)), dtype) <= 0.85
