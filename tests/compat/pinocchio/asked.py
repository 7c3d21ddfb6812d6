"""What Ulna's package and Pinocchio are both asked, line by line, each in its own interpreter; answers go out as JSON.

`python asked.py out.json group robot`. A line that starts with `!` is a statement; every other one is an expression
whose value is kept.
"""

import io
import json
import sys
from contextlib import redirect_stdout

import numpy as np
import pinocchio as pin

SPATIAL = """
! R, S = pin.exp3(rng.normal(size=3)), pin.exp3(rng.normal(size=3)); p, r = rng.normal(size=(2, 3))
! A, B = pin.SE3(R, p), pin.SE3(S, r)
! m, n, f = pin.Motion(rng.normal(size=6)), pin.Motion(p, r), pin.Force(r, p)
! I = pin.Inertia(2.5, p, np.diag([0.5, 0.6, 0.7]) + 0.01); Y = pin.Symmetric3(np.diag([1.0, 2, 3]) + 0.2)
! Q, P = pin.Quaternion(R), pin.Quaternion(S); w = rng.normal(size=3)
R; A * B; A.inverse(); ~A; A.action; A.actionInverse; A.dualAction; A * m; A.actInv(m); A.act(f); A.actInv(f); A * r
A.actInv(r); A.actInv(B); A.act(I); A.actInv(I); A.homogeneous; A.isIdentity(); A.isApprox(A); A == B
(I - I).matrix(); pin.exp6_quat(np.arange(6.0))
str(A); repr(A); str(m); str(f); str(I); repr(I); str(Y); str(pin.Quaternion(1.0, 2.0, 3.0, 4.0))
m.cross(n); m ^ f; m.dot(f); f.dot(m); m.action; m.dualAction; m.homogeneous; m + n; m - n; -m; m * 2.0; 2.0 * m; m / 3.0
m.se3Action(A); f.se3ActionInverse(A); m.isZero(); pin.classicAcceleration(m, n); pin.classicAcceleration(m, n, A)
I * m; I + I; I.vtiv(m); I.toDynamicParameters(); I.vxi(m); I.ivx(m); I.vxiv(m); I.variation(m); I.inverse(); I.lever
I.inertia; I.mass; pin.Inertia.FromSphere(1.3, 0.2); pin.Inertia.FromEllipsoid(1.0, 0.1, 0.2, 0.3)
pin.Inertia.FromCylinder(1.0, 0.2, 0.5); pin.Inertia.FromBox(1.0, 0.2, 0.3, 0.4); pin.Inertia.FromCapsule(1.0, 0.2, 0.5)
pin.Inertia.FromDynamicParameters(I.toDynamicParameters()); pin.SE3.Interpolate(A, B, 0.3)
Y.data; Y.rotate(R).matrix(); Y.vtiv(p); (Y + Y).matrix(); Y * p
Q.coeffs(); (Q * P).coeffs(); Q * p; Q.slerp(0.3, P).coeffs(); Q.angularDistance(P); Q.inverse().coeffs(); Q.matrix()
pin.Quaternion.FromTwoVectors(p, r).coeffs(); Q.conjugate().coeffs(); Q.x; Q.w; Q.norm(); P.coeffs(); Q._transformVector(p); pin.log3(Q); pin.AngleAxis(0.1, p) == pin.AngleAxis(0.1, p.copy())
pin.AngleAxis(R).angle; pin.AngleAxis(R).axis; str(pin.AngleAxis(0.3, np.array([0.0, 0, 1]))); pin.AngleAxis(0.3, p).matrix()
pin.exp3(w); pin.log3(R); pin.exp6(m); pin.exp6(m.vector); pin.log6(A); pin.log6(A.homogeneous); pin.exp(w); pin.log(A); pin.log(R)
pin.Jexp3(w); pin.Jlog3(R); pin.Jexp6(m); pin.Jlog6(A); pin.exp3_quat(w); pin.exp6_quat(m.vector)
pin.SE3ToXYZQUAT(A); pin.SE3ToXYZQUATtuple(B); pin.XYZQUATToSE3(pin.SE3ToXYZQUAT(A)); pin.log6_quat(pin.SE3ToXYZQUAT(A))
pin.log6_quat(np.arange(7) // 6 * 1.0); pin.log6_quat(np.array([1, 2, 3, 1e-9, -2e-9, 1e-9, 1]))
pin.XYZQUATToSE3(1.004 * pin.SE3ToXYZQUAT(A)); pin.XYZQUATToSE3(tuple(0.997 * pin.SE3ToXYZQUAT(A)))
pin.log3(1.004 * pin.SE3ToXYZQUAT(A)[3:]); pin.log3(pin.Quaternion(0.997 * pin.SE3ToXYZQUAT(A)[3:]))
pin.Symmetric3(np.arange(9.0).reshape(3, 3) + 7 * np.eye(3)).matrix()
pin.skew(p); pin.unSkew(pin.skew(p)); pin.skewSquare(p, r); pin.rpy.rpyToMatrix(0.1, 0.2, 0.3); pin.rpy.rpyToMatrix(p)
pin.rpy.matrixToRpy(R); pin.rpy.rotate("y", 0.3); pin.rpy.computeRpyJacobian(p); pin.utils.rotate("x", 0.4)
pin.rpy.computeRpyJacobian(p, RF); pin.rpy.computeRpyJacobianInverse(p, RF); pin.rpy.computeRpyJacobianTimeDerivative(p, r, RF)
pin.utils.npToTuple(R); pin.utils.npToTuple(p); pin.utils.isapprox(A.homogeneous, A.homogeneous); pin.utils.eye(3); pin.utils.zero([2, 3])
printed(pin.utils.mprint, np.arange(1, 15.0).reshape(2, 7) / 7); printed(pin.utils.mprint, A); printed(pin.utils.mprint, p * 1e-7)
"""

