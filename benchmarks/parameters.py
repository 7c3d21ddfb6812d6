"""Kernels whose masses and placements are inputs: their cost beside kernels with constants, and many robots at once.

    python benchmarks/parameters.py [--models 10000]

Needs `pin`. Its inertias, and its models, are made before the clock starts; the loop over kernels with constants makes one for
each robot, without the disk cache.
"""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Callable

os.environ["OMP_NUM_THREADS"] = "1"
os.environ["ULNA_CACHE"] = "0"

import numpy as np
import pinocchio as pin
from _timing import medians, shown, table

import ulna
from ulna import kernels
from ulna.model import parameters, with_parameters

CASES = ((), ("gravity",), ("offset",), ("inertia",), ("shift",), ("placement",), ("inertia", "placement"))
BATCH = 1000


def cost_of(name: str, quantity: str) -> list[list[str]]:
    """Operations, one call and one of a batch for each choice of parameters."""
    model = ulna.load(name).model
    rng = np.random.default_rng(0)
    single: list[Callable[[], object]] = []
    batched: list[Callable[[], object]] = []
    made = []
    for names in CASES:
        start = time.perf_counter()
        kernel = kernels.kernel(model, quantity, parameters=names)
        took = time.perf_counter() - start
        count = len(kernel.function.inputs) - len(names)
        one = [rng.uniform(-1.0, 1.0, port.shape) for port in kernel.function.inputs[:count]]
        own = [np.ascontiguousarray(parameters(model, key)) for key in names]
        many = [np.tile(x, (BATCH, *[1] * x.ndim)) for x in (*one, *own)]
        single.append(lambda kernel=kernel, args=(*one, *own): kernel(*args))
        batched.append(lambda kernel=kernel, args=many: kernel(*args))
        made.append((kernel.operations, took))
    calls, batches = medians(single), medians(batched)
    return [
        [
            f"{name} {quantity}",
            ", ".join(names) or "none, constants",
            str(operations),
            shown(took),
            f"{shown(one)} ({one / calls[0]:.1f})",
            f"{shown(batch / BATCH)} ({batch / batches[0]:.1f})",
        ]
        for names, (operations, took), one, batch in zip(CASES, made, calls, batches, strict=True)
    ]


def randomised(count: int) -> list[list[str]]:
    """Forward dynamics of `count` Pandas with different masses, one state."""
    robot = ulna.load("panda")
    rng = np.random.default_rng(0)
    q, v, tau = rng.uniform(-1.0, 1.0, (3, robot.nv))
    scale = rng.uniform(0.8, 1.2, (count, len(robot.joint_names), 1))
    inertia = (robot.parameters["inertia"].reshape(-1, 10) * scale).reshape(count, -1)
    kernel = robot.kernel("forward_dynamics", parameters=("inertia",))

    peer = pin.Model()
    for i, joint in enumerate(robot.model.joints):
        P = joint.placement
        axis = np.array(joint.kind.axis)  # type: ignore[attr-defined]
        placement = pin.SE3(np.array(P.rotation), np.array(P.translation))
        peer.addJoint(i, pin.JointModelRevoluteUnaligned(axis), placement, joint.name)
    data = peer.createData()
    few = inertia[: min(count, 500)]
    bodies = [[pin.Inertia.FromDynamicParameters(ten) for ten in row.reshape(-1, 10)] for row in few]

    def written(model: pin.Model, row: list[pin.Inertia]) -> pin.Model:
        for i, body in enumerate(row):
            model.inertias[i + 1] = body
        return model

    prepared = [written(pin.Model(peer), row) for row in bodies]
    ways = {
        "Pinocchio: write ready inertias, aba": lambda: [
            pin.aba(written(peer, row), data, q, v, tau).copy() for row in bodies
        ],
        "Pinocchio: aba on as many ready models": lambda: [
            pin.aba(model, data, q, v, tau).copy() for model in prepared
        ],
    }
    error = max(np.abs(kernel(q, v, tau, few) - np.stack(way())).max() for way in ways.values())
    together, *theirs = medians([lambda: kernel(q, v, tau, inertia), *ways.values()], repeat=7)
    start = time.perf_counter()
    for row in inertia[:5]:
        kernels.kernel(with_parameters(robot.model, {"inertia": row}), "forward_dynamics")(q, v, tau)
    constant = (time.perf_counter() - start) / 5
    ours = together / count
    print(f"largest difference from Pinocchio: {error:.1e} rad/s^2\n")
    return [
        ["one kernel, masses as input", shown(ours), shown(together), "1"],
        *(
            [way, shown(t / len(few)), "", f"{t / len(few) / ours:.0f}"]
            for way, t in zip(ways, theirs, strict=True)
        ),
        ["a kernel with constants for each", shown(constant), "", f"{constant / ours:.0f}"],
    ]


def main() -> None:
    """Prints the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--models", type=int, default=10_000)
    count = parser.parse_args().models
    rows = [
        row
        for name in ("panda", "ur5")
        for quantity in ("fk", "inverse_dynamics", "forward_dynamics", "mass_matrix")
        for row in cost_of(name, quantity)
    ]
    header = [
        "kernel",
        "parameters",
        "operations",
        "made in",
        "one call (constants: 1)",
        f"one of {BATCH} (constants: 1)",
    ]
    print(table("The cost of parameters", header, rows))
    header = ["forward dynamics", "one robot", f"{count} robots", "ratio"]
    print(table(f"{count} Pandas with different masses, one core", header, randomised(count)))


if __name__ == "__main__":
    main()
