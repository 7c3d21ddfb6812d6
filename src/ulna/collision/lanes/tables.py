"""A robot in a world as the procedures of planning read it: one kernel of poses, and tables of numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from ulna.algorithms import joint_poses
from ulna.collision import clearance as gap
from ulna.collision.attached import carried
from ulna.collision.clouds import is_points, point_grid
from ulna.collision.grids import joined
from ulna.collision.lanes.motion_bounds import Group, motion_bounds
from ulna.collision.lanes.sphere_pairs import RESERVE, meeting_spheres
from ulna.collision.lanes.table_lookup import PairGrids, packed
from ulna.collision.lanes.touching import Tables, Work
from ulna.collision.mask import check_touches
from ulna.collision.objects import Obstacle
from ulna.collision.pair_tables import PairTable, without_tables
from ulna.collision.pairs import LinkPair
from ulna.collision.solids import Missing, obstacle_solid
from ulna.collision.spheres import Spheres
from ulna.collision.world import World
from ulna.compiler import trace
from ulna.compiler.procedures import aligned, lanes_kernel
from ulna.data_classes import dataclass
from ulna.errors import InputError
from ulna.geometry import Shape
from ulna.model import Model, Planar
from ulna.model.joints.base import VectorKind
from ulna.spatial import SE3
from ulna.system.cached import cached_property
from ulna.system.collector import paused_collection
from ulna.typing import Array, Floats

ROUNDING = 1e-4
"""By how much all spheres are larger at least, because positions are computed in float32 [m]."""

_UNIT = 2.0**-20  # some sixteen roundings of float32

_ANGLE_NOISE = 1e-9  # moves nothing within `FARTHEST` by more than a thousandth of `ROUNDING`

_WIDEST = 1e30  # within which everything is [m]

FARTHEST = 100.0
"""Nothing may be farther from the origin than this, so that the rounding of float32 stays below `ROUNDING` [m]."""


@dataclass(frozen=True, eq=False)
class Moving:
    """What moves: a robot's links, and what they carry.

    Attributes:
        model: The robot.
        groups: Spheres that move together.
        pairs: Numbers of groups that are checked against each other, with the distances that they must keep [m].
        standing: Parts of links that never move, each with the names of the groups that it is checked against.
        kernel: From configurations to the poses of all joints, and the centres of bounding spheres of the links.
        clearances: Tables of proved clearance of pairs of links.
        fixed: Tables of links that never move, by number: each with its group and the distance to keep [m].
    """

    model: Model
    groups: tuple[Group, ...]
    pairs: tuple[tuple[int, int, float], ...]
    standing: tuple[tuple[gap.Part, frozenset[str]], ...]
    kernel: Any
    clearances: tuple[PairTable, ...] = ()
    fixed: tuple[tuple[int, float], ...] = ()

    @cached_property
    def bounds_of_motion(self) -> tuple[Floats, Floats]:
        """How far points of groups move at most when a joint moves by one, (G, nq), and pairs approach, (P, nq)."""
        return motion_bounds(self.model, self.groups, [pair[:2] for pair in self.pairs])

    @cached_property
    def range(self) -> tuple[Floats, Floats]:
        """Between which configurations `rounding` holds: the limits, or four turns either way, (nq,) each [rad, m]."""
        low, high = self.model.lower_position, self.model.upper_position
        four = 8.0 * np.pi
        return np.where(np.isfinite(low), low, -four), np.where(np.isfinite(high), high, four)

    @cached_property
    def rounding(self) -> float:
        """By how much float32 may place a sphere wrongly, with room to spare [m]."""
        ends = np.maximum(*np.abs(self.range))
        return max(ROUNDING, _UNIT * (FARTHEST + float((self.bounds_of_motion[0] @ ends).max())))

    @cached_property
    def tables(self) -> dict[str, Any]:
        """The tables that do not depend on obstacles, by name; radii without a margin."""
        lanes, reach = self.kernel.lanes, self.bounds_of_motion[0].T.astype(np.float32)
        filled = np.zeros((self.model.nq, -(-len(self.groups) // lanes) * lanes), np.float32)
        # what does not move stays 0: the number after 0 is subnormal, and a product with it takes 100 cycles
        filled[:, : len(self.groups)] = np.where(reach > 0.0, np.nextafter(reach, np.float32(np.inf)), 0.0)
        centres, radii = (
            np.concatenate([getattr(g, name) for g in self.groups]) for name in ("centres", "radii")
        )
        first_bound = 12 * len(self.model.joints)
        return {
            "first_bound": first_bound,
            "first_sphere": first_bound + 3 * len(self.groups),
            "known": (self.kernel.sizes[1] // lanes - first_bound) // 3,
            "bodies": np.array([12 * g.joint for g in self.groups], np.int64),
            "bounds": np.array([_bounding_sphere(g) for g in self.groups]),
            "first": np.cumsum([0, *(len(g.radii) for g in self.groups)]).astype(np.int64),
            "spheres": np.column_stack([centres, radii]),
            "reach": aligned(filled),
        }

    @cached_property
    def _larger_spheres(self) -> dict[float, dict[str, Any]]:
        return {}

    def larger_spheres(self, by: float) -> dict[str, Any]:
        """The tables of spheres that are larger by a length, by name: the same ones for every world.

        Args:
            by: By how much [m].

        Returns:
            `bounds`, `spheres` and `columns`.
        """
        kept = self._larger_spheres
        if by not in kept:
            larger = np.array([0.0, 0.0, 0.0, by])
            bounds, spheres = (
                (self.tables[name] + larger).astype(np.float32) for name in ("bounds", "spheres")
            )
            columns = np.zeros((4, len(spheres) + self.kernel.lanes), np.float32)
            columns[:, : len(spheres)] = spheres.T
            if len(kept) >= 16:
                kept.clear()
            kept[by] = {"bounds": bounds, "spheres": spheres, "columns": columns}
        return kept[by]

    @cached_property
    def _packed_clearances(self) -> dict[str, Any]:
        return packed(self.clearances)

    def grids(self, pairs: dict[str, Any], by: float) -> PairGrids:
        """The tables of proved clearance.

        Args:
            pairs: What `pair_tables` returns.
            by: By how much spheres are larger [m].

        Returns:
            The tables, with how near links may come.
        """
        number = {frozenset((t.first, t.second)): g for g, t in enumerate(self.clearances)}
        names = [group.name for group in self.groups]
        of_pair = [number.get(frozenset((names[a], names[b])), -1) for a, b, *_ in pairs["pairs"].tolist()]
        by = min(by, _WIDEST)
        reach = np.maximum(pairs["pair_margins"].astype(float), -_WIDEST) + 2.0 * by
        fixed = np.array([(g, margin + by) for g, margin in self.fixed]).reshape(-1, 2)
        return PairGrids(
            **self._packed_clearances, of_pair=np.array(of_pair, np.int64),
            pair_reach=np.nextafter(reach.astype(np.float32), np.float32(np.inf)),
            fixed=fixed[:, 0].astype(np.int64),
            fixed_reach=np.nextafter(fixed[:, 1].astype(np.float32), np.float32(np.inf)),
        )  # fmt: skip

    def pair_tables(self, margin: float) -> dict[str, Any]:
        """The tables of groups that are checked against each other, by name.

        Args:
            margin: By how much spheres are larger [m].

        Returns:
            `pairs`, `pair_margins`, `rows` and `partners`.
        """
        greatest = max((pair[2] for pair in self.pairs), default=0.0)
        return self._near_pairs if 2.0 * (margin + self.rounding) + greatest <= RESERVE else self._all_pairs

    @cached_property
    def _near_pairs(self) -> dict[str, Any]:
        numbers = tuple(pair[:2] for pair in self.pairs)
        return self._listed(meeting_spheres(self.model, self.groups, numbers, self.bounds_of_motion[1]))

    @cached_property
    def _all_pairs(self) -> dict[str, Any]:
        sizes = [(len(self.groups[a].radii), len(self.groups[b].radii)) for a, b, _ in self.pairs]
        return self._listed([np.ones(size, dtype=bool) for size in sizes])

    def _listed(self, masks: Sequence[Any]) -> dict[str, Any]:
        """Pairs of groups, for each its rows: a sphere of the first, and where its partners begin."""
        starts = self.tables["first"]
        pairs, margins, rows, partners = [], [], [], []
        for (a, b, margin), mask in zip(self.pairs, masks, strict=True):
            if not mask.any():
                continue
            begin = len(rows)
            for i in np.flatnonzero(mask.any(axis=1)):
                rows.append([starts[a] + i, len(partners)])
                partners += (starts[b] + np.flatnonzero(mask[i])).tolist()
            pairs.append([a, b, begin, len(rows)])
            margins.append(margin)
        rows.append([0, len(partners)])
        return {
            "pairs": np.array(pairs, np.int64).reshape(-1, 4),
            "pair_margins": np.array(margins, np.float32),
            "rows": np.array(rows, np.int64),
            "partners": np.array(partners, np.int64),
        }

    def work(self) -> Work:
        """Storage for one thread's checks."""
        lanes, balls = self.kernel.lanes, len(self.tables["spheres"])
        rows = self.tables["first_sphere"] + 3 * balls
        return Work(
            aligned(np.zeros((self.model.nq, lanes), np.float32)),
            aligned(np.zeros(rows * lanes, np.float32)),
            np.zeros(1, np.int64),
            np.zeros(balls, np.int64),
        )


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
        return Moving(
            model, tuple(groups), _numbered(groups, pairs, self.world),
            _standing(model, without_tables(pairs, tables), self.missing), self.robot.kernel, tables,
            _fixed(model, tables, self.world),
        )  # fmt: skip

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
        for part, partners in self.moving.standing:
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


