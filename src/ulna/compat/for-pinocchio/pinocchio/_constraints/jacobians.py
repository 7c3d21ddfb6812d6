"""Jacobians of constraints, and their Delassus matrices."""

from __future__ import annotations

from typing import Any

import numpy as np

from pinocchio._algorithms.jacobians import computeJointJacobians
from pinocchio._constraints.constraint_model import AnyConstraint
from pinocchio._constraints.constraint_set import ConstraintSet, cached_constraint_set, constraint_set_of
from pinocchio._constraints.delassus import damped_inverse, with_inertia
from pinocchio._constraints.kernels import core_constraints, jacobian_kernel, sizes_of
from pinocchio._constraints.proximal_settings import damping_of
from pinocchio._constraints.rigid_constraint import RigidConstraint
from pinocchio._containers.arguments import ArgumentError
from pinocchio._containers.arrays import exact, not_applicable
from pinocchio._data.data import Data
from pinocchio._data.states import compiled_for
from pinocchio._model.model import Model
from ulna import algorithms
from ulna.errors import excerpt
from ulna.model import Model as CoreModel
from ulna.quantities.mass import with_mass
from ulna.typing import Array, Floats

__all__ = [
    "computeDampedDelassusMatrixInverse",
    "computeDelassusMatrix",
    "getConstraintJacobian",
    "getConstraintsJacobian",
]


def getConstraintsJacobian(model: Model, data: Data, constraint_models: Any, constraint_datas: Any) -> Floats:
    """The Jacobian (m, nv) of all constraints, at the configuration of the last kinematics or dynamics.

    Args:
        data: Its data, after kinematics or dynamics.
        constraint_datas: Their data.

    Returns:
        Jacobian (m, nv).
    """
    constraint_set = cached_constraint_set(model, data, constraint_models, constraint_datas)
    if constraint_set is not None and "jacobian here" in constraint_set.runs:
        J = constraint_set.runs["jacobian here"]()
        if J is not NotImplemented:
            return J
    data._require(data._q, "forwardKinematics(model, data, q), or constraintDynamics,")
    if constraint_set is None:
        compiled_for(model, data)
        if not all(isinstance(one, RigidConstraint) for one in constraint_models):
            pairs = list(zip(constraint_models, constraint_datas, strict=True))
            _check_constraints(constraint_models)
            return np.vstack([one.jacobian(model, data, known) for one, known in pairs])
        constraint_set = constraint_set_of(model, data, constraint_models, constraint_datas)
    return jacobian_here(model, data, constraint_set)


def jacobian_here(model: Model, data: Data, constraint_set: ConstraintSet) -> Floats:
    """The Jacobian of constraints at the configuration of the last kinematics or dynamics.

    Args:
        constraint_set: The constraints.

    Returns:
        Jacobian (m, nv).
    """
    step = constraint_set.runs.get("jacobian here", not_applicable)
    J = step()
    if J is NotImplemented:
        q = data._q
        J = evaluate(model, data, constraint_set, "jacobian", q)
        constraint_set = constraint_set_of(model, data, constraint_set.models, constraint_set.datas)
        if len(J):
            constraint_set.runs["jacobian here"] = _bind(
                model, data, constraint_set, "jacobian", len(J), (q,)
            )
    return J


def _check_constraints(constraint_models: Any) -> None:
    for one in constraint_models:
        if not isinstance(one, (AnyConstraint, RigidConstraint)):
            raise ArgumentError(
                f"The constraint is {excerpt(repr(one))}; expected a constraint model, such as RigidConstraintModel."
            )


def getConstraintJacobian(model: Model, data: Data, constraint_model: Any, constraint_data: Any) -> Floats:
    """The Jacobian (residualSize, nv) of one constraint; see `getConstraintsJacobian`.

    Args:
        data: Its data, after kinematics or dynamics.
        constraint_model: The constraint.

    Returns:
        Jacobian (m, nv).
    """
    return getConstraintsJacobian(model, data, [constraint_model], [constraint_data])


def computeDelassusMatrix(
    model: Model, data: Data, q: Any, contact_models: Any, contact_datas: Any, mu: float = 0.0
) -> Floats:
    """G = J M^-1 J^T of constraints, (m, m), along the axes of each; with an inertia mu at each, (1 + mu G)^-1 G.

    Args:
        mu: Inertia at each row [kg].

    Returns:
        Matrix (m, m) [1/kg].
    """
    G = evaluate(model, data, constraint_set_of(model, data, contact_models, contact_datas), "delassus", q)
    computeJointJacobians(model, data, q)
    return with_inertia(G, damping_of(mu)) if mu else G


def computeDampedDelassusMatrixInverse(
    model: Model,
    data: Data,
    q: Any,
    contact_models: Any,
    contact_datas: Any,
    mu: float = 0.0,
    scaled: bool = False,
) -> Floats:
    """The inverse of J M^-1 J^T + mu 1, (m, m); scaled, it is multiplied by mu.

    Args:
        mu: Number that is added to the diagonal [1/kg].
        scaled: Whether the inverse is multiplied by `mu`.

    Returns:
        Matrix (m, m).
    """
    damping = damping_of(mu)
    S = damped_inverse(computeDelassusMatrix(model, data, q, contact_models, contact_datas), damping)
    return damping * S if scaled else S


def evaluate(model: Model, data: Data, constraint_set: ConstraintSet, name: str, q: Any) -> Floats:
    """Evaluates a quantity of constraints by a kernel bound to them and a Data.

    Args:
        constraint_set: The constraints.
        name: "jacobian" or "delassus".

    Returns:
        Matrix (m, nv) or (m, m).
    """
    step = constraint_set.runs.get(name)
    result = NotImplemented if step is None else step(q, *constraint_set.places)
    if result is NotImplemented:
        q = exact(q, model.nq, "q")
        data._attach(model)
        constraint_set = constraint_set_of(model, data, constraint_set.models, constraint_set.datas)
        rows = sum(shape[0] for shape in constraint_set.shapes)
        if not rows:
            return np.zeros((0, model.nv if name == "jacobian" else 0))
        step = constraint_set.runs[name] = _bind(model, data, constraint_set, name, rows)
        result = step(q, *constraint_set.places)
    return result


def _bind(
    model: Model, data: Data, constraint_set: ConstraintSet, name: str, rows: int, last_inputs: Any = ()
) -> Any:
    """Binds a kernel of constraints; where `last_inputs` is the array of q, to it and to the placements, too."""
    watch = model._watched("placements" if name == "jacobian" else "parameters")  # first: see `run`
    compiled, shapes = data._attach(model), constraint_set.shapes
    if name == "jacobian":
        kernel, targets = jacobian_kernel(compiled, shapes, model.nq), [np.zeros((rows, model.nv))]
    else:
        build, sizes = with_mass(_delassus(shapes)), sizes_of(shapes)
        kernel = compiled.compile(("constraint delassus", shapes), build, q=(model.nq,), **sizes)
        targets = [np.zeros((rows, rows)), data._target("M"), data._target("joints q")]
    if last_inputs:
        last_inputs = *last_inputs, *constraint_set.places
    return kernel.into(*targets, returns=(0,), watch=watch, otherwise=not_applicable, last_inputs=last_inputs)


def _delassus(shapes: Any) -> Any:
    def build(core: CoreModel) -> Any:
        def run(q: Array, *placements: Array) -> tuple[Array, ...]:
            G = algorithms.delassus_matrix(core, q, core_constraints(shapes, np.stack(placements)))
            return G, algorithms.mass_matrix(core, q), q

        return run

    return build
