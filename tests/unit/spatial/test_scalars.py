"""The functions of numeric that spatial leans on, where numbers, traced scalars and symbols meet."""

from __future__ import annotations

import math
import subprocess
import sys
from typing import Any

import numpy as np
import pytest

from ulna import numeric
from ulna.compiler import trace


@pytest.mark.parametrize("name", ["sin", "cos", "sqrt"])
def test_unary_functions_take_mixed_object_arrays(name: str) -> None:
    f = getattr(numeric, name)
    sympy = pytest.importorskip("sympy")
    x = sympy.Symbol("x")
    result = f(np.array([x, 0.5], dtype=object))
    assert result[0] == getattr(sympy, name)(x)
    assert result[1] == getattr(np, name)(0.5)
    traced = trace(lambda t: f(np.array([t, 0.5], dtype=object)), t=())
    np.testing.assert_array_equal(traced(0.25), getattr(np, name)([0.25, 0.5]))


@pytest.mark.parametrize(
    "f",
    [
        lambda t: numeric.arctan2(t, -2.0),
        lambda t: numeric.arctan2(-2.0, t),
        lambda t: numeric.arctan2(np.array([1.0, t], dtype=object), np.array([t, 3.0], dtype=object)),
        lambda t: numeric.arctan2(np.array([1.0, -1.0], dtype=object), -0.5) + t,
        lambda t: numeric.where(numeric.less(t, 0.3), t, -1.0),
        lambda t: numeric.where(numeric.less(0.3, t), np.array([1.0, t], dtype=object), 2.0 * t),
    ],
)
def test_traced_and_plain_numbers_mix(f: Any) -> None:
    for t in (0.25, 0.75):
        np.testing.assert_allclose(trace(f, t=())(t), np.asarray(f(t), dtype=float), rtol=1e-15)


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_the_error_function_has_the_shape_and_type_of_its_argument(dtype: type) -> None:
    x = np.array([[-np.inf, -1.0, -0.0], [0.5, 7.0, np.nan]], dtype)
    y = numeric.erf(x)
    assert y.shape == (2, 3) and y.dtype == dtype
    np.testing.assert_array_equal(y, np.array([[math.erf(v) for v in row] for row in x.tolist()], dtype))
    assert np.signbit(y[0, 2])
    assert numeric.erf(dtype(0.5)).dtype == dtype and numeric.erf(np.zeros((0, 3), dtype)).shape == (0, 3)


def test_the_error_function_of_numbers_and_symbols() -> None:
    assert numeric.erf(1) == math.erf(1.0) and isinstance(numeric.erf(1), float)
    np.testing.assert_array_equal(numeric.erf([1, 2]), [math.erf(1.0), math.erf(2.0)])
    sympy = pytest.importorskip("sympy")
    x = sympy.Symbol("x")
    mixed = numeric.erf(np.array([x, 0.5], dtype=object))
    assert mixed[0] == sympy.erf(x) and mixed[1] == math.erf(0.5)
    assert trace(lambda t: numeric.erf(2.0 * t), t=())(x) == sympy.erf(2.0 * x)
    traced = trace(lambda t: numeric.erf(np.array([t, 0.5], dtype=object)), t=())
    np.testing.assert_array_equal(traced(0.25), numeric.erf([0.25, 0.5]))


def test_cases_of_symbols() -> None:
    sympy = pytest.importorskip("sympy")
    x = sympy.Symbol("x", real=True)
    chosen = numeric.where(numeric.less(x, 1.0), x, 2 * x)
    assert chosen.subs(x, 0.5) == 0.5
    assert chosen.subs(x, 3.0) == 6.0
    assert numeric.where(sympy.Integer(1) < 2, x, 0.0) == x
    assert numeric.arctan2(x, 1.0) == sympy.atan2(x, 1.0)


def test_where_of_numbers_is_a_number() -> None:
    assert isinstance(numeric.where(True, 1.0, 2.0), float)
    np.testing.assert_array_equal(numeric.where(np.array([True, False]), 1.0, 2.0), [1.0, 2.0])


def test_the_first_symbol_of_a_program_warns_of_nothing() -> None:
    pytest.importorskip("sympy")
    program = "import sys, ulna; assert 'sympy' not in sys.modules; import sympy; print(ulna.SE3.rx(sympy.Symbol('a')).rotation[1, 1])"
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", program], capture_output=True, text=True, check=False
    )
    assert (done.stdout.strip(), done.stderr) == ("cos(a)", "")
