"""Inverse kinematics of Ulna beside its peers, from Python, in one run: success, median and tail of one call, batches.

    python benchmarks/ik.py [--quick]

Needs `roboticstoolbox-python`, `ssik`, `EAIK`, `ik-geo` and `example-robot-data`; a peer that is missing is left out.
Goals are poses of random configurations within the joint limits. Success is checked here, for every solver alike: within
1e-6 m and 1e-6 rad of the goal by the peer's or our own forward kinematics, and within the limits. The Toolbox is asked
for `tol=1e-12`, which is what that accuracy takes of its squared error. Analytic solvers compute all branches, of which
one within the limits counts. One core.
"""

from __future__ import annotations

import argparse
import os
import platform
import sys
import time
from collections.abc import Callable, Sequence
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from _timing import shown, table

import ulna
from ulna.model import FreeFlyer, with_root_joint
from ulna.spatial import so3_log

Solve = Callable[[np.ndarray], "np.ndarray | None"]


def is_met(robot: ulna.Robot, q: Any, T: np.ndarray, frame: Any, rows: str = "pose") -> np.ndarray:
    """Whether configurations are at their goals and within the limits."""
    pose = robot.fk(q, frame)
    position = np.linalg.norm(pose[..., :3, 3] - T[..., :3, 3], axis=-1) <= 1e-6
    turned = np.swapaxes(pose[..., :3, :3], -1, -2) @ T[..., :3, :3]
    rotation = np.linalg.norm(so3_log(turned), axis=-1) <= 1e-6 * (1 + 1e-6)
    met = position & (rotation if rows == "pose" else True)
    return (
        met if met.ndim == 1 or not isinstance(frame, list) else met.all(axis=-1)
    ) & robot.limits.contains(q, 1e-12)