def check_vector_joints(model: Model) -> None:
    """Checks that a configuration is plain numbers, whose sums are configurations.

    Args:
        model: The robot.

    Raises:
        InputError: If a joint has another kind of configuration; names it, and what to do.
    """
    for joint in model.joints:
        if not isinstance(joint.kind, VectorKind):
            advice = "Lock it where it stands: robot.lock({name: position})."
            if isinstance(joint.kind, Planar):
                advice = "Make a planar base of two prismatic joints and a continuous one, or lock it."
            raise InputError(
                f"Joint {joint.name!r} is {type(joint.kind).__name__}; planning takes joints whose positions are plain "
                f"numbers, such as revolute, prismatic and universal ones. {advice}"
            )


@lru_cache(maxsize=32)
def links_of(
    model: Model, spheres: Spheres, pairs: tuple[LinkPair, ...], missing: Missing,
    tables: tuple[PairTable, ...] = (),
) -> Moving:  # fmt: skip
    """The links of a robot, as planning checks them.

    Args:
        model: The robot.
        spheres: Spheres of its links.
        pairs: Pairs of links to check against each other.
        missing: What to do about mesh files that are missing: "error", or "skip" them with a warning.
        tables: Tables of proved clearance of some of the pairs.

    Returns:
        The links, with the kernel of poses.

    Raises:
        InputError: If a joint has a configuration that is not one number, or no link with spheres moves.
    """
    check_vector_joints(model)
    groups = []
    for name, balls in spheres.links.items():
        link = model.link(name)
        if link.joint >= 0:
            groups.append(Group(name, link.joint, link.placement @ balls.centres, balls.radii))
    if not groups:
        raise InputError(
            f"No link of {model.name!r} that moves has collision geometry; there is nothing to plan for."
        )
    numbered = _numbered(groups, pairs, World())
    bounds = tuple((12 * group.joint, *_bounding_sphere(group)[:3]) for group in groups)
    return Moving(
        model, tuple(groups), numbered, _standing(model, without_tables(pairs, tables), missing),
        _pose_kernel(model, bounds), tables, _fixed(model, tables, World()),
    )  # fmt: skip


