"""The six scripts of a course, unmodified: they end, and they end where they end in the toolbox itself."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("spatialmath")
SCRIPTS = Path(__file__).parents[3] / "examples" / "seed-0"


DRIVER = """
import json, runpy, sys
space = runpy.run_path(sys.argv[1], run_name="__main__")
robot, env = space.get("robot", space.get("panda")), space.get("env")
state = {"q": [float(x) for x in robot.q], "time": env and env.sim_time}
if env is not None:
    state["alphas"] = [(h.show, h.opacity) for h in env.viewer.robots]
if "sol" in space:
    state |= {"sol": list(map(float, space["q_pickup"])), "at": robot.fkine(space["q_pickup"]).A.tolist()}
    state["goal"] = space["Tep"].A.tolist()
print("\\n@" + json.dumps(state))
"""


def end_of(script: Path, tmp_path: Path) -> tuple[dict[str, Any], str]:
    """What a script leaves behind, and what it printed, without a screen."""
    driver = tmp_path / "driver.py"
    driver.write_text(DRIVER)
    done = subprocess.run(
        [sys.executable, "-m", "ulna", "run", str(driver), str(script)],
        env={**os.environ, "ULNA_HEADLESS": "1", "MPLBACKEND": "Agg"},
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=600,
        stdin=subprocess.DEVNULL,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.rpartition("\n@")[2]), done.stdout


def test_script_1_prints_a_table(tmp_path: Path) -> None:
    _, said = end_of(SCRIPTS / "rtb_example1.py", tmp_path)
    assert "panda_link7" in said and "qr" in said


def test_script_2_moves_the_robot(tmp_path: Path) -> None:
    state, _ = end_of(SCRIPTS / "rtb_example2.py", tmp_path)
    assert np.abs(np.array(state["q"]) - [0.5, -0.3, 0, -2.2, 0, 2.0, np.pi / 4 + 0.5]).max() < 1e-12


ENDS = {
    # steps, their length [s] and where the arm ends in roboticstoolbox 1.5.0 with swift 2.1.0
    "rtb_example3": (
        431,
        0.01,
        [-0.2146009353914437, 0.8461450364946989, -0.07430635499818788, -1.446805639781611, 0.11869983928082116,
         2.384906768370784, 0.44162635248722576],
    ),
    "rtb_example4": (
        4317,
        0.01,
        [-0.21481364495007296, 0.8459156502308218, -0.07397826645852187, -1.4469917107996284, 0.1183390994114961,
         2.384891604948844, 0.4418592235948408],
    ),
    "rtb_example5": (
        429,
        0.005,
        [-0.20288685038055065, 0.8893757510722367, -0.055580901889027375, -1.5279816689546795, 0.11282947408123413,
         2.510970774172132, 0.46157067136974383],
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", ENDS)
def test_servo_loops_end_where_the_toolbox_ends(name: str, tmp_path: Path) -> None:
    steps, dt, q = ENDS[name]
    state, _ = end_of(SCRIPTS / f"{name}.py", tmp_path)
    assert round(state["time"] / dt) == steps
    assert np.abs(np.array(state["q"]) - q).max() < 1e-9
    assert state["alphas"] == (
        [["visual", 0.5], ["collision", 0.5]] if name.endswith("4") else [["visual", 1.0]]
    )


def test_holding_within_the_loop_as_the_document_has_it(tmp_path: Path) -> None:
    text = (SCRIPTS / "rtb_example3.py").read_text()
    script = tmp_path / "printed.py"
    script.write_text(text.replace("\nenv.hold()", "\n    env.hold()"))
    state, said = end_of(script, tmp_path)
    assert round(state["time"] / 0.01) == 431 and said.count("There is no screen") == 1


def test_script_6_plans_and_plays(tmp_path: Path) -> None:
    state, _ = end_of(SCRIPTS / "rtb_example6.py", tmp_path)
    assert np.abs(np.array(state["at"]) - state["goal"]).max() < 1e-3


def test_script_6_writes_a_film_of_the_right_speed(tmp_path: Path) -> None:
    image = pytest.importorskip("PIL.Image")
    text = (SCRIPTS / "rtb_example6.py").read_text()
    assert text.count("#robot.plot") == 1
    script = tmp_path / "film.py"
    script.write_text(text.replace("#robot.plot", "robot.plot"))
    end_of(script, tmp_path)
    with image.open(tmp_path / "panda1.gif") as film:
        assert film.n_frames == 50 and film.info["duration"] == 50
