"""Algorithms of constrained motion as kernels take them: arrays in the order of the options that add them."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from ulna.algorithms import Proximal
from ulna.model import Model
from ulna.model.constraint import frame_pairs
from ulna.quantities.deferred_algorithms import algorithms
from ulna.quantities.forces import friction_law, wrench_arguments
from ulna.quantities.quantity import Arguments
from ulna.typing import Array

if TYPE_CHECKING:
    from ulna.compiler.language.function import SecondForm


def of_frame_pairs(algorithm: Callable[..., Any]) -> Callable[..., Any]:
    """An algorithm that takes resolved constraints last, as one that takes the option `constraints`."""

    @functools.wraps(algorithm)
    def run(model: Model, *arrays: Array, constraints: Any) -> Any:
        return algorithm(model, *arrays, frame_pairs(model, constraints))

    return run


def constraint_error(model: Model, q: Array, *anchors: Array, constraints: Any) -> Array:
    """Errors of constraints, against the anchors of contacts."""
    return algorithms.constraint_error(
        model, q, anchors[0] if anchors else None, frame_pairs(model, constraints)
    )


def anchor_arguments(options: Mapping[str, Any]) -> Arguments:
    """Contacts add one argument, their anchors (contacts, 4, 4)."""
    contacts = sum(constraint.is_contact for constraint in options["constraints"])
    return (("anchors", (contacts, 4, 4)),) if contacts else ()


def constrained_dynamics(
    model: Model,
    q: Array,
    v: Array,
    tau: Array,
    *rest: Array,
    constraints: Any,
    forces: tuple[str, ...],
    reference: Any,
    friction: Any,
    stabilised: bool,
    solver: Proximal,
) -> tuple[Any, ...]:
    """Accelerations, constraint forces, residual and rounds; the options say which arrays follow `tau`."""
    resolved, law, remaining = frame_pairs(model, constraints), friction_law(model, friction), list(rest)
    external = pull = None
    if forces:
        frames = [model.frame(name) for name in forces]
        external = algorithms.at_joints(model, q, remaining.pop(0), frames, reference)
    if stabilised:
        anchored = any(constraint.is_contact for constraint in constraints)
        pull = algorithms.Stabilisation(remaining.pop(0) if anchored else None, remaining.pop(0))
    if law is not None:
        tau = tau + algorithms.friction_torque(v, law)
    return tuple(algorithms.constrained_dynamics(model, q, v, tau, resolved, external, pull, solver))


def stages_of_motion(
    model: Model,
    *,
    constraints: Any,
    forces: tuple[str, ...],
    reference: Any,
    friction: Any,
    stabilised: bool,
    solver: Proximal,
) -> SecondForm | None:
    """The form of stages of `constrained_dynamics`; None where the motion is stabilised."""
    if stabilised:
        return None
    law = friction_law(model, friction)
    return algorithms.stages_of_constrained_dynamics(
        model, frame_pairs(model, constraints), solver, forces, reference, law
    )


def stages_of_impact(model: Model, *, constraints: Any, elastic: bool, solver: Proximal) -> SecondForm | None:
    """The form of stages of `impulse_dynamics`; None for elastic impacts."""
    if elastic:
        return None
    return algorithms.stages_of_impulse_dynamics(model, frame_pairs(model, constraints), solver)


def motion_arguments(options: Mapping[str, Any]) -> Arguments:
    """Wrenches of the forces; where the motion is stabilised, anchors and gains."""
    gains: Arguments = (("gains", (len(options["constraints"]), 2)),)
    return (
        *wrench_arguments(options),
        *((*anchor_arguments(options), *gains) if options["stabilised"] else ()),
    )


def forward_dynamics_with_jacobian(
    model: Model, *arrays: Array, rows: int, compliant: bool, solver: Proximal
) -> tuple[Any, ...]:
    """The same under J a + drift + compliance f = 0."""
    q, v, tau, J, drift, *compliance = arrays
    soft = compliance[0] if compliant else 0.0
    return tuple(algorithms.forward_dynamics_with_jacobian(model, q, v, tau, J, drift, soft, None, solver))


def jacobian_arguments(options: Mapping[str, Any]) -> Arguments:
    """The Jacobian of so many rows, its drift, and the compliance."""
    soft: Arguments = (("compliance", ()),) if options["compliant"] else ()
    return (("J", (options["rows"], "nv")), ("drift", (options["rows"],)), *soft)


def impulse_dynamics(
    model: Model, q: Array, v: Array, *restitution: Array, constraints: Any, elastic: bool, solver: Proximal
) -> tuple[Any, ...]:
    """Velocity after an impact, impulses, residual and rounds."""
    back = restitution[0] if elastic else None
    return tuple(algorithms.impulse_dynamics(model, q, v, frame_pairs(model, constraints), back, solver))


def impact_arguments(options: Mapping[str, Any]) -> Arguments:
    """Coefficients of restitution of an elastic impact."""
    return (("restitution", (len(options["constraints"]),)),) if options["elastic"] else ()
