"""How accelerations and forces under constraints change with the state."""

from __future__ import annotations

from typing import Any, final

import numpy as np

from pinocchio._constraints.bound_dynamics import Solved, flat, leave_derived
from pinocchio._constraints.dynamics import restitution
from pinocchio._constraints.kernels import bonds_of, jacobian_kernel
from pinocchio._constraints.proximal_settings import settings_of
from pinocchio._constraints.rigid_constraint import paired, shapes_of
from pinocchio._data.data import Data
from pinocchio._model.bound_kernels import not_applicable
from pinocchio._model.model import Model
from ulna.algorithms.constraints.dynamics_derivatives import bound_response, bound_terms
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
        model: The model.
        data: Its data, as constraintDynamics left it.
        contact_models: The constraints.
        contact_datas: Their data.
        settings: Those of constraintDynamics.
    """
    rounds = 1 if settings is None else max(1, settings_of(settings).iter)
    solved = _solved(model, data, contact_models, contact_datas, False, "constraintDynamics")
    derived = _derived(model, data, solved, float(rounds))
    leave_derived(model, data, derived.compiled, solved)
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
    """
    settings_of(prox_settings)
    solved = _solved(model, data, contact_models, contact_datas, True, "impulseDynamics")
    derived = _derived(model, data, solved, 1.0 + restitution(r_coeff))
    leave_derived(model, data, derived.compiled, solved)


@final
class Derived:
    """Derivatives bound to what an algorithm left: a native call, and a product of two dense matrices."""

    names = ("ddq_dq", "ddq_dv", "ddq_dtau", "dlambda_dq", "dlambda_dv", "dlambda_dtau")

    def __init__(self, model: Model, data: Data, solved: Solved) -> None:
        self.model, self.impact, n, m = model, solved.impact, model.nv, len(solved.forces)
        self.told = np.zeros(1)
        self.given = (*solved.kept, solved.a, solved.forces, solved.numbers, self.told)
        watch = model.watched("parameters")  # first: see `run`
        self.compiled = compiled = data.attach(model)
        shapes = solved.shapes
        sizes: dict[str, Any] = {f"x{k}": x.shape for k, x in enumerate(self.given)}
        key, build = ("bound response", shapes, solved.impact), _response(shapes, solved.impact)
        kernel = compiled.compile(key, build, **sizes)
        self.own = {name: np.zeros((m, n)) for name in ("dlambda_dq", "dlambda_dv")}
        self.own["osim"] = np.zeros((m, m))
        wide = n if solved.impact else 2 * n
        self.W, self.B, self.found = (np.zeros((n + m, k)) for k in (n + m, wide, wide))
        self.X_q, self.unique = np.zeros((m, n)), np.zeros(())
        targets = [self.W, self.B, self.X_q, self.own["osim"], self.unique]
        if solved.impact:
            targets += [data._arrays["ddq_dv"], self.own["dlambda_dv"]]
        else:
            self.own |= {name: np.zeros((m, n)) for name in ("dlambda_dtau", "dac_da")}
            targets += [data._arrays["ddq_dtau"], self.own["dlambda_dtau"], self.own["dac_da"]]
        self.step = kernel.into(*targets, watch=watch, otherwise=not_applicable)
        self.by_q, self.by_v = ((x[:n], x[n:]) for x in (self.found[:, :n], self.found[:, n:]))

    def fill(self, data: Data, told: float) -> Any:
        """Writes them into the data; NotImplemented where a number of the model is not what it was."""
        self.told[0] = told
        if self.step(*self.given) is NotImplemented or not self.unique:
            return NotImplemented
        np.matmul(self.W, self.B, out=self.found)
        blocks, own = data._arrays, self.own
        blocks["ddq_dq"][...], forces = self.by_q
        np.add(forces, self.X_q, out=own["dlambda_dq"])
        if not self.impact:
            blocks["ddq_dv"][...], own["dlambda_dv"][...] = self.by_v
        blocks.update(own)
        data.mark_filled("ddq_dq", "ddq_dv", "ddq_dtau", *own)
        return None


def _derived(model: Model, data: Data, solved: Solved, told: float) -> Derived:
    derived = solved.derived
    if derived is not None and derived.model is model and derived.fill(data, told) is not NotImplemented:
        return derived
    derived = solved.derived = Derived(model, data, solved)
    if derived.fill(data, told) is NotImplemented:
        q, _, places, _, _ = solved.kept
        J = jacobian_kernel(data.attach(model), solved.shapes, model.nq)(q, *places)
        if not np.isfinite(J).all():
            raise InputError(
                f"{'impulseDynamics' if solved.impact else 'constraintDynamics'} was given q = {q}."
            )
        raise InputError(
            f"The {len(J)} rows of the constraints depend on each other (rank {np.linalg.matrix_rank(J)}): "
            "their forces are not unique, and have no derivatives. Leave some out, or give settings with mu > 0."
        )
    return derived


def _solved(model: Model, data: Data, models: Any, datas: Any, impact: bool, mend: str) -> Solved:
    solved = data._constraint_solution
    if solved is not None and solved.impact == impact and solved.ties.serves(model, models, datas):
        return solved
    data.attach(model)
    checked = paired(model, models, datas)
    if solved is None or solved.impact != impact or shapes_of(checked) != solved.shapes:
        raise InputError(
            f"This Data holds no solution of these constraints. Call {mend} with them, and the same data, first."
        )
    return solved


def _response(shapes: Any, impact: bool) -> Any:
    def build(core: CoreModel) -> Any:
        def run(
            q: Array,
            v: Array,
            places: Array,
            gains: Array,
            wanted: Array,
            a: Array,
            forces: Array,
            numbers: Array,
            told: Array,
        ) -> tuple[Any, ...]:
            bonds = bonds_of(shapes, places)
            if impact:
                v, gains, wanted = told[0] * v + a, np.zeros(gains.shape), np.zeros(wanted.shape)
            terms = bound_terms(core, q, v, a, forces, gains, flat(wanted, shapes), bonds, impact)
            if not impact:
                found = bound_response(terms, numbers[0], told[0])
                more = found.a_tau, found.f_tau, terms.X @ terms.J
                return found.W, found.B, found.X_q, found.S, found.unique, *more
            found, n = bound_response(terms._replace(g_q=terms.c_q), numbers[0]), core.nv
            by_v = found.W[:, n:] @ (told[0] * terms.J)  # all that depends on v
            return found.W, found.B[:, :n], found.X_q, found.S, found.unique, by_v[:n], by_v[n:]

        return run

    return build
