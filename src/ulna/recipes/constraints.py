"""Recipes of constrained dynamics: motion, impacts and the parts of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from ulna import algorithms
from ulna.algorithms import Proximal, Stabilisation
from ulna.model import Model
from ulna.model.constraint import bonds
from ulna.recipes.base import QV, QVTAU, Arguments, Q, Recipe
from ulna.recipes.dynamics import FORCES, law_of, wrenches
from ulna.recipes.mass import with_mass
from ulna.typing import Array

_BOUND = {"constraints": ()}
_SOLVED = {**_BOUND, "solver": Proximal()}


def _of_bonds(function: Callable[..., Any]) -> Callable[..., Callable[..., Any]]:
    def build(model: Model, constraints: Any) -> Callable[..., Any]:
        resolved = bonds(model, constraints)
        return lambda *arrays: function(model, *arrays, resolved)

    return build


def _error(model: Model, constraints: Any) -> Callable[..., Any]:
    resolved = bonds(model, constraints)
    return lambda q, *anchors: algorithms.constraint_error(
        model, q, anchors[0] if anchors else None, resolved
    )


def _anchors(options: Mapping[str, Any]) -> Arguments:
    contacts = sum(constraint.is_contact for constraint in options["constraints"])
    return (("anchors", (contacts, 4, 4)),) if contacts else ()


def _motion(
    model: Model,
    constraints: Any,
    forces: tuple[str, ...],
    reference: Any,
    friction: Any,
    stabilised: bool,
    solver: Proximal,
) -> Callable[..., Any]:
    resolved, law = bonds(model, constraints), law_of(model, friction)
    frames = [model.frame(name) for name in forces]
    anchored = any(constraint.is_contact for constraint in constraints)

    def run(q: Array, v: Array, tau: Array, *rest: Array) -> tuple[Any, ...]:
        remaining = list(rest)
        external = algorithms.at_joints(model, q, remaining.pop(0), frames, reference) if frames else None
        pull = None
        if stabilised:
            pull = Stabilisation(remaining.pop(0) if anchored else None, remaining.pop(0))
        if law is not None:
            tau = tau + algorithms.friction_torque(v, law)
        return tuple(algorithms.constrained_dynamics(model, q, v, tau, resolved, external, pull, solver))

    return run


def _motion_arguments(options: Mapping[str, Any]) -> Arguments:
    pull: Arguments = ()
    if options["stabilised"]:
        pull = (*_anchors(options), ("gains", (len(options["constraints"]), 2)))
    return (*wrenches(options), *pull)


def _with_jacobian(model: Model, rows: int, compliant: bool, solver: Proximal) -> Callable[..., Any]:
    def run(q: Array, v: Array, tau: Array, J: Array, drift: Array, *compliance: Any) -> tuple[Any, ...]:
        soft = compliance[0] if compliant else 0.0
        return tuple(
            algorithms.forward_dynamics_with_jacobian(model, q, v, tau, J, drift, soft, None, solver)
        )

    return run


def _jacobian_arguments(options: Mapping[str, Any]) -> Arguments:
    soft: Arguments = (("compliance", ()),) if options["compliant"] else ()
    return (("J", (options["rows"], "nv")), ("drift", (options["rows"],)), *soft)


def _impact(model: Model, constraints: Any, elastic: bool, solver: Proximal) -> Callable[..., Any]:
    resolved = bonds(model, constraints)

    def run(q: Array, v: Array, *restitution: Array) -> tuple[Any, ...]:
        back = restitution[0] if elastic else None
        return tuple(algorithms.impulse_dynamics(model, q, v, resolved, back, solver))

    return run


def _impact_arguments(options: Mapping[str, Any]) -> Arguments:
    return (("restitution", (len(options["constraints"]),)),) if options["elastic"] else ()


RECIPES: dict[str, Recipe] = {
    "constraint_error": Recipe(_error, Q, _BOUND, "How far constraints are from closed, (m,).", _anchors),
    "constraint_velocity": Recipe(
        _of_bonds(algorithms.constraint_velocity), QV, _BOUND, "How fast they drift, (m,)."
    ),
    "constraint_jacobian": Recipe(
        _of_bonds(algorithms.constraint_jacobian), Q, _BOUND, "That velocity by v, (m, nv)."
    ),
    "constraint_bias": Recipe(
        _of_bonds(algorithms.constraint_bias), QV, _BOUND, "Its rate when a = 0, (m,)."
    ),
    "delassus_matrix": Recipe(
        with_mass(_of_bonds(algorithms.delassus_matrix)), Q, _BOUND, "J M^-1 J^T of constraints, (m, m)."
    ),
    "constrained_dynamics": Recipe(
        with_mass(_motion),
        QVTAU,
        {**_BOUND, **FORCES, "friction": False, "stabilised": False, "solver": Proximal()},
        "Accelerations (nv,), constraint forces (m,), residual and rounds, () each.",
        _motion_arguments,
    ),
    "forward_dynamics_with_jacobian": Recipe(
        with_mass(_with_jacobian),
        QVTAU,
        {"rows": 1, "compliant": False, "solver": Proximal()},
        "The same under J a + drift + compliance f = 0.",
        _jacobian_arguments,
    ),
    "impulse_dynamics": Recipe(
        with_mass(_impact),
        QV,
        {**_BOUND, "elastic": False, "solver": Proximal()},
        "Velocity after an impact (nv,), impulses (m,), residual and rounds, () each.",
        _impact_arguments,
    ),
}
