"""The dynamics as felt at a robot's end, by position and angles.

Source: Khatib 1987, A unified approach for motion and force control of robot manipulators.
"""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from roboticstoolbox._dynamics.dynamics import vector3
from roboticstoolbox._links.ulna_model import model_of
from roboticstoolbox._mixins.robot_mixin import RobotMixin
from ulna.errors import InputError
from ulna.robot import Robot as Body
from ulna.spatial import SE3
from ulna.typing import Floats


class OperationalSpace(RobotMixin):
    """Operational space."""

    def _robot_and_end(self) -> tuple[Body, str]:
        """The robot of Ulna with the present masses, and the name of its end."""
        self._current_dynamic_arrays()
        base = np.eye(4) if self._base is None else self._base
        body = Body(model_of(self.name, self._links, self._grippers, self._gravity, base, moving=False))
        end, tool = self._default_end()
        if tool is None and self._tool is None:
            return body, end.name
        T = np.eye(4) if tool is None else tool
        body = body.with_tool(end.name, SE3.from_matrix(T if self._tool is None else T @ self._tool))
        return body, body.tool

    def _operational_quantity(self, name: str, arrays: tuple[Any, ...], representation: str | None) -> Floats:
        """What is felt at the end, by Ulna's operational space."""
        body, end = self._robot_and_end()
        try:
            value = getattr(body, name)(*arrays, frame=end, representation=representation)
        except ZeroDivisionError:
            raise InputError(
                f"The inertia matrix of {self.name!r} is singular: one of its joints moves no mass; set m or I "
                "of the links after it, or Jm of their motors."
            ) from None
        return self._finite(value, representation)

    def _finite(self, value: Floats, representation: str | None) -> Floats:
        if not np.isfinite(value).all():
            raise InputError(
                f"{self.name!r} is at a configuration where the angles {representation!r}, or the arm, are singular; "
                'take another `representation`, such as "exp", or another configuration.'
            )
        return value

    def inertia_x(
        self, q: Any = None, pinv: bool = False, representation: str = "rpy/xyz", Ji: Any = None
    ) -> Floats:
        """The inertia felt at the end, by position and angles, (6, 6)."""
        return self._operational_quantity(
            "operational_inertia", (self.q if q is None else q,), representation
        )

    def coriolis_x(
        self, q: Any, qd: Any, pinv: bool = False, representation: str = "rpy/xyz", **_: Any
    ) -> Floats:
        """Coriolis and centrifugal effects felt at the end, (6, 6)."""
        return self._operational_quantity("operational_coriolis", (q, qd), representation)

    def accel_x(
        self,
        q: Any,
        xd: Any,
        wrench: Any,
        gravity: Any = None,
        pinv: bool = False,
        representation: str = "rpy/xyz",
    ) -> Floats:
        """The acceleration of position and angles of the end, moving at `xd`, under a force there, (6,)."""
        J = self._finite(self.jacob0_analytical(q, representation), representation)
        v = np.linalg.pinv(J) @ np.asarray(xd, dtype=float)
        tau = J.T @ np.asarray(wrench, dtype=float) - self._friction_torques(v)
        gravity_before = self._gravity
        try:
            self._gravity = gravity_before if gravity is None else vector3(gravity)
            return self._operational_quantity("operational_acceleration", (q, v, tau), representation)
        finally:
            self._gravity = gravity_before

    def payload_capacity(self, q: Any, tau_m: Any, w: Any, frame: str = "base") -> Floats:
        """How many times the wrench `w` (6,) at the end the joint torques `tau_m` (n,) can carry.

        `frame` says in whose axes the wrench is written: "base" or "ee".
        """
        if frame not in ("base", "ee"):
            raise InputError(f"`frame` is {frame!r}; expected 'base' or 'ee'.")
        body, end = self._robot_and_end()
        where = "local_world_aligned" if frame == "base" else "local"
        return np.atleast_2d(body.payload_capacity(q, end, w, tau_m, where))

    def gravload_x(
        self,
        q: Any = None,
        gravity: Any = None,
        pinv: bool = False,
        representation: str = "rpy/xyz",
        Ji: Any = None,
    ) -> Floats:
        """The force at the end that holds the robot against gravity, (6,)."""
        gravity_before = self._gravity
        try:
            self._gravity = gravity_before if gravity is None else vector3(gravity)
            return self._operational_quantity(
                "operational_gravity", (self.q if q is None else q,), representation
            )
        finally:
            self._gravity = gravity_before

    def cinertia(self, q: Any) -> Floats:
        """A former name of `inertia_x`."""
        warnings.warn("cinertia is the former name of inertia_x", DeprecationWarning, stacklevel=2)
        return self.inertia_x(q)
