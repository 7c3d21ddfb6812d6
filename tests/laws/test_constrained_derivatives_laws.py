"""Derivatives under constraints are those of the motion, and both forms of the kernel agree."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import ulna
from support.random_models import random_model
from ulna import kernels
from ulna.algorithms import Proximal
from ulna.errors import InputError
from ulna.model import FrameContact, FrameLoop, ModelBuilder, PointContact, PointLoop, Revolute
from ulna.spatial import SE3, Inertia

EXACT = Proximal(mu=0.0)
STEP = 1e-6


ROBOT = ulna.Robot(
    random_model(np.random.default_rng(3), ("revolute", "prismatic"), 9, root="free_flyer", mimics=0)
)
TIPS = [name for name in reversed(ROBOT.model.link_names)][:3]
CASES: dict[str, list[Any]] = {
    "points": [PointContact(TIPS[0]), PointContact(TIPS[1], point=(0.1, 0.2, -0.1))],
    "frame": [FrameContact(TIPS[0])],
    "local frame": [replace(FrameContact(TIPS[0]), axes="local")],
    "local point": [replace(PointContact(TIPS[1]), axes="local")],
    "loop": [PointLoop(TIPS[0], TIPS[1]), PointContact(TIPS[2])],
}


def state(seed: int = 0, robot: ulna.Robot = ROBOT) -> tuple[Any, Any, Any]:
    rng = np.random.default_rng(seed)
    return robot.random_configuration(seed=seed), *rng.standard_normal((2, robot.nv))


def compare_with_differences(robot: ulna.Robot, constraints: list[Any], seed: int = 0) -> None:
    q, v, tau = state(seed, robot)
    derivatives = robot.constraints.forward_dynamics_derivatives(q, v, tau, constraints)

    def motion(dq: Any, dv: Any, dtau: Any) -> Any:
        where = robot.integrate(q, dq)
        return robot.constraints.forward_dynamics(where, v + dv, tau + dtau, constraints, solver=EXACT)

    steps, still = STEP * np.eye(robot.nv), np.zeros((robot.nv, robot.nv))
    for k, name in enumerate(("q", "v", "tau")):
        moved = [steps if j == k else still for j in range(3)]
        ahead, behind = motion(*moved), motion(*(-x for x in moved))
        for part, exact in (("a", f"a_{name}"), ("forces", f"forces_{name}")):
            difference = (getattr(ahead, part) - getattr(behind, part)).T / (2.0 * STEP)
            found = getattr(derivatives, exact)
            assert found.shape == difference.shape
            assert np.abs(found - difference).max() < 1e-6 * max(np.abs(found).max(), 1.0), exact


def arm(builder: ModelBuilder, name: str) -> ModelBuilder:
    """Adds an arm of four joints to the link l0."""
    axes = [Revolute(axis) for axis in ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))]
    for k, kind in enumerate(axes, start=1):
        body = Inertia.from_com(1.0, (0.05, -0.02, 0.08), np.diag([0.1, 0.2, 0.15]))
        builder.add_link(f"{name}{k}", body).add_joint(
            f"{name}j{k}", kind, f"{name}{k - 1}" if k > 1 else "l0", f"{name}{k}", SE3.trans(0.1, 0.2, 0.3)
        )
    return builder


def test_they_are_the_derivatives_of_the_motion_of_an_arm() -> None:
    model = arm(ModelBuilder("arm").add_link("l0"), "l").build()
    compare_with_differences(ulna.Robot(model), [PointContact("l4", point=(0.1, 0.2, -0.1))])


def test_an_arm_without_constraints_keeps_its_derivatives_where_forces_on_another_are_not_unique() -> None:
    model = arm(arm(ModelBuilder("two arms").add_link("l0"), "l"), "r").build()
    robot, rng = ulna.Robot(model), np.random.default_rng(3)
    q, v, tau = rng.standard_normal((3, robot.nv))
    held = [PointContact("l4", point=(0.1, 0.2, -0.1))]
    once = robot.constraints.forward_dynamics_derivatives(q, v, tau, held)
    twice = robot.constraints.forward_dynamics_derivatives(q, v, tau, [*held, *held])
    free = [k for k, name in enumerate(model.joint_names) if name.startswith("r")]
    bound = [k for k in range(robot.nv) if k not in free]
    for name in ("a_q", "a_v", "a_tau"):
        expected, result = getattr(once, name), getattr(twice, name)
        known = np.isfinite(result)
        assert known[np.ix_(free, free)].all()
        assert not known[np.ix_(bound, bound[1:])].any()  # turning all about the vertical changes nothing
        np.testing.assert_allclose(result[known], expected[known], rtol=1e-12, atol=1e-12)
    assert np.isnan(twice.forces_tau[:, bound]).all()


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_they_are_the_derivatives_of_the_motion(case: str) -> None:
    compare_with_differences(ROBOT, CASES[case])


@pytest.mark.slow
def test_a_batch_by_the_graph_has_the_numbers_of_single_calls_by_columns() -> None:
    states = [state(seed) for seed in range(3)]
    together = ROBOT.constraints.forward_dynamics_derivatives(
        *map(np.stack, zip(*states, strict=True)), CASES["frame"]
    )
    assert kernels.kernel(
        ROBOT.model, "constrained_dynamics_derivatives", constraints=tuple(CASES["frame"])
    ).operations
    for k, one in enumerate(states):
        alone = ROBOT.constraints.forward_dynamics_derivatives(*one, CASES["frame"])
        for x, y in zip(together, alone, strict=True):
            assert np.abs(x[k] - y).max() < 1e-11 * max(np.abs(y).max(), 1.0)


@pytest.mark.slow
def test_forces_that_are_not_unique_have_no_derivatives() -> None:
    twice = [PointContact(TIPS[0]), PointContact(TIPS[0])]
    assert np.isnan(ROBOT.constraints.forward_dynamics_derivatives(*state(), twice).a_q).all()


def test_loops_between_frames_are_refused_with_advice() -> None:
    with pytest.raises(InputError, match="FrameLoop; expected contacts and PointLoops.*forward_dynamics"):
        ROBOT.constraints.forward_dynamics_derivatives(*state(), [FrameLoop(TIPS[0], TIPS[1])])
