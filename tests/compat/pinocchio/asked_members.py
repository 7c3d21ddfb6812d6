"""What the package and Pinocchio are both asked of members: of spatial classes, of RobotWrapper, of geometries, joints and cones.

`python asked_members.py out.json urdf srdf share`: lines as in `asked.py`; an exception is an answer, too.
"""

import copy
import json
import sys

import numpy as np
import pinocchio as pin
from asked import plain

SPATIAL = """
! S = pin.Symmetric3(np.diag([1.0, 2, 3]) + 0.2); Z = pin.Symmetric3(np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])); p, r = rng.normal(size=(2, 3))
pin.Symmetric3(1.0, 2.0, 3.0, 4.0, 5.0, 6.0); pin.Symmetric3(Z); pin.Symmetric3(Z.data); pin.Symmetric3.Zero(); pin.Symmetric3.Identity(); type(pin.Symmetric3()).__name__
pin.Symmetric3.Random().data.shape; Z.inverse(np.zeros(3))
Z - S; Z + S; Z == pin.Symmetric3(Z); Z == S; Z != S; Z == 3
Z.isZero(); (Z - Z).isZero(); pin.Symmetric3(np.full(6, 1e-13)).isZero(); pin.Symmetric3(np.full(6, 0.1)).isZero(0.2); pin.Symmetric3(np.full(6, 0.1)).isZero(0.05)
Z.isApprox(Z); Z.isApprox(S); Z.isApprox(pin.Symmetric3(Z.data + 1e-13)); Z.isApprox(pin.Symmetric3(Z.data + 0.01), 0.1); Z.isApprox(pin.Symmetric3(Z.data + 0.01), 1e-3)
copy.copy(Z); copy.deepcopy(Z); copy.copy(Z) is Z
! Y = pin.Symmetric3(Z); Y += S; X = pin.Symmetric3(Z); X -= S; W = pin.Symmetric3(Z); W.fill(0.7); V = pin.Symmetric3(Z); V.setDiagonal(p)
! U = pin.Symmetric3(Z); U.setZero(); T = pin.Symmetric3(Z); T.setIdentity(); R = pin.Symmetric3(Z); R.setRandom(); D = pin.Symmetric3(Z); D.data = np.arange(6.0)
Y; X; W; V; U; T; R == Z; D; Z.vtiv(r); Z.matrix(); Z * p
! I = pin.Inertia(2.5, p, np.diag([0.5, 0.6, 0.7]) + 0.01); m = pin.Motion(p, r); f = pin.Force(r, p); n = pin.Motion(r, 2 * p)
pin.Inertia(I); pin.Inertia.Zero(); pin.Inertia.Random().mass > 0; pin.Inertia(1.0, p); pin.Inertia("a", p, S)
np.array(I); I.np; I.isApprox(I); I.isApprox(pin.Inertia(2.6, p, I.inertia)); I.isApprox(pin.Inertia(2.5001, p, I.inertia), 1e-3); I.isZero(); (I - I).isZero(); I == pin.Inertia(I); I != I; I == 3
copy.copy(I); copy.copy(I) is I; I * m; I.toPseudoInertia().toMatrix(); I.inertia; I.se3Action(A); I.se3ActionInverse(A)
! J = pin.Inertia(I); J.setZero(); K = pin.Inertia(I); K.setIdentity(); H = pin.Inertia(I); H.setRandom(); G = pin.Inertia(I); G += I; E = pin.Inertia(I); E.mass = 7.0; E.lever = r; E.inertia = np.eye(3)
J; K; H == I; G; E
pin.Motion.Random().vector.shape; pin.Force.Random().vector.shape; pin.Motion(m); type(pin.Motion()).__name__; pin.Motion(1, 2, 3); pin.Force("a"); m.np; f.np; m.cross(f); m.cross(n); m.cross(3); m ^ n; m ^ f; m == n; m == pin.Motion(m); m != n; m == 3; f == 3
! a = pin.Motion(m); a.angular = r; a.linear = p; b = pin.Motion(m); b.vector = np.arange(6.0); c = pin.Motion(m); c.setZero(); d = pin.Motion(m); d.setRandom(); e = pin.Force(f); e -= f; g = pin.Force(f); g += f; h = pin.Motion(m); h -= n
a; b; c; d == m; e; g; h; m.isApprox(n); m.isApprox(pin.Motion(m.vector + 1e-13)); m.isApprox(pin.Motion(m.vector + 0.01), 0.1); m.isZero(); c.isZero(); pin.Motion(np.full(6, 0.1)).isZero(0.2); -f; f * 2.0; f / 4.0; 3.0 * f; f - g; f.dot(m); copy.copy(m); copy.deepcopy(f)
f.se3Action(A); m.se3ActionInverse(A); m.toHomogeneousMatrix() if hasattr(m, "toHomogeneousMatrix") else 0; m.action; f.isZero(); f.isApprox(g); f.isApprox(pin.Force(f.vector + 1e-13))
! P = I.toPseudoInertia(); L = pin.LogCholeskyParameters(0.3 * np.arange(10.0) / 10); C = pin.LogCholeskyParameters(L.parameters.copy())
copy.copy(P); P == 3; P == pin.PseudoInertia(1.0, P.h, P.sigma); np.array(P); L == 3; copy.copy(L).parameters; L.toPseudoInertia()
C.toDynamicParameters()[0]; pin.PseudoInertia("a", 1, 2)
"""

