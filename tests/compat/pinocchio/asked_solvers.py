"""Random problems of constraints and what the iterative solvers make of them: asked of both packages, by a test.

`python asked_solvers.py out.json solver first count`: the seeds from `first` on, each a problem and settings; without numbers,
problems in which much is zero.
"""

from __future__ import annotations

import json
import sys
from typing import Any

import numpy as np
import pinocchio as pin

RULES = ("OSQP", "OSQP", "SPECTRAL", "LINEAR", "CONSTANT")
KINDS = ("contacts", "frictionless", "points", "frames", "limits", "frictions", "mixed")
NUMBERS = ("primal_feasibility", "dual_feasibility", "complementarity")
RECORDED = (*NUMBERS, "dual_feasibility_ncp")
OF_ADMM = ("rho", "mu_prox")


def constraints(model: Any, kind: str, rng: Any) -> list[Any]:
    """One to four constraints of a kind, or some of each."""
    joints = list(range(1, model.njoints))
    if kind == "limits":
        return [pin.JointLimitConstraintModel(model, sorted(rng.choice(joints, 3, False).tolist()))]
    if kind == "frictions":
        bound = rng.uniform(0.0, 1.0, model.nv)
        return [
            pin.JointFrictionConstraintModel(
                model, sorted(rng.choice(joints, 4, False).tolist()), -bound, bound
            )
        ]
    if kind == "mixed":
        some = [one for name in KINDS[:-1] for one in constraints(model, name, rng)[:2]]
        return [some[k] for k in rng.permutation(len(some))[: rng.integers(2, 7)]]
    made = []
    for _ in range(rng.integers(1, 5)):
        classes = {"points": pin.PointAnchorConstraintModel, "frames": pin.FrameAnchorConstraintModel}
        made.append(classes.get(kind, pin.PointContactConstraintModel)(model, int(rng.choice(joints))))
        if kind in ("contacts", "frictionless"):
            made[-1].setFriction(0.0 if kind == "frictionless" else float(rng.choice([0.1, 0.5, 1.0, 1.5])))
    return made


def problem(seed: int) -> tuple[Any, Any, Any, Any, Any]:
    """Delassus operator, velocities, constraints, their data, and the random numbers that come next."""
    rng = np.random.default_rng(seed)
    model = pin.buildSampleModelManipulator()
    model.lowerPositionLimit[:], model.upperPositionLimit[:] = -1.0, 1.0
    models, data = pin.StdVec_ConstraintModel(), model.createData()
    models.extend(constraints(model, KINDS[seed % len(KINDS)], rng))
    datas = pin.StdVec_ConstraintData()
    q = rng.uniform(-1.0, 1.0, model.nq)
    pin.forwardKinematics(model, data, q)
    pin.computeJointJacobians(model, data, q)
    pin.crba(model, data, q)
    datas.extend([one.createData() for one in models])
    for one, its in zip(models, datas, strict=True):
        one.calc(model, data, its)
    size = sum(one.residualSize() for one in models)
    if seed % 5 == 4:
        decomposition = pin.ConstraintCholeskyDecomposition(model, data, models, datas)
        decomposition.compute(model, data, models, datas, float(rng.choice([1e-6, 1e-2])))
        return decomposition, rng.normal(size=size), models, datas, rng
    rank = size + int(rng.integers(-2, 6))
    root = rng.normal(size=(size, max(rank, 1))) * rng.choice([0.1, 1.0, 10.0])
    G = root @ root.T / size
    if seed % 3 == 0:
        G += 0.1 * np.eye(size)
    delassus = pin.DelassusOperatorDense(G)
    if seed % 4 == 1:
        delassus.updateCompliance(rng.uniform(0.0, 0.1, size))
    if seed % 4 == 2:
        delassus.updateDamping(1e-3)
    return delassus, rng.normal(size=size), models, datas, rng


