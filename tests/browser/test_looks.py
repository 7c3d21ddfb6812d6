"""Looks change in the page: of every kind that is drawn in its own way, to be seen in the pixels, and in a file."""

from __future__ import annotations

import io
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from support.patience import patient
from ulna.geometry import Box
from ulna.viewer.graph.camera import Camera
from ulna.viewer.viewer import Viewer

pytestmark = pytest.mark.browser
SIZE = {"width": 320, "height": 240}  # drawn by the processor here, so small
EYE = Camera((0.0, -3.0, 0.6), (0.0, 0.0, 0.3), 0.5)
TWO_FRAMES = "() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"
WAY = np.array([(-0.4, 0.0, 0.1), (0.4, 0.0, 0.1), (0.3, 0.0, 0.5), (-0.3, 0.0, 0.5)])
KINDS: dict[str, Callable[[Viewer], Any]] = {
    "sphere": lambda v: v.sphere(0.3, pose=at(0.3)),
    "line": lambda v: v.line(WAY, thickness=0.06, color=(0.1, 0.1, 0.9)),
    "points": lambda v: v.points(WAY, (0.1, 0.1, 0.9), size=0.2),
    "copies": lambda v: v.copies(Box((0.2, 0.2, 0.2)), positions=WAY, colors=(0.1, 0.1, 0.9)),
    "text": lambda v: v.text("words", (-0.7, 0.0, 0.1), height=0.5),
}


def at(height: float) -> np.ndarray:
    pose = np.eye(4)
    pose[2, 3] = height
    return pose


wait = patient()


class Tab:
    """A tab whose pixels are read."""

    def __init__(self, chromium: Any, url: str) -> None:
        self.context = chromium.new_context(viewport=SIZE)
        self.page = self.context.new_page()
        self.page.goto(url)
        self.page.add_style_tag(
            content="[class*=mantine-Notif], .mantine-Paper-root {display: none !important}"
        )

    def pixels(self) -> np.ndarray:
        """The middle of what the canvas shows."""
        from PIL import Image

        shot = Image.open(io.BytesIO(self.page.locator("canvas").first.screenshot())).convert("RGB")
        return np.asarray(shot).astype(int)[60:200, 30:290]

    def rests(self) -> np.ndarray:
        """What it shows when nothing changes any more."""
        last, same = self.pixels(), 0
        for _ in range(300):
            time.sleep(0.2)
            self.page.evaluate(TWO_FRAMES)
            now = self.pixels()
            same = same + 1 if np.abs(now - last).max() < 4 else 0
            if same == 3:
                return now
            last = now
        raise AssertionError("the page does not come to rest")


def seen(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.abs(a - b).max(axis=-1) > 40


@pytest.fixture(scope="module")
def viewer() -> Iterator[Viewer]:
    with Viewer(port=0, browser=False, camera=EYE, floor=-1.0) as viewer:
        yield viewer


@pytest.fixture(scope="module")
def tab(viewer: Viewer, chromium: Any) -> Iterator[Tab]:
    pytest.importorskip("PIL")
    tab = Tab(chromium, f"{viewer.url}/?fixedDpr=1")
    assert wait(lambda: tab.page.evaluate("() => !!window.__viserMutable?.messageQueue?.ulna"))
    tab.rests()
    yield tab
    tab.context.close()


SLOW = ("sphere", "points", "copies")


@pytest.mark.parametrize("kind", [pytest.param(k, marks=pytest.mark.slow) if k in SLOW else k for k in KINDS])
def test_looks_are_seen_and_go_again(viewer: Viewer, tab: Tab, kind: str) -> None:
    without = tab.rests()
    thing = KINDS[kind](viewer)
    assert wait(lambda: seen(tab.pixels(), without).sum() > 200)
    before = tab.rests()
    there = seen(before, without)

    def same(picture: np.ndarray) -> bool:
        return bool(seen(tab.pixels(), picture).mean() < 0.002)

    thing.color = (0.0, 0.8, 0.0)
    greenish = lambda p: (p[..., 1] > p[..., [0, 2]].max(axis=-1) + 30)[there].mean() > 0.6  # noqa: E731
    assert wait(lambda: greenish(tab.pixels()))
    thing.color = None
    assert wait(lambda: same(before))
    thing.opacity = 0.3

    def faint() -> bool:
        now, most = tab.pixels(), seen(before, without)
        share = np.abs(now - without)[most].sum() / np.abs(before - without)[most].sum()
        return bool(0.1 < share < 0.8)

    assert wait(faint)
    thing.opacity = 1.0
    assert wait(lambda: same(before))
    thing.scale = 0.5
    assert wait(lambda: 0 < seen(tab.pixels(), without).sum() < 0.7 * there.sum())
    thing.scale = 1.0
    assert wait(lambda: same(before))
    thing.visible = False
    assert wait(lambda: same(without))
    thing.visible = True
    assert wait(lambda: same(before))
    thing.position = thing.position + (0.3, 0.0, 0.1)
    assert wait(lambda: not same(before) and seen(tab.pixels(), without).sum() > 0.5 * there.sum())
    thing.remove()
    assert wait(lambda: same(without))


def test_what_lets_light_through_is_seen_behind_the_middle_of_the_floor(viewer: Viewer, tab: Tab) -> None:
    without = tab.rests()
    far = viewer.sphere(0.3, pose=np.array([[1, 0, 0, 0], [0, 1, 0, 1.5], [0, 0, 1, 0], [0, 0, 0, 1.0]]))
    far.color, far.opacity = (0.9, 0.0, 0.0), 0.7
    assert wait(lambda: (tab.pixels()[..., 0] > tab.pixels()[..., 2] + 40).sum() > 100)
    far.remove()
    assert wait(lambda: seen(tab.pixels(), without).sum() == 0)


def test_words_of_the_theme_are_dark_on_light_and_light_on_dark(viewer: Viewer, tab: Tab) -> None:
    words = viewer.text("IIIIII", (-0.5, 0.0, 0.1), height=0.6)
    assert wait(lambda: (tab.pixels().max(axis=-1) < 90).sum() > 100)
    viewer.theme = "dark"
    assert wait(lambda: (tab.pixels().min(axis=-1) > 190).sum() > 100)
    words.text = "."
    assert wait(lambda: (tab.pixels().min(axis=-1) > 190).sum() < 100)
    viewer.theme = "light"
    words.remove()


@pytest.mark.slow
def test_a_file_has_the_looks_of_everything(chromium: Any, tmp_path: Path) -> None:
    pytest.importorskip("PIL")
    viewer = Viewer(page=False, camera=EYE, floor=-1.0)
    made = {kind: make(viewer) for kind, make in KINDS.items()}
    for thing in made.values():
        thing.visible = False
    for kind, thing in made.items():
        thing.visible, thing.color, thing.opacity = True, (0.9, 0.0, 0.0), 0.8
        tab = Tab(chromium, f"{viewer.html(tmp_path / f'{kind}.html').as_uri()}?fixedDpr=1")
        try:
            assert wait(lambda tab=tab: (np.diff(tab.pixels()[..., :2])[..., 0] < -60).sum() > 150), kind
            thing.visible = False
        finally:
            tab.context.close()
