"""Pinocchio's calls through the face, beside real Pinocchio: each package in a separate Python process, taking turns.

python benchmarks/compat_pinocchio.py [--markdown]
"""

from __future__ import annotations

import json
import statistics
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

from _pair import environments

ROBOTS = {"UR5": "ur5", "Panda": "panda", "Solo12": "solo12", "Talos": "talos"}
FLOATING = ("solo12", "talos")
ROUNDS = 41
SPAN = 2e-4  # of each measurement [s]: short, so that few are interrupted where other work runs beside
CALLS = {
    "forwardKinematics, oMi[-1] read": "pin.forwardKinematics(m, d, q); d.oMi[end].translation",
    "forwardKinematics(q, v, a)": "pin.forwardKinematics(m, d, q, v, a)",
    "getFrameVelocity": "pin.getFrameVelocity(m, d, last, pin.LOCAL)",
    "getFrameAcceleration": "pin.getFrameAcceleration(m, d, last, pin.LOCAL)",
    "framesForwardKinematics": "pin.framesForwardKinematics(m, d, q)",
    "updateFramePlacements": "pin.updateFramePlacements(m, d)",
    "computeJointJacobians": "pin.computeJointJacobians(m, d, q)",
    "getJointJacobian": "pin.getJointJacobian(m, d, end, pin.LOCAL)",
    "getFrameJacobian": "pin.getFrameJacobian(m, d, last, pin.LOCAL)",
    "computeJointJacobian": "pin.computeJointJacobian(m, d, q, end)",
    "computeFrameJacobian": "pin.computeFrameJacobian(m, d, q, last, pin.LOCAL_WORLD_ALIGNED)",
    "rnea": "pin.rnea(m, d, q, v, a)",
    "rnea with forces": "pin.rnea(m, d, q, v, a, fext)",
    "crba": "pin.crba(m, d, q)",
    "aba": "pin.aba(m, d, q, v, tau)",
    "aba with forces": "pin.aba(m, d, q, v, tau, fext)",
    "nonLinearEffects": "pin.nonLinearEffects(m, d, q, v)",
    "computeGeneralizedGravity": "pin.computeGeneralizedGravity(m, d, q)",
    "computeCoriolisMatrix": "pin.computeCoriolisMatrix(m, d, q, v)",
    "computeMinverse": "pin.computeMinverse(m, d, q)",
    "computeAllTerms": "pin.computeAllTerms(m, d, q, v)",
    "computeRNEADerivatives": "pin.computeRNEADerivatives(m, d, q, v, a)",
    "computeABADerivatives": "pin.computeABADerivatives(m, d, q, v, tau)",
    "centerOfMass": "pin.centerOfMass(m, d, q)",
    "jacobianCenterOfMass": "pin.jacobianCenterOfMass(m, d, q)",
    "ccrba": "pin.ccrba(m, d, q, v)",
    "computeKineticEnergy": "pin.computeKineticEnergy(m, d, q, v)",
    "integrate": "pin.integrate(m, q, v)",
    "difference": "pin.difference(m, q, k)",
    "randomConfiguration": "pin.randomConfiguration(m, low, high)",
    "LieGroup.integrate": "group.integrate(q, v)",
    "LieGroup.difference": "group.difference(q, k)",
    "getVelocity": "pin.getVelocity(m, d, end, pin.LOCAL)",
    "computeTotalMass": "pin.computeTotalMass(m)",
    "computeSubtreeMasses": "pin.computeSubtreeMasses(m, d)",
    "updateGlobalPlacements": "pin.updateGlobalPlacements(m, d)",
    "jointBodyRegressor": "pin.jointBodyRegressor(m, d, end)",
    "data.Ycrb[-1]": "d.Ycrb[end]",
    "createData": "m.createData()",
    "model.copy": "m.copy()",
    "log6(SE3)": "pin.log6(M)",
    "SE3 * SE3": "M * M",
    "oMi[-1].translation alone": "d.oMi[end].translation",
    "data.M alone": "d.M",
    "buildModelFromUrdf of the same file again": "pin.buildModelFromUrdf(urdf, *roots)",
    "buildReducedModel": "pin.buildReducedModel(m, [end], q)",
    "buildSampleModelHumanoidRandom": "pin.buildSampleModelHumanoidRandom()",
}


