"""A joint with one angle that is a chain of turns, and follows another joint: its turns do so by their own multiples."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
import pytest

from support.random_models import random_inertia, random_pose
from ulna import Robot, kernels
from ulna.algorithms.multibody.tree import steps
from ulna.data_classes import dataclass
from ulna.ik.analytic.chain import arm_of
from ulna.model import Coordinate, Model, ModelBuilder, Revolute
from ulna.model.joints.joint_kind import angle
from ulna.model.joints.turn_chain import Turn, TurnChain


@dataclass(frozen=True)
class Bend(TurnChain):
    """Bends by three quarters of the angle, and by the last quarter further on."""

    name: ClassVar[str] = "bend"
    symbol: ClassVar[str] = "B"
    coordinates: ClassVar[tuple[Coordinate, ...]] = (angle(),)

    def describe(self) -> str:
        return "bend"

    @property
    def turns(self) -> tuple[Turn, ...]:
        y = Revolute((0.0, 1.0, 0.0))
        return Turn(0.0, y, 0, 0.75), Turn(0.2, y, 0, 0.25)


@pytest.fixture(scope="module")
def model() -> Model:
    rng = np.random.default_rng(4)
    builder = ModelBuilder("finger").add_link("base")
    for k, (kind, mimic) in enumerate(
        [(Revolute((0.0, 0.0, 1.0)), None), (Bend(), ("0", -0.8, 0.4)), (Revolute((1.0, 0.0, 0.0)), None)]
    ):
        parent = f"link{k - 1}" if k else "base"
        builder.add_link(f"link{k}", random_inertia(rng))
        builder.add_joint(str(k), kind, parent, f"link{k}", random_pose(rng), mimic=mimic)
    return builder.set_tool("link2").build()


def test_turns_follow_by_their_own_multiples(model: Model) -> None:
    turns = [step for step in steps(model) if step.joint.mimic is not None]
    np.testing.assert_allclose([step.multiplier for step in turns], [-0.6, -0.2], atol=1e-15)
    np.testing.assert_allclose([step.shift for step in turns], [0.3, 0.1], atol=1e-15)
    arm = arm_of(model, model.frame("link2"), ("0", "1"), np.zeros(2))
    np.testing.assert_allclose([axis.scale for axis in arm.axes], [1.0, -0.6, -0.2], atol=1e-15)
    np.testing.assert_allclose([axis.offset for axis in arm.axes], [0.0, 0.3, 0.1], atol=1e-15)


def test_velocities_are_those_of_the_poses(model: Model) -> None:
    robot, q, v, h = Robot(model), np.array([0.5, -0.3]), np.array([0.7, 1.1]), 1e-6
    ahead, behind = (robot.fk(q + s * v)[:3, 3] for s in (h, -h))
    np.testing.assert_allclose((robot.jacobian(q) @ v)[:3], (ahead - behind) / (2 * h), atol=1e-8)
    a = np.array([0.4, -2.0])
    np.testing.assert_allclose(robot.forward_dynamics(q, v, robot.inverse_dynamics(q, v, a)), a, atol=1e-10)
    energies = [robot.kinetic_energy(q, v), 0.5 * v @ robot.mass_matrix(q) @ v]
    np.testing.assert_allclose(energies[0], energies[1], rtol=1e-12)


@pytest.mark.parametrize("name", ["fk", "jacobian", "inverse_dynamics", "mass_matrix"])
def test_loops_over_a_table_give_the_same(model: Model, name: str) -> None:
    rng = np.random.default_rng(2)
    looped, traced = kernels.looped(model, name), kernels.function(model, name)
    assert looped is not None
    arrays = [rng.uniform(-1.0, 1.0, (5, 2)) for _ in kernels.QUANTITIES[name].arrays]
    np.testing.assert_allclose(looped(*arrays), traced(*arrays), atol=1e-12)
