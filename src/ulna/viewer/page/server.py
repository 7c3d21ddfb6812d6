"""What the page needs of viser beyond its public interface: a guarded socket, and all poses in one message.

Everything here was read in viser 1.1. Where a version is not known, poses go through the public interface
instead; where the socket cannot be guarded, there is no page.
"""

from __future__ import annotations

import atexit
import contextlib
import logging
import socket
import weakref
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

from ulna.errors import ViewerError, needed
from ulna.extras import install_command
from ulna.system import forks
from ulna.viewer.page import access as guard
from ulna.viewer.page import client_files as client
from ulna.viewer.page.inherited_sockets import close_inherited
from ulna.viewer.page.message_filter import filter_messages
from ulna.viewer.page.port import checked_port
from ulna.viewer.page.pose_channel import early_script, is_known_version
from ulna.viewer.page.visits import Visits

_construction_lock = forks.lock()
_visits: weakref.WeakKeyDictionary[Any, Visits] = weakref.WeakKeyDictionary()
_answered: weakref.WeakKeyDictionary[Any, set[int]] = weakref.WeakKeyDictionary()  # clients that have it all
_serving: weakref.WeakKeyDictionary[Any, list[Any]] = weakref.WeakKeyDictionary()  # what opened the sockets
_log = logging.getLogger("ulna.page")
_log.setLevel(logging.CRITICAL)


def _answer(
    answer: Callable[[Any, Any], Any],
    files: Any,
    token: str,
    any_host: bool,
    visits: Visits,
    connection: Any,
    request: Any,
) -> Any:
    """The answer to a request for the page, or for its socket: none for whoever is not allowed to see it."""
    headers = request.headers
    if not guard.is_allowed(headers.get("Host"), headers.get("Origin"), any_host):
        return connection.respond(403, "This page answers its own machine only.\n")
    if not guard.has_token(token, request.path, headers.get("Cookie")):
        return connection.respond(403, "This page answers requests with its token only.\n")
    visits.note_request(request)
    response = client.response_to(files, request) or answer(connection, request)
    if response is not None:
        response.headers["Content-Security-Policy"] = guard.frame_ancestors(headers["Host"])
        if token:
            response.headers["Set-Cookie"] = guard.token_cookie(token)
    return response


def serve(host: str, port: int | None, title: str, token: str = "") -> Any:
    """A viser server that answers its own machine only, shares nothing and prints nothing.

    With a token it answers clients that send it, in the address or in a cookie, under whatever name they know it.

    Args:
        host: Address to listen on.
        port: Port to listen on; 0 takes any free one, None that of `ULNA_PORT`, or 8080.
        title: Title of the tab.
        token: The token; "" for none.

    Returns:
        The `viser.ViserServer`.

    Raises:
        MissingExtra: viser is not installed.
        InputError: The port is none.
        ViewerError: The socket cannot be guarded.
    """
    with needed("viser", "viewer", "The page in the browser"):
        import viser
        import websockets.asyncio.server as sockets
    port = checked_port(port)
    _check_address(host)
    any_host = host not in guard.LOOPBACK or bool(token)
    page = Path(viser.__file__).parent / "client" / "build" / "index.html"
    page_files = client.ClientFiles(page, early_script(title)) if is_known_version() else None
    original: Any = sockets.serve
    guarded: list[Any] = []
    visits = Visits()

    def guarded_serve(*args: Any, **options: Any) -> Any:
        answer: Any = options.get("process_request")
        if getattr(answer, "__module__", "").startswith("viser"):  # leave servers of other threads alone
            if len(args) > 2 and args[2] > 65535:  # all ports from the one asked for to the last are in use
                args = (*args[:2], 0, *args[3:])
            options["process_request"] = partial(_answer, answer, page_files, token, any_host, visits)
            options["logger"] = _log  # browsers open sockets that they may never use; that is no error
            guarded.append(original(*args, **options))
            return guarded[-1]
        return original(*args, **options)

    with _construction_lock, _without_viser_output():
        sockets.serve = guarded_serve
        try:
            server = viser.ViserServer(host=host, port=port, label=title, verbose=False)
        finally:
            sockets.serve = original
    atexit.unregister(server.stop)  # it prints a message; `stop` here does not
    if not guarded:
        stop(server)
        raise _not_protected(viser.__version__)
    _answered[server] = set()
    _restrict_messages(server, visits, _answered[server])
    _serving[server], _visits[server] = guarded, visits
    return server


def _not_protected(version: str) -> ViewerError:
    """The error where viser opens no socket that requests can be checked on."""
    return ViewerError(
        f"viser {version} opens its socket in a form that cannot be protected against other web pages. Install a "
        f"version that can: {install_command('viewer', 'viser')}"
    )


def _restrict_messages(server: Any, visits: Visits, answered: set[int]) -> None:
    """Removes the sharing of the page, checks messages from it, and notes tabs that connect and that have it all."""
    from viser import _messages

    # else anyone in the page could open a tunnel to the internet
    for kind in ("ShareUrlRequest", "ShareUrlDisconnect"):
        server._websock_server.unregister_handler(getattr(_messages, kind))
    if is_known_version():
        filter_messages(server, answered)
        server._websock_server.on_client_connect(lambda _: visits.note_connected())


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
            "this machine alone, '0.0.0.0' for all its networks, or another address of this machine."
        ) from error


def stop(server: Any) -> None:
    """Stop a server without a word."""
    with _without_viser_output():
        server.stop()
    _silence(server)
    server._thread_executor.shutdown(wait=False)


def visits_of(server: Any) -> Visits:
    """What is known of tabs of a server before they are connected."""
    return _visits.setdefault(server, Visits())


def is_connected(server: Any) -> bool:
    """Whether any tab has opened its socket, also one that has not drawn anything so far."""
    return bool(server._websock_server._live_connections) if is_known_version() else False


def has_delivered(server: Any) -> bool:
    """Whether all tabs have answered the last message, and so have everything that was sent before it."""
    return _answered.get(server, set()).issuperset(list(server._websock_server._live_connections))


def disconnect(server: Any) -> None:
    """Let go of a server that runs in the parent of this forked child: nothing here reaches it or waits for it."""
    _silence(server)
    close_inherited(opened.server for opened in _serving.get(server, ()) if hasattr(opened, "server"))
    buffer = server._websock_server.get_message_buffer() if is_known_version() else None
    for part in (server, server._websock_server, server.gui, server.scene, buffer):
        for value in vars(part).values() if part is not None else ():
            forks.renew(value)


def _silence(server: Any) -> None:
    """Discard messages that a program still sends to the page, without output of viser."""
    if is_known_version():
        server._websock_server.get_message_buffer().push = lambda message: None
        for control in server.gui._gui_input_handle_from_uuid.values():
            control._impl.update_cb.clear()


@contextlib.contextmanager
def _without_viser_output() -> Iterator[None]:
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
