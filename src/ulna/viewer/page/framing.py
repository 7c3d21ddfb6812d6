"""Cameras of tabs that show the whole scene, until somebody moves them."""

from __future__ import annotations

from typing import Any, final

import numpy as np

from ulna.viewer.graph.camera import Camera, camera_for
from ulna.viewer.graph.scene_graph import SceneGraph
from ulna.viewer.page.surroundings import set_initial_camera, set_tab_camera

_UNMOVED = 1e-3  # difference of a camera that nobody moved, as a part of its distance
_SIMILAR = (
    0.1  # difference up to which a view stays as it is when something is added, as a part of its distance
)
_USUAL_ASPECT = 1.6  # width over height of a window
_SIDE_PANEL_ASPECT = (
    1.2  # aspect above which the panel covers the right of the window; else it is at the bottom
)


def framing_camera(scene: SceneGraph, aspect: float = _USUAL_ASPECT) -> Camera:
    """A camera that shows the whole scene beside the panel.

    Args:
        scene: The scene.
        aspect: Width over height of the window [-].

    Returns:
        The camera.
    """
    return camera_for(scene, aspect, margin=1.4, aside=0.11 if aspect > _SIDE_PANEL_ASPECT else 0.0)


@final
class Framing:
    """Has the tabs of a server show the whole scene.

    Args:
        scene: The scene.
        server: The viser server.
    """

    def __init__(self, scene: SceneGraph, server: Any) -> None:
        self._scene, self._server = scene, server
        self._initial = framing_camera(scene)
        self._sent: dict[int, Camera] = {}  # the camera that each tab got last

    def update(self, moved_too: bool = False) -> None:
        """Frame the scene in tabs to come, and in each tab whose camera nobody moved.

        Args:
            moved_too: Whether to frame it in all tabs.
        """
        clients = dict(self._server.get_clients())
        self._sent = {number: camera for number, camera in self._sent.items() if number in clients}
        before, self._initial = self._initial, framing_camera(self._scene)
        set_initial_camera(self._server, self._initial)
        for number, client in clients.items():
            view, is_new = (
                client.camera,
                number not in self._sent,
            )  # a new one may not have sent its position
            sent = self._sent.setdefault(number, before)
            better = framing_camera(self._scene, view.aspect)
            unmoved = is_new or _is_near(view.position, view.look_at, sent, _UNMOVED)
            if moved_too or (unmoved and _differs(better, sent)):
                self._sent[number] = better
                set_tab_camera(client, better)


def _differs(camera: Camera, other: Camera) -> bool:
    return not _is_near(camera.position, camera.target, other, _SIMILAR)


def _is_near(position: Any, target: Any, camera: Camera, part: float) -> bool:
    far = part * float(np.linalg.norm(np.subtract(camera.position, camera.target)))
    return bool(
        np.linalg.norm(np.subtract(position, camera.position)) <= far
        and np.linalg.norm(np.subtract(target, camera.target)) <= far
    )
