"""How short paths get with time, beside VAMP's AORRTC, on MotionBenchMaker's problems of the Panda.

python benchmarks/planning_optimal.py FOLDER [--every 10]

FOLDER is VAMP's unpacked source; VAMP itself must be installed. Of each planner the mean cost over all problems is
printed for growing numbers of samples, with the median and mean of the time that they took. Ours is certified, too,
within that time; VAMP's paths are shortened by VAMP's own routine at the end, which is part of its time.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import Any

import numpy as np
import vamp
from planning_vamp import problems

import ulna
from ulna.planning import Planner

BUDGETS = (0, 1_000, 3_000, 10_000, 30_000)


def of_vamp(problem: Any, budget: int) -> tuple[float, float]:
    """Seconds and cost."""
    module, search, settings, simplify = vamp.configure_robot_and_planner_with_kwargs(
        "panda", "aorrtc" if budget else "rrtc"
    )
    samples = module.halton()
    if budget:
        settings.max_iterations = settings.max_samples = budget
    found = search(problem.start, [problem.goal], problem.environment, settings, samples)
    if not found.solved:
        return np.nan, np.nan
    short = module.simplify(found.path, problem.environment, simplify, samples)
    return (found.nanoseconds + short.nanoseconds) / 1e9, short.path.cost()


def main() -> None:
    """Plans with both and prints costs over time."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--every", type=int, default=10, help="take every n-th problem")
    options = parser.parse_args()
    files = options.folder / "resources" / "panda"
    robot = ulna.load(files / "panda_spherized.urdf", srdf=files / "panda.srdf")
    chosen = problems(options.folder)[:: options.every]
    planners = [Planner(robot, problem.world, method="spheres") for problem in chosen]
    straight = np.mean([np.linalg.norm(problem.goal - problem.start) for problem in chosen])
    print(f"{len(chosen)} problems; straight lines would cost {straight:.3f}")
    for budget in BUDGETS:
        theirs, ours, proved = [], [], 0
        for problem, planner in zip(chosen, planners, strict=True):
            theirs.append(of_vamp(problem, budget))
            planner.plan(problem.start, problem.goal, improve=min(budget, 1))  # compiles
            begin = time.perf_counter()
            plan = planner.plan(problem.start, problem.goal, improve=budget)
            ours.append((time.perf_counter() - begin, plan.cost))
            proved += plan.is_certified
        for name, results in (("VAMP", np.array(theirs)), ("Ulna", np.array(ours))):
            rows = results[np.isfinite(results).all(axis=1)]
            print(
                f"{budget:6} samples  {name}: cost {rows[:, 1].mean():.3f} in {1e3 * np.median(rows[:, 0]):.2f} ms (mean "
                f"{1e3 * rows[:, 0].mean():.2f}), {len(rows)} solved"
            )
        print(f"{'':15}  certified {proved} of {len(chosen)}")


if __name__ == "__main__":
    main()
