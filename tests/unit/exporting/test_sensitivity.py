"""Tolerances of recorded values: small for what is well conditioned, as large as rounding explains elsewhere."""

from __future__ import annotations

import numpy as np
import pytest

import ulna
from ulna import numeric
from ulna.exporting.selection import entries, records
from ulna.exporting.sensitivity import TOLERANCE, compared_outputs, tolerance


def exported(kernel):
    functions, _ = records(None, entries({"f": kernel}), {})
    return functions[0]


@pytest.mark.parametrize("dtype", ["float64", "float32"])
def test_functions_without_cancellation_have_the_usual_tolerance(dtype):
    f = exported(ulna.compile(lambda x: np.sin(x) * x, x=(3,)))
    assert tolerance(f, f.samples, dtype) == TOLERANCE[dtype]


@pytest.mark.parametrize("dtype", ["float64", "float32"])
def test_functions_near_a_singularity_have_a_larger_one(dtype):
    f = exported(ulna.compile(lambda x: 1.0 / (x[0] - 1.0), x=(1,)))
    samples = (np.array([[1.0 + 1e-5]]),)
    bound = tolerance(f, samples, dtype)
    single = 1.0 / (np.float32(samples[0][0, 0]) - np.float32(1.0))
    actual = abs(float(single) - 1e5) / 1e5 if dtype == "float32" else 1e-11
    assert actual < bound < 30 * 1e5 * np.finfo(dtype).eps


def test_all_recorded_values_of_an_operational_inertia_pass(tmp_path):
    robot = ulna.load("panda")
    functions, _ = records(robot.model, entries("operational_inertia"), {})
    assert tolerance(functions[0], functions[0].samples, "float64") > 1e-11


def test_rounds_are_not_compared_in_single_precision():
    def halved(x):
        y, rounds = numeric.loop(lambda y, n: y > 1e-6, lambda y, n: (0.5 * y, n + 1.0), (x, 0.0), 60)
        return y, rounds, rounds + 1.0

    f = exported(ulna.compile(halved, x=()))
    assert compared_outputs(f, "float64") == [True, True, True]
    assert compared_outputs(f, "float32") == [True, False, True]


@pytest.mark.parametrize("dtype", ["float64", "float32"])
def test_iterations_of_constrained_dynamics_are_rounds(dtype):
    robot = ulna.load("panda")
    found = entries("forward_dynamics_with_jacobian")
    (f,), _ = records(robot.model, found, {}, dtype)
    assert compared_outputs(f, dtype) == [True, True, True, dtype == "float64"]
