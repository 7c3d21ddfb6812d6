"""The tree of a model as arrays, which procedures loop over.

| symbol | meaning | shape | unit |
|---|---|---|---|
| i | a step of `algorithms/multibody/tree.py`, in row i + 1; row 0 is the world | | |
| P | placement of a step's fixed frame in its parent's moving frame | SE3 | [m] |
| L | placement of its moving frame in its fixed frame | SE3 | [m] |
| X | P L: rotation A0 + A1 cos + A2 sin, translation p0 + D0 u + D1 w, of an angle and two lengths u, w | SE3 | [m] |
| S | columns of motion subspaces in the moving frame, times the multiplier of their step | (columns, 6) | |

Rodrigues' formula is linear in 1, cos and sin; so P and the axis of a joint are multiplied once, for the table.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ulna.algorithms.multibody.tree import Step, steps
from ulna.compiler.procedures import Array1, Array2, f64
from ulna.model import (
    Circle,
    Frame,
    FreeFlyer,
    Helical,
    JointKind,
    Model,
    Planar,
    PlanarCircle,
    Prismatic,
    Revolute,
    Spherical,
    Translation,
)
from ulna.model.constraint import End
from ulna.spatial import SE3
from ulna.typing import Floats

INT = np.int64

TURN, SLIDE, PAIR, PLANE, PLANE_PAIR, SPACE, BALL, FREE = range(8)
"""How a step reads q: an angle; a length; a cosine and a sine; two lengths and an angle; two lengths, a cosine and a
sine; three lengths; a quaternion; three lengths and a quaternion."""

RATIO, OFFSET = 36, 37
"""The columns of `TreeTable.fixed` that hold `Step.multiplier` and `Step.shift`."""


class TreeTable(NamedTuple):
    """The steps, parents first; row 0 is the world.

    Attributes:
        parents: The row of the parent, (rows,).
        kinds: How it reads q, (rows,).
        starts: Where its part of q begins, (rows,).
        columns: Where its columns of S begin, and where the last ones end, (rows + 1,).
        entries: The entry of v that a column belongs to, (columns,).
        ends: Where the columns of all steps from a step outward end, (rows,).
        fixed: A0, A1, A2 by rows (9 each), p0, D0, D1 (3 each), multiplier, offset, (rows, 38).
        S: (columns, 6).
        inertias: Mass, mass times centre, moments xx, xy, xz, yy, yz, zz about the frame's origin, (rows, 10).
        armature: (nv,) [kg m^2 or kg].
        gravity: The acceleration of free fall in the world, (3,) [m/s^2].
    """

    parents: Array1[INT]
    kinds: Array1[INT]
    starts: Array1[INT]
    columns: Array1[INT]
    entries: Array1[INT]
    ends: Array1[INT]
    fixed: Array2[f64]
    S: Array2[f64]
    inertias: Array2[f64]
    armature: Array1[f64]
    gravity: Array1[f64]


class UnknownKind(Exception):
    """A joint is of a kind that tables do not have."""


def tree_table(model: Model, joints: Sequence[int] | None = None) -> TreeTable:
    """The table of some joints of a model, or of all; the last ones that were made are kept.

    Args:
        model: The robot.
        joints: Ascending indices; with every joint, its ancestors; None for all.

    Returns:
        The table, which procedures only read.

    Raises:
        UnknownKind: If a joint is of a kind that tables do not have.
    """
    is_whole = joints is None or len(joints) == len(model.joints)
    return _tree_table(model, None if is_whole or joints is None else tuple(joints))


@lru_cache(maxsize=8)
def _tree_table(model: Model, joints: tuple[int, ...] | None) -> TreeTable:
    tree = steps(model, joints)
    columns = [step.columns() for step in tree]
    rows = [_fixed(step) for step in tree]
    counts = [0, 0, *np.cumsum([len(part) for part in columns]).tolist()]
    return TreeTable(
        _integers([0, *(step.parent + 1 for step in tree)]),
        _integers([SLIDE, *(kind_code(step.kind) for step in tree)]),
        _integers([0, *(step.joint.idx_q + step.start_q for step in tree)]),
        _integers(counts),
        _integers([entry for part in columns for entry, _ in part]),
        _ends(tree, counts),
        np.concatenate([_world_row(), *rows]).reshape(-1, 38),
        np.array([s.vector() for part in columns for _, s in part], float).reshape(-1, 6),
        _inertias(model, tree),
        np.array(model.armature, float),
        np.array(model.gravity, float),
    )


def has_mimics(model: Model, tree: TreeTable) -> bool:
    """Whether some joint mimics another: entries of v are not those of the columns, in order.

    Args:
        model: The robot.
        tree: Its whole table.

    Returns:
        Whether there is such a joint.
    """
    return not np.array_equal(tree.entries, np.arange(model.nv))


def carriers(model: Model, frames: Sequence[Frame | End]) -> tuple[TreeTable, Mapping[int, int]]:
    """The table of the joints that carry frames, and the rows of joints.

    Args:
        model: The robot.
        frames: The frames.

    Returns:
        The table of these joints and of those between them and the world, and their rows by joint.
    """
    needed: set[int] = set()
    for first in {frame.joint for frame in frames}:
        joint = first
        while joint >= 0 and joint not in needed:
            needed.add(joint)
            joint = model.joints[joint].parent
    joints = None if len(needed) == len(model.joints) else tuple(sorted(needed))
    return tree_table(model, joints), step_rows(model, joints)


def free_columns(tree: TreeTable) -> TreeTable:
    """The table of the robot whose every column has its own entry of velocity; without armature.

    Args:
        tree: The whole table of a model.

    Returns:
        The table; columns stay times the multiplier of their step.
    """
    columns = len(tree.entries)
    return tree._replace(entries=np.arange(columns), armature=np.zeros(columns))


@lru_cache(maxsize=8)
def step_rows(model: Model, joints: tuple[int, ...] | None = None) -> Mapping[int, int]:
    """The row of the moving frame of each joint; that of -1, the world, is 0.

    Args:
        model: The robot.
        joints: As for `tree_table`.

    Returns:
        Rows by the indices of joints.
    """
    last = {step.joint.name: row for row, step in enumerate(steps(model, joints), start=1)}
    places = {name: index for index, name in enumerate(model.joint_names)}
    return {-1: 0} | {places[name]: row for name, row in last.items()}


def _integers(values: Sequence[int]) -> np.ndarray:
    return np.array(values, INT)


def _world_row() -> Floats:
    row = np.zeros(38)
    row[[0, 4, 8]] = 1.0
    return row


def kind_code(kind: JointKind) -> int:
    """How a joint of a kind reads q; raises UnknownKind where tables do not have it."""
    match kind:
        case Revolute() | Helical():
            return TURN
        case Prismatic():
            return SLIDE
        case Circle():
            return PAIR
        case Planar():
            return PLANE
        case PlanarCircle():
            return PLANE_PAIR
        case Translation():
            return SPACE
        case Spherical():
            return BALL
        case FreeFlyer():
            return FREE
    raise UnknownKind(kind.name)


def _fixed(step: Step) -> Floats:
    return fixed_row(step.kind, step.placement, step.multiplier, step.shift)


def fixed_row(kind: JointKind, P: SE3, multiplier: float = 1.0, offset: float = 0.0) -> Floats:
    """A row of `TreeTable.fixed`.

    Args:
        kind: The kind of the step.
        P: Placement of its fixed frame in its parent's moving frame [m].
        multiplier: `Step.multiplier` [-].
        offset: `Step.shift` [rad or m].

    Returns:
        The row, (38,).
    """
    code = kind_code(kind)
    row = np.zeros(38)
    R = np.asarray(P.rotation, float)
    A0, A1, A2, directions = R, np.zeros((3, 3)), np.zeros((3, 3)), np.zeros((2, 3))
    if code in (TURN, PAIR, PLANE, PLANE_PAIR):
        x, y, z = axis = np.array(getattr(kind, "normal", getattr(kind, "axis", None)))
        along = np.outer(axis, axis)
        A0, A1 = R @ along, R @ (np.eye(3) - along)
        A2 = R @ np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        directions[0] = getattr(kind, "pitch", 0.0) * axis
    if isinstance(kind, Prismatic):
        directions[0] = kind.axis
    if code in (PLANE, PLANE_PAIR):
        plane = kind if isinstance(kind, Planar) else Planar(getattr(kind, "normal", (0.0, 0.0, 1.0)))
        directions = np.array(plane.axes)
    for k, part in enumerate((A0, A1, A2)):
        row[9 * k : 9 * k + 9] = part.reshape(9)
    row[27:30], row[30:33], row[33:36] = P.translation, R @ directions[0], R @ directions[1]
    row[RATIO], row[OFFSET] = multiplier, offset
    return row


def _ends(tree: Sequence[Step], counts: Sequence[int]) -> np.ndarray:
    """Where the columns end that each step moves; the columns of a subtree are one range, as joints are depth first."""
    ends = np.array([counts[-1], *counts[2:]], INT)
    for row in range(len(tree), 0, -1):
        parent = tree[row - 1].parent + 1
        ends[parent] = max(ends[parent], ends[row])
    return ends


def _inertias(model: Model, tree: Sequence[Step]) -> Floats:
    """Rows of `TreeTable.inertias`; the inner parts of a joint carry no body."""
    out = np.zeros((len(tree) + 1, 10))
    places = {name: index for index, name in enumerate(model.joint_names)}
    for row, step in enumerate(tree, start=1):
        if step.is_last:
            body = model.inertias[places[step.joint.name]]
            out[row, 0], out[row, 1:4] = body.mass, body.first_moment()
            out[row, 4:] = np.asarray(body.about_origin()).reshape(9)[[0, 1, 2, 4, 5, 8]]
    return out


def matrices_as_rows(poses: Sequence[SE3]) -> Floats:
    """Poses as rows (n, 12): rotation by rows, then translation [m]."""
    rows = [np.concatenate([np.ravel(T.rotation), T.translation]) for T in poses]
    return np.array(rows, float).reshape(-1, 12)
