"""The problem that solvers of constraints share: the Delassus operator, and the sets that impulses belong to."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from pinocchio._constraints._procedures.solver_rows import (
    BOUNDED,
    CONTACT,
    HELD,
    ITERATIONS_OUT,
    LANES,
    PUSHED,
    Given,
    Rows,
)
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


AT_ONCE = 1001
"""So many iterations does one native call make, which Ctrl-C does not reach."""


class SearchError(Exception):
    """A search that could not be made."""


class RowStorage:
    """The arrays of a problem of one size that procedures read; vectors are filled up to lanes with zeros.

    Args:
        sizes: How many constraints and how many rows there are.
        head: How many numbers a solution begins with.
        count_of_vectors: How many vectors it has.

    Attributes:
        is_written_elsewhere: Whether searches that no Python runs for write frictions, too.
        given: Arrays that problems are copied into, and solutions written into.
        span: The first iteration, the one after the last, and whether G is there already (3,); between searches, those
            of a search that no Python runs for.
    """

    def __init__(self, sizes: tuple[int, int], head: int, count_of_vectors: int) -> None:
        self.sizes, (count, self.m) = sizes, sizes
        self.width = max(-(-self.m // LANES), 1) * LANES
        self.rows = Rows(
            np.zeros(count, np.int64), np.zeros(count + 1, np.int64), np.zeros(self.m), np.zeros(self.m)
        )
        self.G, self.g = np.zeros((self.m, self.width)), self.vector()
        self._sets: Sets | None = None
        self.is_written_elsewhere = False
        vectors = [np.zeros(self.m) for _ in range(3)]
        self.given = Given(
            np.zeros((self.m, self.m)), *vectors, out=np.zeros(head + count_of_vectors * self.m)
        )
        self.span = np.zeros(3, np.int64)
        self._entries = self.G[:, : self.m]

    def vector(self) -> Floats:
        """A vector of zeros (width,)."""
        return np.zeros(self.width)

    def search(
        self, run: Any, problem: tuple[Floats, ...], most: int, out: Floats
    ) -> Iterator[tuple[int, int]]:
        """Makes iterations, so many at once that Ctrl-C is heard.

        Args:
            run: A bound procedure that takes `given` and `span`.
            problem: G (m, m), what is added to its diagonal (m,), twice, and the velocities without impulses (m,).
            most: How many iterations at most.
            out: What the solution is written into, numbers and vectors (n,); see `Given`.

        Returns:
            After each part which iteration was its first, and how many have been made in vain.

        Raises:
            SearchError: The procedure returns neither 0 nor 1.
        """
        given, span, first, answer = self.given, self.span, 0, 0
        self._entries[:] = problem[0]
        for target, values in zip(given[1:4], problem[1:], strict=True):
            target[:] = values
        given.out[:] = out
        run.restore()  # calls that no Python runs for may have read other arrays
        try:
            while first < most and not answer:
                span[:] = first, min(first + AT_ONCE, most), 1
                answer = run()
                if answer > 1:
                    raise SearchError
                done = int(given.out.item(ITERATIONS_OUT))
                out[:] = given.out
                yield first, done
                first = done
        finally:
            span[:] = 0, most, 0

    def put_sets(self, sets: Sets) -> None:
        """Writes the sets of the rows."""
        if sets != self._sets:
            self._sets = sets
            for array, values in zip(self.rows, sets, strict=True):
                array[:] = values
        elif self.is_written_elsewhere:
            self.rows.upper[:] = sets.upper
