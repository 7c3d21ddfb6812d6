"""Kinematics on SymPy symbols: the formulas that come out, evaluated, are what plain floats give."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from support.random_models import KINDS, random_model
from ulna import algorithms as alg
from ulna.model import Frame, Model

sympy = pytest.importorskip("sympy")

FUNCTIONS: dict[str, Callable[[Model, Frame, Any, Any], Any]] = {
    "pose": lambda m, f, q, v: alg.frame_pose(m, q, f).matrix(),
    "jacobian": lambda m, f, q, v: alg.frame_jacobian(m, q, f, "local"),
    "acceleration": lambda m, f, q, v: alg.frame_acceleration(m, q, v, None, f).vector(),
    "integrate": lambda m, f, q, v: alg.integrate(m, q, v),
}


@pytest.mark.parametrize("kind", KINDS)
def test_symbols_equal_floats(kind: str) -> None:
    rng = np.random.default_rng(1)
    model = random_model(rng, (kind,), mimics=0)
    tip = model.frame("tip")
    symbols = sympy.symbols(f"q:{model.nq}", real=True), sympy.symbols(f"v:{model.nv}", real=True)
    q, v = (np.array(s, dtype=object) for s in symbols)
    x, y = alg.random(model, rng), rng.standard_normal(model.nv)
    for name, f in FUNCTIONS.items():
        formulas = f(model, tip, q, v)
        evaluate = sympy.lambdify(symbols, formulas.ravel().tolist(), cse=True)
        expected = f(model, tip, x, y)
        np.testing.assert_allclose(
            np.reshape(evaluate(x, y), expected.shape), expected, atol=1e-13, err_msg=name
        )
