"""Optimal control beside Crocoddyl, from Python, in one run: derivatives of all knots, and DDP to convergence.

    python benchmarks/optimal_control.py [--quick]

Needs `example-robot-data` and `pip install crocoddyl==3.2.1 pin==4.0.0`: with pin 4.1 this version of Crocoddyl crashes in the
derivatives of frames. Both libraries read the same URDF and solve the same problem: 100 knots of 10 ms,
from rest to a point with little torque and speed; integrators and costs are equal, which is checked first. One core.
"""

from __future__ import annotations

import argparse
import os
import platform
import sys
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import crocoddyl  # pyright: ignore[reportMissingImports]
import numpy as np
from _timing import medians, shown, table
from derivatives import load

from ulna import control
from ulna.robot import Robot

KNOTS, DT = 100, 0.01
ROBOTS = {"Panda": "panda_hand", "UR5": "tool0"}


def ours(robot: Robot, frame: str) -> tuple[control.Stage, control.TerminalStage]:
    """The problem in Ulna."""
    stage = control.stage(robot, lambda q, v, u: np.concatenate([0.1 * v, 0.01 * u]), dt=DT)

    def miss(q: Any, v: Any, target: Any) -> Any:
        return np.concatenate([100.0 * (robot.fk(q, frame)[:3, 3] - target), v])

    return stage, stage.terminal(miss, target=(3,))


def theirs(peer: Any, frame: str, x0: np.ndarray, target: np.ndarray, limit: Any = np.inf) -> Any:
    """The problem in Crocoddyl, whose integrator multiplies costs by its step; `limit` bounds the torques."""
    state = crocoddyl.StateMultibody(peer)
    actuation = crocoddyl.ActuationModelFull(state)
    speed = np.concatenate([np.zeros(peer.nv), np.ones(peer.nv)])

    def model(dt: float, weights: dict[str, float]) -> Any:
        costs = crocoddyl.CostModelSum(state)
        residuals = {
            "v": crocoddyl.CostModelResidual(
                state,
                crocoddyl.ActivationModelWeightedQuad(speed),
                crocoddyl.ResidualModelState(state, state.nv),
            ),
            "u": crocoddyl.CostModelResidual(state, crocoddyl.ResidualModelControl(state)),
            "p": crocoddyl.CostModelResidual(
                state, crocoddyl.ResidualModelFrameTranslation(state, peer.getFrameId(frame), target)
            ),
        }
        for name, weight in weights.items():
            costs.addCost(name, residuals[name], weight)
        free = crocoddyl.DifferentialActionModelFreeFwdDynamics(state, actuation, costs)
        step = crocoddyl.IntegratedActionModelEuler(free, dt)
        step.u_lb, step.u_ub = np.full(peer.nv, -1.0) * limit, np.ones(peer.nv) * limit
        return step

    running = model(DT, {"v": 0.1**2 / DT, "u": 0.01**2 / DT})
    problem = crocoddyl.ShootingProblem(x0, [running] * KNOTS, model(0.0, {"p": 100.0**2, "v": 1.0}))
    problem.nthreads = 1
    return problem


def compare(label: str, repeat: int) -> list[list[str]]:
    """Two rows: derivatives of a knot, and a whole search."""
    model, peer = load(label.lower())
    robot, frame = Robot(model), ROBOTS[label]
    q = np.array([0.1, -0.8, 0.2, -1.9, 0.3, 1.2, 0.4])[: robot.nq]
    x0, target = np.concatenate([q, np.zeros(robot.nv)]), robot.fk(q, frame)[:3, 3] + [-0.1, 0.15, 0.1]
    hold = np.tile(robot.gravity_forces(q), (KNOTS, 1))
    stage, end = ours(robot, frame)
    problem = theirs(peer, frame, x0, target)
    xs, us = list(problem.rollout(list(hold))), list(hold)
    X, out = np.array(xs[:-1]), stage.derivatives(np.array(xs[:-1]), hold)

    def differentiate() -> None:
        problem.calc(xs, us)
        problem.calcDiff(xs, us)

    differentiate()
    for mine, name in ((out[1], "Fx"), (out[2], "Fu"), (out[4], "Lx"), (out[6], "Lxx")):
        np.testing.assert_allclose(mine[3], getattr(list(problem.runningDatas)[3], name), atol=1e-8)

    def search(limit: Any = np.inf) -> Any:
        return control.ddp(stage, end, x0, hold, terminal_parameters=(target,), limits=limit, tolerance=1e-6)

    def their_search(problem: Any = problem, kind: Any = crocoddyl.SolverDDP) -> Any:
        solver = kind(problem)
        solver.th_stop = 1e-6
        solver.solve(xs, us, 100, True)
        return solver

    per_knot = [
        t / KNOTS for t in medians([lambda: stage.derivatives(X, hold, out=out), differentiate], repeat)
    ]
    limit = 0.8 * np.abs(search().controls).max(axis=0)
    limited = theirs(peer, frame, x0, target, limit)
    return [
        [label, "derivatives of a knot", *map(shown, per_knot), f"{per_knot[1] / per_knot[0]:.1f}", ""],
        *searches(label, "", search, their_search, repeat),
        *searches(
            label, ", torques limited", lambda: search(limit), lambda: their_search(limited, crocoddyl.SolverBoxDDP),
            repeat,
        ),
    ]  # fmt: skip


def searches(label: str, kind: str, ours: Any, theirs: Any, repeat: int) -> list[list[str]]:
    """Two rows: an iteration of a search, and all of them."""
    solution, solver = ours(), theirs()
    whole = medians([ours, theirs], repeat)
    counts = (len(solution.iterations), solver.iter + 1)
    each = [t / n for t, n in zip(whole, counts, strict=True)]
    costs, number = f"cost {solution.cost:.5f}; {solver.cost:.5f}", f"{counts[0]}; {counts[1]} iterations"
    return [
        [label, f"one iteration{kind}", *map(shown, each), f"{each[1] / each[0]:.1f}", costs],
        [label, f"to convergence{kind}", *map(shown, whole), f"{whole[1] / whole[0]:.1f}", number],
    ]


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer repetitions")
    given = parser.parse_args()
    print(
        f"Python {sys.version.split()[0]}, NumPy {np.__version__}, crocoddyl {crocoddyl.__version__}, {platform.machine()}\n"
    )
    rows = [row for label in ROBOTS for row in compare(label, 5 if given.quick else 21)]
    print(
        table(
            "Optimal control, 100 knots",
            ["robot", "what", "Ulna", "crocoddyl", "ratio", "Ulna; crocoddyl"],
            rows,
        )
    )


if __name__ == "__main__":
    main()
