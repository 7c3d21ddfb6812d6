"""The page without a browser: it answers its own machine only, goes without a trace, and follows the scene."""

import contextlib
import http.client
import socket
import threading
import time
from collections.abc import Iterator
from types import SimpleNamespace

import numpy as np
import pytest

pytest.importorskip("viser", reason="viser, which serves the page, is not installed")

from support.patience import patient
from ulna.errors import InputError, MissingExtra, UlnaWarning, ViewerError
from ulna.geometry import Box
from ulna.viewer.mesh.primitives import tessellate
from ulna.viewer.page import Page, pose_channel
from ulna.viewer.page import access as guard
from ulna.viewer.page import keep_open as hold_module
from ulna.viewer.scene import Scene


def at(x: float) -> np.ndarray:
    pose = np.eye(4)
    pose[0, 3] = x
    return pose


def box_scene() -> Scene:
    scene = Scene()
    scene.add("robot/box", [tessellate(Box((0.1, 0.1, 0.1)))], at(1.0))
    return scene


@pytest.fixture
def page() -> Iterator[Page]:
    with Page(box_scene(), port=0) as page:
        yield page


def status(page: Page, path: str = "/", **headers: str) -> int:
    connection = http.client.HTTPConnection("127.0.0.1", page.port, timeout=300)
    try:
        connection.request("GET", path, headers={"Host": f"localhost:{page.port}", **headers})
        return connection.getresponse().status
    finally:
        connection.close()


UPGRADE = {
    "Connection": "Upgrade",
    "Upgrade": "websocket",
    "Sec-WebSocket-Version": "13",
    "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==",
    "Sec-WebSocket-Protocol": "viser-v0",
}


wait = patient(pause=0.01)


def test_an_address_of_another_machine_is_refused_at_once() -> None:
    for host in ("192.0.2.1", "no such name"):
        with pytest.raises(ViewerError, match=host):
            Page(Scene(), port=0, host=host)
    for port in (70_000, -1, 80.5, "8080"):
        with pytest.raises(InputError, match="port"):
            Page(Scene(), port=port)  # type: ignore[arg-type]


def test_after_the_last_port_any_is_taken() -> None:
    with socket.socket() as taken:
        with contextlib.suppress(OSError):  # in use, it does as well
            taken.bind(("127.0.0.1", 65535))
        taken.listen()
        with Page(Scene(), port=65535) as page:
            assert 0 < page.port < 65535


def test_only_pages_of_this_machine_may_frame_it(page: Page) -> None:
    for encoding in ("gzip", "identity"):  # viser's page and ours
        connection = http.client.HTTPConnection("127.0.0.1", page.port, timeout=300)
        connection.request("GET", "/", headers={"Host": "localhost:1", "Accept-Encoding": encoding})
        assert connection.getresponse().headers["Content-Security-Policy"] == guard.frame_ancestors(
            "localhost:1"
        )
        connection.close()


def test_the_page_is_served_to_its_own_machine(page: Page) -> None:
    assert page.url == f"http://localhost:{page.port}"
    assert status(page) == 200
    assert status(page, Host="evil.example") == 403
    assert status(page, Origin="http://evil.example") == 403


def test_a_foreign_page_cannot_open_the_socket(page: Page) -> None:
    assert status(page, Origin="http://evil.example", **UPGRADE) == 403
    assert status(page, Origin="http://localhost:1", **UPGRADE) == 403
    assert status(page, Origin="null", **UPGRADE) == 403
    assert status(page, Origin=page.url, **UPGRADE) == 101


def test_it_listens_on_the_loopback_only(page: Page) -> None:
    sockets = page.server._websock_server
    assert sockets._host == "127.0.0.1"
    with pytest.raises(OSError):
        socket.create_connection(("127.0.0.2", page.port), timeout=0.5).close()


def test_the_page_offers_no_share_url(page: Page) -> None:
    from viser import _messages

    handlers = page.server._websock_server._incoming_handlers
    assert _messages.ShareUrlRequest not in handlers
    assert _messages.ShareUrlDisconnect not in handlers


def test_nothing_is_printed(capfd: pytest.CaptureFixture[str]) -> None:
    Page(box_scene(), port=0).close()
    assert capfd.readouterr() == ("", "")


def test_a_connection_that_says_nothing_is_no_news(page: Page, capfd: pytest.CaptureFixture[str]) -> None:
    socket.create_connection(("127.0.0.1", page.port)).close()
    assert status(page) == 200
    time.sleep(0.2)
    assert capfd.readouterr() == ("", "")


