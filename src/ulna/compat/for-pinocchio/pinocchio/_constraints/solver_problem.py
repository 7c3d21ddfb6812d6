"""The problem that solvers of constraints share: the Delassus operator, and the sets that impulses belong to."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from pinocchio._constraints._procedures.solver_rows import BOUNDED, CONTACT, HELD, LANES, PUSHED, Rows
from pinocchio._constraints.anchors import PointContactConstraintModel
from pinocchio._constraints.delassus import DelassusOperator, DelassusOperatorDense
from pinocchio._constraints.joint_constraints import JointFrictionConstraintModel, JointLimitConstraintModel
from pinocchio._containers.arguments import WrongShape
from ulna.typing import Floats


class Sets(NamedTuple):
    """What `solver_rows.Rows` holds, as lists."""

    kinds: list[int]
    starts: list[int]
    lower: list[float]
    upper: list[float]


def sets_of(models: Any, datas: Any) -> Sets:
    """The sets that impulses of constraints belong to.

    Args:
        models: The constraints.
        datas: Their data, after `calc`.

    Returns:
        Of each constraint its kind and first row, of each row its bounds.
    """
    out = Sets([], [0], [], [])
    for model, data in zip(models, datas, strict=True):
        kind, low, high = _set_of(model, data)
        out.kinds.append(kind)
        out.lower.extend(low)
        out.upper.extend(high)
        out.starts.append(len(out.upper))
    return out


_FREE = (0.0, 0.0, 0.0)


def _set_of(model: Any, data: Any) -> tuple[int, Any, Any]:
    if type(model) is PointContactConstraintModel:
        return CONTACT, _FREE, (model.getFriction(), 0.0, 0.0)
    if type(model) is JointFrictionConstraintModel:
        box = model.set(data)
        return BOUNDED, box.lb.tolist(), box.ub.tolist()
    size = model.residualSize()
    if type(model) is JointLimitConstraintModel:
        return PUSHED, (0.0,) * size, (np.inf,) * size
    return HELD, (0.0,) * size, (0.0,) * size


def operator_for(delassus: Any, sets: Sets) -> DelassusOperator:
    """The Delassus operator, whose size is checked.

    Args:
        delassus: An operator, or a matrix (m, m).
        sets: The sets of its rows.

    Returns:
        The operator.

    Raises:
        WrongShape: The constraints have not as many rows.
    """
    operator = delassus if isinstance(delassus, DelassusOperator) else DelassusOperatorDense(delassus)
    m, rows = operator.size(), sets.starts[-1]
    if rows != m:
        raise WrongShape("delassus", (m, m), f"({rows}, {rows})", "The constraints have as many rows.")
    return operator


class RowStorage:
    """The arrays of a problem of one size that procedures read; vectors are filled up to lanes with zeros.

    Args:
        sizes: How many constraints and how many rows there are.
    """

    def __init__(self, sizes: tuple[int, int]) -> None:
        self.sizes, (count, self.m) = sizes, sizes
        self.width = max(-(-self.m // LANES), 1) * LANES
        self.rows = Rows(
            np.zeros(count, np.int64), np.zeros(count + 1, np.int64), np.zeros(self.m), np.zeros(self.m)
        )
        self.G = np.zeros((self.m, self.width))
        self._entries = self.G[:, : self.m]
        self._diagonal = self.G.reshape(-1)[:: self.width + 1]
        self.g = self.vector()
        self._sets: Sets | None = None

    def vector(self) -> Floats:
        """A vector of zeros (width,)."""
        return np.zeros(self.width)

    def fill(self, operator: DelassusOperator, g: Floats, sets: Sets, added: Floats) -> None:
        """Writes a problem.

        Args:
            operator: Its Delassus operator.
            g: Velocities without impulses (m,) [m/s].
            sets: The sets of its rows.
            added: What is added to the diagonal (m,).
        """
        if sets != self._sets:
            self._sets = sets
            for array, values in zip(self.rows, sets, strict=True):
                array[:] = values
        self._entries[:] = operator._G
        self._diagonal += added
        self.g[: self.m] = g
