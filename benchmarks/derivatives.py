"""Derivatives of dynamics of Ulna beside Pinocchio, from Python, in one run: single calls and batches, medians and ratios.

    python benchmarks/derivatives.py [--quick] [robot ...]

Needs `pin` and `example-robot-data`. Both libraries read the same URDF; the fingers of the Panda are locked in both, and
robots that walk have a free flyer in both. One core; run it on a quiet machine.
"""

from __future__ import annotations

import argparse
import os
import platform
import sys
import time

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
import pinocchio as pin
from _timing import medians, shown, table

from ulna.loading import load_model
from ulna.model import FreeFlyer, Model, lock_joints, with_root_joint
from ulna.robot import Robot
from ulna.robots import example_robot_data as data

ROBOTS = {"Panda": "panda", "UR5": "ur5", "Solo12": "solo12", "G1": "g1", "Talos": "talos"}
LOCKED = {"panda": ["panda_finger_joint1", "panda_finger_joint2"]}
PEERS = {
    "inverse_dynamics_derivatives": pin.computeRNEADerivatives,
    "forward_dynamics_derivatives": pin.computeABADerivatives,
    "centroidal_derivatives": pin.computeCentroidalDynamicsDerivatives,
}


def load(name: str) -> tuple[Model, pin.Model]:
    """The robot in both libraries, from one file."""
    path, _ = data.files(name)
    floating = data.DESCRIPTIONS[name].floating
    model = load_model(path)
    if floating and not any(isinstance(joint.kind, FreeFlyer) for joint in model.joints):
        model = with_root_joint(model, FreeFlyer())
    peer = pin.buildModelFromUrdf(str(path), *([pin.JointModelFreeFlyer()] if floating else []))
    locked = LOCKED.get(name, [])
    if locked:
        model = lock_joints(model, [j for j in locked if j in model.joint_names])
        peer = pin.buildReducedModel(peer, [peer.getJointId(j) for j in locked], pin.neutral(peer))
    return model, peer


def compare(label: str, robot: Robot, peer: pin.Model, name: str, count: int) -> list[str]:
    """One row: operations, seconds to compile, single calls, and a batch beside the loop over Pinocchio."""
    rng = np.random.default_rng(0)
    memory, theirs = peer.createData(), PEERS[name]
    q, x, y = robot.random_configuration(seed=0), *rng.standard_normal((2, robot.nv))
    their_q, their_x, their_y = pin.randomConfiguration(peer), *rng.standard_normal((2, peer.nv))
    start = time.perf_counter()
    kernel = robot.kernel(name)
    kernel(q, x, y)
    ready = time.perf_counter() - start
    Q, (X, Y) = robot.random_configuration((count,), seed=1), rng.standard_normal((2, count, robot.nv))
    out = kernel(Q, X, Y)
    ours, other = medians([lambda: kernel(q, x, y), lambda: theirs(peer, memory, their_q, their_x, their_y)])
    batch = medians([lambda: kernel(Q, X, Y, out=out)], repeat=7)[0] / count
    operations = robot.function(name).operations
    return [label, name.removesuffix("_derivatives"), str(robot.nv), str(operations), shown(ready), shown(ours),
            shown(other), f"{other / ours:.1f}", shown(batch), f"{other / batch:.0f}"]  # fmt: skip


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="smaller batches")
    parser.add_argument("robots", nargs="*", help=f"out of {', '.join(ROBOTS)}; default Panda, UR5, Solo12")
    given = parser.parse_args()
    count = 1_000 if given.quick else 10_000
    rows = []
    for label in given.robots or ["Panda", "UR5", "Solo12"]:
        model, peer = load(ROBOTS[label])
        rows += [compare(label, Robot(model), peer, name, count) for name in PEERS]
    head = [
        "robot",
        "derivatives of",
        "nv",
        "operations",
        "ready in",
        "one call",
        "pin",
        "ratio",
        "in a batch",
        "ratio",
    ]
    print(
        f"Python {sys.version.split()[0]}, NumPy {np.__version__}, pin {pin.__version__}, {platform.machine()}\n"
    )
    print(table("Derivatives of dynamics", head, rows))


if __name__ == "__main__":
    main()
