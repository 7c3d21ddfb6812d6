"""A model of Pinocchio whose numbers change before every call, through the face and there; and what memory it takes.

python benchmarks/compat_pinocchio_changes.py
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Mapping

from _pair import answer_rounds, environments, in_turns

ROBOTS = {"UR5": ("ur5", ""), "Talos": ("talos", "floating")}
ROUNDS = 21
SPAN = 1e-3  # of each measurement [s]
CHANGES = {
    "none": "pass",
    "a mass": "body.mass = x",
    "a mass, a placement, gravity": "body.mass = x; place.translation[0] = x; fall[0] = x",
}
CALLS = {
    "rnea": "pin.rnea(m, d, q, v, v)",
    "aba": "pin.aba(m, d, q, v, v)",
    "crba": "pin.crba(m, d, q)",
    "forwardKinematics": "pin.forwardKinematics(m, d, q)",
    "computeJointJacobians": "pin.computeJointJacobians(m, d, q)",
    "computeAllTerms": "pin.computeAllTerms(m, d, q, v)",
    "computeRNEADerivatives": "pin.computeRNEADerivatives(m, d, q, v, v)",
}
MEMORY = "memory of 10,000 changes [kB]"


def prepare(urdf: str, floating: bool) -> Callable[[], Mapping[str, float]]:
    import numpy as np
    import pinocchio as pin

    names: dict[str, object] = {"pin": pin, "np": np}
    of: dict[str, Callable[[int], None]] = {}
    for change, line in CHANGES.items():
        model = pin.buildModelFromUrdf(urdf, *([pin.JointModelFreeFlyer()] if floating else []))
        names |= {"m": model, "d": model.createData(), "q": pin.neutral(model), "v": np.ones(model.nv)}
        own = dict(names, body=model.inertias[2], place=model.jointPlacements[2], fall=model.gravity.linear)
        for call, text in CALLS.items():
            exec(
                f"def loop(n):\n    for k in range(n):\n        x = 1.0 + 1e-9 * k\n        {line}; {text}",
                own,
            )
            of[f"{call} | {change}"] = own["loop"]  # type: ignore[assignment]
            own["loop"](20)  # type: ignore[operator]

    def measure() -> dict[str, float]:
        found = {}
        for name, loop in of.items():
            start = time.perf_counter()
            loop(20)
            count = max(20, int(20 * SPAN / (time.perf_counter() - start)))
            start = time.perf_counter()
            loop(count)
            found[name] = 1e6 * (time.perf_counter() - start) / count
        before = resident()
        of["rnea | a mass"](10_000)
        return found | {MEMORY: resident() - before}

    return measure


def resident() -> float:
    """Memory of this process [kB]."""
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1024


def main() -> None:
    from ulna.robots.example_robot_data import files

    who = dict(zip(("face", "pin"), environments("pinocchio"), strict=True))
    for title, (robot, floating) in ROBOTS.items():
        print(f"\n{title}, microseconds a change and a call" + "".join(f"{w:>12}" for w in who))
        found = in_turns([__file__, str(files(robot)[0]), floating], who, ROUNDS)
        for name in found["face"]:
            print(f"{name:48}" + "".join(f"{found[w][name]:12.2f}" for w in who))


if __name__ == "__main__":
    if len(sys.argv) > 1:
        answer_rounds(lambda: prepare(sys.argv[1], bool(sys.argv[2])))
    else:
        main()
