"""Chains of 100 to 5,000 joints: compile time and calls by loops over joints, by straight-line code, and by Pinocchio.

    python benchmarks/large_robots.py            # medians in turns
    python benchmarks/large_robots.py 100 1000   # these sizes
    python benchmarks/large_robots.py 100 coriolis_matrix   # of these quantities

The first call of straight-line code is traced and compiled anew, without the disk cache; it is left out where it would
take more than about five seconds. That of loops compiles nothing but a procedure that all models share, and is shown as
it is once that is on disk. Pinocchio's data grow with the cube of the joints: it takes part up to 200 joints.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable
from typing import Any

os.environ["ULNA_QUIET"] = "1"

import numpy as np
from _timing import medians, shown, table

from ulna import compiler, kernels
from ulna.model import Model, ModelBuilder, Revolute
from ulna.quantities import QUANTITIES
from ulna.quantities.size import estimated_nodes
from ulna.spatial import SE3, Inertia

SIZES = (50, 100, 200, 500, 1000, 5000)
MOST_TRACED, MOST_FOR_PINOCCHIO, MOST_IN_MATRICES = 60_000, 200, 2000
NAMES = (
    "fk", "jacobian", "inverse_dynamics", "forward_dynamics", "center_of_mass", "mechanical_energy", "centroidal_matrix",
    "centroidal_derivatives", "jacobian_dot", "frame_acceleration_derivatives", "mass_matrix", "coriolis_matrix", "inverse_mass_matrix", "inverse_dynamics_derivatives",
    "forward_dynamics_derivatives", "joint_torque_regressor", "hessian",
)  # fmt: skip
SQUARE = NAMES[-7:]
"""Those whose results grow with the square of the joints."""


def chain(n: int) -> Model:
    """A chain of n revolute joints with inclined axes."""
    body = Inertia.from_com(1.0, (0.05, -0.02, 0.08), np.diag([0.1, 0.2, 0.15]))
    axes = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    builder = ModelBuilder(f"chain{n}").add_link("l0")
    for k in range(1, n + 1):
        place = SE3.trans(0.1, 0.02, 0.03) @ SE3.rx(0.3 + 0.01 * (k % 50))
        builder.add_link(f"l{k}", body)
        builder.add_joint(f"j{k}", Revolute(axes[k % 3]), f"l{k - 1}", f"l{k}", place)
    return builder.build()


def by_pinocchio(model: Model, name: str, q: Any, v: Any, u: Any) -> Callable[[], Any] | None:
    """What Pinocchio calls the quantity; None without it, and where its data would take gigabytes."""
    try:
        import pinocchio as pin
    except ImportError:
        return None
    if model.nv > MOST_FOR_PINOCCHIO:
        return None
    robot = pin.Model()
    for k, (joint, inertia) in enumerate(zip(model.joints, model.inertias, strict=True)):
        x, y, _z = joint.kind.axis
        kind = pin.JointModelRX if x else pin.JointModelRY if y else pin.JointModelRZ
        place = pin.SE3(joint.placement.rotation.copy(), joint.placement.translation.copy())
        robot.addJoint(k, kind(), place, joint.name)
        body = pin.Inertia(inertia.mass, inertia.com.copy(), inertia.inertia.copy())
        robot.appendBodyToJoint(k + 1, body, pin.SE3.Identity())
    data = robot.createData()
    return {
        "fk": lambda: pin.forwardKinematics(robot, data, q),
        "jacobian": lambda: pin.computeJointJacobian(robot, data, q, model.nv),
        "inverse_dynamics": lambda: pin.rnea(robot, data, q, v, u),
        "forward_dynamics": lambda: pin.aba(robot, data, q, v, u),
        "jacobian_dot": lambda: pin.computeJointJacobiansTimeVariation(robot, data, q, v),
        "frame_acceleration_derivatives": lambda: pin.computeForwardKinematicsDerivatives(
            robot, data, q, v, u
        ),
        "hessian": lambda: pin.computeJointKinematicHessians(robot, data, q),
        "mass_matrix": lambda: pin.crba(robot, data, q),
        "inverse_mass_matrix": lambda: pin.computeMinverse(robot, data, q),
        "center_of_mass": lambda: pin.centerOfMass(robot, data, q),
        "mechanical_energy": lambda: pin.computeMechanicalEnergy(robot, data, q, v),
        "centroidal_matrix": lambda: pin.computeCentroidalMap(robot, data, q),
        "centroidal_derivatives": lambda: pin.computeCentroidalDynamicsDerivatives(robot, data, q, v, u),
        "joint_torque_regressor": lambda: pin.computeJointTorqueRegressor(robot, data, q, v, u),
        "coriolis_matrix": lambda: pin.computeCoriolisMatrix(robot, data, q, v),
        "inverse_dynamics_derivatives": lambda: pin.computeRNEADerivatives(robot, data, q, v, u),
        "forward_dynamics_derivatives": lambda: pin.computeABADerivatives(robot, data, q, v, u),
    }[name]


def timed(make: Callable[[], Any]) -> tuple[Any, float]:
    """What a function returns, and how long it takes [s]."""
    start = time.perf_counter()
    made = make()
    return made, time.perf_counter() - start


def row(model: Model, name: str) -> list[str]:
    """One line of the table."""
    rng = np.random.default_rng(0)
    q, v, u = rng.standard_normal((3, model.nv)) / np.sqrt(model.nv)
    named = {"q": q, "v": v, "a": u, "tau": u}
    arrays = [named[array] for array in QUANTITIES[name].arrays]
    kernels.looped(model, name)(*arrays)  # type: ignore[misc]  # the procedure is on disk from now on

    def first_loop() -> Any:
        made = kernels.looped(model, name)
        made(*arrays)  # type: ignore[misc]
        return made

    looped, loop_seconds = timed(first_loop)
    calls: dict[str, Callable[[], Any]] = {"loops": lambda: looped(*arrays)}
    batch = [np.tile(x, (64, 1)) for x in arrays]
    compiled, seconds = None, 0.0
    if estimated_nodes(model, QUANTITIES[name], {}) < MOST_TRACED:
        os.environ["ULNA_CACHE"] = "0"
        compiled, seconds = timed(lambda: compiler.compile(kernels.function(model, name)))
        del os.environ["ULNA_CACHE"]
        calls["straight"] = lambda: compiled(*arrays)
    peer = by_pinocchio(model, name, q, v, u)
    if peer is not None:
        calls["pinocchio"] = peer
    if name not in SQUARE:
        calls["loops, batch"] = lambda: looped(*batch)
        if compiled is not None:
            compiled(*batch)
            calls["straight, batch"] = lambda: compiled(*batch)
    took = dict(zip(calls, medians([*calls.values()], repeat=11, seconds=0.01), strict=True))
    cell = lambda key, many=1: shown(took[key] / many) if key in took else "-"  # noqa: E731
    first = shown(seconds) if compiled is not None else "-"
    return [
        f"{model.nv:,}", name, shown(loop_seconds), first, cell("loops"), cell("straight"), cell("pinocchio"),
        cell("loops, batch", 64), cell("straight, batch", 64),
    ]  # fmt: skip


def main() -> None:
    """Prints the table, and each row on the error stream when it is measured."""
    os.environ.pop("ULNA_CACHE", None)
    sizes = [int(word) for word in sys.argv[1:] if word.isdigit()] or SIZES
    names = [name for name in NAMES if name in sys.argv[1:]] or NAMES
    header = (
        "joints", "quantity", "first: loops", "straight-line", "call: loops", "straight-line", "pin",
        "64 at once: loops", "straight-line",
    )  # fmt: skip
    rows = []
    for n in sizes:
        model = chain(n)
        for name in names:
            if n <= MOST_IN_MATRICES or name not in SQUARE:
                rows.append(row(model, name))
                print(*rows[-1], sep=", ", file=sys.stderr, flush=True)
    print(table("Large robots", header, rows))


if __name__ == "__main__":
    main()
