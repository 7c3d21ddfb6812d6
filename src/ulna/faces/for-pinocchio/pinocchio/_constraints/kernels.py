"""Constraints as kernels take them: checked, their kinds as a key, their placements as an array."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from pinocchio._constraints.factorization import Kernels, kernels_for
from pinocchio._constraints.rigid_constraint import RigidConstraintData, RigidConstraintModel
from pinocchio._model.model import Model
from ulna import algorithms, spatial
from ulna.algorithms.constrained_factors import moved_by
from ulna.errors import InputError
from ulna.model import Model as TowerModel
from ulna.model.constraint import Bond, End
from ulna.typing import Array

if TYPE_CHECKING:
    from pinocchio._model.kernels import Engine


def paired(model: Model, models: Any, datas: Any) -> list[RigidConstraintModel]:
    """The constraints, checked against their data and the model.

    Raises:
        InputError: something is no constraint, or no data of it; a joint is not one of the model.
    """
    if len(models) != len(datas):
        raise InputError(
            f"There are {len(models)} constraints and {len(datas)} data of constraints; expected as many."
        )
    for one, data in zip(models, datas, strict=True):
        if not isinstance(one, RigidConstraintModel) or not isinstance(data, RigidConstraintData):
            raise InputError(
                f"The constraint is {one!r} and its data {data!r}; expected a RigidConstraintModel and what its "
                "createData() gives."
            )
        if data._size != one.residualSize():
            raise InputError(
                f"The data of a constraint has {data._size} rows, the constraint {one.residualSize()}; make it anew: "
                "constraint.createData()."
            )
        if not 0 <= min(one.joint1_id, one.joint2_id) < max(one.joint1_id, one.joint2_id) < model.njoints:
            raise InputError(
                f"A constraint is between the joints {one.joint1_id} and {one.joint2_id}; the model has "
                f"{model.njoints}. It was made for another model."
            )
    return list(models)


def shapes_of(models: Sequence[RigidConstraintModel]) -> tuple[tuple[int, bool, int, int], ...]:
    """What kernels depend on, for each: rows, whether they are written in local axes, the joints."""
    return tuple(one._shape() for one in models)


def bonds_of(shapes: Sequence[tuple[int, bool, int, int]], places: Array) -> list[Bond]:
    """The constraints for the tower; a frame of the world stands at its joint -1."""
    found = []
    for k, (size, local, *joints) in enumerate(shapes):
        first, second = (
            End(joint - 1, spatial.SE3(places[k, end, :3, :3], places[k, end, :3, 3]))
            for end, joint in enumerate(joints)
        )
        found.append(Bond(first, second, size, local))  # type: ignore[arg-type]
    return found


def jacobian_kernel(engine: Engine, shapes: Any, nq: int) -> Any:
    """The compiled Jacobian (m, nv) of constraints, a function of q and the placements (2, 4, 4) of each."""

    def build(tower: TowerModel) -> Any:
        def run(q: Array, *places: Array) -> Array:
            return algorithms.constraint_jacobian(tower, q, bonds_of(shapes, np.stack(places)))

        return run

    return engine.made(("constraint jacobian", shapes), build, q=(nq,), **sizes_of(shapes))


def factor_kernels(engine: Engine, shapes: Any) -> Kernels:
    """What is compiled for the factors of the mass matrix and of constraints."""
    found = engine.kernels.get(("factors", shapes))
    if found is None:
        tower = engine.model
        moved = [np.tile(moved_by(tower, [j - 1 for j in joints]), (size, 1)) for size, _, *joints in shapes]
        rows = np.vstack([np.zeros((0, tower.nv)), *moved])
        found = engine.kernels["factors", shapes] = kernels_for(engine, rows)
    return found


def sizes_of(shapes: Any) -> dict[str, Any]:
    """The placements of each constraint as inputs of a kernel."""
    return {f"place{k}": (2, 4, 4) for k in range(len(shapes))}
