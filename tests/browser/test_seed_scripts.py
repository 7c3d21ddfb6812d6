"""The six scripts of a course, unmodified, in a real browser: what they promise is seen, and they end."""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ulna
from support.script_pages import OPACITIES, PLACE, near, running, tab_at, wait

pytest.importorskip("spatialmath")
pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(sys.platform in ("win32", "darwin"), reason="a browser is put into $BROWSER"),
]

SCRIPTS = Path(__file__).parents[2] / "examples" / "seed-0"
HAND = "/panda/panda_hand"
READY = np.array([0.0, -0.3, 0.0, -2.2, 0.0, 2.0, np.pi / 4])
ENDS = {
    "rtb_example2": READY + [0.5, 0, 0, 0, 0, 0, 0.5],
    "rtb_example3": [-0.2146009354, 0.8461450365, -0.0743063550, -1.4468056398, 0.1186998393, 2.3849067684, 0.4416263525],
    "rtb_example4": [-0.2148136450, 0.8459156502, -0.0739782665, -1.4469917108, 0.1183390994, 2.3848916049, 0.4418592236],
    "rtb_example5": [-0.2028868504, 0.8893757511, -0.0555809019, -1.5279816690, 0.1128294741, 2.5109707742, 0.4615706714],
}  # fmt: skip


def hand_at(q: Any) -> Any:
    """Where the hand is, (3,) [m]."""
    return ulna.load("panda", visuals="simple").fk(np.asarray(q), frame="panda_hand")[:3, 3]


def ends(tab: Any, process: Any) -> str:
    """What the script printed, ending because its page was closed."""
    tab.context.close()
    said, wrong = process.communicate(timeout=120)
    assert process.returncode == 0, wrong
    assert "The page was closed." in said
    return said


def test_script_1_shows_the_robot(chromium: Any, tmp_path: Path) -> None:
    with running(SCRIPTS / "rtb_example1.py", tmp_path) as (process, address):
        tab = tab_at(chromium, address())
        assert wait(lambda: near(tab, HAND, hand_at(READY)))
        assert "panda_link7" in ends(tab, process)


@pytest.mark.parametrize("name", [n for n in ENDS if n != "rtb_example4"])
def test_what_moves_arrives(chromium: Any, name: str, tmp_path: Path) -> None:
    with running(SCRIPTS / f"{name}.py", tmp_path) as (process, address):
        tab = tab_at(chromium, address())
        assert wait(lambda: near(tab, HAND, hand_at(ENDS[name]))), "the arm did not get there"
        if name == "rtb_example3":
            goal = np.array(tab.evaluate(PLACE, "/axes 1")).reshape(4, 4).T
            assert np.abs(goal[:3, 3] - [0.7179893443, -0.2, 0.0843450009]).max() < 1e-6
        ends(tab, process)


def test_script_4_is_translucent(chromium: Any, tmp_path: Path) -> None:
    with running(SCRIPTS / "rtb_example4.py", tmp_path) as (_, address):
        tab = tab_at(chromium, address())
        for node in (
            "/panda/panda_link3",
            "/panda 2/panda_link3",
        ):  # what it looks like, what it collides with
            assert wait(lambda node=node: np.allclose(tab.evaluate(OPACITIES, node) or 1, 0.5, atol=0.01))
        start = hand_at(READY)
        assert wait(lambda: np.abs(np.array(tab.evaluate(PLACE, HAND))[12:15] - start).max() > 0.01)
        tab.context.close()


@pytest.mark.slow
def test_script_4_arrives_in_time(chromium: Any, tmp_path: Path) -> None:
    began = time.monotonic()
    with running(SCRIPTS / "rtb_example4.py", tmp_path) as (process, address):
        tab = tab_at(chromium, address())
        assert wait(lambda: near(tab, HAND, hand_at(ENDS["rtb_example4"]), 1e-4))
        assert (
            time.monotonic() - began > 35.0
        )  # nearly 43.17 s, which the script lasts; no less where pages load slowly
        ends(tab, process)


def test_script_6_plans_films_and_plays(chromium: Any, tmp_path: Path) -> None:
    """With the line that the document has as a remark: a film by pyplot; then the motion in the page."""
    image = pytest.importorskip("PIL.Image")
    text = (SCRIPTS / "rtb_example6.py").read_text()
    assert text.count("#robot.plot") == 1
    script = tmp_path / "sixth.py"
    epilogue = """
import json, pathlib, time
print("@" + json.dumps(list(map(float, q_pickup))), flush=True)
while not pathlib.Path("seen").exists():
    time.sleep(0.05)
"""
    script.write_text(text.replace("#robot.plot", "robot.plot") + epilogue)
    with running(script, tmp_path) as (process, address):
        tab = tab_at(chromium, address())
        last = next((line for line in process.stdout if line.startswith("@")), "")
        assert last, process.communicate(timeout=120)[1]
        there = hand_at(json.loads(last[1:]))
        assert wait(lambda: near(tab, HAND, there)), "the arm was not seen to get there"
        assert np.linalg.norm(there - [0.6, -0.3, 0.1 + 0.1034]) < 1e-3
        (tmp_path / "seen").touch()
        _, wrong = process.communicate(timeout=120)
        assert process.returncode == 0, wrong
        assert near(tab, HAND, there), "the tab lost what it had when the script ended"
        tab.context.close()
    with image.open(tmp_path / "panda1.gif") as film:
        assert (film.n_frames, film.info["duration"]) == (50, 50)
        pictures = []
        for k in (0, 25, 49):
            film.seek(k)
            pictures.append(np.asarray(film.convert("L"), dtype=float))
    assert all(p.std() > 5.0 for p in pictures)  # something is drawn
    assert np.abs(pictures[0] - pictures[2]).mean() > 0.5 < np.abs(pictures[1] - pictures[0]).mean()
