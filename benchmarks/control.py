"""One control step of Ulna beside the Robotics Toolbox, from Python, in one run, and the price of each control law.

    python benchmarks/control.py

The servo step is the one of the Toolbox's manual: pose of the tool, p_servo, Jacobian in the tool's axes, pseudoinverse,
joint velocities; each library with its own functions on its own Panda. Needs `roboticstoolbox-python`.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from _timing import medians, shown, table

import ulna
from ulna import control


def servo() -> list[list[str]]:
    """The servo step."""
    import roboticstoolbox as rtb
    from spatialmath import SE3

    theirs = rtb.models.Panda()
    ours = ulna.load("panda")
    q = np.array(ours.configurations["qr"])
    goal = ours.fk(q)
    goal[:3, 3] += 0.1
    goal_theirs = theirs.fkine(theirs.qr) * SE3.Tx(0.2) * SE3.Ty(0.2) * SE3.Tz(0.35)
    rate = control.resolved_rate(ours, reference="local", bounded=False)
    rest = np.zeros(7)

    def toolbox() -> np.ndarray:
        v, _ = rtb.p_servo(theirs.fkine(theirs.qr), goal_theirs, 1.0, 0.01)
        return np.linalg.pinv(theirs.jacobe(theirs.qr)) @ v

    def same_words() -> np.ndarray:
        v, _ = ulna.p_servo(ours.fk(q), goal, 1.0, 0.01)
        return np.linalg.pinv(ours.jacobian(q, None, "local")) @ v

    def compiled() -> np.ndarray:
        v, _ = ulna.p_servo(ours.fk(q), goal, 1.0, 0.01)
        return rate(q, v, 0.0, rest)

    names = ["Robotics Toolbox", "Ulna, the same words, NumPy's pinv", "Ulna, resolved_rate"]
    times = medians([toolbox, same_words, compiled])
    return [[n, shown(t), f"{times[0] / t:.1f}x"] for n, t in zip(names, times, strict=True)]


def laws() -> list[list[str]]:
    """Each law on the Panda."""
    robot = ulna.load("panda")
    q, zero, one = np.array(robot.configurations["qr"]), np.zeros(7), np.ones(7)
    T, six, ones = robot.fk(q), np.zeros(6), np.ones(6)
    reactive = control.Reactive(robot)
    goal = T.copy()
    goal[:3, 3] += 0.1
    cases = {
        "p_servo": (lambda: ulna.p_servo(T, goal, 1.0), None),
        "resolved_rate": (control.resolved_rate(robot), (q, ones, 0.01, zero)),
        "joint_pd": (control.joint_pd(robot), (q, zero, q, zero, one, one)),
        "computed_torque": (control.computed_torque(robot), (q, zero, q, zero, zero, one, one)),
        "impedance": (control.impedance(robot), (q, zero, T, six, ones, ones, q, one, one)),
        "operational_space": (
            control.operational_space(robot),
            (q, zero, T, six, six, ones, ones, q, one, one),
        ),
        "admittance": (control.admittance(), (T, six, six, ones, ones, ones, ones, 1e-3)),
        "Reactive, limits": (lambda: reactive(q, ones * 0.1, 10.0), None),
        "Reactive, and 5 rows": (
            lambda: reactive(q, ones * 0.1, 10.0, (np.eye(7)[:5], np.full(5, 1e-3))),
            None,
        ),
    }
    rows = []
    for name, (law, arguments) in cases.items():
        call = law if arguments is None else (lambda law=law, arguments=arguments: law(*arguments))
        operations = str(law.operations) if arguments is not None else ""
        rows.append([name, operations, shown(medians([call])[0])])
    return rows


def main() -> None:
    """Prints the tables."""
    print(table("One servo step, Panda", ["", "one step", "of the Toolbox"], servo()))
    print(table("Control laws, Panda", ["law", "operations", "one call"], laws()))


if __name__ == "__main__":
    main()
