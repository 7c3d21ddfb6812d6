"""Surfaces of primitive shapes, axes, arrows and tubes, with NumPy only."""

from __future__ import annotations

import numpy as np

from ulna.errors import InputError
from ulna.geometry import (
    Box,
    Capsule,
    Cone,
    Cylinder,
    Ellipsoid,
    HeightField,
    Plane,
    PointCloud,
    Shape,
    Sphere,
)
from ulna.typing import Array, ArrayLike, Floats
from ulna.viewer.mesh.surface import DEFAULT_COLOUR, RGBA, Surface, normalized

FACETS = 36
"""Facets around a round shape."""

AXIS_COLOURS: tuple[RGBA, RGBA, RGBA] = (
    (0.86, 0.20, 0.22, 1.0),
    (0.20, 0.66, 0.28, 1.0),
    (0.16, 0.39, 0.92, 1.0),
)
"""Red, green, blue for x, y, z."""


def tessellate(shape: Shape, rgba: RGBA = DEFAULT_COLOUR, around: int = FACETS) -> Surface:
    """The surface of a primitive shape in its own frame.

    Args:
        shape: A shape of `ulna.geometry` other than a mesh.
        rgba: Its colour.
        around: Facets around a round shape.

    Returns:
        The surface.

    Raises:
        InputError: The shape is a mesh; `load_mesh` reads these.
    """
    match shape:
        case Box():
            return _box(shape.size, rgba)
        case Sphere():
            return _ellipsoid((shape.radius,) * 3, rgba, around)
        case Ellipsoid():
            return _ellipsoid(shape.radii, rgba, around)
        case Cylinder():
            return _revolve(_cylinder_profile(shape.radius, shape.length), rgba, around)
        case Capsule():
            return _revolve([_capsule_profile(shape.radius, shape.length, around)], rgba, around)
        case Cone():
            return _revolve(_cone_profile(shape.radius, shape.length), rgba, around)
        case Plane():
            # a plane without end is the floor's business; the picture gets a piece of it
            x, y = (s or 10.0 for s in shape.size)
            corners = np.array([(-x, -y, 0), (x, -y, 0), (x, y, 0), (-x, y, 0)]) / 2
            return Surface(corners, np.array([(0, 1, 2), (0, 2, 3)]), np.tile((0.0, 0.0, 1.0), (4, 1)), rgba)
        case PointCloud():
            return _octahedra(shape, rgba)
        case HeightField():
            return _flat(*shape.triangles(), rgba)
    raise InputError(
        f"Cannot tessellate {shape!r}; expected a Box, Sphere, Cylinder, Capsule, Cone, Ellipsoid, Plane, "
        "PointCloud or HeightField."
    )


_MAX_DRAWN_POINTS = 20_000  # points of a cloud that are drawn, evenly chosen from more


