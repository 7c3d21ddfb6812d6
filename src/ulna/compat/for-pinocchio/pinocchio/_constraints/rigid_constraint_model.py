"""RigidConstraintModel: a rigid constraint, its placements and its Jacobian at a configuration."""

from __future__ import annotations

from typing import final

from pinocchio._constraints.jacobians import getConstraintJacobian
from pinocchio._constraints.rigid_constraint import RigidConstraint, RigidConstraintData, checked_constraints
from pinocchio._data.data import Data
from pinocchio._model.model import Model
from ulna.typing import Floats

__all__ = ["RigidConstraintModel"]


@final
class RigidConstraintModel(RigidConstraint):
    __doc__ = RigidConstraint.__doc__

    __slots__ = ()

    def calc(self, model: Model, data: Data, constraint_data: RigidConstraintData) -> None:
        """Fills the placements of its frames from `data.oMi`.

        Args:
            data: Its data, after forwardKinematics.
        """
        data._require(data._known_states or None, "forwardKinematics(model, data, q)")
        checked_constraints(model, [self], [constraint_data])
        constraint_data._place(self, data)

    def jacobian(self, model: Model, data: Data, constraint_data: RigidConstraintData) -> Floats:
        """The Jacobian (residualSize, nv) at the configuration of the last forwardKinematics or dynamics.

        Args:
            data: Its data, after kinematics or dynamics.

        Returns:
            Jacobian (m, nv).
        """
        return getConstraintJacobian(model, data, self, constraint_data)
