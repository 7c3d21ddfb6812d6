"""Where the solids of a robot are, and lower bounds of their distances, for a whole batch at once.

| symbol | meaning | shape | unit |
|---|---|---|---|
| R, p | pose of each solid in the world | (..., n, 3, 3), (..., n, 3) | [m] |
| c, h | centre and half edges of the box along the world's axes around each solid | (..., n, 3) | [m] |
| g | gap of two such boxes along each axis | (..., 3) | [m] |

Two shapes are at least |max(g, 0)| apart; where all of g is negative they can be pulled apart by -max(g), so that
their signed distance is at least max(g). Source: Ericson, Real-Time Collision Detection (2005), section 4.2.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ulna import algorithms
from ulna.collision.solids import Solid
from ulna.compiler import compile, trace
from ulna.geometry import Capsule, Plane, Sphere
from ulna.model import Model
from ulna.numeric import apply, dot
from ulna.typing import Array, Floats


def pose_kernel(model: Model, solids: Sequence[Solid]) -> Any:
    """The kernel that places the solids of a robot, and boxes around them.

    Args:
        model: The robot.
        solids: The solids, fixed to links or to the world.

    Returns:
        A kernel from a configuration, shape (nq,), to R, p, c, h of the solids, each with a leading axis n.
    """

    def boxes(q: Array) -> tuple[Array, ...]:
        poses = algorithms.frame_poses(model, q, solids)  # type: ignore[arg-type]
        around = [_box(s, T.rotation, T.translation) for s, T in zip(solids, poses, strict=True)]
        return (
            np.stack([T.rotation for T in poses]),
            np.stack([T.translation for T in poses]),
            np.stack([c for c, _ in around]),
            np.stack([h for _, h in around]),
        )

    unit = tuple((0, entries) for entries in model.unit_vectors)
    return compile(trace(boxes, name="solids", q=(model.nq,)), checked=True, unit_entries=unit)


def boxes_at(solids: Sequence[Solid], rotation: Floats, translation: Floats) -> tuple[Floats, Floats]:
    """Boxes around solids, along the world's axes.

    Args:
        solids: n solids.
        rotation: Rotations of the solids in the world, shape (..., n, 3, 3) [-].
        translation: Positions of the solids in the world, shape (..., n, 3) [m].

    Returns:
        Centres c and half edges h, each of shape (..., n, 3) [m].
    """
    if not solids:
        empty = np.zeros((*translation.shape[:-2], 0, 3))
        return empty, empty
    around = [_box(s, rotation[..., k, :, :], translation[..., k, :]) for k, s in enumerate(solids)]
    return np.stack([c for c, _ in around], axis=-2), np.stack([h for _, h in around], axis=-2)


def _box(solid: Solid, rotation: Array, translation: Array) -> tuple[Array, Array]:
    centre, half = solid.bounds
    shape = solid.shape
    if isinstance(shape, Plane):
        return translation, np.full(translation.shape, np.inf)
    middle = apply(rotation, centre) + translation if centre.any() else translation
    if isinstance(shape, Sphere):
        return middle, 0.0 * translation + shape.radius
    if isinstance(shape, Capsule):
        return middle, abs(rotation[..., :, 2]) * (shape.length / 2.0) + shape.radius
    return middle, apply(abs(rotation), half)


def gaps(c: Floats, h: Floats, count: int) -> Floats:
    """Lower bounds of the signed distances from the first `count` boxes to all boxes.

    Args:
        c: Centres, shape (rows, n, 3) [m].
        h: Half edges, shape (rows, n, 3) [m].
        count: How many boxes belong to links.

    Returns:
        Distances, shape (count, n, rows) [m].
    """
    worst = squares = None
    for middle, half in zip(_by_axis(c), _by_axis(h), strict=True):
        gap = np.abs(middle[:count, None] - middle)
        gap -= half[:count, None]
        gap -= half
        outside = np.maximum(gap, 0.0)
        outside *= outside
        worst = gap if worst is None else np.maximum(worst, gap, out=worst)
        squares = outside if squares is None else np.add(squares, outside, out=squares)
    assert worst is not None and squares is not None
    return np.where(worst > 0.0, np.sqrt(squares), worst)


def overlaps(c: Floats, h: Floats, count: int, margin: float | Floats) -> Array:
    """Whether boxes come near along every axis.

    Args:
        c: Centres, shape (rows, n, 3) [m].
        h: Half edges, shape (rows, n, 3) [m].
        count: How many boxes belong to links.
        margin: How near, () or (count, n, 1) [m].

    Returns:
        Truth values, shape (count, n, rows).
    """
    candidates = None
    for low, high in zip(_by_axis(c - h), _by_axis(c + h), strict=True):
        near = low[:count, None] <= high + margin
        near &= low <= high[:count, None] + margin
        candidates = near if candidates is None else np.logical_and(candidates, near, out=candidates)
    assert candidates is not None
    return candidates


def _by_axis(x: Floats) -> Floats:
    """(rows, n, 3) as (3, n, rows): the batch last, where NumPy's loops are long."""
    return np.ascontiguousarray(x.T)


def plane_gaps(c: Floats, h: Floats, rotation: Floats, translation: Floats) -> Floats:
    """Lower bounds of the signed distances from boxes to a solid half space.

    Args:
        c: Centres of the boxes, shape (rows, n, 3) [m].
        h: Half edges, shape (rows, n, 3) [m].
        rotation: Rotations of the half space, shape (rows, 3, 3) [-]; its normal is the third column.
        translation: A point on its plane, shape (rows, 3) [m].

    Returns:
        Distances, shape (n, rows) [m].
    """
    normal = rotation[..., None, :, 2]
    return (dot(normal, c - translation[..., None, :]) - dot(np.abs(normal), h)).T
