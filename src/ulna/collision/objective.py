"""How far a robot is from itself and a world by its spheres, as a function for objectives of your own."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ulna.collision.attached import carried
from ulna.collision.clearance import Part, checked_links, parts, root, row, self_pairs, signed, standing
from ulna.collision.covering import fit
from ulna.collision.mask import check_touches
from ulna.collision.pairs import LinkPair, link_pairs
from ulna.collision.spheres import Spheres, sphere_centres
from ulna.collision.world import World
from ulna.model import Model
from ulna.numeric import exp, minimum
from ulna.spatial import SE3
from ulna.typing import Array


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
    held = carried(model, world, balls)
    all_pairs = (*chosen, *held.pairs)
    balls = Spheres({**balls.links, **held.spheres})
    couples = self_pairs(model, balls, all_pairs)
    rows: list[tuple[Part, SE3, tuple[str, ...]]] = [
        (part, SE3.identity(), links) for part, links in standing(model, all_pairs)
    ]
    for part in parts(world):
        links = tuple(checked_links(model, balls, world[part.owner], world))
        rows.append((part, world[part.owner].pose, links))

    def distances(q: Array) -> list[Any]:
        c = sphere_centres(model, q, balls, held.carriers)
        gaps = []
        for a, i, b, j in couples:
            v = c[a][i] - c[b][j]
            apart = balls.links[a].radii[i] + balls.links[b].radii[j] + world.margin(a, b)
            gaps.append(root(v @ v) - apart)
        for part, pose, links in rows:
            for link in links:
                numbers = row(part.grown(world.margin(part.owner, link)), pose)
                for centre, radius in zip(c[link], balls.links[link].radii, strict=True):
                    gaps.append(signed(part.kind, centre, numbers) - radius)
        return gaps

    def function(q: Array) -> Any:
        gaps = distances(q)
        return _least(gaps, smooth) if gaps else 0.0 * q[0] + np.inf

    return function


def _least(gaps: Sequence[Any], smooth: float | None) -> Any:
    """The least of distances, rounded off by a length or not."""
    least = gaps[0]
    for d in gaps[1:]:
        least = minimum(least, d)
    if smooth is None:
        return least
    total = sum(exp((least - d) / smooth) for d in gaps)  # none above 1
    return least - smooth * np.log(total)
