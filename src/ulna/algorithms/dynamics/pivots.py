"""Whether the mass matrix of a large model can be inverted: the articulated inertia that each entry of v moves.

| symbol | meaning | shape | unit |
|---|---|---|---|
| G | articulated inertia of a step, in world axes about its origin | (6, 6) | [kg], [kg m], [kg m^2] |
| s | column of S, in world axes | (6,) | [1] or [m/rad] |
| d | pivot of the factors of the mass matrix: s . G s plus armature | () | [kg], [kg m^2] |
| D | size of the sums whose difference d is | () | [kg], [kg m^2] |

`conditioning.py` examines all motions, in a time that grows with the cube of the joints; this takes time in proportion
to them, and finds a motion that moves no inertia by its pivot, which is zero. D / d is a lower bound of the condition
number. Source: Featherstone 2008, table 7.1.
"""

from __future__ import annotations

import numpy as np

from ulna.algorithms.dynamics.conditioning import Conditioning
from ulna.algorithms.multibody.tree import Step, poses, shares_velocities, steps
from ulna.errors import ModelError
from ulna.model import Model
from ulna.numeric.arrays import skew
from ulna.spatial import SE3, Inertia
from ulna.typing import Floats

_ROUNDING = 64.0 * np.finfo(float).eps


class ZeroPivot(ModelError):
    """A motion moves no inertia, whatever the inputs: a matrix that depends on nothing there cannot be inverted."""

    def __init__(self, index: int) -> None:
        self.index = index
        super().__init__(
            f"Entry {index} of v moves no inertia, and its drive has no armature, so that forces accelerate it without "
            "bound. Lock the joint, or give it inertia or armature."
        )


def conditioning_by_pivots(model: Model, q: Floats) -> Conditioning:
    """How well the mass matrix of a large model can be inverted, estimated from its pivots.

    Args:
        model: The robot. With mimic joints or ellipsoids nothing is found.
        q: Configuration, shape (nq,) [rad, m].

    Returns:
        The first velocity, from the tips on, that moves no inertia; a lower bound of the condition number; and the
        velocity that moves the least for its size.
    """
    if not model.nv or shares_velocities(model):
        return Conditioning((), 1.0, ())
    d, D = _pivots(model, q)
    zero = np.flatnonzero(np.abs(d) <= _ROUNDING * D)
    if len(zero):
        return Conditioning((int(zero[-1]),), np.inf, (int(zero[-1]),))
    slender = D / np.abs(d)
    return Conditioning((), float(slender.max()), (int(slender.argmax()),))


def _pivots(model: Model, q: Floats) -> tuple[Floats, Floats]:
    """d and D of each entry of v; a joint with a zero pivot counts as locked."""
    tree = steps(model)
    placed = poses(tree, q)
    armature = np.asarray(model.armature, dtype=float)
    d, D = np.zeros(model.nv), np.zeros(model.nv)
    bodies = iter(model.inertias)
    G = np.zeros((len(tree), 6, 6))
    size = np.zeros((len(tree), 2))  # of the translational and rotational entries of what adds up to G
    for i, step in enumerate(tree):
        if step.is_last:
            G[i] = _inertia(next(bodies), placed[i])
    for i in reversed(range(len(tree))):
        step = tree[i]
        traces = np.array([abs(np.trace(G[i, :3, :3])), abs(np.trace(G[i, 3:, 3:]))])
        for k, s in zip(step.indices, _columns(step, placed[i]), strict=True):
            U = G[i] @ s
            d[k] = s @ U + armature[k]
            D[k] = (size[i] + traces) @ (s[:3] @ s[:3], s[3:] @ s[3:]) + abs(armature[k])
            if abs(d[k]) > _ROUNDING * D[k]:
                G[i] -= np.outer(U, U) / d[k]
        if step.parent >= 0:
            arm = placed[i].translation - placed[step.parent].translation
            to_child = np.eye(6)
            to_child[:3, 3:] = -skew(arm)
            G[step.parent] += to_child.T @ G[i] @ to_child
            size[step.parent] += traces + np.array([0.0, traces[0] * (arm @ arm)])
    return d, D


def _inertia(body: Inertia, T: SE3) -> Floats:
    """The inertia of a body about the origin of its joint, in world axes."""
    mass, across = float(body.mass), skew(T.rotation @ body.com)
    out = np.zeros((6, 6))
    out[:3, :3] = mass * np.eye(3)
    out[:3, 3:], out[3:, :3] = -mass * across, mass * across
    out[3:, 3:] = T.rotation @ body.inertia @ T.rotation.T - mass * across @ across
    return out


def _columns(step: Step, T: SE3) -> list[Floats]:
    return [np.concatenate([T.rotation @ s.linear, T.rotation @ s.angular]) for s in step.subspace()]