def worker(urdf: str, floating: bool) -> None:
    """Answers each line of standard input with the medians [us] of all calls."""
    import numpy as np
    import pinocchio as pin

    roots = [pin.JointModelFreeFlyer()] if floating else []
    m = pin.buildModelFromUrdf(urdf, *roots)
    rng = np.random.default_rng(0)
    q, k = (pin.integrate(m, pin.neutral(m), rng.uniform(-1.0, 1.0, m.nv)) for _ in range(2))
    v, a, tau = rng.normal(size=(3, m.nv))
    d, M = m.createData(), pin.SE3.Random()
    names: dict[str, Any] = {"pin": pin, "m": m, "d": d, "q": q, "k": k, "v": v, "a": a, "tau": tau, "M": M}
    fext = pin.StdVec_Force()
    fext.extend([pin.Force.Random() for _ in range(m.njoints)])
    low, high = np.full(m.nq, -1.0), np.ones(m.nq)
    names |= {"fext": fext, "group": pin.lieGroup(m), "low": low, "high": high}
    names |= {"urdf": urdf, "roots": roots}
    names |= {"end": m.njoints - 1, "last": m.nframes - 1, "clock": time.perf_counter}
    pin.forwardKinematics(m, d, q, v, a)
    pin.framesForwardKinematics(m, d, q)
    pin.computeJointJacobians(m, d, q)
    pin.rnea(m, d, q, v, a)
    pin.crba(m, d, q)
    loops = {}
    for title, call in CALLS.items():
        exec(f"def loop(n):\n start = clock()\n for _ in range(n): {call}\n return clock() - start", names)
        loops[title] = names["loop"]
        loops[title](20)
    counts = {title: min(max(int(SPAN * 20 / loop(20)), 2), 2000) for title, loop in loops.items()}
    for _ in sys.stdin:
        next(iter(loops.values()))(1000)  # awake again
        found = {}
        for title, loop in loops.items():
            loop(1)  # a copied model has frames that are bound anew
            found[title] = loop(counts[title]) / counts[title] * 1e6
        print(json.dumps(found), flush=True)


def main() -> None:
    from ulna.robots.example_robot_data import files

    print(f"{'us a call':<34}" + "".join(f"{name:>24}" for name in ROBOTS))
    print(" " * 34 + f"{'face   pin  ratio':>24}" * len(ROBOTS))
    columns = []
    for key in ROBOTS.values():
        command = [sys.executable, __file__, str(files(key)[0]), str(int(key in FLOATING))]
        pipes: dict[str, Any] = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
        pair = [subprocess.Popen(command, env=env, **pipes) for env in environments("pinocchio")]
        rounds: list[list[dict[str, float]]] = [[], []]
        for _ in range(ROUNDS):
            for process, found in zip(pair, rounds, strict=True):
                assert process.stdin is not None and process.stdout is not None
                process.stdin.write("\n")
                process.stdin.flush()
                found.append(json.loads(process.stdout.readline()))
        for process in pair:
            assert process.stdin is not None
            process.stdin.close()
            process.wait()
        columns.append([{t: statistics.median(r[t] for r in found) for t in CALLS} for found in rounds])
    if "--markdown" in sys.argv:
        for title in CALLS:
            cells = [f"{x:.2g}" for own, real in columns for x in (own[title], real[title])]
            print(f"| {title} | {' | '.join(cells)} |")
        return
    for title in CALLS:
        row = [
            f"{own[title]:6.2f}{real[title]:6.2f}{real[title] / own[title]:6.2f}x" for own, real in columns
        ]
        print(f"{title:<34}" + "".join(f"{cell:>24}" for cell in row))


if __name__ == "__main__":
    if len(sys.argv) == 3 and Path(sys.argv[1]).suffix == ".urdf":
        worker(sys.argv[1], sys.argv[2] == "1")
    else:
        main()
