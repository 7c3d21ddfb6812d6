"""What moves of a robot, as the procedures of planning read it: one kernel of poses, and tables of numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from ulna.algorithms import joint_poses
from ulna.collision import clearance as gap
from ulna.collision.lanes.motion_bounds import Group, motion_bounds
from ulna.collision.lanes.sphere_pairs import RESERVE, meeting_spheres
from ulna.collision.lanes.table_lookup import PairGrids, packed
from ulna.collision.lanes.touching import Work
from ulna.collision.pair_tables import PairTable, without_tables
from ulna.collision.pairs import LinkPair
from ulna.collision.solids import Missing
from ulna.collision.spheres import Spheres
from ulna.collision.world import World
from ulna.compiler import trace
from ulna.compiler.procedures import aligned, lanes_kernel
from ulna.data_classes import dataclass
from ulna.errors import InputError
from ulna.model import Model, Planar
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
        fixed_parts: Parts of links that never move, each with the names of the groups that it is checked against.
        kernel: From configurations to the poses of all joints, and the centres of bounding spheres of the links.
        clearances: Tables of proved clearance of pairs of links.
        fixed: Tables of links that never move, by number: each with its group and the distance to keep [m].
    """

    model: Model
    groups: tuple[Group, ...]
    pairs: tuple[tuple[int, int, float], ...]
    fixed_parts: tuple[tuple[gap.Part, frozenset[str]], ...]
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
        """Upper bound of the error of the place of a sphere in float32 [m]."""
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
            "spans": np.concatenate([_spans(g) for g in self.groups]),
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
            `bounds`, `spheres`, `spans` and `columns`.
        """
        cached = self._larger_spheres
        tables = cached.get(by)
        if tables is None:  # other threads may add and remove tables meanwhile
            larger = np.array([0.0, 0.0, 0.0, by])
            bounds, spheres = (
                (self.tables[name] + larger).astype(np.float32) for name in ("bounds", "spheres")
            )
            columns = np.zeros((4, len(spheres) + self.kernel.lanes), np.float32)
            columns[:, : len(spheres)] = spheres.T
            if len(cached) >= 16:
                cached.clear()
            spans = np.nextafter((self.tables["spans"] + by).astype(np.float32), np.float32(np.inf))
            tables = {"bounds": bounds, "spheres": spheres, "spans": spans, "columns": columns}
            cached[by] = tables
        return tables

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


def check_vector_joints(model: Model) -> None:
    """Checks that a configuration is plain numbers, whose sums are configurations.

    Args:
        model: The robot.

    Raises:
        InputError: If a joint has another kind of configuration; names it, and what to do.
    """
    for joint in model.joints:
        if not joint.kind.is_vector:
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
    bounds = tuple((12 * group.joint, *_bounding_sphere(group)[:3]) for group in groups)
    return moving_groups(model, groups, pairs, World(), _pose_kernel(model, bounds), tables, missing)


def moving_groups(
    model: Model,
    groups: Sequence[Group],
    pairs: Sequence[LinkPair],
    world: World,
    kernel: Any,
    tables: tuple[PairTable, ...],
    missing: Missing,
) -> Moving:
    """Groups of spheres, as planning checks them.

    Args:
        model: The robot.
        groups: The groups.
        pairs: Pairs of links and attached objects to check against each other.
        world: Which distances they must keep.
        kernel: The kernel of poses.
        tables: Tables of proved clearance of some of the pairs.
        missing: What to do about mesh files that are missing: "error", or "skip" them with a warning.

    Returns:
        The groups with all that they are checked against.
    """
    fixed_parts = gap.fixed_parts(model, without_tables(pairs, tables), missing)
    return Moving(
        model,
        tuple(groups),
        _numbered(groups, pairs, world),
        tuple((part, frozenset(partners)) for part, partners in fixed_parts),
        kernel,
        tables,
        _fixed(model, tables, world),
    )


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
    """A pose whose rotation has 0, 1 and -1 where it differs from them by less than the rounding of float32.

    Files have pi / 2 to ten digits or so, and products with what is left of its cosine would be computed in all lanes.
    """
    R = T.rotation.copy()
    nearest = np.round(R)
    is_near = np.abs(R - nearest) < _ANGLE_NOISE
    R[is_near] = nearest[is_near]
    return SE3(R, T.translation)


def _bounding_sphere(group: Group) -> list[float]:
    """Centre and radius of a sphere around spheres: about the middle of their bounding box."""
    return [*_middle(group), float(_spans(group).max())]


def _middle(group: Group) -> Floats:
    """The middle of the bounding box of spheres."""
    r = group.radii[:, None]
    return ((group.centres - r).min(axis=0) + (group.centres + r).max(axis=0)) / 2.0


def _spans(group: Group) -> Floats:
    """How far spheres reach from the centre of their bounding sphere, shape (n,) [m]."""
    return np.linalg.norm(group.centres - _middle(group), axis=1) + group.radii
