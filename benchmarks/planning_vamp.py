"""Plans the MotionBenchMaker problems of the Panda beside VAMP, in turns, with VAMP's spheres and pairs.

python benchmarks/planning_vamp.py FOLDER [--every 1] [--rounds 5] [--turns rounds]

FOLDER is VAMP's unpacked source, with resources/panda; VAMP itself must be installed. Both plan with the same spheres
against the same boxes and capsules. Of each problem the least time of all rounds counts. VAMP's times are those that
it reports itself, ours contain what Python does. With `--turns rounds` each plans all problems before the other does,
with `--turns problems` each problem is planned by both; VAMP then drives what ours need from the processor's caches, by
the memory that it takes for its trees before it begins to measure.
"""

from __future__ import annotations

import argparse
import tarfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import vamp
import yaml

import ulna
from ulna.collision import World
from ulna.geometry import Box, Capsule
from ulna.planning import Planner
from ulna.spatial import SE3

SETS = (
    "bookshelf_small_panda", "bookshelf_tall_panda", "bookshelf_thin_panda", "box_panda", "cage_panda",
    "table_pick_panda", "table_under_pick_panda",
)  # fmt: skip
JOINTS = [f"panda_joint{k}" for k in range(1, 8)]


@dataclass(frozen=True)
class Problem:
    """A start, a goal, and the same world for both planners."""

    name: str
    start: np.ndarray
    goal: np.ndarray
    world: World
    environment: Any


def problems(folder: Path) -> list[Problem]:
    """The problems whose start and goal VAMP finds free."""
    archive = folder / "resources" / "panda" / "problems.tar.bz2"
    loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
    with tarfile.open(archive) as tar:
        texts = {member.name: tar.extractfile(member).read() for member in tar if member.isfile()}  # type: ignore
    result = []
    for name in SETS:
        for number in range(1, 101):
            request = yaml.load(texts[f"problems/{name}/request{number:04}.yaml"], loader)
            scene = yaml.load(texts[f"problems/{name}/scene{number:04}.yaml"], loader)
            state = request["start_state"]["joint_state"]
            start = dict(zip(state["name"], state["position"], strict=True))
            goal = {
                c["joint_name"]: c["position"] for c in request["goal_constraints"][0]["joint_constraints"]
            }
            world, environment = _both_worlds(scene, name)
            q0, q1 = (np.array([values[joint] for joint in JOINTS]) for values in (start, goal))
            if vamp.panda.validate(q0, environment) and vamp.panda.validate(q1, environment):
                result.append(Problem(f"{name} {number}", q0, q1, world, environment))
    return result


def _both_worlds(scene: dict[str, Any], name: str) -> tuple[World, Any]:
    """The obstacles as VAMP takes them: capsules for cylinders, but boxes in the set "box"."""
    world, environment = World(), vamp.Environment()
    for entry in scene["world"]["collision_objects"]:
        for k, (shape, pose) in enumerate(zip(entry["primitives"], entry["primitive_poses"], strict=True)):
            place = SE3.from_quat_xyzw(_xyzw(pose["orientation"]), pose["position"])
            angles, label = _euler_xyz(place.rotation), f"{entry['id']}.{k}"
            if shape["type"] == "box":
                size = shape["dimensions"]
            elif name == "box_panda":
                length, radius = shape["dimensions"]
                size = (2 * radius, 2 * radius, length)
            else:
                length, radius = shape["dimensions"]
                world = world.add(label, Capsule(radius, length), place)
                environment.add_capsule(vamp.Cylinder(pose["position"], angles, radius, length))
                continue
            world = world.add(label, Box(tuple(size)), place)
            environment.add_cuboid(vamp.Cuboid(pose["position"], angles, [edge / 2 for edge in size]))
    return world, environment


def _xyzw(values: Any) -> np.ndarray:
    q = np.array(values, float)
    return q / np.linalg.norm(q)


