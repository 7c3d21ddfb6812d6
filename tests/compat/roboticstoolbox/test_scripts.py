"""Scripts as people write them run through `ulna run`, without a screen; what is not offered says what to use."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("matplotlib")
pytest.importorskip("spatialmath")
pytest.importorskip("PIL")
pytest.importorskip("sympy")

FIRST = """
import roboticstoolbox as rtb
robot = rtb.models.Panda()
print(robot)
robot.plot(robot.qr, block=True)
"""

SIXTH = """
import roboticstoolbox as rtb
from spatialmath import SE3
robot = rtb.models.Panda()
Te = robot.fkine(robot.qr)
Tep = SE3.Trans(0.6, -0.3, 0.1) * SE3.OA([0, 1, 0], [0, 0, -1])
sol = robot.ik_LM(Tep)
q_pickup = sol[0]
assert sol.success and abs(robot.fkine(q_pickup).A - Tep.A).max() < 1e-5
qt = rtb.jtraj(robot.qr, q_pickup, 5)
robot.plot(qt.q, backend="pyplot", movie="panda1.gif")
robot.plot(qt.q)
from PIL import Image
film = Image.open("panda1.gif")
times = []
for k in range(film.n_frames):
    film.seek(k)
    times.append(film.info["duration"])
print(film.n_frames, sum(times))
"""

SYMBOLS = """
import numpy as np, roboticstoolbox as rtb, sympy
from roboticstoolbox import ET
q, at = sympy.symbols("q:7"), np.linspace(-1.0, 1.0, 7)
def valued(formula, n):
    return np.array(sympy.Matrix(formula).subs(dict(zip(q[:n], at))), dtype=float)
e = ET.Rz() * ET.tx(1) * ET.Rz() * ET.tx(0.5)
puma, panda = rtb.models.DH.Puma560(), rtb.models.ETS.Panda()
for robot, n in ((e, 2), (puma, 6), (panda, 7)):
    assert np.allclose(valued(robot.fkine(q[:n]).A, n), robot.fkine(at[:n]).A, atol=1e-12)
    assert np.allclose(valued(robot.jacob0(list(q[:n])), n), robot.jacob0(at[:n]), atol=1e-12)
    assert np.allclose(valued(robot.jacobe(np.array(q[:n])), n), robot.jacobe(at[:n]), atol=1e-12)
assert np.allclose(valued(e.eval(q[:2]), 2), e.eval(at[:2]))
assert sympy.simplify(ET.Rz().A(q[0])[0, 0] - sympy.cos(q[0])) == 0
assert np.allclose(valued(puma.links[0].A(q[0]).A, 1), puma.links[0].A(at[0]).A)
for wrong, word in ((q[:1], "symbols for one"), (["a", "b"], "numbers")):
    try:
        e.eval(wrong)
    except (TypeError, ValueError) as error:
        assert word in str(error), error
    else:
        raise AssertionError(wrong)
print("fine")
"""

COLLISION = """
import numpy as np, roboticstoolbox as rtb, spatialgeometry as sg, spatialmath as sm
robot = rtb.models.Panda()
q = robot.qr
assert not robot.isselfcollided(q)
ball = sg.Sphere(0.05, pose=sm.SE3(0.5, 0.2, 0.45))
d, p, w = robot.closest_point(q, ball)
assert np.isclose(np.linalg.norm(w - p), d) and not robot.iscollided(q, ball)
A, b = robot.link_collision_damper(ball, q, di=0.3, ds=0.05, xi=2.0)
near = d
step = 1e-6 * A[np.argmin(b)]
assert np.isclose((robot.closest_point(q + step, ball)[0] - near) / 1e-6, -A[np.argmin(b)] @ A[np.argmin(b)], rtol=1e-3)
assert np.isclose(b.min(), 2.0 * (d - 0.05) / 0.25)
ball.T = sm.SE3(5.0, 0.0, 0.0)
assert robot.closest_point(q, ball) == (None, None, None)
assert robot.link_collision_damper(ball, q) == (None, None)
q2 = q.copy(); q2[3] = -0.12; q2[5] = 3.7
A, b = robot.joint_velocity_damper(q2)
assert np.allclose(b, [0, 0, 0, 0.004, 0, 0.05, 0]) and A[3, 3] == 1 and A[5, 5] == 1
print("fine")
"""

STATE = """
import copy, pickle, numpy as np, roboticstoolbox as rtb
robot = rtb.models.Panda()
robot.q = robot.qr
robot.qd = [0.1] * 7
twin = pickle.loads(pickle.dumps(robot))
other = copy.deepcopy(robot)
for one in (twin, other, robot.copy()):
    assert np.array_equal(one.q, robot.qr) and np.array_equal(one.qd, robot.qd)
    assert np.array_equal(one.fkine(one.q).A, robot.fkine(robot.q).A)
    assert np.allclose(one.gravload(one.q), robot.gravload(robot.q))