def _fixed(model: Model, tables: Sequence[PairTable], world: World) -> tuple[tuple[int, float], ...]:
    """The tables of links that never move, by number, with the distances that the others must keep [m]."""
    return tuple(
        (number, world.margin(table.first, table.second))
        for number, table in enumerate(tables)
        if model.link(table.first).joint < 0 or model.link(table.second).joint < 0
    )


def _numbered(
    groups: Sequence[Group], pairs: Sequence[LinkPair], world: World
) -> tuple[tuple[int, int, float], ...]:
    """The pairs of which both move, by number, with the distances that they must keep [m]."""
    number = {group.name: k for k, group in enumerate(groups)}
    return tuple((number[a], number[b], world.margin(a, b)) for a, b in pairs if a in number and b in number)


def _standing(
    model: Model, pairs: Sequence[LinkPair], missing: Missing
) -> tuple[tuple[gap.Part, frozenset[str]], ...]:
    return tuple((part, frozenset(partners)) for part, partners in gap.standing(model, pairs, missing))


@lru_cache(maxsize=32)
def _pose_kernel(model: Model, points: tuple[tuple[float, ...], ...]) -> Any:
    """From q to the poses of all joints, twelve numbers each, rotation by rows and position, and points on bodies.

    Args:
        model: The robot.
        points: The first row of the body's pose, and where the point is on the body [m].
    """
    rounded = replace(model, joints=tuple(replace(j, placement=_rounded(j.placement)) for j in model.joints))

    def poses(q: Array) -> Array:
        rows = [np.append(T.rotation.reshape(9), T.translation) for T in joint_poses(rounded, q)]
        numbers = np.concatenate([np.asarray(row, dtype=object) for row in rows])
        placed = [
            numbers[row : row + 9].reshape(3, 3) @ np.array(place) + numbers[row + 9 : row + 12]
            for row, *place in points
        ]
        return np.concatenate([numbers, *placed])

    with paused_collection():
        return lanes_kernel(trace(poses, name="joint_poses", q=(model.nq,)))


def _rounded(T: SE3) -> SE3:
    """A pose whose rotation has 0, 1 and -1 where it differs from them by less than float32 can tell.

    Files have pi / 2 to ten digits or so, and products with what is left of its cosine would be computed in all lanes.
    """
    R = T.rotation.copy()
    nearest = np.round(R)
    is_near = np.abs(R - nearest) < _ANGLE_NOISE
    R[is_near] = nearest[is_near]
    return SE3(R, T.translation)


def _bounding_sphere(group: Group) -> list[float]:
    """Centre and radius of a sphere around spheres: about the middle of their bounding box."""
    r = group.radii[:, None]
    middle = ((group.centres - r).min(axis=0) + (group.centres + r).max(axis=0)) / 2.0
    return [*middle, float((np.linalg.norm(group.centres - middle, axis=1) + group.radii).max())]


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
