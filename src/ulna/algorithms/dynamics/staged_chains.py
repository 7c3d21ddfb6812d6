"""Dynamics of long serial chains of revolute joints, as stages: segments of the chain in SIMD lanes.

T, s, V and A are those of multibody/chain_walks.py.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| o | the origin of everything below: that of the first moving frame; axes are the world's | | | |
| m, c, I | mass, centre of mass, rotational inertia about it | | [kg], [m], [kg m^2] | |
| f, n | force on a body, and moment about c | (3), (3) | [N], [N m] | m c'', I w' + w x I w |
| F | force on all bodies from a joint outward | Force | [N, N m] | sum of (f, n + c x f) |
| tau | torque | | [N m] | s . F + armature times a |
| c_G, m_G | centre of mass and mass of all that moves | (3), () | [m], [kg] | |
| J | column of the Jacobian of c_G | (3) | [m] | z x (sum of m (c - p) over the bodies outward) / m_G |
| h | momentum about c_G | Force | [N s, N m s] | sum of (m c', I w + (c - c_G) x m c') |
| A_G | column of its matrix | Force | | momentum of all bodies from a joint outward at the twist s |
| E | kinetic energy, and potential energy | () | [J] | sum of (m c'.c' + w.I w) / 2 - m g.c, plus armature v^2 / 2 |

Seen from one frame, motions and forces do not travel from body to body: twists and accelerations are sums outward along
the chain, forces, moments and momenta of what lies outward are sums inward, and sums are parallel prefixes
(`ulna.compiler.forms.scans`). The definitions are inverse_dynamics in rnea_point_accelerations.py, energy.py,
center_of_mass.py and centroidal.py; `tests/laws/test_staged_chains.py` compares.

Source: Featherstone 2008, sections 2.14 and 5.3 (the recursive Newton-Euler algorithm in one frame); Siciliano et al.
2009, section 7.5 (about centres of mass); Orin, Goswami & Lee 2013.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ulna.algorithms.dynamics.center_of_mass import total_mass
from ulna.algorithms.multibody.chain_frames import (
    PADDING,
    ChainFrames,
    chain_frames,
    pose_numbers,
    pose_of,
)
from ulna.algorithms.multibody.chain_walks import (
    motion,
    placed,
    screw,
    walk_of_accelerations,
    walk_of_poses,
    walk_of_twists,
)
from ulna.algorithms.multibody.mass_moments import UPPER, MassMoments, rotate_symmetric, steiner, symmetric
from ulna.compiler.forms.scans import Walk, sums
from ulna.compiler.forms.stages import StagedForm, Stages
from ulna.model import Model
from ulna.numeric import apply, cross, dot
from ulna.spatial import SE3, Force, Motion
from ulna.typing import Array


def stages_of_inverse_dynamics(model: Model) -> StagedForm | None:
    """The joint torques that produce an acceleration.

    Args:
        model: The robot.

    Returns:
        The form; None for robots that need another one.
    """
    return _torques("inverse_dynamics", model, "q", "v", "a")


def stages_of_bias_forces(model: Model) -> StagedForm | None:
    """The joint torques that produce no acceleration.

    Args:
        model: The robot.

    Returns:
        The form; None for robots that need another one.
    """
    return _torques("bias_forces", model, "q", "v")


def stages_of_mechanical_energy(model: Model, potential: bool = True) -> StagedForm | None:
    """The kinetic energy, and the potential energy.

    Args:
        model: The robot.
        potential: Whether the latter counts.

    Returns:
        The form; None for robots that need another one.
    """
    walks = _walks("mechanical_energy" if potential else "kinetic_energy", model, "q", "v")
    if walks is None:
        return None
    gravity = np.asarray(model.gravity) if potential else np.zeros(3)
    at_origin = -float(gravity @ walks.origin) * total_mass(model)
    walks.velocities()
    walks.armature()

    def of_body(
        state: Array, V_before: Array, V_local: Array, T: Array, bodies: Array, armature: Array, v: Array
    ) -> Array:
        body, V = _Body(pose_of(T), bodies), motion(V_before + V_local)
        w, u = body.turned_back(V.angular), body.velocity(V)
        kinetic = body.mass * dot(u, u) + dot(w, apply(body.inertia, w)) + armature[0] * v[0] * v[0]
        return state + np.array([0.5 * kinetic - body.mass * dot(gravity, body.center)], dtype=object)

    reads = ("V_before", "V_local", "T", "bodies", "armature", "v")
    walks.add(Walk(of_body, reads, (), sums(1), "E_before", lambda E: E + at_origin, "E_whole"))
    walks.scan()
    walks.stages.straight(lambda E_whole: E_whole[0], ("E_whole",), ("E",))
    return walks.stages.form("E")


def stages_of_center_of_mass_jacobian(model: Model, subtree: str | None = None) -> StagedForm | None:
    """The Jacobian of the centre of mass.

    Args:
        model: The robot; without mass it has no such form.
        subtree: Name of a joint, for what it moves, which has no such form; None for all.

    Returns:
        The form; None for robots that need another one.
    """
    walks, m_G = _walks("center_of_mass_jacobian", model, "q"), total_mass(model)
    if walks is None or not m_G or subtree is not None:
        return None
    walks.outward_mass()

    def of_body(state: Array, segment: Array, local: Array, bodies: Array) -> tuple[Array, ...]:
        T = placed(segment, local)
        body = _Body(T, bodies)
        after = state + body.mass * body.center
        return after, np.concatenate([T.rotation[:, 2], T.translation]), after

    def column(c_before: Array, c_local: Array, axes: Array, outward_mass: Array) -> Array:
        moment = c_before + c_local - outward_mass[0] * axes[3:]
        return cross(axes[:3], moment) * (1.0 / m_G)

    reads = ("segment", "local", "bodies")
    walks.add(Walk(of_body, reads, ("axes", "c_local"), sums(3), "c_before", is_inward=True))
    walks.add(Walk(column, ("c_before", "c_local", "axes", "outward_mass"), ("J",)))
    walks.scan("J")
    return walks.stages.form("J")


def stages_of_centroidal_momentum(model: Model) -> StagedForm | None:
    """The momentum about the centre of mass.

    Args:
        model: The robot; without mass it has no such form.

    Returns:
        The form; None for robots that need another one.
    """
    walks, m_G = _walks("centroidal_momentum", model, "q", "v"), total_mass(model)
    if walks is None or not m_G:
        return None
    walks.velocities()

    def of_body(state: Array, V_before: Array, V_local: Array, T: Array, bodies: Array) -> Array:
        body, V = _Body(pose_of(T), bodies), motion(V_before + V_local)
        p = body.mass * body.velocity(V)
        n = body.turned(apply(body.inertia, body.turned_back(V.angular)))
        return state + np.concatenate([body.mass * body.center, p, n + cross(body.center, p)])

    def about_center(state: Array) -> Array:
        return np.concatenate([state[3:6], state[6:] - cross(state[:3] * (1.0 / m_G), state[3:6])])

    reads = ("V_before", "V_local", "T", "bodies")
    walks.add(Walk(of_body, reads, (), sums(9), "h_before", about_center, "h"))
    walks.scan()
    return walks.stages.form("h")


def centroidal_matrix_of_chain(model: Model) -> StagedForm | None:
    """The matrix of the momentum about the centre of mass.

    Args:
        model: The robot; without mass it has no such form.

    Returns:
        The form; None for robots that need another one.
    """
    walks, m_G = _walks("centroidal_matrix", model, "q"), total_mass(model)
    if walks is None or not m_G:
        return None
    walks.outward_mass()

    def of_body(state: Array, segment: Array, local: Array, bodies: Array) -> tuple[Array, ...]:
        T = placed(segment, local)
        first, second = _Body(T, bodies).moments()
        after = state + np.array([*first, *(second[place] for place in UPPER)], dtype=object)
        return after, screw(T), after

    def column(
        moments_before: Array, moments_local: Array, s: Array, outward_mass: Array, c_G: Array
    ) -> Array:
        moments = moments_before + moments_local
        h = MassMoments(outward_mass[0], moments[:3], symmetric(moments[3:])).apply(motion(s))
        return np.concatenate([h.linear, h.angular - cross(c_G, h.linear)])

    walks.add(
        Walk(
            of_body,
            ("segment", "local", "bodies"),
            ("s", "moments_local"),
            sums(9),
            "moments_before",
            lambda moments: moments[:3] * (1.0 / m_G),
            "c_G",
            is_inward=True,
        )
    )
    walks.add(Walk(column, ("moments_before", "moments_local", "s", "outward_mass", "c_G"), ("A_G",)))
    walks.scan("A_G")
    return walks.stages.form("A_G")


def _torques(name: str, model: Model, *inputs: str) -> StagedForm | None:
    """The torques of inverse dynamics, without joint accelerations where they are no input."""
    walks = _walks(name, model, *inputs)
    if walks is None:
        return None
    walks.velocities()
    walks.accelerations()
    walks.forces()
    walks.armature()

    def torque(F_before: Array, F_local: Array, s: Array, armature: Array, a: Array | None = None) -> Array:
        tau = dot(s, F_before + F_local)
        return np.array([tau if a is None else tau + armature[0] * a[0]], dtype=object)

    walks.add(Walk(torque, ("F_before", "F_local", "s", "armature", *inputs[2:]), ("tau",)))
    walks.scan(flat=("tau",))
    return walks.stages.form("tau")


def _walks(name: str, model: Model, *inputs: str) -> _Walks | None:
    """The walks of a chain, with poses; None for other robots."""
    chain = chain_frames(model)
    return None if chain is None else _Walks(name, model, chain, inputs)


class _Walks:
    """The walks of a chain; the names of arrays are those of the table above.

    A column of the table of `bodies` is m, c and the upper triangle of I in the moving frame.

    Args:
        name: The name of the function.
        model: The robot.
        chain: Its frames.
        inputs: The names of the inputs, "q" first.
    """

    def __init__(self, name: str, model: Model, chain: ChainFrames, inputs: Sequence[str]) -> None:
        sizes = {key: model.nq if key == "q" else model.nv for key in inputs}
        self.stages = Stages(name, model.nv, **{key: (size,) for key, size in sizes.items()})
        self.model = model
        rotation, self.origin = chain.start[:9], np.array(chain.start[9:])
        self._walks = [walk_of_poses(chain, pose_numbers, (*rotation, 0.0, 0.0, 0.0))]
        self._known: dict[str, Any] = {"numbers": chain.numbers, "bodies": _bodies(model, chain)}
        self._vectors = {key: chain.first_q if key == "q" else 0 for key in inputs}

    def know(self, name: str, rows: Any) -> None:
        """Something that is known of the columns, (rows, columns)."""
        self._known[name] = rows

    def add(self, walk: Walk) -> None:
        """One more walk."""
        self._walks.append(walk)

    def scan(self, *tables: str, flat: Sequence[str] = ()) -> None:
        """The stage of all walks; arguments are names of what is handed on."""
        self.stages.scan(self._walks, self._known, {"numbers": PADDING}, self._vectors, tables, flat)

    def outward_mass(self) -> None:
        """The mass of all bodies from a joint outward."""
        masses = self._known["bodies"][0]
        self.know("outward_mass", np.cumsum(masses[::-1])[None, ::-1])

    def armature(self) -> None:
        """The `armature` of every joint."""
        self.know("armature", [[float(x) for x in self.model.armature]])

    def velocities(self) -> None:
        """T, s and V."""
        self.add(walk_of_twists())

    def accelerations(self) -> None:
        """A, and V of the whole chain."""
        self.add(walk_of_accelerations(self.model.gravity, "a" if "a" in self._vectors else ""))

    def forces(self) -> None:
        """F."""

        def of_body(
            state: Array, A_before: Array, A_local: Array, V: Array, T: Array, bodies: Array
        ) -> tuple[Array, Array]:
            body = _Body(pose_of(T), bodies)
            after = state + body.force(motion(V), motion(A_before + A_local)).vector()
            return after, after

        reads = ("A_before", "A_local", "V", "T", "bodies")
        self.add(Walk(of_body, reads, ("F_local",), sums(6), "F_before", is_inward=True))


class _Body:
    """A body in one of the lanes.

    Args:
        T: The pose of its moving frame.
        numbers: Its column of the table of bodies.

    Attributes:
        mass: m.
        center: c.
        inertia: I in the axes of the moving frame.
    """

    def __init__(self, T: SE3, numbers: Array) -> None:
        self._R = T.rotation
        self.mass, self.inertia = numbers[0], symmetric(numbers[4:])
        self.center = apply(T.rotation, numbers[1:4]) + T.translation

    def turned(self, x: Array) -> Array:
        """A vector of the axes of the moving frame in those of the world."""
        return apply(self._R, x)

    def turned_back(self, x: Array) -> Array:
        """A vector of the axes of the world in those of the moving frame."""
        return apply(self._R.T, x)

    def velocity(self, V: Motion) -> Array:
        """That of the centre of mass at a twist."""
        return V.linear + cross(V.angular, self.center)

    def force(self, V: Motion, A: Motion) -> Force:
        """What moves the body at a twist with an acceleration, about the origin."""
        f = self.mass * (A.linear + cross(A.angular, self.center) + cross(V.angular, self.velocity(V)))
        w, dw = self.turned_back(V.angular), self.turned_back(A.angular)
        n = self.turned(apply(self.inertia, dw) + cross(w, apply(self.inertia, w)))
        return Force(f, n + cross(self.center, f))

    def moments(self) -> tuple[Array, Array]:
        """First and second moment about the origin."""
        first = self.mass * self.center
        return first, rotate_symmetric(self._R, self.inertia) + steiner(self.center, 0.5 * first)


def _bodies(model: Model, chain: ChainFrames) -> Array:
    """The table of bodies."""
    columns = []
    for step, frame in zip(chain.links.tree, chain.links.frames, strict=True):
        body = frame.inverse().act(model.inertias[model.joint_index(step.joint.name)])
        columns.append([body.mass, *body.com, *(body.inertia[place] for place in UPPER)])
    return np.array(columns, dtype=float).T
