"""Shapes and geometries are checked values."""

from __future__ import annotations

import math
import pickle

import numpy as np
import pytest

from ulna.errors import InputError
from ulna.geometry import (
    Box,
    Capsule,
    Cone,
    Cylinder,
    Ellipsoid,
    Geometry,
    Material,
    Mesh,
    Plane,
    Shape,
    Sphere,
)
from ulna.spatial import SE3

SHAPES: list[Shape] = [
    Box((0.1, 0.2, 0.3)),
    Sphere(0.5),
    Cylinder(0.1, 0.4),
    Capsule(0.1, 0.4),
    Cone(0.1, 0.4),
    Ellipsoid((0.1, 0.2, 0.3)),
    Plane(),
    Plane((1.0, 2.0)),
    Mesh("some/folder/part.stl", (0.001, 0.001, 0.001)),
    Mesh(None, missing=True),
]


@pytest.mark.parametrize("shape", SHAPES, ids=lambda s: s.describe())
def test_a_shape_is_a_value(shape: Shape) -> None:
    copy = pickle.loads(pickle.dumps(shape))
    assert copy == shape
    assert hash(copy) == hash(shape)
    assert sum(shape == other for other in SHAPES) == 1


def test_sizes_become_tuples_of_floats() -> None:
    assert Box(np.array([1, 2, 3])).size == (1.0, 2.0, 3.0)  # type: ignore[arg-type]
    assert isinstance(Sphere(np.float32(1)).radius, float)  # type: ignore[arg-type]
    assert Box([1, 2, 3]) == Box((1.0, 2.0, 3.0))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: Box((1.0, 2.0)), "Box: `size` has 2 numbers; expected 3 lengths"),  # type: ignore[arg-type]
        (lambda: Box((1.0, 2.0, -3.0)), "Box: `size` .* not negative"),
        (lambda: Sphere(math.nan), "Sphere: `radius` .* finite"),
        (lambda: Sphere("big"), "Sphere: `radius`"),  # type: ignore[arg-type]
        (lambda: Cylinder(1.0, -1.0), "Cylinder: `length`"),
        (lambda: Capsule(-1.0, 1.0), "Capsule: `radius`"),
        (lambda: Cone(1.0, math.inf), "Cone: `length`"),
        (lambda: Ellipsoid((1.0, 1.0, math.nan)), "Ellipsoid: `radii`"),
        (lambda: Plane((1.0, -1.0)), "Plane: `size`"),
        (lambda: Mesh("a.stl", (1.0, 1.0)), "Mesh: `scale`"),  # type: ignore[arg-type]
        (lambda: Mesh("a.stl", (1.0, 1.0, math.nan)), "Mesh: `scale`"),
        (lambda: Mesh("a.stl", 2.0), "Mesh: `scale`"),  # type: ignore[arg-type]
        (lambda: Material("m", (1.0, 1.0, 1.0)), "Material 'm': `rgba`"),  # type: ignore[arg-type]
        (lambda: Material("m", "red"), "Material 'm': `rgba`"),  # type: ignore[arg-type]
    ],
)
def test_impossible_sizes_are_refused(make, says: str) -> None:
    with pytest.raises(InputError, match=says):
        make()


def test_a_colour_becomes_a_tuple_of_floats() -> None:
    colour = Material("m", [1, 0, np.float32(0.5), 1]).rgba  # type: ignore[arg-type]
    assert colour == (1.0, 0.0, 0.5, 1.0) and isinstance(colour, tuple)
    assert all(type(c) is float for c in colour)
    assert hash(Material("m", [1, 0, 0, 1])) == hash(Material("m", (1.0, 0.0, 0.0, 1.0)))  # type: ignore[arg-type]
    assert Material("m").rgba is None


def test_a_mesh_knows_its_file_name() -> None:
    assert Mesh("some/folder/part.stl").file_name == "part.stl"
    assert Mesh("some\\folder\\part.stl").file_name == "part.stl"
    assert Mesh("package://robot/part.stl").file_name == "part.stl"
    assert Mesh(None).file_name == ""
    assert "missing" in Mesh("part.stl", missing=True).describe()


def test_a_geometry_is_a_value() -> None:
    a = Geometry("g", Sphere(1.0), SE3.trans(0.0, 0.0, 1.0), Material("red", (1, 0, 0, 1)))
    b = Geometry("g", Sphere(1.0), SE3.trans(-0.0, 0.0, 1.0), Material("red", (1.0, 0.0, 0.0, 1.0)))
    assert a == b
    assert hash(a) == hash(b)
    assert pickle.loads(pickle.dumps(a)) == a
    assert a != Geometry("g", Sphere(1.0), SE3.trans(0.0, 0.0, 2.0), a.material)
    assert Geometry("g", Sphere(1.0)).placement == SE3.identity()