ROTATIONS = """
! p, r = rng.normal(size=(2, 3)); Q = pin.Quaternion(pin.exp3(p)); P = pin.Quaternion(pin.exp3(r)); A = pin.SE3(pin.exp3(p), r); B = pin.SE3(pin.exp3(r), p)
pin.Quaternion(p, r); pin.Quaternion(4.0, 1.0, 2.0, 3.0); pin.Quaternion(np.array([1.0, 2, 3, 4])); pin.Quaternion(Q); pin.Quaternion(pin.AngleAxis(0.3, np.array([0, 0, 1.0]))); pin.Quaternion("a"); pin.Quaternion(1, 2, 3)
Q.vec(); pin.Quaternion(4.0, 1.0, 2.0, 3.0).normalized(); pin.Quaternion(4.0, 1.0, 2.0, 3.0).norm(); pin.Quaternion(4.0, 1.0, 2.0, 3.0).squaredNorm(); Q.dot(P); Q.isApprox(P); Q.isApprox(pin.Quaternion(Q.coeffs() + 1e-13)); Q.isApprox(pin.Quaternion(Q.coeffs() + 0.01), 0.1); Q.isApprox(pin.Quaternion(Q.coeffs() + 0.01), 1e-3)
Q[0]; Q[1]; Q[2]; Q[3]; Q[4]; Q[-5]; Q == P; Q != P; Q == pin.Quaternion(Q); Q == 3; Q.x; Q.y; Q.z; Q.w; pin.Quaternion.Identity(); str(pin.Quaternion.Identity()); Q.toRotationMatrix(); Q.inverse(); pin.Quaternion(4.0, 1.0, 2.0, 3.0).inverse(); Q.conjugate(); Q * P; Q * p; Q.slerp(0.0, P); Q.slerp(1.0, P); Q.slerp(0.7, P); Q.slerp(0.3, pin.Quaternion(-Q.coeffs())); Q.angularDistance(P); Q.angularDistance(Q)
! a = pin.Quaternion(Q); a.setIdentity(); b = pin.Quaternion(Q); b[1] = 5.0; c = pin.Quaternion(4.0, 1.0, 2.0, 3.0); c.normalize(); d = pin.Quaternion(Q); d.assign(P); e = pin.Quaternion(Q); e.setFromTwoVectors(p, r); f = pin.Quaternion(Q); f.x = 9.0; f.w = 8.0; f.y = 7.0; f.z = 6.0; g = pin.Quaternion(Q); g *= P
a; b; c; d; e; f; g; pin.Quaternion.FromTwoVectors(p, -p).norm(); pin.Quaternion.FromTwoVectors(p, 2 * p); pin.Quaternion(Q).assign(3)
! u = pin.AngleAxis(0.4, np.array([0.6, 0.8, 0.0])); v = pin.AngleAxis(-0.2, np.array([0, 0, 1.0]))
u; pin.AngleAxis(u); pin.AngleAxis(Q); pin.AngleAxis(Q.matrix()); pin.AngleAxis("a"); u.inverse(); u.matrix(); u.toRotationMatrix(); u * v; u * Q; u * p; u.isApprox(v); u.isApprox(pin.AngleAxis(0.4 + 1e-13, u.axis)); u.isApprox(pin.AngleAxis(0.41, u.axis), 0.1); u == v; u == pin.AngleAxis(0.4, np.array([0.6, 0.8, 0.0])); u != v; str(u); pin.AngleAxis(pin.Quaternion.Identity()).angle; pin.AngleAxis(pin.Quaternion(-1.0, 0.0, 0.0, 0.0)).angle
! w = pin.AngleAxis(u); w.angle = 1.5; w.axis = np.array([0, 1.0, 0])
w; w.matrix(); (w.fromRotationMatrix(Q.matrix()), w)[1]
pin.SE3(A); pin.SE3(1); pin.SE3(Q, p); pin.SE3(A.homogeneous); pin.SE3(pin.SE3ToXYZQUAT(A)); pin.SE3("a"); pin.SE3.Random().homogeneous[3]; pin.SE3.Identity(); np.array(A); A.np; A * B; A.act(p); A.actInv(p); A.act(np.ones(4)); A.act(3); A * 3; A == B; A == 3; A != B; A == pin.SE3(A); A.isApprox(B); A.isApprox(pin.SE3(A.rotation, A.translation + 1e-13)); A.isApprox(pin.SE3(A.rotation, A.translation + 0.01), 0.1); A.isIdentity(); pin.SE3.Identity().isIdentity(); pin.SE3(np.eye(3), np.full(3, 0.01)).isIdentity(0.1); pin.SE3(np.eye(3), np.full(3, 0.01)).isIdentity(1e-3); copy.copy(A); copy.deepcopy(A); copy.copy(A) is A
! C = pin.SE3(A); C.setIdentity(); D = pin.SE3(A); D.setRandom(); E = pin.SE3(A); E.translation = r; E.rotation = pin.exp3(r); F = pin.SE3(pin.coal.Transform3s(A.rotation, A.translation)) if hasattr(pin, "coal") else A
C; D == A; E; F; A.act(pin.Motion(p, r)); A.act(pin.Force(p, r)); A.actInv(pin.Force(p, r)); A.toActionMatrix(); pin.SE3.Interpolate(A, B, 0.0); pin.SE3.Interpolate(A, B, 1.0); pin.SE3.Interpolate(A, B, 0.6)
pin.exp(0.3); pin.exp(np.arange(6.0)); pin.exp(pin.Motion(p, r)); pin.exp(np.ones(4)); pin.log(2.0); pin.log(A); pin.log(A.homogeneous); pin.log(np.ones((2, 2))); pin.log3(Q.matrix(), th); th; pin.log3(Q.matrix()); pin.exp6(pin.Motion(p, r).vector); pin.Jexp6(pin.Motion.Zero()); pin.Jlog6(pin.SE3.Identity()); pin.Jexp3(np.zeros(3)); pin.Jlog3(np.eye(3)); pin.exp3(np.zeros(3)); pin.exp3(np.full(3, 1e-9)); pin.log3(np.eye(3)); pin.log6(pin.SE3.Identity()); pin.exp3_quat(np.zeros(3)); pin.Jexp3(np.full(3, 1e-5)); pin.Jlog3(pin.exp3(np.full(3, 1e-5))); pin.Jexp6(pin.Motion(np.full(6, 1e-5))); pin.Jlog6(pin.exp6(pin.Motion(np.full(6, 1e-5)))); pin.log3(pin.exp3(np.array([0, 0, 3.1415926])))
pin.utils.rand(4).shape; pin.utils.npToTTuple(np.eye(2)) ; pin.utils.npToTuple(p); pin.utils.rotate("z", 0.2); pin.utils.rotate("w", 0.2); pin.utils.isapprox(p, r); pin.utils.isapprox(1.0, 1.0 + 1e-9); pin.utils.isapprox(p, p + 1e-3, 1e-2); pin.utils.eye(2); pin.utils.zero(3); pin.utils.fromListToVectorOfString(["a", "b"]); pin.rpy.rotate("w", 0.1); pin.rpy.rpyToMatrix(np.zeros(4)); pin.rpy.matrixToRpy(pin.rpy.rpyToMatrix(0.1, np.pi / 2, 0.3)) @ np.zeros(3)
"""

