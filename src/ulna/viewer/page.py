"""The page in the browser: a scene and controls, by way of viser, sending the newest poses only.

A program never waits for the browser. It writes poses into the scene; a thread of the page looks 60 times a
second and sends all of them in one message. Where that is not known to work (another version of viser) every
node is set through viser's public interface instead: slower, the same picture. Changes of sliders and of the
dragged target come back through that thread, one after the other and the newest only, so that the functions
which handle them need no locks among themselves.
"""

from __future__ import annotations

import atexit
import contextlib
import itertools
import sys
import threading
import time
import traceback
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from ulna.typing import Floats
from ulna.viewer import guard
from ulna.viewer.camera import Camera, frame
from ulna.viewer.channel import PoseChannel, serve, stop
from ulna.viewer.controls import Control, Gizmo, pose_rows, position_wxyz
from ulna.viewer.glb import glb
from ulna.viewer.look import decorate
from ulna.viewer.scene import Node, Scene

RATE = 60.0
"""How often the page looks for something new [1/s]."""


class Page:
    """A page in the browser that shows a scene.

    Args:
        scene: What to show; the page follows it.
        title: What stands over the panel.
        port: Port to listen on; the next free one is taken when it is in use, 0 takes any.
        host: Address to listen on. Beyond the loopback anyone who can reach it can look and drag.
        camera: Where the scene is looked at from at first; one that has everything in view when not given.

    Raises:
        MissingExtra: viser is not installed.
        ViewerError: The page cannot be served.
    """

    def __init__(
        self,
        scene: Scene,
        title: str = "Ulna",
        port: int = 8080,
        host: str = "127.0.0.1",
        camera: Camera | None = None,
    ) -> None:
        self.scene, self.title = scene, title
        self._server = serve(host, port, title)
        self._host = "localhost" if host in (*guard.LOOPBACK, "0.0.0.0", "::") else host
        self._channel = PoseChannel(self._server, f"{title} · Ulna" if title != "Ulna" else title)
        self._handles: dict[str, Any] = {}
        self._shown: dict[str, Node] = {}
        self._paths: dict[str, str] = {}
        self._sent = (-1, -1)
        self._settled = True
        self._again = self._moved_at = 0.0
        self._events: dict[int, tuple[Callable[[Any], None], Any]] = {}
        self._events_lock = threading.Lock()
        self._count = itertools.count(1)
        self._tick_lock = threading.RLock()
        self._ticks: list[Callable[[], None]] = []
        self._stop = threading.Event()
        self._complaint = ""
        self.visited = False
        """Whether any tab has looked at it so far."""
        atexit.register(self.close)
        # robots reach further than they stand, and the panel covers the right
        decorate(self._server, camera or frame(scene, margin=1.75, aside=0.10), scene.floor())
        self._server.on_client_connect(self._greet)
        with self._tick_lock:
            self._publish()
        self._thread = threading.Thread(target=self._run, name="ulna-page", daemon=True)
        self._thread.start()

    @property
    def port(self) -> int:
        """The port it listens on."""
        return int(self._server.get_port())

    @property
    def url(self) -> str:
        """Its address."""
        return f"http://{self._host}:{self.port}"

    @property
    def clients(self) -> int:
        """How many tabs are looking at it."""
        return 0 if self._stop.is_set() else len(self._server.get_clients())

    @property
    def closed(self) -> bool:
        """Whether `close` was called."""
        return self._stop.is_set()

    def close(self) -> None:
        """Stop serving; tabs go grey. May be called twice."""
        if self._stop.is_set():
            return
        self._stop.set()
        if threading.current_thread() is not self._thread:
            self._thread.join(timeout=2.0)
        stop(self._server)
        atexit.unregister(self.close)

    def __enter__(self) -> Page:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _repr_html_(self) -> str:
        return f'<iframe src="{self.url}" width="100%" height="560" style="border:0"></iframe>'

    def flush(self) -> None:
        """Send what the scene holds now, without waiting for the thread of the page."""
        with self._tick_lock:
            self._publish()
        self._server.flush()

    def each_tick(self, function: Callable[[], None]) -> None:
        """Call `function` on the thread of the page, 60 times a second, before poses are sent."""
        self._ticks.append(function)

    # controls -----------------------------------------------------------------------------------------------

    @contextlib.contextmanager
    def folder(self, label: str, open: bool = True) -> Iterator[None]:
        """Controls that are made within stand together under a heading."""
        with self._server.gui.add_folder(label, expand_by_default=open):
            yield

    def slider(
        self,
        label: str,
        low: float,
        high: float,
        value: float,
        on_change: Callable[[float], None],
        *,
        step: float = 0.001,
        hint: str | None = None,
    ) -> Control:
        """A slider; `on_change` is called with its value when someone moves it."""
        handle = self._server.gui.add_slider(
            label, low, high, step, float(np.clip(value, low, high)), hint=hint
        )
        return self._control(handle, on_change)

    def buttons(self, label: str, options: tuple[str, ...], on_click: Callable[[str], None]) -> Control:
        """A row of buttons, or a menu of many; `on_click` is called with the one that was chosen."""
        if len(options) <= 6:
            handle = self._server.gui.add_button_group(label, options)
            return self._control(handle, on_click, handle.on_click)
        return self._control(self._server.gui.add_dropdown(label, options), on_click)

    def text(self, content: str) -> Control:
        """A piece of text in Markdown; setting `value` replaces it."""
        return Control(self._server.gui.add_markdown(content), "content")

    def gizmo(
        self, name: str, pose: Floats, on_drag: Callable[[tuple[Floats, str]], None], size: float = 0.2
    ) -> Gizmo:
        """A pose to drag; `on_drag` is called with (T_world_gizmo, "start" | "update" | "end")."""
        position, wxyz = position_wxyz(pose)
        handle = self._server.scene.add_transform_controls(
            f"/(page)/{name}",
            scale=size,
            line_width=3.0,
            depth_test=False,
            opacity=0.9,
            position=position,
            wxyz=wxyz,
        )
        gizmo = Gizmo(handle)

        @handle.on_update
        async def _(event: Any) -> None:  # async: on viser's own loop, so that events stay in order
            gizmo.held = event.phase != "end"
            # starts and ends are never dropped, of updates only the newest counts
            key = id(handle) if event.phase == "update" else -next(self._count)
            self._notice(key, on_drag, (gizmo.pose, event.phase))

        return gizmo

    def _control(self, handle: Any, function: Callable[[Any], None], register: Any = None) -> Control:
        async def changed(event: Any) -> None:
            if event.client is not None:  # a value that the program set itself is no news
                self._notice(id(handle), function, getattr(handle, "value", None))

        (register or handle.on_update)(changed)
        return Control(handle, "value")

    def _notice(self, key: int, function: Callable[[Any], None], value: Any) -> None:
        with self._events_lock:
            self._events.pop(key, None)  # the newest only, and in the order of the newest
            self._events[key] = (function, value)

    # the thread --------------------------------------------------------------------------------------------

    def _run(self) -> None:
        due = time.monotonic()
        while not self._stop.is_set():
            try:
                with self._tick_lock:
                    with self._events_lock:
                        events, self._events = list(self._events.values()), {}
                    for function, value in events:
                        function(value)
                    for tick in self._ticks:
                        tick()
                    self._publish()
            except Exception:  # a mistake in a user's function must not silence the page
                complaint = traceback.format_exc()
                if complaint != self._complaint and not self._stop.is_set():  # once, not 60 times a second
                    print(complaint, file=sys.stderr, end="")
                self._complaint = complaint
            due = max(due + 1.0 / RATE, time.monotonic())
            self._stop.wait(due - time.monotonic())

    async def _greet(self, client: Any) -> None:
        # a newcomer replays the scene, and its hook may come after the poses; those are sent again for a while
        self.visited = True
        self._again = time.monotonic() + 3.0

    def _publish(self) -> None:
        if self._settled and self.scene.version == self._sent and time.monotonic() >= self._again:
            return
        structure, motion, nodes, poses = self.scene.snapshot()
        if structure != self._sent[0]:
            self._build(nodes, poses)
        now = time.monotonic()
        if (structure, motion) != self._sent:
            self._sent, self._settled, self._moved_at = (structure, motion), False, now
        elif not self._settled and now - self._moved_at > 0.3:
            # at rest: leave the poses in viser's own state, too, which newcomers and recordings start from
            self._settled = True
            self._set_each(nodes, poses)
        elif now >= self._again:
            return
        if self._channel.open:
            self._send(nodes, poses)
        else:
            self._set_each(nodes, poses)

    def _build(self, nodes: tuple[Node, ...], poses: Floats) -> None:
        present = {node.name: node for node in nodes}
        for name in [n for n, node in self._shown.items() if present.get(n) is not node]:
            handle = self._handles.pop(name, None)
            if handle is not None:
                handle.remove()
            del self._shown[name]
            self._paths.pop(name, None)
        for node, pose in zip(nodes, poses, strict=True):
            if node.name in self._shown:
                continue
            self._shown[node.name] = node
            if not any(len(s.triangles) for s in node.surfaces):
                continue
            position, wxyz = position_wxyz(pose)
            path = self._paths[node.name] = self._path(node.name)
            self._handles[node.name] = self._server.scene.add_glb(
                path,
                glb(node.surfaces),
                position=position,
                wxyz=wxyz,
                cast_shadow=node.shadow and not node.translucent,
            )
        self._again = max(self._again, time.monotonic() + 1.0)

    def _path(self, name: str) -> str:
        """A path of its own with no other pose above it: groups are for display, poses are of the world."""
        group, _, rest = name.partition("/")
        taken = set(self._paths.values())
        if rest:
            while f"/{group}" in taken:  # a node stands there, and would carry the group along
                group += " ·"
            path = f"/{group}/{rest.replace('/', ' › ')}"
        else:
            path = f"/{group}"
            while any(other.startswith(f"{path}/") for other in taken):
                path += " ·"
        while path in taken:
            path += "'"
        return path

    def _send(self, nodes: tuple[Node, ...], poses: Floats) -> None:
        rows = [i for i, node in enumerate(nodes) if node.name in self._paths]
        self._channel.send([self._paths[nodes[i].name] for i in rows], pose_rows(poses[rows]))

    def _set_each(self, nodes: tuple[Node, ...], poses: Floats) -> None:
        for node, row in zip(nodes, pose_rows(poses), strict=True):
            handle = self._handles.get(node.name)
            if handle is not None:
                handle.position, handle.wxyz = row[:3], row[3:]
