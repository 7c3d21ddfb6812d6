"""Trajectories of Ulna beside toppra and the Robotics Toolbox, from Python, in one run: medians and ratios.

    python benchmarks/trajectory.py [--quick]

Needs `toppra` and `roboticstoolbox-python`. Time-optimal parameterisation: one spline through five way-points of seven
joints in both, 100 segments, from the path to a trajectory that can be asked; toppra with its fastest solver (seidel, in
Cython). Its torques come from Ulna's compiled inverse dynamics too, which it calls once a grid point.
"""

from __future__ import annotations

import argparse
import os
import platform
import sys
from collections.abc import Callable
from importlib.metadata import version
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
import roboticstoolbox as rtb
import spatialmath
import toppra
from _timing import medians, shown, table
from toppra import algorithm, constraint

import ulna
from ulna import trajectory

SCHEMES = {
    "interpolation": constraint.DiscretizationType.Interpolation,
    "collocation": constraint.DiscretizationType.Collocation,
}
Pair = tuple[str, Callable[[], object], Callable[[], object]]


def time_optimal(robot: Any, scheme: str, torque: bool, seed: int = 0) -> Pair:
    """The same problem for both."""
    rng = np.random.default_rng(seed)
    low, high = robot.limits.lower, robot.limits.upper
    path = toppra.SplineInterpolator(
        np.linspace(0, 1, 5), low + (high - low) * rng.uniform(0.2, 0.8, (5, robot.nv))
    )
    spline = path.cspl
    ours = trajectory.Polynomial.of(spline.x, np.swapaxes(spline.c[::-1], 0, 1))
    grid, speed, hard, effort = (
        np.linspace(0, 1, 101),
        robot.limits.velocity,
        np.full(robot.nv, 12.0),
        robot.limits.effort,
    )
    box = lambda limit: np.stack([-limit, limit], axis=1)  # noqa: E731
    kernel = robot.kernel("inverse_dynamics")
    limits = [constraint.JointVelocityConstraint(box(speed))]
    if torque:
        limits.append(
            constraint.JointTorqueConstraint(kernel, box(effort), np.zeros(robot.nv), SCHEMES[scheme])
        )
    else:
        limits.append(constraint.JointAccelerationConstraint(box(hard), SCHEMES[scheme]))

    def theirs() -> Any:
        task = algorithm.TOPPRA(
            limits, path, gridpoints=grid, solver_wrapper="seidel", parametrizer="ParametrizeConstAccel"
        )
        return task.compute_trajectory()

    def mine() -> Any:
        if torque:
            return trajectory.time_optimal(
                ours, robot, velocity=speed, torque=effort, scheme=scheme, grid=grid
            )
        return trajectory.time_optimal(ours, velocity=speed, acceleration=hard, scheme=scheme, grid=grid)

    assert abs(mine().duration / theirs().duration - 1.0) < 2e-2  # ours keeps limits between grid points too
    what = "speed and torque" if torque else "speed and acceleration"
    return f"TOPP, 7 joints, 100 segments, {what}, {scheme} / toppra", mine, theirs


def sampled() -> list[Pair]:
    """Making and sampling trajectories, beside the Toolbox."""
    rng = np.random.default_rng(0)
    q0, q1 = rng.normal(size=(2, 7))
    t = np.linspace(0.0, 2.0, 1000)
    a, b = ulna.SE3.exp(rng.normal(size=6)), ulna.SE3.exp(rng.normal(size=6))
    A, B = spatialmath.SE3(a.matrix(), check=False), spatialmath.SE3(b.matrix(), check=False)
    law = trajectory.trapezoidal(0.0, 1.0, duration=2.0)
    points, times = rng.normal(size=(6, 3)), [1.0, 1.2, 0.9, 1.0, 1.1]

    def line() -> object:
        return trajectory.pose_line(a, b, 2.0).path.retimed(law).sample(n=50)

    return [
        ("quintic, 7 joints, 1000 samples of q, v, a / jtraj",
         lambda: trajectory.quintic(q0, q1, 2.0).state(t), lambda: rtb.jtraj(q0, q1, t)),
        ("trapezoidal, 7 joints, 1000 samples / mtraj",
         lambda: trajectory.trapezoidal(q0, q1, duration=2.0).state(t), lambda: rtb.mtraj(rtb.trapezoidal, q0, q1, t)),
        ("pose line, 50 poses, twists, accelerations / ctraj, 50 poses", line, lambda: rtb.ctraj(A, B, 50)),
        ("quintic blends, 5 segments, 100 a second / mstraj",
         lambda: trajectory.blended(points, 0.3, segment_times=times, kind="quintic", ends="half").sample(rate=100),
         lambda: rtb.mstraj(points, dt=0.01, tacc=0.3, tsegment=times)),
    ]  # fmt: skip


def main() -> None:
    """Prints the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer repetitions")
    repeat = 7 if parser.parse_args().quick else 31
    toppra.setup_logging("ERROR")
    panda = ulna.load("panda")
    pairs = [
        time_optimal(panda, scheme, torque) for torque in (False, True) for scheme in SCHEMES
    ] + sampled()
    rows = []
    for what, ours, theirs in pairs:
        one, two = medians([ours, theirs], repeat=repeat)
        rows.append([what, shown(one), shown(two), f"{two / one:.1f}"])
    q, v = np.random.default_rng(1).normal(size=(2, 7))
    t = trajectory.quintic(q, v, 1.0)
    single = medians([lambda: t.state(0.3)])[0]
    versions = f"NumPy {np.__version__}, toppra {version('toppra')}, roboticstoolbox {rtb.__version__}"
    print(f"Python {sys.version.split()[0]}, {versions}, {platform.machine()}\n")
    print(table("Trajectories", ["ours / peer", "ours", "peer", "ratio"], rows))
    print(f"One state (q, v, a) of a quintic of 7 joints at one time: {shown(single)}\n")


if __name__ == "__main__":
    main()
