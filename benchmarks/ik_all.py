"""All solutions of inverse kinematics beside EAIK, IK-Geo and ssik, from Python, in one run: time, how many, whether all.

    python benchmarks/ik_all.py [--quick]

Needs `EAIK`, `ik-geo` and `ssik`; a peer that is missing, or does not know an arm, is left out. Goals are poses of random
configurations; limits do not count. For each solver: the median time of one call, how many distinct configurations per
pose reach the goal within 1e-6 (checked here, for all alike, by our forward kinematics), and for how many poses the
configuration that the pose was made from is among them. One core; run it on a quiet machine.
"""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Callable, Iterator
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from _timing import shown, table

import ulna
from ulna.formats.dh import model_from_dh, revolute
from ulna.ik.analytic.chain import arm_of, usual
from ulna.model import Model

Solve = Callable[[np.ndarray], Any]


def puma560() -> Model:
    """Spherical wrist; figures of Corke & Armstrong-Helouvry 1994."""
    rows = [
        (0.0, 0.0, 90),
        (0.0, 0.4318, 0),
        (0.15005, 0.0203, -90),
        (0.4318, 0.0, 90),
        (0.0, 0.0, -90),
        (0.0, 0.0, 0),
    ]
    return model_from_dh([revolute(d, a, np.deg2rad(alpha)) for d, a, alpha in rows], name="puma560")


def offset_wrist() -> Model:
    """No three axes meet or are parallel."""
    rows = [
        (0.3, 0.05, -80),
        (0.1, 0.4, 15),
        (0.1, 0.08, -90),
        (0.4, 0.03, 70),
        (0.05, 0.06, -90),
        (0.1, 0.02, 30),
    ]
    return model_from_dh([revolute(d, a, np.deg2rad(alpha)) for d, a, alpha in rows], name="offset_wrist")


ARMS: dict[str, tuple[Callable[[], Model], str]] = {
    "UR5": (lambda: ulna.load("ur5").model, "three_parallel_two_intersecting"),
    "Puma 560": (puma560, "spherical_two_parallel"),
    "six general axes": (offset_wrist, "gen_six_dof"),
}


def peers(model: Model, geo_name: str) -> Iterator[tuple[str, Solve]]:
    """Solvers made from the same axes; they know no rotation of the tool, so their goals lack it."""
    end = model.frame(model.tool)
    arm = arm_of(model, end, usual(model, end), model.neutral)
    H = np.array([axis.line.direction for axis in arm.axes])
    P = np.diff([np.zeros(3), *(axis.line.point for axis in arm.axes), arm.end.translation], axis=0)
    tool = np.eye(4)
    tool[:3, :3] = arm.end.rotation.T
    try:
        from eaik.IK_HP import HPRobot

        eaik = HPRobot(H, P)
        if eaik.hasKnownDecomposition():
            yield "EAIK", lambda T: eaik.IK(T @ tool).Q
    except ImportError:
        pass
    try:
        from ik_geo import Robot as Geo

        geo = getattr(Geo, geo_name)(H.tolist(), P.tolist())
        yield "IK-Geo", lambda T: [q for q, _ in geo.get_ik((T @ tool)[:3, :3].T.tolist(), T[:3, 3].tolist())]
    except ImportError:
        pass
    try:
        from ssik import Manipulator

        ssik = Manipulator.from_axes(H, P)
        if "general" in ssik.solver_name:
            return  # prepares for minutes
        yield "ssik", lambda T: [s.q for s in ssik.solve(T @ tool, respect_limits=False)]
    except ImportError:
        pass


