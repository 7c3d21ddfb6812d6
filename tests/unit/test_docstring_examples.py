"""The examples in the docstrings of the names that are used most run, and print what they say."""

from __future__ import annotations

import doctest

import numpy as np
import pytest

import ulna

NAMES = [
    "ulna.Robot.analytical_jacobian",
    "ulna.Robot.attach",
    "ulna.Robot.bias_forces",
    "ulna.Robot.center_of_mass",
    "ulna.Robot.collides",
    "ulna.Robot.coriolis_matrix",
    "ulna.Robot.difference",
    "ulna.Robot.distance",
    "ulna.Robot.fk",
    "ulna.Robot.forward_dynamics",
    "ulna.Robot.frame_acceleration",
    "ulna.Robot.frame_velocity",
    "ulna.Robot.function",
    "ulna.Robot.gravity_forces",
    "ulna.Robot.ik",
    "ulna.Robot.ik_all",
    "ulna.Robot.ik_free",
    "ulna.Robot.integrate",
    "ulna.Robot.interpolate",
    "ulna.Robot.inverse_dynamics",
    "ulna.Robot.inverse_mass_matrix",
    "ulna.Robot.jacobian",
    "ulna.Robot.jacobian_dot",
    "ulna.Robot.kernel",
    "ulna.Robot.kinetic_energy",
    "ulna.Robot.link_poses",
    "ulna.Robot.lock",
    "ulna.Robot.manipulability",
    "ulna.Robot.mass_matrix",
    "ulna.Robot.plan",
    "ulna.Robot.random_configuration",
    "ulna.Robot.static_torque",
    "ulna.Robot.with_configuration",
    "ulna.Robot.with_payload",
    "ulna.Robot.with_tool",
    "ulna.SE3.distance",
    "ulna.SE3.from_rpy",
    "ulna.SE3.interpolate",
    "ulna.SE3.looking_at",
    "ulna.SE3.pointing",
    "ulna.SE3.pointing_down",
    "ulna.compile",
    "ulna.control.computed_torque",
    "ulna.control.joint_pd",
    "ulna.diagnosis.diagnose",
    "ulna.identification.base_parameters",
    "ulna.load",
    "ulna.p_servo",
    "ulna.sim.simulate",
    "ulna.trajectory.check",
    "ulna.trajectory.minimum_jerk",
    "ulna.trajectory.pose_line",
    "ulna.trajectory.quintic",
    "ulna.trajectory.time_optimal",
    "ulna.trajectory.trapezoidal",
]


@pytest.mark.parametrize("name", NAMES)
def test_examples_run(name: str) -> None:
    if name in ("ulna.Robot.collides", "ulna.Robot.distance", "ulna.Robot.ik_free"):
        pytest.importorskip("coal")
    value = ulna
    for part in name.split(".")[1:]:
        value = getattr(value, part)
    finder = doctest.DocTestFinder(recurse=False)
    runner = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE)
    (example,) = finder.find(value, name, globs={"ulna": ulna, "np": np})
    assert example.examples, f"{name} has no example"
    assert runner.run(example).failed == 0
