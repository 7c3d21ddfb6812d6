"""A robot in a world as the procedures of planning read it: its tables beside those of the obstacles."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from ulna.collision import clearance as gap
from ulna.collision.attached import carried
from ulna.collision.clouds import is_points, point_grid
from ulna.collision.grids import joined
from ulna.collision.lanes.motion_bounds import Group
from ulna.collision.lanes.moving import (
    FARTHEST,
    ROUNDING,
    Moving,
    moving_groups,
)
from ulna.collision.lanes.touching import Tables
from ulna.collision.mask import check_touches
from ulna.collision.objects import Obstacle
from ulna.collision.pairs import LinkPair
from ulna.collision.solids import Missing, obstacle_solid
from ulna.collision.spheres import Spheres
from ulna.collision.world import World
from ulna.compiler.procedures import aligned
from ulna.data_classes import dataclass
from ulna.errors import InputError
from ulna.geometry import Shape
from ulna.spatial import SE3
from ulna.system.cached import cached_property
from ulna.typing import Floats


@dataclass(frozen=True, eq=False)
class Scene:
    """A robot in a world, as machine code checks it.

    Attributes:
        robot: The robot alone.
        spheres: Spheres of its links.
        link_pairs: Pairs of links that are checked against each other.
        world: The obstacles, which stand where the world has them, and what links carry.
        missing: What to do about mesh files that are missing: "error", or "skip" them with a warning.
    """

    robot: Moving
    spheres: Spheres
    link_pairs: tuple[LinkPair, ...]
    world: World
    missing: Missing

    @property
    def lanes(self) -> int:
        """How many configurations are checked at once."""
        return self.robot.kernel.lanes

    @cached_property
    def moving(self) -> Moving:
        """What moves: the links, and what they carry in this world."""
        if not (self.world.attachments or self.world.margins):
            return self.robot
        model = self.robot.model
        carried_bodies = carried(model, self.world, self.spheres, self.missing)
        groups = list(self.robot.groups)
        for name, balls in carried_bodies.spheres.items():
            link = model.link(carried_bodies.carriers[name])
            groups.append(Group(name, link.joint, link.placement @ balls.centres, balls.radii))
        pairs, tables = (*self.link_pairs, *carried_bodies.pairs), self.robot.clearances
        return moving_groups(model, groups, pairs, self.world, self.robot.kernel, tables, self.missing)

    def tables(self, margin: float) -> Tables:
        """The tables, with all spheres larger by a margin.

        Args:
            margin: How much larger [m]; two links are then kept twice as far apart.

        Returns:
            Arrays of the types that the procedures take.
        """
        pairs = self.moving.pair_tables(margin)
        return self._tables_of(margin + self.moving.rounding, pairs)

    def check_tables(self, reach: float, rounding: float) -> Tables:
        """The tables for checks of configurations, in which a reach counts once between two links, too.

        Args:
            reach: How near counts as touching [m].
            rounding: 1.0 for spheres that are larger by what float32 may place them wrongly, -1.0 for smaller ones
                [-].

        Returns:
            Arrays of the types that the procedures take.
        """
        pairs = self.moving.pair_tables(reach)
        margins = pairs["pair_margins"] - np.float32(reach)
        return self._tables_of(reach + rounding * self.moving.rounding, {**pairs, "pair_margins": margins})

    def _tables_of(self, by: float, pairs: dict[str, Any]) -> Tables:
        """The tables, with all spheres larger by a length [m]."""
        grids = self.moving.grids(pairs, by)
        larger_ones = self.moving.larger_spheres(by)
        return Tables(**{**self.moving.tables, **pairs, **self._obstacles, **larger_ones, "grids": grids})

    @cached_property
    def _obstacles(self) -> dict[str, Any]:
        """The tables of obstacles, by name."""
        rows = self._rows()
        boxes, cylinders, planes = (
            np.array([row[1] for row in rows if row[0] == kind]).reshape(-1, gap.WIDTH[kind])
            for kind in ("box", "cylinder", "plane")
        )
        masks = {kind: [row[2] for row in rows if row[0] == kind] for kind in ("box", "cylinder", "plane")}
        extents = np.concatenate([_box_extents(boxes), _cylinder_extents(cylinders)], axis=1)
        farthest = max(np.abs(extents).max(initial=0.0), np.abs(planes[:, 3:]).max(initial=0.0))
        _check_float32_range("", farthest)
        groups, count = len(self.moving.groups), extents.shape[1]
        columns = -(-count // self.lanes) * self.lanes
        filled = np.full((6, columns), np.inf, np.float32)
        filled[3:] = -np.inf
        filled[:3, :count], filled[3:, :count] = extents[:3] - ROUNDING / 2.0, extents[3:] + ROUNDING / 2.0
        padded = np.zeros((groups, columns), np.float32)
        padded[:, :count] = np.array(masks["box"] + masks["cylinder"]).reshape(count, groups).T
        return {
            **self._clouds, "boxes": boxes.astype(np.float32), "cylinders": cylinders.astype(np.float32),
            "extents": aligned(filled), "masks": aligned(padded), "planes": planes.astype(np.float32),
            "plane_masks": np.array(masks["plane"], np.float32).reshape(len(planes), groups).T.copy(),
        }  # fmt: skip

    @cached_property
    def _clouds(self) -> dict[str, Any]:
        """The tables of obstacles that are points, by name."""
        names = [group.name for group in self.moving.groups]
        placed, margins = [], []
        for obstacle in self.world:
            if not is_points(obstacle.shape):
                continue
            solid = obstacle_solid(obstacle, self.missing)
            if solid is not None:
                _check_float32_range(
                    obstacle.name, np.abs(obstacle.pose @ solid.vertices).max() + solid.rounding
                )
                placed.append((point_grid(solid), obstacle.pose.matrix()))
                margins.append(
                    [
                        self.world.margin(name, obstacle.name) if self._is_checked(obstacle, name) else -1.0
                        for name in names
                    ]
                )
        table = np.array(margins, np.float32).reshape(-1, len(names)).T.copy()
        return {"clouds": joined(placed), "cloud_margins": table}

    def _rows(self) -> list[tuple[gap.Kind, Floats, list[bool]]]:
        """By obstacle the formula, its numbers, and which groups it is checked against."""
        names = [group.name for group in self.moving.groups]
        rows = []
        for part, partners in self.moving.fixed_parts:
            rows += self._with_margins(part, SE3.identity(), names, [name in partners for name in names])
        check_touches(self.robot.model, self.world)
        for obstacle in self.world:
            if is_points(obstacle.shape):
                continue
            mask = [self._is_checked(obstacle, name) for name in names]
            for part in _shape_parts(obstacle.shape, self.missing):
                named = gap.Part(obstacle.name, part.kind, part.placement, part.sizes)
                rows += self._with_margins(named, obstacle.pose, names, mask)
        return rows

    def _is_checked(self, obstacle: Obstacle, name: str) -> bool:
        """Whether an obstacle is checked against a link or an attached object."""
        if name in obstacle.touches:
            return False
        return not any(name == a.name and obstacle.name in a.touches for a in self.world.attachments)

    def _with_margins(
        self, part: gap.Part, pose: SE3, names: Sequence[str], mask: list[bool]
    ) -> list[tuple[gap.Kind, Floats, list[bool]]]:
        """A part, once for each distance that groups must keep from it."""
        if not self.world.margins:
            return [(part.kind, gap.row(part, pose), mask)]
        margins = [self.world.margin(part.owner, name) for name in names]
        return [
            (
                part.kind,
                gap.row(part.grown(margin), pose),
                [is_checked and m == margin for is_checked, m in zip(mask, margins, strict=True)],
            )
            for margin in sorted(set(margins))
        ]


@lru_cache(maxsize=4096)
def _shape_parts(shape: Shape, missing: Missing) -> tuple[gap.Part, ...]:
    """The parts of a shape that formulas know."""
    return gap.parts(World().add("obstacle", shape), missing)


def _check_float32_range(name: str, farthest: float) -> None:
    """Raises where an obstacle is too far away for float32."""
    if farthest > FARTHEST:
        raise InputError(
            f"{f'Obstacle {name!r}' if name else 'An obstacle'} reaches {farthest:.3g} m from the origin; planning "
            f"takes at most {FARTHEST:g} m. Look at the units, or place the base nearer to the origin; a floor can "
            "be a Plane, and of a scan keep what is near: points[np.linalg.norm(points, axis=1) < 5.0]."
        )


def _box_extents(boxes: Floats) -> Floats:
    """Least and greatest coordinates of rounded boxes, shape (6, n) [m]."""
    R, t, h, m = boxes[:, :9].reshape(-1, 3, 3), boxes[:, 9:12], boxes[:, 12:15], boxes[:, 15:]
    half = (np.abs(R) @ h[:, :, None])[..., 0] + m
    return np.concatenate([t - half, t + half], axis=1).T


def _cylinder_extents(cylinders: Floats) -> Floats:
    """Least and greatest coordinates of cylinders, shape (6, n) [m]."""
    axis, t, r, half_length = cylinders[:, :3], cylinders[:, 3:6], cylinders[:, 6:7], cylinders[:, 7:8]
    half = half_length * np.abs(axis) + r * np.sqrt(np.maximum(1.0 - axis**2, 0.0))
    return np.concatenate([t - half, t + half], axis=1).T
