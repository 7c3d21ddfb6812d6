"""A 3D viewer: a scene, a page in the browser that shows it, and pictures and videos without one.

Nothing here is imported by `import ulna`, and the names below are imported when they are first used. From the top:

| package | content |
|---|---|
| `live` | a robot as one HTML file with its kinematics, which browsers open without a server |
| `viewer`, `show`, `export` | what users open: a viewer of a scene, the page of one robot; pictures, videos, HTML |
| `panel` | controls beside the scene, plots, the teach panel of a robot, the time line |
| `notebook` | what notebooks display |
| `page` | the viser server, the messages to the browser, who may connect |
| `render` | pictures with NumPy alone |
| `scene` | adding robots, shapes, meshes and annotations by name |
| `robot` | meshes of links, overlays such as frames and ellipsoids, following a target |
| `graph` | the scene graph: nodes, content, camera, theme, handles |
| `mesh` | surfaces, primitive shapes, mesh files, glTF |
| `output`, `colours`, `attributes`, `progress` | files, colours, base classes, reports of long work |
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ulna.system.deferred_names import deferred_names
from ulna.viewer import renamed

if TYPE_CHECKING:
    from ulna.viewer.graph.camera import Camera as Camera
    from ulna.viewer.graph.handles import Handle as Handle
    from ulna.viewer.graph.theme import Theme as Theme
    from ulna.viewer.mesh.mesh_files import load_mesh as load_mesh
    from ulna.viewer.mesh.surface import Surface as Surface
    from ulna.viewer.mesh.surface import Texture as Texture
    from ulna.viewer.output.png import write_png as write_png
    from ulna.viewer.page.page import Page as Page
    from ulna.viewer.panel.panel import Panel as Panel
    from ulna.viewer.robot.robot_handle import RobotHandle as RobotHandle
    from ulna.viewer.robot.stick_figure import stick_figure as stick_figure
    from ulna.viewer.scene.scene import Scene as Scene
    from ulna.viewer.viewer import Viewer as Viewer

_FILES = {
    "Camera": "graph.camera",
    "Handle": "graph.handles",
    "Page": "page.page",
    "Panel": "panel.panel",
    "RobotHandle": "robot.robot_handle",
    "Scene": "scene.scene",
    "Surface": "mesh.surface",
    "Texture": "mesh.surface",
    "Theme": "graph.theme",
    "Viewer": "viewer",
    "load_mesh": "mesh.mesh_files",
    "stick_figure": "robot.stick_figure",
    "write_png": "output.png",
}
"""The file of each public name."""

__all__ = list(_FILES)

renamed.install()


__getattr__ = deferred_names(__name__, _FILES)


def __dir__() -> list[str]:
    return sorted({*__all__, *globals()})
