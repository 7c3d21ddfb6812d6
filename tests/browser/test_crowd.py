"""Equal things are drawn at once in the page, and each of them keeps a look of its own."""

from __future__ import annotations

import io
import time
from typing import Any

import numpy as np
import pytest

from ulna.viewer.camera import Camera
from ulna.viewer.viewer import Viewer

pytestmark = pytest.mark.browser

COUNTS = "() => [...(window.__viserMutable?.ulnaCrowds?.values() ?? [])].map(one => one.count)"


def settles(tab: Any, counts: list[int]) -> bool:
    due = time.monotonic() + 60.0
    while time.monotonic() < due:
        if tab.evaluate(COUNTS) == counts:
            return True
        time.sleep(0.05)
    return False


def reds(tab: Any) -> int:
    from PIL import Image

    shot = Image.open(io.BytesIO(tab.locator("canvas").first.screenshot())).convert("RGB")
    red, green, blue = np.moveaxis(np.asarray(shot).astype(int), 2, 0)
    return int(((red > 2 * green) & (red > 2 * blue)).sum())


def becomes(tab: Any, red: bool) -> bool:
    due = time.monotonic() + 60.0
    while time.monotonic() < due:
        if (reds(tab) > 100) == red:
            return True
        time.sleep(0.1)
    return False


def test_equal_boxes_are_drawn_at_once_until_they_differ(chromium: Any) -> None:
    pytest.importorskip("PIL")
    with Viewer(port=0, browser=False) as viewer:
        viewer.camera = Camera((0.0, -3.0, 0.6), (0.0, 0.0, 0.3), 0.5)
        blue = (0.1, 0.1, 0.9)
        boxes = [viewer.box((0.2, 0.2, 0.2), color=blue) for _ in range(10)]
        for k, box in enumerate(boxes):
            box.position = (0.3 * (k % 5) - 0.6, 0.0, 0.2 + 0.4 * (k // 5))
        context = chromium.new_context(viewport={"width": 320, "height": 240})
        tab = context.new_page()
        tab.set_default_timeout(120_000)
        tab.goto(f"{viewer.url}/?fixedDpr=1")
        tab.add_style_tag(content="[class*=mantine-Notif], .mantine-Paper-root {display: none !important}")
        assert settles(tab, [10]) and becomes(tab, red=False)
        boxes[2].color = (0.9, 0.05, 0.05)  # a colour of its own does not part it from the others
        assert becomes(tab, red=True) and settles(tab, [10])
        boxes[2].visible = False
        assert becomes(tab, red=False) and settles(tab, [9])
        boxes[2].visible = True
        assert becomes(tab, red=True) and settles(tab, [10])
        boxes[2].position = (9.0, 9.0, 0.0)
        assert becomes(tab, red=False)
        boxes[2].position = (0.0, -0.1, 0.3)
        assert becomes(tab, red=True)
        boxes[3].opacity = 0.5
        assert settles(tab, [9])
        boxes[3].opacity = 1.0
        assert settles(tab, [10])
        for box in boxes[3:6]:
            box.remove()
        assert settles(tab, [])
        assert becomes(tab, red=True)  # drawn by itself again
        context.close()
