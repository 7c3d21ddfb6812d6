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

POSES, LOOKS = "/(page)/poses", "/(page)/looks"
"""The names under which all poses, and all looks that are not plain, are sent; no node has them."""

# The page puts messages into a queue and empties it before each frame. The hook takes messages with poses out
# and writes them where the page keeps the newest pose of each node, so that they never pile up. Looks are put on the
# materials of meshes, ten times a second on those that were loaded since; what has lost its look becomes plain.
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
  const dress = (name, look) => {
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
    wanted.forEach((look, name) => dress(name, look) && worn.add(name));
    worn.forEach(name => wanted.has(name) || (dress(name, plain), worn.delete(name)));
  };
  const looks = ({names, v}) => {
    wanted = new Map(names.map((name, i) => [name, Array.from(v.slice(7 * i, 7 * i + 7))]));
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
            hook = _HOOK.replace("POSES", json.dumps(POSES)).replace("LOOKS", json.dumps(LOOKS))
            hook = hook.replace("TITLE", json.dumps(title))
            server._websock_server.queue_message(_messages.RunJavascriptMessage(source=hook))

    def send(self, paths: Sequence[str], rows: Array) -> None:
        """Send poses as rows x y z, w x y z, float32, one for each path; they replace those not sent yet."""
        self._queue(POSES, {"names": list(paths), "p": rows})

    def dress(self, paths: Sequence[str], rows: Array) -> None:
        """Send looks as rows: linear red, green, blue or -1, opacity, three scales; float32. All others are plain."""
        self._queue(LOOKS, {"names": list(paths), "v": rows.reshape(-1)})

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
