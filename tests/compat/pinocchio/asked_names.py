"""What Ulna's package and Pinocchio are both asked beyond `asked.py`: rarer names, their classes' members, printed words.

`python asked_names.py out.json urdf srdf share urdf srdf`: a robot, where packages lie, and a robot with rotors; lines as
in `asked.py`.
"""

import copy
import json
import pickle
import sys

import numpy as np
import pinocchio as pin
from asked import answers

SPATIAL = """
! I = pin.Inertia(2.5, rng.normal(size=3), np.diag([0.5, 0.6, 0.7]) + 0.01); P = I.toPseudoInertia(); R = pin.exp3(rng.normal(size=3))
! L = pin.LogCholeskyParameters(0.3 * rng.normal(size=10)); v = rng.normal(size=3); A = pin.exp6(rng.normal(size=6))
P.mass; P.h; P.sigma; P.toMatrix(); P.toDynamicParameters(); P.toInertia(); str(P); P.copy().toMatrix(); P.cast().toMatrix()
pin.PseudoInertia.FromMatrix(P.toMatrix()).toMatrix(); pin.PseudoInertia.FromInertia(I).toMatrix(); pin.PseudoInertia(P.mass, P.h, P.sigma).toMatrix()
pin.PseudoInertia.FromDynamicParameters(I.toDynamicParameters()).toMatrix(); pin.Inertia.FromPseudoInertia(P)
L.parameters; L.toDynamicParameters(); L.toInertia(); L.toPseudoInertia().toMatrix(); L.calculateJacobian(); str(L); L.copy().parameters
pin.Inertia.FromLogCholeskyParameters(L); pin.Hlog3(R, v); pin.XAxis; pin.YAxis; pin.ZAxis
A.cast(); I.cast(); pin.Motion(v, v).cast(); pin.Force(v, v).cast(); pin.Symmetric3(np.diag(v)).cast().data; A.toActionMatrix()
A.toActionMatrixInverse(); A.toDualActionMatrix(); pin.Motion.Zero(); pin.Force.Zero(); pin.SE3.Identity(); pin.Inertia.Identity()
pickle.loads(pickle.dumps(A)); pickle.loads(pickle.dumps(I)); pickle.loads(pickle.dumps(pin.Motion(v, v))); copy.deepcopy(pin.Force(v, v))
list(pin.StdVec_SE3([A, A])); list(pin.StdVec_Force([pin.Force(v, v)]))
list(pin.StdVec_Index([1, 2])); list(pin.StdVec_StdString(["a"])); list(pin.StdVec_Double([0.5]))
list(pin.StdVec_Motion([pin.Motion(v, v)])); list(pin.StdVec_Inertia([I])); list(pin.StdVec_Bool([True])); list(pin.StdVec_int([3]))
pin.linalg.inv(P.toMatrix()); pin.linalg.retrieveLargestEigenvalue(v); np.abs(pin.linalg.computeLargestEigenvector(P.toMatrix(), 200, 1e-12))
pin.ScalarType(1); pin.sharedMemory(); pin.checkVersionAtLeast(4, 0, 0); pin.PINOCCHIO_MAJOR_VERSION; pin.PINOCCHIO_MINOR_VERSION
pin.PINOCCHIO_PATCH_VERSION; pin.printVersion(); pin.WITH_URDFDOM; pin.WITH_COLLISION; pin.WITH_CPPAD; pin.WITH_SDFORMAT
int(pin.VISUAL); int(pin.COLLISION); int(pin.POSITION); int(pin.VELOCITY); int(pin.ACCELERATION); int(pin.ARG2); int(pin.ARG3); int(pin.ARG4)
int(pin.OP_FRAME); int(pin.JOINT); int(pin.FIXED_JOINT); int(pin.BODY); int(pin.SENSOR); int(pin.FrameType.BODY); int(pin.KinematicLevel.VELOCITY)
int(pin.ReferenceFrame.WORLD); int(pin.GeometryType.VISUAL); int(pin.ArgumentPosition.ARG1); int(pin.Convention.WORLD)
int(pin.LogLevel.CONSOLE_BRIDGE_LOG_WARN); int(pin.PhysicsMaterialType.WOOD)
! S = np.cos(np.arange(25.0)).reshape(5, 5); S = S + S.T; D = pin.LanczosDecomposition(S, 4); T = D.Ts(); C = pin.LanczosDecomposition(np.diag([1.0, 1, 2]), 3)
D.Qs(); T.matrix(); T.diagonal(); T.subDiagonal(); D.size(); D.decompositionSize(); D.copy() == D; C.Qs(); C.Ts().matrix(); T.rows()
T.computeSpectrum(); T.computeEigenvalue(2, 0.1); T.isDiagonal(); T.isDiagonal(9.0); T.isZero(); T.isIdentity()
[pin.getFrictionCoefficientMatrix().getFrictionFromMaterialPair(a, b) for a in (pin.ICE, pin.METAL, pin.PLASTIC, pin.WOOD) for b in (pin.METAL, pin.CONCRETE)]
pin.PGSSolverStats(3).size(); pin.PGSSolverSettings().stat_record; pin.PGSSolverSettings().measure_timings
"""

