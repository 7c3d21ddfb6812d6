"""Jacobians of constraints, and their Delassus matrices."""

from __future__ import annotations

from typing import Any

import numpy as np

from pinocchio._algorithms.jacobians import JACOBIANS, computeJointJacobians
from pinocchio._constraints.bound_dynamics import with_side_outputs
from pinocchio._constraints.constraint_model import AnyConstraint
from pinocchio._constraints.constraint_set import (
    ConstraintSet,
    cached_constraint_set,
    constraint_set_of,
)
from pinocchio._constraints.delassus import (
    MOST_ROWS,
    damped_inverse,
    inverse_and_least_pivot,
    with_added_diagonal,
    with_inertia,
)
from pinocchio._constraints.frame_pair import watched_changes
from pinocchio._constraints.kernels import (
    core_constraints,
    has_columns_of,
    jacobian_kernel,
    sizes_of,
    stored_jacobian_kernel,
)
from pinocchio._constraints.proximal_settings import damping_of
from pinocchio._constraints.rigid_constraint import DELASSUS_LEAVES, RigidConstraint
from pinocchio._constraints.workspace import PROPAGATORS
from pinocchio._containers.arguments import ArgumentError, check_model_and_data, checks_itself
from pinocchio._containers.arrays import exact, not_applicable
from pinocchio._data.algorithm import Algorithm
from pinocchio._data.binding import side_outputs
from pinocchio._data.data import Data
from pinocchio._data.deferred_fields import JOINTS, stacked
from pinocchio._data.first_evaluation import loaded_evaluator, store
from pinocchio._data.states import compiled_for
from pinocchio._model.bound_kernels import BoundKernel
from pinocchio._model.model import Model
from pinocchio._tables.constraint_jacobians import constraint_jacobian as table_jacobian
from pinocchio._tables.fields import WORST_CONDITION, NotByTable, TableFields
from ulna import algorithms, linalg
from ulna.compiler.runtime.repeated_calls import call_cache, repeated_calls
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


_list_calls, _calls = (call_cache(4, weak=2) for _ in range(2))


@repeated_calls(_list_calls)
@checks_itself
def getConstraintsJacobian(model: Model, data: Data, constraint_models: Any, constraint_datas: Any) -> Floats:
    """The Jacobian (m, nv) of all constraints, at the configuration of the last kinematics or dynamics.

    It is made of the columns of `data.J` where they are of that configuration.

    Args:
        data: Its data, after kinematics or dynamics.

    Returns:
        Jacobian (m, nv).
    """
    step, known, J = _bound_jacobian(model, data, constraint_models, constraint_datas)
    if J is NotImplemented:
        return _jacobian_anew("getConstraintsJacobian", model, data, constraint_models, constraint_datas)
    if known.is_given_again(constraint_models, constraint_datas):
        _list_calls.add(step, 0, model, data, constraint_models, constraint_datas)
    return J


def _bound_jacobian(model: Any, data: Any, models: Any, datas: Any) -> tuple[Any, Any, Any]:
    """What is bound to constraints, their set, and their Jacobian, or NotImplemented where that does not apply."""
    try:
        known: Any = cached_constraint_set(model, data, models, datas)
        step = known.runs["jacobian here"]
        return step, known, step()
    except (LookupError, TypeError, ValueError, AttributeError):
        return None, None, NotImplemented


def _jacobian_anew(
    function: str, model: Model, data: Data, constraint_models: Any, constraint_datas: Any
) -> Floats:
    """The Jacobian of constraints that nothing is bound to yet, or that have changed."""
    check_model_and_data(function, model, data)
    constraint_set = cached_constraint_set(model, data, constraint_models, constraint_datas)
    data._require(data._q, "forwardKinematics(model, data, q), or constraintDynamics,")
    if constraint_set is None:
        compiled_for(model, data)
        if not all(isinstance(one, RigidConstraint) for one in constraint_models):
            pairs = list(zip(constraint_models, constraint_datas, strict=True))
            check_constraints(constraint_models)
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
        q, shapes = data._q, constraint_set.shapes
        if evaluator := loaded_evaluator(model, data, ("constraint jacobian", shapes)):
            J = data._arrays["J"] if has_columns_of(model, data, q) else None
            return (
                table_jacobian(evaluator, q, shapes, constraint_set.places, J) if shapes else _no_rows(model)
            )
        data._attach(model)
        constraint_set = constraint_set_of(model, data, constraint_set.models, constraint_set.datas)
        if not shapes:
            return _no_rows(model)
        step = constraint_set.runs["jacobian here"] = _bind_jacobian(model, data, constraint_set, q)
        J = step()
    return J


