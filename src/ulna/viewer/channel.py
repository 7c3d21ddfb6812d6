"""What the page needs of viser beyond its promises, in one place: a guarded socket, and all poses in one message.

Everything here was read in viser 1.1. Where a version is not known, poses go through the public interface
instead; where the socket cannot be guarded, there is no page.
"""

from __future__ import annotations

import atexit
import contextlib
import json
import logging
import re
import socket
import threading
from collections.abc import Iterator, Sequence
from numbers import Integral
from pathlib import Path
from typing import Any

from ulna.errors import InputError, MissingExtra, ViewerError
from ulna.extras import install_command
from ulna.typing import Array
from ulna.viewer import client, guard

KNOWN = ("1.1.",)
"""Versions of viser whose page has the queue that the hook relies on."""

LAMP, SKY = "/(page)/key", "/(page)/sky"
"""The names of the lamp that throws shadows, and of the light from all around."""

POSES, LOOKS, FLOOR = "/(page)/poses", "/(page)/looks", "/(page)/floor"
"""The names under which all poses, and all looks that are not plain, are sent, which no node has; and the floor's."""

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
    if not (isinstance(port, Integral) and 0 <= port <= 65535):
        raise InputError(f"`port` is {port!r}; expected 0 (any free one) to 65535.")
    _check_address(host)
    any_host = host not in guard.LOOPBACK
    page = Path(viser.__file__).parent / "client" / "build" / "index.html"
    kept = client.Client(page, _early(title)) if known() else None
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
                response = client.answer(kept, request) or answer(connection, request)
                if response is not None:
                    response.headers["Content-Security-Policy"] = guard.frames(headers["Host"])
                    if token:
                        response.headers["Set-Cookie"] = guard.cookie(token)
                return response

            if len(args) > 2 and args[2] > 65535:  # all ports from the one asked for to the last are in use
                args = (*args[:2], 0, *args[3:])
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
            f"pages. Install a version that can: {install_command('viewer', 'viser')}"
        )
    from viser import _messages

    # else anyone in the page could open a tunnel to the world
    for kind in ("ShareUrlRequest", "ShareUrlDisconnect"):
        server._websock_server.unregister_handler(getattr(_messages, kind))
    return server


def _check_address(host: str) -> None:
    """Refuse an address that this machine does not have: viser would try one port after the other, and never return.

    Raises:
        ViewerError: Nothing can listen there.
    """
    try:
        for family, kind, protocol, _, address in socket.getaddrinfo(
            host, 0, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
        ):
            with socket.socket(family, kind, protocol) as probe:
                probe.bind(address)
    except (OSError, UnicodeError) as error:
        raise ViewerError(
            f"The page cannot listen on {host!r}: {getattr(error, 'strerror', None) or error}. Take '127.0.0.1' for "
            "this machine alone, '0.0.0.0' for all its networks, or an address of its own."
        ) from error


def known() -> bool:
    """Whether the version of viser is one whose page was read: with that queue, and normals that it computes itself."""
    import viser

    return viser.__version__.startswith(KNOWN)


def _hook(title: str) -> str:
    """The program that makes viser's page ours."""
    here = Path(__file__).parent
    out = "".join((here / name).read_text(encoding="utf-8") for name in ("lamp.js", "frames.js", "hook.js"))
    filled = {"POSES": POSES, "LOOKS": LOOKS, "FLOOR": FLOOR, "LAMP": LAMP, "SKY": SKY, "TITLE": title}
    return re.sub(r"\b(" + "|".join(filled) + r")\b", lambda found: _quoted(filled[found[0]]), out)


def _quoted(text: str) -> str:
    """A text as JavaScript has it, also within HTML."""
    return json.dumps(text).replace("<", "\\u003c")


def _early(title: str) -> str:
    """A program that sees viser's page before any message does."""
    text = (Path(__file__).parent / "early.js").read_text(encoding="utf-8")
    return text.replace("HOOK", _hook(title))


def stop(server: Any) -> None:
    """Stop a server without a word."""
    with _quiet():
        server.stop()
    if known():  # what a program still tells the page goes nowhere, without a word of viser
        server._websock_server.get_message_buffer().push = lambda message: None
        for control in server.gui._gui_input_handle_from_uuid.values():
            control._impl.update_cb.clear()
    server._thread_executor.shutdown(wait=False)


class PoseChannel:
    """All poses in one message, where the version of viser is known to take it (`open`)."""

    def __init__(self, server: Any, title: str) -> None:
        self.open = known()
        self._server = server
        if self.open:
            from viser import _messages

            self._message = _messages.SceneNodeUpdateMessage
            self._script = _messages.RunJavascriptMessage
            self._run(_hook(title))

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
