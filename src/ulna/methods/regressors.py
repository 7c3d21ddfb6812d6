"""What of a robot is linear in the masses and inertias of its bodies, and what it can carry."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.algorithms.multibody.references import Reference
from ulna.methods.base import Part
from ulna.typing import ArrayLike


class Regressors(Part):
    """Matrices that make torques, energies and the centre of mass out of dynamic parameters; payload capacity."""

    __slots__ = ()

    def joint_torque_regressor(self, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> Any:
        """The matrix (..., nv, 10 nbodies) that makes the joint torques out of the dynamic parameters.

        `regressor @ ulna.model.dynamic_parameters(robot.model)` is inverse dynamics without the drives' inertia.
        """
        return self._plain["joint_torque_regressor"](q, v, a)

    def gravity_regressor(self, q: ArrayLike) -> Any:
        """The same at rest, (..., nv, 10 nbodies): makes the torques that hold the robot still."""
        return self._plain["gravity_regressor"](q)

    def static_regressor(self, q: ArrayLike) -> Any:
        """The matrix (..., 3, 4 nbodies) [1/kg] that makes the centre of mass out of each body's m and m c."""
        return self._plain["static_regressor"](q)

    def frame_regressor(self, q: ArrayLike, v: ArrayLike, a: ArrayLike, frame: str | None = None) -> Any:
        """The matrix (..., 6, 10) that makes the wrench on a body at a frame out of its dynamic parameters."""
        return self._checked("frame_regressor", frame=frame)(q, v, a)

    def kinetic_energy_regressor(self, q: ArrayLike, v: ArrayLike) -> Any:
        """The row (..., 10 nbodies) that makes the kinetic energy [J] out of the dynamic parameters."""
        return self._plain["kinetic_energy_regressor"](q, v)

    def potential_energy_regressor(self, q: ArrayLike) -> Any:
        """The row (..., 10 nbodies) that makes the potential energy [J] out of the dynamic parameters."""
        return self._plain["potential_energy_regressor"](q)

    def payload_capacity(
        self,
        q: ArrayLike,
        frame: str | None = None,
        wrench: ArrayLike | None = None,
        effort: ArrayLike | None = None,
        reference: Reference = "local_world_aligned",
    ) -> Any:
        """How many times a load each joint can hold at a frame, standing still, (..., nv); the least counts.

        Args:
            q: Configuration, (..., nq).
            frame: Where the load acts; None for the tool.
            wrench: What it exerts there, (..., 6) [N, N m]; None for the weight of 1 kg, so that the answer is in kg.
            effort: Greatest torques in both directions, (nv,) [N m or N]; None for the model's.
            reference: In whose axes, and about which point, the wrench is written.

        Returns:
            Multiples of the load; inf where it does not burden a joint, nan where a joint cannot even hold the robot.
        """
        weight = np.concatenate([self.model.gravity, np.zeros(3)])
        load = np.asarray(weight if wrench is None else wrench, dtype=float)
        limit = np.asarray(self.model.effort_limit if effort is None else effort, dtype=float)
        free = np.isinf(limit)
        kernel = self._checked("payload_multiples", frame=frame, reference=reference)
        load_limit = kernel(q, load, np.where(free, np.finfo(float).max, limit))
        return np.where(free & ~np.isnan(load_limit), np.inf, load_limit)
