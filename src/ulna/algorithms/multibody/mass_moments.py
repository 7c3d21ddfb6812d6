"""Inertias as what adds up: mass, first and second moment about a frame's origin; and which of them a joint can feel.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| m | mass | () | [kg] | |
| c | first moment: mass times centre of mass | (3) | [kg m] | |
| I | rotational inertia about the origin | (3, 3) | [kg m^2] | |
| h = (p, n) | momentum at the twist (v, w) | Force | [N s, N m s] | p = m v + w x c, n = I w + c x v |
| D | rate of I about a point that stands still | (3, 3) | [kg m^2/s] | [w] I - I [w] + 2 (c.v) 1 - c v^T - v c^T |
| k, a, b | axis of a revolute joint, and the two across it | | | |

What lies on the axis of a revolute joint moves with either of the two bodies it joins: a mass m, a first moment c_k,
and a part of I that is equal in aa and bb. It may as well belong to the parent. `felt` moves all of it inward, so
that most bodies have no mass, no c_k and no I_bb any more, and their zeros fold away; the torques are the same to the
last parameter. Prismatic joints and translations leave I, spherical joints m, to the parent. Forces and momenta of
bodies are not the same: use it only for what is projected on motion subspaces.

Source: Khalil & Kleinfinger, Minimum operations and minimum parameters of the dynamic models of tree structure robots
(1987). The rotation of I about a coordinate axis is Featherstone's, appendix A.5.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ulna.algorithms.multibody.link_frames import Tidy
from ulna.algorithms.multibody.tree import Step
from ulna.model import Continuous, Helical, JointKind, Model, Prismatic, Revolute, Spherical, Translation
from ulna.numeric import apply, cross, dot, is_symbolic, matrix
from ulna.spatial import SE3, Force, Inertia, Motion
from ulna.typing import Array


@dataclass(frozen=True, slots=True)
class Lump:
    """The inertia of bodies about the origin of a frame; lumps in one frame are added."""

    mass: Any
    first: Array
    second: Array

    @classmethod
    def of(cls, inertia: Inertia) -> Lump:
        """That of a body."""
        return cls(inertia.mass, inertia.first_moment(), inertia.about_origin())

    @classmethod
    def zero(cls) -> Lump:
        """That of nothing."""
        return cls(0.0, np.zeros(3), np.zeros((3, 3)))

    def __add__(self, other: Lump) -> Lump:
        return Lump(self.mass + other.mass, self.first + other.first, self.second + other.second)

    def __sub__(self, other: Lump) -> Lump:
        return Lump(self.mass - other.mass, self.first - other.first, self.second - other.second)

    def apply(self, motion: Motion) -> Force:
        """The momentum at a twist, or the force at an acceleration."""
        v, w = motion.linear, motion.angular
        linear = _wide(self.mass, 1) * v + cross(w, self.first)
        return Force(linear, apply(self.second, w) + cross(self.first, v))

    def rate(self, V: Motion) -> Array:
        """D, when the body has the twist V and the origin stands still."""
        w, I, c, v = V.angular, self.second, self.first, V.linear
        x, y, z = w[..., 0], w[..., 1], w[..., 2]
        e = [[I[..., i, j] for j in range(3)] for i in range(3)]
        xx = 2.0 * e[0][2] * y - 2.0 * e[0][1] * z
        yy = 2.0 * e[0][1] * z - 2.0 * e[1][2] * x
        xy = z * (e[0][0] - e[1][1]) + y * e[1][2] - x * e[0][2]
        xz = y * (e[2][2] - e[0][0]) + x * e[0][1] - z * e[1][2]
        yz = x * (e[1][1] - e[2][2]) + z * e[0][2] - y * e[0][1]
        turned = matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, -(xx + yy)]])
        return turned + steiner(c, v)

    def moved(self, T: SE3, axis: int | None = None) -> Lump:
        """The same seen from the outer frame of T, which turns about a coordinate axis if it is told which."""
        p, m = T.translation, self.mass
        c = apply(T.rotation, self.first)
        shifted = c + _wide(m, 1) * p
        I = turned(T.rotation, self.second, axis) + steiner(p, c + 0.5 * _wide(m, 1) * p)
        return Lump(m, shifted, I)


def steiner(a: Array, b: Array) -> Array:
    """2 (a.b) 1 - a b^T - b a^T (..., 3, 3)."""
    (a0, a1, a2), (b0, b1, b2) = ([u[..., n] for n in range(3)] for u in (a, b))
    xx, yy, zz = 2.0 * a0 * b0, 2.0 * a1 * b1, 2.0 * a2 * b2
    xy, xz, yz = -(a0 * b1 + a1 * b0), -(a0 * b2 + a2 * b0), -(a1 * b2 + a2 * b1)
    return matrix([[yy + zz, xy, xz], [xy, xx + zz, yz], [xz, yz, xx + yy]])


def turned(R: Array, I: Array, axis: int | None = None) -> Array:
    """R I R^T (..., 3, 3) of a symmetric I; cheaper when R turns about a coordinate axis, 0, 1 or 2."""
    if axis is None:
        half = R @ I
        e = {(i, j): dot(half[..., i, :], R[..., j, :]) for i in range(3) for j in range(i, 3)}
        return matrix([[e[min(i, j), max(i, j)] for j in range(3)] for i in range(3)])
    a, b, k = (axis + 1) % 3, (axis + 2) % 3, axis
    cos, sin = R[..., a, a], R[..., b, a]
    u = sin * (I[..., a, a] - I[..., b, b]) + cos * (2.0 * I[..., a, b])
    t = sin * u
    out: list[list[Any]] = [[None] * 3 for _ in range(3)]
    out[a][a], out[b][b], out[k][k] = I[..., a, a] - t, I[..., b, b] + t, I[..., k, k]
    out[a][b] = out[b][a] = cos * u - I[..., a, b]
    out[a][k] = out[k][a] = cos * I[..., a, k] - sin * I[..., b, k]
    out[b][k] = out[k][b] = sin * I[..., a, k] + cos * I[..., b, k]
    return matrix(out)


def turning_axis(kind: JointKind) -> int | None:
    """The coordinate axis, 0, 1 or 2, about which a joint turns its moving frame; None if it is not one."""
    if isinstance(kind, (Revolute, Continuous, Helical)):
        axis = np.asarray(kind.axis)
        if np.count_nonzero(axis) == 1:
            return int(np.abs(axis).argmax())
    return None


def lumps(model: Model, tidied: Tidy) -> list[Lump]:
    """Of every step the body it carries, in its moving frame; nothing for the inner parts of a joint."""
    return [
        Lump.of(model.inertias[model.joint_index(step.joint.name)]).moved(frame.inverse())
        if step.is_last
        else Lump.zero()
        for step, frame in zip(tidied.tree, tidied.frames, strict=True)
    ]


def felt(model: Model, tidied: Tidy) -> list[Lump]:
    """The same for torques: what the joint of a step cannot tell from inertia of its parent is given to the parent."""
    bodies = lumps(model, tidied)
    for i, step in reversed(list(enumerate(tidied.tree))):
        if step.parent >= 0 and is_symbolic(step.placement.rotation, step.placement.translation):
            continue  # moving inertia through a placement that is not known costs more than it saves
        given = _indifferent(step, bodies[i])
        if given is None:
            continue
        bodies[i] = bodies[i] - given
        if step.parent >= 0:
            bodies[step.parent] = bodies[step.parent] + given.moved(step.placement)
    return bodies


def _indifferent(step: Step, body: Lump) -> Lump | None:
    """The part of a body that moves with the parent as well, in the moving frame at zero, which is the fixed frame."""
    nothing = np.zeros(3), np.zeros((3, 3))
    if isinstance(step.kind, (Prismatic, Translation)):
        return Lump(0.0, nothing[0], body.second)
    if isinstance(step.kind, Spherical):
        return Lump(body.mass, *nothing)
    if not isinstance(step.kind, (Revolute, Continuous)):
        return None
    k = turning_axis(step.kind)
    if k is None:
        return Lump(body.mass, *nothing)
    b = (k + 2) % 3
    return Lump(body.mass, body.first * np.eye(3)[k], body.second[b, b] * (np.eye(3) - np.diag(np.eye(3)[k])))


def _wide(x: Any, rank: int) -> Any:
    return x[(..., *[None] * rank)] if isinstance(x, np.ndarray) and x.ndim else x
