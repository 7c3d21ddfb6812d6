"""Synchronisation of the page with the scene: changed nodes, appearances and poses are sent."""

from __future__ import annotations

import time
from typing import Any, final

from ulna.viewer.graph.content import Text
from ulna.viewer.graph.node import Snapshot
from ulna.viewer.graph.scene_graph import SceneGraph
from ulna.viewer.graph.theme import Theme
from ulna.viewer.page.motion_log import MotionLog
from ulna.viewer.page.pose_channel import PoseChannel
from ulna.viewer.page.poses import pose_rows
from ulna.viewer.page.viser_nodes import (
    ViserNode,
    add_node,
    appearance_of,
    appearance_rows,
    is_drawn,
)
from ulna.viewer.page.viser_paths import ViserPaths

_DEFAULT_APPEARANCE = (-1.0, -1.0, -1.0, 1.0, 1.0, 1.0, 1.0)
_CONTENT_TIME_FRACTION = 1 / 8
"""Part of its time that the page's thread may spend on contents that change all the time [-]."""
_MAX_CONTENT_DELAY = 0.25
"""How long such contents wait at most [s]."""
_IDLE_TIME = 0.3
"""How long no pose must have changed for the scene to count as at rest [s]."""


@final
class Publisher:
    """Sends what is new in a scene to the tabs of a server.

    Args:
        scene: What to show.
        server: A viser server.
        channel: Sends poses and appearances.
        live: Whether colours may change later; in a recording they are part of the nodes.
        theme: The colours of the background.
    """

    def __init__(
        self, scene: SceneGraph, server: Any, channel: PoseChannel, live: bool, theme: Theme
    ) -> None:
        self._scene, self._server, self._channel = scene, server, channel
        self._theme = theme
        self._has_fixed_appearance = not (live and channel.is_supported)
        self.shown: dict[str, ViserNode] = {}
        """The nodes of the scene as the page has them."""
        self._paths = ViserPaths()
        self._pose_targets: tuple[list[str], list[int]] | None = None
        self._content_due = 0.0  # when contents may be sent again
        self._label_texts: dict[str, str] = {}  # of the texts that a file contains
        self._content_pending = False  # whether some have not been sent yet
        self._sent = (-1, -1, -1)
        self._is_at_rest = True
        self._moved_at = 0.0
        self.motion = MotionLog()
        """The motion that the page can play after its program has ended."""
        self._logs = live and channel.is_supported
        self.resend_until = 0.0
        """Until when poses and appearances are sent again for new tabs [s, monotonic]."""

    def resend(self) -> None:
        """Send poses and appearances again for a while: a new tab replays the scene, and may install its hook later."""
        self.resend_until = time.monotonic() + 3.0

    def set_theme(self, theme: Theme) -> None:
        """Change the theme: labels without a colour have the text colour of the theme."""
        self._theme, self._sent = theme, (*self._sent[:2], -1)

    def send_content_now(self) -> None:
        """Send contents that change often at once."""
        self._content_due = 0.0

    def publish(self, now: float) -> None:
        """Send what is new at this time [s, monotonic]."""
        unchanged = self._is_at_rest and self._scene.version == self._sent
        if unchanged and now >= self.resend_until and not self._content_pending:
            return
        snapshot = self._scene.snapshot()
        structure, _, appearances = self._sent
        if snapshot.structure != structure or self._content_pending:
            self._update_nodes(snapshot, now)
        if snapshot.appearance != appearances or snapshot.structure != structure or now < self.resend_until:
            self._update_appearances(snapshot)
        t = None
        if snapshot[:3] != self._sent:
            t = self.motion.add_published(snapshot) if self._logs else None
            self._sent, self._is_at_rest, self._moved_at = snapshot[:3], False, now
        elif not self._is_at_rest and now - self._moved_at > _IDLE_TIME:
            # at rest: leave the poses in viser's own state, too, which new tabs and recordings start from
            self._is_at_rest = True
            self._set_each(snapshot)
        elif now >= self.resend_until:
            return
        if self._channel.is_supported:
            self._send(snapshot, t)
        else:
            self._set_each(snapshot)

    def send_motion(self) -> None:
        """Send the whole motion, for pages to play after the program has ended, and ask them whether they have it."""
        if self._logs:
            self.motion.add_step(self._scene.snapshot, at_end=True)
            paths = {name: [h.name for h in node.handles] for name, node in self.shown.items()}
            self._channel.send_motion(self.motion.parts(paths))
            self._channel.send_last()

    def _update_nodes(self, snapshot: Snapshot, now: float) -> None:
        """Make the nodes of the page those of the scene."""
        present = {node.name: (i, node) for i, node in enumerate(snapshot.nodes) if is_drawn(node)}
        self._content_pending, self._pose_targets = False, None
        began, too_early = time.thread_time(), now < self._content_due
        for name, shown in list(self.shown.items()):
            i, node = present.get(name, (0, None))
            if node is shown.node:
                continue
            if too_early and node is not None and node.content is not None:
                self._content_pending = True
            elif node is None or not shown.update_content(snapshot, i):
                self._remove_node(name)
        for name, (i, _) in present.items():
            if name not in self.shown:
                path = self._paths.take(name)
                self.shown[name] = self._add_node(path, snapshot, i)
                self.resend_until = max(self.resend_until, now + 1.0)
        if not too_early:
            self._content_due = now + min(
                (time.thread_time() - began) / _CONTENT_TIME_FRACTION, _MAX_CONTENT_DELAY
            )

    def _add_node(self, path: str, snapshot: Snapshot, i: int) -> ViserNode:
        return add_node(
            self._server, path, snapshot, i, self._has_fixed_appearance, self._channel.is_supported
        )

    def _remove_node(self, name: str) -> None:
        shown = self.shown.pop(name)
        shown.remove()
        self._paths.free(shown.path)

    def _update_appearances(self, snapshot: Snapshot) -> None:
        """Colours, opacity, scale and visibility as the scene has them."""
        paths, appearances, texts = [], [], {}
        text_colour = tuple(c / 255 for c in self._theme.text)
        for i, node in enumerate(snapshot.nodes):
            shown = self.shown.get(node.name)
            if shown is None:
                continue
            appearance = appearance_of(snapshot, i)
            if (
                appearance != shown.appearance
                and not shown.is_mesh
                and shown.node is node
                and not shown.update_scale(appearance)
            ):
                shown.remove()
                shown = self.shown[node.name] = self._add_node(shown.path, snapshot, i)
                self._pose_targets = None
            shown.appearance = appearance
            shown.set_visible(bool(snapshot.visible[i]))
            if shown.is_mesh and isinstance(node.content, Text):
                texts[shown.path] = node.content.text
                appearance = (*text_colour, *appearance[3:]) if appearance[0] < 0 else appearance
            if shown.is_mesh and appearance != _DEFAULT_APPEARANCE:
                paths.append(shown.path)
                appearances.append(appearance)
        rows = appearance_rows(appearances, [p in texts for p in paths])
        if not self._has_fixed_appearance:
            self._channel.send_appearances(paths, rows, texts)
        elif texts and texts != self._label_texts:
            self._label_texts = texts
            self._channel.send_appearances_to_file(paths, rows, texts)

    def _send(self, snapshot: Snapshot, t: float | None) -> None:
        if self._pose_targets is None:
            pairs = [
                (h.name, i)
                for i, n in enumerate(snapshot.nodes)
                if n.name in self.shown
                for h in self.shown[n.name].handles
            ]
            self._pose_targets = [path for path, _ in pairs], [i for _, i in pairs]
        paths, rows = self._pose_targets
        self._channel.send_poses(paths, pose_rows(snapshot.poses[rows]), t)

    def _set_each(self, snapshot: Snapshot) -> None:
        for node, row in zip(snapshot.nodes, pose_rows(snapshot.poses), strict=True):
            if node.name in self.shown:
                self.shown[node.name].set_pose(row)
