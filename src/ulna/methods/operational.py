"""The dynamics of a robot as one of its frames feels it."""

from __future__ import annotations

from typing import Any

from ulna.algorithms import Representation
from ulna.algorithms.multibody.references import Reference
from ulna.methods.base import Part
from ulna.typing import ArrayLike


class Operational(Part):
    """Inertia, Coriolis matrix, gravity and acceleration of a frame.

    The force that a motion x' of the frame takes is `inertia @ x'' + coriolis @ x' + gravity`. x' is the frame's twist
    in a `reference`, or, with a `representation` ("rpy/xyz", "rpy/zyx", "eul", "exp"), the rates of position and
    angles. Where the Jacobian is singular the inertia is infinite; `damping` bounds it (the square of it is added to
    its inverse). Reference: Khatib 1987.
    """

    __slots__ = ()

    def operational_inertia(
        self,
        q: ArrayLike,
        frame: str | None = None,
        reference: Reference = "local_world_aligned",
        representation: Representation | None = None,
        damping: float = 0.0,
    ) -> Any:
        """The inertia that a force at the frame feels, (..., 6, 6) [kg, kg m, kg m^2].

        Args:
            q: Configuration, (..., nq) [rad or m].
            frame: Name; None for the tool.
            reference: Of which twist of the frame.
            representation: Of which angles, instead of a twist.
            damping: What bounds the inertia where the frame cannot move in some direction.

        Raises:
            ShapeError, DtypeError, NonFiniteError: If `q` cannot be a configuration.
            UnknownName: If there is no such frame, reference or representation.
        """
        return self._of_task("operational_inertia", (q,), frame, reference, representation, damping)

    def operational_coriolis(
        self,
        q: ArrayLike,
        v: ArrayLike,
        frame: str | None = None,
        reference: Reference = "local_world_aligned",
        representation: Representation | None = None,
        damping: float = 0.0,
    ) -> Any:
        """The matrix that makes Coriolis and centrifugal forces at the frame out of its motion, (..., 6, 6)."""
        return self._of_task("operational_coriolis", (q, v), frame, reference, representation, damping)

    def operational_gravity(
        self,
        q: ArrayLike,
        frame: str | None = None,
        reference: Reference = "local_world_aligned",
        representation: Representation | None = None,
        damping: float = 0.0,
    ) -> Any:
        """The force at the frame that gravity takes, (..., 6) [N, N m]."""
        return self._of_task("operational_gravity", (q,), frame, reference, representation, damping)

    def operational_acceleration(
        self,
        q: ArrayLike,
        v: ArrayLike,
        tau: ArrayLike,
        frame: str | None = None,
        reference: Reference = "local_world_aligned",
        representation: Representation | None = None,
    ) -> Any:
        """How the frame accelerates under the joint torques `tau`, (..., 6) [m/s^2, rad/s^2]."""
        return self._of_task("operational_acceleration", (q, v, tau), frame, reference, representation)

    def _of_task(
        self,
        name: str,
        arrays: tuple[ArrayLike, ...],
        frame: str | None,
        reference: Reference,
        representation: Representation | None,
        damping: float = 0.0,
    ) -> Any:
        options = {"frame": frame, "reference": reference, "representation": representation}
        return self._checked(name, **options, damping=float(damping))(*arrays)