JOINTS = """
! kinds = joints(); A = pin.XYZQUATToSE3(np.array([0.1, 0.2, 0.3, 0, 0, 0, 1.0])); m, c, q, v = tower_of(kinds); d = m.createData(); pin.forwardKinematics(m, d, q, v, 0 * v)
str(m); [j.shortname() for j in m.joints]; [j.nq for j in m.joints][1:]; [j.nv for j in m.joints][1:]; [str(j) for j in kinds]
[list(j.hasConfigurationLimit) for j in kinds if "H" not in j.shortname()]; [list(j.hasConfigurationLimitInTangent) for j in kinds[:14]]
[j.lieGroup().name for j in kinds if "Composite" not in j.shortname()]; [j.classname() for j in kinds]
[type(j).__name__ for j in kinds]; [j.createData().shortname() for j in kinds]; [str(j.createData()) for j in kinds]
[x.shortname() for x in d.joints]; [x.M for x in d.joints][1:]; [x.v for x in d.joints][1:]; [x.c for x in d.joints][1:]
[x.S for x in d.joints][1:]; [x.joint_q for x in d.joints][1:]; [str(x) for x in d.joints][:-1]; list(d.oMi); list(d.v); list(d.a)[1:]
pin.rnea(m, d, q, v, v); pin.crba(m, d, q); pin.aba(m, d, q, v, v); pin.tangentMap(m, q); pin.compactTangentMap(m, q)
pin.tangentMapProduct(m, q, np.ones((m.nv, 2))); pin.tangentMapTransposeProduct(m, q, np.ones((m.nq, 2)))
[list(part) for part in pin.getTangentToConfigurationSparsitySegment(m)]; pin.normalize(m, 1.5 * q); pin.neutral(m)
list(m.getChildJoints()); [list(s) for s in m.span_indexes_vector]; list(m.sparsity_pattern_vector); [list(s) for s in m.mimic_joint_supports]
c.njoints; c.getJointId("second"); [j.shortname() for j in c.joints]; list(c.jointPlacements); str(c); c.nq
[pin.JointModelRY().getMotionAxis(), pin.JointModelPZ().getMotionAxis(), pin.JointModelHX(0.2).getMotionAxis(), pin.JointModelRUBZ().getMotionAxis()]
[x.shortname() for x in (pin.JointDataRX(), pin.JointDataRY(), pin.JointDataRZ(), pin.JointDataPX(), pin.JointDataPY())]
[x.shortname() for x in (pin.JointDataPZ(), pin.JointDataHX(), pin.JointDataHY(), pin.JointDataHZ(), pin.JointDataRUBX())]
[x.shortname() for x in (pin.JointDataRUBY(), pin.JointDataRUBZ(), pin.JointDataPlanar(), pin.JointDataSpherical())]
[x.shortname() for x in (pin.JointDataSphericalZYX(), pin.JointDataTranslation(), pin.JointDataFreeFlyer())]
[pin.JointDataUniversal.__name__, pin.JointDataRevoluteUnaligned.__name__, pin.JointDataPrismaticUnaligned.__name__]
[pin.JointDataRevoluteUnboundedUnalignedTpl.__name__, pin.JointDataHelicalUnaligned.__name__, pin.JointDataComposite.__name__]
[pin.JointDataMimic.__name__, pin.JointData.__name__, pin.JointModelMimic.__name__, pin.JointModelComposite.__name__]
pin.JointModelRevoluteUnboundedUnaligned().nq; [len(pin.StdVec_JointModelVector()), len(pin.StdVec_JointDataVector())]
pin.JointModelUniversal(1, 0, 0, 0, 1, 0).axis2; pin.JointModelHelicalUnaligned(0, 0, 1, 0.4).pitch
pin.JointModelRevoluteUnaligned(1, 0, 0).axis; pin.JointModelPrismaticUnaligned(np.array([0.6, 0.8, 0])).axis; pin.JointModelHZ(0.5).pitch
! j = pin.JointModelRX(); j.setIndexes(1, 0, 0); x = j.createData(); j.calc(x, np.array([0.3])); k = pin.JointModel(j)
str(j); k.shortname(); k.extract().shortname(); j.idx_q; j.idx_v; j.id; j.nvExtended; x.joint_q
! e = pin.JointModelComposite(pin.JointModelRX(), A); e = e.addJoint(pin.JointModelPY(), A); e.setIndexes(1, 0, 0); y = e.createData()
! e.calc(y, np.array([0.1, 0.2]), np.ones(2))
! own = list(m.joints)[1:]; z = [j.createData() for j in own]; n3 = 3 * list(zip(own, z))
! _ = [j.calc(x, q, v) for j, x in n3]
[x.M for x in z]; [x.v for x in z]; [x.c for x in z]; [x.S for x in z]; [x.joint_q for x in z]
! zero = pin.neutral(m)
! _ = [j.calc(x, zero) for j, x in n3]
[x.M for x in z]; [x.v for x in z]; [x.S for x in z]; [x.joint_q for x in z]
! before = d.joints[1]; _ = pin.forwardKinematics(m, d, pin.neutral(m), 2 * v); after = d.joints[1]; place = z[0].M; place.setRandom()
before.M; before.v; after.M; after.v; z[0].M; m.joints[2].createData().M
y.M; y.v; y.c; y.S; y.joint_v; m.joints[1].createData().shortname(); pin.JointModelTranslation().shortname()
! n = pin.transformJointIntoMimic(pin.buildSampleModelManipulator(), 1, 3, 2.0, 0.1); g = n.createData(); u = np.linspace(0, 1, n.nq)
! pin.forwardKinematics(n, g, u, u, 0 * u)
str(n.joints[3].extract()); n.joints[3].extract().scaling; n.joints[3].extract().offset; str(g.joints[3].extract()); g.joints[3].M; g.joints[3].v
[list(s) for s in n.mimic_joint_supports]; [list(s) for s in n.span_indexes_vector]; list(n.mimicking_joints); list(n.mimicked_joints)
! L = pin.liegroups; G = L.SE3() * L.SO2() * L.R1(); w = G.integrate(G.neutral, 0.3 * np.ones(G.nv))
G.tangentMap(w); G.tangentMapProduct(w, np.ones((G.nv, 2))); G.tangentMapTransposeProduct(w, np.ones((G.nq, 2)))
[len(G.random()), len(L.R3().random()), pin.LieGroup().nq, len(G.randomConfiguration(-np.ones(G.nq), np.ones(G.nq)))]
"""

