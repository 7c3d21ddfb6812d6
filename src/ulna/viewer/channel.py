"""What the page needs of viser beyond its promises, in one place: a guarded socket, and all poses in one message.

Everything here was read in viser 1.1. Where a version is not known, poses go through the public interface
instead; where the socket cannot be guarded, there is no page.
"""

from __future__ import annotations

import atexit
import contextlib
import json
import logging
import threading
from collections.abc import Iterator, Sequence
from typing import Any

from ulna.errors import InputError, MissingExtra, ViewerError
from ulna.typing import Array
from ulna.viewer import guard

KNOWN = ("1.1.",)
"""Versions of viser whose page has the queue that the hook relies on."""

POSES, LOOKS, FLOOR = "/(page)/poses", "/(page)/looks", "/(page)/floor"
"""The names under which all poses, and all looks that are not plain, are sent, which no node has; and the floor's."""

# The page puts messages into a queue and empties it before each frame. The hook takes messages with poses out
# and writes them where the page keeps the newest pose of each node, so that they never pile up. Looks are put on the
# materials of meshes, ten times a second on those that were loaded since; what has lost its look becomes plain.
# The floor is drawn before whatever lets light through: farther away than its middle, that would be painted over.
# Words are drawn by the browser, in the fonts that it has, on a square that is turned to whoever looks.
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
  let wanted = new Map();
  const worn = new Set(), plain = [-1, -1, -1, 1, 1, 1, 1];
  const write = (mesh, words) => {
    if (mesh.userData.said === words) return false;
    const m = mesh.material, lines = words.split("\\n"), font = "96px system-ui, sans-serif";
    const canvas = document.createElement("canvas"), pen = canvas.getContext("2d");
    const fresh = mesh.userData.said === undefined, height = mesh.userData.words;
    pen.font = font;
    canvas.width = Math.max(1, ...lines.map(line => Math.ceil(pen.measureText(line).width)));
    canvas.height = 120 * lines.length;
    pen.fillRect(0, 0, canvas.width, canvas.height);
    pen.font = font;  // a canvas that gets a size forgets
    pen.fillStyle = "white";
    lines.forEach((line, k) => pen.fillText(line, 0, 120 * k + 96));
    const Texture = (m.map ?? m.alphaMap).constructor;
    if (!fresh) m.alphaMap.dispose();
    m.alphaMap = new Texture(canvas);
    m.alphaMap.flipY = false;
    m.alphaMap.needsUpdate = m.needsUpdate = true;
    m.map = null;
    m.toneMapped = m.depthWrite = false;
    mesh.userData.said = words;
    mesh.frustumCulled = false;
    mesh.onBeforeRender = (renderer, scene, camera) => {
      const p = mesh.parent.matrixWorld.elements, c = camera.matrixWorld.elements, e = mesh.matrixWorld.elements;
      const size = height * Math.hypot(p[8], p[9], p[10]), wide = size * canvas.width / 96;
      for (let i = 0; i < 3; i++) {
        e[i] = wide * c[i];
        e[4 + i] = 1.25 * size * lines.length * c[4 + i];
        e[8 + i] = c[8 + i];
        e[12 + i] = p[12 + i] - 0.25 * size * c[4 + i];
      }
    };
    return true;
  };
  const dress = (name, look, words) => {
    const node = page.nodeRefFromName[name];
    if (!node) return false;
    let news = false;
    const set = (thing, key, value) => { if (thing[key] !== value) { thing[key] = value; news = true; } };
    if (node.scale.x !== look[4] || node.scale.y !== look[5] || node.scale.z !== look[6]) {
      node.scale.set(look[4], look[5], look[6]);
      news = true;
    }
    node.traverse(mesh => {
      const m = mesh.material;
      if (!m || !m.color || m.isShaderMaterial) return;
      if (words !== undefined && mesh.userData.words) news = write(mesh, words) || news;
      const own = m.userData.ulna ??= {color: m.color.clone(), map: m.map, opacity: m.opacity,
        transparent: m.transparent, depthWrite: m.depthWrite, side: m.side, cast: mesh.castShadow};
      const tinted = look[0] >= 0, opacity = own.opacity * look[3], clear = opacity < 0.999;
      const color = tinted ? m.color.clone().setRGB(look[0], look[1], look[2]) : own.color;
      if (!m.color.equals(color)) { m.color.copy(color); news = true; }
      set(m, "map", tinted ? null : own.map);
      set(m, "opacity", opacity);
      set(m, "depthWrite", own.depthWrite && !clear);
      set(m, "side", clear ? 0 : own.side);
      set(m, "transparent", own.transparent || clear);
      set(mesh, "castShadow", own.cast && !clear);
      if (news) m.needsUpdate = true;
    });
    if (news) page.requestRender();
    return true;
  };
  const wear = () => {
    page.nodeRefFromName[FLOOR]?.traverse(part => { part.renderOrder = -1; });
    wanted.forEach(([look, words], name) => dress(name, look, words) && worn.add(name));
    worn.forEach(name => wanted.has(name) || (dress(name, plain), worn.delete(name)));
  };
  const looks = ({names, v, words}) => {
    wanted = new Map(names.map((name, i) => [name, [Array.from(v.slice(7 * i, 7 * i + 7)), words[name]]]));
    wear();
  };
  setInterval(wear, 100);
  Object.defineProperty(queue, "ulna", {value: true});
  Object.defineProperty(queue, "push", {value: (...messages) => {
    for (const m of messages) {
      if (m.type === "SceneNodeUpdateMessage" && m.name === POSES) apply(m.updates);
      else if (m.type === "SceneNodeUpdateMessage" && m.name === LOOKS) looks(m.updates);
      else push.call(queue, m);
    }
    return queue.length;
  }});
  document.title = TITLE;
})();"""
_construction = threading.Lock()
_log = logging.getLogger("ulna.page")
_log.setLevel(logging.CRITICAL)


def serve(host: str, port: int, title: str, token: str = "") -> Any:
    """A viser server that answers its own machine only, shares nothing and prints nothing.

    With a token it answers whoever knows it: the address carries it, and a cookie remembers it.

    Raises:
        MissingExtra: viser is not installed.
        InputError: The port is none.
        ViewerError: The socket cannot be guarded.
    """
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

    def guarded_serve(*args: Any, **options: Any) -> Any:
        answer: Any = options.get("process_request")
        if getattr(answer, "__module__", "").startswith("viser"):  # leave servers of other threads alone

            def process_request(connection: Any, request: Any) -> Any:
                headers = request.headers
                if not guard.allowed(headers.get("Host"), headers.get("Origin"), any_host):
                    return connection.respond(403, "This page answers its own machine only.\n")
                if not guard.knows(token, request.path, headers.get("Cookie")):
                    return connection.respond(403, "This page answers those who know its token only.\n")
                response = answer(connection, request)
                if token and response is not None:
                    response.headers["Set-Cookie"] = guard.cookie(token)
                return response

            options["process_request"] = process_request
            options["logger"] = _log  # browsers open sockets that they may never use; that is no error
            guarded.append(True)
        return original(*args, **options)

    with _construction, _quiet():
        sockets.serve = guarded_serve
        try:
            server = viser.ViserServer(host=host, port=port, label=title, verbose=False)
        finally:
            sockets.serve = original
    atexit.unregister(server.stop)  # it would say goodbye; `stop` here does not
    if not guarded:
        stop(server)
        raise ViewerError(
            f"viser {viser.__version__} opens its socket in a way that cannot be guarded against other web "
            "pages. Install a version that can: pip install 'ulna[viewer]'"
        )
    from viser import _messages

    # else anyone in the page could open a tunnel to the world
    for kind in ("ShareUrlRequest", "ShareUrlDisconnect"):
        server._websock_server.unregister_handler(getattr(_messages, kind))
    return server


def stop(server: Any) -> None:
    """Stop a server without a word."""
    with _quiet():
        server.stop()
    server._thread_executor.shutdown(wait=False)


class PoseChannel:
    """All poses in one message, where the version of viser is known to take it (`open`)."""

    def __init__(self, server: Any, title: str) -> None:
        import viser

        self.open = viser.__version__.startswith(KNOWN)
        self._server = server
        if self.open:
            from viser import _messages

            self._message = _messages.SceneNodeUpdateMessage
            self._script, hook = _messages.RunJavascriptMessage, _HOOK
            for word, text in (("POSES", POSES), ("LOOKS", LOOKS), ("FLOOR", FLOOR), ("TITLE", title)):
                hook = hook.replace(word, json.dumps(text))
            self._run(hook)

    def send(self, paths: Sequence[str], rows: Array) -> None:
        """Send poses as rows x y z, w x y z, float32, one for each path; they replace those not sent yet."""
        self._queue(POSES, {"names": list(paths), "p": rows})

    def dress(self, paths: Sequence[str], rows: Array, words: dict[str, str]) -> None:
        """Send looks as rows: linear red, green, blue or -1, opacity, three scales; float32. All others are plain.

        What those with words say stands in `words`.
        """
        self._queue(LOOKS, {"names": list(paths), "v": rows.reshape(-1), "words": words})

    def dress_file(self, paths: Sequence[str], rows: Array, words: dict[str, str]) -> None:
        """Send the same to a file, which hands its first messages over all at once, before any is heeded."""
        looks = {"names": list(paths), "v": rows.reshape(-1).tolist(), "words": words}
        message = {"type": "SceneNodeUpdateMessage", "name": LOOKS, "updates": looks}
        self._run(f"window.__viserMutable.messageQueue.push({json.dumps(message)})")

    def _run(self, script: str) -> None:
        self._server._websock_server.queue_message(self._script(source=script))

    def _queue(self, name: str, updates: dict[str, Any]) -> None:
        self._server._websock_server.queue_message(self._message(name, updates))


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


def start_recording(server: Any) -> Any:
    """A recording of the scene as it is and of every message from now on: `insert_sleep(seconds)`, `as_html(...)`."""
    return server.get_scene_serializer()
