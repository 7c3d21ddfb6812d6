"""The Coriolis matrix that belongs to the Christoffel symbols of the mass matrix.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| V_i, s | twist of body i; a column of S_i, both in its moving frame | Motion | | |
| s' | rate of s as it is carried along | Motion | | s' = V_i x s |
| I | inertia of all bodies from step i outward | MassMoments | | sum of theirs |
| h = (p, n), D | their momentum, and the rate of their second moment | Force, (3, 3) | | see mass_moments.py |
| B s | for s = (l; w) | Force | | (w x p; (D w + w x n) / 2) |
| B^T s | a pure moment | (3) | | p x l + (D w + n x w) / 2 |
| C_ij | s_j of a step on which step i stands, or i itself | () | | column of i: s_j . (B s + I s') |
| C_ji | the transposed entry | () | | row of i: s_j' . I s + s_j . B^T s |
| C | Coriolis matrix | (nv, nv) | | C v + gravity = bias, dM/dt = C + C^T |

Source: Echeandia & Wensing, Numerical methods to compute the Coriolis matrix and Christoffel symbols for rigid-body
systems (2021), algorithm 1. Among the matrices C with the same C v it is that of the symbols of the first kind, where
dM/dt - 2 C is skew. The frames are those of link_frames.py, and the inertias are regrouped.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

from ulna.algorithms.multibody.batch_shapes import batch_zeros
from ulna.algorithms.multibody.body_motions import body_velocities
from ulna.algorithms.multibody.mass_moments import MassMoments, rotate_symmetric, rotation_axis, steiner
from ulna.algorithms.multibody.prepared_model import prepare
from ulna.algorithms.multibody.tree import Step, inward
from ulna.model import Model
from ulna.numeric import apply, cross, dot
from ulna.spatial import SE3, Force, Motion
from ulna.typing import Array


class MovingBodies(NamedTuple):
    """Bodies that move: their inertia I, their momentum h, and D, about the origin of a frame."""

    body: MassMoments
    h: Force
    D: Array

    @classmethod
    def at(cls, body: MassMoments, V: Motion) -> MovingBodies:
        """The quantities of one body.

        Args:
            body: Its inertia about the origin of its frame [kg, kg m, kg m^2].
            V: Its twist in that frame [m/s, rad/s].

        Returns:
            Inertia, momentum and rate of the second moment.
        """
        return cls(body, body.apply(V), body.rate(V))

    def __add__(self, other: Any) -> MovingBodies:
        return MovingBodies(self.body + other.body, self.h + other.h, self.D + other.D)

    def to_parent(self, step: Step, q: Array) -> MovingBodies:
        """The same in the parent's moving frame.

        Args:
            step: The step in whose moving frame the quantities are.
            q: Configuration, shape (..., nq) [rad, m].

        Returns:
            The quantities about the origin of the parent's moving frame.
        """
        return self.to_outer_frame(step.transform(q), rotation_axis(step.kind)).to_outer_frame(step.placement)

    def to_outer_frame(self, T: SE3, axis: int | None = None) -> MovingBodies:
        """The same in another frame.

        Args:
            T: The pose of the present frame in the outer one [m].
            axis: The coordinate axis, 0, 1 or 2, about which T turns, which saves operations; None for any rotation.

        Returns:
            The quantities about the origin of the outer frame, in its axes.
        """
        h = T.act(self.h)
        return MovingBodies(
            self.body.to_outer_frame(T, axis),
            h,
            rotate_symmetric(T.rotation, self.D, axis) + steiner(T.translation, h.linear),
        )

    def halves(self, s: Motion) -> tuple[Array, Array]:
        """D w / 2 and w x n / 2 for a column s = (l; w), shape (..., 3) each."""
        return 0.5 * apply(self.D, s.angular), 0.5 * cross(s.angular, self.h.angular)

    def rate(self, s: Motion) -> Force:
        """(dI/dt) s for a column s that stands still: B s + B^T s."""
        p, w = self.h.linear, s.angular
        return Force(cross(w, p), apply(self.D, w) + cross(p, s.linear))


def coriolis_matrix(model: Model, q: Array, v: Array) -> Array:
    """The Coriolis matrix of the Christoffel symbols of the first kind: dM/dt - 2 C is skew.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].

    Returns:
        C, shape (..., nv, nv); `C @ v` are the Coriolis and centrifugal torques [N m, N].
    """
    prepared = prepare(model)
    tree = prepared.tree
    V = body_velocities(tree, q, v)
    bodies = [MovingBodies.at(body, twist) for body, twist in zip(prepared.regrouped_moments, V, strict=True)]
    subtrees = inward(tree, bodies, lambda step, moving: moving.to_parent(step, q))
    C = batch_zeros((model.nv, model.nv), q, v)
    for i, step in enumerate(tree):
        for k, s in step.columns():
            _add_pairs(tree, V, i, k, s, subtrees[i], q, C)
    return C


def _add_pairs(
    tree: Sequence[Step],
    V: Sequence[Motion],
    i: int,
    k: int,
    s: Motion,
    subtree: MovingBodies,
    q: Array,
    C: Array,
) -> None:
    """Adds the entries of column s of step i with the columns of that step and of its ancestors."""
    h, body = subtree.h, subtree.body
    half, turn = subtree.halves(s)
    column = Force(cross(s.angular, h.linear), half + turn) + body.apply(V[i].cross(s))
    row = body.apply(s)
    moment = cross(h.linear, s.linear) + half - turn
    for index, other in tree[i].columns():
        C[..., index, k] += column.dot(other)
    while tree[i].parent >= 0:
        P, J = tree[i].placement, tree[i].transform(q)
        column, row = P.act(J.act(column)), P.act(J.act(row))
        moment = apply(P.rotation, apply(J.rotation, moment))
        i = tree[i].parent
        for index, other in tree[i].columns():
            C[..., index, k] += column.dot(other)
            C[..., k, index] += row.dot(V[i].cross(other)) + dot(moment, other.angular)