other.links[3].m = 50.0
assert not np.allclose(other.gravload(other.q), robot.gravload(robot.q))
other.grippers[0].tool = np.eye(4)
assert not np.allclose(other.fkine(other.q).A, robot.fkine(robot.q).A)
for name, word in (("DstarPlanner", "arms"), ("nonsense", "nonsense")):
    try:
        getattr(rtb, name)
    except AttributeError as error:
        assert word in str(error), error
    else:
        raise AssertionError(name)
for name, word in (("pay", "payload"), ("ikine_LMS", "ikine_LM"), ("nonsense", "nonsense")):
    try:
        getattr(robot, name)
    except AttributeError as error:
        assert word in str(error), error
    else:
        raise AssertionError(name)
print("fine")
"""

SHAPES = """
import pickle, numpy as np, roboticstoolbox as rtb, spatialgeometry as sg
from spatialmath import SE3
robot, ball = rtb.models.Panda(), sg.Sphere(0.05, pose=SE3(0.52, 0.4, 0.3))
robot.q = robot.qr
links = [*robot.links, *robot.grippers[0].links]
far = robot.closest_point(robot.q, ball)[0]
for one in (robot, pickle.loads(pickle.dumps(robot))):
    each = [solid.closest_point(ball)[0] for link in [*one.links, *one.grippers[0].links] for solid in link.collision]
    assert np.isclose(min(x for x in each if x is not None), far)
    assert np.isclose(one.closest_point(one.q, ball)[0], far)
twin = robot.copy()
twin.q = twin.qz
moved, stayed = twin.links[4].collision[0], robot.links[4].collision[0]
assert isinstance(stayed, sg.Shape) and not np.allclose(moved._wT, stayed._wT)
link = rtb.Link(rtb.ET.Rz(), name="a", collision=[sg.Cuboid([0.1, 0.1, 0.1], pose=SE3.Tx(0.5))])
own = rtb.Robot([link])
assert np.isclose(own.closest_point([np.pi / 2], sg.Sphere(0.1, pose=SE3(0, 1, 0)))[0], 0.35)
link.collision = [sg.Sphere(0.2)]
assert np.isclose(own.closest_point([np.pi / 2], sg.Sphere(0.1, pose=SE3(0, 1, 0)))[0], 0.7)
arm = rtb.models.URDF.px100()
q = np.linspace(-1.0, 1.0, arm.n)
def height(q):
    return sum(link.m * 9.81 * (arm.fkine(q, end=link.name).A @ [*link.r, 1.0])[2] for link in arm.links)
slope = [(height(q + 1e-6 * e) - height(q - 1e-6 * e)) / 2e-6 for e in np.eye(arm.n)]
assert np.allclose(arm.gravload(q), slope, atol=1e-8)
panda = rtb.models.Panda()
rise = [(panda.manipulability(panda.qr + 1e-6 * e, axes="trans") - panda.manipulability(panda.qr - 1e-6 * e, axes="trans")) / 2e-6 for e in np.eye(7)]
assert np.allclose(panda.jacobm(panda.qr, axes="trans").ravel(), rise, atol=1e-8)
print("fine")
"""


@pytest.mark.parametrize(
    ("script", "said"),
    [
        (FIRST, "panda_link8"),
        (SIXTH, "5 250"),
        (SYMBOLS, "fine"),
        (COLLISION, "fine"),
        (STATE, "fine"),
        (SHAPES, "fine"),
    ],
)
def test_runs_to_the_end(script: str, said: str, tmp_path: Path) -> None:
    file = tmp_path / "script.py"
    file.write_text(script)
    bare = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}
    done = subprocess.run(
        [sys.executable, "-m", "ulna", "run", str(file)],
        env=bare | {"MPLBACKEND": "agg"},
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert said in done.stdout


def test_importing_the_face_does_not_import_spatialmath_or_matplotlib(tmp_path: Path) -> None:
    file = tmp_path / "script.py"
    file.write_text(
        "import sys, roboticstoolbox as rtb\nrtb.models.Panda()\n"
        "print([m for m in ('spatialmath', 'matplotlib', 'scipy') if m in sys.modules])\n"
    )
    command = [sys.executable, "-m", "ulna", "run", str(file)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600, check=True)
    assert done.stdout.strip() == "[]"
