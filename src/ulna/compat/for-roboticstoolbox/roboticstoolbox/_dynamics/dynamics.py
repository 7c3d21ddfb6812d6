"""The dynamics of a robot: kernels take inertias, motors and gravity as arguments, so that links may change.

| symbol | meaning | unit |
|---|---|---|
| Jm, B, Tc, G | inertia, viscous and Coulomb friction of a motor, gear ratio | [kg m^2], [N m s/rad], [N m] |
| tau | torques, friction overcome: M qdd + C qd + g + B G^2 qd + abs(G) Tc sign(qd) | [N m] |

Source: Corke, Robotics, Vision and Control (2023), chapter 9.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np

from roboticstoolbox._common.errors import SingularInertia, WrongShape, WrongType
from roboticstoolbox._common.numbers import numbers
from roboticstoolbox._common.symbols import has_symbols
from roboticstoolbox._dynamics.symbolic_torques import symbolic_torques
from roboticstoolbox._links.link import Link
from roboticstoolbox._links.ulna_model import model_of
from ulna.checks.arrays import check_finite
from ulna.compiler import compile
from ulna.errors import InputError, ShapeError
from ulna.model import parameters
from ulna.numeric import less, where
from ulna.robot import Robot as Body
from ulna.typing import Array, Floats

_KERNEL_PARAMETERS = {
    "inverse_dynamics": ("inertia", "armature", "gravity"),
    "forward_dynamics": ("inertia", "armature", "gravity"),
    "gravity_forces": ("inertia", "gravity"),
    "mass_matrix": ("inertia", "armature"),
    "coriolis_matrix": ("inertia",),
}
_DIMENSIONS = {"mass_matrix": 2, "coriolis_matrix": 2}  # of results for one configuration; 1 where not listed


@cache
def _friction(n: int) -> Any:
    """Torques that overcome friction, (..., n): of speeds, B G^2, and Coulomb friction both ways."""

    def torque(v: Array, viscous: Array, forward: Array, backward: Array) -> Array:
        dry = where(less(0.0, v), forward, where(less(v, 0.0), backward, 0.0))
        return viscous * v + dry

    return compile(torque, v=(n,), viscous=(n,), forward=(n,), backward=(n,))


class Dynamics:
    """Torques, inertia and motion."""

    _dynamic_arrays: dict[str, Floats] | None
    _kernels: dict[str, Any]
    _links: list[Link]
    _grippers: list[Any]
    _base: Floats | None
    _tool: Floats | None
    _gravity: Floats
    name: str
    n: int
    q: Floats
    symbolic: bool

    def dynchanged(self, what: str | None = None) -> None:
        """Discards the arrays of masses and motors; called when a link changes."""
        self._dynamic_arrays = None

    @property
    def hasdynamics(self) -> bool:
        """Whether any link has mass, motor or friction."""
        return any(link.hasdynamics for link in self._links)

    def _current_dynamic_arrays(self) -> dict[str, Floats]:
        """The present inertias, motors and friction as arguments of the kernels."""
        if self._dynamic_arrays is None:
            if has_symbols(self._gravity) or any(link.has_symbolic_mass for link in self._links):
                raise WrongType(
                    f"Parameters of robot {self.name!r} are symbols, by which only `rne` and poses are computed."
                )
            if not self.hasdynamics:
                raise InputError(
                    f"Robot {self.name!r} has no masses, so no dynamics; set m, r and I of its links."
                )
            base = np.eye(4) if self._base is None else self._base
            model = model_of(self.name, self._links, self._grippers, self._gravity, base, moving=False)
            joints = sorted((a for a in self._links if a.isjoint), key=lambda a: a.jindex or 0)
            gears = np.array([abs(a.G) for a in joints])
            self._dynamic_arrays = {
                "inertia": parameters(model, "inertia"),
                "armature": parameters(model, "armature"),
                "viscous": np.array([a.B for a in joints]) * gears**2,
                "forward": np.array([a.Tc[0] for a in joints]) * gears,
                "backward": np.array([a.Tc[1] for a in joints]) * gears,
            }
            self._dynamic_arrays["has_friction"] = np.array(
                any(self._dynamic_arrays[k].any() for k in ("viscous", "forward", "backward"))
            )
            if not self._kernels:
                self._kernels["body"] = Body(model)
        return self._dynamic_arrays

    def _kernel(self, name: str) -> Any:
        if name not in self._kernels:
            body = self._kernels["body"]
            self._kernels[name] = body.kernel(name, checked=True, parameters=_KERNEL_PARAMETERS[name])
        return self._kernels[name]

    def _evaluate(self, name: str, arrays: tuple[Any, ...], gravity: Any = None) -> Floats:
        values = self._current_dynamic_arrays() if self._dynamic_arrays is None else self._dynamic_arrays
        fall = self._gravity if gravity is None else vector3(gravity)
        extra = [fall if part == "gravity" else values[part] for part in _KERNEL_PARAMETERS[name]]
        kernel = self._kernels.get(name) or self._kernel(name)
        try:
            result = kernel(*arrays, *extra)
        except (TypeError, ValueError):
            for argument, array in zip(("q", "qd", "qdd"), arrays, strict=False):
                numbers(argument, array)
            raise
        return _of_one_row(result, _DIMENSIONS.get(name, 1))

    def rne(
        self, q: Any, qd: Any = None, qdd: Any = None, symbolic: bool = False, gravity: Any = None
    ) -> Floats:
        """The joint torques of a motion, motors and friction included, (n,) or (m, n).

        Args:
            q: Configuration, (n,) or (m, n) [rad or m].
            qd: Velocity, likewise.
            qdd: Acceleration, likewise.
            symbolic: Whether to compute with symbols even where there are none.
            gravity: Acceleration of free fall, (3,) [m/s^2]; None for the robot's.

        Returns:
            Torques (n,) or (m, n) [N m or N].

        Raises:
            InputError: Symbols are asked of a robot that is no serial arm, or numbers of one that has no masses.
        """
        if symbolic or self.symbolic:
            return self._symbolic_torques(q, qd, qdd, gravity)
        try:
            v = np.zeros(self.n) if qd is None else numbers("qd", qd)
            return self._torques(q, v, qdd, gravity)
        except TypeError:
            if not any(has_symbols(x) for x in (q, qd, qdd) if x is not None):
                raise
        return self._symbolic_torques(q, qd, qdd, gravity)

    def _torques(self, q: Any, v: Any, qdd: Any, gravity: Any) -> Floats:
        tau = self._evaluate("inverse_dynamics", (q, v, np.zeros(self.n) if qdd is None else qdd), gravity)
        values = self._dynamic_arrays
        assert values is not None
        return tau + self._friction_torques(v) if values["has_friction"] else tau

    def _symbolic_torques(self, q: Any, qd: Any, qdd: Any, gravity: Any) -> Floats:
        joints = [link for link in self._links if link.isjoint]
        if len(joints) < len(self._links) or len({link.parent for link in joints}) < len(joints):
            raise InputError(
                "Torques with symbols are for serial arms with a joint in each link, such as DH robots."
            )
        still = np.zeros(self.n, dtype=int)
        motion = [np.asarray(still if x is None else x, dtype=object) for x in (q, qd, qdd)]
        if any(x.shape != (self.n,) for x in motion):
            raise ShapeError(
                "q", motion[0].shape, f"({self.n},), like qd and qdd: symbols for one configuration"
            )
        base = np.eye(4) if self._base is None else self._base
        return symbolic_torques(joints, base, self._gravity if gravity is None else vector3(gravity), *motion)

    def _friction_torques(self, v: Any) -> Floats:
        values = self._current_dynamic_arrays()
        tau = _friction(self.n)(v, values["viscous"], values["forward"], values["backward"])
        return _of_one_row(tau, 1)

    def inertia(self, q: Any) -> Floats:
        """The inertia matrix, motors included, (n, n) or (m, n, n)."""
        return self._evaluate("mass_matrix", (q,))

    def coriolis(self, q: Any, qd: Any) -> Floats:
        """The matrix of Coriolis and centrifugal effects.

        Args:
            q: Configuration (n,) or (m, n) [rad or m].
            qd: Velocity (n,) or (m, n) [rad/s or m/s].

        Returns:
            Matrix (n, n) or (m, n, n).
        """
        return self._evaluate("coriolis_matrix", (q, qd))

    def gravload(self, q: Any = None, gravity: Any = None) -> Floats:
        """The torques that hold the robot against gravity.

        Args:
            q: Configuration (n,) or (m, n) [rad or m].
            gravity: Acceleration of free fall, (3,) [m/s^2]; None for the robot's.

        Returns:
            Torques (n,) or (m, n) [N m or N].
        """
        return self._evaluate("gravity_forces", (q,), gravity)

    def itorque(self, q: Any, qdd: Any) -> Floats:
        """The torques of inertia alone.

        Args:
            q: Configuration (n,) or (m, n) [rad or m].
            qdd: Acceleration (n,) or (m, n) [rad/s^2 or m/s^2].

        Returns:
            Torques (n,) or (m, n) [N m or N].
        """
        rates = self._of_joints("qdd", qdd)
        return _of_one_row(np.squeeze(self.inertia(q) @ rates[..., None], axis=-1), 1)

    def accel(self, q: Any, qd: Any, torque: Any, gravity: Any = None) -> Floats:
        """The accelerations under torques and friction.

        Args:
            q: Configuration (n,) or (m, n) [rad or m].
            qd: Velocity (n,) or (m, n) [rad/s or m/s].
            torque: Torques (n,) or (m, n) [N m or N].
            gravity: Acceleration of free fall, (3,) [m/s^2]; None for the robot's.

        Returns:
            Accelerations (n,) or (m, n) [rad/s^2 or m/s^2].

        Raises:
            SingularInertia: A joint moves no mass.
        """
        self._current_dynamic_arrays()
        net_torque = self._of_joints("torque", torque) - self._friction_torques(self._of_joints("qd", qd))
        acceleration = self._evaluate("forward_dynamics", (q, qd, net_torque), gravity)
        flat = acceleration.ravel()
        if not math.isfinite(flat.dot(flat)) and not np.isfinite(flat).all():
            raise SingularInertia(
                f"The inertia matrix of {self.name!r} is singular: one of its joints moves no mass; set m or I "
                "of the links after it, or Jm of their motors."
            )
        return acceleration

    def friction(self, qd: Any) -> Floats:
        """The torques of friction, against the motion, (n,) or (m, n)."""
        rates = self._of_joints("qd", qd)
        return -self._friction_torques(rates) if self.hasdynamics else -0.0 * rates

    def _of_joints(self, name: str, value: Any) -> Floats:
        """The finite numbers of an argument that has one for each joint, (n,) or (m, n); a number for one joint."""
        out = numbers(name, value)
        out = out.reshape(1) if out.ndim == 0 and self.n == 1 else out
        if out.shape[-1:] != (self.n,):
            raise WrongShape(name, out.shape, f"({self.n},) or (m, {self.n})")
        check_finite(name, out)
        return out


def _of_one_row(result: Floats, dimensions: int) -> Floats:
    """The result for one configuration, which has `dimensions` axes, also where one was passed as a row (1, n)."""
    return result[0] if result.ndim > dimensions and len(result) == 1 else result


def vector3(gravity: Any) -> Floats:
    g = np.ravel(gravity if has_symbols(gravity) else numbers("gravity", gravity))
    if g.shape != (3,):
        raise WrongShape("gravity", np.shape(gravity), "(3,)")
    return g
