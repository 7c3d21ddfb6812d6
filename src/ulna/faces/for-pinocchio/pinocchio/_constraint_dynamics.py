"""Accelerations and forces of a robot that constraints bind."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple, final

import numpy as np

from pinocchio._arrays import exact
from pinocchio._constraint_kernels import bonds_of, paired, shapes_of
from pinocchio._constraint_pair import changes
from pinocchio._constraint_state import Bound, Left, bound, leave
from pinocchio._constraints import RigidConstraintData, RigidConstraintModel
from pinocchio._data import Data, engine_for
from pinocchio._dynamics import aba
from pinocchio._jacobian_dynamics import impact_with_jacobian
from pinocchio._kinematics import stacked
from pinocchio._model import Model
from pinocchio._proximal import ProximalSettings, settings_of
from pinocchio._runs import refuse
from pinocchio._states import OWN
from ulna import algorithms
from ulna.algorithms.constrained_dynamics_damped import Damped, damped_dynamics, damped_impact
from ulna.algorithms.constraint_twists import constraint_twists
from ulna.errors import InputError
from ulna.model import Model as TowerModel
from ulna.recipes.base import with_mass
from ulna.typing import Array, Floats

__all__ = [
    "computeJointMinimalOrdering",
    "constraintDynamics",
    "impulseDynamics",
    "initConstraintDynamics",
    "lcaba",
]


class Solved(NamedTuple):
    """What the last algorithm under constraints found."""

    state: Bound
    a: Floats
    forces: Floats
    wanted: Floats
    settings: ProximalSettings
    impact: bool

    def solved(self) -> Solved:
        """Itself."""
        return self


def initConstraintDynamics(model: Model, data: Data, contact_models: Any, contact_datas: Any) -> None:
    """Makes room in `data` for the forces of constraints, all zero; checks constraints and their data."""
    models = paired(model, contact_models, contact_datas)
    engine_for(model, data)
    m, nv = sum(one.residualSize() for one in models), model.nv
    blocks = data._blocks
    for name in ("lambda_c", "impulse_c"):
        blocks[name] = np.zeros(m)
    for name in ("dlambda_dq", "dlambda_dv", "dlambda_dtau", "dac_da"):
        blocks[name] = np.zeros((m, nv))
    blocks["osim"] = np.zeros((m, m))


def share(forces: Floats, datas: Sequence[RigidConstraintData]) -> None:
    """Writes the forces (m,) into the data of their constraints."""
    start = 0
    for known in datas:
        known._views["contact_force"]._v[: known._size] = forces[start : start + known._size]
        start += known._size


@final
class Session:
    """Constraints bound to a Data: one native call solves, and writes what is known then."""

    def __init__(self, model: Model, data: Data, models: Any, datas: Any, limit: int) -> None:
        self.models, self.datas = paired(model, models, datas), list(datas)
        if len({id(known) for known in self.datas}) < len(self.datas):
            raise InputError(
                "One data stands for two constraints; give each its own: constraint.createData()."
            )
        self.model, self.limit, self.version = model, limit, changes[0]
        self.home = data._blocks["ddq"]
        self.shapes = shapes = shapes_of(self.models)
        k, rows = len(shapes), sum(shape[0] for shape in shapes)
        self.places, self.gains = np.zeros((k, 2, 4, 4)), np.zeros((k, 2))
        self.wanted, self.numbers = np.zeros((k, 6)), np.zeros(3)
        self.settings = ProximalSettings()
        self.a, self.forces, self.report = np.zeros(model.nv), np.zeros(rows), np.zeros(3)
        self.kept = [np.zeros(model.nq), np.zeros(model.nv), self.places.copy(), self.gains.copy()]
        self.kept_wanted = self.wanted.copy()
        engine = data.attach(model)
        self.left = Left(engine, self.datas, shapes, *self.kept)
        given = {"q": self.kept[0], "v": self.kept[1], "tau": self.a, "places": self.places}
        given |= {"gains": self.gains, "wanted": self.wanted, "numbers": self.numbers}
        sizes: dict[str, Any] = {name: x.shape for name, x in given.items()}
        kernel = engine.made(
            ("constraint dynamics", shapes, limit), with_mass(_motion(shapes, limit)), **sizes
        )
        names = ("ddq", "M", "nle", "J", "oMi", "places q", "own q", "jacobians q")
        targets = [data.target(name) for name in names]
        own = [self.a, self.forces, self.report, *self.kept, self.kept_wanted]
        forces = [known._views["contact_force"]._v for known in self.datas]
        watch = model.watched("numbers")
        self.step = kernel.into(*targets, *own, *forces, returns=(0,), watch=watch, otherwise=refuse)
        data._known |= {"places", "own", "jacobians"}

    def serves(self, model: Model, data: Data, models: Any, datas: Any, limit: int) -> bool:
        """Whether it was made for these."""
        return (
            self.model is model
            and self.home is data._blocks["ddq"]
            and self.limit == limit
            and self.version == changes[0]
            and models == self.models
            and datas == self.datas
        )

    def solve(self, models: Any, settings: ProximalSettings, q: Any, v: Any, tau: Any) -> Any:
        """The accelerations; NotImplemented where arguments or numbers of the model are not what they were."""
        for k, one in enumerate(models):
            self.places[k] = one._places
            self.gains[k] = one._gains._v
        for k, known in enumerate(self.datas):
            self.wanted[k] = known._views["contact_acceleration_desired"]._v
            known._due = self.left
        self.settings = settings
        self.numbers[:] = settings._numbers
        return self.step(q, v, tau, self.places, self.gains, self.wanted, self.numbers)

    def solved(self) -> Solved:
        """What it found."""
        q, v, places, gains = (x.copy() for x in self.kept)
        wanted = np.concatenate(
            [w[: shape[0]] for w, shape in zip(self.kept_wanted, self.shapes, strict=True)]
        )
        state = Bound(self.models, self.datas, q, v, places, gains)
        return Solved(state, self.a.copy(), self.forces.copy(), wanted, self.settings, False)


def constraintDynamics(
    model: Model,
    data: Data,
    q: Any,
    v: Any,
    tau: Any,
    contact_models: Any,
    contact_datas: Any,
    prox_settings: Any = None,
) -> Floats:
    """The accelerations that torques give under constraints (nv,); kept in `data.ddq`, the forces in `data.lambda_c`.

    Each force is also in `contact_force` of the data of its constraint. Fills `data.M`, `data.nle`, `data.J` and
    `data.oMi`, too.

    Args:
        model: The model.
        data: Its data.
        q: Configuration (nq,).
        v: Velocity (nv,).
        tau: Torques (nv,).
        contact_models: Constraints.
        contact_datas: Their data.
        prox_settings: How the forces are found; it is told how that went. None for one round without damping.
    """
    settings = _ONE_ROUND if prox_settings is None else settings_of(prox_settings)
    session = data._session
    if session is None or not session.serves(model, data, contact_models, contact_datas, settings.max_iter):
        if not len(contact_models):
            paired(model, contact_models, contact_datas)
            return aba(model, data, q, v, tau)
        session = data._session = Session(model, data, contact_models, contact_datas, settings.max_iter)
    a = session.solve(contact_models, settings, q, v, tau)
    if a is NotImplemented:
        q, v, tau = exact(q, model.nq, "q"), exact(v, model.nv, "v"), exact(tau, model.nv, "tau")
        session = data._session = Session(model, data, contact_models, contact_datas, settings.max_iter)
        a = session.solve(contact_models, settings, q, v, tau)
    if prox_settings is not None:
        settings._report(*session.report)
    data._blocks["lambda_c"] = session.forces
    data._due |= OWN
    data._bound = session
    return a


_ONE_ROUND = ProximalSettings()
"""The settings that hold when none are given."""


def _motion(shapes: Any, limit: int) -> Any:
    sizes = [shape[0] for shape in shapes]
    owner = [i for i, size in enumerate(sizes) for _ in range(size)]

    def build(tower: TowerModel) -> Any:
        def run(
            q: Array, v: Array, tau: Array, places: Array, gains: Array, wanted: Array, numbers: Array
        ) -> tuple[Any, ...]:
            twists = constraint_twists(tower, q, v, bonds_of(shapes, places))
            pull = gains[owner, 1] * twists.velocity + gains[owner, 0] * twists.error
            asked = np.concatenate([wanted[k, :size] for k, size in enumerate(sizes)])
            damped = Damped(numbers[0], numbers[1], numbers[2], limit)
            a, forces, *report = damped_dynamics(
                tower, q, v, tau, twists.J, twists.bias + pull - asked, damped
            )
            parts = np.split(forces, np.cumsum(sizes)[:-1])
            return (
                a,
                algorithms.mass_matrix(tower, q),
                algorithms.bias_forces(tower, q, v),
                algorithms.joint_jacobians(tower, q),
                stacked(algorithms.joint_poses(tower, q)),
                q,
                q,
                q,
                a,
                forces,
                np.stack(report),
                q,
                v,
                places,
                gains,
                wanted,
                *(np.concatenate([part, np.zeros(6 - len(part))]) for part in parts),
            )

        return run

    return build


def computeJointMinimalOrdering(model: Model, data: Data, constraint_models: Any) -> None:
    """Checks the constraints; `lcaba` needs no ordering here."""
    engine_for(model, data)
    paired(model, constraint_models, [one.createData() for one in constraint_models])


def lcaba(
    model: Model,
    data: Data,
    q: Any,
    v: Any,
    tau: Any,
    constraint_models: Any,
    constraint_datas: Any,
    prox_settings: Any,
) -> Floats:
    """The same as constraintDynamics; how closed loops are eliminated is decided inside."""
    return constraintDynamics(
        model, data, q, v, tau, constraint_models, constraint_datas, settings_of(prox_settings)
    )


def impulseDynamics(model: Model, data: Data, *state: Any, **named: Any) -> Floats:
    """The velocity after an impact (nv,); kept in `data.dq_after`, the impulses in `data.impulse_c`.

    `impulseDynamics(model, data, q, v, constraints, datas[, r_coeff[, settings]])`, or with a Jacobian,
    `impulseDynamics(model, data, [q,] v, J[, restitution_coefficient[, damping]])`; without q after crba.
    Each impulse is also in `contact_force` of the data of its constraint; both ends of a constraint count.
    """
    told = list(state)
    for name in ("q", "v_before", "v", "constraint_jacobian", "contact_models", "contact_datas"):
        if name in named:
            told.append(named.pop(name))
    if len(told) < 4 or not _are_constraints(told[2]):
        return impact_with_jacobian(model, data, *told, **named)
    return _impact(model, data, *told, **named)


def _are_constraints(value: Any) -> bool:
    return isinstance(value, (list, tuple)) and all(isinstance(x, RigidConstraintModel) for x in value)


def _impact(
    model: Model,
    data: Data,
    q: Any,
    v: Any,
    contact_models: Any,
    contact_datas: Any,
    r_coeff: float = 0.0,
    prox_settings: Any = None,
) -> Floats:
    state = bound(model, contact_models, contact_datas, q, v)
    settings = settings_of(prox_settings)
    engine = engine_for(model, data)
    blocks = data._blocks
    if not state.models:
        blocks["dq_after"][:] = state.v
        return state.v.copy()
    shapes = shapes_of(state.models)
    numbers = np.array([settings.mu, restitution(r_coeff)])
    given = (state.q, state.v, state.places, numbers)
    sizes: dict[str, Any] = dict(zip(("q", "v", "places", "numbers"), (x.shape for x in given), strict=True))
    found = engine.made(("impact", shapes), with_mass(_impact_of(shapes)), **sizes)(*given)
    blocks["ddq"][:], impulses, blocks["M"][:], blocks["J"][:], data._tails["oMi"][...] = found
    blocks["dq_after"][:] = after = state.v + found[0]
    blocks["impulse_c"] = impulses
    q = data.keep(engine, state.q)
    data._q_of_jacobians = q
    share(impulses, state.datas)
    leave(engine, state)
    data._bound = Solved(
        state._replace(q=q, v=state.v.copy()), found[0], impulses, 0.0 * impulses, settings, True
    )
    return after


def restitution(value: Any) -> float:
    part = float(value)
    if not 0.0 <= part <= 1.0:
        raise InputError(f"The coefficient of restitution is {value!r}; expected a number from 0 to 1.")
    return part


def _impact_of(shapes: Any) -> Any:
    def build(tower: TowerModel) -> Any:
        def run(q: Array, v: Array, places: Array, numbers: Array) -> tuple[Any, ...]:
            bonds = bonds_of(shapes, places)
            J = algorithms.constraint_jacobian(tower, q, bonds)
            jump = (1.0 + numbers[1]) * algorithms.constraint_velocity(tower, q, v, bonds)
            found = damped_impact(tower, q, J, jump, Damped(numbers[0], 0.0, 0.0, 1))
            return (
                found.a,
                found.forces,
                algorithms.mass_matrix(tower, q),
                algorithms.joint_jacobians(tower, q),
                stacked(algorithms.joint_poses(tower, q)),
            )

        return run

    return build
