"""Scripts of Swift through the face against Swift itself: two processes that take turns; with `--page`, watched in Chromium.

Run: python benchmarks/compat_swift.py [--page]

It needs swift-sim and roboticstoolbox-python, and for `--page` playwright and a Chromium.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time
import webbrowser
from collections.abc import Callable
from typing import Any

from _pair import answer_rounds, environments, in_turns
from _timing import shown, table

ROUNDS = 7
SERVO = "servo loop of example 3: `fkine`, `p_servo`, `jacobe`, `numpy.linalg.pinv`, `step`"
REALTIME = "example 3 in real time, 4.31 s"


class Chromium(webbrowser.BaseBrowser):
    """Opens pages in a Chromium without a window, in a separate process."""

    def open(self, url: str, new: int = 0, autoraise: bool = True) -> bool:
        """Open a page."""
        _, plain = environments("roboticstoolbox")
        self.process = subprocess.Popen([sys.executable, __file__, "--browse", url], env=plain)
        return True


def browse(url: str) -> None:
    """Looks at a page for ever."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as driver:
        browser = driver.chromium.launch(
            executable_path=shutil.which("chromium"),
            args=["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
        )
        browser.new_page(viewport={"width": 640, "height": 400}).goto(url)
        while True:
            time.sleep(1.0)


def opened(realtime: bool, browser: Chromium | None) -> Any:
    """An environment, with a page if there is a browser."""
    import swift

    env = swift.Swift()
    if browser is None:
        env.launch(realtime=realtime, headless=True)
    elif hasattr(type(env), "viewer"):
        env.launch(realtime=realtime, headless=False)
        browser.open(env.viewer.url)
        while not env.viewer.clients:
            time.sleep(0.1)
    else:
        webbrowser.register("here", None, browser)
        env.launch(realtime=realtime, headless=False, browser="here")
    return env


def prepared(browser: Chromium | None) -> Callable[[], dict[str, float]]:
    """What measures once: seconds by name."""
    import numpy as np
    import roboticstoolbox as rtb
    import spatialmath as sm

    page = browser is not None
    clock = time.perf_counter if page else time.thread_time  # where nothing waits, the work counts
    env, panda = opened(page, browser), rtb.models.Panda()
    panda.q = panda.qr
    env.add(panda)
    goal = panda.fkine(panda.q) * sm.SE3.Tx(0.2) * sm.SE3.Ty(0.2) * sm.SE3.Tz(0.35)

    def servo() -> None:
        twist, _ = rtb.p_servo(panda.fkine(panda.q), goal, gain=1, threshold=0.01)
        panda.qd = np.linalg.pinv(panda.jacobe(panda.q)) @ twist
        env.step(0.01)

    def taken(f: Callable[[], None], count: int) -> float:
        panda.q, panda.qd = panda.qr, np.full(7, 1e-3)
        start = clock()
        for _ in range(count):
            f()
        return clock() - start

    if page:
        time.sleep(5.0)  # until the meshes are there
    else:
        taken(servo, 300)

    def measured() -> dict[str, float]:
        if page:
            return {REALTIME: taken(servo, 431)}
        return {
            "`env.step`, one Panda": taken(lambda: env.step(1e-3), 1000) / 1000,
            SERVO: taken(servo, 300) / 300,
        }

    return measured


def worker(page: bool) -> None:
    """Answers with what it measures, and ends, though Swift would wait for its page."""
    browser = Chromium() if page else None
    answer_rounds(lambda: prepared(browser))
    if browser is not None:
        browser.process.kill()
    os._exit(0)


def main() -> None:
    """Prints the table."""
    page = "--page" in sys.argv
    command = ["-W", "ignore", __file__, "--worker", *(["--page"] if page else [])]
    variables = dict(zip(("face", "swift"), environments("roboticstoolbox"), strict=True))
    if page:  # pages draw even when nothing moves, so that they are open one after the other
        found = {who: in_turns(command, {who: env}, 3)[who] for who, env in variables.items()}
    else:
        found = in_turns(command, variables, ROUNDS)
    rows = []
    for name, ours in found["face"].items():
        theirs = found["swift"][name]
        rows.append([name, shown(ours), shown(theirs), f"{theirs / ours:.1f}"])
    print(table("Scripts of Swift", ["", "face", "swift", "ratio"], rows))


if __name__ == "__main__":
    if "--browse" in sys.argv:
        browse(sys.argv[-1])
    elif "--worker" in sys.argv:
        worker("--page" in sys.argv)
    else:
        main()
