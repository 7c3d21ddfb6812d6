"""Spheres around simple shapes by formula: few, and near the shape.

| symbol | meaning | unit |
|---|---|---|
| t | how far a sphere may stick out of a curved surface; twice that out of a flat one | [m] |
| r, L | radius and length of a capsule or cylinder | [m] |
| R | radius of the spheres | [m] |
| s | half the distance of two neighbours on the axis | [m] |
| w | edges of one cell of a box, or of the square cells that cover a disc | [m] |

Capsule: R^2 = r^2 + s^2 covers between neighbours, r + e = R past the last centre; n reach L = 2 s (n - 1) + 2 e.
A cone and an ellipsoid are cut into n slices with a ball around each.
Cylinder: n layers, each disc covered by circles of radius rho: R^2 = rho^2 + (L / 2n)^2. Box: R = |w| / 2.
Source: Pythagoras; Kershner, The number of circles covering a set, American Journal of Mathematics 61 (1939) for
discs covered by 3, 4 and 7 circles.
"""

from __future__ import annotations

import itertools
import math

import numpy as np

from ulna.geometry import Box, Capsule, Cone, Cylinder, Ellipsoid, Shape, Sphere
from ulna.typing import Floats

Cover = tuple[Floats, Floats, float]
"""Centres (n, 3), radii (n,), and how far they stick out at most, all in [m]."""

# circles that cover the unit disc: their radius, and their centres
_S3 = math.sqrt(3.0)
_DISCS: tuple[tuple[float, list[tuple[float, float]]], ...] = (
    (1.0, [(0.0, 0.0)]),
    (_S3 / 2.0, [(0.5 * math.cos(a), 0.5 * math.sin(a)) for a in (0.0, 2 * math.pi / 3, 4 * math.pi / 3)]),
    (math.sqrt(0.5), [(x, y) for x in (-0.5, 0.5) for y in (-0.5, 0.5)]),
    (
        0.5,
        [
            (0.0, 0.0),
            *((_S3 / 2 * math.cos(k * math.pi / 3), _S3 / 2 * math.sin(k * math.pi / 3)) for k in range(6)),
        ],
    ),
)


def pack(shape: Shape, t: float, most: int) -> Cover | None:
    """Spheres that cover a shape.

    Args:
        shape: The shape.
        t: How far they stick out, about [m].
        most: The largest number of spheres.

    Returns:
        Centres, shape (n, 3) [m], radii, shape (n,) [m], and how far they stick out [m]; None for a shape without a
        formula.
    """
    match shape:
        case Sphere(radius=r):
            return np.zeros((1, 3)), np.array([r]), 0.0
        case Capsule(radius=r, length=length):
            return _capsule(r, length, t, most)
        case Cylinder(radius=r, length=length):
            return _cylinder(r, length, t, most)
        case Box(size=size):
            return _box(size, t, most)
        case Cone(radius=r, length=length):
            return _cone(r, length, t, most)
        case Ellipsoid(radii=radii):
            return _ellipsoid(radii, t, most)
    return None


def _capsule(r: float, length: float, t: float, most: int) -> Cover:
    n, R = 1, r + length / 2.0
    while n < most and R - r > t:
        n += 1
        low, high = r, r + length / 2.0  # n spheres reach farther the larger they are
        for _ in range(60):
            R = (low + high) / 2.0
            reach = 2.0 * (n - 1) * math.sqrt(R * R - r * r) + 2.0 * (R - r)
            low, high = (low, R) if reach >= length else (R, high)
        R = high
    end = max(length / 2.0 - (R - r), 0.0)
    centres = np.zeros((n, 3))
    centres[:, 2] = np.linspace(-end, end, n) if n > 1 else 0.0
    return centres, np.full(n, R), R - r


