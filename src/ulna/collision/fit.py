"""Spheres that cover solids: by formula where there is one, else by clusters of points; none without need.

| symbol | meaning | shape | unit |
|---|---|---|---|
| x | points of which none of the solid is farther away than delta | (m, 3) | [m] |
| c, r | centres and radii of spheres | (n, 3), (n,) | [m] |
| e | how far any point of the spheres can be from the solid | | [m] |

Points go to the nearest centre, centres to the middle of the smallest ball around their points, until that settles;
then r is the distance to the farthest point of a sphere's own plus delta, so that the spheres cover the solid for
sure. Spheres are added until e is small enough. Source: Gonzalez, Clustering to minimize the maximum intercluster
distance, Theoretical Computer Science 38 (1985) for the start; Badoiu and Clarkson, Smaller core-sets for balls
(SODA 2003) for the smallest ball.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ulna.collision.cover import sample
from ulna.collision.packing import Cover, pack
from ulna.collision.solids import Solid
from ulna.errors import MissingExtra
from ulna.spatial import SE3
from ulna.typing import Array, Floats

_COUNTS = (1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64)
_ROUNDS = 8
_FEW = 4000  # points that decide where centres go; all of them decide radii


def cover(solids: Sequence[Solid], places: Sequence[SE3], tolerance: float, most: int) -> Cover:
    """Spheres around solids.

    Args:
        solids: Bounded solids, each as its convex hull.
        places: T_common_shape of each [m].
        tolerance: How far spheres should stick out of curved surfaces [m]; of flat ones twice that.
        most: The largest number of spheres for a solid.

    Returns:
        Centres, shape (n, 3) [m], radii, shape (n,) [m], and e [m].
    """
    covers = [
        pack(solid.shape, tolerance, most) or _cluster(solid, 2.0 * tolerance, most) for solid in solids
    ]
    centres = [place @ c for place, (c, _, _) in zip(places, covers, strict=True)]
    owner = np.repeat(np.arange(len(covers)), [len(c) for c in centres])
    c, r = np.concatenate(centres), np.concatenate([radii for _, radii, _ in covers])
    needed = _needed(solids, places, c, r, owner, tolerance)
    return c[needed], r[needed], max(e for _, _, e in covers)


def _needed(
    solids: Sequence[Solid], places: Sequence[SE3], c: Floats, r: Floats, owner: Array, tolerance: float
) -> Array:
    """Which spheres are not made needless by the others, the smallest going first.

    A sphere can go where each sample that stands for what it covers of its own solid is deeper than delta in another.
    """
    needed = np.ones(len(c), dtype=bool)
    samples = [sample(s, T, tolerance / 4.0) for s, T in zip(solids, places, strict=True)]
    for k in np.argsort(r, kind="stable"):
        x, _, delta = samples[owner[k]]
        covered = x[((x - c[k]) ** 2).sum(axis=1) <= (r[k] + delta) ** 2]
        needed[k] = False
        uncovered = np.ones(len(covered), dtype=bool)
        for centre, radius in zip(c[needed], r[needed], strict=True):
            if radius > delta:
                uncovered &= ((covered - centre) ** 2).sum(axis=1) > (radius - delta) ** 2
        needed[k] = bool(uncovered.any())
    return needed


def _cluster(solid: Solid, tolerance: float, most: int) -> Cover:
    """Spheres around a solid without a formula, by clusters of points."""
    x, inside, delta = sample(solid, SE3.identity(), tolerance / 4.0)
    few = x[:: max(1, len(x) // _FEW)]
    tree = _tree(inside)
    best, least = _start(few, 1), np.inf
    for count in [n for n in _COUNTS if n < most] + [most]:
        c, r = _radii(few, _settled(few, _start(few, count)), delta)
        rough = _rough(tree, c, r)
        if rough < least:
            best, least = c, rough
        if rough <= tolerance:
            break
    c, r = _radii(x, best, delta)
    return c, r, _excess(tree, c, r, max(delta, tolerance / 4.0))


def _start(x: Floats, count: int) -> Floats:
    """Points far from each other: each the farthest from those before it."""
    chosen = [x[np.argmax(((x - x.mean(axis=0)) ** 2).sum(axis=1))]]
    far = np.full(len(x), np.inf)
    while len(chosen) < count:
        np.minimum(far, ((x - chosen[-1]) ** 2).sum(axis=1), out=far)
        chosen.append(x[np.argmax(far)])
    return np.array(chosen)


def _settled(x: Floats, c: Floats) -> Floats:
    for _ in range(_ROUNDS):
        owners = _owners(x, c, np.zeros(len(c)))
        new = np.array([_middle(x[owners == k], c[k]) for k in range(len(c))])
        if np.abs(new - c).max() < 1e-4:
            break
        c = new
    return c


def _middle(x: Floats, start: Floats) -> Floats:
    """The centre of the smallest ball around points, to some percents of its radius."""
    if not len(x):
        return start
    c = x.mean(axis=0)
    for k in range(1, 15):
        c = c + (x[np.argmax(((x - c) ** 2).sum(axis=1))] - c) / (k + 1)
    return c


def _owners(x: Floats, c: Floats, r: Floats) -> Array:
    """For each point the sphere it is deepest in."""
    best, owners = np.full(len(x), np.inf), np.zeros(len(x), dtype=int)
    for k, (centre, radius) in enumerate(zip(c, r, strict=True)):
        depth = np.sqrt(((x - centre) ** 2).sum(axis=1)) - radius
        nearer = depth < best
        best[nearer], owners[nearer] = depth[nearer], k
    return owners


def _radii(x: Floats, c: Floats, delta: float) -> tuple[Floats, Floats]:
    """Spheres that hold all points with `delta` to spare; those that hold none are dropped."""
    r = np.zeros(len(c))
    for _ in range(4):  # radii decide owners, owners radii; each round leaves every point covered
        owners = _owners(x, c, r)
        r = np.array([_farthest(x[owners == k], c[k]) for k in range(len(c))])
    used = r >= 0.0
    return c[used], r[used] + delta


def _farthest(x: Floats, c: Floats) -> float:
    return float(np.sqrt(((x - c) ** 2).sum(axis=1).max())) if len(x) else -1.0


def _rough(tree: Any, c: Floats, r: Floats) -> float:
    """How far points on the spheres are from the solid; a guess at e."""
    k = np.arange(100) + 0.5
    z, angle = 1.0 - k / 50.0, np.pi * (1.0 + np.sqrt(5.0)) * k
    flat = np.sqrt(1.0 - z * z)
    ball = np.stack([np.cos(angle) * flat, np.sin(angle) * flat, z], axis=1)
    return float(tree.query((c[:, None] + r[:, None, None] * ball).reshape(-1, 3))[0].max())


def _excess(tree: Any, c: Floats, r: Floats, step: float) -> float:
    """A bound of e: the distance grows by no more than a point moves, so a grid inside the spheres tells all."""
    slack = step * np.sqrt(3.0) / 2.0
    worst = 0.0
    for centre, radius in zip(c, r, strict=True):
        n = int(np.ceil((radius + slack) / step))
        axis = step * np.arange(-n, n + 1)
        grid = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3)
        length = np.sqrt((grid**2).sum(axis=1, keepdims=True))
        near = grid[length[:, 0] <= radius + slack]
        drawn = near * np.minimum(1.0, radius / np.maximum(length[length[:, 0] <= radius + slack], 1e-12))
        worst = max(worst, float(tree.query(centre + drawn)[0].max()))
    return worst + slack


def _tree(points: Floats) -> Any:
    try:
        from scipy.spatial import KDTree
    except ImportError as error:
        raise MissingExtra("scipy", "collision", "Fitting spheres") from error
    return KDTree(points)