def common(settings: Any, rng: Any) -> None:
    """Settings of both solvers."""
    settings.max_iterations, settings.solve_ncp = int(rng.choice([0, 1, 5, 100, 300])), bool(rng.integers(2))
    tolerance = float(rng.choice([1e-3, 1e-6, 1e-8]))
    settings.absolute_feasibility_tol = settings.absolute_complementarity_tol = tolerance
    settings.relative_feasibility_tol = float(rng.choice([0.0, 1e-6, 1e-3]))
    settings.relative_complementarity_tol = 1e-6


def chosen(name: str, rng: Any) -> Any:
    """Settings of a solver."""
    settings = getattr(pin, f"{name}SolverSettings")()
    common(settings, rng)
    if name == "PGS":
        settings.over_relaxation = float(rng.choice([1.0, 1.0, 0.7, 1.4]))
        return settings
    settings.admm_update_rule = getattr(pin.ADMMUpdateRule, str(rng.choice(RULES)))
    settings.admm_proximal_rule = getattr(
        pin.ADMMProximalRule, str(rng.choice(["MANUAL", "MANUAL", "AUTOMATIC"]))
    )
    settings.anderson_capacity = int(rng.choice([0, 0, 1, 2, 4, 8]))
    settings.mu_prox = float(rng.choice([1e-6, 1e-6, 1e-3, 1e-1]))
    settings.tau, settings.tau_prox = float(rng.choice([0.5, 0.5, 0.9])), float(rng.choice([1.0, 1.0, 0.5]))
    settings.dual_momentum = float(rng.choice([0.0, 0.0, 0.0, 0.1]))
    settings.ratio_primal_dual = float(rng.choice([10.0, 10.0, 3.0]))
    settings.rho_min_update_frequency = int(rng.choice([1, 1, 5]))
    settings.rho_init = None if rng.integers(3) else float(rng.choice([0.01, 1.0, 10.0]))
    settings.lanczos_size = int(rng.choice([2**31 - 1, 2**31 - 1, 3]))
    settings.max_delassus_decomposition_updates = int(rng.choice([2**31 - 1, 2**31 - 1, 4]))
    return settings


def answer(solver: Any, settings: Any, result: Any, size: int) -> dict[str, Any]:
    """All that a solver says."""
    said = {name: getattr(result, name) for name in ("iterations", "converged", *NUMBERS, "problem_size")}
    said["impulses"] = np.asarray(result.retrieveConstraintImpulses()).tolist()
    said["velocities"] = np.asarray(result.retrieveConstraintVelocities()).tolist()
    for name in ("retrievePrimalSolution", "retrieveDualSolution"):
        getattr(result, name)(out := np.zeros(size))
        said[name] = out.tolist()
    recorded = {name: list(getattr(solver.stats, name)) for name in RECORDED}
    if isinstance(result, pin.ADMMSolverResult):
        for name in (*OF_ADMM, "spectral_rho_power", "delassus_decomposition_update_count"):
            said[name] = getattr(result, name)
        result.retrieveDesaxceTerm(out := np.zeros(size))
        said["shift"] = out.tolist()
        for name in (*OF_ADMM, "anderson_size"):
            recorded[name] = list(getattr(solver.stats, name))
        said["iterations recorded"] = solver.stats.iterations
        said["noise"] = max(
            [0.0, *solver.stats.linear_system_residual, *solver.stats.linear_system_consistency]
        )
    said["records"], said["size"] = recorded, solver.stats.size()
    return said


