"""Progress in the tabs of a page, and the sockets of a page in a forked child."""

from __future__ import annotations

import os
import socket
from types import SimpleNamespace
from typing import Any

import pytest

from ulna.viewer.page.inherited_sockets import close_inherited
from ulna.viewer.page.notifications import ProgressNotifications


class Tab:
    """A tab that keeps the notifications it shows."""

    def __init__(self) -> None:
        self.shown: list[Any] = []

    def add_notification(self, title: str, body: str, **options: Any) -> Any:
        notice = SimpleNamespace(title=title, body=body, options=options)
        notice.remove = lambda: self.shown.remove(notice)
        self.shown.append(notice)
        return notice

    def bodies(self) -> dict[str, str]:
        return {notice.title: notice.body for notice in self.shown}


def test_progress_is_shown_in_every_tab_until_it_is_done() -> None:
    first, late = Tab(), Tab()
    tabs = {1: first}
    progress = ProgressNotifications(SimpleNamespace(get_clients=lambda: tabs))
    progress("compiling", "10 %")
    assert first.bodies() == {"compiling": "10 %"}
    assert first.shown[0].options == {"loading": True, "with_close_button": False}
    tabs[2] = late
    progress("compiling", "20 %")
    progress("loading", "1 of 3")
    assert first.bodies() == late.bodies() == {"compiling": "20 %", "loading": "1 of 3"}
    progress("compiling", "")
    assert first.bodies() == late.bodies() == {"loading": "1 of 3"}
    del tabs[1]  # closed meanwhile
    progress("loading", "")
    assert (first.bodies(), late.bodies()) == ({"loading": "1 of 3"}, {})
    progress("loading", "")  # nothing is shown for what is done at once
    progress("compiling", "5 %")
    assert late.bodies() == {"compiling": "5 %"}


def _descriptors() -> set[str]:
    """What this process has open, without the descriptor that lists them; empty where the system does not say."""
    folder = "/proc/self/fd"
    listed = os.listdir(folder) if os.path.isdir(folder) else []
    return {number for number in listed if os.path.lexists(f"{folder}/{number}")}


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork here")
def test_a_child_closes_listeners_and_connections_and_leaves_those_of_the_parent() -> None:
    listener, (ours, theirs) = socket.create_server(("127.0.0.1", 0)), socket.socketpair()
    closed = socket.socket()
    closed.close()
    connection = SimpleNamespace(transport=SimpleNamespace(get_extra_info={"socket": ours}.get))
    gone = SimpleNamespace(transport=SimpleNamespace(get_extra_info=lambda _: closed))
    lost = SimpleNamespace(transport=SimpleNamespace(get_extra_info=lambda _: None))
    handlers = [SimpleNamespace(transport=None), gone, lost, connection, SimpleNamespace()]
    servers = [
        SimpleNamespace(server=object(), sockets=[listener], handlers=handlers),
        SimpleNamespace(server=None, sockets=[theirs]),  # not started: nothing of it is open
    ]
    before = _descriptors()
    child = os.fork()
    if child == 0:
        close_inherited(servers)
        null = os.stat(os.devnull).st_rdev
        are_null = [os.fstat(s.fileno()).st_rdev == null for s in (listener, ours, theirs)]
        leaked = _descriptors() - before
        inherited = any(os.get_inheritable(s.fileno()) for s in (listener, ours))
        os._exit(0 if are_null == [True, True, False] and not leaked and not inherited else 1)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    ours.sendall(b"still here")
    assert theirs.recv(100) == b"still here"
    for one in (listener, ours, theirs):
        one.close()
