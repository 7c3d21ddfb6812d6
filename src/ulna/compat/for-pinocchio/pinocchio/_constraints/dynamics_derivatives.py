"""How accelerations and forces under constraints change with the state."""

from __future__ import annotations

from array import array
from functools import lru_cache, partial
from typing import Any, final

import numpy as np

from pinocchio._algorithms.jacobians import computeJointJacobiansTimeVariation
from pinocchio._constraints._procedures.product import bound_product
from pinocchio._constraints.bound_dynamics import (
    DERIVED,
    IMPACT_DERIVED,
    ConstraintSolution,
    with_side_outputs,
)
from pinocchio._constraints.dynamics import restitution
from pinocchio._constraints.kernels import core_constraints, flat, jacobian_kernel
from pinocchio._constraints.proximal_settings import settings_of
from pinocchio._constraints.rigid_constraint import checked_constraints, structures_of
from pinocchio._containers.arguments import ArgumentError
from pinocchio._containers.arrays import not_applicable
from pinocchio._data.binding import side_outputs
from pinocchio._data.data import Data
from pinocchio._data.evaluated_model import EvaluatedModel, step_on_numbers
from pinocchio._model.model import Model
from ulna.algorithms.constraints.bound_response import bound_response
from ulna.algorithms.constraints.dynamics_derivatives import bound_terms
from ulna.compiler import compile as compile_function
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
    ddq_dq, ddq_dv, dlambda_dq, dlambda_dv, ddq_dtau, dlambda_dtau = _derived(
        model, data, solved, float(rounds)
    )
    computeJointJacobiansTimeVariation(model, data, *solved.state[:2])
    return ddq_dq, ddq_dv, ddq_dtau, dlambda_dq, dlambda_dv, dlambda_dtau


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
    if prox_settings is not None:
        settings_of(prox_settings)
    solved = _solved(model, data, contact_models, contact_datas, True, "impulseDynamics")
    _derived(model, data, solved, 1.0 + restitution(r_coeff))


_BY_TAU = 5, 6
"""Which outputs of the kernel are derivatives by tau."""
_INPUTS = {"q": 0, "v": 1, "a": 5}
"""Which inputs of the kernel these are."""
_KEPT, _KEPT_OF_IMPACT = (0, 1, 2, 3, 4, 5, 6), (0, 1, 2, 5, 6)
"""Which inputs are kept for fields that are computed when they are read: states, constraints and forces."""


@final
class BoundDerivatives:
    """Derivatives bound to what an algorithm left: a product of two dense matrices between two native calls."""

    def __init__(self, model: Model, data: Data, solved: ConstraintSolution) -> None:
        self.model, self.impact, n, m = model, solved.impact, model.nv, len(solved.forces)
        self.factor, self.shapes = np.zeros(1), solved.shapes
        self.inputs = (*solved.state, solved.a, solved.forces, solved.settings, self.factor)
        kept = _KEPT_OF_IMPACT if solved.impact else _KEPT
        self.at = tuple(np.zeros_like(x) if k in kept else None for k, x in enumerate(self.inputs))
        watch = model._watched("parameters")  # first: see `run`
        compiled, shapes = data._attach(model), solved.shapes
        algorithm = IMPACT_DERIVED if solved.impact else DERIVED
        side_targets, stored, marks = side_outputs(data, algorithm)
        at_inputs = [*(_INPUTS[algorithm.inputs[k]] for k in stored), *kept]
        sizes: dict[str, Any] = {f"x{k}": x.shape for k, x in enumerate(self.inputs)}
        key = ("bound response", shapes, solved.impact)
        build = with_side_outputs(_response(shapes, solved.impact), at_inputs, marks)
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
        marked = len(side_targets) - len(marks)
        targets += [*side_targets[:marked], *(self.at[k] for k in kept), *side_targets[marked:]]
        filled = [data._arrays["ddq_dq"], self.outputs["dlambda_dq"]]
        if not solved.impact:
            filled = [filled[0], data._arrays["ddq_dv"], filled[1], self.outputs["dlambda_dv"]]
        self.evaluated = model.first_calls.includes(key, 1)
        if self.evaluated:
            self._step_on_numbers(build(EvaluatedModel(model).model), targets, filled)
        else:
            self._bind(compiled.compile(key, build, **sizes), targets, filled, watch)
        data._store_states(algorithm)

    def _step_on_numbers(self, function: Any, targets: list[Any], filled: list[Any]) -> None:
        """Evaluates the functions at every call."""
        of_state = step_on_numbers(function, targets, () if self.impact else _BY_TAU)
        split = step_on_numbers(
            _split(len(self.solution) - len(self.X_q), self.impact), filled, range(len(filled))
        )
        self.step, self.split = lambda: of_state(*self.inputs), lambda: split(self.solution, self.X_q)
        self.multiply = partial(np.dot, self.W, self.B, self.solution)

    def _bind(self, kernel: Any, targets: list[Any], filled: list[Any], watch: Any) -> None:
        """Binds the two kernels, and the product between them, to their arrays."""
        self.step = kernel.into(
            *targets,
            returns=() if self.impact else _BY_TAU,
            watch=watch,
            otherwise=not_applicable,
            trailing_inputs=self.inputs,
        )
        m, n = self.X_q.shape
        self.multiply = bound_product(self.W, self.B, self.solution)
        self.split = _splitter(n, m, self.impact).into(
            *filled,
            returns=() if self.impact else range(len(filled)),
            otherwise=not_applicable,
            trailing_inputs=(self.solution, self.X_q),
        )

    def fill(self, data: Data, factor: float) -> Any:
        """Writes them into the data.

        Args:
            factor: Number of rounds, or 1 plus the coefficient of restitution [-].

        Returns:
            Nothing for an impact; else accelerations by q and v, forces by q and v, and both by tau; NotImplemented
            where a parameter of the model has changed.
        """
        self.factor[0] = factor
        by_tau = self.step()
        if by_tau is NotImplemented or not self.flag[0]:
            return NotImplemented
        self.multiply()
        by_state = self.split()
        data._arrays.update(self.outputs)
        if self.impact:
            data._impact_derivatives = self
            return None
        data._motion_derivatives = self
        return by_state + by_tau


def _split(n: int, impact: bool) -> Any:
    """Derivatives of accelerations and forces out of one matrix, and of what forces change by beside it."""

    def run(solution: Array, X_q: Array) -> tuple[Array, ...]:
        by_q = solution[:n, :n], solution[n:, :n] + X_q
        return by_q if impact else (by_q[0], solution[:n, n:], by_q[1], solution[n:, n:])

    return run


@lru_cache(32)
def _splitter(n: int, m: int, impact: bool) -> Any:
    return compile_function(_split(n, impact), solution=(n + m, n if impact else 2 * n), X_q=(m, n))


def _derived(model: Model, data: Data, solved: ConstraintSolution, factor: float) -> Any:
    """What `BoundDerivatives.fill` returns."""
    derived = solved.derived
    if derived is not None and derived.model is model and not derived.evaluated:
        results = derived.fill(data, factor)
        if results is not NotImplemented:
            return results
    derived = solved.derived = BoundDerivatives(model, data, solved)
    results = derived.fill(data, factor)
    if results is NotImplemented:
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
    return results


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