def _no_rows(model: Model) -> Floats:
    return np.zeros((0, model.nv))


def _bind_jacobian(model: Model, data: Data, constraint_set: ConstraintSet, q: Floats) -> Any:
    """Binds the Jacobian of constraints to their placements, to the array of q, and to J and the array of its q."""
    watch = [*model._watched("placements"), (watched_changes, watched_changes.copy())]  # first: see `run`
    compiled, shapes = data._attach(model), constraint_set.shapes
    inputs: tuple[Floats, ...] = (q, *constraint_set.places)
    if model.nvExtended != model.nv:  # several joints share a column
        return BoundKernel(jacobian_kernel(compiled, shapes, model.nq), watch, trailing_inputs=inputs).call
    of_columns = data._arrays["jacobians q"]
    if "jacobians" not in data._known_states:
        of_columns[...] = np.nan
    inputs = (data._arrays["J"], of_columns, *inputs)
    return BoundKernel(stored_jacobian_kernel(compiled, shapes), watch, trailing_inputs=inputs).call


def check_constraints(constraint_models: Any) -> None:
    """Checks that constraints are constraints.

    Raises:
        ArgumentError: One of them is none.
    """
    for one in constraint_models:
        if not isinstance(one, (AnyConstraint, RigidConstraint)):
            raise ArgumentError(
                f"The constraint is {excerpt(repr(one))}; expected a constraint model, such as RigidConstraintModel."
            )


@repeated_calls(_calls)
@checks_itself
def getConstraintJacobian(model: Model, data: Data, constraint_model: Any, constraint_data: Any) -> Floats:
    """The Jacobian (residualSize, nv) of one constraint; see `getConstraintsJacobian`.

    Args:
        data: Its data, after kinematics or dynamics.
        constraint_model: The constraint.

    Returns:
        Jacobian (m, nv).
    """
    models, datas = [constraint_model], [constraint_data]
    step, _, J = _bound_jacobian(model, data, models, datas)
    if J is NotImplemented:
        return _jacobian_anew("getConstraintJacobian", model, data, models, datas)
    _calls.add(step, 0, model, data, constraint_model, constraint_data)
    return J


def computeDelassusMatrix(
    model: Model, data: Data, q: Any, contact_models: Any, contact_datas: Any, mu: float = 0.0
) -> Floats:
    """G = J M^-1 J^T of constraints, (m, m), along the axes of each; with an inertia mu at each, (1 + mu G)^-1 G.

    Args:
        mu: Inertia at each row [kg].

    Returns:
        Matrix (m, m) [1/kg].
    """
    constraint_set = constraint_set_of(model, data, contact_models, contact_datas)
    G = constraint_set.runs.get("delassus", not_applicable)(q)
    if G is NotImplemented:
        G = _delassus_matrix(model, data, q, constraint_set)
        constraint_set.note_places()
    data._delassus = (
        constraint_set.shapes,
        constraint_set.delassus_places,
        1.0 / damping_of(mu) if mu else 0.0,
    )
    return with_inertia(G, damping_of(mu)) if mu else G


_FILLS = ("M", *JACOBIANS)
_DEFERRED = JOINTS | PROPAGATORS
_DELASSUS, _DAMPED = (
    Algorithm(name, "q", _FILLS, not_applicable, deferred=_DEFERRED, title=title)
    for name, title in (
        ("delassus", "computeDelassusMatrix"),
        ("damped_inverse", "computeDampedDelassusMatrixInverse"),
    )
)


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
    constraint_set = constraint_set_of(model, data, contact_models, contact_datas)
    S = constraint_set.runs.get("damped inverse", not_applicable)(q, damping)
    if S is NotImplemented:
        S = _damped_inverse(model, data, q, constraint_set, damping)
        constraint_set.note_places()
    data._delassus = constraint_set.shapes, constraint_set.delassus_places, damping
    constraint_set.leave("computeDampedDelassusMatrixInverse", DELASSUS_LEAVES)
    return damping * S if scaled else S


