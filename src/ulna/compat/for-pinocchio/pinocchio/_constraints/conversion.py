"""Anchors as rigid constraints."""

from __future__ import annotations

from typing import Any

import numpy as np

from pinocchio._constraints.anchors import FrameAnchorConstraintModel, PointAnchorConstraintModel
from pinocchio._constraints.frame_pair import ContactType
from pinocchio._constraints.rigid_constraint_model import RigidConstraintModel
from pinocchio._containers.arguments import ArgumentError
from pinocchio._containers.enums import ReferenceFrame
from pinocchio._model.model import Model
from pinocchio._spatial.motion_force import Motion
from pinocchio._spatial.se3 import SE3
from pinocchio.explog import exp6

__all__ = ["convertToRigidConstraintModel"]


def convertToRigidConstraintModel(
    model: Model, constraint: Any, reference_frame: Any = ReferenceFrame.LOCAL
) -> RigidConstraintModel:
    """The RigidConstraintModel of an anchor: of a point CONTACT_3D, of a frame CONTACT_6D.

    Args:
        constraint: A PointAnchorConstraintModel or FrameAnchorConstraintModel.
        reference_frame: LOCAL, WORLD or LOCAL_WORLD_ALIGNED.

    Returns:
        The constraint.

    Raises:
        ArgumentError: It is no anchor.
    """
    if not isinstance(constraint, (PointAnchorConstraintModel, FrameAnchorConstraintModel)):
        raise ArgumentError(
            f"The constraint is {constraint!r}; expected a PointAnchorConstraintModel or a FrameAnchorConstraintModel."
        )
    is_frame = constraint.residualSize() == 6
    kind = ContactType.CONTACT_6D if is_frame else ContactType.CONTACT_3D
    ends = (
        constraint.joint1_id,
        constraint.joint1_placement,
        constraint.joint2_id,
        constraint.joint2_placement,
    )
    rigid = RigidConstraintModel(kind, model, *ends, reference_frame)
    padding = np.zeros(6 - constraint.residualSize())
    offset, velocity, acceleration = (
        np.concatenate([x, padding])
        for x in (
            constraint.desired_constraint_offset,
            constraint.desired_constraint_velocity,
            constraint.desired_constraint_acceleration,
        )
    )
    rigid.name = constraint.name
    rigid.desired_contact_placement = exp6(offset) if is_frame else SE3(np.eye(3), offset[:3])
    rigid.desired_contact_velocity, rigid.desired_contact_acceleration = (
        Motion(velocity),
        Motion(acceleration),
    )
    rigid.setBaumgarteCorrectorParameters(constraint.baumgarte_corrector_parameters)
    return rigid
