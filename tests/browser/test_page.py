"""The page in a real browser: nothing leaves the machine, sliders and dragging move the robot, pixels follow."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, HTTPServer
from typing import Any
from urllib.parse import urlsplit

import numpy as np
import pytest

import ulna
from support.patience import patient
from ulna.spatial import quat_xyzw_to_matrix

pytestmark = pytest.mark.browser
SIZE = {"width": 800, "height": 500}  # drawn by the processor here, so small
PIXEL = """([x, y, z]) => { const page = window.__viserMutable, root = page.nodeRefFromName[""];
    root.updateWorldMatrix(true, false); page.camera.updateMatrixWorld();
    const v = root.localToWorld(root.position.clone().set(x, y, z)).project(page.camera);
    const box = page.canvas.getBoundingClientRect();
    return [box.x + (v.x + 1) / 2 * box.width, box.y + (1 - v.y) / 2 * box.height]; }"""


wait = patient()


class Visit:
    """A page of a robot and a tab that looks at it."""

    def __init__(self, chromium: Any, show: Any) -> None:
        self.show, self.requests, self.errors = show, [], []
        self.context = chromium.new_context(viewport=SIZE, every_frame=True)  # handles are dragged
        self.tab = self.context.new_page()
        self.tab.on("request", lambda r: self.requests.append(r.url))
        self.tab.on("websocket", lambda s: self.requests.append(s.url))
        self.tab.on("pageerror", lambda e: self.errors.append(str(e)))
        self.tab.goto(f"{show.url}/?fixedDpr=1")
        there = "name => window.__viserMutable?.nodeRefFromName[name] !== undefined"
        assert wait(lambda: self.tab.evaluate(there, f"/{show.robot.name}/panda_hand"))

    def pose(self, link: str) -> np.ndarray:
        """Where the browser has a link: position and quaternion w x y z of what is drawn; nan while it is not."""
        return self.pose_of(f"/{self.show.robot.name}/{link}")

    def pose_of(self, node: str) -> np.ndarray:
        """Where the browser has a node of the scene; see `pose`."""
        values = self.tab.evaluate(
            """name => { const o = window.__viserMutable.nodeRefFromName[name];
                return o && [...o.position.toArray(), o.quaternion.w, ...o.quaternion.toArray().slice(0, 3)]; }""",
            node,
        )
        return np.array(values or [np.nan] * 7)

    def agrees(self) -> bool:
        """Whether the browser has every visible link where the robot's kinematics put it."""
        robot, q = self.show.robot, self.show.q
        for link, T in zip(robot.model.links, robot.link_poses(q), strict=True):
            if not link.visuals:
                continue
            x, y, z, w, *v = self.pose(link.name)
            rotation = quat_xyzw_to_matrix(np.array([*v, w]))
            if not (np.abs(rotation - T[:3, :3]).max() < 1e-5 and np.abs(T[:3, 3] - (x, y, z)).max() < 1e-5):
                return False
        return True

    def picture(self) -> bytes:
        return self.tab.screenshot()

    def pixel(self, point: np.ndarray) -> list[float]:
        """Where the tab draws a point of the world now: x and y from the corner at the upper left [pixels]."""
        return self.tab.evaluate(PIXEL, point.tolist())

    def target_is_at_the_tool(self) -> bool:
        """Whether the browser has the target of inverse kinematics at the tool."""
        position = self.pose_of(f"/(page)/target of {self.show.robot.name}")[:3]
        return bool(np.abs(position - self.show.tool[:3, 3]).max() < 1e-4)


@pytest.fixture(scope="module")
def visit(chromium: Any) -> Iterator[Visit]:
    from ulna.viewer.show import show

    with show(ulna.load("panda", visuals="simple"), port=0, browser=False) as shown:
        visit = Visit(chromium, shown)
        yield visit
        visit.context.close()


def test_the_robot_stands_where_its_kinematics_put_it(visit: Visit) -> None:
    assert wait(visit.agrees)
    assert visit.errors == []


def test_the_tab_says_what_it_shows(visit: Visit) -> None:
    assert wait(lambda: visit.tab.title() == "panda · Ulna")


def test_no_request_leaves_the_machine(visit: Visit) -> None:
    hosts = {
        urlsplit(u).hostname for u in visit.requests if urlsplit(u).scheme in ("http", "https", "ws", "wss")
    }
    assert hosts == {"localhost"}
    assert len(visit.requests) >= 2  # the page and its socket


def test_setting_q_moves_the_robot_and_the_pixels(visit: Visit) -> None:
    before = visit.picture()
    q = visit.show.q.copy()
    q[0], q[3] = 0.9, -1.5
    visit.show.q = q
    assert wait(visit.agrees)
    assert wait(lambda: visit.picture() != before)


def test_a_slider_moves_the_robot(visit: Visit) -> None:
    visit.show.q = "qr"
    slider = visit.tab.get_by_role("slider").nth(1)
    assert wait(lambda: abs(float(slider.get_attribute("aria-valuenow")) + 0.3) < 1e-6)
    slider.focus()
    for _ in range(5):
        slider.press("ArrowRight")
    assert wait(lambda: abs(visit.show.q[1] + 0.295) < 1e-6), visit.show.q
    assert wait(visit.agrees)


def test_sliders_follow_the_program(visit: Visit) -> None:
    q = visit.show.q.copy()
    q[6] = -0.75
    visit.show.q = q
    slider = visit.tab.get_by_role("slider").nth(6)
    assert wait(lambda: abs(float(slider.get_attribute("aria-valuenow")) + 0.75) < 1e-6)


