"""MeshCat's tree draws what scripts of MeshCat set, place and change; run where `pinocchio` is the package."""

from __future__ import annotations

import io
import warnings
from typing import Any

import meshcat
import meshcat.geometry as mg
import meshcat.transformations as tf
import numpy as np
import pinocchio as pin
from pinocchio.visualize import MeshcatVisualizer, RVizVisualizer, Visualizer
from scipy.spatial.transform import Rotation

import ulna
from ulna.viewer.graph.content import Lines, Points


def refused(call: Any, *expected: str) -> None:
    try:
        call()
    except Exception as error:
        assert all(text in str(error) for text in expected), error
    else:
        raise AssertionError(expected)


def classes_of_scenes() -> None:
    shared = mg.Box([1.0, 1.0, 1.0]), mg.MeshPhongMaterial()
    assert all(isinstance(one, mg.ReferenceSceneElement) for one in shared)
    assert issubclass(mg.ReferenceSceneElement, mg.SceneElement)
    assert not isinstance(mg.Mesh(*shared), mg.ReferenceSceneElement)


def visualizer() -> MeshcatVisualizer:
    model = pin.buildSampleModelManipulator()
    geometries = pin.buildSampleGeometryModelManipulator(model)
    viz = MeshcatVisualizer(model, geometries, geometries)
    viz.initViewer(ulna.Viewer(page=False), loadModel=True)
    return viz


def object_of(viz: MeshcatVisualizer, name: str) -> Any:
    """The part of a node that its object is drawn by."""
    scene = viz.viewer.gui.scene
    return [scene.node(n) for n in scene.names if n.startswith(f"{name}/·object")]


def extent(viz: MeshcatVisualizer, name: str) -> Any:
    """Lowest and highest corner of what is drawn, in the node's frame."""
    nodes = object_of(viz, name)
    parts = [s.vertices for node in nodes for s in node.surfaces]
    parts += [node.content.bounding_points for node in nodes if node.content is not None]
    points = np.concatenate(parts)
    return np.stack([points.min(axis=0), points.max(axis=0)])


def geometries(viz: MeshcatVisualizer) -> None:
    tree = viz.viewer
    cases = {
        "box": (mg.Box([0.2, 0.4, 0.6]), [0.1, 0.2, 0.3]),
        "sphere": (mg.Sphere(0.5), [0.5, 0.5, 0.5]),
        "ellipsoid": (mg.Ellipsoid([0.1, 0.2, 0.3]), [0.1, 0.2, 0.3]),
        "cylinder": (mg.Cylinder(1.0, 0.1), [0.1, 0.5, 0.1]),
        "frustum": (mg.Cylinder(1.0, radiusTop=0.0, radiusBottom=0.2), [0.2, 0.5, 0.2]),
    }
    for name, (geometry, half) in cases.items():
        tree[name].set_object(geometry, mg.MeshLambertMaterial(color=0x336699, opacity=0.5))
        np.testing.assert_allclose(extent(viz, name), [np.negative(half), half], atol=5e-3, err_msg=name)
        (surface,) = object_of(viz, name)[0].surfaces
        np.testing.assert_allclose(surface.rgba, [0x33 / 255, 0x66 / 255, 0x99 / 255, 0.5])
    bottom = object_of(viz, "frustum")[0].surfaces[0].vertices
    assert np.linalg.norm(bottom[bottom[:, 1] > 0.4][:, [0, 2]], axis=1).max() < 1e-9  # the tip is at +y
    corners = np.eye(3)
    tree["triangle"].set_object(
        mg.TriangularMeshGeometry(corners, [[0, 1, 2]], corners), mg.MeshPhongMaterial(vertexColors=True)
    )
    np.testing.assert_allclose(object_of(viz, "triangle")[0].surfaces[0].rgba[:3], 1 / 3, atol=0.04)
    tree["edges"].set_object(mg.Box([1, 1, 1]), mg.MeshBasicMaterial(wireframe=True))
    assert isinstance(object_of(viz, "edges")[0].content, Lines)
    refused(lambda: mg.TriangularMeshGeometry(corners, [[0, 1]]), "(1, 2)")
    refused(lambda: mg.MeshPhongMaterial(map=3), "`map`")
    text = "v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n"
    tree["file"].set_object(mg.ObjMeshGeometry.from_stream(io.StringIO(text)))
    np.testing.assert_allclose(extent(viz, "file"), [[0, 0, 0], [1, 2, 0]])


