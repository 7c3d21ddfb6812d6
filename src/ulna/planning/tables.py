"""The tables and the kernel that the procedures of planning read, from a robot's spheres and a world."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from ulna.algorithms.multibody.tree import Step, steps
from ulna.collision import LinkSpheres, SphereChecker, Spheres
from ulna.collision import clearance as gap
from ulna.collision.spheres import sphere_centres
from ulna.compiler import trace
from ulna.compiler.procedures import lanes_kernel
from ulna.errors import InputError
from ulna.model import Model, Prismatic, Revolute
from ulna.planning.touching import Tables
from ulna.system.cached import cached_property
from ulna.typing import Array, Floats

ROUNDING = 1e-4
"""By how much all spheres are larger at least, because positions are computed in float32 [m]."""

_UNIT = 2.0**-20  # some sixteen roundings of float32

FARTHEST = 100.0
"""Nothing may be farther from the origin than this, so that the rounding of float32 stays below `ROUNDING` [m]."""


@dataclass(frozen=True, eq=False)
class Scene:
    """A robot in a world, as machine code checks it.

    Attributes:
        checker: The robot, its spheres and the world.
        kernel: From configurations to the centres of all spheres, in lanes.
        reach: rho: how far a point of a link moves at most when a joint moves by one, (L, nq) [m/rad], [1].
        approach: How far two links that are checked against each other approach at most likewise, (pairs, nq).
        links: The moving links with spheres, in the order of the tables.
    """

    checker: SphereChecker
    kernel: Any
    reach: Floats
    approach: Floats
    links: tuple[str, ...]

    @property
    def lanes(self) -> int:
        """How many configurations are checked at once."""
        return self.kernel.lanes

    @cached_property
    def rounding(self) -> float:
        """By how much float32 may place a sphere wrongly, with room to spare [m]."""
        model = self.checker.model
        ends = np.maximum(np.abs(model.lower_position), np.abs(model.upper_position))
        turns = np.where(np.isfinite(ends), ends, 8.0 * np.pi)
        return max(ROUNDING, _UNIT * (FARTHEST + float((self.reach @ turns).max())))

    def tables(self, margin: float) -> Tables:
        """The tables, with all spheres larger by a margin.

        Args:
            margin: How much larger [m]; two links are then kept twice as far apart.

        Returns:
            Arrays of the types that the procedures take.
        """
        larger = margin + self.rounding
        bounds, radii = ((values + larger).astype(np.float32) for values in self._radii)
        return self._tables._replace(bounds=bounds, radii=radii)

    @cached_property
    def _radii(self) -> tuple[Floats, Floats]:
        """Radii of the links' bounding spheres, and of all spheres [m]."""
        spheres = self.checker.spheres
        bounds = [_bounding_sphere(spheres, name)[1] for name in self.links]
        return np.array(bounds), np.concatenate([spheres.links[name].radii for name in self.links])

    @cached_property
    def _tables(self) -> Tables:
        """The tables without a margin."""
        spheres = self.checker.spheres
        count = [len(spheres.links[name].radii) for name in self.links]
        bounds, radii = (values.astype(np.float32) for values in self._radii)
        groups = {kind: self._obstacles(kind) for kind in ("box", "cylinder", "plane")}
        pairs = [[self.links.index(name) for name in pair] for pair in moving_pairs(self.checker, self.links)]
        return Tables(
            bounds=bounds,
            radii=radii,
            first=np.cumsum([0, *count]).astype(np.int64),
            boxes=groups["box"][0],
            box_links=groups["box"][1],
            cylinders=groups["cylinder"][0],
            cylinder_links=groups["cylinder"][1],
            planes=groups["plane"][0],
            plane_links=groups["plane"][1],
            pairs=np.array(pairs, np.int64).reshape(-1, 2),
        )

    def _obstacles(self, kind: gap.Kind) -> tuple[Any, Any]:
        """The rows of all obstacles of a kind, and the links that each is checked against."""
        rows: list[Any] = []
        masks: list[list[int]] = []
        for group_kind, names, numbers, _ in self.checker.static_groups():
            if group_kind == kind:
                rows += list(numbers)
                masks += [[int(link in names) for link in self.links]] * len(numbers)
        width = gap.WIDTH[kind]
        table = np.array(rows, float).reshape(-1, width)
        places = {"box": slice(9, 12), "cylinder": slice(3, 6), "plane": slice(0, 0)}[kind]
        if np.abs(table[:, places]).max(initial=0.0) > FARTHEST:
            raise InputError(
                f"An obstacle is {np.abs(table[:, places]).max():.3g} m from the origin; planning takes at most "
                f"{FARTHEST:g} m. Look at the units, or place the robot's base nearer to the origin."
            )
        return table.astype(np.float32), np.array(masks, np.int64).reshape(-1, len(self.links))