MODELS = """
! h = pin.buildSampleModelHumanoid(); t = pin.buildSampleModelHumanoid(False); a = pin.buildSampleModelManipulator(True)
[str(x) for x in (h, t, a)]; [x.nframes for x in (h, t, a)]; [x.nbodies for x in (h, t, a)]
[[f.name for f in x.frames] for x in (h, t, a)]; [[f.parentFrame for f in x.frames] for x in (h, t, a)]; list(h.jointPlacements)[1:]
list(h.inertias); list(t.jointPlacements)[1:]; finite(h.lowerPositionLimit); finite(t.upperPositionLimit); finite(h.upperVelocityLimit)
! r = pin.buildSampleModelHumanoidRandom(); s = pin.buildSampleModelHumanoidRandom(True, True); z = pin.buildSampleModelHumanoidRandom(False)
[str(x) for x in (r, s, z)]; [[f.name for f in x.frames] for x in (r, s, z)]; [j.shortname() for j in s.joints]; len(pin.randomConfiguration(r))
! h.lowerPositionLimit[:3] = -1; h.upperPositionLimit[:3] = 1; b = pickle.loads(pickle.dumps(h)); d = h.createData()
! q = pin.integrate(h, pin.neutral(h), rng.uniform(-1, 1, h.nv)); pin.forwardKinematics(h, d, q); pin.updateGlobalPlacements(h, d)
b == h; copy.deepcopy(h) == h; h.copy() == h; list(d.oMi); [len(pin.randomConfiguration(h)), h.existBodyName("head2_body")]
pin.computeJointKinematicRegressor(h, d, 20, RF); pin.computeFrameKinematicRegressor(h, d, 50, RF)
pin.computeJointKinematicRegressor(h, d, 20, RF, pin.XYZQUATToSE3(np.array([0.1, 0.2, 0.3, 0, 0, 0, 1.0])))
! m = pin.buildModelFromUrdf(urdf); e = m.createData(); q, v, w = rng.normal(size=(3, m.nq)); pin.forwardKinematics(m, e, q, v, w)
! pin.rnea(m, e, q, v, w); moving = [i for i, f in enumerate(m.frames) if f.parentJoint > 0]
[pin.computeSupportedForceByFrame(m, e, i) for i in moving]; [pin.computeSupportedInertiaByFrame(m, e, i, True) for i in moving]
[pin.computeSupportedInertiaByFrame(m, e, i, False) for i in moving]; list(pin.findCommonAncestor(m, 3, 5))
! n = pin.buildModelFromXML(open(urdf).read()); pin.loadReferenceConfigurations(n, srdf, False)
str(n); sorted(k for k, _ in configurations(n)); [x for _, x in sorted(configurations(n))]; n.rotorInertia; n.rotorGearRatio
! k = pin.buildModelFromUrdf(urdf); pin.loadReferenceConfigurationsFromXML(k, open(srdf).read(), False)
[x for _, x in sorted(configurations(k))]; pin.computeTotalMass(n)
! s = pin.buildSampleModelManipulator(); y = s.createData(); q, v, w = rng.normal(size=(3, 6)); _ = pin.computeJointJacobians(s, y, q)
! _ = pin.computeJointKinematicHessians(s, y, q); pin.updateFramePlacements(s, y)
np.sort(pin.getJointKinematicHessian(s, y, 6, RF).ravel()); np.sort(pin.getFrameKinematicHessian(s, y, 10, RF).ravel())
! _ = pin.jacobianCenterOfMass(s, y, q), pin.computeRNEADerivatives(s, y, q, v, w)
pin.getCoriolisMatrix(s, y); pin.getJacobianSubtreeCenterOfMass(s, y, 3); pin.getCentroidalDynamicsDerivatives(s, y)
! x = pin.buildModelFromUrdf(humanoid[0], pin.JointModelFreeFlyer()); pin.loadRotorParameters(x, humanoid[1], False)
x.rotorInertia; x.rotorGearRatio
! f = pin.Frame("grip", 3, 0, pin.SE3.Identity(), pin.OP_FRAME); i = m.addFrame(f); o = m.appendBodyToJoint(2, pin.Inertia.FromSphere(1.0, 0.1), pin.SE3.Identity())
i; m.frames[i].name; m.inertias[2]; m.frames[i].cast().name; m.nbodies; str(f); pickle.loads(pickle.dumps(f)).name
"""