def _octahedra(cloud: PointCloud, rgba: RGBA) -> Surface:
    """An octahedron about each point of a cloud."""
    points = cloud.points[:: max(1, -(-len(cloud.points) // _MAX_DRAWN_POINTS))]
    corners = cloud.radius * np.concatenate([np.eye(3), -np.eye(3)])
    faces = np.array([(0, 1, 2), (1, 3, 2), (3, 4, 2), (4, 0, 2), (1, 0, 5), (3, 1, 5), (4, 3, 5), (0, 4, 5)])
    vertices = (points[:, None] + corners).reshape(-1, 3)
    triangles = (6 * np.arange(len(points))[:, None, None] + faces).reshape(-1, 3)
    normals = np.tile(normalized(corners) if cloud.radius else corners, (len(points), 1))
    return Surface(vertices, triangles, normals, rgba)


def _flat(vertices: Floats, triangles: Array, rgba: RGBA) -> Surface:
    """Triangles with a normal each."""
    corners = vertices[triangles]
    normals = normalized(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
    numbers = np.arange(3 * len(triangles)).reshape(-1, 3)
    return Surface(corners.reshape(-1, 3), numbers, np.repeat(normals, 3, axis=0), rgba)


def axes(length: float = 0.1, radius: float | None = None) -> tuple[Surface, Surface, Surface]:
    """Three arrows along x, y, z in red, green, blue.

    Args:
        length: Length of an arrow [m].
        radius: Radius of its shaft [m]; a fortieth of the length when not given.

    Returns:
        The arrows along x, y and z.
    """
    r = length / 40 if radius is None else radius
    tip = max(length - 7 * r, 0.5 * length)
    profile = [
        np.array([(0, 0, 0, -1), (r, 0, 0, -1)], dtype=float),
        np.array([(r, 0, 1, 0), (r, tip, 1, 0)], dtype=float),
        np.array([(r, tip, 0, -1), (2.4 * r, tip, 0, -1)], dtype=float),
        _straight_strip((2.4 * r, tip), (0.0, length)),
    ]
    along_z = _revolve(profile, AXIS_COLOURS[2], 20)
    from_z = {0: [(0, 0, 1), (1, 0, 0), (0, 1, 0)], 1: [(0, 1, 0), (0, 0, 1), (1, 0, 0)], 2: np.eye(3)}
    out = []
    for axis in range(3):
        pose = np.eye(4)
        pose[:3, :3] = np.asarray(from_z[axis], dtype=float)
        out.append(along_z.moved(pose).coloured(AXIS_COLOURS[axis]))
    return out[0], out[1], out[2]


def ball(radius: float, rgba: RGBA, around: int = 24) -> Surface:
    """A ball about the origin.

    Args:
        radius: Its radius [m].
        rgba: Its colour.
        around: Facets around it.

    Returns:
        The surface.
    """
    return _ellipsoid((radius,) * 3, rgba, around)


def arrow(rgba: RGBA, around: int = 20) -> tuple[Surface, Surface]:
    """The shaft and the tip of an arrow along z, each of length 1 and radius 1, from the origin up.

    Args:
        rgba: Its colour.
        around: Facets around it.

    Returns:
        Shaft and tip.
    """
    shaft = [_straight_strip((0, 0), (1, 0)), _straight_strip((1, 0), (1, 1))]
    tip = [_straight_strip((0, 0), (1, 0)), _straight_strip((1, 0), (0, 1))]
    return _revolve(shaft, rgba, around), _revolve(tip, rgba, around)


def tube(points: ArrayLike, radius: float, rgba: RGBA, around: int = 8) -> Surface:
    """A tube along a polyline.

    Args:
        points: The polyline [m], shape (n, 3).
        radius: Radius of the tube [m].
        rgba: The colour.
        around: Facets around it.

    Returns:
        The surface; without triangles where all points coincide.
    """
    path = np.asarray(points, dtype=float).reshape(-1, 3)
    if len(path) > 1:  # one ring for every half radius of way, and one at the end
        arc_length = np.concatenate([[0.0], np.linalg.norm(np.diff(path, axis=0), axis=1).cumsum()])
        step = np.floor(arc_length / (0.5 * radius))
        keep = np.concatenate([[True], step[1:] > step[:-1]])
        keep[-1] = arc_length[-1] > 0.0
        path = path[keep]
    if len(path) < 2:
        empty = np.zeros((0, 3))
        return Surface(empty, empty, empty, rgba)
    tangent = normalized(np.asarray(np.gradient(path, axis=0)))
    # carry one normal along the path, so that the tube does not twist
    helper = np.eye(3)[np.argmin(np.abs(tangent[0]))]
    normal = np.empty_like(path)
    current = helper
    for i, t in enumerate(tangent):
        current = current - t * (current @ t)
        current = current / max(float(np.linalg.norm(current)), 1e-12)
        normal[i] = current
    binormal = np.cross(tangent, normal)
    angle = np.linspace(0, 2 * np.pi, around, endpoint=False)
    ring = np.cos(angle)[:, None, None] * normal + np.sin(angle)[:, None, None] * binormal  # (around, n, 3)
    ring = ring.transpose(1, 0, 2)
    vertices = path[:, None, :] + radius * ring
    i = np.arange(len(path) - 1)[:, None] * around
    j = np.arange(around)[None, :]
    k = (j + 1) % around
    a, b, c, d = i + j, i + k, i + around + j, i + around + k
    triangles = np.stack([np.stack([a, b, d], -1), np.stack([a, d, c], -1)], axis=2)
    return Surface(vertices, triangles, ring, rgba)


def _box(size: tuple[float, ...], rgba: RGBA) -> Surface:
    half = np.asarray(size) / 2
    vertices, normals, triangles = [], [], []
    for axis in range(3):
        u, v = np.eye(3)[(axis + 1) % 3], np.eye(3)[(axis + 2) % 3]
        for sign in (-1.0, 1.0):
            n = sign * np.eye(3)[axis]
            corners = [n - u * sign - v, n + u * sign - v, n + u * sign + v, n - u * sign + v]
            first = len(vertices)
            vertices += [c * half for c in corners]
            normals += [n] * 4
            triangles += [(first, first + 1, first + 2), (first, first + 2, first + 3)]
    return Surface(np.array(vertices), np.array(triangles), np.array(normals), rgba)


def _ellipsoid(radii: tuple[float, ...], rgba: RGBA, around: int) -> Surface:
    ball = _revolve([_capsule_profile(1.0, 0.0, around)], rgba, around)
    return ball.moved(np.eye(4), radii)


def _straight_strip(start: tuple[float, float], end: tuple[float, float]) -> Floats:
    """A straight strip of a profile from (r, z) to (r, z), its normal to the right of the way."""
    (r0, z0), (r1, z1) = start, end
    nr, nz = z1 - z0, r0 - r1
    size = max(float(np.hypot(nr, nz)), 1e-300)
    return np.array([(r0, z0, nr / size, nz / size), (r1, z1, nr / size, nz / size)])


def _cylinder_profile(radius: float, length: float) -> list[Floats]:
    h = length / 2
    return [
        _straight_strip((0, -h), (radius, -h)),
        _straight_strip((radius, -h), (radius, h)),
        _straight_strip((radius, h), (0, h)),
    ]


def _cone_profile(radius: float, length: float) -> list[Floats]:
    h = length / 2
    steps = np.linspace(0, 1, 7)  # several rings, so that the normals near the tip stay good
    side = _straight_strip((radius, -h), (0, h))
    side = side[0] + steps[:, None] * (side[1] - side[0])
    return [_straight_strip((0, -h), (radius, -h)), side]


def _capsule_profile(radius: float, length: float, around: int) -> Floats:
    latitude = np.linspace(-np.pi / 2, np.pi / 2, 2 * max(around // 4, 2) + 1)
    c, s = np.cos(latitude), np.sin(latitude)
    c[0] = c[-1] = 0.0
    strip = np.stack([radius * c, radius * s, c, s], axis=1)
    half = len(strip) // 2
    low, high = strip[: half + 1].copy(), strip[half:].copy()
    low[:, 1] -= length / 2
    high[:, 1] += length / 2
    return np.concatenate([low, high]) if length > 0 else strip


def _revolve(strips: list[Floats], rgba: RGBA, around: int) -> Surface:
    """The surface of revolution about z of profile strips, rows (r, z, normal r, normal z), going up."""
    angle = np.linspace(0, 2 * np.pi, around, endpoint=False)
    c, s = np.cos(angle), np.sin(angle)
    vertices, normals, triangles = [], [], []
    first = 0
    for strip in strips:
        r, z, nr, nz = (strip[:, k, None] for k in range(4))
        vertices.append(
            np.stack([r * c, r * s, np.broadcast_to(z, (len(strip), around))], axis=-1).reshape(-1, 3)
        )
        normals.append(
            np.stack([nr * c, nr * s, np.broadcast_to(nz, (len(strip), around))], axis=-1).reshape(-1, 3)
        )
        i = first + np.arange(len(strip) - 1)[:, None] * around
        j = np.arange(around)[None, :]
        k = (j + 1) % around
        a, b, e, f = i + j, i + k, i + around + j, i + around + k
        lower = np.stack([a, b, f], axis=-1)[strip[:-1, 0] > 0].reshape(-1, 3)
        upper = np.stack([a, f, e], axis=-1)[strip[1:, 0] > 0].reshape(-1, 3)
        triangles += [lower, upper]
        first += len(strip) * around
    return Surface(np.concatenate(vertices), np.concatenate(triangles), np.concatenate(normals), rgba)
