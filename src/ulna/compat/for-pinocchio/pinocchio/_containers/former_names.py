"""Names of older versions of Pinocchio, and what has taken their place."""

from __future__ import annotations

_TABLES = {
    "pinocchio": """
        jacobian computeJointJacobian(model, data, q, joint_id)
        jacobians computeJointJacobians(model, data, q)
        computeJacobians computeJointJacobians(model, data, q)
        computeJacobian computeJointJacobian(model, data, q, joint_id)
        getJacobian getJointJacobian(model, data, joint_id, reference_frame)
        jointJacobian computeJointJacobian(model, data, q, joint_id)
        frameJacobian computeFrameJacobian(model, data, q, frame_id)
        framesKinematics framesForwardKinematics(model, data, q)
        crbaMinimal crba(model, data, q)
        kineticEnergy computeKineticEnergy(model, data, q, v)
        potentialEnergy computePotentialEnergy(model, data, q)
        computeCentroidalDynamics computeCentroidalMomentumTimeVariation(model, data, q, v, a)
        jacobianSubtreeCoMJacobian jacobianSubtreeCenterOfMass(model, data, joint_id)
        copyGeometryModel geometry_model.copy()
        getNeutralConfigurationFromSrdf loadReferenceConfigurations(model, file), model.referenceConfigurations
        removeCollisionPairsFromSrdf removeCollisionPairs(model, geometry_model, file)
        loadRotorParamsFromSrdf loadRotorParameters(model, file)
        RomeoWrapper RobotWrapper.BuildFromURDF(file), example_robot_data.load("romeo")
        romeo_wrapper RobotWrapper.BuildFromURDF(file), example_robot_data.load("romeo")
        se3ToXYZQUAT SE3ToXYZQUAT(M)
        se3ToXYZQUATtuple SE3ToXYZQUATtuple(M)
        XYZQUATToSe3 XYZQUATToSE3(x)
    """,
    "RobotWrapper": """
        increment q = pinocchio.integrate(robot.model, q, v)
        jacobian computeJointJacobian(q, joint_id)
        Jf computeFrameJacobian(q, frame_id)
        Mass mass(q)
        geometryObject visual_model.geometryObjects
        geom_model collision_model
        geometryModel collision_model
        computeAllTerms pinocchio.computeAllTerms(robot.model, robot.data, q, v)
        computeJacobians computeJointJacobians(q)
        generalizedAcceleration pinocchio.aba(robot.model, robot.data, q, v, tau)
    """,
    "GeometryObject": """
        parent parentJoint
        fcl geometry
    """,
    "GeometryModel": """
        geometryObject geometryObjects
    """,
}
_REPLACED = {
    owner: dict(line.split(maxsplit=1) for line in table.strip().splitlines())
    for owner, table in _TABLES.items()
}


def replacement_message(owner: str, name: str) -> str:
    """What to use in place of a name of an older version; empty for other names.

    Args:
        owner: "pinocchio", or the class that had it.
        name: The name.

    Returns:
        The message.
    """
    new = _REPLACED[owner].get(name.strip())
    return "" if new is None else f"It is a name of an older version; use {new}."
