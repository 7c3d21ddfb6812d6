"""Plans of a UR5 and of a humanoid's arm, beside OMPL's RRT-Connect with the same check of configurations.

    python benchmarks/planning_ompl.py [--problems 40]

OMPL (`pip install ompl`) searches in C++ and asks Ulna's compiled check by spheres for each configuration, one at a time
from Python; its path is simplified by its own routine. Ulna plans, shortens and certifies. For both: time of the call,
processor time, length of the path, and how many paths touch something between their points (looked at densely, by the
check of both). The time that OMPL spends outside of the check is given, too.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from _timing import table
from ompl import base, geometric, util

import ulna
from ulna.collision import World, link_pairs
from ulna.geometry import Box
from ulna.planning import Planner

LIMIT = 5.0  # of a search [s]
STEP = 0.05  # between checked configurations of OMPL [rad]


@dataclass(frozen=True)
class Case:
    """A robot in a world, and which of its numbers move."""

    name: str
    robot: ulna.Robot
    world: World
    joints: tuple[str, ...] | None
    columns: np.ndarray


@dataclass(frozen=True)
class Result:
    """What one plan took and is."""

    seconds: float
    outside: float
    cost: float
    touches: bool


def boxes(places: list[tuple[float, float, float]], size: tuple[float, float, float]) -> World:
    """Boxes at places."""
    world = World()
    for k, place in enumerate(places):
        world = world.add(f"box {k}", Box(size), place)
    return world


def cases() -> list[Case]:
    """A UR5 between four boxes, and the right arm of a G1 with one beside and one before it."""
    ur5 = ulna.load("ur5")
    places = [(0.45, 0.35, 0.3), (0.45, -0.35, 0.3), (-0.45, 0.35, 0.5), (0.0, -0.5, 0.6)]
    g1 = ulna.load("g1")
    arm = tuple(name for name in g1.joint_names if name.startswith("right_") and is_of_arm(name))
    moving = np.array([g1.model.joint(name).idx_q for name in arm])
    front = boxes([(0.35, -0.25, 0.1), (0.25, -0.5, 0.35)], (0.1, 0.2, 0.1))
    return [
        Case("UR5", ur5, boxes(places, (0.2, 0.2, 0.4)), None, np.arange(6)),
        Case("G1, right arm", g1, front, arm, moving),
    ]


def is_of_arm(name: str) -> bool:
    """Whether a joint belongs to an arm."""
    return any(part in name for part in ("shoulder", "elbow", "wrist"))


def pairs(case: Case) -> tuple[tuple[str, str], ...]:
    """The pairs of links that are checked: those with a link that moves, less two whose spheres always touch."""
    every = link_pairs(case.robot.model)
    if case.joints is None:
        return tuple(every)
    always = {
        "right_elbow_link",
        "right_wrist_pitch_link",
    }  # of the G1, whose meshes are some millimetres apart
    moves = lambda name: name.startswith("right_") and is_of_arm(name)  # noqa: E731
    return tuple((a, b) for a, b in every if (moves(a) or moves(b)) and {a, b} != always)


def problems(case: Case, checker: Any, count: int) -> list[tuple[np.ndarray, np.ndarray]]:
    """Starts and goals that are free by 5 mm, and that no straight motion joins."""
    robot, rng = case.robot, np.random.default_rng(0)
    low, high = robot.model.lower_position[case.columns], robot.model.upper_position[case.columns]
    low, high = np.maximum(low, -np.pi), np.minimum(high, np.pi)
    q = np.repeat(robot.neutral[None], 4000, axis=0)
    q[:, case.columns] = rng.uniform(low, high, (len(q), len(low)))
    free = q[checker.clearance(q) > 0.005]
    chosen = []
    for a, b in zip(free[::2], free[1::2], strict=False):
        if checker.collides(a + np.linspace(0.0, 1.0, 200)[:, None] * (b - a)).any():
            chosen.append((a, b))
        if len(chosen) == count:
            break
    return chosen


def touches(checker: Any, points: np.ndarray) -> bool:
    """Whether a path touches anything, looked at every 0.005 rad or less."""
    t = np.linspace(0.0, 1.0, 400)[:, None]
    return any(bool(checker.collides(a + t * (b - a)).any()) for a, b in pairwise(points))


def by_ulna(planner: Planner, case: Case, checker: Any, start: np.ndarray, goal: np.ndarray) -> Result | None:
    """Our plan."""
    begin = time.perf_counter()
    plan = planner.plan(start, goal, joints=case.joints, timeout=LIMIT)
    seconds = time.perf_counter() - begin
    return Result(seconds, seconds, plan.cost, touches(checker, plan.points)) if plan else None


def by_ompl(case: Case, checker: Any, start: np.ndarray, goal: np.ndarray) -> Result | None:
    """OMPL's plan."""
    n, columns = len(case.columns), case.columns
    space = base.RealVectorStateSpace(n)
    bounds = base.RealVectorBounds(n)
    low, high = case.robot.model.lower_position[columns], case.robot.model.upper_position[columns]
    for k in range(n):
        bounds.setLow(k, float(max(low[k], -2.0 * np.pi)))
        bounds.setHigh(k, float(min(high[k], 2.0 * np.pi)))
    space.setBounds(bounds)
    setup = geometric.SimpleSetup(space)
    q, inside = start.copy(), 0.0

    def is_free(state: Any) -> bool:
        nonlocal inside
        begin = time.perf_counter()
        for k in range(n):
            q[columns[k]] = state[k]
        free = not checker.collides(q)
        inside += time.perf_counter() - begin
        return free

    setup.setStateValidityChecker(is_free)
    space.setLongestValidSegmentFraction(STEP / space.getMaximumExtent())
    ends = []
    for point in (start, goal):
        state = space.allocState()
        for k in range(n):
            state[k] = float(point[columns[k]])
        ends.append(state)
    setup.setStartAndGoalStates(*ends)
    setup.setPlanner(geometric.RRTConnect(setup.getSpaceInformation()))
    begin = time.perf_counter()
    solved = setup.solve(LIMIT)
    if not solved or not setup.haveExactSolutionPath():
        return None
    setup.simplifySolution()
    seconds = time.perf_counter() - begin
    path = setup.getSolutionPath()
    points = np.repeat(start[None], path.getStateCount(), axis=0)
    for row, k in np.ndindex(len(points), n):
        points[row, columns[k]] = path.getState(row)[k]
    cost = float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
    return Result(seconds, seconds - inside, cost, touches(checker, points))


