"""Jacobians of constraints from the columns of all joints in the world."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pinocchio._tables import recursions as r
from pinocchio._tables.evaluation import TableEvaluator
from pinocchio._tables.frame_jacobians import frame_of, moved_to
from ulna.typing import Floats


def constraint_jacobian(
    evaluator: TableEvaluator,
    q: Floats,
    shapes: Sequence[tuple[int, bool, int, int]],
    places: Sequence[Floats],
    stored: Floats | None = None,
) -> Floats:
    """The Jacobian of constraints.

    Args:
        evaluator: The evaluator, whose parameters are loaded.
        q: Configuration (nq,) [rad or m].
        shapes: For each constraint its rows, whether they are local, and its two joints.
        places: Both placements of each constraint (2, 4, 4) [m].
        stored: The columns of the joints in the world (6, nv), in place of those of q.

    Returns:
        Jacobian (m, nv).
    """
    columns = evaluator.run(r.COLUMNS, q).J
    parts = []
    for (rows, local, *joints), pair in zip(shapes, places, strict=True):
        first, second = (frame_of(evaluator, joint, M) for joint, M in zip(joints, pair, strict=True))
        at = first[:3, 3], (first if rows == 6 else second)[:3, 3]
        J1, J2 = (
            moved_to(_supporting(evaluator, joint, columns, stored), point)[:rows]
            for joint, point in zip(joints, at, strict=True)
        )
        J = J1 - J2
        parts.append((first[:3, :3].T @ J.reshape(-1, 3, J.shape[1])).reshape(J.shape) if local else J)
    return np.vstack(parts)


def _supporting(evaluator: TableEvaluator, joint: int, columns: Floats, stored: Floats | None) -> Floats:
    """The columns (6, nv) that move a joint, zero for all others."""
    supports = evaluator.supports(joint)[:, None]
    if stored is None:
        return evaluator.by_entries(columns * supports)
    return stored * evaluator.by_entries(np.ones_like(columns) * supports)