def one_by_one(solvers: Sequence[tuple[str, Solve]], goals: np.ndarray, check: Any) -> list[list[str]]:
    """Each solver on each goal, in turns of a few goals; a row of a table for each."""
    seconds: list[list[float]] = [[] for _ in solvers]
    answers: list[list[Any]] = [[] for _ in solvers]
    for _, solve in solvers:
        solve(goals[0])  # compile
    for part in np.array_split(np.arange(len(goals)), max(len(goals) // 100, 1)):
        for number, (_, solve) in enumerate(solvers):
            for k in part:
                start = time.perf_counter()
                answer = solve(goals[k])
                seconds[number].append(time.perf_counter() - start)
                answers[number].append(answer)
    rows, first = [], float(np.median(seconds[0]))
    for (name, _), spent, found in zip(solvers, seconds, answers, strict=True):
        here = [q is not None and bool(check(name, q, T)) for q, T in zip(found, goals, strict=True)]
        median = float(np.median(spent))
        tail = shown(float(np.quantile(spent, 0.99)))
        rows.append(
            [
                name,
                f"{100 * np.mean(here):.2f} %",
                shown(median),
                tail,
                f"{median / first:.1f}x",
                str(len(goals)),
            ]
        )
    return rows


HEADER = ["solver", "success", "median", "p99", "of ours", "goals"]


def toolbox_panda(count: int) -> list[list[str]]:
    """The Toolbox's own Panda and poses."""
    import roboticstoolbox as rtb

    panda = rtb.models.Panda()
    chain = panda.ets()
    lower, upper = panda.qlim
    q = np.random.default_rng(2).uniform(lower, upper, (count, 7))
    goals = np.array([chain.eval(x) for x in q])

    def check(name: str, q: np.ndarray, T: np.ndarray) -> bool:
        pose = chain.eval(q)
        turned = np.linalg.norm(so3_log(pose[:3, :3].T @ T[:3, :3]))
        near = np.linalg.norm(pose[:3, 3] - T[:3, 3]) <= 1e-6 and turned <= 1e-6 * (1 + 1e-6)
        return bool(near and (q >= lower - 1e-12).all() and (q <= upper + 1e-12).all())

    def lm(T: np.ndarray) -> Any:
        return chain.ik_LM(T, tol=1e-12).q

    return one_by_one([("RTB ik_LM, chan (C++)", lm)], goals, check)


def panda(count: int) -> list[list[str]]:
    """Panda: ours, the Toolbox, ssik."""
    robot = ulna.load("panda")
    goals = robot.fk(robot.random_configuration(count, seed=1))
    solvers: list[tuple[str, Solve]] = [("ulna", lambda T: robot.ik(T).q)]
    peers: list[list[str]] = []
    try:
        from ssik.prebuilt import franka_panda_ik

        def analytic(T: np.ndarray) -> Any:
            found = franka_panda_ik.solve(T)
            return np.array([s.q for s in found]) if found else None

        hand = _frame_of(robot, franka_panda_ik)
        if hand is not None:
            solvers.append((f"ssik, all branches ({hand})", analytic))
            goals = robot.fk(robot.random_configuration(count, seed=1), hand)
            solvers[0] = ("ulna", lambda T: robot.ik(T, frame=hand).q)
    except ImportError:
        hand = None
    rows = one_by_one(solvers, goals, lambda name, q, T: is_met(robot, np.atleast_2d(q), T, hand).any())
    try:
        peers = toolbox_panda(min(count, 2000))
        peers[0][4] = f"{_seconds(peers[0][2]) / _seconds(rows[0][2]):.1f}x"
    except ImportError:
        pass
    return rows + peers


def _frame_of(robot: ulna.Robot, arm: Any) -> str | None:
    """Our name of the frame a prebuilt solver of ssik speaks of."""
    q = robot.configurations["qr"]
    for name in ("panda_link8", "panda_hand", "panda_hand_tcp"):
        found = arm.solve(robot.fk(q, name))
        if any(np.abs(np.asarray(s.q) - q).max() < 1e-6 for s in found):
            return name
        if found and np.abs(robot.fk(np.asarray(found[0].q), name) - robot.fk(q, name)).max() < 1e-6:
            return name
    return None


def _seconds(text: str) -> float:
    number, unit = text.split()
    return float(number) * {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}[unit]


def ur5(count: int) -> list[list[str]]:
    """UR5: ours, EAIK, IK-Geo."""
    robot = ulna.load("ur5")
    q = np.random.default_rng(3).uniform(-np.pi, np.pi, (count, 6))
    goals = robot.fk(q)
    solvers: list[tuple[str, Solve]] = [("ulna", lambda T: robot.ik(T).q)]
    H, P, R = _axes(robot)
    turn = R.T
    try:
        from eaik.IK_HP import HPRobot

        eaik = HPRobot(H, P)

        def eaik_solve(T: np.ndarray) -> Any:
            G = T.copy()
            G[:3, :3] = T[:3, :3] @ turn
            return np.remainder(np.array(eaik.IK(G).Q) + np.pi, 2 * np.pi) - np.pi

        solvers.append(("EAIK, all branches", eaik_solve))
    except ImportError:
        pass
    try:
        from ik_geo import Robot as GeoRobot

        geo = GeoRobot.ur5()  # its own figures, hence separate goals
        own = np.tile(np.eye(4), (count, 1, 1))
        for T, x in zip(own, q, strict=True):
            T[:3, :3], T[:3, 3] = geo.forward_kinematics(x)

        def geo_check(name: str, found: Any, T: np.ndarray) -> bool:
            poses = [geo.forward_kinematics(x) for x in found]
            return any(
                np.linalg.norm(p - T[:3, 3]) <= 1e-6
                and np.linalg.norm(so3_log(np.array(R).T @ T[:3, :3])) <= 1e-6
                for R, p in poses
            )

        def geo_solve(T: np.ndarray) -> Any:
            return [x for x, _ in geo.get_ik(T[:3, :3], T[:3, 3])]

        beside = one_by_one([("IK-Geo, all branches", geo_solve)], own, geo_check)
    except ImportError:
        beside = []
    rows = one_by_one(solvers, goals, lambda name, q, T: is_met(robot, np.atleast_2d(q), T, None).any())
    for row in beside:
        row[4] = f"{_seconds(row[2]) / _seconds(rows[0][2]):.1f}x"
    return rows + beside


def _axes(robot: ulna.Robot) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Axes and offsets of a chain at rest, as products of exponentials want them, and the tool's rotation there."""
    names = robot.joint_names
    poses = robot.fk(robot.neutral, list(names))
    J = robot.jacobian(robot.neutral)
    H = J[3:].T
    points = np.vstack([poses[:, :3, 3], robot.fk(robot.neutral)[:3, 3]])
    return H, np.diff(np.vstack([np.zeros(3), points]), axis=0), robot.fk(robot.neutral)[:3, :3]


def others(count: int) -> list[list[str]]:
    """Robots and questions of other kinds, ours alone."""
    tight = ulna.load("panda")
    rows = []
    arm = ulna.load("so101").with_tool("gripper_frame_link")
    g1 = ulna.load("g1")
    hands = ["left_rubber_hand", "right_rubber_hand"]
    feet = [*hands, "left_ankle_roll_link", "right_ankle_roll_link"]
    floating = ulna.Robot(with_root_joint(g1.model, FreeFlyer()))
    talos = ulna.load("talos_arm")
    cases: list[tuple[str, ulna.Robot, Any, Any]] = [
        ("Panda, position", tight, None, "position"),
        ("Talos, arm of 7 joints", talos, None, None),
        ("SO101, 5 joints, position and z axis", arm, None, "position+z"),
        ("SO101, 5 joints, reachable poses", arm, None, "pose"),
        ("G1, hand, waist included (10 joints)", g1, "left_rubber_hand", None),
        ("G1, both hands (17 joints)", g1, hands, None),
        ("G1, hands and feet, floating (35)", floating, feet, None),
        ("Kinova (continuous joints)", ulna.load("kinova"), None, None),
    ]
    for name, robot, frame, mask in cases:
        goals = robot.fk(robot.random_configuration(count, seed=5), frame)

        def solve(T: np.ndarray, robot: Any = robot, frame: Any = frame, mask: Any = mask) -> Any:
            return robot.ik(T, frame=frame, mask=mask)

        solve(goals[0])
        seconds, met = [], []
        for T in goals:
            start = time.perf_counter()
            solution = solve(T)
            seconds.append(time.perf_counter() - start)
            met.append(solution.success)
        tail = shown(float(np.quantile(seconds, 0.99)))
        rows.append(
            [name, f"{100 * np.mean(met):.2f} %", shown(float(np.median(seconds))), tail, "", str(count)]
        )
    return rows


def batches(count: int) -> list[list[str]]:
    """Many goals in one call, one core."""
    rows = []
    for name in ("panda", "ur5", "talos_arm", "kinova"):
        robot = ulna.load(name)
        low, high = np.maximum(robot.limits.lower, -np.pi), np.minimum(robot.limits.upper, np.pi)
        q = np.random.default_rng(6).uniform(low, high, (count, robot.nq))
        goals = robot.fk(q)
        robot.ik(goals[:2000])
        spent = []
        for _ in range(5):
            start = time.perf_counter()
            solution = robot.ik(goals)
            spent.append(time.perf_counter() - start)
        near = robot.limits.clip(q + np.random.default_rng(7).normal(0.0, 0.05, q.shape))
        start = time.perf_counter()
        warm = robot.ik(goals, near)
        warm_rate = count / (time.perf_counter() - start)
        met = is_met(robot, solution.q, goals, None)
        rate = count / float(np.median(spent))
        rows.append(
            [name, f"{100 * met.mean():.3f} %", f"{rate / 1e6:.2f} million/s", f"{100 * warm.success.mean():.3f} %",
             f"{warm_rate / 1e6:.2f} million/s", str(count)]
        )  # fmt: skip
    return rows


def main() -> None:
    """Prints the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="a tenth of the goals")
    quick = parser.parse_args().quick
    count = 1000 if quick else 10_000
    print(f"{platform.processor() or platform.machine()}, Python {sys.version.split()[0]}\n")
    print(table("Panda, one goal a call", HEADER, panda(count)))
    print(table("UR5, one goal a call", HEADER, ur5(count)))
    print(table("Other robots and questions", [*HEADER[:4], "", "goals"], others(count // 10)))
    header = ["robot", "success", "solved", "success near q0", "solved near q0", "goals"]
    print(table("Batches, one core", header, batches(10 * count)))


if __name__ == "__main__":
    main()
