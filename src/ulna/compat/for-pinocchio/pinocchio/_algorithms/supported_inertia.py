"""What a frame carries: the inertia behind it, and the force it takes to move that."""

from __future__ import annotations

from pinocchio._containers.arrays import index
from pinocchio._data.data import Data
from pinocchio._model.model import Model
from pinocchio._spatial.inertia import Inertia
from pinocchio._spatial.motion_force import Force
from pinocchio._spatial.se3 import SE3


def computeSupportedInertiaByFrame(model: Model, data: Data, frame_id: int, with_subtree: bool) -> Inertia:
    """The inertia of all that is attached to a frame, in its axes, where `data.oMi` has the joints.

    Args:
        data: Its data, after `forwardKinematics`.
        frame_id: The frame.
        with_subtree: Whether joints that are attached to it count; else the frames on its own joint alone.

    Returns:
        The inertia.
    """
    inertia, children = _behind(model, frame_id)
    if with_subtree:
        frame = model.frames[frame_id]
        back = (data.oMi[frame.parentJoint] * frame.placement).inverse()
        for child in children:
            for joint in model.subtrees[child]:
                inertia += model.inertias[joint].se3Action(back * data.oMi[joint])
    return inertia


def computeSupportedForceByFrame(model: Model, data: Data, frame_id: int) -> Force:
    """The force that moves all that a frame carries, in the axes of the frame.

    Args:
        data: Its data, after rnea.

    Returns:
        Force (6,) [N, N m].
    """
    inertia, children = _behind(model, frame_id)
    frame = model.frames[frame_id]
    v, a = (frame.placement.actInv(list_[frame.parentJoint]) for list_ in (data.v, data.a_gf))
    force = inertia * a + inertia.vxiv(v)
    for child in children:
        force += frame.placement.actInv(data.liMi[child].act(data.f[child]))
    return force


def _behind(model: Model, frame_id: int) -> tuple[Inertia, list[int]]:
    """The inertia of the frames on the same joint that are attached to a frame, in its axes, and the joints that do."""
    first = model.frames[index(frame_id, model.nframes, "frame", "model.getFrameId(name) returns one.")]
    joint, back = first.parentJoint, first.placement.inverse()
    carried = {int(frame_id)}
    total = Inertia(first.inertia)
    joints = []
    for i in range(int(frame_id) + 1, model.nframes):
        frame = model.frames[i]
        if frame.parentFrame not in carried:
            continue
        if frame.parentJoint == joint:
            carried.add(i)
            total += frame.inertia.se3Action(SE3(back * frame.placement))
        elif model.parents[frame.parentJoint] == joint:
            joints.append(frame.parentJoint)
    return total, sorted(set(joints))
