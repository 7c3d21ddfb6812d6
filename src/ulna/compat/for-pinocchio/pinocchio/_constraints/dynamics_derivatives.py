"""How accelerations and forces under constraints change with the state."""

from __future__ import annotations

from array import array
from typing import Any, final

import numpy as np

from pinocchio._algorithms.jacobians import computeJointJacobiansTimeVariation
from pinocchio._constraints.bound_dynamics import (
    DERIVED,
    IMPACT_DERIVED,
    ConstraintSolution,
    flat,
    with_side_outputs,
)
from pinocchio._constraints.dynamics import restitution
from pinocchio._constraints.kernels import core_constraints, jacobian_kernel
from pinocchio._constraints.proximal_settings import settings_of
from pinocchio._constraints.rigid_constraint import checked_constraints, structures_of
from pinocchio._containers.arguments import ArgumentError
from pinocchio._containers.arrays import not_applicable
from pinocchio._data.binding import side_outputs
from pinocchio._data.data import Data
from pinocchio._model.model import Model
from ulna.algorithms.constraints.bound_response import bound_response
from ulna.algorithms.constraints.dynamics_derivatives import bound_terms
from ulna.errors import InputError
from ulna.model import Model as CoreModel
from ulna.typing import Array, Floats

__all__ = ["computeConstraintDynamicsDerivatives", "computeImpulseDynamicsDerivatives"]


def computeConstraintDynamicsDerivatives(
    model: Model, data: Data, contact_models: Any, contact_datas: Any, settings: Any = None
) -> tuple[Floats, ...]:
    """Derivatives of accelerations, (nv, nv) each, and forces, (m, nv) each, by q, v and tau, after constraintDynamics.

    They are kept in `data.ddq_dq`, `ddq_dv`, `ddq_dtau`, `dlambda_dq`, `dlambda_dv` and `dlambda_dtau`.

    Args:
        data: Its data, as constraintDynamics left it.
        settings: Those of constraintDynamics.

    Returns:
        Three matrices (nv, nv), then three (m, nv).
    """
    rounds = 1 if settings is None else max(1, settings_of(settings).iter)
    solved = _solved(model, data, contact_models, contact_datas, False, "constraintDynamics")
    derived = _derived(model, data, solved, float(rounds))
    computeJointJacobiansTimeVariation(model, data, *solved.state[:2])
    blocks = data._arrays
    return tuple([blocks[name].copy() for name in derived.names])


def computeImpulseDynamicsDerivatives(
    model: Model,
    data: Data,
    contact_models: Any,
    contact_datas: Any,
    r_coeff: float = 0.0,
    prox_settings: Any = None,
) -> None:
    """Derivatives of an impact by q and v, after impulseDynamics with constraints.

    Fills `data.ddq_dq` and `data.ddq_dv`, of the jump of the velocity, and `data.dlambda_dq` and `data.dlambda_dv`,
    of the impulses.

    Args:
        data: Its data, after impulseDynamics.
        r_coeff: Coefficient of restitution [-].
        prox_settings: Accepted; only its type is checked.
    """
    settings_of(prox_settings)
    solved = _solved(model, data, contact_models, contact_datas, True, "impulseDynamics")
    _derived(model, data, solved, 1.0 + restitution(r_coeff))


_INPUTS = {"q": 0, "v": 1, "a": 5}
"""Which inputs of the kernel these are."""


