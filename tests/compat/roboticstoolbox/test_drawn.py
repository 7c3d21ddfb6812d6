"""Robots are drawn, taught and attached without a screen: in matplotlib and in the viewer, with and without shapes."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("matplotlib")
pytest.importorskip("spatialmath")

STICKS = """
import numpy as np, roboticstoolbox as rtb, swift
for robot in (rtb.models.DH.Panda(), rtb.models.DH.Puma560(), rtb.models.ETS.Panda(), rtb.models.ETS.Planar2()):
    env = swift.Swift()
    env.launch()
    handle = env.add(robot)
    assert [figure.show for figure in handle.figures] == ["skeleton"]
    env.step(0.05)
    assert type(robot.plot(np.vstack([robot.q, robot.q + 0.1]), backend="swift")).__name__ == "Swift"
    assert np.allclose(robot.q, robot.configs.get("none", robot.q))
env = swift.Swift()
env.launch()
assert [figure.show for figure in env.add(rtb.models.Panda()).figures] == ["visual"]
print("fine")
"""

TAUGHT = """
import numpy as np, roboticstoolbox as rtb
robot = rtb.models.DH.Puma560()
env = robot.teach(robot.qn, vellipse=True, view="xz")
env.sliders[2].set_val(0.3)
assert np.allclose(robot.q, [*robot.qn[:2], 0.3, *robot.qn[3:]])
env = robot.teach(robot.qn, backend="swift")
env.process_events({env.sliders[0].id: 30.0})
assert np.allclose(robot.q, [np.radians(30.0), *robot.qn[1:]])
flat = rtb.models.ETS.Planar2()
flat.teach(backend="swift", block=False), flat.teach(block=False), flat.plot([0.1, 0.2], backend="pyplot2")
print("fine")
"""

FIGURES = """
import numpy as np, roboticstoolbox as rtb
from roboticstoolbox.backends.PyPlot import PyPlot
from roboticstoolbox.backends.swift import Swift
robot = rtb.models.DH.Puma560()
env = PyPlot()
env.launch("figure", limits=[-1, 1], view="xy")
assert (env.ax.elev, env.ax.azim) == (90, -90)  # from above, x to the right
for view, direction in (("xz", (0, -90)), ("yz", (0, 0))):
    other = PyPlot()
    other.launch(view=view)
    assert (other.ax.elev, other.ax.azim) == direction
env.add(robot)
before = np.asarray(env.getframe())
robot.q, robot.qd = robot.qn, 0.1 * np.ones(6)
env.step(0.5)
assert np.allclose(robot.q, np.clip(robot.qn + 0.05, *robot.qlim)) and (np.asarray(env.getframe()) != before).any()
number = env.add(robot.vellipse(robot.q))
import matplotlib.pyplot as plt
figures = [robot.plot(q, block=False).fig for q in (robot.qz, robot.qn)]  # in one window, as in the toolbox
assert figures[0] is figures[1] and len(figures[0].axes) == 1
assert env.getframe().mode == "RGB" and env.getframe().size == (640, 480)
env.remove(number)
env.reset()
robot.default_backend = "swift"
assert isinstance(robot.plot(robot.qn), type(rtb.backends.load_backend("swift")))
rtb.Robot.set_default_backend("pyplot")
assert isinstance(rtb.models.Panda().plot(np.zeros(7)), PyPlot)
J, shell = robot.jacob0(robot.qn), robot.vellipse(robot.qn, scale=2.0)
x = (shell.points - shell.centre[:, None, None]) / 2.0
assert np.allclose(np.einsum("iab,ij,jab->ab", x, np.linalg.inv(J[:3] @ J[:3].T), x), 1.0)
assert robot.linkcolormap(["r", "g", "b", "c", "m", "y"]).N == 6
for name in ("nonsense", "ROS"):
    try:
        getattr(rtb.backends, name)
    except AttributeError as error:
        assert name in str(error)
print("fine")
"""

ATTACHED = """
import copy, pickle, numpy as np, roboticstoolbox as rtb, spatialgeometry as sg, spatialmath as sm, swift
truck, arm = rtb.models.Panda(), rtb.models.DH.Puma560()
arm.attach_to(truck.links[8])
ball = sg.Sphere(0.05, pose=sm.SE3(0, 0, 0.1))
arm.links[5].attach(ball)
env = swift.Swift()
env.launch()
env.add(truck)
handle = env.add(arm)
truck.q = truck.qr
env.step(0.0)
expected = truck.fkine(truck.q, end="panda_link8").A @ arm.fkine(arm.q).A @ sm.SE3(0, 0, 0.1).A
assert np.allclose(ball._wT, expected)
assert np.allclose(handle.part_poses()[-1].A, truck.fkine(truck.q, end="panda_link8").A @ arm.fkine(arm.q).A)
for twin in (copy.deepcopy(arm), pickle.loads(pickle.dumps(arm))):
    assert twin.scene_parent is None and np.allclose(twin.fkine(twin.q).A, arm.fkine(arm.q).A)
try:
    truck.attach_to(arm.links[2])
except ValueError as error:
    assert "circles" in str(error)
else:
    raise AssertionError("a circle")
print("fine")
"""

DESCRIBED = """
import numpy as np, roboticstoolbox as rtb
from roboticstoolbox.models.URDF.URDFRobot import URDFRobot
assert rtb.models.URDF.URDFRobot is URDFRobot
for name, joints in (("UR3", 6), ("UR5", 6), ("UR10", 6), ("PR2", None), ("Frankie", 7)):
    robot = getattr(rtb.models, name)()
    assert joints in (None, robot.n) and robot.qr.shape == (robot.n,) and robot.hasdynamics
same = URDFRobot("ur10", gripper_link_name="tool0")
ten = rtb.models.UR10()
assert np.allclose(same.fkine(ten.qr).A, ten.fkine(ten.qr).A)
ten = rtb.models.DH.UR10()
solver = ten.analytic_ik()
found = solver.solve(ten.fkine(ten.q + 0.5), joint_limits=False)
assert len(found) == 8 and all(np.allclose(ten.fkine(q).A, ten.fkine(ten.q + 0.5).A, atol=1e-8) for q in found)
path = ten.fkine(np.linspace(ten.q + 0.5, ten.q + 0.7, 5))
assert np.allclose(ten.ikine_analytic(path, q0=ten.q + 0.5).q, np.linspace(ten.q + 0.5, ten.q + 0.7, 5), atol=1e-7)
assert solver.validate(5) == 1.0
rtb.models.catalog(mtype="URDF")
print("fine")
"""


def _run(script: str, folder: Path) -> str:
    file = folder / "script.py"
    file.write_text(script)
    bare = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-m", "ulna", "run", str(file)],
        env=bare | {"MPLBACKEND": "agg", "SWIFT_HEADLESS": "1"},
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize(
    "script", [STICKS, TAUGHT, FIGURES, ATTACHED], ids=["sticks", "taught", "figures", "attached"]
)
def test_runs_without_a_screen(script: str, tmp_path: Path) -> None:
    assert _run(script, tmp_path).rstrip().endswith("fine")


def test_robots_that_others_describe(tmp_path: Path) -> None:
    from ulna.robots import example_robot_data

    if example_robot_data.share_folder() is None:
        pytest.skip("example-robot-data is not installed")
    assert _run(DESCRIBED, tmp_path).rstrip().endswith("fine")
