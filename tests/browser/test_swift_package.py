"""Scripts written for Swift, in a real browser: what they move is seen to move, and what is done in the panel arrives."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import ulna
from support.compat_packages import using
from support.script_pages import OPACITIES, PLACE, near, tab_at, wait

pytest.importorskip("spatialmath")
pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def toolbox() -> Iterator[None]:
    with using("roboticstoolbox"):
        yield


def test_an_environment_in_the_browser(toolbox: None, chromium: Any) -> None:
    import spatialgeometry as sg
    import swift

    panda = ulna.load("panda", visuals="simple")
    start = np.array(panda.configurations["qr"])
    arm = SimpleNamespace(ulna=panda, name="panda", q=start.copy(), qd=np.zeros(7), base=np.eye(4))
    heard: list[Any] = []
    env = swift.Swift()
    env.launch(headless=False)
    try:
        env.add(arm, robot_alpha=0.5, collision_alpha=0.25)
        ball = sg.Sphere(0.1, pose=_at(0.5, 0, 0.5), color="tomato")
        env.add(ball, name="ball")
        env.add(swift.Slider(heard.append, 0, 10, 1, 3, label="gain"), name="gain")
        env.add(swift.Checkbox(heard.append, "flags", ["quick", "careful"], [True, False]))
        env.add(swift.Button(lambda _: heard.append("go"), "Go"))
        label = swift.Label("at rest")
        env.add(label)
        tab = tab_at(chromium, env.viewer.url)
        assert wait(lambda: tab.evaluate(PLACE, "/panda/panda_hand"))
        assert wait(lambda: np.allclose(tab.evaluate(OPACITIES, "/panda/panda_link3") or 0, 0.5, atol=0.01))
        before = np.array(tab.evaluate(PLACE, "/panda/panda_hand"))
        arm.qd, ball.v = np.array([1.0, 0, 0, 0, 0, 0, 0]), [0, 0, 0.5, 0, 0, 0]
        for _ in range(10):
            env.step(0.05)
        label.label = "moved"
        expected = panda.fk(arm.q, frame="panda_hand")[:3, 3]
        hand = wait(lambda: near(tab, "/panda/panda_hand", expected))
        assert hand and np.abs(np.array(hand)[12:15] - before[12:15]).max() > 0.1
        assert wait(lambda: near(tab, "/ball", [0.5, 0, 0.75]))
        assert wait(lambda: tab.get_by_text("moved", exact=True).count())
        tab.get_by_role("slider").nth(1).press("ArrowRight")  # the first one is that of time
        tab.get_by_role("button", name="Go", exact=True).click()
        tab.get_by_role("checkbox").nth(1).check()
        assert wait(lambda: env._controls.waiting >= 3) and heard == []
        env.step(0.01)
        assert heard == [4.0, "go", [True, True]] and env.values == {"gain": 4.0}
        gain, flags = env.elements[0], env.elements[1]
        gain.label, gain.max = "stiffness", 4.5
        assert wait(lambda: tab.get_by_text("stiffness").count() and not tab.get_by_text("gain").count())
        flags.options = ["quick", "careful", "loud"]
        assert wait(lambda: tab.get_by_text("loud").count())
        env.remove(flags)
        assert wait(lambda: not tab.get_by_text("loud").count())
        port = env.viewer.url
        env.reset()
        assert env.viewer.url == port  # the tab finds it again
        env.add(sg.Cuboid([0.1, 0.2, 0.3]), name="box")
        hand = "/panda/panda_hand"
        assert wait(lambda: tab.evaluate(PLACE, "/box") and tab.evaluate(PLACE, hand) is None)
        tab.context.close()
    finally:
        env.close()


def _at(x: float, y: float, z: float) -> np.ndarray:
    out = np.eye(4)
    out[:3, 3] = x, y, z
    return out