def scene(checker: SphereChecker) -> Scene:
    """A robot in a world, ready to be checked by procedures.

    Args:
        checker: The robot, its spheres and the world.

    Returns:
        The scene; its kernel depends on robot and spheres alone, and is kept.

    Raises:
        InputError: If a joint has a configuration that is not one number, or no link with spheres moves.
    """
    model = checker.model
    for joint in model.joints:
        if not isinstance(joint.kind, Revolute | Prismatic):
            raise InputError(
                f"Joint {joint.name!r} is {type(joint.kind).__name__}; planning takes revolute, continuous and "
                "prismatic joints. Lock it where it stands: robot.lock({name: position})."
            )
    links = tuple(name for name in checker.spheres.links if model.link(name).joint >= 0)
    if not links:
        raise InputError(
            f"No link of {model.name!r} that moves has collision geometry; there is nothing to plan for."
        )
    kernel = _centres_kernel(model, checker.spheres, links)
    return Scene(checker, kernel, *motion_bounds(checker, links), links)


def moving_pairs(checker: SphereChecker, links: Sequence[str]) -> list[tuple[str, str]]:
    """The pairs of links that are checked against each other and both move.

    Args:
        checker: The robot and its pairs.
        links: The links that move.

    Returns:
        Names.
    """
    return [(a, b) for a, b in checker.pairs if a in links and b in links]


@lru_cache(maxsize=32)
def _centres_kernel(model: Model, spheres: Spheres, links: tuple[str, ...]) -> Any:
    """From q to the centres of the bounding spheres of the links, then of all spheres, three numbers each."""
    bounding = {name: _bounding_sphere(spheres, name) for name in links}

    def centres(q: Array) -> Array:
        coarse = Spheres({name: _sphere(*bounding[name]) for name in links})
        fine = Spheres({name: spheres.links[name] for name in links})
        placed = [*sphere_centres(model, q, coarse).values(), *sphere_centres(model, q, fine).values()]
        return np.concatenate([np.asarray(points, dtype=object) for points in placed])

    return lanes_kernel(trace(centres, name="sphere_centres", q=(model.nq,)))


def _sphere(centre: Floats, radius: float) -> Any:
    return LinkSpheres(centre[None], np.array([radius]))


def _bounding_sphere(spheres: Spheres, name: str) -> tuple[Floats, float]:
    """A sphere around the spheres of a link: about the middle of their bounding box."""
    c, r = spheres.links[name].centres, spheres.links[name].radii
    middle = ((c - r[:, None]).min(axis=0) + (c + r[:, None]).max(axis=0)) / 2.0
    return middle, float((np.linalg.norm(c - middle, axis=1) + r).max())


def motion_bounds(checker: SphereChecker, links: Sequence[str]) -> tuple[Floats, Floats]:
    """How far points of links move at most, and how far links approach each other, when a joint moves by one.

    A point moves by at most its distance from the axis, which is no more than the lengths of all that lies between,
    added. A joint that carries two links moves neither towards the other. Source: Schwarzer, Saha and Latombe (2005),
    section 3.

    Args:
        checker: The robot; its spheres are among the points.
        links: Names of links that move.

    Returns:
        Bounds of links, shape (links, nq), and of pairs, (pairs, nq) [m/rad] for turning joints, [1] for sliding ones.
    """
    model, tree = checker.model, steps(checker.model)
    by_step = np.stack([_step_bounds(model, checker.spheres, tree, name) for name in links])
    pairs = [[links.index(name) for name in pair] for pair in moving_pairs(checker, links)]
    first, second = (by_step[[pair[k] for pair in pairs]].reshape(-1, len(tree)) for k in (0, 1))
    apart = np.where((first > 0.0) != (second > 0.0), first + second, 0.0)
    columns = np.zeros((len(tree), model.nq))
    columns[np.arange(len(tree)), [step.joint.idx_q for step in tree]] = 1.0
    return by_step @ columns, apart @ columns


def _step_bounds(model: Model, spheres: Spheres, tree: Sequence[Step], name: str) -> Floats:
    """How far a point of a link moves at most when a step's source moves by one, shape (steps,)."""
    link, balls = model.link(name), spheres.links[name]
    length = float((np.linalg.norm(link.placement @ balls.centres, axis=1) + balls.radii).max())
    bounds = np.zeros(len(tree))
    k = next(k for k, step in enumerate(tree) if step.is_last and step.joint is model.joints[link.joint])
    while k >= 0:
        step = tree[k]
        turns = float(np.linalg.norm(step.subspace()[0].angular)) > 0.0
        bounds[k] = abs(step.multiplier) * (length if turns else 1.0)
        length += float(np.linalg.norm(step.placement.translation)) + (0.0 if turns else _travel(model, step))
        k = step.parent
    return bounds


def _travel(model: Model, step: Step) -> float:
    """How far a sliding joint can slide from its zero [m]."""
    column, mimic = step.joint.idx_q, step.joint.mimic
    farthest = max(abs(model.lower_position[column]), abs(model.upper_position[column]))
    return farthest if mimic is None else abs(mimic.offset) + abs(mimic.multiplier) * farthest
