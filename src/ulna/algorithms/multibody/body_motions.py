"""Velocities and accelerations of the bodies, each in its own moving frame.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| V_i | twist of body i | Motion | [m/s, rad/s] | V_i = X_i^-1 V_p + S_i v_i, V_0 = 0 |
| A_i | its spatial acceleration | Motion | [m/s^2, rad/s^2] | A_i = X_i^-1 A_p + V_i x S_i v_i + S_i a_i |

Source: Featherstone 2008, section 5.3, with S constant.
"""

from __future__ import annotations

from collections.abc import Sequence

from ulna.algorithms.multibody.tree import Step, outward
from ulna.spatial import Motion
from ulna.typing import Array


def body_velocities(tree: Sequence[Step], q: Array, v: Array) -> list[Motion]:
    """V of every step.

    Args:
        tree: The steps, parents first.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].

    Returns:
        V of every step, each in its own moving frame [m/s, rad/s].
    """
    return outward(tree, Motion.zero(), lambda step, V: step.motion_from_parent(V, q) + step.motion(v))


def body_accelerations(
    tree: Sequence[Step], q: Array, v: Array, a: Array | None, A_0: Motion | None = None
) -> list[tuple[Motion, Motion]]:
    """V and A of every step.

    Args:
        tree: The steps, parents first.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        a: Acceleration, shape (..., nv) [rad/s^2, m/s^2]; None for zero.
        A_0: Acceleration of the world, minus that of gravity where it counts [m/s^2, rad/s^2]; None for zero.

    Returns:
        V and A of every step, each in its own moving frame [m/s, rad/s], [m/s^2, rad/s^2].
    """

    def advance(step: Step, parent: tuple[Motion, Motion]) -> tuple[Motion, Motion]:
        v_J = step.motion(v)
        V = step.motion_from_parent(parent[0], q) + v_J
        A = step.motion_from_parent(parent[1], q) + V.cross(v_J)
        return V, A if a is None else A + step.motion(a)

    return outward(tree, (Motion.zero(), Motion.zero() if A_0 is None else A_0), advance)
