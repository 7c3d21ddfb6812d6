"""Kinetic, potential and mechanical energy.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| u, w | velocity of the origin of a body's frame, angular velocity, in that frame | (3) | [m/s], [rad/s] | |
| m, c, I | mass, first and second moment about the frame's origin | MassMoments | | see mass_moments.py |
| J_a | armature: inertia of the drives | (nv) | [kg], [kg m^2] | |
| T | kinetic energy | () | [J] | sum of m u.u / 2 + u.(w x c) + w.I w / 2, plus v.J_a v / 2 |
| U | potential energy, zero at the world's origin | () | [J] | -g . (first moment of all that moves) |
| E | mechanical energy | () | [J] | T + U |

Source: Featherstone 2008, eq. 2.63; Siciliano 2009, section 7.1. T is v.M v / 2 with the mass matrix of crba.py, which
holds the armature; so E is constant along a motion without friction and torques. The inertias are regrouped.
"""

from __future__ import annotations

from typing import Any

from ulna.algorithms.dynamics.center_of_mass import first_moment
from ulna.algorithms.multibody.batch_shapes import batch_zeros
from ulna.algorithms.multibody.body_motions import body_velocities
from ulna.algorithms.multibody.prepared_model import prepare
from ulna.model import Model
from ulna.numeric import apply, cross, dot
from ulna.typing import Array


def kinetic_energy(model: Model, q: Array, v: Array) -> Any:
    """The kinetic energy, that of the drives (armature) included.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].

    Returns:
        T, shape (...) [J].
    """
    prepared = prepare(model)
    T = 0.5 * dot(v * model.armature, v) + batch_zeros((), q, v)[()]
    for body, V in zip(prepared.regrouped_moments, body_velocities(prepared.tree, q, v), strict=True):
        u, w = V.linear, V.angular
        T = T + dot(w, 0.5 * apply(body.second, w) + cross(body.first, u)) + 0.5 * (body.mass * dot(u, u))
    return T


def potential_energy(model: Model, q: Array) -> Any:
    """The potential energy of all that moves, zero at the world's origin.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].

    Returns:
        U, shape (...) [J].
    """
    return -dot(first_moment(model, q).position, model.gravity) + batch_zeros((), q)[()]


def mechanical_energy(model: Model, q: Array, v: Array) -> Any:
    """The sum of kinetic and potential energy.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].

    Returns:
        E, shape (...) [J].
    """
    return kinetic_energy(model, q, v) + potential_energy(model, q)
