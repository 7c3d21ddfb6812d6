"""Simple shapes as triangles: closed, the right size, turned outwards."""

import numpy as np
import pytest

from ulna.errors import InputError
from ulna.geometry import Box, Capsule, Cone, Cylinder, Ellipsoid, Mesh, Plane, Shape, Sphere
from ulna.viewer.mesh.primitives import AXIS_COLOURS, axes, tessellate, tube
from ulna.viewer.mesh.surface import Surface

PI = np.pi
SOLIDS: list[tuple[Shape, float, tuple[float, float, float]]] = [
    (Box((0.2, 0.3, 0.4)), 0.2 * 0.3 * 0.4, (0.2, 0.3, 0.4)),
    (Sphere(0.5), 4 / 3 * PI * 0.125, (1.0, 1.0, 1.0)),
    (Cylinder(0.2, 0.7), PI * 0.04 * 0.7, (0.4, 0.4, 0.7)),
    (Capsule(0.2, 0.5), PI * 0.04 * 0.5 + 4 / 3 * PI * 0.008, (0.4, 0.4, 0.9)),
    (Capsule(0.2, 0.0), 4 / 3 * PI * 0.008, (0.4, 0.4, 0.4)),
    (Cone(0.3, 0.6), PI * 0.09 * 0.6 / 3, (0.6, 0.6, 0.6)),
    (Ellipsoid((0.1, 0.2, 0.3)), 4 / 3 * PI * 0.006, (0.2, 0.4, 0.6)),
]
IDS = [type(s).__name__ for s, _, _ in SOLIDS]


def volume(surface: Surface) -> float:
    a, b, c = (surface.vertices[surface.triangles[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


@pytest.mark.parametrize(("shape", "expected", "size"), SOLIDS, ids=IDS)
def test_volume_and_extent(shape: Shape, expected: float, size: tuple[float, float, float]) -> None:
    surface = tessellate(shape, around=96)
    assert volume(surface) == pytest.approx(expected, rel=0.01)
    np.testing.assert_allclose(np.ptp(surface.vertices, axis=0), size, rtol=2e-3)
    np.testing.assert_allclose(surface.vertices.max(axis=0) + surface.vertices.min(axis=0), 0, atol=1e-12)


@pytest.mark.parametrize(("shape", "expected", "size"), SOLIDS, ids=IDS)
def test_closed_and_turned_outwards(shape: Shape, expected: float, size: tuple[float, float, float]) -> None:
    surface = tessellate(shape)
    a, b, c = (surface.vertices[surface.triangles[:, k]] for k in range(3))
    facing = np.cross(b - a, c - a)
    assert (np.linalg.norm(facing, axis=1) > 1e-12).all()
    np.testing.assert_allclose(facing.sum(axis=0), 0, atol=1e-9)  # the area of a closed surface cancels
    np.testing.assert_allclose(np.linalg.norm(surface.normals, axis=1), 1.0, atol=1e-9)
    mean = surface.normals[surface.triangles].mean(axis=1)
    assert (np.einsum("ij,ij->i", facing, mean) > 0).all()


def test_a_plane_is_a_sheet_facing_up() -> None:
    sheet = tessellate(Plane((2.0, 4.0)))
    np.testing.assert_allclose(np.ptp(sheet.vertices, axis=0), (2, 4, 0))
    assert (sheet.normals == (0, 0, 1)).all()


def test_meshes_are_not_simple_shapes() -> None:
    with pytest.raises(InputError, match="Cannot tessellate"):
        tessellate(Mesh("a.stl"))


def test_axes_point_where_their_colours_say() -> None:
    for k, arrow in enumerate(axes(0.2)):
        assert arrow.rgba == AXIS_COLOURS[k]
        assert arrow.vertices[:, k].max() == pytest.approx(0.2)
        assert np.delete(arrow.vertices, k, axis=1).max() < 0.02
        assert volume(arrow) > 0


def test_a_tube_follows_its_points_to_both_ends() -> None:
    angle = np.linspace(0, 3, 500)
    points = np.stack([np.cos(angle), np.sin(angle), 0.1 * angle], axis=1)
    line = tube(points, 0.01, (1.0, 0.0, 0.0, 1.0))
    distance = np.linalg.norm(line.vertices[:, None] - points[None], axis=2)
    np.testing.assert_allclose(distance.min(axis=1), 0.01, rtol=0.02)
    assert distance[:, 0].min() < 0.0101
    assert distance[:, -1].min() < 0.0101


@pytest.mark.parametrize("points", [[], [(0, 0, 0)], [(0, 0, 0), (0, 0, 0)]])
def test_a_tube_of_no_length_is_empty(points: list[tuple[float, float, float]]) -> None:
    assert len(tube(points, 0.01, (1.0, 0.0, 0.0, 1.0)).triangles) == 0


def test_a_tube_of_steps_far_smaller_than_its_radius_reaches_its_end() -> None:
    points = np.zeros((1000, 3))
    points[:, 0] = np.linspace(0, 0.1, 1000)
    assert tube(points, 0.004, (1.0, 0.0, 0.0, 1.0)).vertices[:, 0].max() == pytest.approx(0.1)
