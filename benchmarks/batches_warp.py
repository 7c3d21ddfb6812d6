"""Batches of forward dynamics by MuJoCo Warp on the CPU beside ours, both in float32, without contacts.

    python benchmarks/batches_warp.py [--samples 1000] [robot ...]

Robots: those of speed.py; default Panda and G1. Needs `mujoco-warp`, and what derivatives.py needs; without it, it says so
and measures nothing. MuJoCo Warp compiles its kernels when they are first used, for a minute or more, and stores them; on the CPU
it computes one sample after the other in one thread. Results are compared with MuJoCo's. Medians in turns.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from typing import Any

os.environ["ULNA_QUIET"] = "1"

import numpy as np
from _speed_robots import LABELS, mujoco_model
from _timing import medians, shown, table
from derivatives import ROBOTS

from ulna.loading import load_model
from ulna.model import FreeFlyer, with_root_joint
from ulna.robot import Robot
from ulna.robots import example_robot_data as data

try:
    import mujoco
    import mujoco_warp
    import warp
except ImportError as missing:
    sys.exit(f"MuJoCo Warp is not measured: {missing}. Install mujoco-warp.")

HEAD = (
    "robot",
    "Ulna, float32",
    "two threads",
    "MuJoCo Warp",
    "ratio",
    "its error",
    "Ulna compiled",
    "Warp compiled",
)


def rounded(number: float) -> str:
    return f"{number:.0e}"


def of_ours(robot: Robot, samples: int) -> tuple[Any, list[np.ndarray], float]:
    """The kernel, its arguments, and how long its first batch takes."""
    rng, start = np.random.default_rng(0), time.perf_counter()
    kernel = robot.kernel("forward_dynamics", dtype=np.float32)
    arrays = [
        x.astype(np.float32)
        for x in (
            robot.random_configuration((samples,), seed=1),
            *rng.standard_normal((2, samples, robot.nv)),
        )
    ]
    kernel(*arrays)
    return kernel, arrays, time.perf_counter() - start


def of_warp(peer: Any, samples: int) -> tuple[Any, float, float]:
    """A call of a batch by MuJoCo Warp, how long the first one takes, and its largest error beside the largest number."""
    rng = np.random.default_rng(0)
    q, v, tau = rng.standard_normal((samples, peer.nq)), *rng.standard_normal((2, samples, peer.nv))
    one = mujoco.MjData(peer)
    mujoco.mj_normalizeQuat(peer, q[0])
    start = time.perf_counter()
    model = mujoco_warp.put_model(peer)
    batch = mujoco_warp.make_data(peer, nworld=samples)
    for target, numbers in ((batch.qpos, q), (batch.qvel, v), (batch.qfrc_applied, tau)):
        target.assign(numbers.astype(np.float32))

    def call() -> None:
        mujoco_warp.forward(model, batch)
        warp.synchronize()

    call()
    took = time.perf_counter() - start
    one.qpos[:], one.qvel[:], one.qfrc_applied[:] = q[0], v[0], tau[0]
    mujoco.mj_forward(peer, one)
    error = np.abs(batch.qacc.numpy()[0] - one.qacc).max() / np.abs(one.qacc).max()
    return call, took, float(error)


def row(label: str, samples: int) -> list[str]:
    """One robot."""
    path, _ = data.files(ROBOTS[label])
    floating = data.DESCRIPTIONS[ROBOTS[label]].floating
    model, peer = load_model(path), mujoco_model(path, floating)
    if floating and not any(isinstance(joint.kind, FreeFlyer) for joint in model.joints):
        model = with_root_joint(model, FreeFlyer())
    if peer is None:
        sys.exit(f"MuJoCo has no model of {label}.")
    kernel, arrays, ours = of_ours(Robot(model), samples)
    out = kernel(*arrays)
    call, theirs, error = of_warp(peer, samples)
    calls = [lambda: kernel(*arrays, out=out), lambda: kernel(*arrays, out=out, threads=2), call]
    alone, two, warps = (seconds / samples for seconds in medians(calls, 5, 0.1))
    times = [shown(alone), shown(two), shown(warps), f"{warps / alone:.0f}", rounded(error)]
    return [label, *times, shown(ours), shown(theirs)]


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--samples", type=int, default=1000)
    parser.add_argument("robots", nargs="*", help=f"out of {', '.join(LABELS[:5])}; default Panda and G1")
    given = parser.parse_args()
    warp.config.quiet = True
    warp.set_device("cpu")
    rows = [row(label, given.samples) for label in given.robots or ("Panda", "G1")]
    print(table(f"Batches of {given.samples:,} samples by MuJoCo Warp on the CPU, a sample", HEAD, rows))


if __name__ == "__main__":
    main()
