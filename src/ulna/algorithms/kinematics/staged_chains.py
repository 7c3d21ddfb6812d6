"""Poses and Jacobians of frames at the ends of long serial chains, as stages: segments of the chain in SIMD lanes.

The frames, symbols and sources are those of multibody/chain_frames.py and jacobian.py; forward_kinematics.py and
jacobian.py remain the definitions.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.algorithms.kinematics.jacobian import Reference
from ulna.algorithms.multibody.chain_frames import (
    PADDING,
    ChainFrames,
    chain_frames,
    pose_numbers,
    pose_of,
)
from ulna.algorithms.multibody.chain_walks import walk_of_poses
from ulna.algorithms.multibody.references import check_reference
from ulna.compiler.forms.scans import Walk
from ulna.compiler.forms.stages import StagedForm, Stages
from ulna.model import Frame, Model
from ulna.numeric import apply, cross
from ulna.spatial import SE3
from ulna.typing import Array

_FEWEST = 16
"""Joints between the root and a frame from which on segments are worth it."""

_STRAIGHT_BATCHES = 200
"""Joints up to which batches are computed by straight-line code."""


def stages_of_frame_pose(model: Model, frame: Frame) -> StagedForm | None:
    """The pose of a frame as a matrix.

    Args:
        model: The robot.
        frame: A frame of the model.

    Returns:
        The form; None for robots and frames that need another one.
    """
    chain = _chain(model, frame)
    if chain is None:
        return None
    stages = Stages("fk", chain.numbers.shape[1], q=(model.nq,))
    _scan(stages, chain, _tip(chain, frame))
    stages.straight(lambda tip: pose_of(tip).matrix(), ("tip",), ("T",))
    return stages.form("T", serves_batches=len(chain.numbers[0]) > _STRAIGHT_BATCHES)


def stages_of_frame_jacobian(
    model: Model, frame: Frame, reference: Reference = "local_world_aligned"
) -> StagedForm | None:
    """The Jacobian of a frame.

    Args:
        model: The robot.
        frame: A frame of the model, which all joints move.
        reference: "world", "local" or "local_world_aligned".

    Returns:
        The form; None for robots and frames that need another one.
    """
    check_reference(reference)
    chain = _chain(model, frame)
    if chain is None or chain.numbers.shape[1] != model.nv:
        return None

    def column(segment: Array, tip: Array, axis: Array) -> Array:
        start, end = pose_of(segment), pose_of(tip)
        z, p = apply(start.rotation, axis[:3]), apply(start.rotation, axis[3:]) + start.translation
        if reference == "world":
            return np.concatenate([cross(p, z), z])
        linear = cross(z, end.translation - p)
        if reference == "local":
            back = end.rotation.T
            return np.concatenate([apply(back, linear), apply(back, z)])
        return np.concatenate([linear, z])

    stages = Stages("jacobian", model.nv, q=(model.nq,))
    _scan(stages, chain, _tip(chain, frame), column, "J")
    return stages.form("J", serves_batches=model.nv > _STRAIGHT_BATCHES)


def _chain(model: Model, frame: Frame) -> ChainFrames | None:
    """The chain that moves a frame, where it is long enough."""
    joints = model.support(frame.joint) if frame.joint >= 0 else ()
    return chain_frames(model, joints) if len(joints) >= _FEWEST else None


def _tip(chain: ChainFrames, frame: Frame) -> SE3:
    """The pose of a frame in the last moving frame."""
    return chain.links.frames[-1].inverse() @ frame.placement


def _scan(stages: Stages, chain: ChainFrames, placement: SE3, column: Any = None, table: str = "") -> None:
    """The pose of a frame, `tip`, and where asked for a table of what follows from axes in segments."""

    def end(state: Array) -> Array:
        return pose_numbers(pose_of(state) @ placement)

    walks = [walk_of_poses(chain, _axis, end=end, whole="tip")]
    walks += [Walk(column, ("segment", "tip", "local"), (table,))] if table else []
    tables = (table,) if table else ()
    stages.scan(walks, {"numbers": chain.numbers}, {"numbers": PADDING}, {"q": chain.first_q}, tables)


def _axis(pose: SE3) -> Array:
    """Axis and origin of a moving frame."""
    return np.concatenate([pose.rotation[:, 2], pose.translation])
