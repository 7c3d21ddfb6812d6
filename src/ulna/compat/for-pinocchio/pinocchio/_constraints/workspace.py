"""Intermediate results under constraints, computed when they are read, of the state and the numbers of their call."""

from __future__ import annotations

from typing import Any

import numpy as np

from pinocchio._constraints.kernels import right_side
from pinocchio._data.algorithm import Deferred
from pinocchio._data.articulated_bodies import articulated_bodies, placed
from pinocchio._data.evaluated_model import EvaluatedModel, numbers_of
from pinocchio._data.states import FieldStates
from pinocchio._model.building import KinematicTree
from pinocchio._model.joint_data import states
from pinocchio._spatial.se3 import SE3
from ulna.typing import Floats


def inertias_of_constraints(model: KinematicTree, shapes: Any, places: Any, damping: float) -> Floats:
    """The inertias that constraints stand for in the frames of their first joints, where they may give way.

    Args:
        shapes: For each constraint its rows, whether they are local, and its two joints.
        places: Both placements (2, 4, 4) of each constraint.
        damping: By how much each row gives way [1/kg].

    Returns:
        Matrices (njoints, 6, 6).
    """
    added = np.zeros((model.njoints, 6, 6))
    for (rows, _, joint, _), place in zip(shapes, places, strict=True):
        X = SE3(place[0]).toActionMatrixInverse()[:rows]
        added[joint] += X.T @ X / damping
    return added


def _solution(data: FieldStates, evaluated: EvaluatedModel, fields: tuple[str, ...]) -> None:
    """The forces, the right side of the constraints, and [-forces, accelerations]."""
    solved = data._motion_solution
    for name in fields:
        if name == "lambda_c_prox":
            values = solved.forces.copy()
        elif name == "primal_dual_contact_solution":
            values = np.concatenate([-solved.forces, solved.a])
        else:
            values = -right_side(evaluated.model, solved.shapes, *solved.state)[1]
        data._arrays[name] = values


def _propagators(data: FieldStates, compiled: Any, fields: tuple[str, ...], q: Floats) -> None:
    shapes, places, damping = data._delassus
    added = inertias_of_constraints(data._model, shapes, places, damping) if damping else None
    _fill_bodies(data, compiled, fields, q, added)


def _fill_bodies(
    data: FieldStates, compiled: Any, fields: tuple[str, ...], q: Floats, added: Floats | None
) -> None:
    """Terms of the articulated bodies in the world [Featherstone 2008, section 7.3].

    `oL` is 1 - S D^-1 U^T, which takes the acceleration of the joint before to this one's, `oK` is S D^-1 S^T.
    """
    joints, numbers = states(data._model.joints, q, None), numbers_of(compiled)
    bodies = articulated_bodies(data._model, numbers, joints, added)
    places = placed(data._model, numbers, joints)[1:]
    for k, (M, body) in enumerate(zip(places, bodies, strict=True), start=1):
        X, back = M.toActionMatrix(), M.toActionMatrixInverse()
        S, U = X @ joints[k].subspace, back.T @ body.U
        matrices = {
            "oL": np.eye(6) - S @ body.Dinv @ U.T,
            "oK": S @ body.Dinv @ S.T,
            "oYaba_augmented": back.T @ body.inertia @ back,
            "of_augmented": np.zeros(6),
        }
        for name in fields:
            data._arrays[name][k] = matrices[name]


def _impulse(data: FieldStates, _: Any, fields: tuple[str, ...]) -> None:
    """[-impulses, jump of the velocity]."""
    solved = data._constraint_solution
    for name in fields:
        data._arrays[name] = np.concatenate([-solved.forces, solved.a])


SOLUTION = dict.fromkeys(
    ("lambda_c_prox", "primal_dual_contact_solution", "primal_rhs_contact"), Deferred("", _solution)
)
IMPULSE = {"primal_dual_contact_solution": Deferred("", _impulse)}
PROPAGATORS = dict.fromkeys(("oL", "oK"), Deferred("q", _propagators))
AUGMENTED = Deferred("q", _fill_bodies)
"""Its state is q and the inertias of the constraints."""
