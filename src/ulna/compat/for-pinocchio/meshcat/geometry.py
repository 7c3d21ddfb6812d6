"""MeshCat's geometries, materials and objects, as data. Cylinders are about y, as in three.js.

What only concerns shading (`reflectivity`, `side`, `shininess` ...) is kept and plays no part in the viewer.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from meshcat.materials import (
    GenericMaterial,
    LineBasicMaterial,
    Material,
    MeshBasicMaterial,
    MeshLambertMaterial,
    MeshPhongMaterial,
    MeshToonMaterial,
    PointsMaterial,
    ReferenceSceneElement,
    SceneElement,
)
from ulna.errors import ShapeError
from ulna.typing import Floats

__all__ = [
    "Box",
    "Cylinder",
    "DaeMeshGeometry",
    "Ellipsoid",
    "GenericMaterial",
    "Geometry",
    "Line",
    "LineBasicMaterial",
    "LineLoop",
    "LineSegments",
    "Material",
    "Mesh",
    "MeshBasicMaterial",
    "MeshGeometry",
    "MeshLambertMaterial",
    "MeshPhongMaterial",
    "MeshToonMaterial",
    "ObjMeshGeometry",
    "Object",
    "PerspectiveCamera",
    "PointCloud",
    "Points",
    "PointsGeometry",
    "PointsMaterial",
    "ReferenceSceneElement",
    "SceneElement",
    "Sphere",
    "StlMeshGeometry",
    "TriangularMeshGeometry",
    "triad",
]


class Geometry(ReferenceSceneElement):
    """A form without a material."""

    def intrinsic_transform(self) -> Floats:
        """What the form is stretched by, (4, 4)."""
        return np.eye(4)


class Box(Geometry):
    """A box about the origin.

    Args:
        lengths: Edges along x, y, z [m].
    """

    def __init__(self, lengths: Any) -> None:
        self.lengths = lengths


class Sphere(Geometry):
    """A sphere about the origin.

    Args:
        radius: Radius [m].
    """

    def __init__(self, radius: float) -> None:
        self.radius = radius


class Ellipsoid(Sphere):
    """An ellipsoid about the origin.

    Args:
        radii: Half axes along x, y, z [m].
    """

    def __init__(self, radii: Any) -> None:
        super().__init__(1.0)
        self.radii = radii

    def intrinsic_transform(self) -> Floats:
        """What the unit sphere is stretched by, (4, 4)."""
        return np.diag(np.hstack((self.radii, 1.0)))


class Cylinder(Geometry):
    """A cylinder or truncated cone about y, centred at the origin.

    Args:
        height: Length along y [m].
        radius: Radius [m], unless both others are given.
        radiusTop: Radius at positive y [m].
        radiusBottom: Radius at negative y [m].
    """

    def __init__(
        self,
        height: float,
        radius: float = 1.0,
        radiusTop: float | None = None,
        radiusBottom: float | None = None,
    ) -> None:
        both = radiusTop is not None and radiusBottom is not None
        self.radiusTop, self.radiusBottom = (radiusTop, radiusBottom) if both else (radius, radius)
        self.height = height
        self.radialSegments = 50


class TriangularMeshGeometry(Geometry):
    """Triangles.

    Args:
        vertices: Positions, (n, 3) [m].
        faces: Indices of vertices, (m, 3).
        color: Red, green, blue from 0 to 1 of each vertex, (n, 3); they count where the material has `vertexColors`.

    Raises:
        ShapeError: Other shapes.
    """

    def __init__(self, vertices: Any, faces: Any, color: Any = None) -> None:
        self.vertices = _rows("vertices", np.asarray(vertices, dtype=np.float32))
        self.faces = _rows("faces", np.asarray(faces, dtype=np.uint32))
        self.color = None if color is None else _rows("color", np.asarray(color, dtype=np.float32))
        if self.color is not None and self.color.shape != self.vertices.shape:
            raise ShapeError("color", self.color.shape, f"{self.vertices.shape}, one for each vertex")


def _rows(name: str, values: Any) -> Any:
    if values.ndim != 2 or values.shape[1] != 3:
        raise ShapeError(name, values.shape, "(n, 3)")
    return values


class PointsGeometry(Geometry):
    """Points, or the ends of lines.

    Args:
        position: Positions as columns, (3, n) [m].
        color: Red, green, blue from 0 to 1 as columns, (3, n); None for the material's.
    """

    def __init__(self, position: Any, color: Any = None) -> None:
        self.position, self.color = position, color


class MeshGeometry(Geometry):
    """The content of a mesh file.

    Args:
        contents: Text, or bytes.
        mesh_format: "obj", "dae" or "stl".
    """

    mesh_format = ""

    def __init__(self, contents: Any, mesh_format: str | None = None) -> None:
        self.contents = contents
        self.mesh_format = mesh_format or self.mesh_format

    @classmethod
    def from_file(cls, fname: Any) -> MeshGeometry:
        """The content of a file.

        Raises:
            OSError: It cannot be read.
        """
        return cls(Path(fname).read_bytes())

    @classmethod
    def from_stream(cls, f: Any) -> MeshGeometry:
        """What can be read from an open file."""
        return cls(f.read())


class ObjMeshGeometry(MeshGeometry):
    """The content of an OBJ file."""

    mesh_format = "obj"


class DaeMeshGeometry(MeshGeometry):
    """The content of a COLLADA file."""

    mesh_format = "dae"


class StlMeshGeometry(MeshGeometry):
    """The content of an STL file."""

    mesh_format = "stl"


class Object(SceneElement):
    """A form with a material.

    Args:
        geometry: The form.
        material: How it looks; white when not given.
    """

    def __init__(self, geometry: Geometry, material: Material | None = None) -> None:
        self.geometry = geometry
        self.material = MeshPhongMaterial() if material is None else material


class Mesh(Object):
    """Surfaces."""


class Points(Object):
    """Points."""


class Line(Object):
    """A line from point to point."""


class LineSegments(Object):
    """A line from each point of even number to the next."""


class LineLoop(Object):
    """A line from point to point, and back to the first."""


class PerspectiveCamera(SceneElement):
    """The lens of the camera.

    Args:
        fov: Vertical field of view [degrees].
        aspect: Kept; the window's counts [-].
        near: Kept [m].
        far: Kept [m].
        zoom: Factor by which things appear larger [-].
        **kwargs: Properties of three.js; kept.
    """

    def __init__(
        self,
        fov: float = 50,
        aspect: float = 1,
        near: float = 0.1,
        far: float = 2000,
        zoom: float = 1,
        **kwargs: Any,
    ) -> None:
        self.fov, self.aspect, self.near, self.far, self.zoom = fov, aspect, near, far, zoom
        self.properties = kwargs


def PointCloud(position: Any, color: Any, **kwargs: Any) -> Points:
    """Points with colours.

    Args:
        position: Positions as columns, (3, n) [m].
        color: Red, green, blue from 0 to 1 as columns, (3, n).
        **kwargs: `size` [m] and `color` of `PointsMaterial`.

    Returns:
        The object.
    """
    return Points(PointsGeometry(position, color), PointsMaterial(**kwargs))


def triad(scale: float = 1.0) -> LineSegments:
    """The axes x, y, z as lines in red, green, blue.

    Args:
        scale: Their length [m].

    Returns:
        The object.
    """
    ends = np.zeros((3, 6))
    ends[[0, 1, 2], [1, 3, 5]] = scale
    return LineSegments(
        PointsGeometry(ends, np.repeat(np.eye(3), 2, axis=1)), LineBasicMaterial(vertexColors=True)
    )
