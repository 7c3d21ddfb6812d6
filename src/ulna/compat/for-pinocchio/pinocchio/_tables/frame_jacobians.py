"""Jacobians of frames, and their rates, from the columns of all joints in the world."""

from __future__ import annotations

from typing import Any

import numpy as np

from pinocchio._tables import recursions as r
from pinocchio._tables.evaluation import TableEvaluator
from ulna.algorithms.multibody.references import Reference
from ulna.typing import Floats


def frame_jacobian(
    evaluator: TableEvaluator, q: Floats, joint: int, placement: Floats, reference: Reference
) -> tuple[Floats, Floats, Floats]:
    """The Jacobian of a frame.

    Args:
        joint: The joint that carries the frame, 0 for the universe.
        placement: The frame in the frame of the joint (4, 4) [m].
        reference: Where the Jacobian is expressed.

    Returns:
        The Jacobian (6, nv), the placements of the joints (njoints - 1, 4, 4), that of the frame (4, 4).
    """
    out = evaluator.run(r.COLUMNS, q)
    J = evaluator.by_entries(out.J * evaluator.supports(joint)[:, None])
    T = frame_of(evaluator, joint, placement)
    return _in_frame(J, T, reference), evaluator.placements(), T


def jacobian_of_columns(
    evaluator: TableEvaluator, J: Floats, carrier: Floats, joint: int, placement: Floats, reference: Reference
) -> tuple[Floats, Floats]:
    """The Jacobian of a frame of a robot without mimic joints, from columns that are computed already.

    Args:
        J: The columns of all joints in the world (6, nv), linear rows first.
        carrier: The placement in the world of the joint that carries the frame (4, 4) [m].
        joint: That joint, 0 for the universe.
        placement: The frame in the frame of the joint (4, 4) [m].
        reference: Where the Jacobian is expressed.

    Returns:
        The Jacobian (6, nv), and the placement of the frame (4, 4).
    """
    carries = evaluator.by_entries(np.tile(evaluator.supports(joint)[:, None], 6))
    T = carrier @ placement
    return _in_frame(np.where(carries > 0.0, J, 0.0), T, reference), T


def frame_jacobian_rate(
    evaluator: TableEvaluator, q: Floats, v: Floats, joint: int, placement: Floats, reference: Reference
) -> Floats:
    """The time derivative of the Jacobian of a frame.

    Args:
        joint: The joint that carries the frame, 0 for the universe.
        placement: The frame in the frame of the joint (4, 4) [m].
        reference: Where the Jacobian is expressed.

    Returns:
        Matrix (6, nv).
    """
    out, carried = evaluator.run(r.RATES, q, v), evaluator.supports(joint)[:, None]
    J, dJ = evaluator.by_entries(out.J * carried), evaluator.by_entries(out.dJ * carried)
    T, (linear, turn) = frame_of(evaluator, joint, placement), (J @ v).reshape(2, 3)
    if reference == "local":
        dJ[:3] -= _cross(turn, J[:3]) + _cross(linear, J[3:])
        dJ[3:] -= _cross(turn, J[3:])
    in_frame = _in_frame(dJ, T, reference)
    if reference == "local_world_aligned":
        in_frame[:3] -= _cross(linear + np.cross(turn, T[:3, 3]), J[3:])
    return in_frame


def frame_of(evaluator: TableEvaluator, joint: int, placement: Floats) -> Floats:
    """Where a frame is after a run.

    Args:
        evaluator: The evaluator.
        joint: The joint that carries the frame, 0 for the universe.
        placement: The frame in the frame of the joint (4, 4) [m].

    Returns:
        Its placement in the world (4, 4).
    """
    return placement.copy() if joint == 0 else evaluator.placements()[joint - 1] @ placement


def _in_frame(J: Floats, T: Floats, reference: Reference) -> Floats:
    """Columns in the world, moved to the origin of a frame at T, and turned into its axes for "local"."""
    if reference == "world":
        return J
    out = moved_to(J, T[:3, 3])
    return out if reference != "local" else np.concatenate([T[:3, :3].T @ out[:3], T[:3, :3].T @ out[3:]])


def moved_to(J: Floats, point: Floats) -> Floats:
    """Columns in the world, at a point instead of the origin.

    Args:
        J: The columns (6, nv).
        point: The point (3,) [m].

    Returns:
        New columns (6, nv).
    """
    out = J.copy()
    out[:3] -= _cross(point, J[3:])
    return out


def _cross(vector: Floats, columns: Any) -> Floats:
    return np.asarray(np.cross(vector, columns, axisb=0, axisc=0), float)
