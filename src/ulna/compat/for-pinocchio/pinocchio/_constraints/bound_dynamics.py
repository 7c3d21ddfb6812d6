"""Constraints bound to a Data: one native call reads them, computes, and writes the results."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, final

import numpy as np

from pinocchio._algorithms.jacobians import JACOBIANS
from pinocchio._constraints.constraint_set import ConstraintSet, bound_run, constraint_set_of
from pinocchio._constraints.deferred_state import DeferredConstraintState
from pinocchio._constraints.derivative_fields import (
    DERIVATIVES,
    FORCES_AT_REST,
    IMPACT_DERIVATIVES,
)
from pinocchio._constraints.kernels import core_constraints, right_side
from pinocchio._constraints.rigid_constraint import DYNAMICS_LEAVE
from pinocchio._constraints.workspace import (
    AUGMENTED,
    IMPULSE,
    SOLUTION,
    inertias_of_constraints,
)
from pinocchio._containers.arrays import exact, not_applicable
from pinocchio._data.algorithm import Algorithm
from pinocchio._data.binding import side_outputs
from pinocchio._data.data import Data
from pinocchio._data.deferred_fields import (
    ACCELERATIONS_IN_WORLD,
    BODIES,
    BODY_MOMENTA_IN_WORLD,
    CENTERS,
    CENTROIDAL_MAP,
    INVERSE_MASS,
    JOINTS,
    VELOCITIES_IN_WORLD,
    stacked,
)
from pinocchio._data.derivative_columns import ACCELERATION_COLUMNS, FORCES_BY_ACCELERATION
from pinocchio._data.evaluated_model import EvaluatedModel, step_on_numbers
from pinocchio._model.model import Model
from ulna import algorithms
from ulna.algorithms.constraints.damped_dynamics import Damped, damped_dynamics, damped_impact
from ulna.errors import InputError
from ulna.model import Model as CoreModel
from ulna.quantities.mass import with_mass
from ulna.typing import Array


@final
class ConstraintSolution:
    """The result of an algorithm under constraints, and the state it belongs to."""

    def __init__(self, model: Model, constraint_set: ConstraintSet, impact: bool) -> None:
        self.constraint_set, self.shapes, self.impact = constraint_set, constraint_set.shapes, impact
        k, m = len(constraint_set.shapes), sum(shape[0] for shape in constraint_set.shapes)
        shapes = (model.nq,), (model.nv,), (k, 2, 4, 4), (k, 2), (k, 6)
        self.state = tuple(np.zeros(shape) for shape in shapes)
        self.a, self.forces, self.settings = np.zeros(model.nv), np.zeros(m), np.zeros(3)
        self.derived: Any = None

    def copied(self) -> ConstraintSolution:
        """The same, for another Data."""
        out = object.__new__(ConstraintSolution)
        out.constraint_set, out.shapes, out.impact, out.derived = (
            self.constraint_set,
            self.shapes,
            self.impact,
            None,
        )
        out.state = tuple(x.copy() for x in self.state)
        out.a, out.forces, out.settings = self.a.copy(), self.forces.copy(), self.settings.copy()
        return out


@final
class BoundConstraintDynamics:
    """Dynamics, or an impact, bound to constraints and a Data."""

    def __init__(self, model: Model, data: Data, constraint_set: ConstraintSet, limit: int) -> None:
        """`limit` is how many rounds there may be; 0 means an impact."""
        datas, shapes = constraint_set.datas, constraint_set.shapes
        if len({id(known) for known in datas}) < len(datas):
            raise InputError(
                "One data stands for two constraints; give each its own: constraint.createData()."
            )
        impact = limit == 0
        self.datas, self.report = datas, np.zeros(3)
        self.solved = solved = ConstraintSolution(model, constraint_set, impact)
        self.forces = np.zeros(len(solved.forces))
        watch = model._watched("masses" if impact else "parameters")  # first: see `run`
        compiled = data._attach(model)
        self.deferred_state = DeferredConstraintState(compiled, datas, shapes, *solved.state[:4])
        inputs = (solved.state[0], solved.a, *(() if impact else (solved.a,)), solved.settings)
        inputs += (*((np.zeros(()),) if impact else ()), *constraint_set.live)
        sizes: dict[str, Any] = {f"x{k}": x.shape for k, x in enumerate(inputs)}
        self.algorithm = IMPACT if impact else DYNAMICS
        side_targets, stored, marks = side_outputs(data, self.algorithm)
        build = with_side_outputs(_impact(shapes) if impact else _motion(shapes, limit), stored, marks)
        key, build = ("constraint dynamics", shapes, limit), with_mass(build)
        results = [self.forces, self.report, *solved.state, solved.a, solved.forces, solved.settings]
        contact_forces = [known._views["contact_force"]._v for known in datas]
        targets = [
            *(data._target(name) for name in self.algorithm.fills),
            *results,
            *contact_forces,
            *side_targets,
        ]
        self.evaluated = model.first_calls.includes(key, 1)
        if self.evaluated:
            evaluate = step_on_numbers(build(EvaluatedModel(model).model), targets, [int(not impact)])
            self.step = lambda *state: evaluate(*state, *constraint_set.live)
        else:
            kernel = compiled.compile(key, build, **sizes)
            options = {"watch": watch, "otherwise": not_applicable, "trailing_inputs": constraint_set.live}
            self.step = kernel.into(*targets, returns=(int(not impact),), **options)

    def run(self, *state: Any) -> Any:
        """The accelerations, or the velocity; NotImplemented where something is not what it was bound to."""
        result = self.step(*state)
        if result is not NotImplemented:
            for known in self.datas:
                known._deferred = self.deferred_state
        return result


def solve_directly(model: Any, data: Any, models: Any, datas: Any, limit: int, *args: Any) -> Any:
    """As `solve`, of arrays and of constraints that are bound already; else NotImplemented.

    Args:
        model, data: Anything.
        limit: 0 for an impact, else for accelerations.
        *args: q, v, tau, settings; of an impact q, v, settings, restitution.

    Returns:
        The bound algorithm, and what it returned; or NotImplemented.

    Raises:
        AttributeError: The data is none.
    """
    session = bound_run(model, data, models, datas, limit)
    result = session.run(*args) if session is not not_applicable else NotImplemented
    if result is NotImplemented:
        return NotImplemented
    data.__dict__["_constraint_solution"] = session.solved  # past the checks of what users set
    return session, result


def solve(
    model: Model, data: Data, models: Any, datas: Any, limit: int, *args: Any
) -> tuple[BoundConstraintDynamics, Any]:
    """Runs dynamics (q, v, tau, settings) or, with limit = 0, an impact (q, v, settings, restitution).

    Args:
        limit: 0 for an impact, else for accelerations.
        *args: q, v, tau, settings; of an impact q, v, settings, restitution.

    Returns:
        The bound algorithm, and what it returned.
    """
    constraint_set = constraint_set_of(model, data, models, datas)
    session = constraint_set.runs.get(limit)
    result = NotImplemented if session is None else session.run(*args)
    if result is NotImplemented:
        count = 2 if limit == 0 else 3
        sizes = zip((model.nq, model.nv, model.nv), ("q", "v", "tau"), strict=True)
        state = [exact(x, *size) for x, size in zip(args[:count], sizes, strict=False)]
        result = NotImplemented if session is None else session.run(*state, *args[count:])
        if result is NotImplemented:
            data._attach(model)
            constraint_set = constraint_set_of(model, data, models, datas)
            session = BoundConstraintDynamics(model, data, constraint_set, limit)
            if not session.evaluated:
                constraint_set.runs[limit] = session
            result = session.run(*state, *args[count:])
            data._store_states(session.algorithm)
            for known in datas if limit else ():
                known._leave("constraintDynamics", DYNAMICS_LEAVE)
    assert session is not None
    own = data.__dict__  # past the checks of what users set
    own["_constraint_solution"] = session.solved
    if limit:
        own["_motion_solution"] = session.solved
    return session, result


_FILLS = ("ddq", "M", "com[0]", *JACOBIANS)
_DEFERRED = JOINTS | VELOCITIES_IN_WORLD | CENTROIDAL_MAP | CENTERS
DYNAMICS = Algorithm(
    "constraint_dynamics",
    "qvt",
    ("nle", *_FILLS),
    not_applicable,
    deferred=_DEFERRED
    | BODY_MOMENTA_IN_WORLD
    | {"oa": ACCELERATIONS_IN_WORLD["oa"], "oa_gf": BODIES["oa_gf"]}
    | FORCES_BY_ACCELERATION
    | FORCES_AT_REST
    | SOLUTION,
    title="constraintDynamics",
)
IMPACT = Algorithm(
    "impact",
    "qv",
    ("dq_after", *_FILLS),
    not_applicable,
    deferred=_DEFERRED | FORCES_BY_ACCELERATION | IMPULSE,
    invalidates=("primal_rhs_contact",),
    title="impulseDynamics",
)
_MATRICES = ("ddq_dq", "ddq_dv", "dlambda_dq", "dlambda_dv", "osim")
DERIVED = Algorithm(
    "constraint_derivatives",
    "qva",
    (*_MATRICES, "ddq_dtau", "dlambda_dtau", "dac_da"),
    not_applicable,
    deferred=INVERSE_MASS
    | dict.fromkeys(("a", "oa"), ACCELERATIONS_IN_WORLD["oa"])
    | {"oa_gf": BODIES["f"]}
    | ACCELERATION_COLUMNS
    | DERIVATIVES,
    title="computeConstraintDynamicsDerivatives",
)
IMPACT_DERIVED = Algorithm(
    "impact_derivatives",
    "q",
    _MATRICES,
    not_applicable,
    deferred=INVERSE_MASS | IMPACT_DERIVATIVES,
    invalidates=("dlambda_dtau",),
    title="computeImpulseDynamicsDerivatives",
)
_ELIMINATED = ("g", "of", "oYaba_augmented", "of_augmented")
_LCABA = Algorithm("lcaba", "", (), not_applicable, invalidates=_ELIMINATED, title="lcaba")
"""What algorithms under constraints leave besides their results."""


def defer_after_elimination(model: Model, data: Data) -> None:
    """Defers the fields that lcaba fills besides its results."""
    assert data._constraint_solution is not None
    compiled, solution = data._attach(model), data._constraint_solution
    state = [x.copy() for x in (*solution.state[:2], solution.a)]
    data._defer(ACCELERATIONS_IN_WORLD["oa"], ("oa",), compiled, *state)
    data._defer(BODIES["f"], ("oa_gf",), compiled, *state)
    data._invalidate(_LCABA)
    damping = solution.settings.item(0)
    if damping > 0.0 and not any(second for _, _, _, second in solution.shapes):
        added = inertias_of_constraints(model, solution.shapes, solution.state[2], damping)
        data._defer(AUGMENTED, ("oYaba_augmented", "of_augmented"), compiled, state[0], added)


def with_side_outputs(build: Any, stored: list[int], marks: list[float]) -> Any:
    """The same, with what else it leaves.

    Args:
        build: Makes the function of Ulna's model.
        stored: The numbers of arguments that are further outputs.
        marks: Numbers that are the last outputs.

    Returns:
        What makes the longer function.
    """

    def traced(core: CoreModel) -> Any:
        results = build(core)

        def run(*args: Any) -> tuple[Any, ...]:
            return (*results(*args), *(args[k] for k in stored), *marks)

        return run

    return traced


def _stacks(live: Sequence[Array]) -> tuple[Array, Array, Array]:
    """Placements, gains, and wanted accelerations, each in one array."""
    return np.stack(live[0::3]), np.stack(live[1::3]), np.stack(live[2::3])


def _common_outputs(core: CoreModel, q: Array, shapes: Any, forces: Array) -> tuple[list[Array], list[Array]]:
    """What all algorithms under constraints leave in a Data, and what in the data of the constraints."""
    parts = np.split(forces, np.cumsum([shape[0] for shape in shapes])[:-1])
    places = stacked(algorithms.joint_poses(core, q))
    com, J = algorithms.center_of_mass(core, q), algorithms.joint_jacobians(core, q)
    matrices = [algorithms.mass_matrix(core, q), com, J, places]
    return matrices, [np.concatenate([part, np.zeros(6 - len(part))]) for part in parts]


def _motion(shapes: Any, limit: int) -> Any:
    def build(core: CoreModel) -> Any:
        def run(q: Array, v: Array, tau: Array, settings: Array, *live: Array) -> tuple[Any, ...]:
            placements, gains, desired = _stacks(live)
            J, g = right_side(core, shapes, q, v, placements, gains, desired)
            damped = Damped(settings[0], settings[1], settings[2], limit)
            a, forces, *report = damped_dynamics(core, q, v, tau, J, g, damped)
            common, contact_forces = _common_outputs(core, q, shapes, forces)
            state = q, v, placements, gains, desired, a, forces, settings
            nle = algorithms.bias_forces(core, q, v)
            return nle, a, *common, forces, np.stack(report), *state, *contact_forces

        return run

    return build


def _impact(shapes: Any) -> Any:
    def build(core: CoreModel) -> Any:
        def run(q: Array, v: Array, settings: Array, part: Any, *live: Array) -> tuple[Any, ...]:
            placements, gains, desired = _stacks(live)
            constraints = core_constraints(shapes, placements)
            J = algorithms.constraint_jacobian(core, q, constraints)
            jump = (1.0 + part) * algorithms.constraint_velocity(core, q, v, constraints)
            a, forces, *report = damped_impact(core, q, J, jump, Damped(settings[0], 0.0, 0.0, 1))
            common, contact_forces = _common_outputs(core, q, shapes, forces)
            state = q, v, placements, gains, desired, a, forces, settings
            return v + a, a, *common, forces, np.stack(report), *state, *contact_forces

        return run

    return build
