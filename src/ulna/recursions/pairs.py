"""Recursions of matrices of pairs of columns with velocities: derivatives of inverse dynamics, the Coriolis matrix."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from ulna.model import Model
from ulna.recursions._procedures import derivatives
from ulna.recursions._procedures.newton_euler import new_motions
from ulna.recursions._procedures.placements import new_placements
from ulna.recursions.recursion import Recursion
from ulna.recursions.tree_table import has_mimics, tree_table

Options = Mapping[str, Any]


def _matrices(procedure: Any, count: int, *sizes: str) -> Callable[[Model, Options], Recursion | None]:
    """So many matrices (nv, nv), without external forces and mimic joints."""

    def make(model: Model, options: Options) -> Recursion | None:
        tree = tree_table(model)
        if options.get("forces") or has_mimics(model, tree):
            return None
        rows, columns = len(tree.parents), len(tree.entries)

        def storage(lanes: int) -> Sequence[Any]:
            shapes = (rows, 10), (rows, 6, 1), (rows, 6, 1), *[(columns, 6)] * 3, *[(6, columns)] * 3
            work = derivatives.Pairs(*map(np.zeros, (*shapes, (3, columns), (2, columns))))
            return tree, new_placements(rows, 1, False), new_motions(rows, 1), work

        inputs = tuple((getattr(model, size),) for size in sizes)
        outputs = ((model.nv, model.nv),) * count
        return Recursion(procedure, storage, inputs, outputs, rows, is_matrix=True)

    return make


RECURSIONS = {
    "inverse_dynamics_derivatives": _matrices(derivatives.inverse_dynamics_derivatives, 3, "nq", "nv", "nv"),
    "coriolis_matrix": _matrices(derivatives.coriolis_matrix, 1, "nq", "nv"),
}
"""By the names of quantities."""