GROUPS = """
! L = pin.liegroups; G = L.SE3() * L.SO2() * L.R2() * L.SE2() * L.SO3() * L.Rn(4); x, y = rng.normal(size=(2, G.nv))
! q, k = (G.integrate(G.neutral, 0.5 * u) for u in (x, y))
G.name; G.nq; G.nv; G.neutral; q; G.difference(q, k); G.interpolate(q, k, 0.3); G.distance(q, k); G.squaredDistance(q, k)
G.dIntegrate_dq(q, x); G.dIntegrate_dv(q, x); G.dDifference(q, k, pin.ARG0); G.dDifference(q, k, pin.ARG1)
pin.JointModelRX().lieGroup().name; pin.JointModelRUBX().lieGroup().name; pin.JointModelFreeFlyer().lieGroup().name
! m = pin.buildSampleModelManipulator(); d = m.createData(); q, v = rng.normal(size=(2, 6)); Q = rng.normal(size=(6, 5))
pin.lieGroup(m).name; str(m); [f.name for f in m.frames]; [f.parentFrame for f in m.frames]; list(m.inertias); m.upperEffortLimit
pin.rnea(m, d, q, v, v); pin.rneaInParallel(1, pin.ModelPool(m, 1), Q, Q, Q); pin.abaInParallel(1, pin.ModelPool(m, 1), Q, Q, Q)
! t, w = np.zeros((2, 6, 5)); pool = pin.ModelPool(m, 1); _ = pin.rneaInParallel(1, pool, Q, Q, Q, t), pin.abaInParallel(1, pool, Q, Q, Q, w)
t; w; pin.rneaInParallel(num_thread=1, pool=pool, q=Q, v=Q, a=Q)
! M = pin.crba(m, d, q)
pin.cholesky.decompose(m, d); pin.cholesky.solve(m, d, v); pin.cholesky.computeMinv(m, d); pin.linalg.inv(M)
"""

MODEL = """
list(m.names); [j.shortname() for j in m.joints]; [f.name for f in m.frames]; [str(f.type) for f in m.frames]
list(m.parents); [f.parentJoint for f in m.frames]; [f.parentFrame for f in m.frames]; [f.placement for f in m.frames]
[f.inertia for f in m.frames]; list(m.nqs); list(m.nvs); list(m.idx_qs); list(m.idx_vs); list(m.idx_vExtendeds)
m.nq; m.nv; m.njoints; m.nframes; m.nbodies; m.nvExtended; m.name; list(m.jointPlacements)[1:]; list(m.inertias)
str(m); str(m.joints[2]); finite(m.lowerPositionLimit); finite(m.upperPositionLimit); finite(m.upperVelocityLimit)
finite(m.velocityLimit); finite(m.effortLimit); m.damping; m.friction; m.armature; m.rotorGearRatio; m.gravity; list(m.joints)[1].nq
[list(s) for s in m.supports][-1]; [list(s) for s in m.subtrees][1]; [list(s) for s in m.children][0]
list(m.hasConfigurationLimit()); list(m.hasConfigurationLimitInTangent())
pin.neutral(m); q; pin.difference(m, q, k); pin.interpolate(m, q, k, 0.3); pin.distance(m, q, k); pin.isNormalized(m, q)
pin.dIntegrate(m, q, v); pin.dDifference(m, q, k); pin.dIntegrate(m, q, v, pin.ARG0); pin.isSameConfiguration(m, q, k, 1e-9)
pin.dIntegrateTransport(m, q, v, np.eye(m.nv), pin.ARG1)
"""

