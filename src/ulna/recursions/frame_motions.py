"""Recursions of frames: their poses, Jacobians, velocities and accelerations, each over the joints that carry them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ulna.algorithms.multibody.references import Reference
from ulna.model import Frame, Model
from ulna.model.constraint import End
from ulna.recursions._procedures import frames as of_frames
from ulna.recursions._procedures.newton_euler import new_motions
from ulna.recursions._procedures.placements import new_placements
from ulna.recursions.frame_rows import frame_table
from ulna.recursions.recursion import Recursion
from ulna.recursions.tree_table import INT, carriers

_PROCEDURES = {1: of_frames.frame_velocity, 2: of_frames.frame_acceleration}


def poses_of(model: Model, frames: Sequence[Frame | End], shape: tuple[int, ...]) -> Recursion:
    """Poses of frames.

    Args:
        model: The robot.
        frames: The frames.
        shape: Of the result, (k, 4, 4), or (4, 4) for one.

    Returns:
        The recursion, of q.
    """
    tree, rows = carriers(model, frames)

    def storage(lanes: int) -> Sequence[Any]:
        return tree, new_placements(len(tree.parents), lanes, True), frame_table(frames, rows)

    return Recursion(of_frames.frame_poses, storage, ((model.nq,),), (shape,), len(tree.parents))


def jacobian_of(model: Model, frame: Frame | End, reference: Reference) -> Recursion:
    """The Jacobian of a frame.

    Args:
        model: The robot.
        frame: The frame.
        reference: How it is written.

    Returns:
        The recursion, of q.
    """
    tree, rows = carriers(model, [frame])

    def storage(lanes: int) -> Sequence[Any]:
        return tree, new_placements(len(tree.parents), lanes, True), frame_table([frame], rows, reference)

    return Recursion(of_frames.frame_jacobian, storage, ((model.nq,),), ((6, model.nv),), len(tree.parents))


def motion_of(
    model: Model, frame: Frame | End, reference: Reference, order: int, classical: bool = False
) -> Recursion:
    """The velocity of a frame, or its acceleration.

    Args:
        model: The robot.
        frame: The frame.
        reference: How it is written.
        order: 1 for the velocity, 2 for the acceleration.
        classical: Whether the acceleration is that of the frame's origin.

    Returns:
        The recursion, of q, v and, for the acceleration, a.
    """
    tree, rows = carriers(model, [frame])
    last = (np.array([int(classical)], INT),) if order == 2 else ()

    def storage(lanes: int) -> Sequence[Any]:
        count = len(tree.parents)
        places, moves = new_placements(count, lanes, True), new_motions(count, lanes)
        return tree, places, moves, frame_table([frame], rows, reference), *last

    inputs = ((model.nq,), *[(model.nv,)] * order)
    return Recursion(_PROCEDURES[order], storage, inputs, ((6,),), len(tree.parents))