def _cylinder(r: float, length: float, t: float, most: int) -> Cover:
    discs = [(rho * r, r * np.array(c)) for rho, c in _DISCS] + [_squares(r, t * k) for k in (16, 8, 4, 2)]
    options = [(rho, centres, n) for rho, centres in discs for n in range(1, most // len(centres) + 1)]

    def price(option: tuple[float, Floats, int]) -> float:
        """Spheres, dearer the farther they stick out."""
        side, flat, _ = _out_of_cylinder(r, length, *option)
        return len(option[1]) * option[2] * max(1.0, side / t, flat / (2.0 * t)) ** 3

    rho, centres, n = min(options, key=price)
    side, flat, R = _out_of_cylinder(r, length, rho, centres, n)
    z = length * ((np.arange(n) + 0.5) / n - 0.5)
    points = np.array([(x, y, h) for (x, y), h in itertools.product(centres.tolist(), z.tolist())])
    return (
        points,
        np.full(len(points), R),
        max(math.hypot(side, flat) if len(centres) > 1 else max(side, flat), 0.0),
    )


def _out_of_cylinder(
    r: float, length: float, rho: float, centres: Floats, n: int
) -> tuple[float, float, float]:
    """How far `n` layers of spheres around circles stick out of the round side and of the ends, and their radius."""
    R = math.hypot(rho, length / (2.0 * n))
    side = float(np.sqrt((centres**2).sum(axis=1)).max()) + R - r
    return side, R - length / (2.0 * n), R


def _squares(r: float, w: float) -> tuple[float, Floats]:
    """Circles around the square cells of edge `w` that meet a disc of radius `r`: their radius and centres."""
    w = min(w, 2.0 * r)
    n = math.ceil(2.0 * r / w)
    axis = 2.0 * r / n * (np.arange(n) + 0.5) - r
    x, y = np.meshgrid(axis, axis)
    inner = np.hypot(np.maximum(abs(x) - r / n, 0.0), np.maximum(abs(y) - r / n, 0.0)) <= r
    return math.sqrt(2.0) * r / n, np.stack([x[inner], y[inner]], axis=1).astype(float)


def _box(size: tuple[float, float, float], t: float, most: int) -> Cover:
    counts = [1, 1, 1]
    while True:
        w = [edge / n for edge, n in zip(size, counts, strict=True)]
        R = math.sqrt(sum(x * x for x in w)) / 2.0
        longest = w.index(max(w))
        more = math.prod(counts) // counts[longest] * (counts[longest] + 1)
        if R - min(w) / 2.0 <= 2.0 * t or more > most:
            break
        counts[longest] += 1
    axes = [edge * ((np.arange(n) + 0.5) / n - 0.5) for edge, n in zip(size, counts, strict=True)]
    centres = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    return centres, np.full(len(centres), R), R - min(w) / 2.0


def _cone(r: float, length: float, t: float, most: int) -> Cover:
    """A ball around each slice, centred where both its rims are as far, or on the wider one."""
    for n in range(1, most + 1):
        low = length * (np.arange(n) / n - 0.5)
        high = low + length / n
        wide, narrow = r * (0.5 - low / length), r * (0.5 - high / length)
        z = np.maximum((high**2 - low**2 + narrow**2 - wide**2) / (2.0 * (high - low)), low)
        R = np.sqrt(wide**2 + (z - low) ** 2)
        inner = (r * (0.5 - z / length)) * length / math.hypot(r, length)  # to the slope
        excess = float(np.max(R - np.minimum(inner, z + length / 2.0)))
        if excess <= 2.0 * t:
            break
    return np.stack([0.0 * z, 0.0 * z, z], axis=1), R, excess


def _ellipsoid(radii: tuple[float, float, float], t: float, most: int) -> Cover:
    """A ball around each slice across the longest axis."""
    order = np.argsort(radii)
    thin, wide, long = (radii[k] for k in order)
    for n in range(1, most + 1):
        low = long * (2.0 * np.arange(n) / n - 1.0)
        high = low + 2.0 * long / n
        z = (low + high) / 2.0
        # how far the rim at x is from z grows towards both ends of a slice
        ends = [wide**2 * (1.0 - x * x / long**2).clip(0.0) + (x - z) ** 2 for x in (low, high)]
        R = np.sqrt(np.maximum(*ends))
        excess = float(
            np.max(R - thin * (1.0 - np.abs(z) / long))
        )  # a ball of radius thin and the tip are inside
        if excess <= 2.0 * t:
            break
    centres = np.zeros((n, 3))
    centres[:, order[2]] = z
    return centres, R, excess