GEOMETRY = """
! m = pin.buildSampleModelHumanoid(); d = m.createData(); g = pin.buildSampleGeometryModelHumanoid(m); g.addAllCollisionPairs(); x = g.createData()
! q = pin.integrate(m, pin.neutral(m), rng.uniform(-1, 1, m.nv)); pin.updateGeometryPlacements(m, d, g, x, q)
str(pin.buildSampleGeometryModelManipulator(pin.buildSampleModelManipulator())); str(x); g.ngeoms; [o.name for o in g.geometryObjects]; [o.parentFrame for o in g.geometryObjects]; [o.placement for o in g.geometryObjects]
[o.meshPath for o in g.geometryObjects][:-1]; [o.meshColor for o in g.geometryObjects]; list(x.oMg); g.collisionPairMapping; g.existGeometryName("head_object")
[[p.first, p.second] for p in g.collisionPairs]; str(g.collisionPairs[3]); pin.computeCollisions(g, x); [r.isCollision() for r in x.collisionResults]
pin.computeDistances(g, x); [r.min_distance for r in x.distanceResults]; (pin.computeBodyRadius(m, g, x), list(x.radius))[1]
pin.computeCollisions(m, d, g, x, q, True); pin.computeDistances(m, d, g, x, q); pin.computeDistance(g, x, 5).min_distance; pin.computeCollision(g, x, 5)
! marks = np.triu(np.ones((g.ngeoms, g.ngeoms))); x.setSecurityMargins(g, 0.1 * marks)
pin.computeCollisions(g, x); [r.isCollision() for r in x.collisionResults]; x.collisionRequests[0].security_margin
! x.setSecurityMargins(g, 0 * marks); marks[:, 5] = 0; x.setActiveCollisionPairs(g, marks.astype(bool)); x.setGeometryCollisionStatus(g, 2, False)
list(x.activeCollisionPairs); pin.computeCollisions(g, x); pin.computeDistances(g, x); str(x); list(x.copy().activeCollisionPairs)
! x = g.createData(); pin.updateGeometryPlacements(m, d, g, x); _ = pin.computeCollisions(g, x); pin.computeContactPatches(g, x)
! pin.computeContactPatch(g, x, 3)
[len(x.contactPatchRequests), len(x.distanceRequests), len(x.collision_functors), len(x.distance_functors)]
! B = [pin.BroadPhaseManager_DynamicAABBTreeCollisionManager, pin.TreeBroadPhaseManager_DynamicAABBTreeCollisionManager]
! B += [pin.BroadPhaseManager_DynamicAABBTreeArrayCollisionManager, pin.TreeBroadPhaseManager_DynamicAABBTreeArrayCollisionManager]
! B += [pin.BroadPhaseManager_NaiveCollisionManager, pin.TreeBroadPhaseManager_NaiveCollisionManager]
! B += [pin.BroadPhaseManager_SSaPCollisionManager, pin.TreeBroadPhaseManager_SSaPCollisionManager]
! B += [pin.BroadPhaseManager_SaPCollisionManager, pin.TreeBroadPhaseManager_SaPCollisionManager]; B = [b(m, g, x) for b in B]
[pin.computeCollisions(b) for b in B]; [pin.computeCollisions(m, d, b, q) for b in B]; [b.check() for b in B]
! T = [pin.BroadPhaseManager_DynamicAABBTreeCollisionManager, pin.TreeBroadPhaseManager_SaPCollisionManager]; C = pin.CollisionCallBackDefault(g, x)
[pin.computeCollisions(t(m, g, x), C) for t in T]; C.collision; C.stopAtFirstCollision; [pin.computeCollisions(m, d, t(m, g, x), C, q) for t in T]
! K = pin.CollisionCallBackCollect(g, x); b = T[0](m, g, x); b.update(); b.update(x); _ = b.collide(K); u = b.getCollisionObjects()
K.collision; [g.ngeoms, len(u)]; list(b.getCollisionObjectStatus()); sorted(set(hits(x)) - set(K.pair_indexes)); type(u[0]).__name__
! Q = np.stack([pin.integrate(m, pin.neutral(m), rng.uniform(-1, 1, m.nv)) for _ in range(4)], axis=1); O = pin.GeometryPool(m, g, 2)
pin.computeCollisionsInParallel(1, O, Q); O.size(); O.getModel(0).nq; O.getGeometryModel(1).ngeoms; len(O.getGeometryDatas()); len(O.getDatas())
pin.computeCollisionsInParallel(1, g, x); pin.computeCollisionsInParallel(1, m, d, g, x, q)
! U = pin.BroadPhaseManagerPool_DynamicAABBTreeCollisionManager(m, g, 2); V = pin.TreeBroadPhaseManagerPool_DynamicAABBTreeCollisionManager(m, g, 1)
pin.computeCollisionsInParallel(1, U, Q); pin.computeCollisionsInParallel(1, V, Q); U.check(); U.size(); len(U.getBroadPhaseManagers())
! o = g.geometryObjects[0]; F = pin.ComputeCollision(o, g.geometryObjects[1]); H = pin.ComputeDistance(o, g.geometryObjects[1]); t3 = pin.coal.Transform3s
F.run(t3(), t3(), pin.coal.CollisionRequest(), pin.CollisionResult()); H.run(t3(), t3(), pin.coal.DistanceRequest(), pin.DistanceResult())
F.getGeometryObject1().name; H.getGeometryObject2().name; o.physicsMaterial.compliance; str(o.physicsMaterial.materialType)
type(o.meshMaterial).__name__; [pin.PhysicsMaterial(pin.METAL, 0.1, 0.2).elasticity, int(pin.ICE), int(pin.CONCRETE), int(pin.PLASTIC), int(pin.WOOD)]
! p = pin.GeometryPhongMaterial(np.ones(4) * 0.1, np.ones(4) * 0.2, 0.3); c = pin.GeometryObject.CreateCapsule(0.1, 0.5)
p.meshEmissionColor; p.meshSpecularColor; p.meshShininess; c.geometry.radius; c.geometry.halfLength; type(pin.GeometryNoMaterial()).__name__
! k = g.copy(); k.removeCollisionPair(pin.CollisionPair(0, 1)); k.removeGeometryObject("head_object"); s = g.clone(); s.removeAllCollisionPairs()
len(k.collisionPairs); k.ngeoms; s == g; g.copy() == g; s.ngeoms; str(pin.CollisionPair(1, 2)); pin.CollisionPair(1, 2).copy().second
! v = pin.buildModelFromUrdf(urdf); w = pin.buildGeomFromUrdfString(v, open(urdf).read(), pin.COLLISION, None, share); w.addAllCollisionPairs()
[o.name for o in w.geometryObjects]; len(w.collisionPairs); (pin.removeCollisionPairs(v, w, srdf, False), len(w.collisionPairs))[1]
! y = pin.buildGeomFromUrdf(v, urdf, pin.GeometryType.COLLISION, share); y.addAllCollisionPairs(); pin.removeCollisionPairsFromXML(v, y, open(srdf).read(), False)
len(y.collisionPairs); [o.placement for o in y.geometryObjects]; [o.meshScale for o in y.geometryObjects]
! R = pin.RobotWrapper(v, y); made = pin.buildModelsFromUrdf(urdf, share); D = pin.createDatas(*made)
[R.nq, R.nv, len(made), len(D)]; made[1].ngeoms; pin.robot_wrapper.RobotWrapper.__name__; pin.shortcuts.createDatas.__name__
[len(x()) for x in (pin.StdVec_CollisionPair, pin.StdVec_GeometryObject, pin.StdVec_GeometryModel, pin.StdVec_GeometryData)]
[len(x()) for x in (pin.StdVec_Frame, pin.StdVec_Model, pin.StdVec_Data, pin.StdVec_Symmetric3, pin.StdVec_Vec3s, pin.StdVec_MatrixXs)]
[len(x()) for x in (pin.StdVec_Matrix6, pin.StdVec_Matrix6x, pin.StdVec_IndexVector, pin.StdVec_EigenIndex, pin.StdVec_Scalar)]
[pin.GeometryModel().ngeoms, len(pin.GeometryData(g).oMg), pin.Data(m).M.shape[0]]; type(m.createData()).__name__; pin.hppfcl.__name__[:4]
[pin.CachedMeshLoader.__name__, pin.MeshLoader.__name__, pin.CollisionObject.__name__, pin.CollisionCallBackBase.__name__]
[isinstance(pin.omp_get_max_threads(), int), pin.serialization.StreamBuffer().size(), pin.seed(1) is None]; pin.explog.exp.__name__
! buffer = pin.serialization.StreamBuffer(); n = pin.Model(); v.saveToBinary(buffer); n.loadFromBinary(buffer); w = pin.Model()
! w.loadFromString(v.saveToString())
n == v; w == v; pin.PhysicsMaterialType.METAL.name
! z = pin.ModelPool(m, 2)
z.size(); z.getModel(1).nq; len(z.getDatas()); (z.resize(3), z.size())[1]; z.copy().size(); pin.CollisionGeometry.__name__; pin.Contact.__name__
"""


