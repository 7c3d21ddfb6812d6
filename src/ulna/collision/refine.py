"""Finer spheres where spheres touch and the real shapes do not, at configurations that matter."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping

import numpy as np

from ulna.checks.quaternions import checked_configurations
from ulna.collision import clearance as gap
from ulna.collision.centres import covered, divided
from ulna.collision.cover import Task
from ulna.collision.covering import link_task, solids_by_link
from ulna.collision.exact import Checker
from ulna.collision.pairs import LinkPair, link_pairs
from ulna.collision.solids import Missing
from ulna.collision.spheres import LinkSpheres, Spheres, sphere_centres
from ulna.collision.world import World
from ulna.errors import InputError, ModelWarning
from ulna.model import Model
from ulna.spatial import SE3
from ulna.system.callers import level_of_caller
from ulna.typing import Array, ArrayLike

_ROUNDS = 8

FalseContacts = Mapping[LinkPair, Mapping[str, set[int]]]
"""By pair, and by link of the pair, the numbers of the spheres that touch though the shapes do not."""


def refine(
    model: Model,
    spheres: Spheres,
    q: ArrayLike,
    world: World | None = None,
    *,
    most: int = 60,
    missing: Missing = "error",
) -> Spheres:
    """Spheres with more of them where they touch at given configurations and the real shapes do not.

    Each sphere to found is divided in two, and the radii of its link are computed anew, until nothing touches by
    spheres that does not by coal, or a link has as many as allowed. A warning (ModelWarning) names the pairs that
    remain. Shapes that are balls stay as they are.

    Args:
        model: The robot.
        spheres: What to start from, as `fit` returns them.
        q: Configurations that should be free, shape (..., nq) [rad, m].
        world: Obstacles; None for none.
        most: The largest number of spheres of a link.
        missing: What to do about a mesh file that is missing: "error", or "skip" it with a warning.

    Returns:
        New spheres.

    Raises:
        InputError: If `most` is no count.
        ShapeError, DtypeError, NonFiniteError: If `q` cannot be configurations.
        MissingExtra: If coal or scipy is not installed.
    """
    if int(most) != most or most < 1:
        raise InputError(f"`most` is {most!r}; expected a count, 1 or more.")
    q = checked_configurations("q", q, model).reshape(-1, model.nq)
    world = World() if world is None else world
    checker = Checker(model, world, missing=missing)
    touching = dict(zip((frozenset(p) for p in checker.owners), checker.touching(q).T, strict=True))
    solids, tasks = solids_by_link(model, missing), {}
    for _ in range(_ROUNDS):
        found = _false_contacts(model, spheres, q, world, touching, missing)
        links = dict(spheres.links)
        for name in {name for by_link in found.values() for name in by_link if name in solids}:
            tasks.setdefault(name, None)
            if tasks[name] is None:
                tasks[name] = link_task(model, name, solids[name])
            numbers = set().union(*(by_link.get(name, set()) for by_link in found.values()))
            finer = _divided(tasks[name], spheres.links[name], numbers, int(most))
            if finer is not None:
                links[name] = finer
        if all(links[name] is spheres.links[name] for name in links):
            break
        spheres = Spheres(links)
    left = _false_contacts(model, spheres, q, world, touching, missing)
    if left:
        pairs = ", ".join(f"{a!r} and {b!r}" for a, b in left)
        warnings.warn(
            f"With {spheres.count} spheres, those of {pairs} still touch at some of the configurations, though the "
            f"shapes do not. Allow more (most={2 * most}), or move the configurations away.",
            ModelWarning,
            stacklevel=level_of_caller(),
        )
    return spheres


def _divided(task: Task, old: LinkSpheres, numbers: set[int], most: int) -> LinkSpheres | None:
    """The spheres of a link with two in place of each of some; None where that cannot be."""
    ball_count = len(task.solid_balls[1])
    chosen = sorted(k - ball_count for k in numbers if k >= ball_count)[: max(0, most - len(old.radii))]
    if task.problem is None or task.is_done or not chosen:
        return None
    c, r = covered(task.problem, divided(task.problem, old.centres[ball_count:].copy(), chosen))
    e = float((r + task.problem.region.signed_exactly(c)).max(initial=0.0))
    return LinkSpheres(
        np.vstack([task.solid_balls[0], c]), np.concatenate([task.solid_balls[1], r]), max(e, 0.0)
    )


def _false_contacts(
    model: Model,
    spheres: Spheres,
    q: Array,
    world: World,
    touching: Mapping[frozenset[str], Array],
    missing: Missing,
) -> FalseContacts:
    """The spheres that touch something at configurations at which the shapes do not."""
    placed = {
        name: np.broadcast_to(points, (len(q), *points.shape[-2:]))
        for name, points in sphere_centres(model, q, spheres).items()
    }
    found: dict[LinkPair, dict[str, set[int]]] = {}

    def add(pair: LinkPair, name: str, numbers: Iterable[int]) -> None:
        found.setdefault(pair, {}).setdefault(name, set()).update(int(k) for k in numbers)

    never = np.zeros(len(q), dtype=bool)
    for a, b in link_pairs(model):
        if model.link(a).joint < 0 or model.link(b).joint < 0 or not {a, b} <= placed.keys():
            continue
        reach = spheres.links[a].radii[:, None] + spheres.links[b].radii
        apart = ((placed[a][:, :, None] - placed[b][:, None]) ** 2).sum(axis=-1)
        hits = (apart <= reach**2)[~touching.get(frozenset((a, b)), never)].any(axis=0)
        if hits.any():
            add((a, b), a, np.flatnonzero(hits.any(axis=1)))
            add((a, b), b, np.flatnonzero(hits.any(axis=0)))
    for part, place, links in _fixed_parts(model, spheres, world, missing):
        numbers = gap.row(part, place)
        for name in links:
            free = np.flatnonzero(~touching.get(frozenset((name, part.owner)), never))
            for k, radius in enumerate(spheres.links[name].radii):
                if any(gap.signed(part.kind, placed[name][i, k], numbers) <= radius for i in free):
                    add((name, part.owner), name, [k])
    return found


def _fixed_parts(model: Model, spheres: Spheres, world: World, missing: Missing):
    """The parts of obstacles and of fixed links, their poses, and the links that are checked against each."""
    for part, links in gap.fixed_parts(model, link_pairs(model), missing):
        yield part, SE3.identity(), [name for name in links if name in spheres.links]
    for part in gap.parts(world, missing):
        yield part, world[part.owner].pose, gap.checked_links(model, spheres, world[part.owner], world)