def test_a_button_goes_to_a_named_configuration(visit: Visit) -> None:
    visit.tab.get_by_text("qz", exact=True).click()
    assert wait(lambda: bool(np.abs(visit.show.q[:3]).max() < 1e-9))
    assert wait(visit.agrees)


def test_moving_the_target_moves_the_tool(visit: Visit) -> None:
    visit.show.q = "qr"
    goal = visit.show.tool @ ulna.SE3.trans(0.05, 0.1, -0.1).matrix()
    visit.show.aim(goal)
    assert wait(lambda: bool(np.abs(visit.show.tool - goal).max() < 1e-6))
    assert wait(visit.agrees)


def test_dragging_the_target_moves_the_tool(visit: Visit) -> None:
    visit.show.q = "qr"
    start = visit.show.tool
    arrow = start[:3, 2]  # the blue arrow
    size = visit.show.teach_panel.gizmo._handle.scale
    moved = lambda: visit.show.tool[:3, 3] - start[:3, 3]  # noqa: E731

    def drag(pause: float) -> None:
        origin = visit.show.tool[:3, 3]
        x, y = visit.pixel(origin + 0.75 * size * arrow)
        end_x, end_y = visit.pixel(origin + (0.75 * size + 0.08) * arrow)
        visit.tab.mouse.move(x, y)
        time.sleep(pause)
        visit.tab.mouse.down()
        for share in np.linspace(0, 1, 8):
            visit.tab.mouse.move(x + share * (end_x - x), y + share * (end_y - y))
            time.sleep(0.1 * pause)
        time.sleep(pause)
        visit.tab.mouse.up()

    for pause in (
        0.5,
        0.5,
        1.0,
        2.0,
        4.0,
        8.0,
    ):  # a busy machine may draw the target too late for the pointer
        assert wait(visit.target_is_at_the_tool)
        drag(pause)
        if wait(lambda: bool(moved() @ arrow > 0.03), 10.0):
            break
    assert moved() @ arrow > 0.03, moved()
    assert np.linalg.norm(moved() - (moved() @ arrow) * arrow) < 0.01  # along the arrow only
    assert wait(visit.agrees)


def test_a_newcomer_sees_what_is_there_now(visit: Visit, chromium: Any) -> None:
    q = visit.show.q.copy()
    q[0] = -1.2
    visit.show.q = q
    assert wait(visit.agrees)
    newcomer = Visit(chromium, visit.show)
    try:
        assert wait(newcomer.agrees)
        q[0] = 0.4
        visit.show.q = q  # and what happens next, in both tabs
        assert wait(newcomer.agrees)
        assert wait(visit.agrees)
    finally:
        newcomer.context.close()


def test_a_lost_connection_is_taken_up_again(visit: Visit) -> None:
    visit.show.page.server._websock_server.disconnect_all_clients()
    q = visit.show.q.copy()
    q[0] = 0.77
    visit.show.q = q
    assert wait(visit.agrees)


def test_a_tab_that_slept_has_the_newest_when_it_wakes(visit: Visit) -> None:
    devtools = visit.context.new_cdp_session(visit.tab)
    devtools.send("Page.setWebLifecycleState", {"state": "frozen"})  # as behind a closed lid
    q = visit.show.q.copy()
    for angle in np.linspace(0.0, 1.1, 120):
        q[0] = angle
        visit.show.q = q
        time.sleep(1 / 60)
    devtools.send("Page.setWebLifecycleState", {"state": "active"})
    assert wait(visit.agrees)
    assert visit.errors == []


class Evil(BaseHTTPRequestHandler):
    """A page of another origin that tries to talk to the robot's page."""

    def do_GET(self) -> None:
        self.send_response(200)
        self.send_header("Content-Type", "text/html")
        self.end_headers()
        self.wfile.write(b"<html><body>hello</body></html>")

    def log_message(self, *_: Any) -> None:
        """Say nothing."""


def test_a_page_of_another_origin_is_refused(visit: Visit) -> None:
    server = HTTPServer(("127.0.0.1", 0), Evil)
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    tab = visit.context.new_page()
    attempt = """url => new Promise(done => {
        const socket = new WebSocket(url, ["viser-v1.1.1"]);
        socket.onopen = () => done("open");
        socket.onerror = () => done("refused");
    })"""
    try:
        tab.goto(f"http://127.0.0.1:{server.server_port}/")
        for host in ("localhost", "127.0.0.1"):
            assert tab.evaluate(attempt, f"ws://{host}:{visit.show.page.port}/") == "refused"
        own = visit.show.url.replace("http", "ws")
        assert visit.tab.evaluate(attempt, own) == "open"  # the attempt itself is a good one
    finally:
        tab.close()
        server.shutdown()
        thread.join()
        server.server_close()


def test_hold_ends_when_the_last_tab_closes(chromium: Any, capsys: pytest.CaptureFixture[str]) -> None:
    from ulna.viewer.show import show

    shown = show(ulna.load("panda", visuals="simple"), port=0, browser=False)
    visit = Visit(chromium, shown)
    assert wait(lambda: shown.page.clients == 1)
    holder = threading.Thread(target=shown.hold)
    holder.start()
    time.sleep(0.3)
    assert holder.is_alive()
    visit.context.close()
    holder.join(timeout=600)
    assert not holder.is_alive()
    assert shown.page.closed
    assert "The page was closed" in capsys.readouterr().out
