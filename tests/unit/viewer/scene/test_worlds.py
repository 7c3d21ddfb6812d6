"""Worlds of collision checks in a scene."""

from __future__ import annotations

import numpy as np
import pytest

import ulna
from ulna.collision import World
from ulna.errors import InputError, UnknownName
from ulna.geometry import Box, Cylinder, HeightField, PointCloud
from ulna.viewer.mesh.primitives import tessellate


def test_obstacles_stand_and_attached_objects_move_with_their_links() -> None:
    viewer, robot = ulna.Viewer(page=False), ulna.load("panda")
    arm = viewer.add(robot)
    cloud = PointCloud(np.random.default_rng(0).uniform(size=(50, 3)), 0.01)
    world = World().add("box", Box((0.1, 0.1, 0.1)), (0.4, 0.0, 0.0)).add("scan", cloud, (0.0, 0.5, 0.0))
    world = world.attach("can", "panda_hand", (0.0, 0.0, 0.1), shape=Cylinder(0.03, 0.12))
    handles = viewer.world(world, arm, color="red")
    assert list(handles) == ["box", "scan", "can"] and handles["scan"].name == "world/scan"
    np.testing.assert_allclose(handles["box"].world_pose[:3, 3], [0.4, 0.0, 0.0])
    for q in (arm.q, robot.configurations["ready"]):
        arm.q = q
        expected = robot.fk(q, "panda_hand") @ world.attached("can").pose.matrix()
        np.testing.assert_allclose(handles["can"].world_pose, expected, atol=1e-9)
    assert viewer.world(world)["can"].name == handles["can"].name  # the only robot carries it
    with pytest.raises(InputError, match="links carry 'can'; expected the handle"):
        ulna.Viewer(page=False).world(world)
    with pytest.raises(InputError, match="expected a World"):
        viewer.world([world])  # type: ignore[arg-type]
    with pytest.raises(UnknownName, match="panda_hand"):
        viewer.world(World().attach("can", "panda_hnd", shape=Cylinder(0.03, 0.12)), arm)


def test_clouds_and_height_fields_are_drawn_where_they_are() -> None:
    points = np.random.default_rng(1).uniform(size=(30, 3))
    surface = tessellate(PointCloud(points, 0.01))
    assert len(surface.triangles) == 240
    np.testing.assert_allclose(surface.vertices.reshape(30, 6, 3).mean(axis=1), points, atol=1e-12)
    corners = surface.vertices[surface.triangles]
    outward = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    middles = np.repeat(points, 8, axis=0)
    assert ((corners.mean(axis=1) - middles) * outward).sum(axis=1).min() > 0.0
    assert len(tessellate(PointCloud(np.zeros((90_000, 3)))).vertices) <= 6 * 20_000
    field = HeightField([[0.0, 1.0], [0.0, 1.0], [0.0, 1.0]], (2.0, 1.0))
    surface = tessellate(field)
    assert len(surface.triangles) == 4 and (surface.normals[:, 2] > 0.0).all()
    np.testing.assert_allclose(surface.vertices[:, 2], surface.vertices[:, 1] + 0.5)
