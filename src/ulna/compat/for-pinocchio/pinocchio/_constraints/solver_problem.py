"""The problem that solvers of constraints share: the Delassus matrix, and what each constraint is."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from pinocchio._constraints.anchors import PointContactConstraintModel
from pinocchio._constraints.delassus import DelassusOperator, DelassusOperatorDense
from pinocchio._constraints.joint_constraints import JointFrictionConstraintModel, JointLimitConstraintModel
from pinocchio._containers.arguments import WrongShape
from ulna.algorithms.constraints.cone_complementarity import (
    Bilateral,
    Bounded,
    Frictional,
    Kind,
    Unilateral,
)
from ulna.typing import Floats


def delassus_matrix(delassus: Any, kinds: Sequence[Kind]) -> Floats:
    """The matrix of a Delassus operator, whose size is checked.

    Args:
        kinds: The constraints.

    Returns:
        Matrix (m, m).

    Raises:
        WrongShape: The constraints have not as many rows.
    """
    operator = delassus if isinstance(delassus, DelassusOperator) else DelassusOperatorDense(delassus)
    m, rows = operator.size(), sum(kind.size for kind in kinds)
    if rows != m:
        raise WrongShape("delassus", (m, m), f"({rows}, {rows})", "The constraints have as many rows.")
    return np.ascontiguousarray(DelassusOperator.matrix(operator), dtype=float)


def constraint_kind(model: Any, data: Any) -> Kind:
    """What a constraint is for solvers.

    Args:
        model: The constraint.
        data: Its data, after `calc`.

    Returns:
        Its kind.
    """
    if isinstance(model, PointContactConstraintModel):
        return Frictional(model.getFriction())
    if isinstance(model, JointLimitConstraintModel):
        return Unilateral(model.residualSize())
    if isinstance(model, JointFrictionConstraintModel):
        bounds = model.set(data)
        return Bounded(tuple(bounds.lb.tolist()), tuple(bounds.ub.tolist()))
    return Bilateral(model.residualSize())