WRAPPER = """
! R = pin.RobotWrapper.BuildFromURDF(urdf, [share]); q, k, v, a = rng.uniform(-1, 1, (4, R.nq)); n = R.model.nframes - 1
R.nq; R.nv; R.index("elbow_joint"); R.com(q); list(R.com(q, v)); list(R.com(q, v, a)); R.com(); R.vcom(q, v); R.acom(q, v, a); R.Jcom(q); R.centroidalMomentum(q, v); R.centroidalMap(q); list(R.centroidal(q, v)); R.centroidalMomentumVariation(q, v, a)
R.mass(q); R.nle(q, v); R.gravity(q); R.placement(q, 3); (R.forwardKinematics(k), R.placement(q, 3, False))[1]; R.framePlacement(q, n); (R.forwardKinematics(k), R.framePlacement(q, n, False))[1]; (R.framesForwardKinematics(q), R.data.oMf[n])[1]
R.velocity(q, v, 4); R.velocity(q, v, 4, True, RF); (R.forwardKinematics(k, a), R.velocity(q, v, 4, False))[1]; R.acceleration(q, v, a, 4); R.acceleration(q, v, a, 4, True, RF); (R.forwardKinematics(k, a, v), R.acceleration(q, v, a, 4, False))[1]
R.classicalAcceleration(q, v, a, 4); R.classicalAcceleration(q, v, a, 4, True, RF); R.frameVelocity(q, v, n); R.frameVelocity(q, v, n, True, RF); R.frameAcceleration(q, v, a, n); R.frameAcceleration(q, v, a, n, True, RF); R.frameClassicalAcceleration(q, v, a, n); R.frameClassicalAcceleration(q, v, a, n, True, RF)
R.computeJointJacobians(q); R.computeJointJacobian(q, 5); R.getJointJacobian(5); R.getJointJacobian(5, RF); R.computeFrameJacobian(q, n); R.getFrameJacobian(n); R.getFrameJacobian(n, RF)
! S = R.buildReducedRobot(["elbow_joint", 2], q); T = R.buildReducedRobot(["elbow_joint"])
list(S.model.names); list(S.model.jointPlacements)[1:]; [S.visual_model.ngeoms, S.collision_model.ngeoms]; list(T.model.jointPlacements)[1:]; list(T.model.inertias); [g.placement for g in S.visual_model.geometryObjects]; T.q0; R.q0; R.nothing
! _ = R.model.addFrame(pin.Frame("grip", 3, 0, pin.SE3.Identity(), pin.OP_FRAME)); R.rebuildData()
len(R.data.oMf); len(R.collision_data.oMg); len(R.visual_data.oMg); pin.RobotWrapper(pin.buildSampleModelManipulator()).nq; pin.RobotWrapper(R.model, R.collision_model).visual_model is None
"""

