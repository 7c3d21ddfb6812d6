"""The look of the page: a calm studio with soft shadows, a quiet floor, and the scene in view."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.viewer.camera import Camera


def decorate(server: Any, camera: Camera, floor: float) -> None:
    """Give a viser server its lights, floor (at height `floor` [m]), background and first view."""
    scene, gui = server.scene, server.gui
    gui.configure_theme(
        show_logo=False, show_share_button=False, brand_color=(37, 99, 235), control_width="medium"
    )
    scene.configure_default_lights(False)
    scene.configure_environment_map("studio", environment_intensity=0.30)
    scene.add_light_hemisphere(
        "/(page)/sky", sky_color=(235, 242, 255), ground_color=(150, 155, 160), intensity=0.28
    )
    lamps = (("key", (255, 244, 230), 2.6, (1.6, -1.0, 3.2)), ("rim", (230, 240, 255), 0.8, (-2.0, 2.4, 1.6)))
    for name, tint, strength, place in (*lamps, ("fill", (220, 232, 255), 0.25, (-1.0, -3.0, 1.2))):
        scene.add_light_directional(
            f"/(page)/{name}", color=tint, intensity=strength, cast_shadow=name == "key", position=place
        )
    scene.add_grid(
        "/(page)/floor",
        infinite_grid=True,
        cell_size=0.1,
        cell_thickness=0.7,
        cell_color=(169, 179, 191),
        section_size=1.0,
        section_thickness=1.1,
        section_color=(141, 152, 166),
        plane_color=(180, 190, 201),
        plane_opacity=1.0,
        shadow_opacity=0.42,
        fade_distance=14.0,
        fade_strength=1.6,
        position=(0.0, 0.0, floor - 0.001),
    )
    top, horizon = np.array([142, 163, 187]), np.array([217, 225, 233])
    share = np.clip(np.linspace(0, 1, 512) / 0.33, 0, 1) ** 0.8
    gradient = top + (horizon - top) * share[:, None]
    scene.set_background_image(np.repeat(gradient[:, None, :], 8, axis=1).astype(np.uint8), format="png")
    server.initial_camera.position, server.initial_camera.look_at = camera.position, camera.target
    server.initial_camera.fov = camera.fov
