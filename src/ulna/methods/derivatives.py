"""How torques, accelerations, momentum and twists of a robot change with its state."""

from __future__ import annotations

from ulna.methods.base import Part
from ulna.typing import ArrayLike, Floats


class Derivatives(Part):
    """Derivatives on the tangent space of a configuration."""

    __slots__ = ()

    def inverse_dynamics_derivatives(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike
    ) -> tuple[Floats, Floats, Floats]:
        """Derivatives of the torques of inverse dynamics by `q`, `v` and `a`, (..., nv, nv) each.

        That by `q` is along the tangent space (see `integrate`); that by `a` is the mass matrix.

        Args:
            q: Configuration, (..., nq) [rad or m].
            v: Velocity, (..., nv).
            a: Acceleration, (..., nv).

        Raises:
            ShapeError, DtypeError, NonFiniteError: If an argument cannot be what it stands for.

        Reference: Carpentier & Mansard 2018; Singh, Russell & Wensing 2022.
        """
        return self._checked("inverse_dynamics_derivatives")(q, v, a)

    def forward_dynamics_derivatives(
        self, q: ArrayLike, v: ArrayLike, tau: ArrayLike
    ) -> tuple[Floats, Floats, Floats]:
        """Derivatives of the accelerations of forward dynamics by `q`, `v` and `tau`, (..., nv, nv) each.

        That by `q` is along the tangent space (see `integrate`); that by `tau` is the inverse of the mass matrix.

        Args:
            q: Configuration, (..., nq) [rad or m].
            v: Velocity, (..., nv).
            tau: Joint torques, (..., nv) [N m or N].

        Raises:
            ShapeError, DtypeError, NonFiniteError: If an argument cannot be what it stands for.

        Reference: Carpentier & Mansard 2018, section V.
        """
        return self._checked("forward_dynamics_derivatives")(q, v, tau)

    def centroidal_derivatives(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike
    ) -> tuple[Floats, Floats, Floats, Floats]:
        """Derivatives of the centroidal momentum by `q`, and of its rate by `q`, `v` and `a`, (..., 6, nv) each.

        About the centre of mass of the moving bodies, along the axes of the world, linear part first. The last is also
        the centroidal momentum matrix.
        """
        return self._checked("centroidal_derivatives")(q, v, a)

    def com_velocity_derivatives(self, q: ArrayLike, v: ArrayLike) -> tuple[Floats, Floats]:
        """Derivatives of the velocity of the centre of mass by `q` and `v`, (..., 3, nv) each, in world axes."""
        return self._checked("com_velocity_derivatives")(q, v)

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
