"""Calls of constraints through the Pinocchio face, beside real Pinocchio: each in a separate Python process, taking turns.

python benchmarks/compat_pinocchio_constraints.py        # needs pin and example-robot-data

Solo12 stands on four points, Talos on two frames, along the world's axes.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from typing import Any

from _pair import answer_rounds, environments, in_turns
from _timing import table

ROBOTS = {
    "Solo12": ("solo12", "CONTACT_3D", "FL_KFE,FR_KFE,HL_KFE,HR_KFE"),
    "Talos": ("talos", "CONTACT_6D", "leg_left_6_joint,leg_right_6_joint"),
}
ROUNDS, SPAN = 41, 2e-4
CALLS = {
    "constraintDynamics": "pin.constraintDynamics(m, d, q, v, tau, cs, ds, s)",
    "computeConstraintDynamicsDerivatives": "pin.computeConstraintDynamicsDerivatives(m, d, cs, ds, s)",
    "impulseDynamics": "pin.impulseDynamics(m, d, q, v, cs, ds, 0.3, s)",
    "computeImpulseDynamicsDerivatives": "pin.computeImpulseDynamicsDerivatives(m, d, cs, ds, 0.3, s)",
    "getConstraintJacobian": "pin.getConstraintJacobian(m, d, c, x)",
    "getConstraintsJacobian": "pin.getConstraintsJacobian(m, d, cs, ds)",
    "computeDelassusMatrix": "pin.computeDelassusMatrix(m, d, q, cs, ds, 0.0)",
    "forwardDynamics(q, v, tau, J, drift)": "pin.forwardDynamics(m, d, q, v, tau, J, drift)",
    "forwardDynamics(tau, J, drift)": "pin.forwardDynamics(m, d, tau, J, drift)",
    "impulseDynamics(q, v, J)": "pin.impulseDynamics(m, d, q, v, J)",
    "ContactCholeskyDecomposition.compute": "chol.compute(m, d, cs, ds, 1e-6)",
    "the same, and solve": "chol.compute(m, d, cs, ds, 1e-6); chol.solve(b)",
    "the same, and inverse": "chol.compute(m, d, cs, ds, 1e-6); chol.inverse()",
    "U": "chol.U",
    "matrix": "chol.matrix()",
    "getInverseMassMatrix": "chol.getInverseMassMatrix()",
    "getOperationalSpaceInertiaMatrix": "chol.getOperationalSpaceInertiaMatrix()",
    "solve of its Delassus operator": "G.solve(drift)",
    "computeDampedDelassusMatrixInverse": "pin.computeDampedDelassusMatrixInverse(m, d, q, cs, ds, 1e-3)",
    "computeKKTContactDynamicMatrixInverse": "pin.computeKKTContactDynamicMatrixInverse(m, d, q, J, 1e-3)",
    "getKKTContactDynamicMatrixInverse": "pin.getKKTContactDynamicMatrixInverse(m, d, J)",
    "cholesky.decompose": "pin.cholesky.decompose(m, d)",
    "cholesky.solve": "pin.cholesky.solve(m, d, tau)",
    "cholesky.computeMinv": "pin.cholesky.computeMinv(m, d)",
}


def prepared(urdf: str, kind: str, joints: str) -> Callable[[], dict[str, float]]:
    """All calls of whatever `pinocchio` is, ready to be measured [us]."""
    import numpy as np
    import pinocchio as pin

    m = pin.buildModelFromUrdf(urdf, pin.JointModelFreeFlyer())
    rng = np.random.default_rng(0)
    q = pin.integrate(m, pin.neutral(m), rng.uniform(-1.0, 1.0, m.nv))
    v, tau = rng.normal(size=(2, m.nv))
    cs, ds = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
    for joint in joints.split(","):
        cs.append(
            pin.RigidConstraintModel(
                getattr(pin.ContactType, kind), m, m.getJointId(joint), pin.LOCAL_WORLD_ALIGNED
            )
        )
        ds.append(cs[-1].createData())
    d, s = m.createData(), pin.ProximalSettings(1e-12, 0.0, 1)
    pin.initConstraintDynamics(m, d, cs, ds)
    chol = pin.ContactCholeskyDecomposition(m, d, cs, ds)
    names: dict[str, Any] = {
        "pin": pin,
        "m": m,
        "d": d,
        "q": q,
        "v": v,
        "tau": tau,
        "cs": cs,
        "ds": ds,
        "s": s,
    }
    names |= {
        "c": cs[0],
        "x": ds[0],
        "chol": chol,
        "b": rng.normal(size=chol.size()),
        "clock": time.perf_counter,
    }
    pin.constraintDynamics(m, d, q, v, tau, cs, ds, s)
    names |= {"J": pin.getConstraintsJacobian(m, d, cs, ds), "drift": rng.normal(size=len(d.lambda_c))}
    chol.compute(m, d, cs, ds, 1e-6)
    names["G"] = chol.getDelassusOperatorCholeskyExpression()
    loops = {}
    for title, call in CALLS.items():
        exec(f"def loop(n):\n start = clock()\n for _ in range(n): {call}\n return clock() - start", names)
        loops[title] = names["loop"]
        loops[title](20)
    counts = {title: min(max(int(SPAN * 20 / loop(20)), 40), 1000) for title, loop in loops.items()}

    def measure() -> dict[str, float]:
        return {title: loop(counts[title]) / counts[title] * 1e6 for title, loop in loops.items()}

    return measure


def main() -> None:
    from ulna.robots.example_robot_data import files

    faced, plain = environments("pinocchio")
    found = {}
    for title, (robot, *words) in ROBOTS.items():
        answers = in_turns([__file__, str(files(robot)[0]), *words], {"face": faced, "pin": plain}, ROUNDS)
        found[title] = answers["face"], answers["pin"]
    rows = [[call, *(f"{told[call]:.2g}" for pair in found.values() for told in pair)] for call in CALLS]
    heads = [head for title in found for head in (f"{title} face", "pin")]
    print(table("constraints, us a call", ["", *heads], rows))


if __name__ == "__main__":
    if len(sys.argv) == 4:
        answer_rounds(lambda: prepared(*sys.argv[1:]))
    else:
        main()
