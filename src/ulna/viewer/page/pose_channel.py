"""All poses in one message: the program that is put into the page of viser, and the messages that it understands.

Everything here was read in viser 1.1. Where a version is not known, poses go through the public interface instead.
"""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ulna.typing import Array
from ulna.viewer.page.motion_log import MotionPart

KNOWN_VERSIONS = ("1.1.",)
"""Versions of viser whose page has the queue that the hook relies on."""

KEY_LIGHT, SKY = "/(page)/key", "/(page)/sky"
"""The names of the directional light that casts shadows, and of the hemisphere light."""

POSES, APPEARANCES, FLOOR = "/(page)/poses", "/(page)/looks", "/(page)/floor"
"""The names under which all poses, and all looks that are not plain, are sent, which no node has; and the floor's."""

MOTION = "/(page)/motion"
"""The name, followed by a number, under which parts of the whole motion are sent."""

LAST = "/(page)/last"
"""The name of the last message of a program, which pages answer under the same name."""

_SCRIPTS = ("shadow_light", "render_on_demand", "playback", "scene_messages")


def is_known_version() -> bool:
    """Whether the version of viser is one whose page was read: with that queue, and normals that it computes itself."""
    import viser

    return viser.__version__.startswith(KNOWN_VERSIONS)


def _hook_script(title: str) -> str:
    """The program that makes viser's page ours."""
    source = "".join(_script(name) for name in _SCRIPTS)
    names = {
        "POSES": POSES,
        "APPEARANCES": APPEARANCES,
        "FLOOR": FLOOR,
        "MOTION": MOTION,
        "LAST": LAST,
        "KEY_LIGHT": KEY_LIGHT,
        "SKY": SKY,
        "TITLE": title,
    }
    return re.sub(
        r"\b(" + "|".join(names) + r")\b", lambda match: _javascript_string(names[match[0]]), source
    )


def _script(name: str) -> str:
    """The source of a program of the page."""
    return (Path(__file__).parent / "client" / f"{name}.js").read_text(encoding="utf-8")


def _javascript_string(text: str) -> str:
    """A text as JavaScript has it, also within HTML."""
    return json.dumps(text).replace("<", "\\u003c")


def early_script(title: str) -> str:
    """A program that runs before that of viser's page, and so before any message arrives."""
    return _script("early_hook").replace("HOOK", _hook_script(title))


class PoseChannel:
    """All poses in one message, where the version of viser is known to take it (`open`).

    Args:
        server: The viser server.
        title: The title of the page.
        is_ulnas_page: Whether the server sends Ulna's page, not viser's.
    """

    def __init__(self, server: Any, title: str, is_ulnas_page: bool = True) -> None:
        self.is_supported = is_ulnas_page and is_known_version()
        self._server = server
        if self.is_supported:
            from viser import _messages

            self._message = _messages.SceneNodeUpdateMessage
            self._script = _messages.RunJavascriptMessage
            self._run(_hook_script(title))

    def send_poses(self, paths: Sequence[str], rows: Array, t: float | None = None) -> None:
        """Send poses; they replace those not sent yet.

        Args:
            paths: Paths of the nodes in the page.
            rows: x y z [m], w x y z of each, (n, 7) float32.
            t: Their time in the motion [s], which the page keeps; None for poses that are no part of it.
        """
        self._queue(POSES, {"names": list(paths), "p": rows, "t": t})

    def send_motion(self, parts: Sequence[MotionPart]) -> None:
        """Send the whole motion, which the page plays after its program has ended.

        Args:
            parts: Its parts, in order.
        """
        for k, part in enumerate(parts):
            updates = {"names": part.paths, "t": part.t, "p": part.rows, "part": k, "parts": len(parts)}
            self._queue(f"{MOTION} {k}", updates)

    def send_last(self) -> None:
        """Send a message that pages answer: those that did have everything that was sent before."""
        self._queue(LAST, {})

    def send_appearances(self, paths: Sequence[str], rows: Array, texts: dict[str, str]) -> None:
        """Send appearances; they replace those not sent yet. Nodes that are not named look plain.

        Args:
            paths: Paths of the nodes in the page.
            rows: Linear red, green, blue or -1, opacity, three scales of each, (n, 7) float32.
            texts: Texts of labels by path.
        """
        self._queue(APPEARANCES, {"names": list(paths), "v": rows.reshape(-1), "words": texts})

    def send_appearances_to_file(self, paths: Sequence[str], rows: Array, texts: dict[str, str]) -> None:
        """Send appearances to a recording, which delivers its first messages together before it processes any.

        Args:
            paths: Paths of the nodes in the page.
            rows: As for `send_appearances`, (n, 7).
            texts: Texts of labels by path.
        """
        updates = {"names": list(paths), "v": rows.reshape(-1).tolist(), "words": texts}
        message = {"type": "SceneNodeUpdateMessage", "name": APPEARANCES, "updates": updates}
        self._run(f"window.__viserMutable.messageQueue.push({json.dumps(message)})")

    def _run(self, script: str) -> None:
        self._server._websock_server.queue_message(self._script(source=script))

    def _queue(self, name: str, updates: dict[str, Any]) -> None:
        self._server._websock_server.queue_message(self._message(name, updates))
