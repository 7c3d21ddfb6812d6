"""Forward dynamics with few operations: articulated bodies with accelerations counted from those of locked joints.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| A_0, F_0 | acceleration of a body, and the force on it, where a = 0 | | | see rnea_point_accelerations.py |
| I^A | articulated-body inertia | Articulated | | see articulated_inertia.py |
| F^A | force on a body at A_0, the joints beyond it free | Force | [N, N m] | F_0 + sum of children's F^a |
| s, k | a column of S_i, the entry of v it belongs to | | | |
| u, D | I^A s, s.u + armature | Force, () | | |
| g | acceleration of the joint where the parent's is A_0 | () | [rad/s^2] or [m/s^2] | (tau_k - s.F^A) / D |
| F^a | the force that the parent transmits | Force | | F^A + u g, with I^a = I^A - u u^T / D |
| Y | acceleration of the body less A_0 | Motion | | Y = X^-1 Y_p, then Y + s a for each column |
| a | joint acceleration | (nv) | | a_k = g - u.Y / D |

Derivation from aba.py, table 7.1 of Featherstone 2008: that table starts from V x* I V and adds I^a c at every joint.
With A = A_0 + Y, where A_0 is the acceleration of the body with all joints locked at their velocities, the force on a
body is I A + V x* I V = F_0 + I Y: all products of velocities and gravity are in F_0, which is found once, by the
recursion of inverse dynamics. The relation between Y of neighbouring bodies has no c, so that the other two passes are
those of a robot at rest without gravity. A step with several columns is passed column by column, as that many joints at
one place with no mass between them; S is constant, so that no derivative of S appears, and no matrix D is inverted. The
frames are those of link_frames.py, and the inertias are regrouped, which keeps the joint accelerations. A mimic joint
couples two places of the tree, which no recursion over the tree can do.

Source: Featherstone 2008, section 7.3. `tests/laws/test_textbook_dynamics_laws.py` shows that it is equal to `aba`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ulna.algorithms.dynamics.articulated_inertia import Articulated
from ulna.algorithms.dynamics.mass_matrix_factors import inverse_pivot, is_zero
from ulna.algorithms.dynamics.rnea_point_accelerations import newton_euler, point_motions, subtract_external
from ulna.algorithms.multibody.batch_shapes import batch_zeros
from ulna.algorithms.multibody.external_forces import External
from ulna.algorithms.multibody.mass_moments import MassMoments, rotation_axis
from ulna.algorithms.multibody.prepared_model import prepare
from ulna.algorithms.multibody.tree import Step, shares_velocities
from ulna.errors import InputError
from ulna.model import Model
from ulna.spatial import Force, Motion
from ulna.typing import Array


class _Column(NamedTuple):
    """What the pass outward needs of a column."""

    k: int
    s: Motion
    u: Force
    reciprocal: Any
    g: Any


def articulated_body_dynamics(
    model: Model, q: Array, v: Array, tau: Array, external: External = None
) -> Array:
    """The joint accelerations, by the form that is compiled; equal to `aba`.

    Args:
        model: The robot, without mimic joints.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        tau: Joint torques, shape (..., nv) [N m, N].
        external: Forces on the bodies [N, N m]; None for none.

    Returns:
        Joint accelerations, shape (..., nv) [rad/s^2, m/s^2].

    Raises:
        InputError: The model has mimic joints; `forward_dynamics` takes them.
        ZeroPivot: A motion moves no inertia, whatever the inputs.
    """
    check_no_mimics(model)
    prepared = prepare(model)
    tree, bodies = prepared.tree, prepared.regrouped_moments
    locked = point_motions(tree, q, v, None, -np.asarray(model.gravity))
    forces = subtract_external(prepared, newton_euler(bodies, locked), external)
    columns = _inward(tree, q, tau, bodies, forces, model.armature)
    a = batch_zeros((model.nv,), q, v, tau, external)
    relative: list[Motion] = []
    for i, step in enumerate(tree):
        Y = step.motion_from_parent(relative[step.parent], q) if step.parent >= 0 else Motion.zero()
        for column in reversed(columns[i]):
            a_k = column.g - column.reciprocal * Y.dot(column.u)
            a[..., column.k] = a_k
            Y = Y + column.s * a_k
        relative.append(Y)
    return a


def check_no_mimics(model: Model) -> None:
    """Raises InputError where a model has mimic joints or ellipsoids."""
    if shares_velocities(model):
        raise InputError(
            "The articulated-body algorithm takes no mimic joints and no ellipsoids; use forward_dynamics, which "
            "solves with the mass matrix for such models."
        )


def _inward(
    tree: Sequence[Step],
    q: Array,
    tau: Array,
    bodies: Sequence[MassMoments],
    forces: list[Force],
    armature: Array,
) -> list[list[_Column]]:
    """The columns of every step, with their u, 1 / D and g."""
    inertias = [Articulated.of(body) for body in bodies]
    columns: list[list[_Column]] = [[] for _ in tree]
    for i, step in reversed(list(enumerate(tree))):
        inertia, force = inertias[i], forces[i]
        for k, s in step.columns():
            u = inertia.apply(s)
            reciprocal = inverse_pivot(s.dot(u) + armature[k], k)
            g = (tau[..., k] - s.dot(force)) * reciprocal
            columns[i].append(_Column(k, s, u, reciprocal, g))
            inertia, force = inertia.less(u, reciprocal, s, is_zero(armature[k])), force + u * g
        if step.parent >= 0:
            T = step.transform(q)
            outer = inertia.to_outer_frame(T, rotation_axis(step.kind)).to_outer_frame(step.placement)
            inertias[step.parent] = inertias[step.parent] + outer
            forces[step.parent] = forces[step.parent] + step.placement.act(T.act(force))
    return columns
