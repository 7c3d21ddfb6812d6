"""Gepetto's calls draw into the viewer: placements at refresh, groups, looks, lines, windows; wrong names raise."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ulna
from ulna.compat.packages import FOLDERS
from ulna.errors import InputError, NonFiniteError, ShapeError, UlnaWarning, UnknownName, ViewerError

sys.path.append(str(FOLDERS["pinocchio"]))  # behind everything: only what nobody else has is found there
from gepetto import corbaserver
from gepetto.corbaserver import placement
from gepetto.corbaserver.gui import REFUSED, Gui

sys.path.remove(str(FOLDERS["pinocchio"]))

RED = (1.0, 0.0, 0.0, 1.0)
NAMES = """
    createWindow getWindowID setBackgroundColor1 setBackgroundColor2 createScene createSceneWithFloor addSceneToWindow
    addFloor addBox addCapsule addArrow addRod resizeCapsule resizeArrow addCone addCylinder addSphere addLight
    addXYZaxis addMesh removeLightSources removeObjectFromCache addURDF addUrdfCollision addUrdfObjects addLine
    setLineStartPoint setLineEndPoint setLineExtremalPoints addCurve setCurvePoints setCurveColors setCurveMode
    setCurvePointsSubset setCurveLineWidth addSquareFace addTriangleFace setTexture createRoadmap addEdgeToRoadmap
    addNodeToRoadmap createGroup nodeExists deleteNode getNodeList getGroupNodeList getSceneList getWindowList
    addToGroup removeFromGroup applyConfiguration applyConfigurations refresh setRefreshIsSynchronous
    getNodeGlobalTransform getStaticTransform setStaticTransform addLandmark deleteLandmark setVisibility setScale
    setColor setWireFrameMode setLightingMode setHighlight getPropertyNames getPropertyTypes setStringProperty
    getStringProperty setColorProperty getColorProperty setVector3Property getVector3Property setVector2Property
    getVector2Property setFloatProperty getFloatProperty setBoolProperty getBoolProperty setIntProperty
    getIntProperty callVoidProperty captureFrame startCapture stopCapture setCaptureTransform
    captureTransformOnRefresh captureTransform writeBlenderScript writeNodeFile writeWindowFile attachCameraToNode
    detachCamera getCameraTransform setCameraTransform setCameraToBestFit registerNodeCallback
