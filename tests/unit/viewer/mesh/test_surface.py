"""Surfaces: checked on entry, moved, scaled, mirrored, painted."""

import numpy as np
import pytest

from ulna.errors import InputError, ShapeError
from ulna.viewer.mesh.surface import Surface, albedo, colour, linear_from_srgb, normalized

CORNERS = np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 2.0, 0.0)])


def triangle() -> Surface:
    return Surface(CORNERS, np.array([(0, 1, 2)]), np.tile((0.0, 0.0, 1.0), (3, 1)), (1.0, 0.0, 0.0, 1.0))


def facing(surface: Surface) -> np.ndarray:
    a, b, c = surface.vertices[surface.triangles[0]]
    normal = np.cross(b - a, c - a)
    return normal / np.linalg.norm(normal)


def test_a_surface_is_read_only() -> None:
    with pytest.raises(ValueError):
        triangle().vertices[0, 0] = 1.0


def test_indices_must_be_vertices() -> None:
    with pytest.raises(InputError, match="outside the 3 vertices"):
        Surface(CORNERS, np.array([(0, 1, 3)]), CORNERS)


def test_each_vertex_needs_a_normal() -> None:
    with pytest.raises(ShapeError, match="one for each vertex"):
        Surface(CORNERS, np.array([(0, 1, 2)]), CORNERS[:2])


@pytest.mark.parametrize("scale", [(1, 1, 1), (2, 3, 4), (-1, 1, 1), (-1, -1, 1), (-2, -1, -0.5)])
def test_normals_go_with_the_triangles_even_when_mirrored(scale: tuple[float, float, float]) -> None:
    pose = np.eye(4)
    pose[:3, :3] = [(0, -1, 0), (1, 0, 0), (0, 0, 1)]
    pose[:3, 3] = (1, 2, 3)
    moved = triangle().moved(pose, scale)
    np.testing.assert_allclose(moved.vertices, CORNERS * scale @ pose[:3, :3].T + pose[:3, 3])
    np.testing.assert_allclose(np.abs(facing(moved) @ moved.normals[0]), 1.0)
    assert np.sign(facing(moved) @ moved.normals[0]) == np.sign(facing(triangle()) @ triangle().normals[0])


def test_a_scale_of_zero_leaves_finite_normals() -> None:
    moved = triangle().moved(np.eye(4), (1.0, 0.0, 1.0))
    assert np.isfinite(moved.normals).all()
    np.testing.assert_allclose(np.linalg.norm(moved.normals, axis=1), 1.0)


def test_colours_are_checked() -> None:
    for wrong in [(1.0,), (1, 2, 3, 4, 5), (0.1, np.nan, 0.2)]:
        with pytest.raises(InputError, match="3 or 4 finite numbers"):
            colour(wrong)


def test_paint_keeps_white_below_white_and_black_above_black_and_does_not_grey_red() -> None:
    white, black, red = albedo(np.array([(1.0, 1.0, 1.0), (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)]))
    assert 0.6 < white[0] < 0.8
    assert 0.01 < black[0] < 0.1
    assert red[1] == red[2] == 0.0


def test_srgb_is_undone_at_its_known_points() -> None:
    np.testing.assert_allclose(
        linear_from_srgb([0.0, 0.04045, 0.5, 1.0]), [0, 0.04045 / 12.92, 0.21404114, 1.0]
    )


@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_vectors_without_a_direction_have_one_in_every_type(kind: type) -> None:
    """1e-300, below which a vector counts as too short, is 0 as float32: pictures of a line that turns back divided by it."""
    vectors = np.array([(0.0, 0.0, 0.0), (0.0, 2.0, 0.0)], dtype=kind)
    with np.errstate(all="raise"):
        np.testing.assert_array_equal(normalized(vectors), [(0.0, 0.0, 1.0), (0.0, 1.0, 0.0)])
