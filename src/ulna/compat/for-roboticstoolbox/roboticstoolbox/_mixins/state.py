"""The state of a robot: configuration, velocity, acceleration, control mode and named configurations."""

from __future__ import annotations

from typing import Any

import numpy as np

from roboticstoolbox._common.errors import UnknownOption, WrongShape
from roboticstoolbox._common.numbers import numbers
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
        self._q = self._state("q", q)

    @property
    def qd(self) -> Floats:
        """The velocity, (n,)."""
        return self._qd

    @qd.setter
    def qd(self, qd: Any) -> None:
        self._qd = self._state("qd", qd)

    @property
    def qdd(self) -> Floats:
        """The acceleration, (n,)."""
        return self._qdd

    @qdd.setter
    def qdd(self, qdd: Any) -> None:
        self._qdd = self._state("qdd", qdd)

    def _state(self, name: str, value: Any) -> Floats:
        out = np.array(numbers(name, value))
        if out.shape != (self.n,):
            out = out.ravel()
            if out.shape != (self.n,):
                raise WrongShape(name, np.shape(value), f"({self.n},)")
        return out

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
        self._qdlim = speeds

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
        self._configs[name] = self._state(name, q)

    def addconfiguration_attr(self, name: str, q: Any, unit: str = "rad") -> None:
        """Stores a named configuration in `configs` and as an attribute.

        Args:
            name: Its name.
            q: The configuration (n,).
            unit: Of angles in `q`, "rad" or "deg".

        Raises:
            UnknownOption: Another unit.
        """
        if unit not in ("rad", "deg"):
            raise UnknownOption("unit", unit, ("rad", "deg"))
        values = self._state(name, q)
        self._configs[name] = self.toradians(values) if unit == "deg" else values
        setattr(self, name, self._configs[name])

    def todegrees(self, q: Any) -> Floats:
        """Angles in degrees, lengths as they are."""
        return np.where(self.revolutejoints, np.degrees(np.asarray(q, dtype=float)), q)

    def toradians(self, q: Any) -> Floats:
        """Angles in radians, lengths as they are."""
        return np.where(self.revolutejoints, np.radians(np.asarray(q, dtype=float)), q)

    def jtraj(self, q0: Any, qf: Any, t: Any, qd0: Any = None, qd1: Any = None) -> Any:
        """A joint trajectory between two configurations, or between those of two poses; see `roboticstoolbox.jtraj`.

        Args:
            q0: Start, (n,); or a pose of the end, solved by inverse kinematics.
            qf: End, likewise.
            t: How many, or times.
            qd0: Velocity at the start.
            qd1: Velocity at the end.

        Returns:
            The trajectory.
        """
        from roboticstoolbox.tools.trajectory import jtraj

        ends = [self.ikine_LM(T).q if np.shape(array(T)) == (4, 4) else T for T in (q0, qf)]
        return jtraj(ends[0], ends[1], t, qd0, qd1)
