"""Former names of methods of `Robot` that are in a group now, such as `robot.constraints`: they stay as they were."""

from __future__ import annotations

from ulna.methods.collision import Collision
from ulna.methods.parameters import Parameters
from ulna.quantities.centroidal import Centroidal
from ulna.quantities.configurations import ConfigurationSpace
from ulna.quantities.constrained_dynamics import Constraints
from ulna.quantities.derivatives import Derivatives
from ulna.quantities.operational_space import OperationalSpace
from ulna.quantities.part import Part
from ulna.quantities.regressors import Regressors


class FormerNames(Part):
    """Each name is the very function of its group."""

    __slots__ = ()

    normalize = ConfigurationSpace.normalize
    configuration_distance = ConfigurationSpace.distance
    squared_distance = ConfigurationSpace.squared_distance
    is_same_configuration = ConfigurationSpace.is_same

    center_of_mass_velocity = Centroidal.velocity
    center_of_mass_acceleration = Centroidal.acceleration
    center_of_mass_jacobian = Centroidal.jacobian
    centroidal_momentum = Centroidal.momentum
    centroidal_momentum_rate = Centroidal.momentum_rate
    centroidal_inertia = Centroidal.inertia
    centroidal_matrix = Centroidal.momentum_matrix
    centroidal_matrix_dot = Centroidal.momentum_matrix_dot

    operational_inertia = OperationalSpace.inertia
    operational_coriolis = OperationalSpace.coriolis
    operational_gravity = OperationalSpace.gravity
    operational_acceleration = OperationalSpace.acceleration

    constrained_dynamics = Constraints.forward_dynamics
    forward_dynamics_with_jacobian = Constraints.forward_dynamics_with_jacobian
    impulse_dynamics = Constraints.impulse_dynamics
    delassus_matrix = Constraints.delassus_matrix
    constraint_jacobian = Constraints.jacobian
    constraint_velocity = Constraints.velocity
    constraint_bias = Constraints.bias
    constraint_error = Constraints.error
    constraint_anchors = Constraints.anchors

    inverse_dynamics_derivatives = Derivatives.inverse_dynamics
    forward_dynamics_derivatives = Derivatives.forward_dynamics
    centroidal_derivatives = Derivatives.centroidal_momentum
    com_velocity_derivatives = Derivatives.center_of_mass_velocity
    frame_velocity_derivatives = Derivatives.frame_velocity
    frame_acceleration_derivatives = Derivatives.frame_acceleration
    hessian = Derivatives.jacobian
    manipulability_gradient = Derivatives.manipulability
    integrate_derivatives = Derivatives.integrate
    difference_derivatives = Derivatives.difference

    joint_torque_regressor = Regressors.joint_torque
    gravity_regressor = Regressors.gravity
    static_regressor = Regressors.center_of_mass
    frame_regressor = Regressors.wrench
    kinetic_energy_regressor = Regressors.kinetic_energy
    potential_energy_regressor = Regressors.potential_energy

    distance_gradient = Collision.distance_gradient
    first_contact = Collision.first_contact
    collision_checker = Collision.checker
    collision_spheres = Collision.spheres

    dynamic_parameters = Parameters.dynamic
