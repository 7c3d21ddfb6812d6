"""Lights, background, floor and camera of the page."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.viewer.graph.camera import Camera
from ulna.viewer.graph.theme import Theme


def configure_scene(server: Any, theme: Theme, shadows: bool = True) -> None:
    """Configure panel, lights and background of a viser server.

    Args:
        server: The viser server.
        theme: Colours and intensities.
        shadows: Whether to turn on the shadows of viser.
    """
    scene, gui = server.scene, server.gui
    gui.configure_theme(
        show_logo=False,
        show_share_button=False,
        brand_color=(37, 99, 235),
        control_width="medium",
        dark_mode=theme.dark,
    )
    scene.configure_default_lights(False)
    scene.configure_environment_map("studio", environment_intensity=theme.environment_intensity)
    scene.add_light_hemisphere(
        "/(page)/sky",
        sky_color=(235, 242, 255),
        ground_color=(150, 155, 160),
        intensity=0.28 * theme.light_factor,
    )
    lights = (
        ("key", (255, 244, 230), 2.6, (1.6, -1.0, 3.2)),
        ("rim", (230, 240, 255), 0.8, (-2.0, 2.4, 1.6)),
    )
    for name, tint, strength, position in (*lights, ("fill", (220, 232, 255), 0.25, (-1.0, -3.0, 1.2))):
        scene.add_light_directional(
            f"/(page)/{name}",
            color=tint,
            intensity=strength * theme.light_factor,
            cast_shadow=shadows and name == "key",
            position=position,
        )
    top, horizon = np.array(theme.top), np.array(theme.horizon)
    share = np.clip(np.linspace(0, 1, 512) / 0.33, 0, 1) ** 0.8
    gradient = top + (horizon - top) * share[:, None]
    scene.set_background_image(np.repeat(gradient[:, None, :], 8, axis=1).astype(np.uint8), format="png")


def add_floor(server: Any, theme: Theme, height: float, visible: bool = True) -> None:
    """Add the floor, or replace it.

    Args:
        server: The viser server.
        theme: Its colours.
        height: Its height [m].
        visible: Whether it is shown.
    """
    server.scene.add_grid(
        "/(page)/floor",
        infinite_grid=True,
        cell_size=0.1,
        cell_thickness=0.7,
        cell_color=theme.cell,
        section_size=1.0,
        section_thickness=1.1,
        section_color=theme.section,
        plane_color=theme.floor,
        plane_opacity=1.0,
        shadow_opacity=theme.shadow,
        fade_distance=14.0,
        fade_strength=1.6,
        position=(0.0, 0.0, height - 0.001),
        visible=visible,
    )


def set_initial_camera(server: Any, camera: Camera) -> None:
    """Set the camera of tabs to come.

    Args:
        server: The viser server.
        camera: The camera.
    """
    first = server.initial_camera
    first.position, first.look_at, first.up, first.fov = camera.position, camera.target, camera.up, camera.fov


def set_camera(server: Any, camera: Camera) -> None:
    """Move the camera of all tabs, also of those to come.

    Args:
        server: The viser server.
        camera: The camera.
    """
    set_initial_camera(server, camera)
    for client in server.get_clients().values():
        set_tab_camera(client, camera)


def set_tab_camera(client: Any, camera: Camera) -> None:
    """Move the camera of a tab.

    Args:
        client: The tab, a `viser.ClientHandle`.
        camera: The camera.
    """
    view = client.camera
    view.up_direction, view.position, view.look_at = camera.up, camera.position, camera.target
    view.fov = camera.fov
