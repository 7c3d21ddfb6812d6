"""ViserVisualizer draws on the server it is given, and lets its own server be used."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import viser
from pinocchio.visualize import ViserVisualizer

import ulna


def nodes_of(server: Any) -> dict[str, Any]:
    return server.scene._handle_from_node_name


def check_poses(server: Any, viz: ViserVisualizer) -> None:
    viz._gui.viewer.flush()
    for geometry, M in zip(viz.visual_model.geometryObjects, viz.visual_data.oMg, strict=True):
        handle = nodes_of(server)[f"/pinocchio/visuals › {geometry.name}"]
        np.testing.assert_allclose(handle.position, M.translation, atol=1e-6)
        turn = pin.Quaternion(np.roll(handle.wxyz, -1)).matrix()
        np.testing.assert_allclose(turn, M.rotation, atol=1e-6)


model = pin.buildSampleModelManipulator()
geometries = pin.buildSampleGeometryModelManipulator(model)
server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
before = set(nodes_of(server))
viz = ViserVisualizer(model, geometries, geometries)
viz.initViewer(viewer=server, loadModel=True)
assert viz.viewer is server
viz.viewer.scene.add_frame("/goal")
slider = viz.viewer.gui.add_slider("reach", 0.0, 1.0, 0.1, 0.5)
viz.display(np.linspace(0.1, 0.6, 6))
check_poses(server, viz)
added = set(nodes_of(server)) - before
assert "/goal" in added and not any(
    name.startswith("/(page)") for name in added
)  # its lights stay as they are
viz.loadViewerModel(visual_color=[1.0, 0.0, 0.0, 1.0])
viz.display(np.linspace(0.6, 0.1, 6))
check_poses(server, viz)
viz._gui.viewer.close()
server.scene.add_box("/still_served")
assert slider.value == 0.5 and "/still_served" in nodes_of(server)
server.stop()

alone = ViserVisualizer(model, geometries, geometries)
alone.initViewer(None, False, True, "localhost", "0")
alone.display(np.linspace(0.1, 0.6, 6))
assert isinstance(alone.viewer, viser.ViserServer)
alone.viewer.scene.add_box("/target")
alone.loadViewerModel(frame_axis_length=0.4, frame_axis_radius=0.01)
alone.displayFrames(True)
scene = alone._gui.viewer.scene
axis = next(scene.node(name) for name in scene.names if "/frames/" in name).surfaces[0]
np.testing.assert_allclose(axis.vertices[:, 0].max(), 0.4)
alone._gui.viewer.close()

for wrong, expected in ((dict(viewer=3), "viser.ViserServer"), (dict(ope=True), "'open'")):
    try:
        alone.initViewer(**wrong)
    except Exception as error:
        assert expected in str(error), error
    else:
        raise AssertionError(wrong)
try:
    ulna.Viewer(server=3)
except Exception as error:
    assert "viser.ViserServer" in str(error)
else:
    raise AssertionError("a server of another kind was taken")
