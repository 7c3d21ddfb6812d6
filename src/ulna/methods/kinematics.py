"""Where the frames of a robot are, and how they move with its joints."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

from ulna import algorithms
from ulna.algorithms.multibody.references import Reference
from ulna.methods.base import Part, key_of
from ulna.typing import ArrayLike

FrameName = str | Sequence[str] | None


class Kinematics(Part):
    """Poses, Jacobians, velocities and accelerations of frames, and how far they are from singular."""

    __slots__ = ()

    _fk: dict[Any, Any]
    _jacobian: dict[Any, Any]

    def fk(
        self, q: ArrayLike, frame: FrameName = None, *, out: Any = None, threads: int | None = None
    ) -> Any:
        """Forward kinematics: the pose of a frame in the world.

        Args:
            q: Configuration, (..., nq) [rad or m].
            frame: Name; None for the tool, a list of names for several, "all" for every frame, in the order of
                `frame_names`.
            out: Array to write into.
            threads: How many threads a large batch may use.

        Returns:
            T_world_frame, (..., 4, 4), which maps coordinates of the frame to the world; (..., k, 4, 4) for several.

        Raises:
            ShapeError, DtypeError, NonFiniteError: If `q` cannot be a configuration.
            UnknownName: If there is no such frame.

        Reference: Featherstone 2008, section 4.1.
        """
        try:
            kernel = self._fk[frame]
        except (KeyError, TypeError):
            kernel = self._fk[key_of(frame)] = self._checked("fk", frame=frame)
        if out is None and threads is None:
            return kernel(q)
        return kernel(q, out=out, threads=threads)

    def link_poses(self, q: ArrayLike) -> Any:
        """Poses of all links in the world, T_world_link, (..., nlinks, 4, 4), in the order of `link_names`."""
        return self._plain["link_poses"](q)

    def jacobian(
        self,
        q: ArrayLike,
        frame: str | None = None,
        reference: Reference = "local_world_aligned",
        *,
        out: Any = None,
        threads: int | None = None,
    ) -> Any:
        """The Jacobian of a frame, (..., 6, nv): maps joint velocities to the frame's twist, linear part first.

        Raises:
            ShapeError, DtypeError, NonFiniteError: If `q` cannot be a configuration.
            UnknownName: If there is no such frame or reference.

        Reference: Featherstone 2008, section 4.1; Siciliano et al. 2009, section 3.1.
        """
        try:
            kernel = self._jacobian[reference][frame]
        except (KeyError, TypeError):
            kernel = self._checked("jacobian", frame=frame, reference=reference)
            self._jacobian.setdefault(reference, {})[frame] = kernel
        if out is None and threads is None:
            return kernel(q)
        return kernel(q, out=out, threads=threads)

    def jacobian_dot(
        self,
        q: ArrayLike,
        v: ArrayLike,
        frame: str | None = None,
        reference: Reference = "local_world_aligned",
    ) -> Any:
        """Time derivative of the Jacobian along the velocity `v`, (..., 6, nv)."""
        return self._checked("jacobian_dot", frame=frame, reference=reference)(q, v)

    def hessian(
        self, q: ArrayLike, frame: str | None = None, reference: Reference = "local_world_aligned"
    ) -> Any:
        """Kinematic Hessian, (..., nv, 6, nv): entry [k, :, j] is the derivative of Jacobian column j by joint k."""
        return self._checked("hessian", frame=frame, reference=reference)(q)

    def frame_velocity(
        self,
        q: ArrayLike,
        v: ArrayLike,
        frame: str | None = None,
        reference: Reference = "local_world_aligned",
    ) -> Any:
        """Twist of a frame, (..., 6) [m/s, rad/s]."""
        return self._checked("frame_velocity", frame=frame, reference=reference)(q, v)

    def frame_acceleration(
        self,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        frame: str | None = None,
        reference: Reference = "local_world_aligned",
        classical: bool = False,
    ) -> Any:
        """Acceleration of a frame, (..., 6) [m/s^2, rad/s^2]: the spatial one, or the classical one of its origin."""
        options = {"frame": frame, "reference": reference, "classical": classical}
        return self._checked("frame_acceleration", **options)(q, v, a)

    def analytical_jacobian(
        self, q: ArrayLike, representation: str = "rpy/xyz", frame: str | None = None
    ) -> Any:
        """Jacobian whose lower rows give rates of angles, (..., 6, nv).

        `representation` is "rpy/xyz", "rpy/zyx", "eul" or "exp".
        """
        return self._checked("analytical_jacobian", frame=frame, representation=representation)(q)

    def manipulability(
        self,
        q: ArrayLike,
        measure: Literal["yoshikawa", "inverse_condition", "minimum_singular_value", "asada"] = "yoshikawa",
        axes: Any = "all",
        frame: str | None = None,
    ) -> Any:
        """How far the Jacobian is from losing rank, (...): see `ulna.algorithms.kinematics.manipulability`.

        `axes` is "all", "trans", "rot", or six truth values. Yoshikawa's measure is a compiled kernel; the others take
        singular values of the compiled Jacobian, or, for "asada", eigenvalues of the inertia felt at the frame.
        """
        if measure == "yoshikawa":
            return self._checked("manipulability", frame=frame, axes=axes)(q)
        if measure == "asada":
            return algorithms.asada(self.jacobian(q, frame), self._plain["mass_matrix"](q), axes)
        return algorithms.measure_of(self.jacobian(q, frame), measure, axes)

    def manipulability_gradient(self, q: ArrayLike, axes: Any = "all", frame: str | None = None) -> Any:
        """Gradient of Yoshikawa's manipulability by the configuration, (..., nv)."""
        return self._checked("manipulability_gradient", frame=frame, axes=axes)(q)