MODELS = """
! m = pin.buildSampleModelManipulator(); d = m.createData(); q, v, a = rng.normal(size=(3, 6)); h = pin.buildSampleModelHumanoid(); L = pin.liegroups
pin.Frame("a", 1, 0, pin.SE3.Identity(), pin.BODY) == pin.Frame("a", 1, 0, pin.SE3.Identity(), pin.BODY); pin.Frame("a", 1, 0, pin.SE3.Identity(), pin.BODY) == pin.Frame("b", 1, 0, pin.SE3.Identity(), pin.BODY); pin.Frame(3, 1, 0, pin.SE3.Identity(), pin.BODY); pin.Frame("a", 1, 0, pin.SE3.Identity(), 3.5); pin.Frame(m.frames[3]).name; copy.copy(m.frames[3]).name; m.frames[3] == m.frames[3].copy(); m.frames[3] != m.frames[4]; m.frames[3] == 3
m.joints[2] == m.joints[2].copy() if hasattr(m.joints[2], "copy") else True; m.joints[1] == m.joints[2]; m.joints[2].id; pin.JointModelRevoluteUnaligned(np.array([0.6, 0.8, 0])).axis; pin.JointModelUniversal(1, 0, 0, 0, 1, 0).axis1; pin.JointModelRX() == pin.JointModelRY(); pin.JointModelRX() == pin.JointModelRX()
L.R3() == L.R3(); L.R3() == L.R1(); L.SO3() * L.R1() == L.SO3() * L.R1(); L.R3() == 3; L.R3() != L.R1(); (L.SO3() * L.R2()).name; L.SE2().nq; L.Rn(5).nv; L.R3().isNormalized(np.ones(3)) if hasattr(L.R3(), "isNormalized") else 0; L.SO2().isSameConfiguration(np.array([1.0, 0]), np.array([1.0, 1e-13]), 1e-9); L.SO2().isSameConfiguration(np.array([1.0, 0]), np.array([0, 1.0]), 1e-9)
! G = L.SE3() * L.SO2(); w = G.integrate(G.neutral, 0.3 * np.arange(7.0) / 7); u = 0.2 * np.arange(7.0); z = G.integrate(w, u); J = rng.normal(size=(7, 7))
G.dIntegrate_dq(w, u, 0, J); G.dIntegrate_dq(w, u, J, 0); G.dIntegrate_dv(w, u, 0, J); G.dIntegrate_dv(w, u, J, 0); G.dDifference(w, z, pin.ARG0, J, 0); G.dDifference(w, z, pin.ARG1, 0, J); G.dIntegrate_dq(w, u, J, J); G.squaredDistance(w, z); G.distance(w, z); G.interpolate(w, z, 0.25)
! K = pin.LieGroup()
K.nq; K.nv; K.name; len(K.neutral); m.lowerPositionLimit is None; pin.randomConfiguration(m, -np.ones(6), -np.ones(6)); pin.randomConfiguration(3); pin.integrate(3, q, v); pin.difference(3, q, v); pin.dIntegrate(m, q, v, 7); pin.neutral("m"); pin.squaredDistance(h, pin.neutral(h), pin.integrate(h, pin.neutral(h), 0.1 * np.ones(h.nv))); pin.isNormalized(h, 1.5 * pin.neutral(h)); pin.isNormalized(h, pin.neutral(h) + 1e-6, 1e-3); pin.isNormalized(h, pin.neutral(h) + 1e-2, 1e-3); [pin.isNormalized(h, np.r_[np.zeros(3), np.full(4, 0.5 + s), np.zeros(h.nq - 7)], 2e-3) for s in (8e-4, 1.2e-3, -8e-4, -1.2e-3, -0.5)]; pin.isNormalized(h, pin.neutral(h), 0.0); pin.isNormalized(h, pin.neutral(h), -1.0); pin.isNormalized(h, pin.neutral(h), np.nan); pin.isSameConfiguration(m, q, q, np.nan); pin.tangentMapProduct(m, q, np.ones((2, 6, 3))); pin.tangentMapProduct(m, q, np.ones(5)); pin.tangentMapTransposeProduct(m, q, np.ones(7)); pin.isSameConfiguration(m, q, q + 1e-6, 1e-3); pin.isSameConfiguration(m, q, q + 1e-2, 1e-3)
m.addFrame("a"); m.existFrame("tool"); m.existFrame("nothing"); m.existFrame("effector_body", pin.BODY); m.existFrame("effector_body", pin.JOINT); m.existJointName("wrist1_joint"); m.existBodyName("nothing"); m.getFrameId("effector_body", pin.BODY); m.getFrameId("effector_body", pin.JOINT) >= m.nframes; m.check(d); m.check(h.createData()); m.getFrameId("a", 3.5); pin.computeTotalMass(m); pin.computeTotalMass(m, d); pin.forwardKinematics(m, d); pin.buildReducedModel(m, [1], q[:3]); pin.buildReducedModel(m, [], q).nq; pin.buildReducedModel(m, [2, 2], q); pin.buildReducedModel(m, [2, 1, 2], q)
! n = pin.Model(); i = n.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), "one"); j = n.addJoint(i, pin.JointModelRZ(), pin.SE3.Identity(), "two", np.array([5.0]), np.array([6.0]), np.array([-1.0]), np.array([1.0]))
n.friction; n.damping; finite(n.upperEffortLimit); finite(n.lowerPositionLimit); finite(n.upperPositionLimit); finite(n.upperVelocityLimit); n.addJoint(9, pin.JointModelRX(), pin.SE3.Identity(), "x"); n.addJoint(0, 3, pin.SE3.Identity(), "x"); n.addJointFrame(2); n.addBodyFrame("body", 2, pin.SE3.Identity(), -1); n.nframes; n.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), "y", np.array([5.0]))
! n.gravity = pin.Motion(np.arange(3.0), np.zeros(3)); b = n.gravity.vector.copy(); n.gravity.linear = np.array([1.0, 2, 3]); n.gravity.angular = np.zeros(3); n.inertias[1] = pin.Inertia.FromSphere(2.0, 0.1); n.jointPlacements[2] = pin.SE3(pin.rpy.rpyToMatrix(0.1, 0.2, 0.3), np.ones(3)); n.inertias[2] = pin.Inertia.FromSphere(1.0, 0.2)
b; n.gravity; list(n.inertias)[1:]; list(n.jointPlacements)[1:]; pin.rnea(n, n.createData(), 0.3 * np.ones(n.nq), np.ones(n.nv), np.ones(n.nv)); n == n.copy(); n == m; n != m; n.copy().gravity
! t = pin.transformJointIntoMimic(m, 1, 3, 2.0, 0.1)
t.nq; t.nv; pin.transformJointIntoMimic(t, 1, 4, 2.0, 0.1).nq; pin.transformJointIntoMimic(m, 0, 3, 2.0, 0.1).nq; [list(x) for x in pin.getTangentToConfigurationSparsitySegment(m)] if hasattr(pin, "getTangentToConfigurationSparsitySegment") else 0; pin.findCommonAncestor(h, 5, 20); pin.findCommonAncestor(m, 1, 99)
pin.ModelPool(m, 2).getData(1).M.shape; pin.ModelPool(3, 2); pin.rneaInParallel(1, 3, q, v, a); pin.linalg.inv(np.diag([2.0, 4.0])); pin.cholesky.solve(m, d, np.ones(5)); pin.cholesky.decompose(3, d)
"""

