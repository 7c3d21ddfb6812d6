"""The centroidal momentum matrix of trees of revolute joints on a floating base, as stages, for one sample.

The frame, the symbols and the source are those of columns_in_one_frame.py. The columns of the base have a closed form,
so tables have columns for the joints only:

| symbol | meaning | shape | unit |
|---|---|---|---|
| T | pose in the frame of the base of a joint's frame whose last axis is that of the joint | (12) | [m] |
| own | first and second moment of a body, regrouped | (9) | [kg m, kg m^2] |
| sums | the same of all bodies from a joint outward | (9) | [kg m, kg m^2] |
| c_G, R | centre of mass in the frame of the base; rotation from there to the world | (3), (9) | [m] |

A regrouped body behind a revolute joint has no mass, no first moment along the axis, and one second moment less; the
rows of such numbers are left out. With the axis a through the point p, a column is

    linear: a x c,    angular: I a + c x (p x a) - c_G x linear,    both turned to the world.

A column of the base is m R e or, of a rotation, R (e x c) and R I_G e, with the moments c and I_G of the whole robot.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ulna.algorithms.derivatives.columns_in_one_frame import about, moment_numbers, moments
from ulna.algorithms.multibody.chain_frames import pose_numbers, pose_of
from ulna.algorithms.multibody.prepared_model import PreparedModel, prepare
from ulna.algorithms.multibody.tree import Step
from ulna.compiler.forms.stages import Beside, StagedForm, Stages
from ulna.model import FreeFlyer, Model
from ulna.numeric import cross
from ulna.spatial import SE3, Motion
from ulna.typing import Array

_BASE = 6
"""Velocities of the base, which are the first ones."""
_FEWEST = 16
"""Joints from which on no register holds more columns."""


def centroidal_matrix_of_floating_base(model: Model) -> StagedForm | None:
    """The centroidal momentum matrix.

    Args:
        model: A robot with mass that suits one frame.

    Returns:
        The form; None for robots other than trees of revolute joints on a floating base.
    """
    prepared = prepare(model)
    root, *joints = prepared.tree
    if not isinstance(root.kind, FreeFlyer) or root.indices != range(_BASE) or len(joints) < _FEWEST:
        return None
    if any(step.parent < 0 for step in joints) or any(body.mass for body in prepared.regrouped_moments[1:]):
        return None
    turned = [axes for axes in map(_axes_of_joint, joints) if axes is not None]
    return _form(prepared, turned) if len(turned) == len(joints) else None


def _axes_of_joint(step: Step) -> Array | None:
    """The axes of a frame whose last one is that of the joint; None if it does not turn about an axis of its frame."""
    (_, s), *more = step.columns()
    axis = np.asarray(s.angular, dtype=float)
    if more or np.any(s.linear) or np.count_nonzero(axis) != 1 or abs(axis.sum()) != 1.0:
        return None
    k = int(np.abs(axis).argmax())
    across = [np.eye(3)[(k + 1) % 3], np.eye(3)[(k + 2) % 3]]
    return np.stack([*(across if axis.sum() > 0.0 else across[::-1]), axis], axis=1)


def _form(prepared: PreparedModel, turned: Sequence[Array]) -> StagedForm:
    """The stages, with the axes of each joint."""
    model, count = prepared.model, len(turned)
    stages = Stages("centroidal_matrix", model.nv, q=(model.nq,))
    stages.straight(_poses(prepared.tree, turned), ("q",), ("T", "R"))
    bodies = _bodies(prepared, turned)
    is_there = bodies.any(axis=1)
    stages.constant("bodies", bodies[is_there])

    def of_body(T: Array, bodies: Array) -> Array:
        known = np.zeros(9, dtype=object)
        known[is_there] = bodies
        return moment_numbers(moments(0.0, known).to_outer_frame(pose_of(T)))

    stages.lanes(of_body, ("T", "bodies"), ("own",), count)
    stages.rows(_summed(prepared.tree), ("own",), "sums")
    stages.straight(_of_base(prepared), ("sums", "R"), ("c_G", "of_base"))

    def of_column(T: Array, sums: Array, c_G: Array, R: Array) -> Array:
        axis = T[[2, 5, 8]]
        h = moments(0.0, sums).apply(Motion(cross(T[9:], axis), axis))
        return about(h, c_G, R.reshape(3, 3))

    stages.lanes(of_column, ("T", "sums", "c_G", "R"), ("of_joints",), count)
    return stages.form(Beside(("of_base", "of_joints")))


def _column(step: Step) -> int:
    """The column of a joint in the tables."""
    return step.indices[0] - _BASE


def _poses(tree: Sequence[Step], turned: Sequence[Array]) -> Callable[[Array], tuple[Array, Array]]:
    """T of every joint, and R."""

    def poses(q: Array) -> tuple[Array, Array]:
        T, found = np.zeros((12, len(turned)), dtype=object), [SE3.identity()]
        for step, axes in zip(tree[1:], turned, strict=True):
            pose = step.pose(found[step.parent], q)
            T[:, _column(step)] = pose_numbers(SE3(pose.rotation @ axes, pose.translation))
            found.append(pose)
        return T, tree[0].pose(None, q).rotation.reshape(-1)

    return poses


def _bodies(prepared: PreparedModel, turned: Sequence[Array]) -> Array:
    """The moments of the bodies behind the joints, along the axes of the joints, shape (9, joints)."""
    bodies = np.zeros((9, len(turned)))
    for step, axes, body in zip(prepared.tree[1:], turned, prepared.regrouped_moments[1:], strict=True):
        bodies[:, _column(step)] = moment_numbers(body.to_outer_frame(SE3(axes.T, np.zeros(3))))
    return bodies


def _summed(tree: Sequence[Step]) -> Callable[[Array], Array]:
    """The sums over all bodies from a joint outward of one of their numbers."""

    def sums(own: Array) -> Array:
        totals = own.copy()
        for step in reversed(tree[1:]):
            if step.parent > 0:
                parent = _column(tree[step.parent])
                totals[parent] = totals[parent] + totals[_column(step)]
        return totals

    return sums


def _of_base(prepared: PreparedModel) -> Callable[[Array, Array], tuple[Array, Array]]:
    """The centre of mass, and the columns of the base, from the sums of the joints that it carries."""
    base = prepared.regrouped_moments[0]
    carried = [_column(step) for step in prepared.tree[1:] if step.parent == 0]

    def of_base(sums: Array, R: Array) -> tuple[Array, Array]:
        whole = moments(base.mass, moment_numbers(base) + sums[:, carried].sum(axis=1))
        c_G, rotation = whole.first * (1.0 / base.mass), R.reshape(3, 3)
        turns = [about(whole.apply(Motion(np.zeros(3), e)), c_G, rotation) for e in np.eye(3)]
        moves = np.concatenate([base.mass * rotation, np.zeros((3, 3))])
        return c_G, np.concatenate([moves, np.stack(turns, axis=1)], axis=1)

    return of_base