def asked(name: str, seed: int) -> list[dict[str, Any]]:
    """Three solutions: cold, from a guess, and again with the same result."""
    delassus, g, models, datas, rng = problem(seed)
    decomposition = None
    if isinstance(delassus, pin.ConstraintCholeskyDecomposition):
        decomposition, delassus = delassus, delassus.getDelassusOperatorCholeskyExpression()
    settings, result = chosen(name, rng), getattr(pin, f"{name}SolverResult")()
    solver, said = getattr(pin, f"{name}ConstraintSolver")(len(g)), []
    for time in range(3):
        settings.stat_record = time != 2
        if time == 1:
            result.setConstraintImpulseGuess(rng.normal(size=len(g)))
        if time >= 1 and rng.integers(2):
            result.setConstraintVelocityGuess(rng.normal(size=len(g)))
        if name == "ADMM" and time == 2:
            settings.warmstart_rho_with_previous_result = bool(rng.integers(2))
        try:
            returned = solver.solve(delassus, g, models, datas, settings, result)
        except ValueError:  # the rule SPECTRAL, where all eigenvalues are the same
            return [
                *said,
                {"iterations": -1, "converged": False, "impulses": [0.0], "records": {}, "capacity": 0},
            ]
        said.append({"returned": returned, **answer(solver, settings, result, len(g))})
        said[-1]["capacity"] = getattr(settings, "anderson_capacity", 0)
        said[-1]["diagonal after"] = np.diag(np.asarray(delassus.matrix())).tolist()
    del decomposition  # Pinocchio's operator refers to it
    return said


DEGENERATE = {
    "nothing moves": (np.zeros((3, 3)), {"max_iterations": 20}),
    "a row does not move": (np.diag([1.0, 1.0, 0.0]), {"max_iterations": 20}),
    "rows are the same": (np.ones((3, 3)), {"max_iterations": 30}),
    "no iteration after the first": (np.eye(3), {"max_iterations": 0}),
    "no tolerance": (
        np.eye(3) + 0.3,
        {
            "max_iterations": 7, "absolute_feasibility_tol": 0.0, "relative_feasibility_tol": 0.0,
            "absolute_complementarity_tol": 0.0,
        },
    ),
    "apart": (np.eye(3), {}),
}  # fmt: skip
OF_ADMM_ALONE = (
    {"rho_momentum": 0.5},
    {"rho_momentum": 1.0},
    {"rho_update_ratio": 3.0},
    {"rho_min": 0.0, "rho_init": 1e-9},
    {"rho_max": 0.01},
    {"max_delassus_decomposition_updates": 2},
)


def asked_degenerate(name: str) -> dict[str, Any]:
    """Small problems in which much is zero, and rare settings."""
    model = pin.buildSampleModelManipulator()
    data = model.createData()
    pin.forwardKinematics(model, data, np.zeros(6))
    bounds = np.array([0.1, -1.0, -1.0, 0.0, 0.0, 0.0]), np.ones(6)  # zero is not between the first ones
    kinds = {
        "contact": pin.PointContactConstraintModel(model, 3),
        "smooth contact": pin.PointContactConstraintModel(model, 3),
        "anchor": pin.PointAnchorConstraintModel(model, 4),
        "friction": pin.JointFrictionConstraintModel(model, [1, 2, 3], *bounds),
    }
    kinds["smooth contact"].setFriction(0.0)
    cases = [(kind, *DEGENERATE[case], case) for kind in kinds for case in DEGENERATE]
    if name == "ADMM":
        cases += [("contact", np.eye(3) + 0.2, chosen, str(chosen)) for chosen in OF_ADMM_ALONE]
    said = {}
    for kind, G, changed, case in cases:
        models, datas = pin.StdVec_ConstraintModel(), pin.StdVec_ConstraintData()
        models.extend([kinds[kind]])
        datas.extend([kinds[kind].createData()])
        models[0].calc(model, data, datas[0])
        settings, result = getattr(pin, f"{name}SolverSettings")(), getattr(pin, f"{name}SolverResult")()
        for setting, value in changed.items():
            setattr(settings, setting, value)
        solver, g = getattr(pin, f"{name}ConstraintSolver")(3), np.array([1.0, 0.5, -1.0])
        settings.stat_record = True
        solver.solve(pin.DelassusOperatorDense(G), g, models, datas, settings, result)
        said[f"{kind}, {case}"] = answer(solver, settings, result, 3)
    return said


if __name__ == "__main__":
    target, solver_name, *numbers = sys.argv[1:]
    first, count = map(int, numbers or (0, 0))
    answers = [asked(solver_name, seed) for seed in range(first, first + count)]
    with open(target, "w", encoding="utf-8") as file:
        file.write(json.dumps({"file": pin.__file__, "answers": answers or asked_degenerate(solver_name)}))