CONSTRAINTS = """
! m = pin.buildSampleModelManipulator(); d = m.createData(); q = 0.1 * np.arange(1, 7.0); A = pin.SE3(pin.rpy.rpyToMatrix(0.1, 0.2, 0.3), np.array([0.1, 0.2, 0.3])); pin.forwardKinematics(m, d, q, q, q)
! c = pin.RigidConstraintModel(pin.ContactType.CONTACT_6D, m, 6, A, 0, A.inverse(), pin.LOCAL); e = c.createData(); b = pin.RigidConstraintModel(c); g = pin.RigidConstraintModel(c)
c == b; c != b; c == g; c == 3; b.joint1_id; b.joint2_id; b.joint1_placement; b.joint2_placement; b.name; int(b.type == pin.ContactType.CONTACT_6D); b.desired_contact_placement; b.desired_contact_velocity
c.joint1_placement; pin.RigidConstraintModel(3); pin.BaumgarteCorrectorParameters(2.0, 3.0) == pin.BaumgarteCorrectorParameters(2.0, 3.0)
! pin.initConstraintDynamics(m, d, [c], [e]); pin.constraintDynamics(m, d, q, q, q, [c], [e], pin.ProximalSettings(1e-12, 1e-10, 50))
d.ddq[:0]; e.oMc1; e.oMc2; e.c1Mc2; e.contact_placement_error; pin.getConstraintJacobian(m, d, c, e); pin.getConstraintsJacobian(m, d, [c], [e])
pin.ProximalSettings(1e-5, 1e-6, 7).max_iter; pin.ProximalSettings(1e-5, 1e-6, 7).mu; pin.ProximalSettings(1e-5, 1e-6, 7).absolute_accuracy; pin.ProximalSettings(1e-5, 1e-4, 1e-6, 7).relative_accuracy
"""

