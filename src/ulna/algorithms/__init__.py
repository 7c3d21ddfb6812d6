"""The book: one algorithm a file, free pure functions of a model and of numbers, symbols or traced scalars.

Every file opens with its table of symbols. They refer to Featherstone, Rigid Body Dynamics Algorithms (2008);
Lynch & Park, Modern Robotics (2017); Siciliano et al., Robotics: Modelling, Planning and Control (2009).

Each file is imported when one of its names is first used.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ulna.system.deferred_names import deferred_names

if TYPE_CHECKING:
    from ulna.algorithms.constraints.dry_friction import velocity_after_friction as velocity_after_friction
    from ulna.algorithms.constraints.dynamics import ConstrainedMotion as ConstrainedMotion
    from ulna.algorithms.constraints.dynamics import Impact as Impact
    from ulna.algorithms.constraints.dynamics import Stabilisation as Stabilisation
    from ulna.algorithms.constraints.dynamics import constrained_dynamics as constrained_dynamics
    from ulna.algorithms.constraints.dynamics import delassus_matrix as delassus_matrix
    from ulna.algorithms.constraints.dynamics import (
        forward_dynamics_with_jacobian as forward_dynamics_with_jacobian,
    )
    from ulna.algorithms.constraints.dynamics import impulse_dynamics as impulse_dynamics
    from ulna.algorithms.constraints.forward_dynamics_derivatives import (
        ConstrainedDerivatives as ConstrainedDerivatives,
    )
    from ulna.algorithms.constraints.forward_dynamics_derivatives import (
        columns_of_constrained_derivatives as columns_of_constrained_derivatives,
    )
    from ulna.algorithms.constraints.forward_dynamics_derivatives import (
        constrained_dynamics_derivatives as constrained_dynamics_derivatives,
    )
    from ulna.algorithms.constraints.kinematics import constraint_bias as constraint_bias
    from ulna.algorithms.constraints.kinematics import constraint_error as constraint_error
    from ulna.algorithms.constraints.kinematics import constraint_jacobian as constraint_jacobian
    from ulna.algorithms.constraints.kinematics import constraint_velocity as constraint_velocity
    from ulna.algorithms.constraints.proximal_settings import Proximal as Proximal
    from ulna.algorithms.constraints.staged import (
        stages_of_constrained_derivatives as stages_of_constrained_derivatives,
    )
    from ulna.algorithms.constraints.staged import (
        stages_of_constrained_dynamics as stages_of_constrained_dynamics,
    )
    from ulna.algorithms.constraints.staged import stages_of_impulse_dynamics as stages_of_impulse_dynamics
    from ulna.algorithms.derivatives.centroidal import centroidal_derivatives as centroidal_derivatives
    from ulna.algorithms.derivatives.centroidal import com_velocity_derivatives as com_velocity_derivatives
    from ulna.algorithms.derivatives.differentiated_rnea import aba_derivatives as aba_derivatives
    from ulna.algorithms.derivatives.differentiated_rnea import rnea_derivatives as rnea_derivatives
    from ulna.algorithms.derivatives.forward_dynamics import (
        columns_of_derivatives as columns_of_derivatives,
    )
    from ulna.algorithms.derivatives.forward_dynamics import (
        forward_dynamics_derivatives as forward_dynamics_derivatives,
    )
    from ulna.algorithms.derivatives.inverse_dynamics import (
        inverse_dynamics_derivatives as inverse_dynamics_derivatives,
    )
    from ulna.algorithms.derivatives.serial_chains import is_serial as is_serial
    from ulna.algorithms.derivatives.serial_chains import (
        stages_of_inverse_mass_matrix as stages_of_inverse_mass_matrix,
    )
    from ulna.algorithms.derivatives.staged import (
        stages_of_centroidal_derivatives as stages_of_centroidal_derivatives,
    )
    from ulna.algorithms.derivatives.staged import stages_of_centroidal_matrix as stages_of_centroidal_matrix
    from ulna.algorithms.derivatives.staged import stages_of_coriolis_matrix as stages_of_coriolis_matrix
    from ulna.algorithms.derivatives.staged import (
        stages_of_forward_dynamics_derivatives as stages_of_forward_dynamics_derivatives,
    )
    from ulna.algorithms.derivatives.staged import (
        stages_of_inverse_dynamics_derivatives as stages_of_inverse_dynamics_derivatives,
    )
    from ulna.algorithms.derivatives.staged import stages_of_mass_matrix as stages_of_mass_matrix
    from ulna.algorithms.derivatives.staged_operational_space import (
        stages_of_operational_coriolis as stages_of_operational_coriolis,
    )
    from ulna.algorithms.derivatives.staged_operational_space import (
        stages_of_operational_gravity as stages_of_operational_gravity,
    )
    from ulna.algorithms.derivatives.staged_operational_space import (
        stages_of_operational_inertia as stages_of_operational_inertia,
    )
    from ulna.algorithms.derivatives.staged_regressors import (
        stages_of_gravity_regressor as stages_of_gravity_regressor,
    )
    from ulna.algorithms.derivatives.staged_regressors import (
        stages_of_joint_torque_regressor as stages_of_joint_torque_regressor,
    )
    from ulna.algorithms.derivatives.velocity import (
        frame_acceleration_derivatives as frame_acceleration_derivatives,
    )
    from ulna.algorithms.derivatives.velocity import frame_velocity_derivatives as frame_velocity_derivatives
    from ulna.algorithms.derivatives.velocity import motion_derivatives as motion_derivatives
    from ulna.algorithms.derivatives.velocity import point_derivatives as point_derivatives
    from ulna.algorithms.dynamics.aba import aba as aba
    from ulna.algorithms.dynamics.aba_relative_accelerations import (
        articulated_body_dynamics as articulated_body_dynamics,
    )
    from ulna.algorithms.dynamics.center_of_mass import center_of_mass as center_of_mass
    from ulna.algorithms.dynamics.center_of_mass import (
        center_of_mass_acceleration as center_of_mass_acceleration,
    )
    from ulna.algorithms.dynamics.center_of_mass import center_of_mass_jacobian as center_of_mass_jacobian
    from ulna.algorithms.dynamics.center_of_mass import center_of_mass_velocity as center_of_mass_velocity
    from ulna.algorithms.dynamics.center_of_mass import total_mass as total_mass
    from ulna.algorithms.dynamics.centroidal import centroidal_inertia as centroidal_inertia
    from ulna.algorithms.dynamics.centroidal import centroidal_matrix as centroidal_matrix
    from ulna.algorithms.dynamics.centroidal import centroidal_matrix_dot as centroidal_matrix_dot
    from ulna.algorithms.dynamics.centroidal import centroidal_momentum as centroidal_momentum
    from ulna.algorithms.dynamics.centroidal import centroidal_momentum_rate as centroidal_momentum_rate
    from ulna.algorithms.dynamics.coriolis import coriolis_matrix as coriolis_matrix
    from ulna.algorithms.dynamics.crba import crba as crba
    from ulna.algorithms.dynamics.crba import mass_matrix as mass_matrix
    from ulna.algorithms.dynamics.energy import kinetic_energy as kinetic_energy
    from ulna.algorithms.dynamics.energy import mechanical_energy as mechanical_energy
    from ulna.algorithms.dynamics.energy import potential_energy as potential_energy
    from ulna.algorithms.dynamics.forward_dynamics import by_mass_matrix as by_mass_matrix
    from ulna.algorithms.dynamics.forward_dynamics import forward_dynamics as forward_dynamics
    from ulna.algorithms.dynamics.inverse_mass_matrix import (
        columns_of_inverse_mass_matrix as columns_of_inverse_mass_matrix,
    )
    from ulna.algorithms.dynamics.inverse_mass_matrix import inverse_mass_matrix as inverse_mass_matrix
    from ulna.algorithms.dynamics.joint_friction import Friction as Friction
    from ulna.algorithms.dynamics.joint_friction import friction_torque as friction_torque
    from ulna.algorithms.dynamics.operational_space import Task as Task
    from ulna.algorithms.dynamics.operational_space import (
        operational_acceleration as operational_acceleration,
    )
    from ulna.algorithms.dynamics.operational_space import operational_coriolis as operational_coriolis
    from ulna.algorithms.dynamics.operational_space import operational_gravity as operational_gravity
    from ulna.algorithms.dynamics.operational_space import operational_inertia as operational_inertia
    from ulna.algorithms.dynamics.payload import payload_multiples as payload_multiples
    from ulna.algorithms.dynamics.regressors import body_regressor as body_regressor
    from ulna.algorithms.dynamics.regressors import frame_regressor as frame_regressor
    from ulna.algorithms.dynamics.regressors import gravity_regressor as gravity_regressor
    from ulna.algorithms.dynamics.regressors import joint_torque_regressor as joint_torque_regressor
    from ulna.algorithms.dynamics.regressors import kinetic_energy_regressor as kinetic_energy_regressor
    from ulna.algorithms.dynamics.regressors import potential_energy_regressor as potential_energy_regressor
    from ulna.algorithms.dynamics.regressors import static_regressor as static_regressor
    from ulna.algorithms.dynamics.rnea import rnea as rnea
    from ulna.algorithms.dynamics.rnea_point_accelerations import bias_forces as bias_forces
    from ulna.algorithms.dynamics.rnea_point_accelerations import gravity_forces as gravity_forces
    from ulna.algorithms.dynamics.rnea_point_accelerations import inverse_dynamics as inverse_dynamics
    from ulna.algorithms.dynamics.rnea_point_accelerations import joint_wrenches as joint_wrenches
    from ulna.algorithms.dynamics.rnea_point_accelerations import static_torque as static_torque
    from ulna.algorithms.dynamics.staged_chains import stages_of_bias_forces as stages_of_bias_forces
    from ulna.algorithms.dynamics.staged_chains import (
        stages_of_center_of_mass_jacobian as stages_of_center_of_mass_jacobian,
    )
    from ulna.algorithms.dynamics.staged_chains import (
        stages_of_centroidal_momentum as stages_of_centroidal_momentum,
    )
    from ulna.algorithms.dynamics.staged_chains import (
        stages_of_inverse_dynamics as stages_of_inverse_dynamics,
    )
    from ulna.algorithms.dynamics.staged_chains import (
        stages_of_mechanical_energy as stages_of_mechanical_energy,
    )
    from ulna.algorithms.kinematics.analytical_jacobian import Representation as Representation
    from ulna.algorithms.kinematics.analytical_jacobian import analytical_jacobian as analytical_jacobian
    from ulna.algorithms.kinematics.analytical_jacobian import (
        analytical_jacobian_dot as analytical_jacobian_dot,
    )
    from ulna.algorithms.kinematics.configuration_space import coordinate_rates as coordinate_rates
    from ulna.algorithms.kinematics.configuration_space import difference as difference
    from ulna.algorithms.kinematics.configuration_space import (
        difference_derivatives as difference_derivatives,
    )
    from ulna.algorithms.kinematics.configuration_space import distance as distance
    from ulna.algorithms.kinematics.configuration_space import integrate as integrate
    from ulna.algorithms.kinematics.configuration_space import integrate_derivatives as integrate_derivatives
    from ulna.algorithms.kinematics.configuration_space import interpolate as interpolate
    from ulna.algorithms.kinematics.configuration_space import is_same as is_same
    from ulna.algorithms.kinematics.configuration_space import neutral as neutral
    from ulna.algorithms.kinematics.configuration_space import normalize as normalize
    from ulna.algorithms.kinematics.configuration_space import random as random
    from ulna.algorithms.kinematics.configuration_space import squared_distance as squared_distance
    from ulna.algorithms.kinematics.forward_kinematics import frame_acceleration as frame_acceleration
    from ulna.algorithms.kinematics.forward_kinematics import frame_pose as frame_pose
    from ulna.algorithms.kinematics.forward_kinematics import frame_poses as frame_poses
    from ulna.algorithms.kinematics.forward_kinematics import frame_velocity as frame_velocity
    from ulna.algorithms.kinematics.forward_kinematics import joint_accelerations as joint_accelerations
    from ulna.algorithms.kinematics.forward_kinematics import joint_poses as joint_poses
    from ulna.algorithms.kinematics.forward_kinematics import joint_velocities as joint_velocities
    from ulna.algorithms.kinematics.hessian import frame_hessian as frame_hessian
    from ulna.algorithms.kinematics.jacobian import frame_jacobian as frame_jacobian
    from ulna.algorithms.kinematics.jacobian import frame_jacobian_of as frame_jacobian_of
    from ulna.algorithms.kinematics.jacobian import joint_jacobians as joint_jacobians
    from ulna.algorithms.kinematics.jacobian_dot import frame_jacobian_dot as frame_jacobian_dot
    from ulna.algorithms.kinematics.jacobian_dot import joint_jacobians_dot as joint_jacobians_dot
    from ulna.algorithms.kinematics.jacobian_partials import jacobian_partials as jacobian_partials
    from ulna.algorithms.kinematics.manipulability import asada as asada
    from ulna.algorithms.kinematics.manipulability import manipulability as manipulability
    from ulna.algorithms.kinematics.manipulability import manipulability_gradient as manipulability_gradient
    from ulna.algorithms.kinematics.manipulability import measure_of as measure_of
    from ulna.algorithms.kinematics.staged_chains import stages_of_frame_jacobian as stages_of_frame_jacobian
    from ulna.algorithms.kinematics.staged_chains import stages_of_frame_pose as stages_of_frame_pose
    from ulna.algorithms.multibody.chain_frames import chain_frames as chain_frames
    from ulna.algorithms.multibody.external_forces import External as External
    from ulna.algorithms.multibody.external_forces import at_joints as at_joints
    from ulna.algorithms.multibody.references import Reference as Reference

_NAMES = {
    "constraints.dry_friction": ("velocity_after_friction",),
    "constraints.dynamics": (
        "ConstrainedMotion",
        "Impact",
        "Stabilisation",
        "constrained_dynamics",
        "delassus_matrix",
        "forward_dynamics_with_jacobian",
        "impulse_dynamics",
    ),
    "constraints.forward_dynamics_derivatives": (
        "ConstrainedDerivatives",
        "columns_of_constrained_derivatives",
        "constrained_dynamics_derivatives",
    ),
    "constraints.kinematics": (
        "constraint_bias",
        "constraint_error",
        "constraint_jacobian",
        "constraint_velocity",
    ),
    "constraints.proximal_settings": ("Proximal",),
    "constraints.staged": (
        "stages_of_constrained_derivatives",
        "stages_of_constrained_dynamics",
        "stages_of_impulse_dynamics",
    ),
    "derivatives.centroidal": ("centroidal_derivatives", "com_velocity_derivatives"),
    "derivatives.differentiated_rnea": ("aba_derivatives", "rnea_derivatives"),
    "derivatives.forward_dynamics": ("columns_of_derivatives", "forward_dynamics_derivatives"),
    "derivatives.inverse_dynamics": ("inverse_dynamics_derivatives",),
    "derivatives.serial_chains": ("is_serial", "stages_of_inverse_mass_matrix"),
    "derivatives.staged": (
        "stages_of_centroidal_derivatives",
        "stages_of_centroidal_matrix",
        "stages_of_coriolis_matrix",
        "stages_of_forward_dynamics_derivatives",
        "stages_of_inverse_dynamics_derivatives",
        "stages_of_mass_matrix",
    ),
    "derivatives.staged_operational_space": (
        "stages_of_operational_coriolis",
        "stages_of_operational_gravity",
        "stages_of_operational_inertia",
    ),
    "derivatives.staged_regressors": ("stages_of_gravity_regressor", "stages_of_joint_torque_regressor"),
    "derivatives.velocity": (
        "frame_acceleration_derivatives",
        "frame_velocity_derivatives",
        "motion_derivatives",
        "point_derivatives",
    ),
    "dynamics.aba": ("aba",),
    "dynamics.aba_relative_accelerations": ("articulated_body_dynamics",),
    "dynamics.center_of_mass": (
        "center_of_mass",
        "center_of_mass_acceleration",
        "center_of_mass_jacobian",
        "center_of_mass_velocity",
        "total_mass",
    ),
    "dynamics.centroidal": (
        "centroidal_inertia",
        "centroidal_matrix",
        "centroidal_matrix_dot",
        "centroidal_momentum",
        "centroidal_momentum_rate",
    ),
    "dynamics.coriolis": ("coriolis_matrix",),
    "dynamics.crba": ("crba", "mass_matrix"),
    "dynamics.energy": ("kinetic_energy", "mechanical_energy", "potential_energy"),
    "dynamics.forward_dynamics": ("by_mass_matrix", "forward_dynamics"),
    "dynamics.inverse_mass_matrix": ("columns_of_inverse_mass_matrix", "inverse_mass_matrix"),
    "dynamics.joint_friction": ("Friction", "friction_torque"),
    "dynamics.operational_space": (
        "Task",
        "operational_acceleration",
        "operational_coriolis",
        "operational_gravity",
        "operational_inertia",
    ),
    "dynamics.payload": ("payload_multiples",),
    "dynamics.regressors": (
        "body_regressor",
        "frame_regressor",
        "gravity_regressor",
        "joint_torque_regressor",
        "kinetic_energy_regressor",
        "potential_energy_regressor",
        "static_regressor",
    ),
    "dynamics.rnea": ("rnea",),
    "dynamics.rnea_point_accelerations": (
        "bias_forces",
        "gravity_forces",
        "inverse_dynamics",
        "joint_wrenches",
        "static_torque",
    ),
    "dynamics.staged_chains": (
        "stages_of_bias_forces",
        "stages_of_center_of_mass_jacobian",
        "stages_of_centroidal_momentum",
        "stages_of_inverse_dynamics",
        "stages_of_mechanical_energy",
    ),
    "kinematics.analytical_jacobian": ("Representation", "analytical_jacobian", "analytical_jacobian_dot"),
    "kinematics.configuration_space": (
        "coordinate_rates",
        "difference",
        "difference_derivatives",
        "distance",
        "integrate",
        "integrate_derivatives",
        "interpolate",
        "is_same",
        "neutral",
        "normalize",
        "random",
        "squared_distance",
    ),
    "kinematics.forward_kinematics": (
        "frame_acceleration",
        "frame_pose",
        "frame_poses",
        "frame_velocity",
        "joint_accelerations",
        "joint_poses",
        "joint_velocities",
    ),
    "kinematics.hessian": ("frame_hessian",),
    "kinematics.jacobian": ("frame_jacobian", "frame_jacobian_of", "joint_jacobians"),
    "kinematics.jacobian_dot": ("frame_jacobian_dot", "joint_jacobians_dot"),
    "kinematics.jacobian_partials": ("jacobian_partials",),
    "kinematics.manipulability": ("asada", "manipulability", "manipulability_gradient", "measure_of"),
    "kinematics.staged_chains": ("stages_of_frame_jacobian", "stages_of_frame_pose"),
    "multibody.chain_frames": ("chain_frames",),
    "multibody.external_forces": ("External", "at_joints"),
    "multibody.references": ("Reference",),
}
"""The public names of each file."""

_FILES = {name: file for file, names in _NAMES.items() for name in names}

__getattr__ = deferred_names(__name__, _FILES)


def __dir__() -> list[str]:
    return list(_FILES)
