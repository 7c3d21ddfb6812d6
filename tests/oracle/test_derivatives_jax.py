"""Gradients, Jacobians, Hessians and products with them beside JAX, on random functions."""

from __future__ import annotations

import operator
from typing import Any

import numpy as np
import pytest

from ulna import numeric
from ulna.compiler import trace

jax = pytest.importorskip("jax")

ONE = ("sin", "cos", "arctan", "exp", "root", "log", "square", "absolute")
TWO = (operator.add, operator.sub, operator.mul, operator.truediv, "arctan2", "minimum", "maximum", "choose")


def apply(np_, where, name, *x):
    """An operation in one of the two libraries; arguments of partial functions are moved into their domains."""
    special = {
        "root": lambda a: np_.sqrt(a * a + 0.3),
        "log": lambda a: np_.log(1.2 + a * a),
        "exp": lambda a: np_.exp(-(a * a)),
        "absolute": lambda a: abs(a),
        "choose": lambda a, b: where(a < b, a * b, b - np_.sin(a)),
        "minimum": lambda a, b: where(a < b, a, b),
        "maximum": lambda a, b: where(a < b, b, a),
    }
    if callable(name):
        return name(x[0], x[1] * x[1] + 0.7) if name is operator.truediv else name(*x)
    return special[name](*x) if name in special else getattr(np_, name)(*x)


def random_function(seed: int, inputs: int, outputs: int, size: int):
    """A function of a vector of numbers, as a list of operations on earlier values, and how to evaluate it."""
    rng = np.random.default_rng(seed)
    program = []
    for k in range(size):
        names = ONE if rng.random() < 0.4 else TWO
        arguments = rng.integers(0, inputs + k, size=1 if names is ONE else 2)
        program.append((names[rng.integers(len(names))], tuple(map(int, arguments))))

    def run(np_, where, x):
        values = [x[k] for k in range(inputs)]
        for name, arguments in program:
            values.append(apply(np_, where, name, *(values[a] for a in arguments)))
        return values[-1] if outputs == 1 else np_.stack(values[-outputs:])

    return run


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(12))
def test_random_functions(seed):
    inputs, outputs = 4, 1 if seed % 2 else 3
    run = random_function(seed, inputs, outputs, 25)
    f = trace(lambda x: run(np, numeric.where, x), x=(inputs,))
    with jax.enable_x64(True):
        import jax.numpy as jnp

        def theirs(x):
            return run(jnp, jnp.where, x)

        rng = np.random.default_rng(seed)
        x, d = rng.normal(size=(2, inputs))
        jacobian, hessian = jax.jacobian(theirs)(x), jax.hessian(theirs)(x)
        if not np.isfinite(hessian).all():
            pytest.skip("the random function is outside its domain")
        near: Any = {"rtol": 1e-9, "atol": 1e-10 * max(1.0, float(abs(hessian).max()))}
        np.testing.assert_allclose(f(x), theirs(x), rtol=1e-12, atol=1e-12)
        np.testing.assert_allclose(f.jacobian()(x), jacobian, **near)
        np.testing.assert_allclose(f.hessian()(x), hessian, **near)
        if outputs == 1:
            value, gradient = f.value_and_gradient()(x)
            np.testing.assert_allclose(value, theirs(x), rtol=1e-12, atol=1e-12)
            np.testing.assert_allclose(gradient, jacobian, **near)
            np.testing.assert_allclose(f.hvp()(x, d), hessian @ d, **near)
