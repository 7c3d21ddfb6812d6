"""Recursions of the regressors of torques."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from ulna.algorithms.multibody.tree import steps
from ulna.model import Model
from ulna.recursions._procedures import regressors
from ulna.recursions._procedures.newton_euler import new_motions
from ulna.recursions._procedures.placements import new_placements
from ulna.recursions.recursion import Recursion
from ulna.recursions.tree_table import INT, tree_table

Options = Mapping[str, Any]


def _bodies(model: Model) -> regressors.Bodies:
    """The bodies of the steps; the subtree of a joint is a range of joints, as these are depth first."""
    tree = steps(model)
    body, starts, stops = (np.full(len(tree) + 1, -1, INT) for _ in range(3))
    for row, step in enumerate(tree, start=1):
        joint = model.joint_index(step.joint.name)
        body[row] = joint if step.is_last else -1
        starts[row], stops[row] = joint, joint + 1
    for row in range(len(tree), 0, -1):
        parent = tree[row - 1].parent + 1
        stops[parent] = max(stops[parent], stops[row])
    return regressors.Bodies(body, starts, stops, np.zeros((6, 10 * len(model.joints))))


def _regressor(procedure: Any, *sizes: str) -> Callable[[Model, Options], Recursion]:
    """A matrix with a row for each entry of v, and ten columns for each body."""

    def make(model: Model, options: Options) -> Recursion:
        tree = tree_table(model)
        rows = len(tree.parents)

        def storage(lanes: int) -> Sequence[Any]:
            return tree, new_placements(rows, 1, False), new_motions(rows, 1), _bodies(model)

        inputs = tuple((getattr(model, size),) for size in sizes)
        outputs = ((model.nv, 10 * len(model.joints)),)
        return Recursion(procedure, storage, inputs, outputs, rows, is_matrix=True)

    return make


RECURSIONS = {
    "joint_torque_regressor": _regressor(regressors.joint_torque_regressor, "nq", "nv", "nv"),
    "gravity_regressor": _regressor(regressors.gravity_regressor, "nq"),
}
"""By the names of quantities."""