def test_it_leaves_no_thread_and_no_socket_behind() -> None:
    before = set(threading.enumerate())
    page = Page(box_scene(), port=0)
    port = page.port
    page.close()
    page.close()
    assert page.closed
    assert page.clients == 0
    assert wait(lambda: set(threading.enumerate()) <= before), threading.enumerate()
    with socket.socket() as again:
        again.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        again.bind(("127.0.0.1", port))


def test_a_port_in_use_gives_the_next() -> None:
    with Page(Scene(), port=0) as first, Page(Scene(), port=first.port) as second:
        assert second.port != first.port


def test_an_invalid_port_is_refused() -> None:
    with pytest.raises(InputError, match="65535"):
        Page(Scene(), port=70000)


def test_without_viser_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    import sys

    monkeypatch.setitem(sys.modules, "viser", None)
    with pytest.raises(MissingExtra, match=r"pip install .*'viser<"):
        Page(Scene(), port=0)


def buffered(page: Page, kind: str) -> list:
    buffer = page.server._websock_server._broadcast_buffer
    with buffer.buffer_lock:
        return [m for m in buffer.message_from_id.values() if type(m).__name__ == kind]


def sent(page: Page) -> dict[str, np.ndarray]:
    """The newest poses as they were sent, by path."""
    messages = [m for m in buffered(page, "SceneNodeUpdateMessage") if m.name == pose_channel.POSES]
    return dict(zip(messages[-1].updates["names"], messages[-1].updates["p"], strict=True))


def test_all_poses_travel_in_one_message_and_the_newest_win(page: Page) -> None:
    page.scene.add("robot/second", [tessellate(Box((0.1, 0.1, 0.1)))])
    for k in range(50):
        page.scene.set_poses([at(0), at(k), at(-k)])
    assert wait(lambda: sent(page).get("/robot/second", [0])[0] == -49)
    assert sent(page)["/robot/box"][0] == 49
    assert len([m for m in buffered(page, "SceneNodeUpdateMessage") if m.name == pose_channel.POSES]) == 1


def test_small_moves_are_sent_too(page: Page) -> None:
    page.scene.set_pose("robot/box", at(1.000001))
    assert wait(lambda: sent(page)["/robot/box"][0] == np.float32(1.000001))


def test_at_rest_newcomers_find_the_poses_in_the_public_state(page: Page) -> None:
    page.scene.set_pose("robot/box", at(3.0))
    assert wait(lambda: page._publisher.shown["robot/box"].handles[0].position[0] == 3.0)


