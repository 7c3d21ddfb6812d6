"""Recipes of dynamics: torques, accelerations, inertia, energy, momentum, centre of mass."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from ulna import algorithms
from ulna.algorithms import Friction
from ulna.model import Model
from ulna.recipes.base import QV, QVA, QVTAU, Arguments, Q, Recipe, on_model
from ulna.recipes.mass import with_mass
from ulna.typing import Array

FORCES = {"forces": (), "reference": "local_world_aligned"}
_SUBTREE = {"subtree": None}


def wrenches(options: Mapping[str, Any]) -> Arguments:
    """Named frames add one argument, their wrenches (k, 6)."""
    return (("f_ext", (len(options["forces"]), 6)),) if options["forces"] else ()


def _under_forces(function: Callable[..., Any]) -> Callable[..., Callable[..., Any]]:
    """Recipe of an algorithm that takes external forces as its last argument."""

    def build(model: Model, forces: tuple[str, ...], reference: Any) -> Callable[..., Any]:
        frames = [model.frame(name) for name in forces]

        def run(q: Array, *arrays: Array) -> Array:
            if not frames:
                return function(model, q, *arrays, None)
            external = algorithms.at_joints(model, q, arrays[-1], frames, reference)
            return function(model, q, *arrays[:-1], external)

        return run

    return build


def _under_fixed_forces(function: Callable[..., Any]) -> Callable[..., Callable[..., Any]]:
    """The same for forces that are fixed in the frames they act at."""
    return lambda model, forces: _under_forces(function)(model, forces, "local")


def _inverse(model: Model, friction: bool | Friction, **options: Any) -> Callable[..., Any]:
    run, law = _under_forces(algorithms.inverse_dynamics)(model, **options), law_of(model, friction)
    if law is None:
        return run
    return lambda q, v, *rest: run(q, v, *rest) - algorithms.friction_torque(v, law)


def _forward(model: Model, friction: bool | Friction, **options: Any) -> Callable[..., Any]:
    run, law = _under_forces(algorithms.forward_dynamics)(model, **options), law_of(model, friction)
    if law is None:
        return run
    return lambda q, v, tau, *rest: run(q, v, tau + algorithms.friction_torque(v, law), *rest)


def law_of(model: Model, friction: bool | Friction) -> Friction | None:
    """The law of friction that was asked for, if any."""
    if isinstance(friction, Friction):
        return friction
    return Friction.of(model) if friction else None


RECIPES: dict[str, Recipe] = {
    "inverse_dynamics": Recipe(
        _inverse,
        QVA,
        {**FORCES, "friction": False},
        "Torques that give the acceleration a, (nv,).",
        wrenches,
    ),
    "forward_dynamics": Recipe(
        with_mass(_forward),
        QVTAU,
        {**FORCES, "friction": False},
        "Accelerations that torques give, (nv,).",
        wrenches,
    ),
    "bias_forces": Recipe(
        _under_forces(algorithms.bias_forces),
        QV,
        FORCES,
        "Torques that give no acceleration, (nv,).",
        wrenches,
    ),
    "gravity_forces": Recipe(
        on_model(algorithms.gravity_forces), Q, {}, "Torques that hold the robot against gravity, (nv,)."
    ),
    "static_torque": Recipe(
        _under_forces(algorithms.static_torque),
        Q,
        FORCES,
        "The same under external forces, (nv,).",
        wrenches,
    ),
    "inverse_dynamics_derivatives": Recipe(
        _under_fixed_forces(algorithms.inverse_dynamics_derivatives),
        QVA,
        {"forces": ()},
        "Derivatives of the torques by q, v and a, (nv, nv) each; the last is the mass matrix.",
        wrenches,
    ),
    "forward_dynamics_derivatives": Recipe(
        with_mass(_under_fixed_forces(algorithms.forward_dynamics_derivatives)),
        QVTAU,
        {"forces": ()},
        "Derivatives of the accelerations by q, v and tau, (nv, nv) each; the last is the inverse mass matrix.",
        wrenches,
    ),
    "mass_matrix": Recipe(on_model(algorithms.mass_matrix), Q, {}, "Mass matrix, (nv, nv)."),
    "inverse_mass_matrix": Recipe(
        with_mass(on_model(algorithms.inverse_mass_matrix)), Q, {}, "Its inverse, (nv, nv)."
    ),
    "coriolis_matrix": Recipe(
        on_model(algorithms.coriolis_matrix), QV, {}, "Coriolis matrix of the Christoffel symbols, (nv, nv)."
    ),
    "kinetic_energy": Recipe(on_model(algorithms.kinetic_energy), QV, {}, "Kinetic energy, () [J]."),
    "potential_energy": Recipe(on_model(algorithms.potential_energy), Q, {}, "Potential energy, () [J]."),
    "mechanical_energy": Recipe(on_model(algorithms.mechanical_energy), QV, {}, "Their sum, () [J]."),
    "center_of_mass": Recipe(
        on_model(algorithms.center_of_mass), Q, _SUBTREE, "Centre of mass in the world, (3,) [m]."
    ),
    "center_of_mass_velocity": Recipe(
        on_model(algorithms.center_of_mass_velocity), QV, _SUBTREE, "Its velocity, (3,) [m/s]."
    ),
    "center_of_mass_acceleration": Recipe(
        on_model(algorithms.center_of_mass_acceleration), QVA, _SUBTREE, "Its acceleration, (3,) [m/s^2]."
    ),
    "center_of_mass_jacobian": Recipe(
        on_model(algorithms.center_of_mass_jacobian), Q, _SUBTREE, "Its Jacobian, (3, nv)."
    ),
    "centroidal_momentum": Recipe(
        on_model(algorithms.centroidal_momentum),
        QV,
        {},
        "Momentum about the centre of mass, (6,) [N s, N m s].",
    ),
    "centroidal_momentum_rate": Recipe(
        on_model(algorithms.centroidal_momentum_rate), QVA, {}, "Its time derivative, (6,) [N, N m]."
    ),
    "centroidal_inertia": Recipe(
        on_model(algorithms.centroidal_inertia), Q, {}, "Rotational inertia about the centre of mass, (3, 3)."
    ),
    "centroidal_matrix": Recipe(
        on_model(algorithms.centroidal_matrix), Q, {}, "Matrix that makes it out of v, (6, nv)."
    ),
    "centroidal_matrix_dot": Recipe(
        on_model(algorithms.centroidal_matrix_dot), QV, {}, "Time derivative of that matrix, (6, nv)."
    ),
}
