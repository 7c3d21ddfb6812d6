"""What notebooks display: the page in a frame, or a picture and how to see the page; robots as picture and table."""

from __future__ import annotations

import base64
import html
import os
import sys
from functools import lru_cache
from typing import Any, Literal

from ulna.viewer.graph.camera import camera_for
from ulna.viewer.graph.scene_graph import SceneGraph
from ulna.viewer.graph.theme import LIGHT, Theme
from ulna.viewer.output.png import encode_png
from ulna.viewer.render.renderer import render

Place = Literal["here", "hub", "colab", "vscode", "ssh"]

_NOTES: dict[Place, str] = {
    "here": "",
    "hub": "This notebook runs on a JupyterHub: its kernel is on another machine, where your browser does not reach "
    "{url}. This is a picture; <code>viewer.html('scene.html')</code> writes a page with the motion that you can "
    "download and open. Where you can log in to that machine, <code>ssh -L {port}:localhost:{port} ...</code> "
    "brings the page itself to {link}.",
    "colab": "This notebook runs on Colab, where your browser does not reach {url}. This is a picture; "
    "<code>viewer.html('scene.html')</code> writes a page with the motion that you can download and open.",
    "vscode": "The page is at {link}. Where it stays empty the kernel runs on another machine: forward port {port} in "
    "VS Code's view <i>Ports</i>.",
    "ssh": "The page is at {link}. Where it stays empty, forward its port from your machine: "
    "<code>ssh -L {port}:localhost:{port} ...</code>",
}


def place_of_kernel() -> Place:
    """Where the kernel of a notebook runs, as far as the environment says."""
    if "google.colab" in sys.modules or "COLAB_RELEASE_TAG" in os.environ:
        return "colab"
    if "JUPYTERHUB_SERVICE_PREFIX" in os.environ or "JUPYTERHUB_USER" in os.environ:
        return "hub"
    if any(
        name in os.environ
        for name in ("VSCODE_PID", "VSCODE_IPC_HOOK_CLI", "CODESPACES", "REMOTE_CONTAINERS")
    ):
        return "vscode"
    return "ssh" if "SSH_CONNECTION" in os.environ else "here"


def page_html(scene: SceneGraph, url: str, port: int, theme: Theme = LIGHT) -> str:
    """A page in a frame; a picture of its scene where the user's browser does not reach it; and a note on where it is.

    Args:
        scene: What the page shows.
        url: Its address.
        port: Its port.
        theme: Colours of the picture.

    Returns:
        The HTML text.
    """
    place = place_of_kernel()
    link = f'<a href="{url}" target="_blank">{url}</a>'
    note = _NOTES[place].format(url=url, port=port, link=link)
    below = f'<div style="font-size:smaller;opacity:0.8">{note}</div>' if note else ""
    if place in ("hub", "colab"):
        return picture_html(scene, theme) + below
    return f'<iframe src="{url}" width="100%" height="560" style="border:0"></iframe>{below}'


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
    return f'<img src="data:image/png;base64,{data}" width="{width}" alt="the scene"/>'


@lru_cache(maxsize=16)
def robot_html(robot: Any) -> str:
    """A robot as a notebook displays it: a picture and its table.

    Args:
        robot: An `ulna.Robot`.

    Returns:
        The HTML text; the table alone where its meshes cannot be read.
    """
    from ulna.errors import UlnaError
    from ulna.viewer.robot.configuration import configuration
    from ulna.viewer.scene import Scene

    table = f'<pre style="line-height:1.2;overflow-x:auto">{html.escape(str(robot))}</pre>'
    scene = Scene()
    try:
        scene.add_robot(robot, configuration(robot, None))
    except UlnaError as error:
        return f"{table}<div>No picture: {html.escape(str(error))}</div>"
    return picture_html(scene, width=480, height=360) + table
