"""What the columns of a frame's Jacobian change by: its rate, its Hessian, derivatives of the frame's motion.

The Jacobian comes from loops over joints, with a column for every column of a motion subspace, those of mimic joints
too. Rates and derivatives follow for all columns at once: sums over the steps of a chain are cumulative sums.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple, final

import numpy as np

from ulna.algorithms.derivatives.velocity import ColumnState, acceleration_changes
from ulna.algorithms.kinematics.jacobian_dot import rate_of_column
from ulna.model import Frame, Model
from ulna.quantities.quantity import frame_of
from ulna.recursions._procedures import frames as of_frames
from ulna.recursions._procedures import hessian as of_hessian
from ulna.recursions._procedures.placements import new_placements
from ulna.recursions.composition import Composition
from ulna.recursions.frame_rows import frame_table
from ulna.recursions.recursion import Recursion
from ulna.recursions.tree_table import TreeTable, carriers, free_columns
from ulna.spatial import Motion
from ulna.typing import Floats

Options = Mapping[str, Any]
_COLUMNS_AT_ONCE = 1 << 15


class Chain(NamedTuple):
    """The columns of the joints that carry a frame, in the order of the steps.

    Attributes:
        entries: The entry of v that each belongs to, (columns,).
        first: Where the columns of its own step begin, (columns,).
        stop: Where they end, (columns,).
    """

    entries: np.ndarray
    first: np.ndarray
    stop: np.ndarray

    @classmethod
    def of(cls, tree: TreeTable) -> Chain:
        """Those of a table.

        Args:
            tree: The table.

        Returns:
            The columns.
        """
        counts = np.diff(tree.columns)
        return cls(tree.entries, np.repeat(tree.columns[:-1], counts), np.repeat(tree.columns[1:], counts))

    def sum_before(self, twists: Motion) -> Motion:
        """For each column, the sum over the columns of steps before its own.

        Args:
            twists: A twist for each column, (..., columns).

        Returns:
            The sums, (..., columns).
        """
        return _select(_cumulative_sums(twists), self.first)

    def sum_through(self, twists: Motion) -> Motion:
        """The same, of steps up to and including its own.

        Args:
            twists: As for `sum_before`.

        Returns:
            The sums.
        """
        return _select(_cumulative_sums(twists), self.stop)

    def sum_from(self, twists: Motion) -> Motion:
        """The same, of its own step and those after it.

        Args:
            twists: As for `sum_before`.

        Returns:
            The sums.
        """
        return _select(_cumulative_sums(twists, backward=True), self.first)

    def sum_after(self, twists: Motion) -> Motion:
        """The same, of steps after its own.

        Args:
            twists: As for `sum_before`.

        Returns:
            The sums.
        """
        return _select(_cumulative_sums(twists, backward=True), self.stop)

    def combined(self, columns: Floats, axis: int, size: int) -> Floats:
        """The sums of the columns that belong to the same entry of v.

        Args:
            columns: An array with an axis of columns, (..., columns, ...).
            axis: That axis, from the end.
            size: nv.

        Returns:
            The array with an axis of entries, (..., nv, ...).
        """
        source = np.moveaxis(columns, axis, 0)
        out = np.zeros((size, *source.shape[1:]))
        if len(np.unique(self.entries)) == len(self.entries):
            out[self.entries] = source
        else:
            np.add.at(out, self.entries, source)
        return np.moveaxis(out, 0, axis)


def _cumulative_sums(twists: Motion, backward: bool = False) -> Motion:
    """Sums of the first 0, 1, 2, ... twists; backward those of the others."""

    def summed(x: Floats) -> Floats:
        zero = np.zeros((*x.shape[:-2], 1, 3))
        if backward:
            return np.concatenate([np.cumsum(x[..., ::-1, :], axis=-2)[..., ::-1, :], zero], axis=-2)
        return np.concatenate([zero, np.cumsum(x, axis=-2)], axis=-2)

    return Motion(summed(twists.linear), summed(twists.angular))


def _select(sums: Motion, places: np.ndarray) -> Motion:
    return Motion(sums.linear[..., places, :], sums.angular[..., places, :])


Combine = Callable[..., Sequence[Motion]]
"""Makes a twist for each column of each result: of the chain, J, and rows of v and a by column."""


@final
class FrameColumnQuantity(Composition):
    """Matrices (6, nv) that follow from the columns of a frame's Jacobian.

    Args:
        jacobian: The Jacobian, with a column for every column of a motion subspace.
        chain: These columns.
        count: How many matrices there are.
        nv: How many entries v has.
        combine: Makes them.
    """

    def __init__(self, jacobian: Recursion, chain: Chain, count: int, nv: int, combine: Combine) -> None:
        super().__init__(((6, nv),) * count, jacobian)
        self._chain, self._nv, self._combine = chain, nv, combine

    def evaluate(self, inputs: Sequence[Floats], outputs: Sequence[Floats]) -> None:
        """Computes samples; see `Composition.evaluate`."""
        step = max(_COLUMNS_AT_ONCE // max(len(self._chain.entries), 1), 1)
        for k in range(0, len(outputs[0]), step):
            self._evaluate_some([x[k : k + step] for x in inputs], [x[k : k + step] for x in outputs])

    def _evaluate_some(self, inputs: Sequence[Floats], outputs: Sequence[Floats]) -> None:
        q, *rates = inputs
        count = len(self._chain.entries)
        J = np.empty((len(q), 6 * count))
        self._main.evaluate([q], [J])
        columns = np.ascontiguousarray(J.reshape(len(q), 6, count).swapaxes(1, 2))
        motion = Motion(columns[..., :3], columns[..., 3:])
        results = self._combine(self._chain, motion, *(x[:, self._chain.entries] for x in rates))
        for output, result in zip(outputs, results, strict=True):
            matrix = self._chain.combined(result.vector(), -2, self._nv)
            output.reshape(len(q), 6, self._nv)[...] = matrix.swapaxes(1, 2)


@final
class FrameHessian(Composition):
    """The Hessian of a frame, of that with a column for every column of a motion subspace.

    Args:
        columns: That Hessian, (6 columns, columns).
        chain: These columns.
        nv: How many entries v has.
    """

    def __init__(self, columns: Recursion, chain: Chain, nv: int) -> None:
        super().__init__(((nv, 6, nv),), columns)
        self._chain, self._nv = chain, nv

    def evaluate(self, inputs: Sequence[Floats], outputs: Sequence[Floats]) -> None:
        """Computes samples; see `Composition.evaluate`."""
        count = len(self._chain.entries)
        if np.array_equal(self._chain.entries, np.arange(self._nv)):
            self._main.evaluate(inputs, outputs)
            return
        for k in range(len(outputs[0])):
            H = np.empty((1, 6 * count * count))
            self._main.evaluate([x[k : k + 1] for x in inputs], [H])
            rows = self._chain.combined(H.reshape(count, 6, count), -3, self._nv)
            outputs[0][k] = self._chain.combined(rows, -1, self._nv).reshape(-1)


def _jacobian_rates(reference: Any) -> Combine:
    def combine(chain: Chain, J: Motion, v: Floats) -> Sequence[Motion]:
        twists = J * v
        return (rate_of_column(J, chain.sum_through(twists), chain.sum_after(twists), reference),)

    return combine


def _velocity_derivatives(chain: Chain, J: Motion, v: Floats) -> Sequence[Motion]:
    return chain.sum_before(J * v).cross(J), J


def _acceleration_derivatives(chain: Chain, J: Motion, v: Floats, a: Floats) -> Sequence[Motion]:
    twists = J * v
    C = chain.sum_before(J * a + chain.sum_through(twists).cross(twists))
    state = ColumnState(chain.sum_before(twists), C, chain.sum_from(twists), chain.sum_after(twists))
    return acceleration_changes(J, state)


def _free_carriers(model: Model, frame: Frame) -> tuple[TreeTable, Mapping[int, int], Chain]:
    """The table of the joints that carry a frame, the rows of joints, and the columns."""
    tree, rows = carriers(model, [frame])
    return free_columns(tree), rows, Chain.of(tree)


def _of_columns(
    combine: Callable[[Options], Combine], count: int
) -> Callable[[Model, Options], FrameColumnQuantity]:
    """So many matrices that follow from a Jacobian, which is in "local" where there is no reference."""

    def make(model: Model, options: Options) -> FrameColumnQuantity:
        frame = frame_of(model, options["frame"])
        tree, rows, chain = _free_carriers(model, frame)

        def storage(lanes: int) -> Sequence[Any]:
            places = new_placements(len(tree.parents), lanes, True)
            return tree, places, frame_table([frame], rows, options.get("reference", "local"))

        shapes = ((model.nq,),), ((6, len(chain.entries)),)
        jacobian = Recursion(of_frames.frame_jacobian, storage, *shapes, len(tree.parents))
        return FrameColumnQuantity(jacobian, chain, count, model.nv, combine(options))

    return make


def _hessian(model: Model, options: Options) -> FrameHessian:
    frame = frame_of(model, options["frame"])
    tree, rows, chain = _free_carriers(model, frame)
    count = len(chain.entries)

    def storage(lanes: int) -> Sequence[Any]:
        places = new_placements(len(tree.parents), 1, True)
        return tree, places, frame_table([frame], rows, options["reference"]), np.zeros((6, count))

    shapes = ((model.nq,),), ((6 * count, count),)
    columns = Recursion(of_hessian.frame_hessian, storage, *shapes, len(tree.parents), is_matrix=True)
    return FrameHessian(columns, chain, model.nv)


RECURSIONS = {
    "jacobian_dot": _of_columns(lambda options: _jacobian_rates(options["reference"]), 1),
    "frame_velocity_derivatives": _of_columns(lambda options: _velocity_derivatives, 2),
    "frame_acceleration_derivatives": _of_columns(lambda options: _acceleration_derivatives, 3),
    "hessian": _hessian,
}
"""By the names of quantities."""
