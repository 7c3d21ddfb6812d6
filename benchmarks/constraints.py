"""Constrained dynamics of Ulna beside Pinocchio, from Python, in one run: single calls and batches, medians and ratios.

    python benchmarks/constraints.py [--quick] [robot ...]

Needs `pin` and `example-robot-data`. Quadrupeds stand on four points, humanoids on two frames. Pinocchio's
`constraintDynamics` is asked as it comes, which takes the constraints for independent, and with proximal settings
(accuracy 1e-12, mu 1e-8); Ulna's kernel with mu = 0 and with its default. One core; run it on a quiet machine.
"""

from __future__ import annotations

import argparse
import os
import platform
import sys

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
import pinocchio as pin
from _timing import medians, shown, table
from derivatives import load

from ulna.algorithms import Proximal
from ulna.model import Constraint, FrameContact, PointContact
from ulna.robot import Robot

STANDING: dict[str, tuple[str, list[Constraint]]] = {
    "Solo12": ("solo12", [PointContact(f"{leg}_FOOT") for leg in ("FL", "FR", "HL", "HR")]),
    "G1": ("g1", [FrameContact(f"{side}_ankle_roll_link") for side in ("left", "right")]),
    "Talos": ("talos", [FrameContact(f"{side}_sole_link") for side in ("left", "right")]),
}
WAYS = {
    "direct": (Proximal(mu=0.0), pin.ProximalSettings(1e-12, 0.0, 1)),
    "proximal": (Proximal(), pin.ProximalSettings(1e-12, 1e-8, 20)),
}


def peers_constraints(peer: pin.Model, constraints: list[Constraint]):
    """The same contacts for Pinocchio."""
    models, datas = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
    for constraint in constraints:
        kind = pin.ContactType.CONTACT_3D if constraint.size == 3 else pin.ContactType.CONTACT_6D
        for name, _ in constraint.ends():
            frame = peer.frames[peer.getFrameId(name)]
            models.append(
                pin.RigidConstraintModel(
                    kind, peer, frame.parentJoint, frame.placement, pin.LOCAL_WORLD_ALIGNED
                )
            )
            datas.append(models[len(models) - 1].createData())
    return models, datas


def compare(
    label: str, robot: Robot, peer: pin.Model, constraints: list[Constraint], count: int
) -> list[list[str]]:
    """A row for each way to solve."""
    rng = np.random.default_rng(0)
    one = q, v, tau = robot.random_configuration(seed=0), *rng.standard_normal((2, robot.nv))
    many = [robot.random_configuration((count,), seed=1), *rng.standard_normal((2, count, robot.nv))]
    few = [
        [pin.randomConfiguration(peer), *rng.standard_normal((2, peer.nv))] for _ in range(min(count, 500))
    ]
    memory = peer.createData()
    models, datas = peers_constraints(peer, constraints)
    pin.initConstraintDynamics(peer, memory, models, datas)
    empty = medians([lambda: None])[0]
    rows = []
    for way, (solver, settings) in WAYS.items():
        options = {"constraints": tuple(constraints), "solver": solver}
        kernel = robot.kernel("constrained_dynamics", **options)

        def theirs(q, v, tau, settings=settings):
            return pin.constraintDynamics(peer, memory, q, v, tau, models, datas, settings)

        chosen = {"solver": solver} if solver.mu == 0.0 else {}

        def method(chosen=chosen):
            return robot.constraints.forward_dynamics(q, v, tau, constraints, **chosen)

        kernel(*one)
        method()
        out = kernel(*many)
        candidates = [lambda k=kernel: k(*one), method, lambda f=theirs: f(*few[0])]
        ours, by_method, single = (max(t - empty, 1e-9) for t in medians(candidates))

        def loop(f=theirs) -> None:
            for state in few:
                f(*state)

        batch, looped = medians([lambda k=kernel, o=out: k(*many, out=o), loop], repeat=7, seconds=0.05)
        batch, looped = batch / count, looped / len(few)
        operations = robot.function("constrained_dynamics", **options).operations
        times = [
            shown(ours),
            shown(by_method),
            shown(single),
            f"{single / ours:.1f}",
            shown(batch),
            shown(looped),
        ]
        rows.append([label, way, str(operations), *times, f"{looped / batch:.0f}"])
    return rows


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="smaller batches")
    parser.add_argument("robots", nargs="*", help=f"out of {', '.join(STANDING)}; default all")
    given = parser.parse_args()
    count = 500 if given.quick else 5_000
    rows = []
    for label in given.robots or STANDING:
        name, constraints = STANDING[label]
        model, peer = load(name)
        rows += compare(label, Robot(model), peer, constraints, count)
    print(
        f"Python {sys.version.split()[0]}, NumPy {np.__version__}, pin {pin.__version__}, {platform.machine()}\n"
    )
    head = ["robot", "solved", "operations", "kernel", "method", "pin", "ratio", "in a batch", "loop over pin", "ratio"]  # fmt: skip
    print(table(f"Forward dynamics on contacts; batches of {count:,}, one core", head, rows))


if __name__ == "__main__":
    main()
