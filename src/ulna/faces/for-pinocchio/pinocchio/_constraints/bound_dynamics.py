"""Constraints bound to a Data: one native call reads them, computes, and writes what is known then."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, final

import numpy as np

from pinocchio._algorithms.jacobians import JACOBIANS, computeJointJacobiansTimeVariation
from pinocchio._constraints.deferred_state import Left
from pinocchio._constraints.frame_pair import changes
from pinocchio._constraints.kernels import bonds_of
from pinocchio._constraints.rigid_constraint import paired, shapes_of
from pinocchio._containers.arrays import exact
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
from pinocchio._model.bound_kernels import not_applicable
from pinocchio._model.compiled_model import CompiledModel
from pinocchio._model.model import Model
from ulna import algorithms
from ulna.algorithms.constraints.damped_dynamics import Damped, damped_dynamics, damped_impact
from ulna.algorithms.constraints.frame_errors import constraint_twists
from ulna.errors import InputError
from ulna.model import Model as CoreModel
from ulna.recipes.mass import with_mass
from ulna.typing import Array, Floats

_MOST = 8
"""So many lists of constraints does a Data know."""


@final
class Ties:
    """A list of constraints with its data, for one model, and the algorithms bound to them.

    Attributes:
        live: Of each constraint its placements, gains and wanted acceleration, the arrays that users write to.
        runs: What is bound, by the key of the algorithm.
    """

    def __init__(self, model: Model, models: Any, datas: Any) -> None:
        self.model, self.models, self.datas = model, paired(model, models, datas), list(datas)
        self.version, self.shapes = changes[0], shapes_of(self.models)
        self.places = tuple(one._places for one in self.models)
        self.live = tuple(
            x
            for one, known in zip(self.models, self.datas, strict=True)
            for x in (one._places, one._gains._v, known._views["contact_acceleration_desired"]._v)
        )
        self.runs: dict[Any, Any] = {}

    def serves(self, model: Model, models: Any, datas: Any) -> bool:
        """Whether it was made for these."""
        return (
            self.model is model
            and self.version == changes[0]
            and models == self.models
            and datas == self.datas
        )


def tied(model: Model, data: Data, models: Any, datas: Any) -> Ties:
    """The constraints as they are bound to a Data.

    Raises:
        InputError: see `paired`; the Data does not fit the model.
    """
    found = known_ties(model, data, models, datas)
    if found is None:
        data.attach(model)
        models, datas = list(models), list(datas)
        found = known_ties(model, data, models, datas)
    if found is None:
        found = Ties(model, models, datas)
        data._constraint_sets = [
            *(ties for ties in data._constraint_sets if ties.version == changes[0]),
            found,
        ][-_MOST:]
    return found


def known_ties(model: Model, data: Data, models: Any, datas: Any) -> Ties | None:
    """The same where they have been bound before, else None."""
    for ties in data._constraint_sets:
        if ties.serves(model, models, datas):
            return ties
    return None


@final
class Solved:
    """What an algorithm under constraints found, and of what."""

    def __init__(self, model: Model, ties: Ties, impact: bool) -> None:
        self.ties, self.shapes, self.impact = ties, ties.shapes, impact
        k, m = len(ties.shapes), sum(shape[0] for shape in ties.shapes)
        shapes = (model.nq,), (model.nv,), (k, 2, 4, 4), (k, 2), (k, 6)
        self.kept = tuple(np.zeros(shape) for shape in shapes)
        self.a, self.forces, self.numbers = np.zeros(model.nv), np.zeros(m), np.zeros(3)
        self.derived: Any = None

    def copied(self) -> Solved:
        """The same, for another Data."""
        out = object.__new__(Solved)
        out.ties, out.shapes, out.impact, out.derived = self.ties, self.shapes, self.impact, None
        out.kept = tuple(x.copy() for x in self.kept)
        out.a, out.forces, out.numbers = self.a.copy(), self.forces.copy(), self.numbers.copy()
        return out


@final
class Session:
    """Dynamics, or an impact, bound to constraints and a Data."""

    def __init__(self, model: Model, data: Data, ties: Ties, limit: int) -> None:
        """`limit` is how many rounds there may be; 0 means an impact."""
        datas, shapes = ties.datas, ties.shapes
        if len({id(known) for known in datas}) < len(datas):
            raise InputError(
                "One data stands for two constraints; give each its own: constraint.createData()."
            )
        impact = limit == 0
        self.datas, self.live, self.report = datas, ties.live, np.zeros(3)
        self.solved = solved = Solved(model, ties, impact)
        self.forces = np.zeros(len(solved.forces))
        watch = model.watched("parameters")  # first: see `run`
        compiled = data.attach(model)
        self.left = Left(compiled, datas, shapes, *solved.kept[:4])
        given = (solved.a,) if impact else (solved.a, solved.a)
        given = (solved.kept[0], *given, solved.numbers, *((np.zeros(1),) if impact else ()), *ties.live)
        sizes: dict[str, Any] = {f"x{k}": x.shape for k, x in enumerate(given)}
        self.algorithm = IMPACT if impact else DYNAMICS
        where, kept, marks = side_outputs(data, self.algorithm)
        build = _traced(_impact(shapes) if impact else _motion(shapes, limit), kept, marks)
        kernel = compiled.compile(("constraint dynamics", shapes, limit), with_mass(build), **sizes)
        own = [self.forces, self.report, *solved.kept, solved.a, solved.forces, solved.numbers]
        told = [known._views["contact_force"]._v for known in datas]
        targets = [*(data.target(name) for name in self.algorithm.fills), *own, *told, *where]
        self.step = kernel.into(*targets, returns=(int(not impact),), watch=watch, otherwise=not_applicable)

    def run(self, *state: Any) -> Any:
        """The accelerations, or the velocity; NotImplemented where something is not what it was bound to."""
        found = self.step(*state, *self.live)
        if found is not NotImplemented:
            for known in self.datas:
                known._due = self.left
        return found


def solve(model: Model, data: Data, models: Any, datas: Any, limit: int, *given: Any) -> tuple[Session, Any]:
    """Runs dynamics (q, v, tau, numbers) or, limit = 0, an impact (q, v, numbers, restitution); see `Session`."""
    ties = tied(model, data, models, datas)
    session = ties.runs.get(limit)
    found = NotImplemented if session is None else session.run(*given)
    if found is NotImplemented:
        count = 2 if limit == 0 else 3
        sizes = zip((model.nq, model.nv, model.nv), ("q", "v", "tau"), strict=True)
        state = [exact(x, *size) for x, size in zip(given[:count], sizes, strict=False)]
        found = NotImplemented if session is None else session.run(*state, *given[count:])
        if found is NotImplemented:
            data.attach(model)
            ties = tied(model, data, models, datas)
            session = ties.runs[limit] = Session(model, data, ties, limit)
            found = session.run(*state, *given[count:])
            data.store_states(session.algorithm)
    assert session is not None
    data._constraint_solution = session.solved
    return session, found


_WRITTEN = ("ddq", "M", "com[0]", *JACOBIANS)
_LATE = JOINTS | VELOCITIES_IN_WORLD | CENTROIDAL_MAP | CENTERS
DYNAMICS = Algorithm(
    "constraint_dynamics",
    "qvt",
    ("nle", *_WRITTEN),
    not_applicable,
    deferred=_LATE | BODY_MOMENTA_IN_WORLD | {"oa": ACCELERATIONS_IN_WORLD["oa"], "oa_gf": BODIES["oa_gf"]},
    invalidates=("dFda", "of"),
    title="constraintDynamics",
)
IMPACT = Algorithm(
    "impact",
    "qv",
    ("dq_after", *_WRITTEN),
    not_applicable,
    deferred=_LATE,
    invalidates=("dFda",),
    title="impulseDynamics",
)
_DERIVED = Algorithm(
    "constraint_derivatives",
    "",
    (),
    not_applicable,
    invalidates=("of", "dFdq", "dFdv", "dtau_dq", "dtau_dv"),
    title="computeConstraintDynamicsDerivatives",
)
_IMPACT_DERIVED = Algorithm(
    "impact_derivatives",
    "",
    (),
    not_applicable,
    invalidates=("oa", "of", "dFdq", "dtau_dq", "dlambda_dtau"),
    title="computeImpulseDynamicsDerivatives",
)
_LCABA = Algorithm("lcaba", "", (), not_applicable, invalidates=("g", "of"), title="lcaba")
"""What algorithms under constraints leave besides their results."""


def leave_derived(model: Model, data: Data, compiled: CompiledModel, solved: Solved) -> None:
    """Leaves what derivatives under constraints leave besides their results."""
    q, v = solved.kept[:2]
    data.defer(INVERSE_MASS["Minv"], ("Minv",), compiled, q.copy())
    if not solved.impact:
        computeJointJacobiansTimeVariation(model, data, q, v)
        _leave_motion(data, compiled, ("a", "oa"), q, v, solved.a)
    data.invalidate(_IMPACT_DERIVED if solved.impact else _DERIVED)


def leave_eliminated(model: Model, data: Data) -> None:
    """Leaves what lcaba leaves besides its results."""
    assert data._constraint_solution is not None
    _leave_motion(
        data, data.attach(model), ("oa",), *data._constraint_solution.kept[:2], data._constraint_solution.a
    )
    data.invalidate(_LCABA)


def _leave_motion(data: Data, compiled: CompiledModel, fields: tuple[str, ...], *state: Floats) -> None:
    own = [x.copy() for x in state]
    data.defer(ACCELERATIONS_IN_WORLD["oa"], fields, compiled, *own)
    data.defer(BODIES["f"], ("oa_gf",), compiled, *own)


def _traced(build: Any, kept: list[int], marks: list[float]) -> Any:
    """The same, with what else it leaves."""

    def traced(core: CoreModel) -> Any:
        results = build(core)
        return lambda *given: (*results(*given), *(given[k] for k in kept), *marks)

    return traced


def flat(wanted: Array, shapes: Any) -> Array:
    """Of rows for all constraints (constraints, 6) those that they have, (m,)."""
    return np.concatenate([wanted[k, : shape[0]] for k, shape in enumerate(shapes)])


def _stacks(live: Sequence[Array]) -> tuple[Array, Array, Array]:
    """Placements, gains, and wanted accelerations, each in one array."""
    return np.stack(live[0::3]), np.stack(live[1::3]), np.stack(live[2::3])


def _rest(core: CoreModel, q: Array, shapes: Any, forces: Array) -> tuple[list[Array], list[Array]]:
    """What all algorithms under constraints leave in a Data, and what in the data of the constraints."""
    parts = np.split(forces, np.cumsum([shape[0] for shape in shapes])[:-1])
    places = stacked(algorithms.joint_poses(core, q))
    com, J = algorithms.center_of_mass(core, q), algorithms.joint_jacobians(core, q)
    matrices = [algorithms.mass_matrix(core, q), com, J, places]
    return matrices, [np.concatenate([part, np.zeros(6 - len(part))]) for part in parts]


def _motion(shapes: Any, limit: int) -> Any:
    owner = [k for k, shape in enumerate(shapes) for _ in range(shape[0])]

    def build(core: CoreModel) -> Any:
        def run(q: Array, v: Array, tau: Array, numbers: Array, *live: Array) -> tuple[Any, ...]:
            places, gains, wanted = _stacks(live)
            twists = constraint_twists(core, q, v, bonds_of(shapes, places))
            pull = gains[owner, 1] * twists.velocity + gains[owner, 0] * twists.error
            damped = Damped(numbers[0], numbers[1], numbers[2], limit)
            g = twists.bias + pull - flat(wanted, shapes)
            a, forces, *report = damped_dynamics(core, q, v, tau, twists.J, g, damped)
            left, told = _rest(core, q, shapes, forces)
            state = q, v, places, gains, wanted, a, forces, numbers
            nle = algorithms.bias_forces(core, q, v)
            return nle, a, *left, forces, np.stack(report), *state, *told

        return run

    return build


def _impact(shapes: Any) -> Any:
    def build(core: CoreModel) -> Any:
        def run(q: Array, v: Array, numbers: Array, part: Array, *live: Array) -> tuple[Any, ...]:
            places, gains, wanted = _stacks(live)
            bonds = bonds_of(shapes, places)
            J = algorithms.constraint_jacobian(core, q, bonds)
            jump = (1.0 + part[0]) * algorithms.constraint_velocity(core, q, v, bonds)
            a, forces, *report = damped_impact(core, q, J, jump, Damped(numbers[0], 0.0, 0.0, 1))
            left, told = _rest(core, q, shapes, forces)
            state = q, v, places, gains, wanted, a, forces, numbers
            return v + a, a, *left, forces, np.stack(report), *state, *told

        return run

    return build
