"""After a script has ended, its page plays the motion, also where the page came late."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ulna
from support.patience import patient
from support.ports import free_port
from support.script_pages import PLACE, running, tab_at
from ulna.viewer.viewer import Viewer

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(sys.platform in ("win32", "darwin"), reason="a browser is put into $BROWSER"),
]
wait = patient()
HAND, BAR = "/panda/panda_hand", ".ulna-playback"
SCRIPT = """
import sys
import swift._launch
import numpy as np, roboticstoolbox as rtb, spatialgeometry as sg, swift
{before}
env = swift.Swift()
env.launch()
panda = rtb.models.Panda()
panda.q = panda.qr
env.add(panda)
ball = sg.Sphere(0.05, pose=rtb.models.Panda().fkine(panda.qr))
env.add(ball, name="ball")
panda.qd, ball.v = [0.5, 0, 0, 0.1, 0, 0, 0], [0, 0, 0.25, 0, 0, 0]
for _ in range(40):
    env.step(0.05)
print("stepped", flush=True)
{after}
"""


def place(tab: Any, node: str) -> np.ndarray:
    """The pose of a node in a tab, (4, 4)."""
    return np.array(tab.evaluate(PLACE, node)).reshape(4, 4).T


def scrub(tab: Any, t: float) -> None:
    """Move the time line of the page."""
    set_time = f"e => {{ e.value = {t}; e.dispatchEvent(new Event('input')); }}"
    tab.locator(f"{BAR} input").evaluate(set_time)


def check_motion(tab: Any) -> None:
    """The page has the motion of the script: at any time, and when it plays."""
    tab.wait_for_selector(BAR)
    tab.wait_for_function("n => window.__viserMutable.nodeRefFromName[n]", arg=HAND)
    assert "2.00 s of 2.00 s" in tab.locator(f"{BAR} output").text_content()
    panda = ulna.load("panda", visuals="simple")
    q = np.array(panda.configurations["qr"])
    tool = panda.fk(q)
    for t in (0.0, 0.35, 1.5, 2.0):
        expected = panda.fk(q + t * np.array([0.5, 0, 0, 0.1, 0, 0, 0]), frame="panda_hand")
        scrub(tab, t)
        assert wait(lambda expected=expected: np.abs(place(tab, HAND) - expected).max() < 1e-6), t
        assert np.abs(place(tab, "/ball")[:3, 3] - tool[:3, 3] - [0, 0, 0.25 * t]).max() < 1e-6
    end = place(tab, HAND)
    tab.locator(f"{BAR} select").select_option("0.1")
    tab.get_by_role("button", name="Play", exact=True).click()  # from the beginning
    assert wait(lambda: np.abs(place(tab, HAND) - end).max() > 0.05)
    tab.locator(f"{BAR} select").select_option("5")
    assert wait(lambda: np.abs(place(tab, HAND) - end).max() < 1e-6)
    assert tab.get_by_role("button", name="Play", exact=True).count() == 1  # and it rests there


def test_a_page_that_loads_after_the_last_step_plays_the_motion(chromium: Any, tmp_path: Path) -> None:
    pytest.importorskip("spatialmath")
    script = tmp_path / "script.py"
    # on a machine with other work, a tab of Chromium may take longer than a program waits for it
    patience = "ending._LOADING_TIME = ending._DELIVERY_TIME = visits._LOADING_TIMEOUT = 300.0"
    before = f"swift._launch._BROWSER_TIMEOUT = 0.0\nfrom ulna.viewer.page import ending, visits\n{patience}"
    script.write_text(SCRIPT.format(before=before, after="sys.exit(3)"))
    with running(script, tmp_path) as (process, address):
        url = address()
        assert any(line == "stepped\n" for line in process.stdout)
        tab = tab_at(chromium, url)
        _, printed = process.communicate(timeout=600)
        assert process.returncode == 3, printed
        check_motion(tab)
        tab.context.close()


def test_two_tabs_play_what_was_left_and_go_to_the_next_program(chromium: Any) -> None:
    port = free_port()
    with Viewer(port=port, browser=False) as viewer:
        box = viewer.box((0.1, 0.1, 0.1), name="box")
        tabs = [tab_at(chromium, viewer.url) for _ in range(2)]
        assert wait(lambda: all(tab.evaluate(PLACE, "/box") for tab in tabs))
        line = ulna.trajectory.pose_line(np.eye(4), ulna.SE3.trans(0.0, 0.0, 1.0), 2.0)
        viewer.play({box: line})
    for tab in tabs:  # the viewer was closed while it played
        tab.wait_for_selector(BAR)
        for t in (0.0, 1.0):
            scrub(tab, t + _delay(tab))
            # at most 0.94 m/s: a frame holds for 1/60 s, and the delay is rounded to 0.01 s
            height = line.T(t)[2, 3]
            assert wait(lambda tab=tab, height=height: abs(place(tab, "/box")[2, 3] - height) < 0.06)
    with Viewer(port=port, browser=False) as viewer:
        viewer.sphere(0.1, name="ball")
        assert all(wait(lambda tab=tab: tab.evaluate(PLACE, "/ball")) for tab in tabs)
        assert all(wait(lambda tab=tab: not tab.locator(BAR).count()) for tab in tabs)
    for tab in tabs:
        tab.context.close()


def test_the_first_attempt_to_reconnect_waits_for_messages_that_are_held_back(chromium: Any) -> None:
    """viser's page reconnects at once, and its worker then discards messages that it holds back to smooth their times."""
    with Viewer(port=free_port(), browser=False) as viewer:
        tab = tab_at(chromium, viewer.url)
        assert wait(lambda: tab.evaluate("() => !!window.__viserMutable?.ulnaPlayback"))
        passed = tab.evaluate(
            """() => new Promise(resolve => {
                const source = "onmessage = e => { if (e.data.type !== 'zstd_wasm') postMessage({type: e.data.type}); }";
                const worker = new Worker(URL.createObjectURL(new Blob([source])));
                let closed = 0;
                worker.addEventListener("message", ({data}) => { if (data.type === "closed") closed = performance.now(); });
                worker.postMessage({type: "zstd_wasm"});
                worker.onmessage = ({data}) => {  // as viser's page does, on a connection that is older than 5 s
                    if (data.type === "closed") worker.postMessage({type: "retry"});
                    if (data.type === "retry") resolve(performance.now() - closed);
                };
                worker.postMessage({type: "closed"});
            })"""
        )
        tab.context.close()
    assert passed > 200.0


def _delay(tab: Any) -> float:
    """How long the motion of 2 s in a tab rests before it begins [s]."""
    return float(tab.locator(f"{BAR} output").text_content().split(" of ")[1].split()[0]) - 2.0