def shapes_of_the_visualizer(viz: MeshcatVisualizer) -> None:
    """Pinocchio's own methods of its visualizer of MeshCat."""
    cases = {
        "a box": (lambda name: viz.addBox(name, [0.2, 0.4, 0.6], [1, 0, 0, 0.5]), [0.1, 0.2, 0.3]),
        "a sphere": (lambda name: viz.addSphere(name, 0.5, [1, 0, 0, 0.5]), [0.5, 0.5, 0.5]),
        "a cylinder": (lambda name: viz.addCylinder(name, 1.0, 0.1, [1, 0, 0, 0.5]), [0.1, 0.1, 0.5]),
        "an ellipsoid": (
            lambda name: viz.addEllipsoid(name, [0.1, 0.2, 0.3], [1, 0, 0, 0.5]),
            [0.1, 0.2, 0.3],
        ),
    }
    scene = viz.viewer.gui.scene
    for name, (add, half) in cases.items():
        known = set(scene.names)
        add(name)
        surfaces = [s for new in set(scene.names) - known for s in scene.node(new).surfaces]
        points = np.concatenate([s.vertices for s in surfaces])
        np.testing.assert_allclose(
            [points.min(axis=0), points.max(axis=0)], [np.negative(half), half], atol=5e-3
        )
        np.testing.assert_allclose(surfaces[0].rgba[:3], [1, 0, 0])


def points_and_lines(viz: MeshcatVisualizer) -> None:
    tree, ends = viz.viewer, np.array([[0, 1, 1, 0], [0, 0, 1, 1], [0, 0, 0, 0.0]])
    material = mg.LineBasicMaterial(color=0xFF0000, linewidth=3)
    for kind, count in ((mg.LineSegments, 2), (mg.Line, 3), (mg.LineLoop, 4)):
        tree["lines"].set_object(kind(mg.PointsGeometry(ends), material))
        (node,) = object_of(viz, "lines")
        assert len(node.content.segments) == count and node.content.rgba == (1, 0, 0, 1)
        assert node.content.thickness == 0.006
    tree["axes"].set_object(mg.triad(0.5))
    found = {n.content.rgba[:3]: n.content.segments[0, 1].tolist() for n in object_of(viz, "axes")}
    assert found == {(1, 0, 0): [0.5, 0, 0], (0, 1, 0): [0, 0.5, 0], (0, 0, 1): [0, 0, 0.5]}
    tree["cloud"].set_object(mg.PointCloud(ends, np.eye(3)[:, [0, 1, 2, 0]], size=0.1))
    content = object_of(viz, "cloud")[0].content
    assert isinstance(content, Points) and content.size == 0.1
    np.testing.assert_allclose(content.colours, np.eye(3)[[0, 1, 2, 0]])
    tree["cloud"].set_object(mg.PointsGeometry(ends), mg.PointsMaterial(color=0x00FF00))
    np.testing.assert_allclose(object_of(viz, "cloud")[0].content.colours, [[0, 1, 0]] * 4)
    refused(lambda: tree["cloud"].set_object(mg.PointsGeometry(ends.T)), "(4, 3)")
    tree["none"].set_object(
        mg.LineSegments(mg.PointsGeometry([], np.array([])), material)
    )  # a path without points
    assert "none" in viz.viewer.gui.scene


