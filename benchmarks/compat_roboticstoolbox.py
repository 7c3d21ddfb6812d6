"""The Robotics Toolbox's calls through the face against the toolbox itself: two processes that take turns.

Run: python benchmarks/compat_roboticstoolbox.py

Each has its own Swift, without a page; where swift-sim is not installed, the loops that step it have no ratio.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any

from _pair import answer_rounds, environments, in_turns
from _timing import medians, shown, table

ROUNDS = 7
STARTS = 7
IMPORT = "import roboticstoolbox"
FIRST = """
import roboticstoolbox as rtb
from spatialmath import SE3
panda = rtb.models.Panda()
T = panda.fkine(panda.qr)
J = panda.jacob0(panda.qr)
panda.ik_LM(T * SE3.Tx(0.01), q0=panda.qr)
"""


def prepared() -> Callable[[], dict[str, float]]:
    """What measures each call once: medians by name [s]."""
    import numpy as np
    import roboticstoolbox as rtb
    from spatialmath import SE3

    panda, puma, arm = rtb.models.Panda(), rtb.models.DH.Puma560(), rtb.models.DH.Panda()
    frames = rtb.models.URDF.px100() if hasattr(rtb.models.URDF, "px100") else None
    q, qn = panda.qr, puma.qn
    many = np.random.default_rng(0).uniform(-1.0, 1.0, (1000, 7))
    T, goal = panda.fkine(q), panda.fkine(q + 0.1)
    poses = [panda.fkine(panda.random_q()) for _ in range(20)]
    ets = panda.ets()
    v, a = 0.1 * np.ones(6), 0.2 * np.ones(6)
    panda.q = q

    def servo() -> Any:
        twist, _ = rtb.p_servo(panda.fkine(panda.q), goal, gain=1, threshold=0.01)
        panda.qd = np.linalg.pinv(panda.jacobe(panda.q)) @ twist

    calls: dict[str, Any] = {
        "Panda.fkine": lambda: panda.fkine(q),
        "Panda.fkine, 1000 rows": lambda: panda.fkine(many),
        "Panda.ets().eval": lambda: ets.eval(q),
        "Panda.jacob0": lambda: panda.jacob0(q),
        "Panda.jacobe": lambda: panda.jacobe(q),
        "Panda.hessian0": lambda: panda.hessian0(q),
        "Panda.jacob0_dot": lambda: panda.jacob0_dot(q, q),
        "Panda.jacob0_analytical": lambda: panda.jacob0_analytical(q),
        "Panda.manipulability": lambda: panda.manipulability(q),
        "Panda.jacobm": lambda: panda.jacobm(q),
        "Panda.fkine_all": lambda: panda.fkine_all(q),
        "Panda.ik_LM from near": lambda: panda.ik_LM(goal, q0=q),
        "Panda.ik_LM, 20 random poses": lambda: [panda.ik_LM(pose) for pose in poses],
        "p_servo": lambda: rtb.p_servo(T, goal),
        "servo step: fkine, p_servo, jacobe, pinv": servo,
        "jtraj, 50 points": lambda: rtb.jtraj(q, panda.qz, 50),
        "ctraj, 50 points": lambda: rtb.ctraj(T, goal, 50),
        "DH.Panda.fkine": lambda: arm.fkine(q),
        "DH.Panda.jacob0": lambda: arm.jacob0(q),
        "DH.Puma560.rne": lambda: puma.rne(qn, v, a),
        "DH.Puma560.inertia": lambda: puma.inertia(qn),
        "DH.Puma560.gravload": lambda: puma.gravload(qn),
        "DH.Puma560.accel": lambda: puma.accel(qn, v, a),
        "DH.Puma560.coriolis": lambda: puma.coriolis(qn, v),
    }
    if frames is not None and frames.hasdynamics:
        w = 0.1 * np.ones(frames.n)
        calls["URDF.px100.rne"] = lambda: frames.rne(w, w, w)
        calls["URDF.px100.inertia"] = lambda: frames.inertia(w)
    try:
        import swift
    except ImportError:
        print("Without swift-sim.", file=sys.stderr)
    else:
        env = swift.Swift()
        env.launch(headless=True, realtime=False)
        shown_robot = rtb.models.Panda()
        shown_robot.q = shown_robot.qr
        env.add(shown_robot)
        far = shown_robot.fkine(shown_robot.q) * SE3.Tx(0.2) * SE3.Ty(0.2) * SE3.Tz(0.35)

        def example() -> None:
            v, _ = rtb.p_servo(shown_robot.fkine(shown_robot.q), far, gain=1, threshold=0.01)
            J = shown_robot.jacobe(shown_robot.q)
            shown_robot.qd = np.linalg.pinv(J) @ v
            env.step(0.01)

        calls["example 3: the whole loop, with env.step"] = example
        calls["env.step, one Panda"] = lambda: env.step(0.01)
    for f in calls.values():
        f()
    return lambda: dict(zip(calls, medians(list(calls.values()), repeat=3, seconds=0.005), strict=True))


def seconds_to_run(code: str, env: dict[str, str]) -> float:
    """How long a script takes in a new Python [s], less what Python itself takes."""
    took = []
    for words in ("pass", code):
        start = time.perf_counter()
        subprocess.run([sys.executable, "-c", words], env=env, check=True)
        took.append(time.perf_counter() - start)
    return took[1] - took[0]


def row(name: str, face: float, toolbox: float | None) -> list[str]:
    """A line of the table: seconds of both and their ratio."""
    theirs = ["not installed", ""] if toolbox is None else [shown(toolbox), f"{toolbox / face:.1f}"]
    return [f"`{name}`", shown(face), *theirs]


def main() -> None:
    """Prints the tables."""
    variables = dict(zip(("face", "toolbox"), environments("roboticstoolbox"), strict=True))
    found = in_turns([__file__, "--worker"], variables, ROUNDS)
    rows = [row(name, face, found["toolbox"].get(name)) for name, face in found["face"].items()]
    for name, code in ((IMPORT, IMPORT), ("script: import, Panda, fkine, jacob0, ik_LM once", FIRST)):
        took: dict[str, list[float]] = {who: [] for who in variables}
        for _ in range(STARTS):
            for who, env in variables.items():
                took[who].append(seconds_to_run(code, env))
        rows.append(row(name, statistics.median(took["face"]), statistics.median(took["toolbox"])))
    print(table("The toolbox's calls", ["call", "Ulna", "toolbox", "ratio"], rows))


if __name__ == "__main__":
    answer_rounds(prepared) if "--worker" in sys.argv else main()
