"""Recursions of matrices that depend on velocities: derivatives of inverse dynamics, the Coriolis matrix."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from ulna.model import Model
from ulna.recursions._procedures import derivatives
from ulna.recursions._procedures.newton_euler import new_motions
from ulna.recursions._procedures.placements import new_placements
from ulna.recursions.composition import MimicMatrices
from ulna.recursions.frame_rows import loaded_frames
from ulna.recursions.recursion import Recursion
from ulna.recursions.tree_table import free_columns, has_mimics, tree_table

Options = Mapping[str, Any]
_DERIVATIVES = derivatives.inverse_dynamics_derivatives
_LOADED_DERIVATIVES = derivatives.loaded_inverse_dynamics_derivatives


def new_workspace(rows: int, columns: int) -> derivatives.DerivativeWorkspace:
    """The arrays that the recursion of derivatives writes.

    Args:
        rows: How many rows the table has.
        columns: How many columns its motion subspaces have.

    Returns:
        The storage.
    """
    shapes = (rows, 10), (rows, 6, 1), (rows, 6, 1), *[(columns, 6)] * 3, *[(6, columns)] * 3
    return derivatives.DerivativeWorkspace(*map(np.zeros, (*shapes, (3, columns), (2, columns))))


def _matrices(
    procedure: Any, loaded: Any, count: int, *sizes: str
) -> Callable[[Model, Options], Recursion | MimicMatrices]:
    """A maker of recursions of `count` matrices (nv, nv), the last of which is the mass matrix if there are three."""

    def make(model: Model, options: Options) -> Recursion | MimicMatrices:
        whole, frames = tree_table(model), loaded_frames(model, options)
        tree = free_columns(whole) if has_mimics(model, whole) else whole
        rows, columns = len(tree.parents), len(tree.entries)

        def storage(lanes: int) -> Sequence[Any]:
            places = new_placements(rows, 1, frames is not None)
            last = () if frames is None else (frames,)
            return tree, places, new_motions(rows, 1), new_workspace(rows, columns), *last

        inputs = [(model.nq if size == "nq" else columns,) for size in sizes]
        inputs += [] if frames is None else [(len(frames.rows), 6)]
        chosen = procedure if frames is None else loaded
        outputs = ((columns, columns),) * count
        made = Recursion(chosen, storage, tuple(inputs), outputs, rows, is_matrix=True)
        if tree is whole:
            return made
        return MimicMatrices(made, whole.entries, whole.armature if count == 3 else None, model.nv)

    return make


RECURSIONS = {
    "inverse_dynamics_derivatives": _matrices(_DERIVATIVES, _LOADED_DERIVATIVES, 3, "nq", "nv", "nv"),
    "coriolis_matrix": _matrices(derivatives.coriolis_matrix, None, 1, "nq", "nv"),
}
"""By the names of quantities."""
