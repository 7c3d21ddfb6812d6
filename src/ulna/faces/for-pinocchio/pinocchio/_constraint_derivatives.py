"""How accelerations and forces under constraints change with the state."""

from __future__ import annotations

from typing import Any

import numpy as np

from pinocchio._constraint_dynamics import restitution
from pinocchio._constraint_kernels import bonds_of, paired, shapes_of
from pinocchio._constraint_session import Solved
from pinocchio._data import Data, engine_for
from pinocchio._model import Model
from pinocchio._proximal import settings_of
from ulna.algorithms.constrained_dynamics_derivatives import (
    BoundDerivatives,
    BoundTerms,
    bound_derivatives,
    bound_terms,
)
from ulna.errors import InputError
from ulna.model import Model as TowerModel
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
    settings = settings_of(settings)
    solved = _solved(model, data, contact_models, contact_datas, False, "constraintDynamics")
    terms = _terms(model, data, solved, solved.state.v, solved.state.gains)
    found = _derivatives(terms, solved.settings.mu, max(1, settings.iter))
    blocks = data._blocks
    for name, block in zip(("ddq_dq", "ddq_dv", "ddq_dtau"), found[:3], strict=True):
        blocks[name][:] = block
    blocks["dlambda_dq"], blocks["dlambda_dv"], blocks["dlambda_dtau"], blocks["osim"] = found[3:]
    blocks["dac_da"] = terms.X @ terms.J
    return tuple(found[:6])


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
    factor = 1.0 + restitution(r_coeff)
    terms = _terms(model, data, solved, factor * solved.state.v + solved.a, 0.0 * solved.state.gains)
    terms = terms._replace(g_q=terms.c_q, g_v=factor * terms.J, r_v=0.0 * terms.r_v)
    found = _derivatives(terms, solved.settings.mu, 1)
    blocks = data._blocks
    blocks["ddq_dq"][:], blocks["ddq_dv"][:] = found.a_q, found.a_v
    blocks["dlambda_dq"], blocks["dlambda_dv"], blocks["osim"] = found.f_q, found.f_v, found.S


def _derivatives(terms: BoundTerms, mu: float, rounds: int) -> BoundDerivatives:
    try:
        return bound_derivatives(terms, mu, rounds)
    except np.linalg.LinAlgError:
        raise InputError(
            f"The {len(terms.J)} rows of the constraints depend on each other (rank {np.linalg.matrix_rank(terms.J)}): "
            "their forces are not unique, and have no derivatives. Leave some out, or give settings with mu > 0."
        ) from None


def _solved(model: Model, data: Data, models: Any, datas: Any, impact: bool, mend: str) -> Solved:
    engine_for(model, data)
    checked = paired(model, models, datas)
    solved = None if data._bound is None else data._bound.solved()
    if solved is None or solved.impact != impact or shapes_of(checked) != shapes_of(solved.state.models):
        raise InputError(
            f"This Data holds no solution of these constraints. Call {mend} with them, and the same data, first."
        )
    return solved


def _terms(model: Model, data: Data, solved: Solved, v: Floats, gains: Floats) -> BoundTerms:
    shapes, impact = shapes_of(solved.state.models), solved.impact

    def build(tower: TowerModel) -> Any:
        def run(places: Array, *state: Array) -> tuple[Array, ...]:
            return tuple(bound_terms(tower, *state, bonds=bonds_of(shapes, places), impact=impact))

        return run

    given = (solved.state.places, solved.state.q, v, solved.a, solved.forces, gains, solved.wanted)
    names = ("places", "q", "v", "a", "forces", "gains", "wanted")
    sizes: dict[str, Any] = {name: x.shape for name, x in zip(names, given, strict=True)}
    return BoundTerms(*engine_for(model, data).made(("bound terms", shapes, impact), build, **sizes)(*given))
