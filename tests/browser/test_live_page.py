"""The live page in a browser, opened from disk: real pointer and key events, and no request."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ulna
from support.live_tab import ELEMENT, Tab, state_of
from support.patience import patient

pytestmark = pytest.mark.browser
NOTE_STATUS = (
    "() => { const status = "
    + ELEMENT
    + """.session.panel.status; window.noted = [];
    new MutationObserver(() => window.noted.push(status.textContent)).observe(
        status, { childList: true, characterData: true, subtree: true }); }"""
)
wait = patient()


@pytest.fixture(scope="module")
def robot() -> ulna.Robot:
    return ulna.load("panda", visuals="simple")


@pytest.fixture(scope="module")
def file(robot: ulna.Robot, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return robot.save_html(tmp_path_factory.mktemp("live") / "panda.html")


@pytest.fixture(scope="module")
def tab(chromium: Any, file: Path) -> Iterator[Tab]:
    tab = Tab(chromium, file, color_scheme="light")
    assert tab.started() == "ready"
    yield tab
    tab.context.close()


@pytest.mark.parametrize(
    ("way", "by"),
    [((0, 0, 0), (-40, -30)), ((0.8, 0, 0), (30, 0)), ((0, 0, 0.8), (0, -30)), ((0.52, 0.52, 0), (15, 20))],
    ids=["ball", "arrow x", "arrow z", "ring z"],
)
def test_after_a_drag_the_tool_is_at_the_target(robot: ulna.Robot, tab: Tab, way: Any, by: Any) -> None:
    tab.page.evaluate(f"{ELEMENT}.q = {robot.configurations['qr'].tolist()}")
    tab.drag(way, by)
    goal = np.array(tab.ask("session.goal")).reshape(4, 4)
    assert np.abs(goal - robot.fk(robot.configurations["qr"])).max() > 1e-3, "nothing was dragged"
    wait(lambda: np.abs(robot.fk(tab.ask("q")) - goal).max() < 1e-6)
    tab.page.mouse.up()
    q = np.array(tab.ask("q"))
    assert np.abs(robot.fk(q)[:3, 3] - goal[:3, 3]).max() < 1e-6 and robot.limits.contains(q)


def test_poses_are_those_of_the_robot(robot: ulna.Robot, tab: Tab) -> None:
    tab.page.evaluate(f"{ELEMENT}.q = {robot.configurations['ready'].tolist()}")
    assert (
        np.abs(np.reshape(tab.ask("pose()"), (4, 4)) - robot.fk(robot.configurations["ready"])).max() < 1e-14
    )


def test_out_of_reach_the_panel_says_so_and_the_target_returns(robot: ulna.Robot, tab: Tab) -> None:
    far = np.eye(4)
    far[:3, 3] = (3.0, 0.0, 0.5)
    tab.page.evaluate(NOTE_STATUS)
    tab.page.evaluate(f"{ELEMENT}.setTarget({far.reshape(-1).tolist()})")
    assert wait(lambda: any("Out of reach" in words for words in tab.page.evaluate("window.noted")))
    assert wait(lambda: tab.ask("session.goal") is None)
    assert robot.limits.contains(tab.ask("q"), 1e-12)


def test_sliders_and_keys_move_the_robot(robot: ulna.Robot, tab: Tab) -> None:
    tab.page.evaluate(f"{ELEMENT}.q = {robot.configurations['qr'].tolist()}")
    slider = tab.page.locator("#slider-0")
    slider.focus()
    slider.press("ArrowRight")
    assert tab.ask("q")[0] == pytest.approx(np.deg2rad(1.0))
    slider.fill("99")  # beyond its end
    assert tab.ask("q")[0] <= robot.limits.upper[0]
    before = robot.fk(tab.ask("q"))[2, 3]
    tab.page.locator("canvas").focus()
    tab.page.keyboard.press("PageUp")
    assert wait(lambda: abs(robot.fk(tab.ask("q"))[2, 3] - before - 0.01) < 1e-6)
    tab.page.keyboard.press("2")
    assert wait(lambda: np.allclose(tab.ask("q"), list(robot.configurations.values())[1]))


def test_light_and_dark_and_no_request(tab: Tab, file: Path) -> None:
    assert tab.ask("dataset.look") == "light"
    tab.page.locator("canvas").press("t")
    assert tab.ask("dataset.look") == "dark"
    others = [url for url in tab.requests if url != file.as_uri() and not url.startswith(("data:", "blob:"))]
    assert others == []


def test_the_picture_is_there_before_the_script_and_without_it(chromium: Any, file: Path) -> None:
    tab = Tab(chromium, file, java_script_enabled=False)
    image = tab.page.locator("ulna-robot img")
    assert image.is_visible() and image.bounding_box()["width"] > 400
    tab.context.close()


@pytest.mark.parametrize(
    ("script", "words"),
    [
        ("WebAssembly.validate = () => false", "SIMD"),
        ("HTMLCanvasElement.prototype.getContext = () => null", "WebGL 2"),
        ("delete window.WebAssembly", "no WebAssembly"),
    ],
)
def test_a_browser_that_cannot_says_why(chromium: Any, file: Path, script: str, words: str) -> None:
    context = chromium.new_context()
    page = context.new_page()
    page.add_init_script(script)
    page.goto(file.as_uri())
    assert state_of(page) == "failed"
    assert words in page.locator("[role=alert]").inner_text()
    context.close()
