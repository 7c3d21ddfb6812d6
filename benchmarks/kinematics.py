"""Kinematics of Ulna beside Pinocchio, from Python, in one run: single calls and batches, medians and ratios.

    python benchmarks/kinematics.py [--quick]

Needs `pin` and `example-robot-data`. Both libraries read the same URDF; the fingers of the Panda are locked in both.
The loop over Pinocchio computes joint poses; "with the pose" also reads the tool's 4x4 matrix, which is what a caller
wants. One core; run it on a quiet machine.
"""

from __future__ import annotations

import argparse
import os
import platform
import sys
from collections.abc import Callable

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
import pinocchio as pin
from _timing import medians, shown, table

from ulna.loading import load_model
from ulna.model import lock_joints
from ulna.robot import Robot
from ulna.robots import example_robot_data as data

ROBOTS = {
    "Panda": ("panda", ["panda_finger_joint1", "panda_finger_joint2"], "panda_hand"),
    "UR5": ("ur5", [], "tool0"),
    "G1": ("g1", [], "left_rubber_hand"),
}


def load(name: str, locked: list[str], frame: str) -> tuple[Robot, pin.Model, str]:
    """The robot in both libraries, from one file."""
    path, _ = data.files(name)
    model = load_model(path)
    peer = pin.buildModelFromUrdf(str(path))
    if locked:
        model = lock_joints(model, [j for j in locked if j in model.joint_names])
        ids = [peer.getJointId(j) for j in locked if peer.existJointName(j)]
        peer = pin.buildReducedModel(peer, ids, pin.neutral(peer))
    return Robot(model), peer, frame


def single_calls(label: str, robot: Robot, peer: pin.Model, frame: str) -> list[list[str]]:
    """One configuration at a time."""
    memory, index = peer.createData(), peer.getFrameId(frame)
    q = pin.randomConfiguration(peer)
    q_ours = robot.random_configuration(seed=0)
    fk, jac = robot.kernel("fk", frame=frame), robot.kernel("jacobian", frame=frame, reference="local")

    def pin_fk() -> None:
        pin.forwardKinematics(peer, memory, q)

    def pin_pose() -> np.ndarray:
        pin.forwardKinematics(peer, memory, q)
        return pin.updateFramePlacement(peer, memory, index).homogeneous

    rows = []
    cases: list[tuple[str, Callable[[], object], Callable[[], object]]] = [
        ("FK: kernel / pin.forwardKinematics", lambda: fk(q_ours), pin_fk),
        ("FK: robot.fk / pin with the pose", lambda: robot.fk(q_ours, frame), pin_pose),
        (
            "Jacobian: kernel / pin.computeFrameJacobian",
            lambda: jac(q_ours),
            lambda: pin.computeFrameJacobian(peer, memory, q, index),
        ),
        (
            "Jacobian: robot.jacobian / the same",
            lambda: robot.jacobian(q_ours, frame, "local"),
            lambda: pin.computeFrameJacobian(peer, memory, q, index),
        ),
    ]
    empty = medians([lambda: None])[0]  # the lambda around each candidate costs both sides the same
    for what, ours, theirs in cases:
        a, b = (max(t - empty, 1e-9) for t in medians([ours, theirs]))
        rows.append([label, what, shown(a), shown(b), f"{b / a:.1f}"])
    return rows


def batches(label: str, robot: Robot, peer: pin.Model, frame: str, count: int) -> list[list[str]]:
    """Row-major configurations, one core."""
    memory, index = peer.createData(), peer.getFrameId(frame)
    rng = np.random.default_rng(0)
    Q = rng.uniform(-2, 2, (count, robot.nq))
    few = rng.uniform(-2, 2, (min(count, 2000), peer.nq))
    fk, jac = robot.kernel("fk", frame=frame), robot.kernel("jacobian", frame=frame, reference="local")
    fk32 = robot.kernel("fk", frame=frame, dtype=np.float32)
    out, outJ = np.empty((count, 4, 4)), np.empty((count, 6, robot.nv))
    Q32, out32 = Q.astype(np.float32), np.empty((count, 4, 4), np.float32)

    def loop_fk() -> None:
        for q in few:
            pin.forwardKinematics(peer, memory, q)

    def loop_pose() -> None:
        for q in few:
            pin.forwardKinematics(peer, memory, q)
            pin.updateFramePlacement(peer, memory, index).homogeneous  # noqa: B018

    def loop_jacobian() -> None:
        for q in few:
            pin.computeFrameJacobian(peer, memory, q, index)

    def memory_only() -> None:
        out[:, 0, : min(4, robot.nq)] = Q[:, : min(4, robot.nq)]
        out[:, 1:] = 0.0

    times = medians([lambda: fk(Q), lambda: fk(Q, out=out), lambda: fk32(Q32, out=out32), lambda: jac(Q, out=outJ),
                     loop_fk, loop_pose, loop_jacobian, memory_only], repeat=9, seconds=0.05)  # fmt: skip
    each = [t / n for t, n in zip(times, [count] * 4 + [len(few)] * 3 + [count], strict=True)]
    fresh, reused, single, jacobian, pin_fk, pin_pose, pin_jac, touch = each
    return [
        [label, "FK, new array / loop over pin with the pose", shown(fresh), shown(pin_pose), f"{pin_pose / fresh:.0f}"],
        [label, "FK, out= / loop over pin with the pose", shown(reused), shown(pin_pose), f"{pin_pose / reused:.0f}"],
        [label, "FK, out= / loop over pin.forwardKinematics", shown(reused), shown(pin_fk), f"{pin_fk / reused:.0f}"],
        [label, "FK, float32, out= / loop over pin with the pose", shown(single), shown(pin_pose), f"{pin_pose / single:.0f}"],
        [label, "Jacobian, out= / loop over pin.computeFrameJacobian", shown(jacobian), shown(pin_jac), f"{pin_jac / jacobian:.0f}"],
        [label, "FK, out= / only writing as many numbers", shown(reused), shown(touch), f"{touch / reused:.2f}"],
    ]  # fmt: skip


def main() -> None:
    """Prints the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="smaller batches")
    count = 10_000 if parser.parse_args().quick else 100_000
    single, batch, sizes = [], [], []
    for label, (name, locked, frame) in ROBOTS.items():
        robot, peer, tip = load(name, locked, frame)
        single += single_calls(label, robot, peer, tip)
        batch += batches(label, robot, peer, tip, count)
        for kind in ("fk", "jacobian"):
            sizes.append([label, kind, str(robot.nv), str(robot.function(kind, frame=tip).operations)])
    print(
        f"Python {sys.version.split()[0]}, NumPy {np.__version__}, pin {pin.__version__}, {platform.machine()}\n"
    )
    head = ["robot", "ours / peer", "ours", "peer", "ratio"]
    print(table("One call from Python", head, single))
    print(table(f"Batches of {count:,}, one core, per configuration", head, batch))
    print(table("Scalar operations", ["robot", "kernel", "nv", "operations"], sizes))


if __name__ == "__main__":
    main()