def test_another_version_of_viser_is_driven_through_its_public_interface(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(pose_channel, "KNOWN_VERSIONS", ("0.0.",))
    with Page(box_scene(), port=0) as page:
        page.scene.set_pose("robot/box", at(4.0))
        assert wait(lambda: page._publisher.shown["robot/box"].handles[0].position[0] == 4.0)
        assert not buffered(page, "RunJavascriptMessage")
        for x in (5.0, 6.0, 7.0):  # also while it moves
            page.scene.set_pose("robot/box", at(x))
            page.flush()
            assert page._publisher.shown["robot/box"].handles[0].position[0] == x


def test_nodes_come_and_go_with_the_scene(page: Page) -> None:
    page.scene.add("mark", [tessellate(Box((1, 1, 1)))])
    page.flush()
    assert set(page._publisher.shown) == {"robot/box", "mark"}
    page.scene.remove("robot/box")
    page.flush()
    assert set(page._publisher.shown) == {"mark"}


@pytest.mark.parametrize(
    "names", [("robot",), ("mark", "mark/a"), ("mark/a", "mark"), ("m/a b", "m/a/b", "m/a › b")]
)
def test_no_node_carries_another_along(page: Page, names: tuple[str, ...]) -> None:
    for name in names:
        page.scene.add(name, [tessellate(Box((1, 1, 1)))], at(5.0))
        page.flush()
    paths = [shown.path for shown in page._publisher.shown.values()]
    assert len(paths) == len(names) + 1
    assert len(set(paths)) == len(paths)
    for a in paths:
        assert not any(b.startswith(a + "/") for b in paths)


def test_a_mistake_in_a_users_function_does_not_stop_the_page(
    page: Page, capfd: pytest.CaptureFixture[str]
) -> None:
    called = []

    def wrong() -> None:
        called.append(1)
        raise ValueError("oh")  # 60 times a second; said once

    page.add_tick(wrong)
    assert wait(lambda: len(called) > 2)
    assert capfd.readouterr().err.count("ValueError: oh") == 1


def test_functions_are_called_sixty_times_a_second_at_most(page: Page) -> None:
    called: list[float] = []
    page.add_tick(lambda: called.append(time.monotonic()))
    assert wait(lambda: len(called) > 20)
    assert called[20] - called[0] > 20 / 60 - 0.1  # a busy thread would take all of a core


def test_hold_returns_at_once_without_a_screen(
    page: Page, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(hold_module, "somebody_can_look", lambda: False)
    hold_module.keep_open(page)
    assert "There is no screen" in capsys.readouterr().out


def test_hold_ends_with_ctrl_c(
    page: Page, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupt(_: float) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(hold_module, "somebody_can_look", lambda: True)
    monkeypatch.setattr(hold_module, "time", SimpleNamespace(sleep=interrupt))
    hold_module.keep_open(page)
    assert page.closed


def test_hold_ends_when_the_page_is_closed(page: Page, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(hold_module, "somebody_can_look", lambda: True)
    timer = threading.Timer(0.2, page.close)
    timer.start()
    hold_module.keep_open(page)
    timer.join()
    assert page.closed


def test_on_a_network_the_page_warns_and_asks_for_a_token() -> None:
    with pytest.warns(UlnaWarning, match="not encrypted"):
        page = Page(box_scene(), port=0, host="0.0.0.0")
    with page:
        token = page.url.partition("token=")[2]
        assert len(token) >= 32
        assert status(page) == 403
        assert status(page, Host="192.0.2.1") == 403
        assert status(page, f"/?token={token}") == 200
        assert status(page, f"/?token={token}", Host="192.0.2.1") == 200
        assert status(page, f"/?token={token}", Origin="http://evil.example") == 403
        assert status(page, Origin=f"http://localhost:{page.port}", **UPGRADE) == 403
        remembered = guard.token_cookie(token).partition(";")[0]
        own = f"http://localhost:{page.port}"
        assert status(page, Cookie=remembered, Origin=own, **UPGRADE) == 101


def test_no_file_of_the_machine_can_be_fetched(page: Page) -> None:
    for path in (
        "/etc/passwd",
        "//etc/passwd",
        "/../../../../etc/passwd",
        "/%2e%2e/%2e%2e/%2e%2e/etc/passwd",
    ):
        assert status(page, path) in (400, 403, 404)


def test_looks_travel_in_one_message_and_plain_ones_not_at_all(page: Page) -> None:
    def looks() -> dict:
        messages = [m for m in buffered(page, "SceneNodeUpdateMessage") if m.name == pose_channel.APPEARANCES]
        return dict(zip(messages[-1].updates["names"], messages[-1].updates["v"].reshape(-1, 7), strict=True))

    page.scene.set_look("robot", "opacity", 0.5)
    page.scene.set_look("robot/box", "scale", 2.0)
    assert wait(lambda: "/robot/box" in looks())
    np.testing.assert_allclose(looks()["/robot/box"], (-1, -1, -1, 0.5, 2, 2, 2))
    page.scene.set_look("robot", "opacity", 1.0)
    page.scene.set_look("robot/box", "scale", 1.0)
    assert wait(lambda: looks() == {})


def test_hold_ends_after_its_time(page: Page, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(hold_module, "somebody_can_look", lambda: True)
    began = time.monotonic()
    hold_module.keep_open(page, 0.3)
    assert time.monotonic() - began >= 0.3
    assert page.closed


def test_a_slow_page_does_not_hold_up_the_loop(page: Page) -> None:
    with page._tick_lock:  # as if the page were busy sending
        for k in range(1000):
            page.scene.set_pose("robot/box", at(k))
    assert wait(lambda: sent(page)["/robot/box"][0] == 999)


def test_a_scale_that_changes_makes_no_new_node(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pose_channel, "KNOWN_VERSIONS", ("0.0.",))  # a page that cannot change materials
    with Page(box_scene(), port=0) as page:
        handle = page._publisher.shown["robot/box"].handles[0]
        page.scene.set_look("robot/box", "scale", (1.0, 2.0, 3.0))
        assert wait(lambda: tuple(handle.scale) == (1.0, 2.0, 3.0))
        assert page._publisher.shown["robot/box"].handles[0] is handle
        page.scene.set_look("robot/box", "opacity", 0.5)
        assert wait(lambda: page._publisher.shown["robot/box"].handles[0] is not handle)