GEOMETRY = """
! m = pin.buildModelFromUrdf(urdf); d = m.createData(); g = pin.buildGeomFromUrdf(m, urdf, pin.COLLISION, [share]); g.addAllCollisionPairs(); x = g.createData(); q = 0.2 * np.arange(6.0); o = g.geometryObjects[1]
! c = copy.copy(o); k = copy.copy(g); s = copy.deepcopy(g); e = copy.copy(x)
c.name; c == o; c.placement; c.meshPath == o.meshPath; c.meshScale; c.meshColor; c.parentJoint; c.parentFrame; c.overrideMaterial; c.disableCollision; k == g; s == g; k.ngeoms; len(k.collisionPairs); g != k; g == 3; o == 3; o == g.geometryObjects[2]
! c.meshColor = np.array([0.1, 0.2, 0.3, 0.4]); c.name = "other"; i = k.addGeometryObject(c); c.disableCollision = True
i; k.ngeoms; k.geometryObjects[i].name; k.geometryObjects[i].meshColor; c == o; k == g; k.addGeometryObject(3); pin.CollisionPair(1); pin.CollisionPair().first; pin.CollisionPair(1, 2) == pin.CollisionPair(2, 1); pin.CollisionPair(1, 2) == pin.CollisionPair(1, 3); pin.CollisionPair(3, 1).first; k.existCollisionPair(pin.CollisionPair(0, 1)); k.findCollisionPair(pin.CollisionPair(0, 1)); k.existGeometryName("nothing"); k.getGeometryId("nothing") >= k.ngeoms
! k.removeAllCollisionPairs(); u = np.zeros((k.ngeoms, k.ngeoms), dtype=bool); u[0, 2] = u[1, 3] = u[4, 2] = True; k.setCollisionPairs(u); y = k.createData()
[[p.first, p.second] for p in k.collisionPairs]; list(y.activeCollisionPairs); (y.deactivateCollisionPair(0), list(y.activeCollisionPairs))[1]; (y.deactivateAllCollisionPairs(), list(y.activeCollisionPairs))[1]; (y.activateCollisionPair(1), list(y.activeCollisionPairs))[1]; (k.setCollisionPairs(u.T, False), [[p.first, p.second] for p in k.collisionPairs])[1]; k.setCollisionPairs(np.zeros((2, 2), dtype=bool)); y.activateCollisionPair(99)
! p = pin.PhysicsMaterial(pin.METAL, 0.1, 0.2); r = pin.GeometryPhongMaterial(np.ones(4) * 0.1, np.ones(4) * 0.2, 0.3); r.meshEmissionColor = np.arange(4.0); r.meshSpecularColor = np.arange(4.0) / 2; r.meshShininess = 0.9; w = pin.GeometryPhongMaterial(r)
w.meshEmissionColor; w.meshSpecularColor; w.meshShininess; p == pin.PhysicsMaterial(pin.METAL, 0.1, 0.3); p == pin.PhysicsMaterial(pin.WOOD, 0.1, 0.2); p == 3; p != pin.PhysicsMaterial(pin.WOOD, 0.1, 0.2); pin.PhysicsMaterial().compliance
! t = pin.GeometryObject("ball", 2, pin.SE3.Identity(), pin.coal.Sphere(0.1)); z = pin.GeometryObject("box", 2, 3, pin.SE3.Identity(), pin.coal.Box(1, 2, 3), "", np.array([1.0, 2, 3]), True, np.array([0.4, 0.3, 0.2, 0.1]))
t.name; t.parentJoint; t.meshScale; t.overrideMaterial; z.parentJoint; z.parentFrame; z.meshScale; z.meshColor; z.overrideMaterial; pin.GeometryObject("a"); pin.GeometryObject(t).name; t == pin.GeometryObject(t); pin.GeometryObject(z) == z; t == z
pin.updateGeometryPlacements(m, d, g, x, q); list(x.oMg); pin.computeCollisions(g, x, True); pin.computeCollisions(g, x, False); pin.computeCollision(g, x, 0); pin.computeCollision(g, x, 999); pin.computeDistances(m, d, g, x, q); pin.computeDistance(g, x, 999); (e == x) in (True, False)
! b = pin.BroadPhaseManager_DynamicAABBTreeCollisionManager(m, g, x)
b.check(); b.getModel().nq; b.getGeometryModel().ngeoms; len(b.getGeometryData().oMg); len(b.getCollisionObjects()); b.getModel() == m; pin.computeCollisions(b, True); pin.computeCollisions(b, False)
! f = pin.buildModelFromUrdf(urdf); pin.loadReferenceConfigurations(f, srdf, False); n = pin.buildModelFromXML(CHAIN); pin.loadReferenceConfigurationsFromXML(n, STATES, False)
sorted(key for key, _ in configurations(n)); [value for _, value in sorted(configurations(n))]; n.nq; [j.shortname() for j in n.joints]
pin.serialization.StreamBuffer().max_size() > 0; pin.StdVec_Double([1.0, 2.0, 3.0])[0:2]; pin.StdVec_Index([1, 2, 3]).tolist(); list(pin.StdVec_Double([1.0, 2.0])); len(pin.StdVec_SE3()); pin.StdVec_Index([1, 2, 3])[1]; pin.StdVec_Index([1, 2, 3])[-1]; pin.StdVec_Index([1, 2, 3])[5]
"""

