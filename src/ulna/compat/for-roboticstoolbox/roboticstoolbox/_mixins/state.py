"""The state of a robot: configuration, velocity, acceleration, control mode and named configurations."""

from __future__ import annotations

from typing import Any

import numpy as np

from roboticstoolbox._common.errors import UnknownOption, WrongShape
from roboticstoolbox._common.numbers import greatest, numbers, vector
from roboticstoolbox._common.poses import array
from roboticstoolbox._mixins.robot_mixin import RobotMixin
from ulna.errors import InputError
from ulna.typing import Floats


class State(RobotMixin):
    """State and named configurations."""

    _configs: dict[str, Floats]
    _qdlim: Any = None

    @property
    def q(self) -> Floats:  # type: ignore[override]
        """The configuration, (n,)."""
        return self._q

    @q.setter
    def q(self, q: Any) -> None:
        self._q = vector("q", q, self.n)

    @property
    def qd(self) -> Floats:
        """The velocity, (n,)."""
        return self._qd

    @qd.setter
    def qd(self, qd: Any) -> None:
        self._qd = vector("qd", qd, self.n)

    @property
    def qdd(self) -> Floats:
        """The acceleration, (n,)."""
        return self._qdd

    @qdd.setter
    def qdd(self, qdd: Any) -> None:
        self._qdd = vector("qdd", qdd, self.n)

    @property
    def control_mode(self) -> str:
        """What simulators integrate: "p", "v" or "a"."""
        return self._control_mode

    @control_mode.setter
    def control_mode(self, mode: str) -> None:
        if mode not in ("p", "v", "a"):
            raise InputError(f"`control_mode` is {mode!r}; expected 'p', 'v' or 'a'.")
        self._control_mode = mode

    @property
    def qdlim(self) -> Any:
        """Greatest speeds: those that were set, or (n,) of the joints; None where a joint has none."""
        if self._qdlim is not None:
            return self._qdlim
        speeds = [link.qdlim for link in self._joints()]
        return None if None in speeds else np.array(speeds, dtype=float)

    @qdlim.setter
    def qdlim(self, speeds: Any) -> None:
        self._qdlim = greatest("qdlim", speeds)

    @property
    def configs(self) -> dict[str, Floats]:
        """Named configurations."""
        return self._configs

    def addconfiguration(self, name: str, q: Any) -> None:
        """Stores a named configuration in `configs`.

        Args:
            name: Its name.
            q: The configuration (n,) [rad or m].
        """
        self._configs[name] = vector(name, q, self.n)

    def addconfiguration_attr(self, name: str, q: Any, unit: str = "rad") -> None:
        """Stores a named configuration in `configs` and as an attribute.

        Args:
            name: Its name.
            q: The configuration (n,).
            unit: Of angles in `q`, "rad" or "deg".

        Raises:
            UnknownOption: Another unit.
            InputError: The robot has another attribute of that name, such as a method.
        """
        if unit not in ("rad", "deg"):
            raise UnknownOption("unit", unit, ("rad", "deg"))
        present = getattr(self, name, None)
        if callable(present) or isinstance(present, (str, int)):
            raise InputError(f"The robot has another attribute {name!r}; expected a name that is free.")
        values = vector(name, q, self.n)
        self._configs[name] = self.toradians(values) if unit == "deg" else values
        setattr(self, name, self._configs[name])

    def todegrees(self, q: Any) -> Floats:
        """Angles in degrees, lengths as they are."""
        return self._converted(q, np.degrees)

    def toradians(self, q: Any) -> Floats:
        """Angles in radians, lengths as they are."""
        return self._converted(q, np.radians)

    def _converted(self, q: Any, convert: Any) -> Floats:
        values = numbers("q", q)
        if values.shape[-1:] != (self.n,):
            raise WrongShape("q", values.shape, f"(..., {self.n})")
        return np.where(self.revolutejoints, convert(values), values)

    def jtraj(self, q0: Any, qf: Any, t: Any, qd0: Any = None, qd1: Any = None) -> Any:
        """A joint trajectory between two configurations, or between those of two poses; see `roboticstoolbox.jtraj`.

        Args:
            q0: Start, (n,); or a pose of the end effector, for which inverse kinematics is solved.
            qf: End, likewise.
            t: How many, or times.
            qd0: Velocity at the start.
            qd1: Velocity at the end.

        Returns:
            The trajectory.

        Raises:
            InputError: No configuration is found for a pose.
        """
        from roboticstoolbox.tools.trajectory import jtraj

        return jtraj(self._configuration("q0", q0), self._configuration("qf", qf), t, qd0, qd1)

    def _configuration(self, name: str, value: Any) -> Any:
        """A configuration, or that of a pose."""
        if np.shape(array(value)) != (4, 4):
            return value
        solution = self.ikine_LM(value)
        if not solution.success:
            raise InputError(f"`{name}` is a pose for which no configuration is found: {solution.reason}.")
        return solution.q
