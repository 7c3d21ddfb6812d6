"""How torques, accelerations, momentum and twists of a robot change with its state."""

from __future__ import annotations

from typing import Any

from ulna.algorithms.multibody.references import Reference
from ulna.errors import InputError
from ulna.methods.base import Part
from ulna.methods.dynamics import Forces, stacked
from ulna.typing import ArrayLike, Floats


class Derivatives(Part):
    """Derivatives on the tangent space of a configuration."""

    __slots__ = ()

    def inverse_dynamics_derivatives(
        self,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        forces: Forces = None,
        reference: Reference | None = None,
    ) -> tuple[Floats, Floats, Floats]:
        """Derivatives of the torques of inverse dynamics by `q`, `v` and `a`, (..., nv, nv) each.

        That by `q` is along the tangent space (see `integrate`); that by `a` is the mass matrix.

        Args:
            q: Configuration, (..., nq) [rad or m].
            v: Velocity, (..., nv).
            a: Acceleration, (..., nv).
            forces: External forces that turn with the frames they act at: frame name -> wrench (..., 6) [N, N m] in
                the axes of the frame.
            reference: "local" where there are forces, to say so: with the default of `inverse_dynamics` they would be
                other forces.

        Raises:
            InputError: If forces come without reference="local".
            ShapeError, DtypeError, NonFiniteError: If an argument cannot be what it stands for.
            UnknownName: If there is no such frame.

        Reference: Carpentier & Mansard 2018; Singh, Russell & Wensing 2022.
        """
        return self._under_fixed("inverse_dynamics_derivatives", (q, v, a), forces, reference)

    def forward_dynamics_derivatives(
        self,
        q: ArrayLike,
        v: ArrayLike,
        tau: ArrayLike,
        forces: Forces = None,
        reference: Reference | None = None,
    ) -> tuple[Floats, Floats, Floats]:
        """Derivatives of the accelerations of forward dynamics by `q`, `v` and `tau`, (..., nv, nv) each.

        That by `q` is along the tangent space (see `integrate`); that by `tau` is the inverse of the mass matrix.

        Args:
            q: Configuration, (..., nq) [rad or m].
            v: Velocity, (..., nv).
            tau: Joint torques, (..., nv) [N m or N].
            forces: As for `inverse_dynamics_derivatives`.
            reference: Likewise.

        Raises:
            ShapeError, DtypeError, NonFiniteError: If an argument cannot be what it stands for.

        Reference: Carpentier & Mansard 2018, section V.
        """
        return self._under_fixed("forward_dynamics_derivatives", (q, v, tau), forces, reference)

    def centroidal_derivatives(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike
    ) -> tuple[Floats, Floats, Floats, Floats]:
        """Derivatives of the centroidal momentum by `q`, and of its rate by `q`, `v` and `a`, (..., 6, nv) each.

        About the centre of mass of the moving bodies, along the axes of the world, linear part first. The last is also
        the centroidal momentum matrix.
        """
        return self._plain["centroidal_derivatives"](q, v, a)

    def com_velocity_derivatives(self, q: ArrayLike, v: ArrayLike) -> tuple[Floats, Floats]:
        """Derivatives of the velocity of the centre of mass by `q` and `v`, (..., 3, nv) each, in world axes."""
        return self._plain["com_velocity_derivatives"](q, v)

    def frame_velocity_derivatives(
        self, q: ArrayLike, v: ArrayLike, frame: str | None = None
    ) -> tuple[Floats, Floats]:
        """Derivatives of the twist of a frame, in "local", by `q` and `v`, (..., 6, nv) each."""
        return self._checked("frame_velocity_derivatives", frame=frame)(q, v)

    def frame_acceleration_derivatives(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike, frame: str | None = None
    ) -> tuple[Floats, Floats, Floats]:
        """Derivatives of the spatial acceleration of a frame, in "local", by `q`, `v` and `a`, (..., 6, nv) each."""
        return self._checked("frame_acceleration_derivatives", frame=frame)(q, v, a)

    def _under_fixed(
        self, name: str, arrays: tuple[ArrayLike, ...], forces: Forces, reference: Reference | None
    ) -> Any:
        if not forces:
            return self._plain[name](*arrays)
        if reference != "local":
            raise InputError(
                f"`reference` is {reference!r}; expected 'local' where there are forces: derivatives are those under "
                "wrenches in the axes of their frames, which turn with them. Give the dynamics reference='local', too."
            )
        return self._checked(name, forces=tuple(forces))(*arrays, stacked(forces))
