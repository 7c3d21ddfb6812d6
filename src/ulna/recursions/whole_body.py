"""Recursions of the centre of mass, the momentum and the energies of a whole robot."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from ulna.model import Model
from ulna.recursions._procedures import centroidal, centroidal_derivatives, whole_body
from ulna.recursions._procedures.newton_euler import new_motions
from ulna.recursions._procedures.placements import new_placements
from ulna.recursions.composition import CentroidalResults, Composition
from ulna.recursions.derivative_matrices import new_workspace
from ulna.recursions.recursion import Recursion
from ulna.recursions.tree_table import TreeTable, tree_table
from ulna.typing import Floats

Options = Mapping[str, Any]
Make = Callable[[Model, Options], Recursion | Composition | None]


def _mass(tree: TreeTable) -> Floats:
    return np.array([tree.inertias[:, 0].sum()])


def _has_center(tree: TreeTable, options: Options) -> bool:
    """Whether all bodies are meant, and they have mass."""
    return options.get("subtree") is None and _mass(tree)[0] > 0.0


def _sums(procedure: Any, shape: tuple[int, ...], *sizes: str) -> Make:
    """A quantity that is a sum over the bodies."""

    def make(model: Model, options: Options) -> Recursion | None:
        tree = tree_table(model)
        if not _has_center(tree, options):
            return None
        rows = len(tree.parents)

        def storage(lanes: int) -> Sequence[Any]:
            sums = whole_body.Sums(np.zeros((1, 10, lanes)), _mass(tree))
            moves = (new_motions(rows, lanes),) if len(sizes) > 1 else ()
            return tree, new_placements(rows, lanes, True), *moves, sums

        inputs = tuple((getattr(model, size),) for size in sizes)
        return Recursion(procedure, storage, inputs, (shape,), rows)

    return make


def _matrix(procedure: Any, height: int, width: int | None = None) -> Make:
    """A quantity with a column for each entry of v, or of so many columns."""

    def make(model: Model, options: Options) -> Recursion | None:
        tree = tree_table(model)
        if not _has_center(tree, options):
            return None
        rows, columns = len(tree.parents), len(tree.entries)

        def storage(lanes: int) -> Sequence[Any]:
            work = centroidal.Columns(np.zeros((rows, 10)), np.zeros((6, columns)), _mass(tree))
            return tree, new_placements(rows, 1, True), work

        shape = (height, model.nv if width is None else width)
        return Recursion(procedure, storage, ((model.nq,),), (shape,), rows, is_matrix=True)

    return make


def _derivatives(model: Model, options: Options) -> Recursion | None:
    """Derivatives of the momentum by q, and of its rate by q, v and a."""
    tree = tree_table(model)._replace(gravity=np.zeros(3))
    if not _has_center(tree, options):
        return None
    rows, columns = len(tree.parents), len(tree.entries)

    def storage(lanes: int) -> Sequence[Any]:
        work = new_workspace(rows, columns), np.zeros((6, columns)), _mass(tree)
        return tree, new_placements(rows, 1, True), new_motions(rows, 1), *work

    inputs = (model.nq,), (model.nv,), (model.nv,)
    outputs = ((6, model.nv),) * 4
    procedure = centroidal_derivatives.centroidal_derivatives
    return Recursion(procedure, storage, inputs, outputs, rows, is_matrix=True)


def _matrix_dot(model: Model, options: Options) -> CentroidalResults | None:
    """The rate of the centroidal matrix A: dF/dv = d(A a + dA/dt v)/dv is dA/dt + dh/dq."""
    made = _derivatives(model, options)
    shapes = ((6, model.nv),)
    return made and CentroidalResults(made, shapes, lambda dh_dq, _dF_dq, dF_dv, _A: (dF_dv - dh_dq,))


def _velocity_derivatives(model: Model, options: Options) -> CentroidalResults | None:
    """Derivatives of the velocity of the centre of mass: of the momentum's linear part, over the mass."""
    made = _derivatives(model, options)
    mass, shapes = _mass(tree_table(model))[0], ((3, model.nv),) * 2
    return made and CentroidalResults(
        made, shapes, lambda dh_dq, _dF_dq, _dF_dv, A: (dh_dq[:3] / mass, A[:3] / mass)
    )


RECURSIONS: dict[str, Make] = {
    "center_of_mass": _sums(whole_body.center_of_mass, (3,), "nq"),
    "center_of_mass_velocity": _sums(whole_body.center_of_mass_velocity, (3,), "nq", "nv"),
    "center_of_mass_acceleration": _sums(whole_body.center_of_mass_acceleration, (3,), "nq", "nv", "nv"),
    "center_of_mass_jacobian": _matrix(centroidal.center_of_mass_jacobian, 3),
    "centroidal_momentum": _sums(whole_body.centroidal_momentum, (6,), "nq", "nv"),
    "centroidal_momentum_rate": _sums(whole_body.centroidal_momentum_rate, (6,), "nq", "nv", "nv"),
    "centroidal_matrix": _matrix(centroidal.centroidal_matrix, 6),
    "centroidal_matrix_dot": _matrix_dot,
    "centroidal_derivatives": _derivatives,
    "com_velocity_derivatives": _velocity_derivatives,
    "centroidal_inertia": _matrix(centroidal.centroidal_inertia, 3, 3),
    "kinetic_energy": _sums(whole_body.kinetic_energy, (), "nq", "nv"),
    "potential_energy": _sums(whole_body.potential_energy, (), "nq"),
    "mechanical_energy": _sums(whole_body.mechanical_energy, (), "nq", "nv"),
}
"""By the names of quantities."""
