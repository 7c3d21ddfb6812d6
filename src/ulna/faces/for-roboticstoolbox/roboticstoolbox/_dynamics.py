"""The dynamics of a robot: kernels that take masses, motors and gravity as numbers, so that links may change.

| symbol | meaning | unit |
|---|---|---|
| Jm, B, Tc, G | inertia, viscous and Coulomb friction of a motor, gear ratio | [kg m^2], [N m s/rad], [N m] |
| tau | torques, friction overcome: M qdd + C qd + g + B G^2 qd + abs(G) Tc sign(qd) | [N m] |

Source: Corke, Robotics, Vision and Control (2023), chapter 9.
"""

from __future__ import annotations

from collections import namedtuple
from functools import cache
from typing import Any, Self

import numpy as np

from roboticstoolbox._link import Link
from roboticstoolbox._tree import model_of
from ulna.errors import InputError, MissingExtra, ShapeError, UnknownName
from ulna.model import parameters
from ulna.numeric import less, where
from ulna.robot import Robot as Body
from ulna.spatial import SE3, Inertia
from ulna.trace import compile
from ulna.typing import Array, Floats

_WITH = {
    "inverse_dynamics": ("inertia", "armature", "gravity"),
    "forward_dynamics": ("inertia", "armature", "gravity"),
    "gravity_forces": ("inertia", "gravity"),
    "mass_matrix": ("inertia", "armature"),
    "coriolis_matrix": ("inertia",),
}

