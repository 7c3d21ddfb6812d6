"""The parts of a page, and how they become an HTML file or a script."""

from __future__ import annotations

import base64
import html
import json
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from typing import Any, final

import numpy as np

from ulna.errors import InputError
from ulna.typing import Floats
from ulna.viewer.graph.camera import DIRECTION, camera_for
from ulna.viewer.live.credits import credits_of
from ulna.viewer.live.description import bounds, description, grid_step
from ulna.viewer.live.draggable import DraggableFrame
from ulna.viewer.live.kinematics import webassembly
from ulna.viewer.live.mesh_packing import packed_within
from ulna.viewer.live.poster import poster
from ulna.viewer.mesh.surface import albedo
from ulna.viewer.robot.robot_visual import RobotVisual

_MESH_SIZE, _MESH_SIZE_PER_LINK = 56_000, 4_300  # bytes that the meshes of a robot may have, compressed
_MAX_MESH_SIZE = 12_000_000  # bytes above which a page would take too long to start

_PAGE_STYLE = (
    "html,body{height:100%;margin:0;background:#dde4ec}ulna-robot{display:block;height:100vh;height:100dvh}"
    "ulna-robot:not(:defined){position:relative}"
    "ulna-robot:not(:defined) img{position:absolute;inset:0;width:100%;height:100%;object-fit:contain}"
    "@media(prefers-color-scheme:dark){html,body{background:#1b222d}}"
    "noscript{position:fixed;left:0;right:0;bottom:2em;text-align:center;font:14px system-ui,sans-serif;color:#678}"
)


@final
@dataclass(frozen=True)
class LivePage:
    """What a page is made of.

    Args:
        name: The name that `<ulna-robot robot="...">` asks for.
        title: The title.
        data: The description, as JSON can hold it.
        picture: The URL of the poster.
        theme: "auto", "light" or "dark".
    """

    name: str
    title: str
    data: Mapping[str, Any]
    picture: str
    theme: str


def live_page(
    visual: RobotVisual,
    frames: Sequence[DraggableFrame],
    motion: tuple[Floats, Floats] | None,
    title: str,
    theme: str,
) -> LivePage:
    """The parts of the page of a robot.

    Args:
        visual: The robot in its first configuration, alone in a scene.
        frames: The frames to drag.
        motion: Times (n,) [s] and configurations (n, nq) of what is played; None for nothing.
        title: The title.
        theme: "auto", "light" or "dark".

    Returns:
        The parts.

    Raises:
        InputError: The meshes are too large.
    """
    robot, scene = visual.robot, visual.scene
    points, floor = scene.points(), scene.floor()
    code, kernels = webassembly(robot.model, frames)
    data = description(robot, frames, visual.q, title) | {
        "bounds": bounds(points, floor),
        "view": DIRECTION,
        "meshes": _meshes(visual, grid_step(points)),
        "kernels": kernels,
        "wasm": _packed(code),
        "credits": [*credits_of(robot), *_ulna_credits()],
    }
    if motion is not None:
        rows = np.concatenate([motion[0], motion[1].reshape(-1)]).astype("<f8")
        data["motion"] = {"count": len(motion[0]), "data": _packed(rows.tobytes())}
    picture = poster(scene, camera_for(scene, 1.6), floor)
    return LivePage(_identifier(robot.name), title, data, picture, theme)


def document(page: LivePage) -> str:
    """The HTML file of a page."""
    title, label = html.escape(page.title), html.escape(page.title, quote=True)
    theme = "" if page.theme == "auto" else f' theme="{page.theme}"'
    return (
        f'<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n<title>{title}</title>\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1, viewport-fit=cover">\n'
        f"<style>{_PAGE_STYLE}</style>\n</head>\n<body>\n"
        f'<ulna-robot robot="{page.name}" keys="page"{theme}><img src="{page.picture}" alt="{label}"></ulna-robot>\n'
        "<noscript>This page needs JavaScript to move the robot.</noscript>\n"
        f"<script>{_inline(script(page))}</script>\n</body>\n</html>\n"
    )


def script(page: LivePage) -> str:
    """The script of a page: the program, and the robot."""
    name, data = json.dumps(page.name), json.dumps(page.data, separators=(",", ":"), allow_nan=False)
    return f"{_bundled('ulna-live.min.js')}\nulnaRobot({name},{data});\n"


def _bundled(name: str) -> str:
    """A file of the bundle, which scripts/live_page_bundle.py makes."""
    return (resources.files("ulna.viewer.live") / "bundle" / name).read_text(encoding="utf-8")


def _ulna_credits() -> list[dict[str, str]]:
    ulna = "Made with Ulna, MIT licence. The kinematics runs as WebAssembly, compiled from the robot's description."
    three = {
        "title": "three.js",
        "text": "The robot is drawn with three.js.",
        "licence": _bundled("three-LICENSE.txt"),
    }
    return [{"title": "Program", "text": ulna, "licence": ""}, three]


def _inline(content: str) -> str:
    """A script as it may stand in an HTML file."""
    return content.replace("</script", "<\\/script").replace("<!--", "<\\!--")


def _meshes(visual: RobotVisual, step: float) -> dict[str, Any]:
    links = [visual.scene.node(name).surfaces for name in visual.names]
    size = _MESH_SIZE + _MESH_SIZE_PER_LINK * sum(bool(s) for s in links)
    packed = packed_within(links, size, step)
    if len(packed.data) > _MAX_MESH_SIZE:
        raise InputError(
            f"The meshes of {visual.robot.name!r} take {len(packed.data) / 1e6:.0f} MB; expected at most "
            f'{_MAX_MESH_SIZE / 1e6:.0f} MB for a page. Show less with show="collision" or show="skeleton".'
        )
    surfaces = [{**s, "color": _colour(s["color"])} for s in packed.surfaces]
    data = base64.b64encode(packed.data).decode()
    return {"surfaces": surfaces, "streams": packed.streams, "step": step, "data": data}


def _colour(rgba: Sequence[float]) -> list[float]:
    """Linear red, green, blue, and opacity, as for `albedo`."""
    return [*np.round(albedo(np.array(rgba[:3])), 4).tolist(), rgba[3]]


def _packed(content: bytes) -> str:
    return base64.b64encode(zlib.compress(content, 9)).decode()


def _identifier(name: str) -> str:
    return "".join(c if c.isalnum() or c in "-_." else "-" for c in name) or "robot"