CHAIN = """<robot name="r"><link name="a"/><link name="b"/><link name="c"/><link name="d"/><link name="e"/><link name="f"/>
<joint name="turn" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint>
<joint name="flat" type="planar"><parent link="b"/><child link="c"/><axis xyz="0 0 1"/></joint>
<joint name="free" type="floating"><parent link="c"/><child link="d"/></joint>
<joint name="skewed" type="continuous"><parent link="d"/><child link="e"/><axis xyz="0.6 0.8 0"/></joint>
<joint name="stuck" type="fixed"><parent link="e"/><child link="f"/></joint></robot>"""
STATES = """<robot name="r"><group name="all"/><group_state name="one" group="all"><joint name="turn" value="0.3"/>
<joint name="stuck" value="1"/><joint name="nowhere" value="1"/></group_state>
<group_state name="two" group="all"><joint name="flat" value="1 2 0.6 0.8"/><joint name="free" value="1 2 3 0 0 0 1"/>
</group_state></robot>"""
GROUPS = {"spatial": SPATIAL, "rotations": ROTATIONS, "wrapper": WRAPPER, "models": MODELS} | {
    "constraints": CONSTRAINTS, "geometry": GEOMETRY
}  # fmt: skip


def value_of(value):
    """A value as lists of numbers or as text."""
    if value is None or value is NotImplemented:
        return str(value)
    if isinstance(value, pin.AngleAxis):
        return [value.angle, *value.axis.tolist()]
    if isinstance(value, pin.Quaternion):
        return value.coeffs().tolist()
    if isinstance(value, (pin.Symmetric3, pin.Inertia)):
        return value.matrix().tolist()
    if isinstance(value, pin.PseudoInertia):
        return value.toMatrix().tolist()
    return plain(value)


