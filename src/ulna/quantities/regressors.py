"""Regressors: the matrices of quantities that are linear in the masses and inertias of the bodies."""

from __future__ import annotations

from typing import final

from ulna.quantities.deferred_algorithms import algorithms
from ulna.quantities.part import Part
from ulna.quantities.quantity import of_frame, quantity
from ulna.typing import ArrayLike, Floats


@final
class Regressors(Part):
    """Matrices that map the dynamic parameters `robot.parameters.dynamic` to torques, wrenches and energies.

    The unit of an entry is that of the result for each unit of the parameter: kg, kg m, kg m^2.
    """

    __slots__ = ()

    @quantity(
        algorithms.joint_torque_regressor,
        "(nv, 10 nbodies)",
        nodes=(0, 95, 0.5),
        stages=algorithms.stages_of_joint_torque_regressor,
    )
    def joint_torque(self, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> Floats:
        """The matrix that maps the dynamic parameters to the joint torques, without the inertia of the drives
        [Siciliano et al. 2009, section 7.2].

        Example:
            >>> robot = ulna.load("ur5")
            >>> q, v, a = np.zeros(6), np.ones(6), np.ones(6)
            >>> Y = robot.regressors.joint_torque(q, v, a)
            >>> tau = Y @ robot.parameters.dynamic + robot.model.armature * a
            >>> np.allclose(tau, robot.inverse_dynamics(q, v, a))
            True
        """
        ...

    @quantity(
        algorithms.gravity_regressor,
        "(nv, 10 nbodies)",
        nodes=(0, 31, 1),
        stages=algorithms.stages_of_gravity_regressor,
    )
    def gravity(self, q: ArrayLike) -> Floats:
        """The matrix that maps the dynamic parameters to the torques that hold the robot against gravity."""
        ...

    @quantity(algorithms.static_regressor, "(3, 4 nbodies) [1/kg]")
    def center_of_mass(self, q: ArrayLike) -> Floats:
        """The matrix that maps m and m c of each body to the centre of mass."""
        ...

    @quantity(of_frame(algorithms.frame_regressor), "(6, 10)")
    def wrench(self, q: ArrayLike, v: ArrayLike, a: ArrayLike, frame: str | None = None) -> Floats:
        """The matrix that maps the dynamic parameters of a body at a frame to the wrench on it, in "local"."""
        ...

    @quantity(algorithms.kinetic_energy_regressor, "(10 nbodies,)")
    def kinetic_energy(self, q: ArrayLike, v: ArrayLike) -> Floats:
        """The row that maps the dynamic parameters to the kinetic energy."""
        ...

    @quantity(algorithms.potential_energy_regressor, "(10 nbodies,)")
    def potential_energy(self, q: ArrayLike) -> Floats:
        """The row that maps the dynamic parameters to the potential energy."""
        ...
