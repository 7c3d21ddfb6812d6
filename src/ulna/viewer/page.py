"""The page in the browser: the one file that knows viser, bound to this machine, sending the newest only.

A program never waits for the browser. It writes poses into the scene; a thread of the page looks 60 times a
second and sends all of them in one message, through a hook in the page's own queue. Where the hook is not
known to work (another version of viser) every node is set through viser's public interface instead: slower,
the same picture. Changes of sliders and of the dragged target come back through that thread, one after the
other and the newest only, so that the functions which handle them need no locks among themselves.
"""

from __future__ import annotations

import atexit
import contextlib
import itertools
import threading
import time
import traceback
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from ulna.errors import InputError, MissingExtra, ViewerError
from ulna.spatial import matrix_to_quat_xyzw, quat_xyzw_to_matrix
from ulna.typing import Array, ArrayLike, Floats
from ulna.viewer import guard
from ulna.viewer.camera import Camera, frame
from ulna.viewer.glb import glb
from ulna.viewer.scene import Node, Scene

RATE = 60.0
"""How often the page looks for something new [1/s]."""

_KNOWN = ("1.1.",)  # versions of viser whose page has the queue that the hook relies on
_POSES = "/__ulna_poses"
_HOOK = """(() => {
  const page = window.__viserMutable;
  if (!page || page.messageQueue.ulna) return;
  const queue = page.messageQueue, push = Array.prototype.push;
  const apply = ({names, p}) => names.forEach((name, i) => {
    const pose = page.nodePoseData[name];
    if (!pose) return;
    const k = 7 * i;
    pose.position = [p[k], p[k + 1], p[k + 2]];
    pose.wxyz = [p[k + 3], p[k + 4], p[k + 5], p[k + 6]];
    if (pose.poseUpdateState !== "waitForMakeObject") pose.poseUpdateState = "needsUpdate";
  });
  Object.defineProperty(queue, "ulna", {value: true});
  Object.defineProperty(queue, "push", {value: (...messages) => {
    for (const m of messages) {
      if (m.type === "SceneNodeUpdateMessage" && m.name === "/__ulna_poses") apply(m.updates);
      else push.call(queue, m);
    }
    return queue.length;
  }});
})();"""
_construction = threading.Lock()


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
        self._server = _serve(host, port, title)
        self._host = "localhost" if host in (*guard.LOOPBACK, "0.0.0.0", "::") else host
        self._messages, self._hooked = _channel(self._server)
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
        # robots reach further than they stand, and the panel covers the right
        atexit.unregister(self._server.stop)  # it would say goodbye; ours does not
        atexit.register(self.close)
        _decorate(self._server, camera or frame(scene, margin=1.75, aside=0.10))
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
        with _quiet():
            self._server.stop()
        self._server._thread_executor.shutdown(wait=False)
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
        position, wxyz = _position_wxyz(pose)
        handle = self._server.scene.add_transform_controls(
            f"/{name}",
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
                if not self._stop.is_set():
                    traceback.print_exc()
            due = max(due + 1.0 / RATE, time.monotonic())
            self._stop.wait(due - time.monotonic())

    async def _greet(self, client: Any) -> None:
        # a newcomer replays the scene, and its hook may come after the poses; those are sent again for a while
        self._again = time.monotonic() + 3.0

    def _publish(self) -> None:
        structure, motion, nodes, poses = self.scene.snapshot()
        if structure != self._sent[0]:
            self._build(nodes, poses)
        again = time.monotonic() < self._again
        if (structure, motion) != self._sent or again:
            if (structure, motion) != self._sent:
                self._sent, self._settled, self._moved_at = (structure, motion), False, time.monotonic()
            if self._hooked:
                self._send(nodes, poses)
            else:
                self._set_each(nodes, poses)
        elif not self._settled and time.monotonic() - self._moved_at > 0.3:
            # at rest: leave the poses in viser's own state, too, which newcomers and recordings start from
            self._settled = True
            self._set_each(nodes, poses)
            self._send(nodes, poses)

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
            position, wxyz = _position_wxyz(pose)
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
        """A path with no other pose above it: groups are for display, poses are of the world."""
        group, _, rest = name.partition("/")
        if rest:
            return f"/{group}/{rest.replace('/', ' ')}"
        return f"/{group} ·" if any(p.startswith(f"/{group}/") for p in self._paths.values()) else f"/{group}"

    def _send(self, nodes: tuple[Node, ...], poses: Floats) -> None:
        rows = [i for i, node in enumerate(nodes) if node.name in self._paths]
        names = [self._paths[nodes[i].name] for i in rows]
        update = self._messages.SceneNodeUpdateMessage(_POSES, {"names": names, "p": _pose_rows(poses[rows])})
        self._server._websock_server.queue_message(update)

    def _set_each(self, nodes: tuple[Node, ...], poses: Floats) -> None:
        for node, row in zip(nodes, _pose_rows(poses), strict=True):
            handle = self._handles.get(node.name)
            if handle is not None:
                handle.position, handle.wxyz = row[:3], row[3:]


class Control:
    """A control of the panel; `value` is read and written from any thread."""

    def __init__(self, handle: Any, attribute: str) -> None:
        self._handle, self._attribute = handle, attribute

    @property
    def value(self) -> Any:
        """What it shows."""
        return getattr(self._handle, self._attribute)

    @value.setter
    def value(self, value: Any) -> None:
        if value != self.value:
            setattr(self._handle, self._attribute, value)


class Gizmo:
    """A pose in the page that can be dragged; `held` while someone drags it."""

    def __init__(self, handle: Any) -> None:
        self._handle = handle
        self.held = False

    @property
    def pose(self) -> Floats:
        """T_world_gizmo, shape (4, 4)."""
        out = np.eye(4)
        out[:3, 3] = self._handle.position
        out[:3, :3] = quat_xyzw_to_matrix(np.roll(np.asarray(self._handle.wxyz, dtype=float), -1))
        return out

    @pose.setter
    def pose(self, pose: ArrayLike) -> None:
        position, wxyz = _position_wxyz(np.asarray(pose, dtype=float))
        self._handle.position, self._handle.wxyz = position, wxyz


def _serve(host: str, port: int, title: str) -> Any:
    """A viser server that answers this machine only, shares nothing and prints nothing."""
    try:
        import viser
        import websockets.asyncio.server as sockets
    except ImportError as error:
        raise MissingExtra("viser", "viewer", "The page in the browser") from error
    if not 0 <= port <= 65535:
        raise InputError(f"`port` is {port}; expected 0 (any free one) to 65535.")
    any_host = host not in guard.LOOPBACK
    original: Any = sockets.serve
    guarded: list[bool] = []

    def serve(*args: Any, **options: Any) -> Any:
        answer: Any = options.get("process_request")
        if getattr(answer, "__module__", "").startswith("viser"):  # leave servers of other threads alone

            def process_request(connection: Any, request: Any) -> Any:
                headers = request.headers
                if not guard.allowed(headers.get("Host"), headers.get("Origin"), any_host):
                    return connection.respond(403, "This page answers its own machine only.\n")
                return answer(connection, request)

            options["process_request"] = process_request
            guarded.append(True)
        return original(*args, **options)

    with _construction, _quiet():
        sockets.serve = serve
        try:
            server = viser.ViserServer(host=host, port=port, label=title, verbose=False)
        finally:
            sockets.serve = original
    if not guarded:
        server.stop()
        raise ViewerError(
            f"viser {viser.__version__} opens its socket in a way that cannot be guarded against other web "
            "pages. Install a version that can: pip install 'ulna[viewer]'"
        )
    from viser import _messages

    # else anyone in the page could open a tunnel to the world
    for kind in ("ShareUrlRequest", "ShareUrlDisconnect"):
        server._websock_server.unregister_handler(getattr(_messages, kind))
    return server


def _channel(server: Any) -> tuple[Any, bool]:
    """The messages of viser, and whether all poses can travel in one of them."""
    import viser
    from viser import _messages

    if not viser.__version__.startswith(_KNOWN):
        return _messages, False
    server._websock_server.queue_message(_messages.RunJavascriptMessage(source=_HOOK))
    return _messages, True


def _decorate(server: Any, camera: Camera) -> None:
    """The look: a calm studio, soft shadows, a quiet floor, and a camera that has the scene in view."""
    scene, gui = server.scene, server.gui
    gui.configure_theme(
        show_logo=False, show_share_button=False, brand_color=(37, 99, 235), control_width="medium"
    )
    scene.configure_default_lights(False)
    scene.configure_environment_map("studio", environment_intensity=0.30)
    scene.add_light_hemisphere(
        "/light/sky", sky_color=(235, 242, 255), ground_color=(150, 155, 160), intensity=0.28
    )
    lamps = (("key", (255, 244, 230), 2.6, (1.6, -1.0, 3.2)), ("rim", (230, 240, 255), 0.8, (-2.0, 2.4, 1.6)))
    for name, tint, strength, place in (*lamps, ("fill", (220, 232, 255), 0.25, (-1.0, -3.0, 1.2))):
        scene.add_light_directional(
            f"/light/{name}", color=tint, intensity=strength, cast_shadow=name == "key", position=place
        )
    scene.add_grid(
        "/floor",
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
        position=(0.0, 0.0, -0.001),
    )
    top, horizon = np.array([142, 163, 187]), np.array([217, 225, 233])
    share = np.clip(np.linspace(0, 1, 512) / 0.33, 0, 1) ** 0.8
    gradient = top + (horizon - top) * share[:, None]
    scene.set_background_image(np.repeat(gradient[:, None, :], 8, axis=1).astype(np.uint8), format="png")
    server.initial_camera.position, server.initial_camera.look_at = camera.position, camera.target
    server.initial_camera.fov = camera.fov


def _pose_rows(poses: Floats) -> Array:
    """Poses (n, 4, 4) as rows x y z, w x y z, shape (n, 7), float32."""
    quat = matrix_to_quat_xyzw(poses[:, :3, :3])
    return np.concatenate([poses[:, :3, 3], quat[:, 3:], quat[:, :3]], axis=1).astype(np.float32)


def _position_wxyz(pose: Floats) -> tuple[Any, Any]:
    row = _pose_rows(pose[None])[0].astype(float)
    return tuple(row[:3].tolist()), tuple(row[3:].tolist())


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """Without viser's banner and its goodbye."""
    import rich

    original = rich.print
    rich.print = lambda *_, **__: None
    try:
        yield
    finally:
        rich.print = original
