"""The table of a model's joints for the procedures of `recursions`, and what depends on the kinds of joints alone."""

from __future__ import annotations

from typing import final

import numpy as np

from pinocchio._model.building import KinematicTree
from pinocchio._tables import recursions as r
from ulna.model import (
    Circle,
    ElementaryJoint,
    FreeFlyer,
    Helical,
    JointKind,
    PlanarCircle,
    Prismatic,
    Revolute,
    Spherical,
    Translation,
)
from ulna.spatial import SE3
from ulna.typing import Floats

_KINDS: dict[type, int] = {
    Revolute: r.REVOLUTE,
    Helical: r.REVOLUTE,
    Prismatic: r.PRISMATIC,
    Circle: r.CIRCLE,
    Spherical: r.SPHERICAL,
    FreeFlyer: r.FREE_FLYER,
    Translation: r.TRANSLATION,
    PlanarCircle: r.PLANAR_CIRCLE,
}


class UnknownKind(Exception):
    """A joint is of a kind that tables do not have; its model is compiled at once."""


@final
class JointTable:
    """The steps of a model's joints.

    Attributes:
        table: What procedures read.
        of_joint: For each joint but the universe, the step whose moving frame is the joint's, (njoints - 1,).
        first: For each of them, the step that carries the joint's placement.
        inner: Placements of the other steps, (steps, 12).
        leading: Where the first step of a joint has a placement behind the joint's, its step and that, (4, 4).
    """

    def __init__(self, model: KinematicTree) -> None:
        self._rows: list[tuple[int, int, int, list[float]]] = []
        self._columns: list[tuple[list[float], int]] = []
        self._starts = [0]
        first, last, inner, self.leading = [], [-1], [], {}
        for i in range(1, model.njoints):
            joint, parent = model.joints[i], last[model.parents[i]]
            ratio, offset = joint.mimic[1:] if joint.mimic else (1.0, 0.0)
            q, v = joint.idx_q, joint.idx_v
            first.append(len(self._rows))
            for part in _parts(joint.kind):
                place = part.placement.matrix()
                if len(self._rows) == first[-1] and not np.array_equal(place, np.eye(4)):
                    self.leading[i - 1] = place
                inner.append(place)
                self._add(part.kind, parent, q + part.start_q, v + part.start_v, ratio * part.ratio, offset)
                parent = len(self._rows) - 1
            last.append(parent)
        self.of_joint = np.array(last[1:], np.int64)
        self.first = np.array(first, np.int64)
        self.inner = rows_of(np.array(inner).reshape(-1, 4, 4))
        self.table = self._as_arrays()
        del self._rows, self._columns, self._starts

    def _add(self, kind: JointKind, parent: int, q: int, v: int, ratio: float, offset: float) -> None:
        geometry = np.zeros(12)
        geometry[:3] = getattr(kind, "axis", getattr(kind, "normal", (0.0, 0.0, 1.0)))
        geometry[3:6] = getattr(kind, "pitch", 0.0), ratio, offset
        if isinstance(kind, PlanarCircle):
            geometry[6:9], geometry[9:12] = kind._planar.axes
        self._rows.append((parent, _KINDS[type(kind)], q, geometry.tolist()))
        for k, column in enumerate(kind.motion_subspace(kind.neutral())):
            self._columns.append(((ratio * np.asarray(column.vector(), float)).tolist(), v + k))
        self._starts.append(len(self._columns))

    def _as_arrays(self) -> r.Table:
        parents, kinds, starts, geometry = zip(*self._rows, strict=True) if self._rows else ((),) * 4
        columns, entries = zip(*self._columns, strict=True) if self._columns else ((), ())
        return r.Table(
            np.array(parents, np.int64),
            np.array(kinds, np.int64),
            np.array(starts, np.int64),
            np.array(self._starts, np.int64),
            np.array(geometry, float).reshape(-1, 12),
            np.array(columns, float).reshape(-1, 6),
            np.array(entries, np.int64),
        )


def _parts(kind: JointKind | None) -> tuple[ElementaryJoint, ...]:
    """The elementary joints of a kind; raises UnknownKind where tables do not have one of them."""
    parts = () if kind is None else kind.elementary_joints(SE3.identity())
    if not parts or any(type(part.kind) not in _KINDS for part in parts):
        raise UnknownKind
    return parts


def rows_of(matrices: Floats) -> Floats:
    """Homogeneous matrices (n, 4, 4) as rows (n, 12): rotation by rows, then translation."""
    out = np.empty((len(matrices), 12))
    out[:, :9] = matrices[:, :3, :3].reshape(-1, 9)
    out[:, 9:] = matrices[:, :3, 3]
    return out


def matrices_of(rows: Floats) -> Floats:
    """The homogeneous matrices (n, 4, 4) of rows (n, 12)."""
    out = np.zeros((len(rows), 4, 4))
    out[:, :3, :3] = rows[:, :9].reshape(-1, 3, 3)
    out[:, :3, 3] = rows[:, 9:]
    out[:, 3, 3] = 1.0
    return out
