"""Operational-space dynamics of a frame as stages in one frame, for one sample.

The symbols and the frame are those of dynamics/operational_space.py and of columns_in_one_frame.py. What is computed is
that of operational_space.py, which remains the definition: `tests/laws/test_staged_laws.py` compares.

| symbol | meaning | shape |
|---|---|---|
| J, dJ | Jacobian of the task and its rate, transposed, of the joints that move the frame | (-, 6) |
| X | M^-1 J^T | (nv, 6) |
| CX | C X | (nv, 6) |
| G | J M^-1 J^T, without damping | (6, 6) |
| E | dJ X, so that C_x = L (X^T C X - E) L | (6, 6) |
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ulna.algorithms.derivatives.columns_in_one_frame import OneFrame, suits_one_frame
from ulna.algorithms.derivatives.staged import coriolis_columns
from ulna.algorithms.dynamics.mass_matrix_factors import factors_in_rows
from ulna.algorithms.dynamics.operational_space import Task
from ulna.algorithms.dynamics.rnea_point_accelerations import gravity_forces
from ulna.algorithms.multibody.tree import chain
from ulna.compiler.forms.stages import StagedForm
from ulna.linalg import solve_spd
from ulna.model import Model
from ulna.numeric import apply, dot
from ulna.typing import Array


def stages_of_operational_inertia(model: Model, task: Task) -> StagedForm | None:
    """The inertia of a frame.

    Args:
        model: The robot; every motion must move some mass or have armature.
        task: Which motion of which frame.

    Returns:
        The form; None for robots that need another one.
    """
    path = _path(model, task)
    if not path:
        return None
    frame = _responses(OneFrame("operational_inertia", model, q=(model.nq,)), task, path)
    frame.stages.straight(lambda G: solve_spd(_damped(G, task), np.eye(6)), ("G",), ("L",))
    return frame.stages.form("L")


def stages_of_operational_gravity(model: Model, task: Task) -> StagedForm | None:
    """The forces at the frame that hold the robot against gravity.

    Args:
        model: The robot; every motion must move some mass or have armature.
        task: Which motion of which frame.

    Returns:
        The form; None for robots that need another one.
    """
    path = _path(model, task)
    if not path:
        return None
    frame = _responses(OneFrame("operational_gravity", model, q=(model.nq,)), task, path)
    frame.stages.straight(lambda q: gravity_forces(model, q), ("q",), ("g",))

    def forces(G: Array, X: Array, g: Array) -> Array:
        return solve_spd(_damped(G, task), apply(X.T, g))

    frame.stages.straight(forces, ("G", "X", "g"), ("g_x",))
    return frame.stages.form("g_x")


def stages_of_operational_coriolis(model: Model, task: Task) -> StagedForm | None:
    """The Coriolis matrix in the coordinates of a task.

    Args:
        model: The robot; every motion must move some mass or have armature.
        task: Which motion of which frame.

    Returns:
        The form; None for robots that need another one.
    """
    path = _path(model, task)
    if not path:
        return None
    frame = OneFrame("operational_coriolis", model, q=(model.nq,), v=(model.nv,))
    stages = frame.stages
    frame.kinematics()
    frame.subtrees(with_forces=False)
    coriolis_columns(frame, "C")
    _solved(frame, task, path)
    stages.straight(lambda q, v: task.jacobian_dot(model, q, v).T[path], ("q", "v"), ("dJ",))
    entries = np.argwhere(~frame.unrelated())
    stages.straight(lambda C: C[tuple(entries.T)], ("C",), ("entries",))

    def product(X: Array, C: Array) -> Array:
        rows: list[Any] = [0.0] * model.nv
        for (i, j), entry in zip(entries, C, strict=True):
            rows[i] = rows[i] + entry * X[j]
        return np.array(rows, dtype=object)

    stages.lanes(product, ("X", "entries"), ("CX",), 6)
    stages.lanes(_of_task(path), ("X", "dJ"), ("E",), 6, ("dJ",))
    stages.lanes(_of_task(slice(None)), ("CX", "X"), ("XCX",), 6, ("X",))

    def matrix(G: Array, XCX: Array, E: Array) -> Array:
        mobility = _damped(G, task)
        return solve_spd(mobility, solve_spd(mobility, XCX - E).T).T

    stages.straight(matrix, ("G", "XCX", "E"), ("C_x",))
    return stages.form("C_x", serves_batches=True)


def _path(model: Model, task: Task) -> list[int]:
    """The velocities that move the frame; none where the robot needs another form."""
    if not suits_one_frame(model):
        return []
    return sorted({k for step in chain(model, task.frame) for k in step.indices})


def _damped(G: Array, task: Task) -> Array:
    return G + task.damping**2 * np.eye(6)


def _responses(frame: OneFrame, task: Task, path: list[int]) -> OneFrame:
    """The stages of a robot at rest up to X and G."""
    frame.poses()
    frame.composite_moments()
    frame.responses()
    _solved(frame, task, path)
    return frame


def _solved(frame: OneFrame, task: Task, path: list[int]) -> None:
    """J, X and G, from s and r."""
    model, stages = frame.model, frame.stages
    frame.factors()
    stages.straight(lambda q: task.jacobian(model, q).T[path], ("q",), ("J",))

    def solved(J: Array, factors: Array) -> Array:
        row: list[Any] = [0.0] * model.nv
        for k, entry in zip(path, J, strict=True):
            row[k] = entry
        return np.array(factors_in_rows(factors, frame.paths).solve(row), dtype=object)

    stages.lanes(solved, ("J", "factors"), ("X",), 6)
    stages.lanes(_of_task(path), ("X", "J"), ("G",), 6, ("J",))


def _of_task(path: list[int] | slice) -> Callable[[Array, Array], Array]:
    """The products of entries of a column, such as one of X, with the columns of a table, such as J or dJ."""
    return lambda X, J: np.array([dot(J[:, i], X[path]) for i in range(6)], dtype=object)
