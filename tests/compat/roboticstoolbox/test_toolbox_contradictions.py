"""Where documented differences call the toolbox wrong, its results contradict each other: shown with the toolbox itself."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

pytest.importorskip("roboticstoolbox")
SCRIPT = """
import json
import numpy as np, roboticstoolbox as rtb
from spatialmath import SE3
q = np.array([0.2, -0.4, 0.3, -1.8, 0.4, 1.7])
p, h = np.array([0.2, -0.4, 0.3, -1.8, 0.4, 1.7, 0.5]), 1e-6
puma, tooled, panda = rtb.models.DH.Puma560(), rtb.models.DH.Puma560(), rtb.models.Panda()
tooled.tool = SE3(0.1, 0, 0.2)
def turned(robot):
    R, H = robot.fkine(q).R.T, robot.hessian0(q)
    return np.concatenate([R @ H[:, :3], R @ H[:, 3:]], axis=1)
change = [(panda.hessian0(p + h * e) - panda.hessian0(p - h * e)) / (2 * h) for e in np.eye(7)]
inertia = np.diag(puma.inertia(q)) / [link.G**2 for link in puma.links]
jaco = rtb.models.DH.Jaco()
held = rtb.Robot(panda.ets(), tool=SE3(0, 0.1, 0))
J = held.jacob0(p)[:3]
longer = rtb.ET.Rz() * rtb.ET.tx(1)
longer.append(rtb.ET.Rx())
def arm(**first):
    body = dict(m=1.5, r=[0.1, 0.02, 0.03], I=[0.02, 0.03, 0.04, 0, 0, 0])
    return rtb.DHRobot([rtb.RevoluteMDH(**first, **body), rtb.RevoluteMDH(a=0.4, alpha=0.2, **body)])
still = (p[:2], p[:2], p[:2])
def sliding(first, second):
    body = dict(m=1.5, r=[0.1, 0.02, 0.03], I=[0.02, 0.03, 0.04, 0, 0, 0])
    return rtb.DHRobot([first(theta=0.4, alpha=0.6, **body), second(a=0.4, alpha=0.3, **body)])
def weight(robot, x):
    return sum(link.m * (T.A @ [*link.r, 1.0])[0] for link, T in zip(robot.links, list(robot.fkine_all(x))[1:]))
gantry, modified = sliding(rtb.PrismaticDH, rtb.RevoluteDH), sliding(rtb.PrismaticMDH, rtb.RevoluteMDH)
slope = [(weight(gantry, p[:2] + h * e) - weight(gantry, p[:2] - h * e)) / (2 * h) for e in np.eye(2)]
M = modified.inertia(p[:2])
moments = [arm(**first).rne(*still, base_wrench=True)[1] for first in ({}, {"d": 0.3})]
print(json.dumps({
    "manipulability is of jacob0": bool(np.isclose(held.manipulability(p, axes="trans"), np.sqrt(np.linalg.det(J @ J.T)))),
    "manipulability up to a gripper": float(panda.manipulability(p, end=panda.grippers[0])),
    "an appended joint": [str(longer), bool(np.allclose(longer.eval([0.3, 0.9]), longer.eval([0.3, 0.1])))],
    "a higher arm, the same moment": bool(np.allclose(*moments)),
    "start is ignored": np.array_equal(puma.hessian0(q, start=puma.links[3]), puma.hessian0(q)),
    "hessiane is hessian0 turned": bool(np.allclose(puma.hessiane(q), turned(puma))),
    "with a tool, too": bool(np.allclose(tooled.hessiane(q), turned(tooled))),
    "error of third derivatives": float(np.abs(panda.partial_fkine0(p, 3) - change).max()),
    "gravity of a gantry": float(np.abs(gantry.gravload(p[:2], gravity=[1.0, 0, 0]) + slope).max()),
    "asymmetry of inertia": float(np.abs(M - M.T).max()),
    "cinertia is None": puma.cinertia(q) is None,
    "reach is less than a distance": bool(jaco.reach < np.linalg.norm(jaco.fkine(np.zeros(6)).t)),
    "motors of jointdynamics": [d[1][0] for d in puma.jointdynamics(q)] / inertia - 1.0 > 0.2,
}, default=lambda x: x.tolist()))
"""


@pytest.mark.slow
def test_results_of_the_toolbox_contradict_each_other() -> None:
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT], capture_output=True, text=True, timeout=600, check=True
    )
    found = json.loads(done.stdout.splitlines()[-1])
    assert found["start is ignored"] and found["cinertia is None"] and found["reach is less than a distance"]
    assert found["hessiane is hessian0 turned"] and not found["with a tool, too"]
    assert found["error of third derivatives"] > 0.5
    assert found["gravity of a gantry"] > 0.1 and found["asymmetry of inertia"] > 0.05
    assert all(found["motors of jointdynamics"])
    assert not found["manipulability is of jacob0"] and found["manipulability up to a gripper"] == 0.0
    assert found["an appended joint"] == ["Rz(q0) ⊕ tx(1) ⊕ Rx(q1)", True]
    assert found["a higher arm, the same moment"]
