"""How far a robot is from itself and a world by its spheres, as a function for objectives of your own."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import reduce
from typing import Any

import numpy as np

from ulna.collision.attached import carried
from ulna.collision.clearance import (
    Kind,
    Part,
    checked_links,
    fixed_parts,
    parts,
    root,
    row,
    self_pairs,
    signed,
)
from ulna.collision.covering import fit
from ulna.collision.mask import check_touches
from ulna.collision.pairs import LinkPair, link_pairs
from ulna.collision.spheres import Spheres, sphere_centres
from ulna.collision.world import World
from ulna.model import Model
from ulna.numeric import exp, minimum
from ulna.spatial import SE3
from ulna.typing import Array, Floats

Ball = tuple[str, int]
"""Name of a link and number of its sphere."""
_Partners = tuple[list[tuple[Kind, Floats]], list[Ball]]


def sphere_clearance(
    model: Model,
    world: World | None = None,
    *,
    spheres: Spheres | None = None,
    pairs: Sequence[LinkPair] | None = None,
    smooth: float | None = None,
) -> Callable[[Array], Any]:
    """The function from a configuration to how far the robot's spheres are from everything.

    For your own objectives and constraints: call it in what you compile, use `.jacobian()` of the kernel. The world
    is compiled in, at its own poses.

    Args:
        model: The robot.
        world: Obstacles; None for none.
        spheres: Spheres of the links; None for `fit(model)`.
        pairs: Pairs of links; None for `link_pairs(model)`, () for none.
        smooth: A length s [m] that rounds off the minimum: -s log(sum(exp(-d / s))), which has a gradient everywhere
            and is below the minimum by at most s log(count); None for the minimum.

    Returns:
        A function from a configuration, shape (nq,), to the distance, shape () [m].
    """
    balls = fit(model) if spheres is None else spheres
    chosen = link_pairs(model) if pairs is None else pairs
    world = World() if world is None else world
    check_touches(model, world)
    carried_bodies = carried(model, world, balls)
    all_pairs = (*chosen, *carried_bodies.pairs)
    balls = Spheres({**balls.links, **carried_bodies.spheres})
    checks = _checks(model, world, balls, all_pairs)

    def gaps(q: Array) -> Iterator[list[Any]]:
        c = sphere_centres(model, q, balls, carried_bodies.carriers)
        for (link, i), (obstacles, others) in checks.items():
            radius = balls.links[link].radii[i]
            of_ball = [signed(kind, c[link][i], numbers) - radius for kind, numbers in obstacles]
            for b, j in others:
                v = c[link][i] - c[b][j]
                of_ball.append(root(v @ v) - (radius + balls.links[b].radii[j] + world.margin(link, b)))
            yield of_ball

    def function(q: Array) -> Any:
        return _least(gaps(q), smooth) if checks else 0.0 * q[0] + np.inf

    return function


def _checks(model: Model, world: World, balls: Spheres, pairs: Sequence[LinkPair]) -> dict[Ball, _Partners]:
    """What each sphere is checked against: parts of obstacles, and spheres before it.

    So a sphere is needed until the last one that is checked against it, and those of the last link only while they are
    checked: few are held at a time, which is what registers suffice for.

    Args:
        model: The robot.
        world: Obstacles.
        balls: Spheres of the links and of attached objects.
        pairs: Pairs of links and attached objects.

    Returns:
        By link and number of the sphere, in the order of the links; only of spheres that are checked.
    """
    rows: list[tuple[Part, SE3, Sequence[str]]] = [
        (part, SE3.identity(), links) for part, links in fixed_parts(model, pairs)
    ]
    rows += [
        (part, world[part.owner].pose, checked_links(model, balls, world[part.owner], world))
        for part in parts(world)
    ]
    order = [(link, i) for link, those in balls.links.items() for i in range(len(those.radii))]
    place = {ball: k for k, ball in enumerate(order)}
    checks: dict[Ball, _Partners] = {ball: ([], []) for ball in order}
    for part, pose, links in rows:
        for link in links:
            numbers = row(part.grown(world.margin(part.owner, link)), pose)
            for i in range(len(balls.links[link].radii)):
                checks[link, i][0].append((part.kind, numbers))
    for a, i, b, j in self_pairs(model, balls, pairs):
        first, second = sorted(((a, i), (b, j)), key=place.__getitem__)
        checks[second][1].append(first)
    return {ball: partners for ball, partners in checks.items() if any(partners)}


def _least(gaps: Iterable[Sequence[Any]], smooth: float | None) -> Any:
    """The least of the distances of each sphere, rounded off by a length or not."""
    if smooth is None:
        return reduce(minimum, (reduce(minimum, of_ball) for of_ball in gaps))
    distances = [d for of_ball in gaps for d in of_ball]
    least = reduce(minimum, distances)
    total = sum(exp((least - d) / smooth) for d in distances)  # none above 1
    return least - smooth * np.log(total)
