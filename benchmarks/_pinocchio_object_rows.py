"""Rows of compat_pinocchio.py for small objects: what they are made of, what is assigned, operators, lists, frames."""

from __future__ import annotations

from typing import Any

ASSIGNMENTS = {
    "SE3.translation = view": "N.translation = M.translation",
    "SE3.rotation = R": "N.rotation = R",
    "Motion.linear = p": "w.linear = p",
    "Motion.vector = v": "w.vector = six",
    "Force.angular = p": "z.angular = p",
    "Inertia.mass = m": "Z.mass = 2.0",
    "Inertia.lever = p": "Z.lever = p",
    "Inertia.inertia = I": "Z.inertia = moments",
    "Quaternion.w = 1": "turned.w = 1.0",
    "Frame.placement = M": "frame.placement = M",
    "Frame.name = name": "frame.name = 'a'",
    "StdVec_Force[i] = f": "forces[1] = y",
    "data.oMi[i] = M": "data.oMi[1] = M",
    "data.oMi[i].translation = p": "data.oMi[1].translation = p",
    "model.inertias[i].mass = m": "model.inertias[1].mass = 2.0",
    "model.armature = a": "model.armature = armature",
}
CONSTRUCTORS = {
    "SE3()": "pin.SE3()",
    "SE3(matrix)": "pin.SE3(four)",
    "SE3(M.rotation, M.translation)": "pin.SE3(M.rotation, M.translation)",
    "SE3(quaternion, p)": "pin.SE3(quat, p)",
    "SE3.Interpolate": "pin.SE3.Interpolate(M, N, 0.3)",
    "Motion()": "pin.Motion()",
    "Motion(Motion)": "pin.Motion(x)",
    "Inertia(Inertia)": "pin.Inertia(Y)",
    "Inertia.FromBox": "pin.Inertia.FromBox(1.0, 0.1, 0.2, 0.3)",
    "Inertia.FromEllipsoid": "pin.Inertia.FromEllipsoid(1.0, 0.1, 0.2, 0.3)",
    "Inertia.FromSphere": "pin.Inertia.FromSphere(1.0, 0.1)",
    "Inertia.FromCylinder": "pin.Inertia.FromCylinder(1.0, 0.1, 0.2)",
    "Inertia.FromCapsule": "pin.Inertia.FromCapsule(1.0, 0.1, 0.2)",
    "Quaternion(w, x, y, z)": "pin.Quaternion(1.0, 0.0, 0.0, 0.0)",
    "Quaternion(M.rotation)": "pin.Quaternion(M.rotation)",
    "Quaternion(coefficients)": "pin.Quaternion(four[3])",
    "Quaternion.FromTwoVectors": "pin.Quaternion.FromTwoVectors(p, six[:3])",
    "AngleAxis(R)": "pin.AngleAxis(R)",
    "Frame(name, joint, frame, M, type)": "pin.Frame('a', 1, 0, M, kind)",
    "Frame(Frame)": "pin.Frame(frame)",
    "GeometryObject(name, joint, M, shape)": "pin.GeometryObject('a', 1, M, sphere)",
    "CollisionPair(0, 1)": "pin.CollisionPair(0, 1)",
    "StdVec_Force(7, f)": "pin.StdVec_Force(7, y)",
    "StdVec_SE3([...])": "pin.StdVec_SE3([M, N])",
    "JointModelRX()": "pin.JointModelRX()",
    "Model()": "pin.Model()",
}
OPERATIONS = {
    "SE3.act(point)": "M.act(p)",
    "SE3.act(view)": "M.act(N.translation)",
    "SE3.actInv(point)": "M.actInv(p)",
    "SE3.isIdentity": "M.isIdentity()",
    "Motion / 2": "x / 2.0",
    "Motion * 2 (whole)": "x * 2",
    "Motion / 2 (whole)": "x / 2",
    "Motion += Motion": "kept[0] += x",
    "Inertia += Inertia": "kept[1] += Y",
    "Motion == Motion": "x == w",
    "Motion.isZero": "x.isZero()",
    "Motion.setZero": "w.setZero()",
    "Motion.setRandom": "w.setRandom()",
    "Motion.se3Action": "x.se3Action(M)",
    "Motion.action": "x.action",
    "Motion.homogeneous": "x.homogeneous",
    "Inertia.isApprox": "Y.isApprox(Z)",
    "Inertia.vtiv": "Y.vtiv(x)",
    "Inertia.toDynamicParameters": "Y.toDynamicParameters()",
    "Inertia.FromDynamicParameters": "pin.Inertia.FromDynamicParameters(ten)",
    "Quaternion.normalized": "quat.normalized()",
    "Quaternion.inverse": "quat.inverse()",
    "Quaternion.norm": "quat.norm()",
    "Quaternion.slerp": "quat.slerp(0.3, turned)",
    "Quaternion.normalize": "turned.normalize()",
    "Quaternion *= Quaternion": "kept[2] *= quat",
    "Symmetric3 * vector": "symmetric * p",
    "Symmetric3 + Symmetric3": "symmetric + symmetric",
    "copy.copy(SE3)": "copy.copy(M)",
    "copy.deepcopy(Motion)": "copy.deepcopy(x)",
    "log3(M.rotation)": "pin.log3(M.rotation)",
    "log6(matrix)": "pin.log6(four)",
    "exp6_quat": "pin.exp6_quat(six)",
    "log6_quat": "pin.log6_quat(seven)",
    "Jlog6": "pin.Jlog6(M)",
    "rpy.matrixToRpy(M.rotation)": "pin.rpy.matrixToRpy(M.rotation)",
    "rpy.computeRpyJacobian": "pin.rpy.computeRpyJacobian(p)",
    "rpy.computeRpyJacobian, WORLD": "pin.rpy.computeRpyJacobian(p, pin.WORLD)",
    "rpy.computeRpyJacobianInverse": "pin.rpy.computeRpyJacobianInverse(p)",
    "rpy.computeRpyJacobianTimeDerivative": "pin.rpy.computeRpyJacobianTimeDerivative(p, p)",
    "classicAcceleration": "pin.classicAcceleration(x, w)",
    "classicAcceleration at a placement": "pin.classicAcceleration(x, w, M)",
    "rpy.rotate": "pin.rpy.rotate('x', 0.3)",
    "Frame.copy": "frame.copy()",
    "Frame == Frame": "frame == other",
    "str(Frame)": "str(frame)",
    "GeometryObject.copy": "geometry.copy()",
    "GeometryObject == GeometryObject": "geometry == same_geometry",
    "LieGroup.interpolate": "group.interpolate(seven, point, 0.3)",
    "LieGroup.dIntegrate_dv": "group.dIntegrate_dv(seven, six)",
    "LieGroup.dDifference": "group.dDifference(seven, point, pin.ARG1)",
    "LieGroup.tangentMap": "group.tangentMap(seven)",
    "LieGroup.normalize": "group.normalize(point)",
    "LieGroup * LieGroup": "group * group",
    "LogCholeskyParameters.toInertia": "logs.toInertia()",
    "LogCholeskyParameters.calculateJacobian": "logs.calculateJacobian()",
    "PseudoInertia.toDynamicParameters": "pseudo.toDynamicParameters()",
    "Inertia.toPseudoInertia": "Y.toPseudoInertia()",
    "Quaternion.setFromTwoVectors": "turned.setFromTwoVectors(p, six[:3])",
    "Symmetric3.rotate": "symmetric.rotate(R)",
    "StdVec_SE3[1:3]": "places[1:3]",
    "StdVec_SE3.copy": "places.copy()",
    "StdVec_SE3.append": "more.append(M)",
    "for M in StdVec_SE3": "for one in places: pass",
    "list(data.oMi)": "list(data.oMi)",
    "data.oMi[:]": "data.oMi[:]",
    "data.kinetic_energy": "data.kinetic_energy",
    "model.nframes": "model.nframes",
    "model.nqs": "model.nqs",
    "model.supports[i]": "model.supports[1]",
    "model.subtrees[i]": "model.subtrees[1]",
    "model.children[i]": "model.children[1]",
    "model.existBodyName": "model.existBodyName(body)",
    "model.getBodyId": "model.getBodyId(body)",
}
JOINTS = {
    "data.joints": "d.joints",
    "data.joints[i]": "d.joints[end]",
    "data.joints[i].M": "d.joints[end].M",
    "data.joints[i].S": "d.joints[end].S",
    "data.joints[i].M after kinematics": "pin.forwardKinematics(m, d, q); d.joints[end].M",
    "model.joints[i].createData": "m.joints[end].createData()",
    "model.joints[i].calc(data, q)": "joint.calc(joint_data, q)",
    "model.joints[i].calc(data, q, v)": "joint.calc(joint_data, q, v)",
    "model.joints[1].createData": "m.joints[1].createData()",
    "model.joints[1].calc(data, q, v)": "first.calc(first_data, q, v)",
    "JointModelRX().createData": "single.createData()",
    "JointModelRX().calc(data, q, v)": "single.calc(single_data, q[:1], v[:1])",
    "joint data.M": "joint_data.M",
    "joint data.S": "joint_data.S",
    "joint data.v": "joint_data.v",
}


