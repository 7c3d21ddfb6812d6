"""The regressors of torques as stages in one frame, for one sample.

The symbols and the frame are those of dynamics/regressors.py and columns_in_one_frame.py. What is computed is that of
regressors.py, which remains the definition: `tests/laws/test_staged_laws.py` compares.

| symbol | meaning | shape | unit |
|---|---|---|---|
| R, o | axes and origin of the frame of a body, in the common frame; r_i: a column of R | (3, 3), (3) | | |
| w, e, a | angular velocity and acceleration of the body, acceleration of o | (3) | |
| W_p | wrench that a body needs for one unit of its parameter p, in the common frame | Force | |
| Y | entry of row k and parameter p of a body that s_k moves: s_k . W_p | (nv, 10 nbodies) | |

Ten wrenches a body, of which the force acts at o:

    m           a
    m c_i       e x r_i + w x (w x r_i), and the moment r_i x a
    I_ij        the moment r_i (r_j . e) + (w x r_i) (r_j . w), and the same with i and j exchanged where they differ

In the order of columns of Y, parameters of a body follow each other: tables of ten parameters with one column for each
velocity become one table with ten columns for each body. An entry is then one scalar product, of a register of
parameters at a time, and rows of Y are written as they lie.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.algorithms.derivatives.columns_in_one_frame import OneFrame, suits_one_frame
from ulna.algorithms.dynamics.regressors import PARAMETERS
from ulna.compiler.forms.stages import StagedForm
from ulna.model import Model
from ulna.numeric import apply, cross, dot
from ulna.spatial import Motion
from ulna.typing import Array

_INERTIAS = ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2))
"""The axes of the moments of inertia, in the order of parameters."""


def stages_of_joint_torque_regressor(model: Model) -> StagedForm | None:
    """The regressor of inverse dynamics.

    Args:
        model: The robot.

    Returns:
        The form; None for robots that need another one.
    """
    if not suits_one_frame(model):
        return None
    frame = OneFrame("joint_torque_regressor", model, q=(model.nq,), v=(model.nv,), a=(model.nv,))
    frame.kinematics()
    frame.accelerations("a")

    def of_body(T: Array, place: Array, V: Array, A: Array) -> tuple[Array, ...]:
        R, o = _pose(T, place)
        w, e = V[3:], A[3:]
        a = A[:3] + cross(e, o) + cross(w, V[:3] + cross(w, o))
        axes = [R[:, i] for i in range(3)]
        turned = [cross(w, r) for r in axes]
        wrenches = [_at(o, a)]
        for r, change in zip(axes, turned, strict=True):
            wrenches.append(_at(o, cross(e, r) + cross(w, change), cross(r, a)))
        along = [(dot(r, e), dot(r, w)) for r in axes]
        for i, j in _INERTIAS:
            moment = axes[i] * along[j][0] + turned[i] * along[j][1]
            if i != j:
                moment = moment + axes[j] * along[i][0] + turned[j] * along[i][1]
            wrenches.append(np.concatenate([np.zeros(3), moment]))
        return tuple(wrenches)

    return _regressor(frame, of_body, ("V", "A"), len(PARAMETERS))


def stages_of_gravity_regressor(model: Model) -> StagedForm | None:
    """The regressor at rest.

    Args:
        model: The robot.

    Returns:
        The form; None for robots that need another one.
    """
    if not suits_one_frame(model):
        return None
    frame = OneFrame("gravity_regressor", model, q=(model.nq,))
    frame.poses()
    gravity = np.asarray(model.gravity)
    frame.stages.straight(lambda q: -apply(np.swapaxes(frame.rotation(q), -1, -2), gravity), ("q",), ("up",))

    def of_body(T: Array, place: Array, up: Array) -> tuple[Array, ...]:
        R, o = _pose(T, place)
        return _at(o, up), *(np.concatenate([np.zeros(3), cross(R[:, i], up)]) for i in range(3))

    return _regressor(frame, of_body, ("up",), 4)


def _pose(T: Array, place: Array) -> tuple[Array, Array]:
    """R and o of a body, from the pose of the moving frame of its step and its pose there."""
    turn = T[:9].reshape(3, 3)
    return turn @ place[:9].reshape(3, 3), T[9:] + apply(turn, place[9:])


def _at(o: Array, force: Array, moment: Any = 0.0) -> Array:
    """A force at a point, and a moment, as a wrench about the origin."""
    return np.concatenate([force, cross(o, force) + moment])


def _regressor(frame: OneFrame, of_body: Any, reads: tuple[str, ...], count: int) -> StagedForm:
    """The form from wrenches for the first parameters of a body; for the others they are zero.

    Args:
        frame: The stages, with T, s and what is read.
        of_body: From T, a pose in the moving frame, and what is read, to the wrenches.
        reads: Names of tables or vectors.
        count: For how many parameters there are wrenches; all, or those of bodies at rest.

    Returns:
        The form.
    """
    model, stages, is_at_rest = frame.model, frame.stages, count < len(PARAMETERS)
    carriers = [frame.carrier(k) for k in range(len(model.joints))]
    columns = [frame.tree[carrier].indices[-1] for carrier in carriers]
    places, turns = np.zeros((12, model.nv)), np.zeros(model.nv, dtype=bool)
    for step in frame.tree:
        for k, s in step.columns():
            turns[k] = np.any(s.angular)
    pattern = np.zeros((model.nv, len(columns), len(PARAMETERS)), dtype=bool)
    for body, (carrier, column) in enumerate(zip(carriers, columns, strict=True)):
        pose = frame.prepared.frames[carrier].inverse()
        places[:, column] = [*pose.rotation.reshape(-1), *pose.translation]
        movers = frame.movers[column]
        pattern[movers, body, :count] = turns[movers, None]
        pattern[movers, body, : 1 if is_at_rest else 4] = True
        for k, s in frame.tree[carrier].columns():
            pattern[k, body, :count] = _own_entries(pose.act_inverse(s), is_at_rest)[:count]
    stages.constant("places", places)
    names = [f"W_{k}" for k in range(count)]
    stages.lanes(of_body, ("T", "places", *reads), names)

    def in_order(*rows: Array) -> Array:
        ordered = np.zeros((len(columns), len(PARAMETERS)), dtype=object)
        for k, row in enumerate(rows):
            ordered[:, k] = row[columns]
        return ordered.reshape(-1)

    stages.rows(in_order, names, "W")
    stages.products(dot, ("s",), ("W",), pattern.reshape(model.nv, -1), "Y")
    return stages.form("Y")


def _own_entries(s: Motion, is_at_rest: bool) -> list[bool]:
    """Which entries of a column are not zero for the body of its own joint, in whose frame it is given."""
    turns, moves = np.any(s.angular), np.any(s.linear)
    first = [(moves and not is_at_rest) or np.any(np.cross(s.angular, axis)) for axis in np.eye(3)]
    return [bool(x) for x in (moves, *first, *[turns] * len(_INERTIAS))]
