"""The table of a model's joints for the procedures of `recursions`, and what depends on the kinds of joints alone."""

from __future__ import annotations

from functools import lru_cache
from typing import Any, NamedTuple, final

import numpy as np

from pinocchio._model.building import KinematicTree
from ulna.model import ElementaryJoint, JointKind
from ulna.recursions.tree_table import INT, OFFSET, RATIO, TreeTable, UnknownKind, fixed_row, kind_code
from ulna.spatial import SE3
from ulna.typing import Floats


class Steps(NamedTuple):
    """The steps without the world, parents first; a step is a joint, or one part of a joint that is made of parts.

    Attributes:
        parents: The parent of each step, -1 for the world, (steps,).
        columns: Where its columns of S begin, (steps + 1,).
        entries: The entry of v that a column belongs to, (columns,).
    """

    parents: Any
    columns: Any
    entries: Any


@final
class JointTable:
    """The steps of a model's joints.

    Attributes:
        tree: What procedures read, without parameters of the model; placements of joints count as the identity.
        table: What is read elsewhere.
        of_joint: For each joint but the universe, the step whose moving frame is the joint's, (njoints - 1,).
        first: For each of them, the step that carries the joint's placement.
        leading: Where the first step of a joint has a placement behind the joint's, its step and that, (4, 4).
    """

    def __init__(self, model: KinematicTree) -> None:
        self._rows: list[tuple[int, int, int, Floats]] = [(0, 0, 0, np.zeros(38))]  # the world
        self._columns: list[tuple[Floats, int]] = []
        self._starts = [0, 0]
        first, last, self.leading = [], [0], {}
        for i in range(1, model.njoints):
            joint, parent = model.joints[i], last[model.parents[i]]
            ratio, offset = joint.mimic[1:] if joint.mimic else (1.0, 0.0)
            first.append(len(self._rows))
            leading, parts = _parts_of(joint.kind)
            if leading is not None:
                self.leading[i - 1] = leading
            for part in parts:
                self._add(part, parent, joint.idx_q, joint.idx_v, ratio, offset)
                parent = len(self._rows) - 1
            last.append(parent)
        self.of_joint, self.first = (np.array(x, INT) - 1 for x in (last[1:], first))
        self.tree = self._as_arrays(model.nv)
        self.table = Steps(self.tree.parents[1:] - 1, self.tree.columns[1:], self.tree.entries)
        del self._rows, self._columns, self._starts

    def _add(self, part: _Part, parent: int, q: int, v: int, ratio: float, offset: float) -> None:
        row, ratio = part.row.copy(), ratio * part.joint.ratio
        row[RATIO], row[OFFSET] = ratio, offset
        self._rows.append((parent, part.code, q + part.joint.start_q, row))
        for k, column in enumerate(part.columns):
            self._columns.append((ratio * column, v + part.joint.start_v + k))
        self._starts.append(len(self._columns))

    def _as_arrays(self, nv: int) -> TreeTable:
        parents, kinds, starts, fixed = zip(*self._rows, strict=True)
        columns, entries = zip(*self._columns, strict=True) if self._columns else ((), ())
        parents, kinds, starts, begins, entries = (
            np.array(x, INT) for x in (parents, kinds, starts, self._starts, entries)
        )
        S, rows = np.array(columns, float).reshape(-1, 6), len(parents)
        no_ranges, parameters = np.zeros(rows, INT), (np.zeros((rows, 10)), np.zeros(nv), np.zeros(3))
        return TreeTable(parents, kinds, starts, begins, entries, no_ranges, np.array(fixed), S, *parameters)

    def placed(self, placements: Floats) -> Floats:
        """`TreeTable.fixed` with the placements of the joints (njoints - 1, 4, 4): R A, p, R D."""
        out, rows, R = self.tree.fixed.copy(), self.first + 1, placements[:, None, :3, :3]
        base = out[rows]
        out[rows, :27] = (R @ base[:, :27].reshape(-1, 3, 3, 3)).reshape(-1, 27)
        out[rows, 27:30] = placements[:, :3, 3]
        out[rows, 30:36] = (R @ base[:, 30:36].reshape(-1, 2, 3, 1)).reshape(-1, 6)
        return out


class _Part(NamedTuple):
    """What depends on the kind of a step alone: its code, its row of `TreeTable.fixed`, its columns (n, 6)."""

    joint: ElementaryJoint
    code: int
    row: Floats
    columns: Floats


@lru_cache(maxsize=256)
def _parts_of(kind: JointKind | None) -> tuple[Floats | None, tuple[_Part, ...]]:
    """The placement before the first elementary joint of a kind, None for the identity, and the elementary joints.

    Raises:
        UnknownKind: Tables do not have one of them.
    """
    joints = () if kind is None else kind.elementary_joints(SE3.identity())
    if not joints:
        raise UnknownKind
    parts, leading = [], np.asarray(joints[0].placement.matrix(), float)
    for k, joint in enumerate(joints):
        place = joint.placement if k else SE3.identity()  # the first one is in the joint's
        columns = [column.vector() for column in joint.kind.motion_subspace(joint.kind.neutral())]
        row = fixed_row(joint.kind, place)
        parts.append(_Part(joint, kind_code(joint.kind), row, np.array(columns, float).reshape(-1, 6)))
    return None if np.array_equal(leading, np.eye(4)) else leading, tuple(parts)


def matrices_of(rows: Floats) -> Floats:
    """The homogeneous matrices (n, 4, 4) of rows (n, 12)."""
    out = np.zeros((len(rows), 4, 4))
    out[:, :3, :3] = rows[:, :9].reshape(-1, 3, 3)
    out[:, :3, 3] = rows[:, 9:]
    out[:, 3, 3] = 1.0
    return out


__all__ = ["JointTable", "Steps", "UnknownKind", "matrices_of"]
