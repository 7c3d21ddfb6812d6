"""Forward dynamics by the articulated-body algorithm: the accelerations that torques give.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| A_0, F_0 | acceleration of a body, the force on it, if no joint accelerated | | | rnea.py outward, a = 0 |
| I^A | articulated-body inertia | Articulated | | see articulated.py |
| F^A | holds a body to A_0 while the joints beyond give way | Force | [N, N m] | F_0 + sum of children's F^a |
| s, k | a column of S_i, its place in v | | | |
| u, D | I^A s, s.u + armature | Force, () | | |
| g | acceleration of the joint if its parent kept A_0 | () | [rad/s^2] or [m/s^2] | (tau_k - s.F^A) / D |
| F^a | what the parent feels of it | Force | | F^A + u g, then I^A less u u^T / D |
| Y | acceleration beyond A_0 | Motion | | Y = Y_p seen from the step, + s a |
| a | joint acceleration | (nv) | | a_k = g - u.Y / D |

Source: Featherstone 2008, section 7.3, algorithm of table 7.1. Counting accelerations from A_0 leaves no products of
velocities in the two last passes. A step with several columns is passed column by column, as that many joints at one
place: the mass between them is zero, and S is constant. The frames are those of link_frames.py, and the inertias
those a joint can feel. A mimic joint ties two places of the tree together, which no recursion over the tree can do.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ulna.algorithms.dynamics.articulated_inertia import Articulated
from ulna.algorithms.dynamics.crba import columns_of
from ulna.algorithms.dynamics.mass_matrix_factors import inverted, is_zero
from ulna.algorithms.dynamics.rnea import less_external, rates, wrench
from ulna.algorithms.multibody.external_forces import External, batches
from ulna.algorithms.multibody.link_frames import tidy
from ulna.algorithms.multibody.mass_moments import felt, turning_axis
from ulna.algorithms.multibody.tree import blank
from ulna.errors import InputError
from ulna.model import Model
from ulna.spatial import Force, Motion
from ulna.typing import Array


class _Column(NamedTuple):
    """What the pass outward needs of a column."""

    index: int
    s: Motion
    u: Force
    reciprocal: Any
    g: Any


def aba(model: Model, q: Array, v: Array, tau: Array, external: External = None) -> Array:
    """The joint accelerations, shape (..., nv) [rad/s^2 or m/s^2].

    Args:
        model: The robot, without mimic joints.
        q: Configuration, shape (..., nq).
        v: Velocity, shape (..., nv).
        tau: Joint torques, shape (..., nv) [N m or N].
        external: Forces on the bodies.

    Raises:
        InputError: the model has mimic joints; `forward_dynamics` takes them.
        ZeroPivot: A motion moves no inertia, whatever the inputs.
    """
    if any(joint.mimic is not None for joint in model.joints):
        raise InputError(
            "The articulated-body algorithm takes no mimic joints; use forward_dynamics, which solves with the mass "
            "matrix for such models."
        )
    tidied = tidy(model)
    tree, bodies = tidied.tree, felt(model, tidied)
    held = rates(tree, q, v, None, -np.asarray(model.gravity))
    forces = [wrench(body, rate) for body, rate in zip(bodies, held, strict=True)]
    forces = less_external(model, tidied, forces, external)
    inertias = [Articulated.of(body) for body in bodies]
    passed: list[list[_Column]] = [[] for _ in tree]
    for i, step in reversed(list(enumerate(tree))):
        inertia, force = inertias[i], forces[i]
        for k, s in columns_of(step):
            u = inertia.apply(s)
            reciprocal = inverted(s.dot(u) + model.armature[k], k)
            g = (tau[..., k] - s.dot(force)) * reciprocal
            passed[i].append(_Column(k, s, u, reciprocal, g))
            inertia, force = inertia.less(u, reciprocal, s, is_zero(model.armature[k])), force + u * g
        if step.parent >= 0:
            T = step.transform(q)
            inward = inertia.moved(T, turning_axis(step.kind)).moved(step.placement)
            inertias[step.parent] = inertias[step.parent] + inward
            forces[step.parent] = forces[step.parent] + step.placement.act(T.act(force))
    a = blank((model.nv,), q, v, tau, *batches(external))
    beyond: list[Motion] = []
    for i, step in enumerate(tree):
        Y = step.carry(beyond[step.parent], q) if step.parent >= 0 else Motion(np.zeros(3), np.zeros(3))
        for column in reversed(passed[i]):
            value = column.g - column.reciprocal * Y.dot(column.u)
            a[..., column.index] = value
            Y = Y + column.s * value
        beyond.append(Y)
    return a
