"""Dynamics of Ulna beside Pinocchio, from Python, in one run: single calls and batches, medians and ratios.

    python benchmarks/dynamics.py [--quick] [robot ...]

Needs `pin` and `example-robot-data`. Both libraries read the same URDF; the fingers of the Panda are locked in both, and
robots that walk have a free flyer in both. The batch is compared with a Python loop over Pinocchio's function, and, where
Pinocchio has one, with its own `...InParallel` on one thread. How long kernels take to make is told by `compile.py`. One
core; run it on a quiet machine.
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
from derivatives import ROBOTS, load

from ulna.robot import Robot

PEERS: dict[str, tuple[int, Callable[..., object]]] = {
    "inverse_dynamics": (3, pin.rnea),
    "bias_forces": (2, pin.nonLinearEffects),
    "gravity_forces": (1, pin.computeGeneralizedGravity),
    "mass_matrix": (1, pin.crba),
    "inverse_mass_matrix": (1, pin.computeMinverse),
    "forward_dynamics": (3, pin.aba),
    "coriolis_matrix": (2, pin.computeCoriolisMatrix),
    "mechanical_energy": (2, pin.computeMechanicalEnergy),
    "center_of_mass": (1, pin.centerOfMass),
    "center_of_mass_jacobian": (1, pin.jacobianCenterOfMass),
    "centroidal_momentum": (2, pin.computeCentroidalMomentum),
    "centroidal_matrix": (1, pin.computeCentroidalMap),
}
"""For each kernel how many of q, v, and a or tau it takes, and what Pinocchio has for it."""

PARALLEL = {"inverse_dynamics": pin.rneaInParallel, "forward_dynamics": pin.abaInParallel}


def compare(label: str, robot: Robot, peer: pin.Model, name: str, count: int) -> list[str]:
    """A row of times."""
    arguments, function = PEERS[name]
    memory, rng = peer.createData(), np.random.default_rng(0)
    one = [robot.random_configuration(seed=0), *rng.standard_normal((2, robot.nv))][:arguments]
    many = [robot.random_configuration((count,), seed=1), *rng.standard_normal((2, count, robot.nv))][
        :arguments
    ]
    theirs = [pin.randomConfiguration(peer), *rng.standard_normal((2, peer.nv))]
    few = [
        [pin.randomConfiguration(peer), *rng.standard_normal((2, peer.nv))] for _ in range(min(count, 1000))
    ]

    kernel = robot.kernel(name)
    out = kernel(*many)

    def call() -> object:
        return function(peer, memory, *theirs[:arguments])

    def loop() -> None:
        for state in few:
            function(peer, memory, *state[:arguments])

    empty = medians([lambda: None])[0]  # the lambda around each candidate costs both sides the same
    ours, single = (max(t - empty, 1e-9) for t in medians([lambda: kernel(*one), call]))
    batch, looped = medians([lambda: kernel(*many, out=out), loop], repeat=7, seconds=0.05)
    batch, looped = batch / count, looped / len(few)
    row = [label, name, shown(ours), shown(single), f"{single / ours:.1f}", shown(batch), shown(looped), f"{looped / batch:.0f}"]  # fmt: skip
    row.append(f"{in_parallel(peer, name, few) / batch:.0f}" if name in PARALLEL else "")
    return row


def in_parallel(peer: pin.Model, name: str, states: list[list[np.ndarray]]) -> float:
    """Seconds of one evaluation in Pinocchio's own batch, on one thread; its columns are the samples."""
    pool = pin.ModelPool(peer, 1)
    arrays = [np.asfortranarray(np.stack(column, axis=1)) for column in zip(*states, strict=True)]
    result = np.zeros((peer.nv, len(states)), order="F")
    return medians([lambda: PARALLEL[name](1, pool, *arrays, result)], repeat=7, seconds=0.05)[0] / len(
        states
    )


def main() -> None:
    """Prints the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="smaller batches")
    parser.add_argument("robots", nargs="*", help=f"out of {', '.join(ROBOTS)}; default all")
    given = parser.parse_args()
    count = 1_000 if given.quick else 10_000
    rows = []
    for label in given.robots or ROBOTS:
        model, peer = load(ROBOTS[label])
        robot = Robot(model)
        rows += [compare(label, robot, peer, name, count) for name in PEERS]
    print(
        f"Python {sys.version.split()[0]}, NumPy {np.__version__}, pin {pin.__version__}, {platform.machine()}\n"
    )
    head = ["robot", "kernel", "one call", "pin", "ratio", "in a batch", "loop over pin", "ratio", "InParallel, ratio"]  # fmt: skip
    print(table(f"Dynamics: one call from Python; batches of {count:,}, one core", head, rows))


if __name__ == "__main__":
    main()