def placement(viz: MeshcatVisualizer) -> None:
    tree, scene = viz.viewer, viz.viewer.gui.scene
    here = tf.translation_matrix([0.5, 0, 0.3]) @ tf.rotation_matrix(0.7, [1, 2, 3])
    tree["goal"].set_transform(here)  # before there is an object
    tree["goal"].set_object(mg.Box([0.2, 0.2, 0.2]))
    tree["goal/tip"].set_object(mg.Sphere(0.1))
    tree["goal"]["tip"].set_transform(tf.translation_matrix([0, 0, 0.2]))
    poses = scene.snapshot().poses
    np.testing.assert_allclose(poses[scene.row("goal")], here, atol=1e-15)
    np.testing.assert_allclose(
        poses[scene.row("goal/tip")], here @ tf.translation_matrix([0, 0, 0.2]), atol=1e-15
    )
    tree["goal"].set_object(mg.Sphere(0.2))  # place and nodes below remain
    assert "goal/tip" in scene and np.array_equal(scene.pose("goal"), here)
    tree["stretched"].set_object(mg.Sphere(1.0))
    tree["stretched"].set_transform(here @ np.diag([1, 2, 3, 1.0]))
    np.testing.assert_allclose(extent(viz, "stretched")[1], [1, 2, 3], atol=0.02)
    np.testing.assert_allclose(scene.pose("stretched"), here, atol=1e-14)
    tree["stretched"].set_transform(here)
    np.testing.assert_allclose(extent(viz, "stretched")[1], [1, 1, 1], atol=0.02)
    tree["goal"].set_transform(here @ np.diag([2, 2, 2, 1]))
    refused(lambda: tree["goal"].set_transform(2.0 * here), "last row")
    np.testing.assert_allclose(scene.appearance("goal", "scale"), [2, 2, 2])
    refused(lambda: tree["goal"].set_transform(np.diag([1, 2, 3, 1.0])), "'goal'", "a factor for all axes")
    refused(lambda: tree["goal"].set_transform(np.eye(3)), "(3, 3)", "(4, 4)")
    refused(lambda: tree.set_transform(here), "path of an object")


def properties(viz: MeshcatVisualizer) -> None:
    tree, viewer = viz.viewer, viz.viewer.viewer
    tree["goal"].set_transform(np.eye(4))
    tree["goal"].set_property("color", [0, 1, 0, 0.25])
    tree["goal"].set_property("visible", False)
    handle = viewer["goal"]
    assert handle.color == (0, 1, 0) and handle.opacity == 0.25 and not handle.visible
    tree["goal/<object>"].set_property("opacity", 0.5)
    assert handle.opacity == 0.5
    tree["goal"].set_property("position", [1, 2, 3])
    tree["goal"].set_property("quaternion", [0, 0, 1, 1])
    tree["goal"].set_property("scale", 3)
    np.testing.assert_allclose(
        viewer.scene.pose("goal")[:3], [[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3]], atol=1e-15
    )
    np.testing.assert_allclose(handle.scale, [3, 3, 3])
    refused(lambda: tree["goal"].set_property("visibel", True), "'visible'")
    refused(lambda: tree["/Grid"].set_property("colour", True), "'visible'")
    tree["/Background"].set_property("top_color", [1, 0, 0])
    tree["/Background"].set_property("bottom_color", [0, 0, 1])
    assert viewer.theme.top == (255, 0, 0) and viewer.theme.horizon == (0, 0, 255)
    lines = viewer.theme.section
    tree["/Grid"].set_property("visible", False)
    assert viewer.theme.section == viewer.theme.floor
    tree["/Grid"].set_property("visible", True)
    assert viewer.theme.section == lines
    tree["/Axes"].set_property("visible", True)
    assert "·axes" in viewer.scene
    tree["/Axes"].set_property("visible", False)
    assert "·axes" not in viewer.scene
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        tree["/Lights/SpotLight"].set_property("visible", False)
    assert "theme" in str(caught[0].message)


def camera(viz: MeshcatVisualizer) -> None:
    tree, viewer = viz.viewer, viz.viewer.viewer
    tree.set_cam_pos([3, 1, 2])
    tree.set_cam_target([0, 0, 1])
    assert viewer.camera.position == (3, 1, 2) and viewer.camera.target == (0, 0, 1)
    tree["/Cameras/default"].set_transform(tf.translation_matrix([0, 0, 0.5]))
    assert viewer.camera.position == (3, 1, 2.5) and viewer.camera.target == (0, 0, 0.5)
    tree["/Cameras/default/rotated/<object>"].set_property("position", [1, 2, 3])  # y is up there
    assert viewer.camera.position == (1, -3, 2.5)
    usual = ulna.viewer.Camera().fov
    tree["/Cameras/default/rotated/<object>"].set_property("zoom", 2.0)
    np.testing.assert_allclose(np.tan(viewer.camera.fov / 2), np.tan(usual / 2) / 2)
    tree["/Cameras/default/rotated"].set_object(mg.PerspectiveCamera(fov=90))
    np.testing.assert_allclose(viewer.camera.fov, np.pi / 2)
    tree["/Cameras/default/rotated"].set_object(mg.PerspectiveCamera())
    np.testing.assert_allclose(viewer.camera.fov, np.deg2rad(50))  # that of MeshCat
    refused(lambda: tree["/Cameras/default/rotated"].set_object(mg.Box([1, 1, 1])), "PerspectiveCamera")


