"""The page in the browser: a scene by way of viser, sending the newest poses only.

A program never waits for the browser. It hands its newest state to the scene; a thread of the page looks 60 times a
second and sends all poses in one message. Where that is not known to work (another version of viser) every node is
set through viser's public interface instead: slower, the same picture. Changes of controls and of the dragged target
come back through that thread, one after the other and the newest only, so that the functions which handle them need
no locks among themselves.
"""

from __future__ import annotations

import atexit
import itertools
import secrets
import sys
import threading
import time
import traceback
import warnings
from collections.abc import Callable
from typing import Any

from ulna.errors import UlnaWarning
from ulna.system import forks
from ulna.viewer.graph.camera import Camera, checked_camera
from ulna.viewer.graph.scene_graph import SceneGraph
from ulna.viewer.graph.theme import LIGHT, Theme
from ulna.viewer.page import access as guard
from ulna.viewer.page.ending import has_tabs, wait_for_tabs
from ulna.viewer.page.framing import Framing, framing_camera
from ulna.viewer.page.motion_log import MotionLog
from ulna.viewer.page.notebook import frame_html, place_of_kernel
from ulna.viewer.page.notifications import ProgressNotifications
from ulna.viewer.page.pose_channel import PoseChannel
from ulna.viewer.page.publisher import Publisher
from ulna.viewer.page.server import disconnect, serve, stop, visits_of
from ulna.viewer.page.surroundings import add_floor, configure_scene, set_camera
from ulna.viewer.progress import unwatch, watch

RATE = 60.0
"""How often the page looks for something new [1/s]."""

_FRAMING_INTERVAL = 0.2  # s between two computations of a camera that shows everything