""".split()  # noqa: SIM905


@pytest.fixture
def gui() -> Gui:
    return Gui(ulna.Viewer(page=False))


@pytest.fixture(autouse=True)
def order_as_it_was(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.delenv(placement.VARIABLE, raising=False)
    yield
    placement._chosen.clear()


def place(gui: Gui, name: str) -> list[float]:
    return gui.getNodeGlobalTransform(name)


def test_every_call_of_the_interface_is_there(gui: Gui) -> None:
    assert len(NAMES) == len(set(NAMES)) == 97
    assert not [name for name in NAMES if not callable(getattr(gui, name)) or not getattr(gui, name).__doc__]
    for name, word in REFUSED.items():
        with pytest.raises(ViewerError, match=name) as raised:
            getattr(gui, name)("any", "thing")
        assert word in str(raised.value)


def test_placements_take_effect_at_refresh(gui: Gui) -> None:
    assert gui.addSphere("world/sphere", 0.1, RED)
    gui.applyConfiguration("world/sphere", (0.5, 0.1, 0.2, 0.0, 0.0, 0.0, 1.0))
    assert place(gui, "world/sphere") == [0, 0, 0, 0, 0, 0, 1]
    assert gui.refresh()
    assert place(gui, "world/sphere") == [0.5, 0.1, 0.2, 0, 0, 0, 1]
    gui.addBox("world/box", 0.1, 0.2, 0.3, RED)
    gui.applyConfigurations(["world/sphere", "world/box"], [[1, 0, 0, 0, 0, 0, 1], [2, 0, 0, 0, 0, 0, 1]])
    gui.refresh()
    assert place(gui, "world/sphere")[0] == 1 and place(gui, "world/box")[0] == 2


def test_several_placements_come_all_or_none(gui: Gui) -> None:
    gui.addSphere("world/a", 0.1, RED)
    with pytest.raises(UnknownName, match="'world/a'"):
        gui.applyConfigurations(["world/a", "world/b"], [[1, 0, 0, 0, 0, 0, 1], [1, 0, 0, 0, 0, 0, 1]])
    with pytest.raises(InputError, match="2 nodes, but 1"):
        gui.applyConfigurations(["world/a", "world/a"], [[1, 0, 0, 0, 0, 0, 1]])
    gui.refresh()
    assert place(gui, "world/a")[0] == 0


@pytest.mark.parametrize("by", ["function", "variable"])
def test_the_order_of_quaternions(gui: Gui, by: str, monkeypatch: pytest.MonkeyPatch) -> None:
    gui.addBox("box", 0.1, 0.2, 0.3, RED)
    gui.applyConfiguration("box", (0, 0, 0, 1, 0, 0, 0))
    gui.refresh()
    half_turn = gui.scene.pose("box")
    np.testing.assert_allclose(half_turn[:3, :3], np.diag([1, -1, -1]), atol=1e-15)
    if by == "function":
        assert corbaserver.quaternion_order() == "xyzw"
        assert corbaserver.quaternion_order("wxyz") == "wxyz"
    else:
        monkeypatch.setenv("ULNA_GEPETTO_QUATERNION", "wxyz")
    assert place(gui, "box")[3:] in ([0, 1, 0, 0], [-0.0, 1, 0, 0])
    gui.applyConfiguration("box", (0, 0, 0, 1, 0, 0, 0))
    gui.refresh()
    np.testing.assert_array_equal(gui.scene.pose("box"), np.eye(4))
    wanted = [1.0, 2.0, 3.0, 0.1, 0.3, 0.5, np.sqrt(0.65)]  # another number in each place
    gui.applyConfiguration("box", wanted)
    gui.refresh()
    np.testing.assert_allclose(place(gui, "box"), wanted, atol=1e-12)
    with pytest.raises(UnknownName, match="wxyz"):
        corbaserver.quaternion_order("wxzy")


def test_no_placement_is_refused_before_anything_changes(gui: Gui) -> None:
    gui.addSphere("ball", 0.1, RED)
    for wrong, error in (
        ((0, 0, 0), ShapeError),
        ((0, 0, np.nan, 0, 0, 0, 1), NonFiniteError),
        ((0, 0, 0, 0, 0, 0, 0), InputError),
    ):
        with pytest.raises(error):
            gui.applyConfiguration("ball", wrong)
    with pytest.raises(UnknownName, match="Did you mean 'ball'"):
        gui.applyConfiguration("bal", (0, 0, 0, 0, 0, 0, 1))
    with pytest.raises(AttributeError, match="Did you mean 'addSphere'"):
        gui.addSpere("ball", 0.1, RED)  # pyright: ignore


def test_static_transforms_come_after_configurations(gui: Gui) -> None:
    gui.addSphere("ball", 0.1, RED)
    gui.applyConfiguration("ball", (1, 0, 0, 0, 0, np.sqrt(0.5), np.sqrt(0.5)))
    gui.setStaticTransform("ball", (1, 0, 0, 0, 0, 0, 1))
    gui.refresh()
    np.testing.assert_allclose(place(gui, "ball")[:3], [1, 1, 0], atol=1e-15)
    assert gui.getStaticTransform("ball") == [1, 0, 0, 0, 0, 0, 1]


def test_groups_move_what_is_in_them_and_nodes_keep_their_names(gui: Gui) -> None:
    gui.createGroup("tool")
    gui.addBox("world/box", 0.1, 0.1, 0.1, RED)
    gui.addLandmark("world/box", 0.2)
    gui.addToGroup("world/box", "tool")
    assert gui.getNodeList() == ["tool", "world", "world/box"]
    assert gui.getGroupNodeList("tool") == ["world/box"] and gui.getGroupNodeList("world") == []
    gui.applyConfiguration("tool", (0, 0, 1, 0, 0, 0, 1))
    gui.applyConfiguration("world/box", (1, 0, 0, 0, 0, 0, 1))
    gui.refresh()
    assert place(gui, "world/box")[:3] == [1, 0, 1]
    with pytest.raises(InputError, match="in itself"):
        gui.addToGroup("tool", "world/box")
    assert gui.removeFromGroup("world/box", "tool") and not gui.removeFromGroup("world/box", "world")
    assert gui.getStringProperty("world/box", "Visibility") == "OFF"  # pyright: ignore
    assert gui.addToGroup("world/box", "tool")  # in a group again, it can be seen again
    assert gui.getStringProperty("world/box", "Visibility") == "ON"  # pyright: ignore
    gui.createGroup("hand")
    assert gui.removeFromGroup("world/box", "tool") and gui.addToGroup("world/box", "hand")
    assert gui.getStringProperty("world/box", "Visibility") == "ON"  # pyright: ignore
    assert gui.addToGroup("world/box", "tool") and gui.deleteNode("hand")
    with pytest.raises(InputError, match="1 nodes are in 'tool'"):
        gui.deleteNode("tool", False)
    assert gui.deleteNode("world/box", True) and not gui.nodeExists("world/box")
    assert not gui.deleteNode("world/box", True)
    assert gui.getSceneList() == ["tool", "world"]


def test_a_node_that_was_put_elsewhere_outlives_its_first_group(gui: Gui) -> None:
    gui.addSphere("world/ball", 0.1, RED)
    gui.addSphere("world/other", 0.1, RED)
    gui.createGroup("tool")
    gui.addToGroup("world/ball", "tool")
    gui.applyConfiguration("world/other", (1, 0, 0, 0, 0, 0, 1))
    assert gui.deleteNode("world", True)
    assert gui.getNodeList() == ["tool", "world/ball"] and gui.refresh()
    gui.viewer.remove(gui.at("world/ball"))  # behind the back of what waits
    gui.refresh()
    assert gui.getNodeList() == ["tool"]


def test_every_shape_is_one_node(gui: Gui) -> None:
    gui.addCylinder("world/cylinder", 0.1, 0.2, RED)
    gui.addCapsule("world/capsule", 0.1, 0.2, RED)
    gui.addCone("world/cone", 0.1, 0.2, RED)
    gui.addArrow("world/arrow", 0.01, 0.5, RED)
    gui.addXYZaxis("world/axes", RED, 0.02, 0.1)
    gui.addLine("world/line", (0, 0, 0), (1, 0, 0), RED)
    gui.addCurve("world/curve", [(0, 0, 0), (1, 0, 0), (1, 1, 0)], RED)
    gui.addTriangleFace("world/triangle", (0, 0, 0), (1, 0, 0), (0, 1, 0), RED)
    gui.addSquareFace("world/square", (0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), RED)
    gui.addFloor("world/floor")
    assert len(gui.getGroupNodeList("world")) == 10
    arrow = np.concatenate([gui.scene.points()])
    assert arrow[:, 0].max() > 0.5
    gui.resizeArrow("world/arrow", 0.02, 3.0)
    assert gui.scene.points()[:, 0].max() > gui.viewer["world/floor"].world_pose[0, 3] + 2.9
    gui.resizeCapsule("world/capsule", 4.0)
    assert gui.scene.points()[:, 2].max() == pytest.approx(2.1, abs=1e-6)
    for wrong in (
        lambda: gui.resizeCapsule("world/cone", 1.0),
        lambda: gui.resizeArrow("world/cone", 0.1, 1.0),
    ):
        with pytest.raises(UnknownName):
            wrong()


def test_lines_and_curves_change(gui: Gui) -> None:
    gui.addLine("line", (0, 0, 0), (1, 0, 0), RED)
    gui.setLineStartPoint("line", (0, 0, 1))
    gui.setLineEndPoint("line", (0, 2, 0))
    np.testing.assert_array_equal(gui.scene.node("line").content.segments, [[[0, 0, 1], [0, 2, 0]]])
    gui.setLineExtremalPoints("line", (0, 0, 0), (3, 0, 0))
    gui.setCurveLineWidth("line", 10)
    assert gui.scene.node("line").content.thickness == pytest.approx(0.02)
    gui.addCurve("curve", np.eye(3), RED)
    gui.setCurvePointsSubset("curve", 1, 2)
    assert len(gui.scene.node("curve").content.segments) == 1
    gui.setCurvePoints("curve", np.zeros((5, 3)))
    assert len(gui.scene.node("curve").content.segments) == 4
    gui.addSphere("ball", 0.1, RED)
    with pytest.raises(InputError, match="no line"):
        gui.setLineEndPoint("ball", (0, 0, 0))


def test_looks_and_properties(gui: Gui) -> None:
    gui.addSphere("world/ball", 0.1, (1, 0, 0, 0.5))
    assert gui.getColorProperty("world/ball", "Color") == [1, 0, 0, 0.5]  # pyright: ignore
    gui.setColor("world", (0, 1, 0, 1))
    assert gui.getColorProperty("world/ball", "Color") == [0, 1, 0, 0.5]  # pyright: ignore
    gui.setScale("world/ball", (1, 2, 3))
    assert gui.getVector3Property("world/ball", "Scale") == [1, 2, 3]  # pyright: ignore
    gui.setFloatProperty("world/ball", "Alpha", 0.25)  # pyright: ignore
    assert gui.scene.look("world/ball", "opacity") == 0.25
    gui.setVisibility("world", "OFF")
    assert not gui.scene.snapshot().visible.any()
    assert gui.getPropertyNames("world/ball") and len(gui.getPropertyTypes("world/ball")) == 4
    with pytest.raises(InputError, match="setColorProperty"):
        gui.setFloatProperty("world/ball", "Color", 1.0)  # pyright: ignore
    with pytest.raises(UnknownName, match="Alpha"):
        gui.getFloatProperty("world/ball", "Alfa")  # pyright: ignore
    with pytest.raises(UnknownName, match="'OFF'"):
        gui.setVisibility("world", "OF")


def test_what_changes_nothing_says_so_and_goes_on(gui: Gui) -> None:
    gui.addSphere("ball", 0.1, RED)
    calls: list[Any] = [
        lambda: gui.setLightingMode("ball", "OFF"),
        lambda: gui.setWireFrameMode("ball", "WIREFRAME"),
        lambda: gui.setTexture("ball", "wood.png"),
        lambda: gui.setHighlight("ball", 3),
        lambda: gui.addLight("lamp", "w", 0.1, RED),
    ]
    for call in calls:
        with pytest.warns(UlnaWarning, match="changes nothing"):
            assert call() is False
    with warnings.catch_warnings(action="error"):
        assert gui.setLightingMode("ball", "ON") and gui.setWireFrameMode("ball", "FILL")


def test_windows_cameras_and_pictures(gui: Gui, tmp_path: Path) -> None:
    window = gui.createWindow("window")
    gui.createSceneWithFloor("world")
    gui.addSceneToWindow("world", window)
    assert gui.getWindowList() == ["window"] and gui.getWindowID("window") == window
    with pytest.raises(UnknownName, match="createWindow"):
        gui.getWindowID("windows")
    for call in (
        lambda: gui.addSceneToWindow("world", "windows"),
        lambda: gui.setBackgroundColor1("windows", RED),
        lambda: gui.setBackgroundColor2("windows", RED),
        lambda: gui.getCameraTransform("windows"),
        lambda: gui.setCameraTransform("windows", [0, 0, 0, 0, 0, 0, 1]),
        lambda: gui.setCameraToBestFit("windows"),
        lambda: gui.detachCamera("windows"),
        lambda: gui.captureFrame("windows", str(tmp_path / "frame.png")),
        lambda: gui.startCapture("windows", str(tmp_path / "film"), "png"),
        lambda: gui.stopCapture("windows"),
        lambda: gui.writeWindowFile("windows", str(tmp_path / "page.html")),
    ):
        with pytest.raises(UnknownName, match="No window named 'windows'"):
            call()
    gui.addSphere("world/ball", 0.3, RED)
    wanted = [2.0, 0.0, 0.5, 0.5, 0.5, 0.5, 0.5]  # right is y, up is z, backwards is x
    gui.setCameraTransform(window, wanted)
    np.testing.assert_allclose(gui.getCameraTransform(window), wanted, atol=1e-12)
    gui.setBackgroundColor1(window, (0, 0, 0, 1))
    assert gui.viewer.theme.top == (0, 0, 0)
    gui.captureFrame(window, str(tmp_path / "frame.png"))
    gui.startCapture(window, str(tmp_path / "film"), "png")
    gui.refresh()
    gui.stopCapture(window)
    gui.refresh()
    assert sorted(p.name for p in tmp_path.iterdir()) == ["film_0_0.png", "frame.png"]
    with pytest.raises(InputError, match="png"):
        gui.captureFrame(window, str(tmp_path / "frame.bmp"))
    assert gui.detachCamera(window)
    before = gui.getCameraTransform(window)
    gui.setCameraToBestFit(window)
    assert gui.getCameraTransform(window) != before


def test_roadmaps(gui: Gui) -> None:
    gui.createRoadmap("road", RED, 0.02, 0.1, RED)
    gui.addNodeToRoadmap("road", (0, 0, 1, 0, 0, 0, 1))
    gui.addNodeToRoadmap("road", (1, 0, 1, 0, 0, 0, 1))
    gui.addEdgeToRoadmap("road", (0, 0, 1), (1, 0, 1))
    assert gui.getGroupNodeList("road") == ["road/node0", "road/node1", "road/edge2"]
    assert place(gui, "road/node1")[:3] == [1, 0, 1]
    with pytest.raises(UnknownName, match="createRoadmap"):
        gui.addNodeToRoadmap("rod", (0, 0, 1, 0, 0, 0, 1))


def test_robots_and_meshes_by_file(gui: Gui, tmp_path: Path) -> None:
    urdf = tmp_path / "arm.urdf"
    urdf.write_text(
        "<robot name='arm'><link name='base'><visual><geometry><box size='1 1 1'/></geometry></visual></link></robot>"
    )
    gui.addURDF("world/arm", str(urdf))
    assert "world/arm/base" in gui.getNodeList()
    with pytest.raises(InputError, match="nowhere"):
        gui.addMesh("world/mesh", str(tmp_path / "nowhere.stl"))
    assert not gui.nodeExists("world/mesh")


def test_colours_have_names() -> None:
    assert corbaserver.Color.red == [1, 0, 0, 1] == corbaserver.Color("red")
    assert len(corbaserver.Color.random()) == 4 and corbaserver.Color.lightRed[3] < 1