def finite(limits):
    return np.clip(limits, -1e9, 1e9)


def configurations(model):
    held = model.referenceConfigurations
    return held.items() if isinstance(held, dict) else [(entry.key(), entry.data()) for entry in held]


def answer(expression, names):
    try:
        value = eval(expression, globals() | names)
    except Exception:
        return "an exception"
    try:
        return [value_of(entry) for entry in value] if isinstance(value, (list, tuple)) else value_of(value)
    except (TypeError, ValueError):
        return type(value).__name__


def answers(text, names):
    found = {}
    for line in text.strip().splitlines():
        if line.startswith("!"):
            exec(line[1:].strip(), globals() | names, names)
            continue
        for expression in (part.strip() for part in line.split("; ") if part.strip()):
            for rf in ("LOCAL", "WORLD", "LOCAL_WORLD_ALIGNED") if "RF" in expression else ("",):
                said = expression.replace("RF", f"pin.{rf}")
                found[f"{len(found)} {said}"] = answer(said, names)
    return found


if __name__ == "__main__":
    target, urdf, srdf, share = sys.argv[1:]
    result = {}
    for group, text in GROUPS.items():
        names = {"rng": np.random.default_rng(3), "urdf": urdf, "srdf": srdf, "share": share, "copy": copy}
        names |= {
            "th": np.zeros(1),
            "A": pin.SE3(pin.rpy.rpyToMatrix(0.1, 0.2, 0.3), np.array([0.1, 0.2, 0.3])),
        }
        result |= {f"{group} {said}": value for said, value in answers(text, names).items()}
    with open(target, "w", encoding="utf-8") as out:
        out.write(json.dumps({"file": pin.__file__, "answers": result}))
