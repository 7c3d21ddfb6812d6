"""The dynamics of a robot's end, by position and angles.

Source: Khatib 1987, A unified approach for motion and force control of robot manipulators.
"""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from roboticstoolbox._common.numbers import numbers
from roboticstoolbox._mixins.robot_mixin import RobotMixin
from ulna.errors import InputError, ShapeError
from ulna.typing import Floats

_SIX = 6
_SINGULAR = 1e12  # condition of a Jacobian beyond which its inverse is rounding errors
_NO_LOAD = 1e-10  # [N m] below which a wrench does not burden a joint


class OperationalSpace(RobotMixin):
    """Operational space."""

    def _check_angles(self, J: Floats, representation: str | None) -> None:
        """Refuses configurations where the Jacobian of the angles is singular but for rounding.

        Raises:
            InputError: It is.
        """
        if J.shape[-1] < _SIX:
            return
        scale = np.linalg.norm(J, axis=(-2, -1))
        if not np.isfinite(scale).all() or (np.linalg.cond(J) > _SINGULAR).any():
            raise self._singular(representation)

    def _finite(self, value: Floats, representation: str | None) -> Floats:
        if not np.isfinite(value).all():
            raise self._singular(representation)
        return value

    def _singular(self, representation: str | None) -> InputError:
        return InputError(
            f"{self.name!r} is at a configuration where the angles {representation!r}, or the arm, are singular; "
            'take another `representation`, such as "exp", or another configuration.'
        )

    def inertia_x(
        self, q: Any = None, pinv: bool = False, representation: str = "rpy/xyz", Ji: Any = None
    ) -> Floats:
        """The inertia at the end, by position and angles, (6, 6), or (m, 6, 6).

        Args:
            q: Configuration, (n,) or (m, n) [rad or m].
            pinv: Whether to take the pseudoinverse of the Jacobian, which is done in any case unless n is 6.
            representation: Of which angles.
            Ji: The inverse of the analytical Jacobian, (n, 6); None for that at `q`.

        Returns:
            Inertia (6, 6) or (m, 6, 6).
        """
        at = _rows("q", q)
        inverse = self._inverse_jacobian(at, representation, Ji, pinv=pinv)
        return _turned(inverse) @ self.inertia(at) @ inverse

    def coriolis_x(
        self,
        q: Any,
        qd: Any,
        pinv: bool = False,
        representation: str = "rpy/xyz",
        J: Any = None,
        Ji: Any = None,
        Jd: Any = None,
        C: Any = None,
        Mx: Any = None,
    ) -> Floats:
        """Coriolis and centrifugal effects at the end, (6, 6), or (m, 6, 6).

        Args:
            q: Configuration, (n,) or (m, n) [rad or m].
            qd: Velocity, likewise.
            pinv: Whether to take the pseudoinverse of the Jacobian, which is done in any case unless n is 6.
            representation: Of which angles.
            J: The analytical Jacobian, (6, n); None for that at `q`.
            Ji: Its inverse, (n, 6); None for that of `J`.
            Jd: Its derivative by time, (6, n); None for that at `q` and `qd`.
            C: Coriolis matrix, (n, n); None for that at `q` and `qd`.
            Mx: `inertia_x`, (6, 6); None for that at `q`.

        Returns:
            Matrix (6, 6) or (m, 6, 6).

        Raises:
            ShapeError: `q` and `qd` have different shapes.
        """
        at, rate = _rows("q", q), _rows("qd", qd)
        if at.shape != rate.shape:
            raise ShapeError("qd", rate.shape, f"{at.shape}, as q")
        inverse = self._inverse_jacobian(at, representation, Ji, J, pinv)
        C = self.coriolis(at, rate) if C is None else np.asarray(C, dtype=float)
        Mx = self.inertia_x(at, Ji=inverse) if Mx is None else np.asarray(Mx, dtype=float)
        Jd = self._jacobian_rate(at, rate, representation) if Jd is None else np.asarray(Jd, dtype=float)
        return _turned(inverse) @ C @ inverse - Mx @ Jd @ inverse

    def _analytical_jacobian(self, q: Any, representation: str) -> Floats:
        """The analytical Jacobian with a column for each joint of the robot, (..., 6, n)."""
        J = np.asarray(self.jacob0_analytical(q, representation), dtype=float)
        self._check_angles(J, representation)
        return self._with_all_joints(J)

    def _with_all_joints(self, J: Floats) -> Floats:
        """A matrix with columns of zeros for joints of the robot that do not move its end."""
        if J.shape[-1] == self.n:
            return J
        out = np.zeros((*J.shape[:-1], self.n))
        out[..., self._chain(None, None).jindices] = J
        return out

    def _inverse_jacobian(
        self, q: Floats, representation: str, Ji: Any = None, J: Any = None, pinv: bool = False
    ) -> Floats:
        """The inverse of the analytical Jacobian, (..., n, 6), or what is given instead of it."""
        if Ji is not None:
            return np.asarray(Ji, dtype=float)
        J = self._analytical_jacobian(q, representation) if J is None else J
        matrix = np.asarray(self._finite(np.asarray(J, dtype=float), representation))
        square = self.n == _SIX and self._chain(None, None).n == _SIX
        inverse = np.linalg.inv(matrix) if square and not pinv else np.linalg.pinv(matrix)
        return np.asarray(inverse, dtype=float)

    def _jacobian_rate(self, q: Floats, qd: Floats, representation: str) -> Floats:
        """The derivative of the analytical Jacobian by time, (..., 6, n)."""
        rows = [
            self.jacob0_dot(a, v, representation=representation)
            for a, v in zip(np.atleast_2d(q), np.atleast_2d(qd), strict=True)
        ]
        return self._with_all_joints(np.array(rows).reshape(*q.shape[:-1], 6, -1))

    def accel_x(
        self,
        q: Any,
        xd: Any,
        wrench: Any,
        gravity: Any = None,
        pinv: bool = False,
        representation: str = "rpy/xyz",
    ) -> Floats:
        """The acceleration of position and angles of the end, moving at `xd`, under a force there, (6,), or (m, 6).

        Args:
            q: Configuration, (n,) or (m, n) [rad or m].
            xd: Rates of position and angles, (6,) or (m, 6).
            wrench: The force, (6,) or (m, 6) [N, N m].
            gravity: Acceleration of free fall, (3,) [m/s^2]; None for the robot's.
            pinv: Whether to take the pseudoinverse of the Jacobian, which is done in any case unless n is 6.
            representation: Of which angles.

        Returns:
            Acceleration (6,) or (m, 6).
        """
        at = _rows("q", q)
        J = self._finite(self._analytical_jacobian(at, representation), representation)
        inverse = self._inverse_jacobian(at, representation, None, J, pinv)
        v = np.squeeze(inverse @ _six("xd", xd)[..., None], -1)
        tau = np.squeeze(_turned(J) @ _six("wrench", wrench)[..., None], -1)
        acceleration = self.accel(at, v, tau, gravity)
        Jd = self._jacobian_rate(at, v, representation)
        return np.squeeze(J @ acceleration[..., None] + Jd @ v[..., None], -1)

    def payload_capacity(self, q: Any, tau_m: Any, w: Any, frame: str = "base") -> Floats:
        """How many times the wrench `w` at the end each joint can carry, (m, n).

        Args:
            q: Configuration, (n,) or (m, n) [rad or m].
            tau_m: Greatest torques in both directions, (n,); or least and greatest torques, (2, n) [N m or N].
            w: Wrench, (6,) [N, N m].
            frame: In whose axes it is written, "base" or "ee".

        Returns:
            Multiples of the wrench (m, n); inf where it does not burden a joint, nan where a joint cannot even
            hold the robot.

        Raises:
            InputError: Another `frame`.
            ShapeError: `tau_m` or `w` has another shape.
        """
        if frame not in ("base", "ee"):
            raise InputError(f"`frame` is {frame!r}; expected 'base' or 'ee'.")
        limits, wrench = np.atleast_2d(numbers("tau_m", tau_m)), numbers("w", w)
        if limits.shape not in ((1, self.n), (2, self.n)):
            raise ShapeError(
                "tau_m", np.shape(tau_m), f"({self.n},), or least and greatest torques (2, {self.n})"
            )
        if wrench.shape != (6,):
            raise ShapeError("w", wrench.shape, "(6,)")
        low, high = (-limits[0], limits[0]) if len(limits) == 1 else limits
        at = np.atleast_2d(numbers("q", q))
        hold = self.gravload(at).reshape(at.shape)
        J = np.asarray(self.jacob0(at) if frame == "base" else self.jacobe(at)).reshape(-1, 6, self.n)
        load = -np.squeeze(_turned(J) @ wrench[:, None], -1)
        margin = np.where(load > 0.0, high, low) - hold
        out = np.full(load.shape, np.inf)
        np.divide(margin, load, out=out, where=np.abs(load) > _NO_LOAD)
        out[(hold > high) | (hold < low)] = np.nan
        return out

    def gravload_x(
        self,
        q: Any = None,
        gravity: Any = None,
        pinv: bool = False,
        representation: str = "rpy/xyz",
        Ji: Any = None,
    ) -> Floats:
        """The force at the end that holds the robot against gravity, (6,), or (m, 6).

        Args:
            q: Configuration, (n,) or (m, n) [rad or m].
            gravity: Acceleration of free fall, (3,) [m/s^2]; None for the robot's.
            pinv: Whether to take the pseudoinverse of the Jacobian, which is done in any case unless n is 6.
            representation: Of which angles.
            Ji: The inverse of the analytical Jacobian, (n, 6); None for that at `q`.

        Returns:
            Force (6,) or (m, 6) [N, N m].
        """
        at = _rows("q", q)
        inverse = self._inverse_jacobian(at, representation, Ji, pinv=pinv)
        return np.squeeze(_turned(inverse) @ self.gravload(at, gravity)[..., None], -1)

    def cinertia(self, q: Any) -> Floats:
        """A former name of `inertia_x`."""
        warnings.warn("cinertia is the former name of inertia_x", DeprecationWarning, stacklevel=2)
        return self.inertia_x(q)


def _rows(name: str, value: Any) -> Floats:
    """Configurations or velocities, (n,) or (m, n); a single row is the vector."""
    out = numbers(name, value)
    return out[0] if out.ndim == 2 and len(out) == 1 else out


def _six(name: str, value: Any) -> Floats:
    """The numbers of rates or of a wrench, (..., 6), checked."""
    out = numbers(name, value)
    if out.shape[-1:] != (6,):
        raise ShapeError(name, out.shape, "(6,) or (m, 6)")
    return out


def _turned(J: Floats) -> Floats:
    return np.swapaxes(J, -1, -2)