def _delassus_matrix(model: Model, data: Data, q: Any, constraint_set: ConstraintSet) -> Floats:
    """The Delassus matrix of constraints, computed by the joint table or bound to them for the next time."""
    q, shapes = exact(q, model.nq, "q"), constraint_set.shapes
    if not shapes:
        computeJointJacobians(model, data, q)
        return np.zeros((0, 0))
    if "delassus" not in constraint_set.runs:
        G = _by_table(model, data, q, constraint_set, _DELASSUS)
        if G is not None:
            return G
    data._attach(model)
    constraint_set = constraint_set_of(model, data, constraint_set.models, constraint_set.datas)
    rows = sum(shape[0] for shape in shapes)
    step = constraint_set.runs["delassus"] = _bind(
        model, data, constraint_set, _DELASSUS, [np.zeros((rows, rows))]
    )
    return step(q)


def _damped_inverse(
    model: Model, data: Data, q: Any, constraint_set: ConstraintSet, damping: float
) -> Floats:
    """The damped inverse of the Delassus matrix, made of that or bound to the constraints for the next time."""
    rows = sum(shape[0] for shape in constraint_set.shapes)
    q = exact(q, model.nq, "q")
    if 0 < rows <= MOST_ROWS and "damped inverse" not in constraint_set.runs:
        G = _by_table(model, data, q, constraint_set, _DAMPED)
        if G is not None and (damping > 0.0 or np.linalg.cond(G) < WORST_CONDITION):
            return linalg.inverse(with_added_diagonal(G, damping))
        if G is None:
            data._attach(model)
            constraint_set = constraint_set_of(model, data, constraint_set.models, constraint_set.datas)
            targets = [np.zeros((rows, rows)), np.zeros(())]
            constraint_set.runs["damped inverse"] = _bind(model, data, constraint_set, _DAMPED, targets)
    S = constraint_set.runs.get("damped inverse", not_applicable)(q, damping)
    if S is NotImplemented:
        S = damped_inverse(_delassus_matrix(model, data, q, constraint_set), damping)
    return S


def _by_table(
    model: Model, data: Data, q: Floats, constraint_set: ConstraintSet, record: Algorithm
) -> Floats | None:
    """The Delassus matrix at first calls, without compiling anything; None where that does not apply."""
    shapes = constraint_set.shapes
    evaluator = loaded_evaluator(model, data, (record.name, shapes))
    if evaluator is None:
        return None
    fields = TableFields(evaluator, model, {"q": q})
    try:
        inverse = fields.inverse_mass
    except NotByTable:
        return None
    J = table_jacobian(evaluator, q, shapes, constraint_set.places)
    G = J @ inverse @ J.T
    store(model, data, record, [q], *(fields.field(name) for name in _FILLS))
    return 0.5 * (G + G.T)


def _bind(
    model: Model, data: Data, constraint_set: ConstraintSet, record: Algorithm, results: list[Floats]
) -> Any:
    """Binds a Delassus matrix, or its damped inverse, to constraints and a Data; it returns the first result."""
    watch = model._watched("masses")  # first: see `run`
    compiled, shapes = data._attach(model), constraint_set.shapes
    side_targets, stored, marks = side_outputs(data, record)
    build = with_mass(with_side_outputs(_delassus(shapes, record is _DAMPED), stored, marks))
    damping: dict[str, Any] = {"damping": ()} if record is _DAMPED else {}
    kernel = compiled.compile(
        ("constraint", record.name, shapes), build, q=(model.nq,), **damping, **sizes_of(shapes)
    )
    fills = [data._target(name) for name in _FILLS]
    targets = [*results, *fills, constraint_set.delassus_places, *side_targets]
    data._store_states(record)
    return kernel.into(
        *targets,
        returns=(0,),
        watch=watch,
        otherwise=not_applicable,
        trailing_inputs=constraint_set.places,
        condition=1 if record is _DAMPED else None,
    )


def _delassus(shapes: Any, is_inverse: bool) -> Any:
    def build(core: CoreModel) -> Any:
        def run(q: Array, *others: Any) -> tuple[Any, ...]:
            ends = np.stack(others[is_inverse:])
            constraints = core_constraints(shapes, ends)
            G = algorithms.delassus_matrix(core, q, constraints)
            results = inverse_and_least_pivot(G, others[0]) if is_inverse else (G,)
            places = stacked(algorithms.joint_poses(core, q))
            return (
                *results,
                algorithms.mass_matrix(core, q),
                algorithms.joint_jacobians(core, q),
                places,
                ends,
            )

        return run

    return build
