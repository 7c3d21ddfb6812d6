"""Scripts written for Swift, in a real browser: what they move is seen to move, and what is done in the panel arrives."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import ulna
from support.shelf import worn

pytest.importorskip("spatialmath")
pytestmark = pytest.mark.browser

SCRIPTS = Path(__file__).parents[2] / "examples" / "seed-0"
PLACE = "n => window.__viserMutable?.nodeRefFromName[n]?.matrix.toArray() ?? null"
OPACITY = """n => { let found = null;
  window.__viserMutable?.nodeRefFromName[n]?.traverse(o => { if (o.material && o.material.color) found ??= o; });
  return found && found.material.opacity; }"""


@pytest.fixture(scope="module")
def toolbox() -> Iterator[None]:
    with worn("roboticstoolbox"):
        yield


def wait(condition: Callable[[], Any], patience: float = 90.0) -> Any:
    due = time.monotonic() + patience
    while time.monotonic() < due:
        found = condition()
        if found:
            return found
        time.sleep(0.05)
    return condition()


def tab_at(chromium: Any, url: str) -> Any:
    context = chromium.new_context(viewport={"width": 640, "height": 400})
    tab = context.new_page()
    tab.goto(f"{url}/?fixedDpr=1")
    return tab


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
        assert wait(lambda: tab.evaluate(OPACITY, "/panda/panda_link3") == pytest.approx(0.5, abs=0.01))
        before = np.array(tab.evaluate(PLACE, "/panda/panda_hand"))
        arm.qd, ball.v = np.array([1.0, 0, 0, 0, 0, 0, 0]), [0, 0, 0.5, 0, 0, 0]
        for _ in range(10):
            env.step(0.05)
        label.label = "moved"
        expected = panda.fk(arm.q, frame="panda_hand")[:3, 3]
        hand = wait(lambda: _near(tab.evaluate(PLACE, "/panda/panda_hand"), expected))
        assert hand and np.abs(np.array(hand)[12:15] - before[12:15]).max() > 0.1
        assert wait(lambda: _near(tab.evaluate(PLACE, "/ball"), [0.5, 0, 0.75]))
        assert wait(lambda: tab.get_by_text("moved", exact=True).count())
        tab.get_by_role("slider").nth(1).press("ArrowRight")  # the first one is that of time
        tab.get_by_role("button", name="Go", exact=True).click()
        tab.get_by_role("checkbox").nth(1).check()
        assert wait(lambda: env._controls.waiting >= 3) and heard == []
        env.step(0.01)
        assert heard == [4.0, "go", [True, True]] and env.values == {"gain": 4.0}
        port = env.viewer.url
        env.reset()
        assert env.viewer.url == port  # the tab finds it again
        env.add(sg.Cuboid([0.1, 0.2, 0.3]), name="box")
        assert wait(lambda: tab.evaluate(PLACE, "/box")) and tab.evaluate(PLACE, "/panda/panda_hand") is None
        tab.context.close()
    finally:
        env.close()


@pytest.mark.skipif(sys.platform in ("win32", "darwin"), reason="a browser is put into $BROWSER")
def test_the_second_script_of_the_course(toolbox: None, chromium: Any, tmp_path: Path) -> None:
    """Unmodified: it opens the browser, the arm is seen to move, and it ends when the tab is closed."""
    robot = pytest.importorskip("roboticstoolbox").Robot
    if not (hasattr(robot, "ulna") or hasattr(robot, "_everything")):
        pytest.skip("robots of the face cannot be shown yet")
    opener = tmp_path / "open"
    opener.write_text(f'#!/bin/sh\necho "$1" > {tmp_path}/part && mv {tmp_path}/part {tmp_path}/url\n')
    opener.chmod(0o755)
    process = subprocess.Popen(
        [sys.executable, "-m", "ulna", "run", str(SCRIPTS / "rtb_example2.py")],
        env={**os.environ, "DISPLAY": ":0", "BROWSER": f"{opener} %s", "ULNA_HEADLESS": ""},
        cwd=tmp_path,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        url = wait(lambda: (tmp_path / "url").exists() and (tmp_path / "url").read_text().strip())
        tab = tab_at(chromium, url)
        end = np.array([0.5, -0.3, 0.0, -2.2, 0.0, 2.0, np.pi / 4 + 0.5])
        there = ulna.load("panda", visuals="simple").fk(end, frame="panda_hand")[:3, 3]
        moved = wait(lambda: _near(tab.evaluate(PLACE, "/panda/panda_hand"), there))
        assert moved, "the arm did not get there"
        tab.context.close()
        said, _ = process.communicate(timeout=60)
        assert process.returncode == 0 and "The page was closed." in said
    finally:
        process.kill()
        process.communicate()


def _near(matrix: Any, place: Any) -> Any:
    return matrix and np.abs(np.array(matrix)[12:15] - place).max() < 1e-4 and matrix


def _at(x: float, y: float, z: float) -> np.ndarray:
    out = np.eye(4)
    out[:3, 3] = x, y, z
    return out