KINEMATICS = """
! pin.forwardKinematics(m, d, q, v, a)
list(d.oMi); list(d.liMi)[1:]; list(d.v)[1:]; list(d.a)[1:]
! pin.updateFramePlacements(m, d)
list(d.oMf); pin.updateFramePlacement(m, d, last); (pin.framesForwardKinematics(m, d, q), list(d.oMf))[1]
! pin.forwardKinematics(m, d, q, v, a)
pin.getVelocity(m, d, end, RF); pin.getAcceleration(m, d, end, RF); pin.getClassicalAcceleration(m, d, end, RF)
pin.getFrameVelocity(m, d, last, RF); pin.getFrameAcceleration(m, d, last, RF); pin.getFrameVelocity(m, d, end, M, RF)
pin.getFrameClassicalAcceleration(m, d, last, RF); pin.getVelocity(m, d, end); pin.getFrameVelocity(m, d, last)
pin.centerOfMass(m, d, q); list(d.com); list(d.mass); pin.centerOfMass(m, d, q, v, a); list(d.vcom); list(d.acom)
pin.jacobianCenterOfMass(m, d, q); pin.computeTotalMass(m); (pin.computeSubtreeMasses(m, d), list(d.mass))[1]
pin.rnea(m, d, q, v, a); d.tau; list(d.f)[1:]; list(d.a_gf)[1:]; list(d.h)[1:]; pin.rnea(m, d, q, v, a, forces); list(d.f)[1:]
pin.crba(m, d, q); d.M; pin.nonLinearEffects(m, d, q, v); pin.nle(m, d, q, v); pin.computeGeneralizedGravity(m, d, q)
pin.computeStaticTorque(m, d, q, forces); pin.ccrba(m, d, q, v); d.hg; d.Ig.inertia; pin.computeCentroidalMomentum(m, d, q, v)
pin.computeCentroidalMomentumTimeVariation(m, d, q, v, a); pin.computeCentroidalMap(m, d, q)
"""

NOT_WITH_MIMIC = """
pin.computeJointJacobians(m, d, q); d.J; (pin.updateFramePlacements(m, d), pin.getJointJacobian(m, d, end, RF))[1]
pin.getFrameJacobian(m, d, last, RF); pin.computeFrameJacobian(m, d, q, last, RF); pin.getFrameJacobian(m, d, end, M, RF)
pin.computeJointJacobian(m, d, q, end); pin.computeFrameJacobian(m, d, q, last); pin.computeJointJacobiansTimeVariation(m, d, q, v)
! pin.updateFramePlacements(m, d)
pin.getJointJacobianTimeVariation(m, d, end, RF); pin.getFrameJacobianTimeVariation(m, d, last, RF)
pin.frameJacobianTimeVariation(m, d, q, v, last, pin.WORLD); pin.squaredDistance(m, q, k)
pin.aba(m, d, q, v, tau); d.ddq; pin.aba(m, d, q, v, tau, forces); pin.aba(m, d, q, v, tau, pin.Convention.WORLD)
pin.computeMinverse(m, d, q); pin.computeCoriolisMatrix(m, d, q, v); pin.jacobianSubtreeCenterOfMass(m, d, q, 2)
(pin.computeAllTerms(m, e, q, v), e.M)[1]; e.nle; e.g; e.J; e.dJ; e.Jcom; e.Ag; e.hg; e.com[0]; e.vcom[0]; list(e.oMi)
e.kinetic_energy; e.potential_energy; e.mechanical_energy; pin.dccrba(m, d, q, v); pin.computeCentroidalMapTimeVariation(m, d, q, v)
pin.computeKineticEnergy(m, d, q, v); pin.computePotentialEnergy(m, d, q); pin.computeMechanicalEnergy(m, d, q, v)
pin.computeRNEADerivatives(m, d, q, v, a); pin.computeRNEADerivatives(m, d, q, v, a, forces)
pin.computeABADerivatives(m, d, q, v, tau); d.ddq; pin.computeABADerivatives(m, d, q, v, tau, forces)
pin.computeGeneralizedGravityDerivatives(m, d, q); pin.computeStaticTorqueDerivatives(m, d, q, forces)
! pin.computeForwardKinematicsDerivatives(m, d, q, v, a); pin.updateFramePlacements(m, d)
pin.getJointVelocityDerivatives(m, d, end, RF); pin.getFrameVelocityDerivatives(m, d, last, RF)
pin.getPointVelocityDerivatives(m, d, end, M, pin.LOCAL); pin.getPointVelocityDerivatives(m, d, end, M, pin.LOCAL_WORLD_ALIGNED)
pin.getPointClassicAccelerationDerivatives(m, d, end, M, pin.LOCAL)
pin.getPointClassicAccelerationDerivatives(m, d, end, M, pin.LOCAL_WORLD_ALIGNED)
pin.getJointAccelerationDerivatives(m, d, end, RF); pin.getFrameAccelerationDerivatives(m, d, last, RF)
! pin.centerOfMass(m, d, q, v)
pin.getCenterOfMassVelocityDerivatives(m, d); pin.computeCentroidalDynamicsDerivatives(m, d, q, v, a)
pin.computeJointTorqueRegressor(m, d, q, v, a); pin.computeStaticRegressor(m, d, q); pin.computeKineticEnergyRegressor(m, d, q, v)
pin.computePotentialEnergyRegressor(m, d, q); pin.bodyRegressor(pin.Motion(tau[:6]), pin.Motion(v[:6]))
! pin.forwardKinematics(m, d, q, v, a); pin.rnea(m, d, q, v, a)
pin.jointBodyRegressor(m, d, end); pin.frameBodyRegressor(m, d, last); list(pin.findCommonAncestor(m, end, 2))
! small = pin.buildReducedModel(m, [2, 4], q)
list(small.names); [f.name for f in small.frames]; [str(f.type) for f in small.frames]; list(small.jointPlacements)[1:]
list(small.inertias); [f.placement for f in small.frames]; [f.parentJoint for f in small.frames]; finite(small.upperPositionLimit)
! pair = pin.appendModel(m, other, last, M)
list(pair.names); list(pair.parents); list(pair.jointPlacements)[1:]; list(pair.inertias); finite(pair.lowerPositionLimit)
"""


