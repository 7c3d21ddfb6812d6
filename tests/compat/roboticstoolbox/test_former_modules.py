"""Pickles written before the package was divided into folders load: their modules are found by their former names."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

SCRIPT = """
import pickle, sys
import roboticstoolbox as rtb
import numpy as np

FORMER = {
    "_et": "_ets.elementary_transform", "_ets": "_ets.ets", "_link": "_links.link", "_gripper": "_links.gripper",
    "_copies": "_mixins.copying", "_ik": "_ets.ik_solution", "_robot": "_robots.robot",
    "_dh": "_robots.dh_links", "_planar": "_robots.planar_robot", "_poe": "_robots.poe_robot",
}
arm = rtb.DHRobot([rtb.RevoluteDH(a=0.3, m=1.0), rtb.PrismaticMDH(qlim=[0, 1])][:1], name="arm")
tree = rtb.Robot(rtb.ETS([rtb.ET.Rz(), rtb.ET.tx(0.5), rtb.ET.Ry(), rtb.ET.SE3(np.eye(4))]), name="tree")
screws = rtb.PoERobot([rtb.PoERevolute([0, 0, 1], [0, 0, 0])], np.eye(4))
flat = rtb.models.ETS.Planar2()
things = [
    rtb.ET.Rx(0.1), rtb.ET2.R(), tree.ets(), flat.ets(), tree, arm, screws, flat,
    rtb.IKSolution(np.zeros(2), True), rtb.IK_LM(), rtb.models.Panda(),
]
text = pickle.dumps(things, protocol=0)
for former, present in FORMER.items():
    text = text.replace(f"croboticstoolbox.{present}\\n".encode(), f"croboticstoolbox.{former}\\n".encode())
text = text.replace(b"croboticstoolbox._robots.dh_robot\\n", b"croboticstoolbox._dh\\n")
text = text.replace(b"croboticstoolbox._ik.solvers\\n", b"croboticstoolbox._solvers\\n")
assert b"_robots." not in text and b"_ets." not in text and b"_links." not in text and b"_mixins." not in text
open(sys.argv[1], "wb").write(text)
print("|".join(repr(thing).partition(" at 0x")[0] for thing in things))
"""
LOAD = """
import pickle, sys
things = pickle.load(open(sys.argv[1], "rb"))
print("|".join(repr(thing).partition(" at 0x")[0] for thing in things))
assert type(things[2]._robot()).__name__ == "Robot" and type(things[3]._robot()).__name__ == "Robot2"
assert type(things[0] * things[0]).__name__ == "ETS"
"""


def run(tmp_path: Path, script: str) -> str:
    file = tmp_path / "script.py"
    file.write_text(script)
    command = [sys.executable, "-m", "ulna", "run", str(file), str(tmp_path / "robots.pickle")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_pickles_of_former_modules_load(tmp_path: Path) -> None:
    assert run(tmp_path, SCRIPT) == run(tmp_path, LOAD)