class Page:
    """A page in the browser that shows a scene.

    Args:
        scene: What to show; the page follows it.
        title: The heading of the panel.
        port: Port to listen on; the next free one is taken when it is in use, 0 takes any; None for that of the
            environment variable `ULNA_PORT`, or 8080.
        host: Address to listen on. Other than the loopback addresses need a token, which `url` contains.
        camera: The first camera; one that shows the whole scene when not given.
        theme: The colours around.
        floor: Height of the floor [m]; below everything when not given.
        live: Whether it follows the scene continuously. Otherwise the scene is sent by `flush` only, with colours
            as they are for good: for recordings.
        server: A `viser.ViserServer` of the program to show the scene on. Its page, lights, floor and camera stay as
            they are, poses go through viser's public interface, and `close` does not stop it.

    Raises:
        MissingExtra: viser is not installed.
        ViewerError: The page cannot be served.
    """

    def __init__(
        self,
        scene: SceneGraph,
        title: str = "Ulna",
        port: int | None = None,
        host: str = "127.0.0.1",
        camera: Camera | None = None,
        theme: Theme = LIGHT,
        floor: float | None = None,
        live: bool = True,
        server: Any = None,
    ) -> None:
        self.scene, self.title, self._live = scene, title, live
        checked_camera(camera)
        self._owned = server is None
        self._token = _token(host) if server is None else ""
        self.server = serve(host, port, title, self._token) if server is None else server
        host = self.server.get_host()
        self._host = "localhost" if host in (*guard.LOOPBACK, "0.0.0.0", "::") else host
        if self._owned and host not in guard.LOOPBACK:
            warnings.warn(_open_to_network(host, self.port), UlnaWarning, stacklevel=2)
        channel = PoseChannel(self.server, f"{title} · Ulna" if title != "Ulna" else title, self._owned)
        self._publisher = Publisher(scene, self.server, channel, live, theme)
        self._viser_shadows = not channel.is_supported
        self._events: dict[int, tuple[Callable[[Any], None], Any]] = {}
        self._events_lock = forks.lock()
        self._event_count = itertools.count(1)
        self._tick_lock = forks.lock()
        self._ticks: list[Callable[[], None]] = []
        self._stop, self._last_error = threading.Event(), ""
        self._floor, self._grid, self._theme = floor, True, theme
        self._camera_chosen, self._framing_requested, self._framed_at = camera is not None, False, 0.0
        self.visited = False
        """Whether any tab has looked at it so far."""
        self._thread = threading.Thread(target=self._run, name="ulna-page", daemon=True)
        self._notifications = ProgressNotifications(self.server)
        self.play_out: Callable[[], None] = lambda: None
        """Called before the whole motion is sent to tabs: adds what a motion that is being played has left."""
        self._framing = Framing(scene, self.server)
        self._show(camera)

    def _show(self, camera: Camera | None) -> None:
        """Sends the scene to the server, and what changes later if the page is live."""
        atexit.register(self._close_at_exit)
        forks.in_child(self._leave)
        if self._owned:
            configure_scene(self.server, self._theme, self._viser_shadows)
            add_floor(self.server, self._theme, self.scene.floor() if self._floor is None else self._floor)
            set_camera(self.server, camera or framing_camera(self.scene))
        self.server.on_client_connect(self._on_connect)
        with self._tick_lock:
            self._publish()
        if self._live:
            self._thread.start()
            watch(self._notifications)

    @property
    def port(self) -> int:
        """The port it listens on."""
        return int(self.server.get_port())

    @property
    def url(self) -> str:
        """Its address."""
        return f"http://{self._host}:{self.port}" + (f"/?token={self._token}" if self._token else "")

    @property
    def clients(self) -> int:
        """How many tabs are looking at it."""
        return 0 if self._stop.is_set() else len(self.server.get_clients())

    @property
    def closed(self) -> bool:
        """Whether `close` was called."""
        return self._stop.is_set()

    @property
    def motion(self) -> MotionLog:
        """What the page can play after its program has ended."""
        return self._publisher.motion

    def close(self) -> None:
        """Stop serving; tabs show the newest state, and play the motion until then. May be called twice."""
        self._close(at_exit=False)

    def note_opened(self) -> None:
        """A browser was started with the address: the end of the program waits for its tab."""
        visits_of(self.server).note_opened()

    def _close_at_exit(self) -> None:
        self._close(at_exit=True)

    def _close(self, at_exit: bool) -> None:
        if self._stop.is_set():
            return
        try:
            self.flush()  # tabs keep what they had last: the newest, not that of a sixtieth of a second ago
            if self._live and self._owned and has_tabs(self.server, at_exit):
                with self._tick_lock:
                    self.play_out()
                    self._publisher.send_motion()
                self.server.flush()
                wait_for_tabs(self.server, at_exit)
        finally:
            self._stop.set()
            unwatch(self._notifications)
            if self._thread.is_alive() and threading.current_thread() is not self._thread:
                self._thread.join(timeout=2.0)
            if self._owned:
                stop(self.server)
            atexit.unregister(self._close_at_exit)

    def _leave(self) -> None:
        """In a forked child: the page is the parent's; here it is closed, and nothing reaches the tabs."""
        self._stop = threading.Event()  # the lock of the old one may be held
        self._stop.set()
        unwatch(self._notifications)
        atexit.unregister(self._close_at_exit)
        disconnect(self.server)

    def __enter__(self) -> Page:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _repr_html_(self) -> str:
        return frame_html(self.url, self.port)

    def set_camera(self, camera: Camera | None = None) -> None:
        """Set the camera of every tab; one that shows the whole scene when not given."""
        self._camera_chosen = camera is not None
        if camera is not None:
            set_camera(self.server, camera)
        else:
            self._framing.update(moved_too=True)

    def request_framing(self) -> None:
        """Show the whole scene above the floor soon, where no camera or floor was chosen and nobody moved the view."""
        self._framing_requested = True

    def _frame_scene(self, now: float) -> None:
        self._framing_requested, self._framed_at = False, now
        if not self._owned:
            return
        if not self._camera_chosen:
            self._framing.update()
        if self._floor is None:
            add_floor(self.server, self._theme, self.scene.floor(), self._grid)

    def set_theme(self, theme: Theme, floor: float | None, grid: bool = True) -> None:
        """Change colours, lights and floor.

        Args:
            theme: The theme.
            floor: Height of the floor [m]; None for below everything.
            grid: Whether there is a floor.
        """
        with self._tick_lock:
            self._theme, self._floor, self._grid = theme, floor, grid
            self._publisher.set_theme(theme)
        configure_scene(self.server, theme, self._viser_shadows)
        if self._owned or floor is not None:
            add_floor(self.server, theme, self.scene.floor() if floor is None else floor, grid)

    def flush(self) -> None:
        """Send what the scene holds now, without waiting for the thread of the page."""
        if self._stop.is_set():
            return
        with self._tick_lock:
            self._publisher.send_content_now()
            self._framed_at = 0.0
            self._publish()
        self.server.flush()

    def add_tick(self, function: Callable[[], None]) -> None:
        """Call `function` on the thread of the page, 60 times a second, before poses are sent."""
        self._ticks.append(function)

    def remove_tick(self, function: Callable[[], None]) -> None:
        """Do not call `function` any more."""
        self._ticks = [f for f in self._ticks if f != function]

    def post_event(self, key: int | None, function: Callable[[Any], None], value: Any) -> None:
        """Have a function called on the thread of the page.

        Args:
            key: Of calls with the same key only the newest is made; None makes every call.
            function: The function.
            value: Its argument.
        """
        with self._events_lock:
            key = -next(self._event_count) if key is None else key
            self._events.pop(key, None)  # in the order of the newest
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
                if complaint != self._last_error and not self._stop.is_set():  # once, not 60 times a second
                    print(complaint, file=sys.stderr, end="")
                self._last_error = complaint
            due = max(due + 1.0 / RATE, time.monotonic())
            self._stop.wait(due - time.monotonic())

    async def _on_connect(self, client: Any) -> None:
        self.visited = True
        self.request_framing()  # as wide as its window is
        self.resend()

    def resend(self) -> None:
        """Send poses and looks again for a while: a newcomer replays the scene, and its hook may come after them."""
        self._publisher.resend()

    def _publish(self) -> None:
        now = time.monotonic()
        if self._framing_requested and now - self._framed_at > _FRAMING_INTERVAL:
            self._frame_scene(now)
        self._publisher.publish(now)


def _token(host: str) -> str:
    """A token for the addresses of a page, if others than this user can reach it; else an empty string."""
    exposed = guard.checked_host(host) not in guard.LOOPBACK
    # a hub forwards requests under its own name, and maybe those of its other users: the token distinguishes them
    return secrets.token_urlsafe(24) if exposed or place_of_kernel() == "proxied hub" else ""


def _open_to_network(host: str, port: int) -> str:
    return (
        f"The page is open to the network of {host}, port {port}: anyone who has its address with the token can look, "
        "drag and press. The connection is not encrypted. "
        f"A tunnel is safer: ssh -L {port}:localhost:{port} ..."
    )