def judged(robot: ulna.Robot, Q: np.ndarray, T: np.ndarray, answers: list[Any]) -> tuple[float, int]:
    """How many distinct solutions per pose reach it, and for how many poses the configuration it came from is one."""
    total = back = 0
    for q, goal, answer in zip(Q, T, answers, strict=True):
        found = np.asarray(answer, dtype=float).reshape(-1, robot.nq)
        kept: list[np.ndarray] = []
        for row in (
            found[np.abs(robot.fk(found) - goal).max(axis=(-2, -1), initial=0.0) < 1e-6] if len(found) else ()
        ):
            if not any(apart(row, other) < 1e-4 for other in kept):
                kept.append(row)
        total += len(kept)
        back += any(apart(row, q) < 1e-5 for row in kept)
    return total / len(Q), back


def apart(a: np.ndarray, b: np.ndarray) -> float:
    """The largest difference of two configurations, turns apart."""
    return float(np.abs((a - b + np.pi) % (2.0 * np.pi) - np.pi).max())


def rows_of(label: str, model: Model, geo_name: str, count: int) -> list[list[str]]:
    """A row for each solver, called in turns."""
    robot = ulna.Robot(model)
    Q = np.random.default_rng(0).uniform(-np.pi, np.pi, (count, robot.nq))
    T = robot.fk(Q)
    solvers: list[tuple[str, Solve]] = [("robot.ik_all", lambda goal: robot.ik_all(goal, limits=False).q)]
    try:
        kernel = robot.branch_kernel()
        solvers.append(("robot.branch_kernel", lambda goal: kernel(goal)[0]))
    except ulna.errors.InputError:
        pass
    solvers += peers(model, geo_name)
    spent: list[list[float]] = [[] for _ in solvers]
    answers: list[list[Any]] = [[] for _ in solvers]
    for _, solve in solvers:
        for goal in T[:5]:
            solve(goal)
    for goal in T:
        for (_, solve), seconds, into in zip(solvers, spent, answers, strict=True):
            start = time.perf_counter()
            found = solve(goal)
            seconds.append(time.perf_counter() - start)
            into.append(found)
    first = float(np.median(spent[0]))
    out = []
    for (name, _), seconds, found in zip(solvers, spent, answers, strict=True):
        per_pose, back = judged(robot, Q, T, found)
        middle = float(np.median(seconds))
        out.append(
            [label, name, shown(middle), f"{middle / first:.2f}", f"{per_pose:.3f}", f"{back} of {count}"]
        )
    start = time.perf_counter()
    robot.ik_all(T, limits=False)
    each = (time.perf_counter() - start) / count
    out.append([label, "robot.ik_all, all poses in one call", shown(each), f"{each / first:.2f}", "", ""])
    return out


def redundant(count: int) -> list[list[str]]:
    """The Panda: time, samples, and solutions within limits."""
    panda = ulna.load("panda")
    Q = panda.random_configuration(count, seed=1)
    T = panda.fk(Q)
    out = []
    for samples in (1, 32, 256):
        panda.ik_all(T[0], samples=samples)
        seconds, found, some = [], 0, 0
        for goal in T:
            start = time.perf_counter()
            answer = panda.ik_all(goal, samples=samples)
            seconds.append(time.perf_counter() - start)
            found, some = found + len(answer), some + bool(len(answer))
        out.append(
            [str(samples), shown(float(np.median(seconds))), f"{found / count:.1f}", f"{some} of {count}"]
        )
    return out


def main() -> None:
    """Prints the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer poses")
    quick = parser.parse_args().quick
    rows = []
    for label, (make, geo_name) in ARMS.items():
        slow = label == "six general axes"
        rows += rows_of(label, make(), geo_name, (20 if slow else 200) if quick else (100 if slow else 2000))
    head = [
        "arm",
        "solver",
        "median of one call",
        "of ik_all's",
        "solutions per pose",
        "configuration found again",
    ]
    print(table("All solutions, from Python", head, rows))
    head = [
        "values of panda_joint7",
        "median of one call",
        "solutions within limits per pose",
        "poses with a solution",
    ]
    print(table("Panda", head, redundant(50 if quick else 500)))


if __name__ == "__main__":
    main()
