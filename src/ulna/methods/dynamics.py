"""Torques, accelerations, inertia, energy, centre of mass and momentum of a robot."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ulna import algorithms
from ulna.algorithms import Friction
from ulna.algorithms.multibody.references import Reference
from ulna.checks.masked import check_not_masked
from ulna.errors import ShapeError
from ulna.methods.base import Part
from ulna.typing import Array, ArrayLike

Forces = Mapping[str, ArrayLike] | None
"""What the surroundings exert on the robot: frame name -> wrench (..., 6) [N, N m], force first, moment second."""


class Dynamics(Part):
    """How a robot moves under torques and forces, and what it weighs.

    External forces are a dictionary from frame names to wrenches, `forces={"panda_hand": [0, 0, -9.81, 0, 0, 0]}`:
    what the surroundings exert on the body of that frame. `reference` says how the wrenches are written:
    "local_world_aligned" (about the frame's origin along the world's axes; the default), "local" (about its origin
    along its own axes), or "world" (about the world's origin).

    Friction is left out unless asked for: `friction=True` takes the damping and Coulomb friction of the model, and an
    `ulna.algorithms.Friction` is any other law. The armature of the joints always counts.
    """

    __slots__ = ()

    def inverse_dynamics(
        self,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        forces: Forces = None,
        reference: Reference = "local_world_aligned",
        friction: bool | Friction = False,
    ) -> Any:
        """The joint torques that give the acceleration `a`, (..., nv) [N m or N].

        Args:
            q: Configuration, (..., nq) [rad or m].
            v: Velocity, (..., nv) [rad/s or m/s].
            a: Acceleration, (..., nv) [rad/s^2 or m/s^2].
            forces: External forces: frame name -> wrench (..., 6) [N, N m].
            reference: How the wrenches are written.
            friction: Whether the torques also overcome friction.

        Raises:
            ShapeError, DtypeError, NonFiniteError: If an argument cannot be what it stands for.
            UnknownName: If there is no such frame or reference.

        Reference: Luh, Walker & Paul 1980; Featherstone 2008, section 5.3.
        """
        if not forces and friction is False:
            return self._plain["inverse_dynamics"](q, v, a)
        return self._under("inverse_dynamics", (q, v, a), forces, reference, friction)

    def forward_dynamics(
        self,
        q: ArrayLike,
        v: ArrayLike,
        tau: ArrayLike,
        forces: Forces = None,
        reference: Reference = "local_world_aligned",
        friction: bool | Friction = False,
    ) -> Any:
        """The joint accelerations that the torques `tau` give, (..., nv) [rad/s^2 or m/s^2].

        Args:
            q: Configuration, (..., nq) [rad or m].
            v: Velocity, (..., nv) [rad/s or m/s].
            tau: Joint torques, (..., nv) [N m or N].
            forces: External forces: frame name -> wrench (..., 6) [N, N m].
            reference: How the wrenches are written.
            friction: Whether friction brakes the motion.

        Raises:
            ShapeError, DtypeError, NonFiniteError: If an argument cannot be what it stands for.
            UnknownName: If there is no such frame or reference.

        Reference: Featherstone 2008, sections 6.5 and 7.3; `ulna.algorithms.dynamics.forward_dynamics` chooses one.
        """
        if not forces and friction is False:
            return self._plain["forward_dynamics"](q, v, tau)
        return self._under("forward_dynamics", (q, v, tau), forces, reference, friction)

    def bias_forces(
        self,
        q: ArrayLike,
        v: ArrayLike,
        forces: Forces = None,
        reference: Reference = "local_world_aligned",
    ) -> Any:
        """The torques that give no acceleration, (..., nv): Coriolis, centrifugal and gravity, less external forces."""
        if not forces:
            return self._plain["bias_forces"](q, v)
        return self._under("bias_forces", (q, v), forces, reference)

    def gravity_forces(self, q: ArrayLike) -> Any:
        """The torques that hold the robot against gravity, (..., nv) [N m or N]."""
        return self._plain["gravity_forces"](q)

    def static_torque(
        self, q: ArrayLike, forces: Forces = None, reference: Reference = "local_world_aligned"
    ) -> Any:
        """The torques that hold the robot against gravity and external forces, (..., nv) [N m or N]."""
        return self._under("static_torque", (q,), forces, reference)

    def mass_matrix(self, q: ArrayLike) -> Any:
        """The joint-space mass matrix with armature, (..., nv, nv) [kg, kg m, kg m^2].

        Reference: Featherstone 2008, section 6.2.
        """
        return self._plain["mass_matrix"](q)

    def inverse_mass_matrix(self, q: ArrayLike) -> Any:
        """The inverse of the mass matrix, (..., nv, nv).

        Reference: Featherstone 2008, section 6.5.
        """
        return self._plain["inverse_mass_matrix"](q)

    def coriolis_matrix(self, q: ArrayLike, v: ArrayLike) -> Any:
        """The matrix C with `C @ v + gravity = bias` and `dM/dt - 2 C` skew, (..., nv, nv).

        Reference: Echeandia & Wensing 2021.
        """
        return self._plain["coriolis_matrix"](q, v)

    def kinetic_energy(self, q: ArrayLike, v: ArrayLike) -> Any:
        """Half of `v @ M @ v`, (...) [J]: armature counts."""
        return self._plain["kinetic_energy"](q, v)

    def potential_energy(self, q: ArrayLike) -> Any:
        """The energy of all that moves in the field of gravity, (...) [J]; zero at the world's origin."""
        return self._plain["potential_energy"](q)

    def mechanical_energy(self, q: ArrayLike, v: ArrayLike) -> Any:
        """The sum of kinetic and potential energy, (...) [J]."""
        return self._plain["mechanical_energy"](q, v)

    def total_mass(self, subtree: str | None = None) -> float:
        """The mass of all that moves, or of what the joint `subtree` moves [kg]; `model.mass` is that of all links."""
        return float(algorithms.total_mass(self.model, subtree))

    def center_of_mass(self, q: ArrayLike, subtree: str | None = None) -> Any:
        """Where the centre of mass of all that moves is in the world, (..., 3) [m].

        Args:
            q: Configuration, (..., nq) [rad or m].
            subtree: Name of a joint, for the centre of what it moves.

        Raises:
            UnknownName: If there is no such joint.
            InputError: If there is no mass.
        """
        if subtree is None:
            return self._plain["center_of_mass"](q)
        return self._checked("center_of_mass", subtree=subtree)(q)

    def center_of_mass_velocity(self, q: ArrayLike, v: ArrayLike, subtree: str | None = None) -> Any:
        """How fast the centre of mass moves in the world, (..., 3) [m/s]."""
        if subtree is None:
            return self._plain["center_of_mass_velocity"](q, v)
        return self._checked("center_of_mass_velocity", subtree=subtree)(q, v)

    def center_of_mass_acceleration(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike, subtree: str | None = None
    ) -> Any:
        """How the centre of mass accelerates in the world, (..., 3) [m/s^2]."""
        if subtree is None:
            return self._plain["center_of_mass_acceleration"](q, v, a)
        return self._checked("center_of_mass_acceleration", subtree=subtree)(q, v, a)

    def center_of_mass_jacobian(self, q: ArrayLike, subtree: str | None = None) -> Any:
        """The matrix that makes the velocity of the centre of mass out of `v`, (..., 3, nv)."""
        if subtree is None:
            return self._plain["center_of_mass_jacobian"](q)
        return self._checked("center_of_mass_jacobian", subtree=subtree)(q)

    def centroidal_momentum(self, q: ArrayLike, v: ArrayLike) -> Any:
        """The momentum about the centre of mass along the world's axes, (..., 6) [N s, N m s], linear part first.

        Reference: Orin, Goswami & Lee 2013.
        """
        return self._plain["centroidal_momentum"](q, v)

    def centroidal_momentum_rate(self, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> Any:
        """The time derivative of the centroidal momentum, (..., 6) [N, N m]."""
        return self._plain["centroidal_momentum_rate"](q, v, a)

    def centroidal_inertia(self, q: ArrayLike) -> Any:
        """The rotational inertia about the centre of mass, all joints held, (..., 3, 3) [kg m^2], in world axes."""
        return self._plain["centroidal_inertia"](q)

    def centroidal_matrix(self, q: ArrayLike) -> Any:
        """The matrix that makes the centroidal momentum out of `v`, (..., 6, nv)."""
        return self._plain["centroidal_matrix"](q)

    def centroidal_matrix_dot(self, q: ArrayLike, v: ArrayLike) -> Any:
        """The time derivative of the centroidal matrix along the velocity `v`, (..., 6, nv)."""
        return self._plain["centroidal_matrix_dot"](q, v)

    def _under(
        self,
        name: str,
        arrays: tuple[ArrayLike, ...],
        forces: Forces,
        reference: Reference,
        friction: bool | Friction = False,
    ) -> Any:
        options: dict[str, Any] = {}
        if friction is not False:
            options["friction"] = friction
        if not forces:
            return self._checked(name, **options)(*arrays)
        options |= {"forces": tuple(forces), "reference": reference}
        return self._checked(name, **options)(*arrays, stacked(forces))


def stacked(forces: Mapping[str, ArrayLike]) -> Array:
    """The wrenches side by side, (..., k, 6)."""
    for name, wrench in forces.items():
        check_not_masked(f"forces[{name!r}]", wrench)
    wrenches = [np.asarray(wrench) for wrench in forces.values()]
    for name, wrench in zip(forces, wrenches, strict=True):
        if wrench.shape[-1:] != (6,):
            raise ShapeError(
                f"forces[{name!r}]", wrench.shape, "(..., 6)", "Force first [N], then moment [N m]."
            )
    return np.stack(np.broadcast_arrays(*wrenches), axis=-2)
