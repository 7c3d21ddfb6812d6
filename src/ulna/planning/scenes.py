"""A robot in a world, ready to be planned for."""

from __future__ import annotations

from ulna.collision import SphereChecker
from ulna.collision.lanes.moving import links_of
from ulna.collision.lanes.tables import Scene
from ulna.data_classes import dataclass
from ulna.system.cached import cached_property


@dataclass(frozen=True, eq=False)
class PlanningScene(Scene):
    """A scene with the same check in float64: for certificates and messages."""

    @cached_property
    def checker(self) -> SphereChecker:
        """The check in float64."""
        return SphereChecker(
            self.robot.model, self.world, spheres=self.spheres, pairs=self.link_pairs, missing=self.missing,
            tables=bool(self.robot.clearances),
        )  # fmt: skip


def scene(checker: SphereChecker) -> PlanningScene:
    """A robot in a world, ready to be checked by procedures.

    Args:
        checker: The robot, its spheres and the world.

    Returns:
        The scene; its kernel depends on the robot alone, and is kept.

    Raises:
        InputError: If a joint has a configuration that is not one number, or no link with spheres moves.
    """
    robot = links_of(checker.model, checker.spheres, checker.pairs, checker.missing, checker.tables)
    return PlanningScene(robot, checker.spheres, checker.pairs, checker.world, checker.missing)