@final
class BoundDerivatives:
    """Derivatives bound to what an algorithm left: a native call, and a product of two dense matrices."""

    names = ("ddq_dq", "ddq_dv", "ddq_dtau", "dlambda_dq", "dlambda_dv", "dlambda_dtau")

    def __init__(self, model: Model, data: Data, solved: ConstraintSolution) -> None:
        self.model, self.impact, n, m = model, solved.impact, model.nv, len(solved.forces)
        self.factor = np.zeros(1)
        self.inputs = (*solved.state, solved.a, solved.forces, solved.settings, self.factor)
        watch = model._watched("parameters")  # first: see `run`
        compiled, shapes = data._attach(model), solved.shapes
        algorithm = IMPACT_DERIVED if solved.impact else DERIVED
        side_targets, stored, marks = side_outputs(data, algorithm)
        at_inputs = [_INPUTS[algorithm.inputs[k]] for k in stored]
        sizes: dict[str, Any] = {f"x{k}": x.shape for k, x in enumerate(self.inputs)}
        key = ("bound response", shapes, solved.impact)
        build = with_side_outputs(_response(shapes, solved.impact), at_inputs, marks)
        kernel = compiled.compile(key, build, **sizes)
        self.outputs = {name: np.zeros((m, n)) for name in ("dlambda_dq", "dlambda_dv")}
        self.outputs["osim"] = np.zeros((m, m))
        wide = n if solved.impact else 2 * n
        self.W, self.B, self.solution = (np.zeros((n + m, k)) for k in (n + m, wide, wide))
        self.X_q, self.flag = np.zeros((m, n)), array("d", [0.0])
        unique = np.frombuffer(self.flag).reshape(())
        targets = [self.W, self.B, self.X_q, self.outputs["osim"], unique]
        if solved.impact:
            targets += [data._arrays["ddq_dv"], self.outputs["dlambda_dv"]]
        else:
            self.outputs |= {name: np.zeros((m, n)) for name in ("dlambda_dtau", "dac_da")}
            targets += [data._arrays["ddq_dtau"], self.outputs["dlambda_dtau"], self.outputs["dac_da"]]
        self.step = kernel.into(
            *targets, *side_targets, watch=watch, otherwise=not_applicable, last_inputs=self.inputs
        )
        data._store_states(algorithm)
        self.by_q, self.by_v = ((x[:n], x[n:]) for x in (self.solution[:, :n], self.solution[:, n:]))

    def fill(self, data: Data, factor: float) -> Any:
        """Writes them into the data; NotImplemented where a number of the model is not what it was.

        Args:
            factor: Number of rounds, or 1 plus the coefficient of restitution [-].

        Returns:
            None; NotImplemented where a parameter of the model has changed.
        """
        self.factor[0] = factor
        if self.step() is NotImplemented or not self.flag[0]:
            return NotImplemented
        np.matmul(self.W, self.B, out=self.solution)
        blocks, outputs = data._arrays, self.outputs
        blocks["ddq_dq"][...], forces = self.by_q
        np.add(forces, self.X_q, out=outputs["dlambda_dq"])
        if not self.impact:
            blocks["ddq_dv"][...], outputs["dlambda_dv"][...] = self.by_v
        blocks.update(outputs)
        return None


def _derived(model: Model, data: Data, solved: ConstraintSolution, factor: float) -> BoundDerivatives:
    derived = solved.derived
    if derived is not None and derived.model is model and derived.fill(data, factor) is not NotImplemented:
        return derived
    derived = solved.derived = BoundDerivatives(model, data, solved)
    if derived.fill(data, factor) is NotImplemented:
        q, _, placements, _, _ = solved.state
        J = jacobian_kernel(data._attach(model), solved.shapes, model.nq)(q, *placements)
        if not np.isfinite(J).all():
            raise ArgumentError(
                f"{'impulseDynamics' if solved.impact else 'constraintDynamics'} was given q = {q}."
            )
        raise InputError(
            f"The {len(J)} rows of the constraints depend on each other (rank {np.linalg.matrix_rank(J)}): "
            "their forces are not unique, and have no derivatives. Leave some out, or give settings with mu > 0."
        )
    return derived


def _solved(model: Model, data: Data, models: Any, datas: Any, impact: bool, call: str) -> ConstraintSolution:
    solved = data._constraint_solution
    if solved is not None and solved.impact == impact and solved.constraint_set.matches(model, models, datas):
        return solved
    data._attach(model)
    checked = checked_constraints(model, models, datas)
    if solved is None or solved.impact != impact or structures_of(checked) != solved.shapes:
        raise InputError(
            f"This Data holds no solution of these constraints. Call {call} with them, and the same data, first."
        )
    return solved


def _response(shapes: Any, impact: bool) -> Any:
    def build(core: CoreModel) -> Any:
        def run(
            q: Array,
            v: Array,
            placements: Array,
            gains: Array,
            desired: Array,
            a: Array,
            forces: Array,
            settings: Array,
            factor: Array,
        ) -> tuple[Any, ...]:
            frame_pairs = core_constraints(shapes, placements)
            if impact:
                v, gains, desired = factor[0] * v + a, np.zeros(gains.shape), np.zeros(desired.shape)
            terms = bound_terms(core, q, v, a, forces, gains, flat(desired, shapes), frame_pairs, impact)
            if not impact:
                response = bound_response(terms, settings[0], factor[0])
                more = response.a_tau, response.f_tau, terms.X @ terms.J
                return response.W, response.B, response.X_q, response.S, response.unique, *more
            response, n = bound_response(terms._replace(g_q=terms.c_q), settings[0]), core.nv
            by_v = response.W[:, n:] @ (factor[0] * terms.J)  # all that depends on v
            return (
                response.W,
                response.B[:, :n],
                response.X_q,
                response.S,
                response.unique,
                by_v[:n],
                by_v[n:],
            )

        return run

    return build