def objects_to_change(pin: Any, names: dict[str, Any]) -> dict[str, Any]:
    """What the rows above name, besides what those of "objects" do.

    Args:
        pin: Pinocchio, or the package.
        names: What is there already: a model `m`, and small objects.

    Returns:
        The others.
    """
    import coal
    import numpy as np

    places, more, forces = pin.StdVec_SE3(), pin.StdVec_SE3(), pin.StdVec_Force(4, pin.Force.Random())
    places.extend([pin.SE3.Random() for _ in range(4)])
    M, model = names["M"], names["m"].copy()
    data, sphere = model.createData(), coal.Sphere(0.1)
    pin.computeAllTerms(model, data, pin.neutral(model), np.zeros(model.nv))
    frame = pin.Frame("a", 1, 0, M, pin.FrameType.OP_FRAME)
    return {
        **{"w": pin.Motion.Random(), "z": pin.Force.Random(), "Z": names["Y"].copy(), "four": M.homogeneous},
        **{"turned": pin.Quaternion(names["N"].rotation), "ten": names["Y"].toDynamicParameters()},
        **{"frame": frame, "other": pin.Frame(frame), "kind": pin.FrameType.OP_FRAME, "sphere": sphere},
        **{
            "geometry": pin.GeometryObject("a", 1, M, sphere),
            "same_geometry": pin.GeometryObject("a", 1, M, sphere),
            "kept": [pin.Motion.Random(), names["Y"].copy(), pin.Quaternion(names["N"].rotation)],
        },
        **{"places": places, "more": more, "forces": forces, "model": model, "data": data},
        "armature": np.zeros(model.nv),
        "symmetric": pin.Symmetric3.Random(),
        "group": pin.liegroups.SE3(),
        "point": np.array([0.1, 0.2, 0.3, 0.0, 0.0, 0.0, 1.0]),
        "logs": pin.LogCholeskyParameters(np.linspace(-0.2, 0.3, 10)),
        "pseudo": names["Y"].toPseudoInertia(),
        "body": next(f.name for f in model.frames if f.type == pin.FrameType.BODY),
        "refill": lambda title, count: more.__delitem__(slice(None)) if "append" in title else None,
    }


def joints_to_change(pin: Any, names: dict[str, Any]) -> dict[str, Any]:
    """What the rows of joints name: joints of a model, and one in none, with their data.

    Args:
        pin: Pinocchio, or the package.
        names: What is there already: a model `m`, its Data `d`, and a state.

    Returns:
        The others.
    """
    m, d, q, v, end = (names[x] for x in ("m", "d", "q", "v", "end"))
    pin.forwardKinematics(m, d, q, v)
    joint, first, single = m.joints[end], m.joints[1], pin.JointModelRX()
    single.setIndexes(1, 0, 0)
    made = {"joint": joint, "first": first, "single": single}
    return made | {f"{name}_data": one.createData() for name, one in made.items()}
