"""The Robotics Toolbox's calls through the face against the toolbox itself: two processes that take turns.

Run: python benchmarks/face_roboticstoolbox.py
"""

from __future__ import annotations

import json
import os
import statistics
import subprocess
import sys
import time
from typing import Any

from _timing import medians, shown, table

from ulna.faces.shelves import environment

ROUNDS = 7
IMPORTS = 5


def worker() -> None:
    """Measures each call once for every line that comes in; answers with medians by name."""
    import numpy as np
    import roboticstoolbox as rtb

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
    for f in calls.values():
        f()
    print("ready", flush=True)
    for _ in sys.stdin:
        found = medians(list(calls.values()), repeat=3, seconds=0.005)
        print(json.dumps(dict(zip(calls, found, strict=True))), flush=True)


def seconds_to_import(env: dict[str, str]) -> float:
    """How long `import roboticstoolbox` takes in a new Python [s], less what Python itself takes."""
    took = []
    for code in ("pass", "import roboticstoolbox"):
        start = time.perf_counter()
        subprocess.run([sys.executable, "-c", code], env=env, check=True)
        took.append(time.perf_counter() - start)
    return took[1] - took[0]


def main() -> None:
    """Prints the tables."""
    variables = {"face": environment(["roboticstoolbox"]), "toolbox": dict(os.environ)}
    command = [sys.executable, __file__, "--worker"]
    pipes: dict[str, Any] = {
        "stdin": subprocess.PIPE,
        "stdout": subprocess.PIPE,
        "stderr": subprocess.DEVNULL,
    }
    running = {who: subprocess.Popen(command, env=env, text=True, **pipes) for who, env in variables.items()}
    samples: dict[str, list[dict[str, float]]] = {who: [] for who in running}
    for process in running.values():
        process.stdout.readline()  # type: ignore[union-attr]
    for _ in range(ROUNDS):
        for who, process in running.items():
            process.stdin.write("go\n")  # type: ignore[union-attr]
            process.stdin.flush()  # type: ignore[union-attr]
            samples[who].append(json.loads(process.stdout.readline()))  # type: ignore[union-attr]
    for process in running.values():
        process.stdin.close()  # type: ignore[union-attr]
        process.wait()
    rows = []
    for name in samples["toolbox"][0]:
        ours, theirs = (statistics.median(s[name] for s in samples[who]) for who in ("face", "toolbox"))
        rows.append([f"`{name}`", shown(ours), shown(theirs), f"{theirs / ours:.1f}"])
    imports: dict[str, list[float]] = {who: [] for who in variables}
    for _ in range(IMPORTS):
        for who, env in variables.items():
            imports[who].append(seconds_to_import(env))
    ours, theirs = (statistics.median(imports[who]) for who in ("face", "toolbox"))
    rows.append(["`import roboticstoolbox`", shown(ours), shown(theirs), f"{theirs / ours:.1f}"])
    print(table("The toolbox's calls", ["call", "face", "toolbox", "ratio"], rows))


if __name__ == "__main__":
    worker() if "--worker" in sys.argv else main()
