"""The dynamics of a robot: kernels that take masses, motors and gravity as numbers, so that links may change.

| symbol | meaning | unit |
|---|---|---|
| Jm, B, Tc, G | inertia, viscous and Coulomb friction of a motor, gear ratio | [kg m^2], [N m s/rad], [N m] |
| tau | torques, friction overcome: M qdd + C qd + g + B G^2 qd + abs(G) Tc sign(qd) | [N m] |

Source: Corke, Robotics, Vision and Control (2023), chapter 9.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from roboticstoolbox._links.link import Link
from roboticstoolbox._links.ulna_model import model_of
from ulna.compiler import compile
from ulna.errors import InputError, ShapeError
from ulna.model import parameters
from ulna.numeric import less, where
from ulna.robot import Robot as Body
from ulna.typing import Array, Floats

_WITH = {
    "inverse_dynamics": ("inertia", "armature", "gravity"),
    "forward_dynamics": ("inertia", "armature", "gravity"),
    "gravity_forces": ("inertia", "gravity"),
    "mass_matrix": ("inertia", "armature"),
    "coriolis_matrix": ("inertia",),
}


@cache
def _friction(n: int) -> Any:
    """Torques that overcome friction, (..., n): of speeds, B G^2, and Coulomb friction both ways."""

    def torque(v: Array, viscous: Array, forward: Array, backward: Array) -> Array:
        dry = where(less(0.0, v), forward, where(less(v, 0.0), backward, 0.0))
        return viscous * v + dry

    return compile(torque, v=(n,), viscous=(n,), forward=(n,), backward=(n,))


class Dynamics:
    """Torques, inertia and motion."""

    _weights: dict[str, Floats] | None
    _kernels: dict[str, Any]
    _links: list[Link]
    _grippers: list[Any]
    _base: Floats | None
    _tool: Floats | None
    _gravity: Floats
    name: str
    n: int
    q: Floats

    def dynchanged(self, what: str | None = None) -> None:
        """Forgets masses and motors; called when a link changes."""
        self._weights = None

    @property
    def hasdynamics(self) -> bool:
        """Whether any link has mass, motor or friction."""
        return any(link.hasdynamics for link in self._links)

    def _told(self) -> dict[str, Floats]:
        """Masses, motors and friction as the kernels take them."""
        if self._weights is None:
            if not self.hasdynamics:
                raise InputError(
                    f"Robot {self.name!r} has no masses, so no dynamics; give its links m, r and I."
                )
            base = np.eye(4) if self._base is None else self._base
            model = model_of(self.name, self._links, self._grippers, self._gravity, base, moving=False)
            joints = sorted((a for a in self._links if a.isjoint), key=lambda a: a.jindex or 0)
            gears = np.array([abs(a.G) for a in joints])
            self._weights = {
                "inertia": parameters(model, "inertia"),
                "armature": parameters(model, "armature"),
                "viscous": np.array([a.B for a in joints]) * gears**2,
                "forward": np.array([a.Tc[0] for a in joints]) * gears,
                "backward": np.array([a.Tc[1] for a in joints]) * gears,
            }
            self._weights["rubs"] = np.array(
                any(self._weights[k].any() for k in ("viscous", "forward", "backward"))
            )
            if not self._kernels:
                self._kernels["body"] = Body(model)
        return self._weights

    def _kernel(self, name: str) -> Any:
        if name not in self._kernels:
            body = self._kernels["body"]
            self._kernels[name] = body.kernel(name, checked=True, parameters=_WITH[name])
        return self._kernels[name]

    def _ask(self, name: str, arrays: tuple[Any, ...], gravity: Any = None) -> Floats:
        told = self._told() if self._weights is None else self._weights
        fall = self._gravity if gravity is None else _three(gravity)
        extra = [fall if part == "gravity" else told[part] for part in _WITH[name]]
        kernel = self._kernels.get(name) or self._kernel(name)
        return kernel(*arrays, *extra)

    def rne(
        self, q: Any, qd: Any = None, qdd: Any = None, symbolic: bool = False, gravity: Any = None
    ) -> Floats:
        """The joint torques of a motion, motors and friction included, (n,) or (m, n).

        Args:
            q: Configuration, (n,) or (m, n) [rad or m].
            qd: Velocity, likewise.
            qdd: Acceleration, likewise.
            symbolic: Refused.
            gravity: Acceleration of free fall, (3,) [m/s^2]; None for the robot's.
        """
        if symbolic:
            raise InputError("symbolic=True is not offered; trace `robot.inverse_dynamics` of an ulna.Robot.")
        v = np.zeros(self.n) if qd is None else np.asarray(qd, dtype=float)
        tau = self._ask("inverse_dynamics", (q, v, np.zeros(self.n) if qdd is None else qdd), gravity)
        told = self._weights
        assert told is not None
        return tau + self._rubbing(v) if told["rubs"] else tau

    def _rubbing(self, v: Any) -> Floats:
        told = self._told()
        return _friction(self.n)(v, told["viscous"], told["forward"], told["backward"])

    def inertia(self, q: Any) -> Floats:
        """The inertia matrix, motors included, (n, n) or (m, n, n)."""
        return self._ask("mass_matrix", (q,))

    def coriolis(self, q: Any, qd: Any) -> Floats:
        """The matrix of Coriolis and centrifugal effects, (n, n) or (m, n, n)."""
        return self._ask("coriolis_matrix", (q, qd))

    def gravload(self, q: Any = None, gravity: Any = None) -> Floats:
        """The torques that gravity takes, (n,) or (m, n)."""
        return self._ask("gravity_forces", (self.q if q is None else q,), gravity)

    def itorque(self, q: Any, qdd: Any) -> Floats:
        """The torques of inertia alone, (n,) or (m, n)."""
        return np.squeeze(self.inertia(q) @ np.asarray(qdd, dtype=float)[..., None], axis=-1)

    def accel(self, q: Any, qd: Any, torque: Any, gravity: Any = None) -> Floats:
        """The accelerations that torques give, friction overcome, (n,) or (m, n)."""
        self._told()
        pushing = np.asarray(torque, dtype=float) - self._rubbing(np.asarray(qd, dtype=float))
        return self._ask("forward_dynamics", (q, qd, pushing), gravity)

    def friction(self, qd: Any) -> Floats:
        """The torques of friction, against the motion, (n,) or (m, n)."""
        return -self._rubbing(np.asarray(qd, dtype=float))


def _three(gravity: Any) -> Floats:
    g = np.asarray(gravity, dtype=float).ravel()
    if g.shape != (3,):
        raise ShapeError("gravity", np.shape(gravity), "(3,)")
    return g