def finite(limits):
    return np.clip(limits, -1e9, 1e9)


def configurations(model):
    held = model.referenceConfigurations
    return held.items() if isinstance(held, dict) else [(entry.key(), entry.data()) for entry in held]


def hits(data):
    return [k for k, result in enumerate(data.collisionResults) if result.isCollision()]


def joints():
    """One of every kind of joint."""
    skew = np.array([0.6, 0.8, 0.0])
    found = [
        pin.JointModelRX(),
        pin.JointModelRY(),
        pin.JointModelRZ(),
        pin.JointModelRUBX(),
        pin.JointModelRUBY(),
    ]
    found += [
        pin.JointModelRUBZ(),
        pin.JointModelPX(),
        pin.JointModelPY(),
        pin.JointModelPZ(),
        pin.JointModelFreeFlyer(),
    ]
    found += [
        pin.JointModelPlanar(),
        pin.JointModelSpherical(),
        pin.JointModelSphericalZYX(),
        pin.JointModelTranslation(),
    ]
    found += [
        pin.JointModelHX(0.1),
        pin.JointModelHY(0.2),
        pin.JointModelHZ(0.3),
        pin.JointModelHelicalUnaligned(skew, 0.2),
    ]
    found += [pin.JointModelRevoluteUnaligned(skew), pin.JointModelPrismaticUnaligned(skew)]
    return [*found, pin.JointModelUniversal(skew, np.array([0.0, 0.0, 1.0]))]