fdyn = namedtuple("fdyn", ["t", "q", "qd"])


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

    def fdyn(
        self,
        T: float,
        q0: Any,
        Q: Any = None,
        Q_args: dict[str, Any] | None = None,
        qd0: Any = None,
        solver: str = "RK45",
        solver_args: dict[str, Any] | None = None,
        dt: float | None = None,
        progress: bool = False,
    ) -> fdyn:
        """The motion under torques `Q(robot, t, q, qd, **Q_args)` from `q0` for `T` seconds: t, q, qd by rows.

        `solver` is one of scipy's; its steps are the rows, or every `dt`.
        """
        try:
            from scipy import integrate, interpolate
        except ImportError:
            raise MissingExtra("scipy", "toolbox", "fdyn") from None
        solvers = ("RK23", "RK45", "DOP853", "Radau", "BDF", "LSODA")
        if solver not in solvers:
            raise UnknownName("solver", solver, solvers)
        start = np.asarray(q0, dtype=float)
        if start.shape != (self.n,):
            raise ShapeError("q0", start.shape, f"({self.n},)")
        v0 = np.zeros(self.n) if qd0 is None else np.asarray(qd0, dtype=float)
        still, arguments, n = np.zeros(self.n), Q_args or {}, self.n

        def rate(t: float, x: Floats) -> Floats:
            tau = still if Q is None else np.asarray(Q(self, t, x[:n], x[n:], **arguments), dtype=float)
            return np.concatenate([x[n:], self.accel(x[:n], x[n:], tau)])

        stepper = getattr(integrate, solver)(
            rate, t0=0.0, y0=np.concatenate([start, v0]), t_bound=T, **(solver_args or {})
        )
        times, states = [0.0], [stepper.y]
        while stepper.status == "running":
            message = stepper.step()
            if stepper.status == "failed":
                raise RuntimeError(f"fdyn: {solver} failed at t = {stepper.t:.4g} s: {message}")
            times.append(stepper.t)
            states.append(stepper.y)
        t, x = np.array(times), np.array(states)
        if dt is not None:
            even = np.arange(0.0, T, dt)
            x, t = interpolate.interp1d(t, x, axis=0)(even), even
        return fdyn(t, x[:, :n], x[:, n:])

    def _weighed(self) -> tuple[Body, str]:
        """The robot of Ulna with the weights of now, and the name of its end."""
        self._told()
        base = np.eye(4) if self._base is None else self._base
        body = Body(model_of(self.name, self._links, self._grippers, self._gravity, base, moving=False))
        end, tool = self._end()  # type: ignore[attr-defined]
        if tool is None and self._tool is None:
            return body, end.name
        T = np.eye(4) if tool is None else tool
        body = body.with_tool(end.name, SE3.from_matrix(T if self._tool is None else T @ self._tool))
        return body, body.tool

    def _felt(self, name: str, arrays: tuple[Any, ...], representation: str | None) -> Floats:
        """What is felt at the end, by Ulna's operational space."""
        body, end = self._weighed()
        return getattr(body, name)(*arrays, frame=end, representation=representation)

    def inertia_x(
        self, q: Any = None, pinv: bool = False, representation: str = "rpy/xyz", Ji: Any = None
    ) -> Floats:
        """The inertia felt at the end, by position and angles, (6, 6)."""
        return self._felt("operational_inertia", (self.q if q is None else q,), representation)

    def coriolis_x(
        self, q: Any, qd: Any, pinv: bool = False, representation: str = "rpy/xyz", **_: Any
    ) -> Floats:
        """Coriolis and centrifugal effects felt at the end, (6, 6)."""
        return self._felt("operational_coriolis", (q, qd), representation)

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
        J = self.jacob0_analytical(q, representation)  # type: ignore[attr-defined]
        v = np.linalg.pinv(J) @ np.asarray(xd, dtype=float)
        tau = J.T @ np.asarray(wrench, dtype=float) - self._rubbing(v)
        kept = self._gravity
        try:
            self._gravity = kept if gravity is None else _three(gravity)
            return self._felt("operational_acceleration", (q, v, tau), representation)
        finally:
            self._gravity = kept

    def payload_capacity(self, q: Any, tau_m: Any, w: Any, frame: str = "base") -> Floats:
        """How many times the wrench `w` (6,) at the end the joint torques `tau_m` (n,) can carry.

        `frame` says in whose axes the wrench is written: "base" or "ee".
        """
        if frame not in ("base", "ee"):
            raise InputError(f"`frame` is {frame!r}; expected 'base' or 'ee'.")
        body, end = self._weighed()
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
        """The force at the end that gravity takes, (6,)."""
        kept = self._gravity
        try:
            self._gravity = kept if gravity is None else _three(gravity)
            return self._felt("operational_gravity", (self.q if q is None else q,), representation)
        finally:
            self._gravity = kept

    def payload(self, m: float, p: Any = None) -> None:
        """Adds a point mass `m` [kg] at `p` in the last link's frame [m]."""
        last = self._links[-1]
        body = last._inertia()
        more = Inertia.from_point(float(m), np.zeros(3) if p is None else np.asarray(p, dtype=float))
        whole = more if body is None else body + more
        last.m, last.r, last.I = float(whole.mass), whole.com, whole.inertia

    def nofriction(self, coulomb: bool = True, viscous: bool = False) -> Self:
        """A copy without Coulomb friction, without viscous friction."""
        out = self.copy()  # type: ignore[attr-defined]
        for link in out._links:
            if coulomb:
                link.Tc = [0.0, 0.0]
            if viscous:
                link.B = 0.0
        return out

    def perturb(self, p: float = 0.1) -> Self:
        """A copy with masses and inertias off at random by up to the fraction `p`."""
        out = self.copy()  # type: ignore[attr-defined]
        out.name = f"P/{self.name}"
        draw = np.random.default_rng()
        for link in out._links:
            link.m = link.m * (1.0 + draw.uniform(-p, p))
            link.I = link.I * (1.0 + draw.uniform(-p, p))
        return out

    def dynamics(self) -> None:
        """Prints what the links weigh, as a table."""
        from roboticstoolbox._table import grid

        def listed(x: Any) -> str:
            return ",  ".join(f"{v:.3g}" for v in x)

        rows = []
        for link in self._links:
            if link.isjoint:
                I = link.I
                six = (I[0, 0], I[1, 1], I[2, 2], I[0, 1], I[1, 2], I[0, 2])
                numbers = [listed(link.r), listed(six), f"{link.Jm:.3g}", f"{link.B:.3g}", listed(link.Tc)]
                rows.append([link.name, f"{link.m:.3g}", *numbers, f"{link.G:.3g}"])
        print(grid(["j", "m", "r", "I", "Jm", "B", "Tc", "G"], rows, [False] * 8))

    def dynamics_list(self) -> None:
        """Prints what each link weighs."""
        for i, link in enumerate(self._links):
            print(f"\nLink {i}:: {link}")
            print(link.dyn())


def _three(gravity: Any) -> Floats:
    g = np.asarray(gravity, dtype=float).ravel()
    if g.shape != (3,):
        raise ShapeError("gravity", np.shape(gravity), "(3,)")
    return g