def one_camera(viz: MeshcatVisualizer) -> None:
    """Field of view and zoom are independent, and visualizer, tree and viewer set the same camera."""
    tree, viewer = viz.viewer, viz.viewer.viewer
    lens = tree["/Cameras/default/rotated/<object>"]
    for zoomed, change in (
        (1.0, lambda: tree["/Cameras/default/rotated"].set_object(mg.PerspectiveCamera(fov=90))),
        (2.0, lambda: lens.set_property("zoom", 2.0)),
        (3.0, lambda: viz.setCameraZoom(3.0)),
        (3.0, lambda: tree.set_cam_target([0, 0, 0.5])),
        (3.0, lambda: lens.set_property("fov", 90)),
        (1.0, lambda: lens.set_property("zoom", 1)),
    ):
        change()
        np.testing.assert_allclose(np.tan(viewer.camera.fov / 2), 1 / zoomed)
    viewer.camera = ulna.viewer.Camera(fov=1.0)
    lens.set_property("zoom", 2)
    np.testing.assert_allclose(np.tan(viewer.camera.fov / 2), np.tan(0.5) / 2)
    turned = tf.translation_matrix([0, 0, 0.5]) @ tf.rotation_matrix(0.3, [0, 0, 1])
    for frame in (np.eye(4), turned):
        tree["/Cameras/default"].set_transform(frame)
        tree.set_cam_pos([1, 1, 1])
        viz.setCameraPosition([5, 5, 5])
        tree.set_cam_target([0, 0, 1])
        np.testing.assert_allclose(viewer.camera.position, (frame @ [5, 5, 5, 1])[:3], rtol=1e-14)
        np.testing.assert_allclose(viewer.camera.target, (frame @ [0, 0, 1, 1])[:3], atol=1e-14)
        viz.setCameraTarget([1, 2, 3])
        tree.set_cam_pos([2, 0, 0])
        np.testing.assert_allclose(viewer.camera.target, (frame @ [1, 2, 3, 1])[:3], rtol=1e-14)
        np.testing.assert_allclose(viewer.camera.position, (frame @ [2, 0, 0, 1])[:3], atol=1e-14)
        viz.setCameraPreset("talos")
        np.testing.assert_allclose(viewer.camera.position, (frame @ [1.5, 0.3, 1.5, 1])[:3], rtol=1e-14)
        np.testing.assert_allclose(viewer.camera.target, (frame @ [0, 1.2, 0, 1])[:3], atol=1e-14)


def hidden_sky(viz: MeshcatVisualizer) -> None:
    tree, viewer = viz.viewer, viz.viewer.viewer
    sky, red, green = tree["/Background"], (255, 0, 0), (0, 255, 0)

    def colours() -> tuple[Any, Any]:
        return viewer.theme.top, viewer.theme.horizon

    sky.set_property("top_color", [1, 0, 0])
    sky.set_property("bottom_color", [0, 1, 0])
    for _ in range(2):
        sky.set_property("visible", False)
        sky.set_property("visible", False)
        assert colours() == ((255,) * 3,) * 2
        for _ in range(2):
            sky.set_property("visible", True)
            assert colours() == (red, green)
    sky.set_property("visible", False)
    sky.set_property("top_color", [0, 1, 0])  # shown later
    assert colours() == ((255,) * 3,) * 2
    sky.set_property("visible", True)
    assert colours() == (green, green)
    sky.set_property("visible", False)
    viz.setBackgroundColor(col_top=[1, 0, 0], col_bot=[1, 0, 0])
    sky.set_property("visible", True)
    assert colours() == (red, red)
    viewer.theme = ulna.viewer.Theme(section=(10, 20, 30), floor=(40, 50, 60))
    lines, floor = viewer.theme.section, viewer.theme.floor
    tree["/Grid"].set_property("visible", False)
    assert viewer.theme.section == viewer.theme.cell == floor
    tree["/Grid"].set_property("visible", True)
    assert viewer.theme.section == lines


