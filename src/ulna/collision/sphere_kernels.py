"""Kernels of collision checks by spheres: spheres on spheres of one robot, and spheres on a piece of an obstacle."""

from __future__ import annotations

import functools
from typing import Any, Literal, final

import numpy as np

from ulna.collision import clearance as gap
from ulna.collision.pairs import LinkPair
from ulna.collision.spheres import Spheres, sphere_centres
from ulna.compiler import compile, trace
from ulna.errors import InputError
from ulna.model import Model
from ulna.numeric import less, minimum, where
from ulna.typing import Array

What = Literal["free", "signed"]

MOST_COUPLES = 30_000
"""Pairs of a robot's own spheres that are still compiled into one kernel."""


@functools.lru_cache(maxsize=64)
def self_collision_kernel(what: What, model: Model, spheres: Spheres, pairs: tuple[LinkPair, ...]) -> Any:
    """From a configuration and a reach to the centres of all spheres and the answer of spheres on spheres.

    Shared by all worlds: to change obstacles compiles nothing.

    Args:
        what: "free" or "signed".
        model: The robot.
        spheres: Spheres of its links.
        pairs: Pairs of links.

    Returns:
        The kernel.

    Raises:
        InputError: If there are so many pairs of spheres that they would compile for minutes.
    """
    couples = gap.self_pairs(model, spheres, pairs)
    if len(couples) > MOST_COUPLES:
        raise InputError(
            f"{model.name!r} would check {len(couples):,} pairs of its own spheres, more than the {MOST_COUPLES:,} "
            "that compile in seconds. Take coarser spheres (spheres=robot.collision.spheres(tolerance=0.05, most=4)), "
            "name the links that matter (pairs=...), or use coal (method='exact')."
        )

    def check(q: Array, reach: Any) -> tuple[Any, Any]:
        c = sphere_centres(model, q, spheres)
        answer = _Result(what, reach)
        for a, i, b, j in couples:
            v = c[a][i] - c[b][j]
            radius = spheres.links[a].radii[i] + spheres.links[b].radii[j]
            if what == "free":
                answer.beyond(v @ v, radius)
            else:
                answer.at(gap.root(v @ v) - radius)
        return np.concatenate([np.asarray(x, dtype=object) for x in c.values()]), answer.number()

    return compile(trace(check, name=f"spheres_{what}", q=(model.nq,), reach=()))


@functools.lru_cache(maxsize=64)
def outer_kernel(what: What, kind: gap.Kind, radii: tuple[float, ...]) -> Any:
    """From centres, the numbers of one obstacle, and a reach to the answer of spheres on that obstacle.

    Args:
        what: "free" or "signed".
        kind: Kind of the obstacle's part.
        radii: Radii of the spheres [m].

    Returns:
        The kernel.
    """

    def check(c: Array, numbers: Array, reach: Any) -> Any:
        answer = _Result(what, reach)
        for centre, radius in zip(c, radii, strict=True):
            if what == "free" and kind != "plane":
                squared, rounding = gap.squared(kind, centre, numbers)
                answer.beyond(squared, radius + rounding)
            else:
                answer.at(gap.signed(kind, centre, numbers) - radius)
        return answer.number()

    shapes = {"c": (len(radii), 3), "numbers": (gap.WIDTH[kind],), "reach": ()}
    return compile(trace(check, name=f"spheres_{kind}_{what}", **shapes))


@functools.lru_cache(maxsize=8)
def sphere_kernel(what: What, kind: gap.Kind) -> Any:
    """From a centre, a radius, the numbers of one obstacle, and a reach to the answer of that sphere on it.

    It serves all robots and all objects that they carry.

    Args:
        what: "free" or "signed".
        kind: Kind of the obstacle's part.

    Returns:
        The kernel.
    """

    def check(c: Array, r: Any, numbers: Array, reach: Any) -> Any:
        answer = _Result(what, reach)
        if what == "free" and kind != "plane":
            squared, rounding = gap.squared(kind, c, numbers)
            answer.beyond(squared, r + rounding)
        else:
            answer.at(gap.signed(kind, c, numbers) - r)
        return answer.number()

    shapes = {"c": (3,), "r": (), "numbers": (gap.WIDTH[kind],), "reach": ()}
    return compile(trace(check, name=f"sphere_{kind}_{what}", **shapes))


@final
class _Result:
    """What is gathered while spheres are looked at: whether all is free, or the least distance; nan is not free."""

    def __init__(self, what: What, reach: Any) -> None:
        self.what, self.reach = what, reach
        self.result: Any = True if what == "free" else np.inf

    def beyond(self, squared: Any, radius: Any) -> None:
        """Takes in a squared distance that must be above that of `radius`: no root is needed to say so."""
        limit = radius + self.reach
        self.result = less(limit * limit, squared) & self.result

    def at(self, distance: Any) -> None:
        """Takes in a distance."""
        if self.what == "free":
            self.result = less(self.reach, distance) & self.result
        else:
            self.result = minimum(self.result, distance)

    def number(self) -> Any:
        """1 for free and 0 for not, or the least distance."""
        return where(self.result, 1.0, 0.0) if self.what == "free" else self.result
