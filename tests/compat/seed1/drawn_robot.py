"""The robot's nodes are where its geometries are, in all visualizers' spellings; wrong calls raise."""

import sys
from typing import Any

import numpy as np
import pinocchio as pin
from gepetto.corbaserver import Client, shared_viewer
from pinocchio.robot_wrapper import RobotWrapper
from pinocchio.visualize import GepettoVisualizer, MeshcatVisualizer, ViserVisualizer, Visualizer

import ulna


def refused(call: Any, *words: str) -> None:
    try:
        call()
    except Exception as error:
        assert all(word in str(error) for word in words), error
    else:
        raise AssertionError(words)


def check(viz: Any, root: str) -> None:
    scene = viz.viewer.gui.scene
    for kind, model, data in (
        (pin.GeometryType.VISUAL, viz.visual_model, viz.visual_data),
        (pin.GeometryType.COLLISION, viz.collision_model, viz.collision_data),
    ):
        pin.updateGeometryPlacements(viz.model, viz.data, model, data)
        for geometry, M in zip(model.geometryObjects, data.oMg, strict=True):
            name = viz.getViewerNodeName(geometry, kind)
            assert name == f"{root}/{'visuals' if kind == 0 else 'collisions'}/{geometry.name}"
            if viz._shown[kind]:
                np.testing.assert_allclose(scene.poses[scene.row(name)], M.homogeneous, atol=1e-14)


def wrapper(robot: RobotWrapper) -> None:
    refused(lambda: robot.viewer, "initViewer(loadModel=True)")
    refused(lambda: robot.getViewerNodeName(robot.visual_model.geometryObjects[0], 0), "initViewer")
    refused(lambda: robot.display(robot.q0), "initViewer")
    refused(lambda: robot.placement(robot.q0, robot.index("wrist_3")), "'wrist_3_joint'")
    refused(lambda: robot.placement(robot.q0, 7), "0 to 6", "robot.index")
    refused(lambda: robot.placment, "'placement'")
    refused(lambda: robot.framePlacement(robot.q0, 10**7), "getFrameId")
    robot.initViewer(loadModel=True)
    assert isinstance(robot.viz, GepettoVisualizer) and Visualizer.default() is GepettoVisualizer
    assert robot.viewer.viewer is shared_viewer() is Client().viewer
    q = np.linspace(0.1, 0.6, 6)
    robot.display(q)
    check(robot.viz, "world/pinocchio")
    robot.displayCollisions(True)
    robot.displayVisuals(False)
    check(robot.viz, "world/pinocchio")
    seen = robot.viewer.gui.scene.snapshot()
    for node, visible in zip(seen.nodes, seen.visible, strict=True):
        assert visible == ("/visuals" not in node.name)
    robot.displayVisuals(True)
    robot.viz.displayFrames(True, [robot.model.getFrameId("tool0")])
    robot.display(q)
    here = robot.framePlacement(q, robot.model.getFrameId("tool0")).homogeneous
    name = next(n for n in robot.viewer.gui.getNodeList() if "/frames/" in n and "tool0" in n)
    np.testing.assert_allclose(robot.viewer.gui.scene.pose(name), here, atol=1e-14)
    robot.viz.displayFrames(False)
    refused(lambda: robot.display(np.zeros(5)), "(5,)", "(6,)")
    robot.play(np.array([q, q + 0.1]).T[:, :2], 0.01)  # columns, as older scripts have them
    np.testing.assert_allclose(robot.data.oMi[6].translation, robot.placement(q + 0.1, 6).translation)
    robot.initDisplay("another", "stage", loadModel=True)
    check(robot.viz, "stage/pinocchio")
    assert "stage" in robot.viewer.gui.getSceneList() and "another" in robot.viewer.gui.getWindowList()
    robot.viz.clean()
    refused(lambda: robot.display(q), "initViewer")


def others(robot: RobotWrapper, folder: str) -> None:
    for kind in (MeshcatVisualizer, ViserVisualizer):
        viz = kind(robot.model, robot.collision_model, robot.visual_model)
        viz.initViewer(ulna.Viewer(page=False), loadModel=True)
        viz.display(robot.q0 + 0.2)
        check(viz, "pinocchio")
        viz.setCameraTarget((0.0, 0.0, 0.5))
        viz.setCameraPosition((1.0, 1.0, 1.0))
        viz.setCameraZoom(2.0)
        viz.setBackgroundColor("white")
        assert viz.viewer.viewer.camera.position == (1.0, 1.0, 1.0)
        refused(lambda viz=viz: viz.setCameraPreset("presett1"), "preset1")
        target, position = viz.CAMERA_PRESETS["talos2"]
        viz.setCameraPreset("talos2")
        camera = viz.viewer.viewer.camera
        assert (list(camera.target), list(camera.position)) == (target, position)
        pin.forwardKinematics(viz.model, viz.data, robot.q0, robot.v0 + 1.0)
        viz.drawFrameVelocities(3)
        viz.drawFrameVelocities(4, color=0x0000FF)
        image = viz.captureImage(64, 48)
        assert image.shape == (48, 64, 3)
        ball = pin.GeometryObject(
            "ball", 6, pin.SE3(np.eye(3), np.array([0.0, 0.0, 0.1])), ulna.geometry.Sphere(0.1)
        )
        model = viz.visual_model
        viz.visual_model = model.copy()
        viz.addGeometryObject(ball, (1.0, 0.0, 0.0, 1.0))
        viz.display(robot.q0)
        check(viz, "pinocchio")
        assert not model.existGeometryName("ball")
    viz = MeshcatVisualizer(robot)
    viz.initViewer(ulna.Viewer(page=False), loadModel=True)
    viz.addBox("box", [0.1, 0.2, 0.3], [1, 0, 0, 1])
    viz.applyConfiguration("box", [0.5, 0.1, 0.2, 1, 0, 0, 0])
    np.testing.assert_allclose(viz.viewer.gui.scene.pose("box")[:3, 3], [0.5, 0.1, 0.2])
    viz.applyConfiguration("box", pin.SE3.Identity())
    refused(lambda: viz.applyConfiguration("bo", pin.SE3.Identity()), "'box'")
    viz.delete("box")
    viz.captureImage = lambda *_: viz.viewer.viewer.picture(None, 64, 48, samples=1)  # a small film
    with viz.create_video_ctx(f"{folder}/film.gif", fps=10):
        viz.play([robot.q0, robot.q0 + 0.1], 0.1)
    images = viz.play([robot.q0, robot.q0 + 0.1], 0.1, capture=True)
    assert images is not None and len(images) == 2
    refused(lambda: viz.initViewer("window"), "ulna.Viewer")


robot = RobotWrapper.BuildFromURDF(f"{sys.argv[1]}/robots/ur_description/urdf/ur5_robot.urdf")
wrapper(robot)
others(robot, sys.argv[2])
