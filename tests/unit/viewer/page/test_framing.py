"""Tabs show the whole scene, as wide as they are, until somebody moves their view."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from ulna.viewer import Camera, Viewer
from ulna.viewer.page.framing import Framing, framing_camera


def tab(aspect: float = 1.6) -> Any:
    start = Camera()
    return SimpleNamespace(
        camera=SimpleNamespace(
            position=start.position, look_at=start.target, up_direction=start.up, fov=start.fov, aspect=aspect
        )
    )


class Server:
    def __init__(self) -> None:
        self.tabs: dict[int, Any] = {}
        self.initial_camera = SimpleNamespace()

    def get_clients(self) -> dict[int, Any]:
        return dict(self.tabs)


def in_picture(viewer: Viewer, view: Any) -> tuple[np.ndarray, np.ndarray]:
    """Where points of the scene are in the window: from -1 at the left and bottom to 1."""
    camera = Camera(tuple(view.position), tuple(view.look_at), view.fov)
    x, y, z = ((viewer.scene.points() - camera.position) @ camera.axes()).T
    slope = np.tan(view.fov / 2)
    return x / -z / (slope * view.aspect), y / -z / slope


@pytest.mark.parametrize("aspect", [0.6, 1.0, 1.6, 2.2])
def test_what_comes_after_the_tab_is_shown(aspect: float) -> None:
    """A tab that opened before the robots were loaded kept the camera of the empty scene."""
    viewer, server = Viewer(page=False), Server()
    framing = Framing(viewer.scene, server)
    server.tabs[1] = tab(aspect)
    framing.update()
    for k in range(2):
        viewer.box((0.5, 0.5, 1.0), pose=(0.0, 3.0 * k, 0.5))
        framing.update()
        x, y = in_picture(viewer, server.tabs[1].camera)
        assert max(np.abs(x).max(), np.abs(y).max()) < 1.0
        assert max(np.ptp(x), np.ptp(y)) > 1.2  # of 2: it fills most of the window
        if aspect > 1.2:
            assert x.max() < 0.6  # the panel stands to the right


def test_a_view_that_somebody_moved_stays() -> None:
    viewer, server = Viewer(page=False), Server()
    framing = Framing(viewer.scene, server)
    server.tabs = {1: tab(), 2: tab()}
    framing.update()
    server.tabs[1].camera.position = (5.0, 5.0, 5.0)
    viewer.box((1, 1, 1), pose=(0, 8, 0))
    framing.update()
    assert server.tabs[1].camera.position == (5.0, 5.0, 5.0)
    expected = framing_camera(viewer.scene)
    np.testing.assert_allclose(server.tabs[2].camera.position, expected.position)
    np.testing.assert_allclose(server.initial_camera.position, expected.position)
    framing.update(moved_too=True)
    np.testing.assert_allclose(server.tabs[1].camera.position, expected.position)


def test_a_little_more_does_not_move_the_view() -> None:
    viewer, server = Viewer(page=False), Server()
    viewer.box((1, 1, 1))
    server.tabs[1] = tab()
    framing = Framing(viewer.scene, server)
    framing.update()
    before = server.tabs[1].camera.position
    viewer.box((0.1, 0.1, 0.1), pose=(0.5, 0.0, 0.5))
    framing.update()
    assert server.tabs[1].camera.position == before