def removal(viz: MeshcatVisualizer) -> None:
    tree, scene = viz.viewer, viz.viewer.gui.scene
    q = np.linspace(0.1, 0.6, 6)
    tree["goal"].delete()
    tree["goal"].delete()  # nothing is there any more
    assert "goal" not in scene and "goal/tip" not in scene
    names = [n for n in scene.names if n.startswith("pinocchio/visuals/")]
    tree[names[0]].delete()
    viz.display(q)  # the rest of the robot moves
    pin.updateGeometryPlacements(viz.model, viz.data, viz.visual_model, viz.visual_data)
    np.testing.assert_allclose(scene.pose(names[2]), viz.visual_data.oMg[2].homogeneous, atol=1e-14)
    second = MeshcatVisualizer(viz.model, viz.collision_model, viz.visual_model)
    second.initViewer(viewer=tree)
    assert second.viewer is tree
    tree.delete()
    assert not scene.names
    second.loadViewerModel("again")
    assert second.viewerVisualGroupName == "again/visuals" and "again/visuals" in scene


def transformations() -> None:
    rng = np.random.default_rng(1)
    for _ in range(20):
        angle, axis, angles = rng.normal(), rng.normal(size=3), rng.uniform(-1.4, 1.4, 3)
        turn = Rotation.from_rotvec(angle * axis / np.linalg.norm(axis))
        np.testing.assert_allclose(tf.rotation_matrix(angle, axis)[:3, :3], turn.as_matrix(), atol=1e-14)
        point = rng.normal(size=3)
        np.testing.assert_allclose(
            tf.rotation_matrix(angle, axis, point) @ [*point, 1], [*point, 1], atol=1e-14
        )
        quat = tf.quaternion_about_axis(angle, axis)
        np.testing.assert_allclose(
            quat, turn.as_quat(scalar_first=True) * np.sign(quat @ turn.as_quat(scalar_first=True))
        )
        np.testing.assert_allclose(tf.quaternion_matrix(2 * quat)[:3, :3], turn.as_matrix(), atol=1e-14)
        one = tf.quaternion_multiply(2 * quat, tf.quaternion_inverse(2 * quat))
        np.testing.assert_allclose(one, [1.0, 0.0, 0.0, 0.0], atol=1e-14)
        np.testing.assert_allclose(tf.euler_from_quaternion(quat), turn.as_euler("xyz"), atol=1e-12)
        assert tf.quaternion_real(quat) == quat[0] and (tf.quaternion_imag(quat) == quat[1:]).all()
        half = tf.quaternion_slerp([1.0, 0.0, 0.0, 0.0], quat, 0.5)
        np.testing.assert_allclose(tf.quaternion_multiply(half, half), quat * np.sign(quat[0]), atol=1e-12)
        for axes, order in (("sxyz", "xyz"), ("rzyx", "ZYX"), ("szyz", "zyz"), ("rxyz", "XYZ")):
            wanted = Rotation.from_euler(order, angles).as_matrix()
            np.testing.assert_allclose(tf.euler_matrix(*angles, axes)[:3, :3], wanted, atol=1e-14)
            back = tf.euler_from_matrix(wanted, axes)
            np.testing.assert_allclose(Rotation.from_euler(order, back).as_matrix(), wanted, atol=1e-13)
    np.testing.assert_allclose(tf.scale_matrix(2.0, [1, 0, 0]) @ [2, 1, 0, 1], [3, 2, 0, 1])
    refused(lambda: tf.euler_matrix(0, 0, 0, "xyz"), "'xyz'", "'sxyz'")
    refused(lambda: tf.rotation_matrix(1, [0, 0, 0]), "not zero")


def main() -> None:
    viz = visualizer()
    geometries(viz)
    shapes_of_the_visualizer(viz)
    points_and_lines(viz)
    placement(viz)
    properties(viz)
    camera(viz)
    one_camera(viz)
    hidden_sky(viz)
    assert viz.viewer.get_image(40, 30).size == (40, 30) and "<html" in viz.viewer.static_html().lower()
    removal(viz)
    transformations()
    classes_of_scenes()
    assert meshcat.Visualizer is type(viz.viewer)
    assert Visualizer.MESHCAT.value is MeshcatVisualizer
    refused(lambda: RVizVisualizer(viz.model), "MeshcatVisualizer")
    refused(lambda: viz.viewer.set_animation(None), "viz.play")
    refused(lambda: meshcat.animation, "viz.play")


if __name__ == "__main__":
    main()