def _euler_xyz(R: Any) -> list[float]:
    """Angles about the fixed x, y and z axes."""
    from scipy.spatial.transform import Rotation

    return Rotation.from_matrix(np.array(R)).as_euler("xyz").tolist()


def compare_checks(robot: Any, chosen: list[Problem], count: int = 40) -> tuple[int, int]:
    """How many random configurations both judge, and of how many they differ."""
    random = np.random.default_rng(0)
    differ = total = 0
    for problem in chosen:
        checker = robot.collision_checker(problem.world, method="spheres")
        q = random.uniform(robot.limits.lower, robot.limits.upper, (count, robot.nq))
        free = [vamp.panda.validate(row, problem.environment) for row in q]
        differ += int((~checker.collides(q) != np.array(free)).sum())
        total += count
    return total, differ


def main() -> None:
    """Plans all problems with both, and prints what each took."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--every", type=int, default=1, help="take every n-th problem")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument(
        "--turns",
        choices=("rounds", "problems"),
        default="rounds",
        help="after what the other one takes its turn",
    )
    options = parser.parse_args()
    files = options.folder / "resources" / "panda"
    robot = ulna.load(files / "panda_spherized.urdf", srdf=files / "panda.srdf")
    chosen = problems(options.folder)[:: options.every]
    print("{} configurations, {} judged differently".format(*compare_checks(robot, chosen[::10])))
    planners = [Planner(robot, problem.world, method="spheres") for problem in chosen]
    module, search, settings, simplify = vamp.configure_robot_and_planner_with_kwargs("panda", "rrtc")
    samples = module.halton()
    theirs, ours, called = [], [], []

    def by_vamp(problem: Problem) -> list[Any]:
        samples.reset()
        a = search(problem.start, [problem.goal], problem.environment, settings, samples)
        b = module.simplify(a.path, problem.environment, simplify, samples)
        return [a.nanoseconds / 1e3, b.nanoseconds / 1e3, np.nan, a.iterations, b.path.cost(), a.solved]

    for _ in range(options.rounds):
        rows: list[list[Any]] = [[], [], [], []]
        for problem, planner in zip(chosen, planners, strict=True):
            if options.turns == "problems":
                rows[0].append(by_vamp(problem))
            start = time.perf_counter()
            p = planner.plan(problem.start, problem.goal)
            rows[2].append(1e6 * (time.perf_counter() - start))
            prepare, *parts = (1e6 * p.seconds[name] for name in ("prepare", "search", "shorten", "certify"))
            parts[0] += prepare  # VAMP's time contains the check of the straight motion, too
            rows[1].append([*parts, p.iterations, p.cost, bool(p)])
            rows[3].append(p.is_certified)
        if options.turns == "rounds":
            rows[0] = [by_vamp(problem) for problem in chosen]
        theirs.append(rows[0])
        ours.append(rows[1])
        called.append(rows[2])
    certified = sum(rows[3])
    _show("VAMP", np.min(theirs, axis=0))
    _show("Ulna", np.min(ours, axis=0))
    print(
        f"certified {certified} of {len(chosen)}; whole call from Python {np.median(np.min(called, axis=0)):.0f} us"
    )


def _show(name: str, rows: np.ndarray) -> None:
    """Prints median, mean and 95th percentile of each part [us]."""
    print(f"{name}: solved {int(rows[:, 5].sum())} of {len(rows)}, mean cost {rows[:, 4].mean():.3f}")
    both = rows[:, :2].sum(axis=1)
    parts = {
        "plan": rows[:, 0],
        "simplify": rows[:, 1],
        "both": both,
        "certify": rows[:, 2],
        "and certify": both + rows[:, 2],
    }
    for part, times in (*parts.items(), ("samples", rows[:, 3])):
        if np.isfinite(times).all():
            print(f"  {part:12} {np.median(times):8.1f} {times.mean():8.1f} {np.percentile(times, 95):8.1f}")


if __name__ == "__main__":
    main()
