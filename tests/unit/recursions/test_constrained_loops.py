"""Robots under constraints by loops: the numbers of traced kernels, and the equations of motion of long robots."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest

import ulna
from support.long_robots import configurations, long_robot
from support.random_models import random_model
from ulna import kernel_options, kernels
from ulna.algorithms import Proximal
from ulna.errors import ModelError
from ulna.model import FrameContact, FrameLoop, Model, PointContact, PointLoop
from ulna.spatial import SE3

TURN = SE3.trans(0.1, -0.2, 0.3) @ SE3.rx(0.4)


def robots() -> dict[str, Model]:
    rng = np.random.default_rng(7)
    return {
        "all kinds": random_model(rng, root="free_flyer", mimics=0),
        "mimic joints": random_model(rng, ("revolute", "prismatic", "helical"), 9, root="planar", mimics=4),
        "on the ground": long_robot(12, 0.2),
        "coupled": long_robot(16, 0.2, coupled=5),
    }


ROBOTS = robots()


def constraints(model: Model) -> dict[str, tuple[Any, ...]]:
    """Constraints of every kind, of the tips and, where it has a link, of the world."""
    if "l0" in model.frame_names:
        return {"with the world": (PointLoop("l0", "l5"), FrameLoop("l12", "l0", TURN))}
    return {
        "points": (PointContact("tip", (0.1, 0.0, 0.2)), PointContact("side", axes="local")),
        "a frame": (FrameContact("tip", TURN, axes="local"),),
        "loops": (PointLoop("tip", "side"), PointContact("tip")),
        "a loop of frames": (FrameLoop("tip", "side", TURN, axes="local"),),
    }


CASES = [(robot, bound) for robot in ROBOTS for bound in constraints(ROBOTS[robot])]


def arguments(model: Model, name: str, options: dict[str, Any], batch: int) -> list[Any]:
    """Random arrays for a kernel, with a batch."""
    rng = np.random.default_rng(3)
    quantity, chosen = kernel_options.choose(name, options)
    made: dict[str, Any] = {"q": configurations(model, rng, batch)}
    made["anchors"] = np.broadcast_to(
        TURN.matrix(), (batch, *kernel_options.shapes_of(model, quantity, chosen).get("anchors", (0, 4, 4)))
    )
    made["restitution"] = rng.uniform(0.1, 0.9, (batch, len(options["constraints"])))
    made["gains"] = rng.uniform(1.0, 20.0, (batch, len(options["constraints"]), 2))
    shapes = kernel_options.shapes_of(model, quantity, chosen)
    return [made.get(key, rng.standard_normal((batch, *shape))) for key, shape in shapes.items()]


def kinds_of(name: str, frame: str) -> list[dict[str, Any]]:
    """Options of a quantity that are tried."""
    if name == "constrained_dynamics":
        friction = {"friction": True, "forces": (frame,)}
        return [{}, {"stabilised": True}, friction, {"solver": Proximal(mu=0.0)}]
    return [{"elastic": False}, {"elastic": True}] if name == "impulse_dynamics" else [{}]


@pytest.mark.parametrize(("robot", "bound"), CASES)
@pytest.mark.parametrize(
    "name",
    [
        "constrained_dynamics",
        "impulse_dynamics",
        "delassus_matrix",
        "constraint_jacobian",
        "constraint_velocity",
        "constraint_bias",
        "constraint_error",
    ],
)
def test_the_numbers_are_those_of_the_traced_function(robot: str, bound: str, name: str) -> None:
    model = ROBOTS[robot]
    for more in kinds_of(name, model.tool):
        options = {"constraints": constraints(model)[bound], **more}
        arrays = arguments(model, name, options, 3)
        looped = kernels.looped(model, name, **options)
        assert looped is not None
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            expected = kernels.function(model, name, **options)(*arrays)
        found = looped(*arrays)
        many = expected if isinstance(expected, tuple) else (expected,)
        J = kernels.function(model, "constraint_jacobian", constraints=options["constraints"])(arrays[0])
        dependent = np.linalg.matrix_rank(J, tol=1e-9).min() < J.shape[-2]
        tolerance = 1e-5 if dependent else 1e-9  # forces of dependent constraints are less precise
        for k, (x, y) in enumerate(zip(found if isinstance(found, tuple) else (found,), many, strict=True)):
            assert x.shape == y.shape
            if k < 2:  # the residual is rounding, and rounds may differ by it
                assert np.abs(x - y).max() <= tolerance * max(np.abs(y).max(), 1.0), (options, k)
        assert len(many) == 1 or dependent or found[2].max() <= 1e-9


@pytest.mark.parametrize(("joints", "branching"), [(60, 0.0), (100, 0.3)])
def test_long_robots_obey_the_equations_of_motion(
    joints: int, branching: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(kernels, "LOOPED_ABOVE", 0)
    robot = ulna.Robot(long_robot(joints, branching))
    rng = np.random.default_rng(joints)
    q = configurations(robot.model, rng, 1)[0]
    v, tau = rng.standard_normal((2, robot.model.nv)) / np.sqrt(joints)
    held = [FrameContact(f"l{joints}"), PointLoop(f"l{joints // 2}", "l0")]
    motion = robot.constraints.forward_dynamics(q, v, tau, held)
    J, bias = robot.constraints.jacobian(q, held), robot.constraints.bias(q, v, held)
    scale = np.abs(motion.a).max()
    assert np.abs(J @ motion.a + bias).max() <= 1e-9 * scale
    torques = robot.inverse_dynamics(q, v, motion.a) - J.T @ motion.forces
    assert np.abs(torques - tau).max() <= 1e-9 * np.abs(motion.forces).max()
    assert "loops over" in repr(robot.kernel("constrained_dynamics", constraints=tuple(held)))
    impact = robot.constraints.impulse_dynamics(q, v, held)
    assert np.abs(J @ impact.v).max() <= 1e-9
    gained = robot.mass_matrix(q) @ (impact.v - v)
    assert np.abs(gained - J.T @ impact.impulses).max() <= 1e-9 * np.abs(gained).max()


def test_a_robot_without_inertia_is_refused() -> None:
    builder = ulna.ModelBuilder("ghost").add_link("base").add_link("tip")
    model = builder.add_joint("j", ulna.model.Revolute((0.0, 0.0, 1.0)), "base", "tip").build()
    with pytest.raises(ModelError, match="nothing they move has mass"):
        kernels.kernel(model, "delassus_matrix", constraints=(PointContact("tip", (0.1, 0.0, 0.0)),))