def plain(value):
    """The value as lists of numbers, or as text."""
    if isinstance(value, str):
        return value
    if hasattr(value, "toDynamicParameters"):
        value = value.matrix()
    value = getattr(value, "vector", getattr(value, "homogeneous", value))
    if type(value).__name__.startswith("StdVec") or isinstance(value, (list, tuple)):
        return [plain(entry) for entry in value]
    return np.asarray(value, dtype=float).tolist()


def printed(function, *args):
    out = io.StringIO()
    with redirect_stdout(out):
        function(*args)
    return out.getvalue().replace(" \n", "\n")


def finite(limits):
    return np.clip(limits, -1e9, 1e9)


def prepared(file, root, mimic, other):
    """The names that lines about models use."""
    root_joint = [getattr(pin, f"JointModel{root}")()] if root else []
    m = pin.buildModelFromUrdf(file, *root_joint, **({"mimic": True} if mimic else {}))
    rng = np.random.default_rng(5)
    q, k = (pin.integrate(m, pin.neutral(m), rng.uniform(-1, 1, m.nv)) for _ in range(2))
    v, a, tau = rng.normal(size=(3, m.nv))
    forces = [pin.Force(rng.normal(size=6)) for _ in range(m.njoints)]
    M = pin.XYZQUATToSE3(np.array([0.1, 0.2, 0.3, 0.0, 0.0, np.sin(0.3), np.cos(0.3)]))
    names = {"m": m, "d": m.createData(), "e": m.createData(), "q": q, "k": k, "v": v, "a": a, "tau": tau}
    names |= {"forces": forces, "M": M, "last": m.nframes - 1, "end": m.njoints - 1}
    second = pin.buildModelFromUrdf(other)
    for frame in second.frames:
        frame.name = frame.name if frame.name == "universe" else "second " + frame.name
    return names | {"other": second}


def answers(text, names):
    found = {}
    for line in text.strip().splitlines():
        if line.startswith("!"):
            exec(line[1:].strip(), globals() | names, names)
            continue
        for expression in (part.strip() for part in line.split(";") if part.strip()):
            for rf in ("LOCAL", "WORLD", "LOCAL_WORLD_ALIGNED") if "RF" in expression else ("",):
                said = expression.replace("RF", f"pin.{rf}")
                found[f"{len(found)} {said}"] = plain(eval(said, globals() | names))
    return found


if __name__ == "__main__":
    target, group, *robot = sys.argv[1:]
    if group == "spatial":
        result = answers(SPATIAL + GROUPS, {"rng": np.random.default_rng(3)})
    else:
        file, root, mimic, other = robot
        text = MODEL + KINEMATICS + ("" if mimic else NOT_WITH_MIMIC)
        result = answers(text, prepared(file, root, mimic, other))
    with open(target, "w", encoding="utf-8") as out:
        out.write(json.dumps({"file": pin.__file__, "answers": result}))