def tower_of(kinds):
    """All joints one upon the other, with a composite one on top, and a state."""
    rng = np.random.default_rng(8)
    model = pin.Model()
    place = pin.XYZQUATToSE3(np.array([0.1, 0.2, 0.3, 0.0, 0.0, np.sin(0.2), np.cos(0.2)]))
    composite = pin.JointModelComposite(pin.JointModelRX(), place, "first")
    composite.addJoint(pin.JointModelPY(), place, "second")
    for i, kind in enumerate([*kinds, composite]):
        model.addJoint(i, kind, place, f"joint {i}")
        model.appendBodyToJoint(
            i + 1, pin.Inertia(1.0, np.array([0.1, 0.2, 0.3]), np.diag([0.5, 0.6, 0.7])), place
        )
    q = pin.integrate(model, pin.neutral(model), rng.uniform(-1, 1, model.nv))
    return model, composite, q, rng.normal(size=model.nv)


if __name__ == "__main__":
    target, urdf, srdf, share, *humanoid = sys.argv[1:]
    names = {
        "rng": np.random.default_rng(3),
        "pickle": pickle,
        "copy": copy,
        "urdf": urdf,
        "srdf": srdf,
        "share": share,
    }
    names |= {
        "humanoid": humanoid,
        "joints": joints,
        "tower_of": tower_of,
        "configurations": configurations,
        "hits": hits,
    }
    result = {}
    for group in (SPATIAL, JOINTS, MODELS, GEOMETRY):
        result |= {f"{len(result)} {said}": value for said, value in answers(group, dict(names)).items()}
    with open(target, "w", encoding="utf-8") as out:
        out.write(json.dumps({"file": pin.__file__, "answers": result}))
