"""The live page in use: fingers, the time line, two hands, a page of one's own, and drawings that the browser drops."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ulna
from support.live_tab import ELEMENT, Tab
from support.patience import patient
from ulna.trajectory import quintic

pytestmark = pytest.mark.browser
DISTANCE = "session.stage.camera.position.distanceTo(document.querySelector('ulna-robot').session.stage.controls.target)"
wait = patient()


@pytest.fixture(scope="module")
def robot() -> ulna.Robot:
    return ulna.load("panda", visuals="simple")


@pytest.fixture(scope="module")
def motion(robot: ulna.Robot) -> Any:
    return quintic(robot.configurations["qr"], robot.configurations["ready"], 1.0)


@pytest.fixture(scope="module")
def file(robot: ulna.Robot, motion: Any, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return robot.save_html(tmp_path_factory.mktemp("live") / "motion.html", motion, show="skeleton")


@pytest.fixture(scope="module")
def phone(chromium: Any, file: Path) -> Iterator[Tab]:
    tab = Tab(chromium, file, (390, 720), has_touch=True, is_mobile=True)
    assert tab.started() == "ready"
    yield tab
    tab.context.close()


@pytest.fixture(scope="module")
def tab(chromium: Any, file: Path) -> Iterator[Tab]:
    tab = Tab(chromium, file)
    assert tab.started() == "ready"
    yield tab
    tab.context.close()


def test_a_finger_drags_the_tool(robot: ulna.Robot, phone: Tab) -> None:
    x, y = phone.place_of()
    phone.touch("touchStart", (x, y))
    goals = [None]
    for k in range(1, 7):
        phone.touch("touchMove", (x - 5 * k, y - 6 * k))
        assert wait(lambda: phone.ask("session.goal") not in (None, goals[-1]))  # the page has seen this move
        goals.append(phone.ask("session.goal"))
    goal = np.array(goals[-1]).reshape(4, 4)
    assert np.abs(goal - robot.fk(robot.configurations["qr"])).max() > 1e-3
    assert wait(lambda: np.abs(robot.fk(phone.ask("q")) - goal).max() < 1e-6)
    phone.touch("touchEnd")
    assert wait(lambda: phone.ask("session.goal") is None)
    assert np.abs(robot.fk(phone.ask("q")) - goal).max() < 1e-6


@pytest.mark.parametrize("second", ["background", "ball"])
def test_two_fingers_zoom_wherever_the_second_lands(phone: Tab, second: str) -> None:
    before, q = phone.ask(DISTANCE), phone.ask("q")
    x, y = (200.0, 560.0) if second == "background" else phone.place_of()
    phone.touch("touchStart", (60.0, 600.0))
    phone.touch("touchStart", (60.0, 600.0), (x, y))
    for k in range(1, 6):
        phone.touch("touchMove", (60.0 - 8 * k, 600.0 + 8 * k), (x + 8 * k, y - 8 * k))
    assert wait(lambda: phone.ask(DISTANCE) < 0.9 * before)
    phone.touch("touchEnd")
    assert phone.ask("q") == q and phone.ask("session.goal") is None
    phone.page.get_by_label("First view (Home)").tap()
    x, y = phone.place_of()
    phone.touch("touchStart", (x, y))  # afterwards a finger drags again
    phone.touch("touchMove", (x + 9, y))
    assert wait(lambda: phone.ask("q") != q)
    phone.touch("touchEnd")
    assert wait(lambda: phone.ask("session.goal") is None)


def test_fingers_turn_the_camera_and_use_the_panel(phone: Tab) -> None:
    camera = "session.stage.camera.position.toArray()"
    before = phone.ask(camera)
    phone.touch("touchStart", (60.0, 600.0))
    phone.touch("touchMove", (90.0, 590.0))
    phone.touch("touchMove", (120.0, 590.0))
    assert wait(lambda: phone.ask(camera) != before)
    phone.touch("touchEnd")
    phone.page.get_by_label("Show the panel (P)").tap()
    phone.page.locator("#slider-0").scroll_into_view_if_needed()
    box = phone.page.locator("#slider-0").bounding_box()
    x, y, before = box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"], phone.ask("q")[0]
    phone.touch("touchStart", (x, y))
    for k in range(1, 5):
        phone.touch("touchMove", (x + 10 * k, y))
    assert wait(lambda: phone.ask("q")[0] > before + 0.3)
    assert phone.ask("session.range.group.visible") is True  # the range of the joint
    phone.touch("touchEnd")
    phone.page.get_by_label("Hide the panel (P)").tap()
    assert not phone.page.locator("#slider-0").is_visible()
    assert phone.page.locator(".timeline select").is_visible()


def test_the_time_line_plays_stops_and_is_scrubbed(robot: ulna.Robot, motion: Any, tab: Tab) -> None:
    end = robot.configurations["ready"]
    np.testing.assert_allclose(tab.ask("q"), motion.q(0.0), atol=1e-12)
    tab.page.get_by_label("Play (space)").click()
    assert wait(lambda: np.allclose(tab.ask("q"), end, atol=1e-12))
    assert tab.page.locator(".clock").inner_text() == "1.00 / 1.00 s"
    assert tab.page.get_by_label("Play (space)").is_visible()  # it has stopped
    slider = tab.page.get_by_label("Time", exact=True)
    slider.fill("0.4")
    np.testing.assert_allclose(tab.ask("q"), motion.q(0.4), atol=1e-4)  # between two rows of 60 Hz
    box = slider.bounding_box()
    tab.page.mouse.click(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
    assert tab.ask("session.timeline.time") == pytest.approx(0.5, abs=0.02)


def test_keys_speeds_and_drags_rule_the_time_line(robot: ulna.Robot, motion: Any, tab: Tab) -> None:
    tab.page.get_by_label("Time", exact=True).fill("0.1")
    tab.page.get_by_label("Speed").select_option("0.1")
    tab.page.locator("canvas").focus()
    tab.page.keyboard.press("Space")
    assert wait(lambda: tab.ask("session.timeline.time") > 0.11) and tab.ask("session.timeline.playing")
    tab.page.keyboard.press("Space")
    assert tab.ask("session.timeline.playing") is False
    stopped = tab.ask("session.timeline.time")
    assert stopped < 1.0
    np.testing.assert_allclose(tab.ask("q"), motion.q(stopped), atol=1e-4)
    tab.page.keyboard.press("Space")
    tab.drag((0, 0, 0), (-20, 10))
    goal = np.array(tab.ask("session.goal")).reshape(4, 4)
    assert tab.ask("session.timeline.playing") is False
    assert wait(lambda: np.abs(robot.fk(tab.ask("q")) - goal).max() < 1e-6)
    tab.page.mouse.up()


def test_keys_wait_while_a_dialog_is_open(tab: Tab) -> None:
    tab.page.locator("canvas").focus()
    look = tab.ask("dataset.look")
    tab.page.keyboard.press("?")
    assert tab.page.get_by_role("dialog", name="Help").is_visible()
    tab.page.keyboard.press("t")
    assert tab.ask("dataset.look") == look
    tab.page.keyboard.press("Escape")
    assert wait(lambda: not tab.page.get_by_role("dialog", name="Help").is_visible())
    tab.page.get_by_label("Licences").click()
    about = tab.page.get_by_role("dialog", name="About")
    assert "three.js authors" in about.inner_text() and "Ulna, MIT" in about.inner_text()
    about.get_by_label("Close").click()


def test_a_goal_in_reach_is_never_called_out_of_reach(robot: ulna.Robot, tab: Tab) -> None:
    tab.page.evaluate(f"{ELEMENT}.q = {robot.configurations['qr'].tolist()}")
    tab.page.evaluate(
        f"""() => {{ const status = {ELEMENT}.session.panel.status; window.noted = [];
        new MutationObserver(() => window.noted.push(status.textContent)).observe(status, {{ childList: true }}); }}"""
    )
    goal = robot.fk(robot.configurations["qr"] + [1.5, 0.2, 0, 0, 0.3, 0, 0])
    tab.page.evaluate(f"{ELEMENT}.setTarget({goal.reshape(-1).tolist()})")
    assert wait(lambda: np.abs(robot.fk(tab.ask("q")) - goal).max() < 1e-6)
    assert wait(lambda: "On the target" in tab.page.evaluate("noted"))
    assert not any("Out of reach" in words for words in tab.page.evaluate("noted"))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        ("setTarget(new Array(16).fill(0))", "goal is no pose; expected T_world_frame"),
        ("setTarget([1, 2])", "expected 16 finite numbers"),
        ("setTarget([1,0,0,0, 0,1,0,0, 0,0,1,0, 0.3,0.1,0.4,1])", "transpose its matrices"),
        ("go('redy')", "There is no configuration redy; there are qr, qz, ready"),
        ("pose('hand')", "There is no frame hand to drag"),
        ("q = [1, NaN, 0, 0, 0, 0, 0]", "expected 7 finite numbers"),
    ],
)
def test_the_element_refuses_what_means_nothing(tab: Tab, call: str, message: str) -> None:
    before = tab.ask("q")
    said = tab.page.evaluate(
        f"() => {{ try {{ {ELEMENT}.{call}; }} catch (error) {{ return error.message; }} }}"
    )
    assert message in said and tab.ask("q") == before


def test_a_drawing_that_is_dropped_comes_back(robot: ulna.Robot, tab: Tab) -> None:
    q = robot.configurations["ready"].tolist()
    tab.page.evaluate(f"{ELEMENT}.q = {q}")
    tab.page.evaluate(
        f"window.lost = {ELEMENT}.session.stage.renderer.getContext().getExtension('WEBGL_lose_context'), lost.loseContext()"
    )
    assert wait(lambda: tab.page.get_by_text("Draw the robot again").is_visible())
    assert not tab.ask("poster.classList.contains('gone')")
    tab.page.get_by_text("Draw the robot again").click()
    assert tab.started() == "ready" and tab.ask("q") == q
    assert tab.page.locator("canvas").count() == 1
    tab.page.evaluate(
        f"window.lost = {ELEMENT}.session.stage.renderer.getContext().getExtension('WEBGL_lose_context'), lost.loseContext()"
    )
    assert wait(lambda: tab.page.get_by_text("Draw the robot again").is_visible())
    tab.page.evaluate("lost.restoreContext()")  # as after the graphics processor was reset
    assert wait(lambda: not tab.page.get_by_text("Draw the robot again").is_visible())
    assert tab.started() == "ready" and tab.ask("q") == q


def test_a_standalone_page(robot: ulna.Robot, chromium: Any, tmp_path: Path) -> None:
    robot.save_html(tmp_path / "panda.js", show="skeleton")
    text = '<script src="panda.js" defer></script><input id="other"><ulna-robot panel="none" style="height:300px"></ulna-robot>'
    (tmp_path / "own.html").write_text(text)
    tab = Tab(chromium, tmp_path / "own.html")
    assert tab.started() == "ready"
    assert tab.ask("frames") == [robot.tool] and not tab.page.locator(".panel").is_visible()
    look = tab.ask("dataset.look")
    tab.page.locator("#other").press("t")
    tab.page.evaluate("document.activeElement.blur()")
    tab.page.keyboard.press("t")  # keys outside of the element belong to the page
    assert tab.ask("dataset.look") == look
    tab.page.evaluate(
        f"window.seen = [], {ELEMENT}.addEventListener('change', (event) => seen.push(event.detail.q))"
    )
    q = robot.configurations["qz"]
    tab.page.evaluate(f"{ELEMENT}.go('qz')")
    assert wait(lambda: np.allclose(tab.ask("q"), q)) and np.allclose(tab.page.evaluate("seen.at(-1)"), q)
    tab.page.evaluate(f"window.kept = {ELEMENT}, kept.remove()")
    assert wait(lambda: tab.page.evaluate("kept.session") is None)
    tab.page.evaluate("document.body.append(kept)")  # a robot that comes back goes on where it was
    assert tab.started() == "ready" and np.allclose(tab.ask("q"), q)
    goal = robot.fk(robot.configurations["qr"])
    tab.page.evaluate(f"{ELEMENT}.setTarget({goal.reshape(-1).tolist()})")
    assert wait(lambda: np.abs(robot.fk(tab.ask("q")) - goal).max() < 1e-6)
    tab.context.close()


@pytest.mark.slow
def test_each_hand_of_a_humanoid_is_dragged(chromium: Any, tmp_path: Path) -> None:
    robot = ulna.load("g1", visuals="simple")
    hands = ("left_rubber_hand", "right_rubber_hand")
    tab = Tab(chromium, robot.save_html(tmp_path / "g1.html", frames=hands))
    assert tab.started() == "ready"
    for k, (hand, other) in enumerate([hands, hands[::-1]]):
        before = robot.fk(tab.ask("q"), other)
        tab.drag((0, 0, 0), (-8, -12), gizmo=k)
        assert tab.ask("session.selected") == k
        goal = np.array(tab.ask("session.goal")).reshape(4, 4)
        assert np.abs(goal - robot.fk(robot.neutral, hand)).max() > 1e-3
        assert wait(lambda hand=hand, goal=goal: np.abs(robot.fk(tab.ask("q"), hand) - goal).max() < 1e-6)
        tab.page.mouse.up()
        np.testing.assert_allclose(robot.fk(tab.ask("q"), other), before, atol=1e-12)
        assert robot.limits.contains(np.array(tab.ask("q")), 1e-9)
        assert wait(lambda: tab.ask("session.goal") is None)
    tab.context.close()