def main() -> None:
    """Plans with both and prints a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--problems", type=int, default=40)
    count = parser.parse_args().problems
    util.setLogLevel(util.LogLevel.LOG_NONE)
    lines = []
    for case in cases():
        planner = Planner(case.robot, case.world, pairs=pairs(case), method="spheres")
        checker = planner.scene.checker
        chosen = problems(case, checker, count)
        by_ulna(planner, case, checker, *chosen[0])  # compiles
        ours, theirs = [], []
        for start, goal in chosen:
            ours.append(by_ulna(planner, case, checker, start, goal))
            theirs.append(by_ompl(case, checker, start, goal))
        for name, results in (("Ulna, certified", ours), ("OMPL RRT-Connect, simplified", theirs)):
            solved = [r for r in results if r is not None]
            both = [r for r, a, b in zip(results, ours, theirs, strict=True) if a and b and r]
            lines.append(
                (
                    case.name,
                    name,
                    f"{len(solved)} of {len(chosen)}",
                    f"{1e3 * np.median([r.seconds for r in solved]):.2f} ms",
                    f"{1e3 * np.median([r.outside for r in solved]):.2f} ms",
                    f"{np.mean([r.cost for r in both]):.2f}",
                    str(sum(r.touches for r in solved)),
                )
            )
    header = ("robot", "planner", "solved", "median", "outside of the check", "length", "paths that touch")
    print(table("Beside OMPL", header, lines))


if __name__ == "__main__":
    main()
