"""What notebooks display of scenes and robots: the page or a picture, and for robots their table."""

from __future__ import annotations

import base64
import html
from functools import lru_cache
from typing import Any

from ulna.errors import UlnaError
from ulna.viewer.graph.camera import camera_for
from ulna.viewer.graph.scene_graph import SceneGraph
from ulna.viewer.graph.theme import LIGHT, Theme
from ulna.viewer.output.png import encode_png
from ulna.viewer.page import Page
from ulna.viewer.page.notebook import frame_html, is_reachable, place_of_kernel
from ulna.viewer.render.renderer import render
from ulna.viewer.robot.configuration import configuration
from ulna.viewer.scene import Scene


def page_html(page: Page, theme: Theme = LIGHT) -> str:
    """A page in a frame, with a picture of its scene instead where the user's browser does not reach it.

    Args:
        page: The page.
        theme: Colours of the picture.

    Returns:
        The HTML text.
    """
    picture = "" if is_reachable(place_of_kernel()) else picture_html(page.scene, theme)
    return picture + frame_html(page.url, page.port)


def picture_html(scene: SceneGraph, theme: Theme = LIGHT, width: int = 800, height: int = 500) -> str:
    """A picture of a scene as HTML.

    Args:
        scene: The scene.
        theme: Colours.
        width: Width [pixels].
        height: Height [pixels].

    Returns:
        The HTML text.
    """
    image = render(scene, width, height, camera_for(scene, width / height), theme=theme)
    data = base64.b64encode(encode_png(image)).decode("ascii")
    return f'<img src="data:image/png;base64,{data}" width="{width}" style="max-width:100%" alt="the scene"/>'


@lru_cache(maxsize=16)
def robot_html(robot: Any) -> str:
    """A robot as a notebook displays it: a picture and its table.

    Args:
        robot: An `ulna.Robot`.

    Returns:
        The HTML text; the table alone where its meshes cannot be read.
    """
    style = "font-family:monospace;line-height:1.2;overflow-x:auto;white-space:pre"
    table = f'<pre style="{style}">{html.escape(str(robot))}</pre>'
    scene = Scene()
    try:
        scene.add_robot(robot, configuration(robot, None))
    except UlnaError as error:
        return f"{table}<div>No picture: {html.escape(str(error))}</div>"
    return picture_html(scene, width=480, height=360) + table
