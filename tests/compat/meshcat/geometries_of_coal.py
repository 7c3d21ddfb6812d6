"""Hulls, height fields, octrees, point clouds, planes and triangles of coal are drawn where they are."""

from __future__ import annotations

import coal
import numpy as np
import pinocchio as pin
from pinocchio.visualize import MeshcatVisualizer

import ulna
from ulna.viewer.graph.content import Copies, Points

rng = np.random.default_rng(3)
points = rng.random((40, 3))


def cloud() -> coal.BVHModelOBBRSS:
    mesh = coal.BVHModelOBBRSS()
    mesh.beginModel(0, len(points))
    mesh.addVertices(points)
    return mesh


def hull() -> coal.Convex:
    mesh = cloud()
    mesh.addTriangle(*points[:3])
    mesh.endModel()
    mesh.buildConvexHull(True, "Qt")
    return mesh.convex


def without_triangles() -> coal.ConvexBase:
    corners = coal.StdVec_Vec3s()
    corners.extend(list(points))
    return coal.Convex.convexHull(corners, False, "")


heights = rng.random((6, 4))
shapes = {
    "cloud": cloud(),
    "hull": hull(),
    "bare": without_triangles(),
    "field": coal.HeightFieldOBBRSS(1.0, 1.5, heights, -0.2),
    "tree": coal.makeOctree(points, 0.1),
    "plane": coal.Plane(np.array([0.0, 0.0, 1.0]), -1.0),
    "half": coal.Halfspace(np.array([0.0, 2.0, 0.0]), 3.0),
    "triangle": coal.TriangleP(*points[:3]),
}
model, looks = pin.Model(), pin.GeometryModel()
for name, shape in shapes.items():
    looks.addGeometryObject(pin.GeometryObject(name, 0, pin.SE3.Identity(), shape))
viz = MeshcatVisualizer(model, pin.GeometryModel(), looks)
viz.initViewer(ulna.Viewer(page=False), loadModel=True)
nodes = {name: viz.viewer.gui.scene.node(f"pinocchio/visuals/{name}") for name in shapes}

content = nodes["cloud"].content
assert isinstance(content, Points)
np.testing.assert_allclose(content.positions, points)
content = nodes["tree"].content
assert isinstance(content, Copies)
inside = np.abs(points[:, None] - content.poses[None, :, :3, 3]).max(axis=2).min(axis=1)
assert inside.max() <= 0.05 + 1e-6 and content.scales is not None and np.allclose(content.scales, 0.1)


def volume(name: str) -> float:
    """What closed triangles contain, by the divergence theorem."""
    (surface,) = nodes[name].surfaces
    a, b, c = (surface.vertices[surface.triangles[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


np.testing.assert_allclose(volume("hull"), shapes["hull"].computeVolume(), rtol=1e-9)
np.testing.assert_allclose(volume("bare"), volume("hull"), rtol=1e-9)
cells = (heights[:-1, :-1] + heights[1:, 1:]) / 3 + (
    heights[1:, :-1] + heights[:-1, 1:]
) / 6  # by the diagonal
np.testing.assert_allclose(volume("field"), ((cells + 0.2) * (1 / 3) * (1.5 / 5)).sum(), rtol=1e-6)
corners = nodes["field"].surfaces[0].vertices
for i, y in enumerate(shapes["field"].getYGrid()):
    for j, x in enumerate(shapes["field"].getXGrid()):
        assert np.abs(corners - (x, y, heights[i, j])).max(axis=1).min() < 1e-6
np.testing.assert_allclose(nodes["plane"].surfaces[0].vertices[:, 2], -1.0)
np.testing.assert_allclose(
    nodes["half"].surfaces[0].vertices[:, 1], 1.5
)  # coal divides by the normal's length
assert len(nodes["triangle"].surfaces[0].triangles) == 2

# an SE3 is taken wherever coal takes a Transform3s
apart = pin.SE3(np.eye(3), np.array([2.0, 0.0, 0.0]))
np.testing.assert_array_equal(coal.Transform3s(apart).getTranslation(), apart.translation)
balls = coal.Sphere(0.5), coal.Sphere(0.3)
asked = (balls[0], pin.SE3.Identity(), balls[1], apart, coal.DistanceRequest(), coal.DistanceResult())
assert abs(coal.distance(*asked) - 1.2) < 1e-9
moved = coal.CollisionObject(balls[0], apart)
moved.setTransform(pin.SE3.Identity())
np.testing.assert_array_equal(moved.getTranslation(), np.zeros(3))
