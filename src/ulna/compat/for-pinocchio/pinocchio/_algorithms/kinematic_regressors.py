"""Kinematic regressors: how a frame's placement answers to small changes of the joints' placements, for calibration."""

from __future__ import annotations

from typing import Any

import numpy as np

from pinocchio._algorithms.kinematics import updateFramePlacement
from pinocchio._containers.arrays import index
from pinocchio._containers.enums import ReferenceFrame, reference_of
from pinocchio._data.data import Data
from pinocchio._model.model import Model
from pinocchio._spatial.se3 import SE3
from ulna.typing import Floats


def computeJointKinematicRegressor(
    model: Model, data: Data, joint_id: int, reference_frame: ReferenceFrame, placement: SE3 | None = None
) -> Floats:
    """The matrix (6, 6 (njoints - 1)) from twists of the joints' placements to the twist of a frame on a joint.

    Args:
        data: Its data, after `forwardKinematics`.
        joint_id: The joint.
        reference_frame: LOCAL, WORLD or LOCAL_WORLD_ALIGNED: the reference frame of the twist.
        placement: Where the frame is in the frame of the joint; at the joint when not given.

    Returns:
        Matrix (6, 6 k), k = njoints - 1.
    """
    joint = index(joint_id, model.njoints, "joint", "model.getJointId(name) returns one.")
    frame = data.oMi[joint] * (SE3() if placement is None else placement)
    choices = {
        "local": frame.inverse(),
        "world": SE3(),
        "local_world_aligned": SE3(np.eye(3), -frame.translation),
    }
    to = choices[reference_of(reference_frame)]
    out = np.zeros((6, 6 * (model.njoints - 1)))
    for i in model.supports[joint][1:]:
        place = data.oMi[model.parents[i]] * model.jointPlacements[i]
        out[:, 6 * (i - 1) : 6 * i] = (to * place).action
    return out


def computeFrameKinematicRegressor(
    model: Model, data: Data, frame_id: int, reference_frame: ReferenceFrame
) -> Any:
    """The same of a frame; see `computeJointKinematicRegressor`.

    Args:
        data: Its data, after forwardKinematics.
        reference_frame: LOCAL, WORLD or LOCAL_WORLD_ALIGNED: the reference frame of the twist.

    Returns:
        Matrix (6, 6 k), k = njoints - 1.
    """
    frame = model.frames[index(frame_id, model.nframes, "frame", "model.getFrameId(name) returns one.")]
    updateFramePlacement(model, data, frame_id)
    return computeJointKinematicRegressor(model, data, frame.parentJoint, reference_frame, frame.placement)
