"""Rows of compat_pinocchio.py: calls that a worker times, whatever `pinocchio` it imports."""

from __future__ import annotations

import copy
import itertools
import pickle
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from _pinocchio_object_rows import (
    ASSIGNMENTS,
    CONSTRUCTORS,
    JOINTS,
    OPERATIONS,
    joints_to_change,
    objects_to_change,
)

SPAN = 2e-4  # of each measurement [s]: short, so that few are interrupted where other work runs beside
KINDS = "all kinds"
"""A chain of all kinds of joints, in place of a URDF."""

ALGORITHMS = {
    "forwardKinematics, oMi[-1] read": "pin.forwardKinematics(m, d, q); d.oMi[end].translation",
    "forwardKinematics(q, v, a)": "pin.forwardKinematics(m, d, q, v, a)",
    "framesForwardKinematics": "pin.framesForwardKinematics(m, d, q)",
    "updateFramePlacements": "pin.updateFramePlacements(m, d)",
    "updateFramePlacement": "pin.updateFramePlacement(m, d, last)",
    "updateGlobalPlacements": "pin.updateGlobalPlacements(m, d)",
    "getVelocity": "pin.getVelocity(m, d, end, pin.LOCAL)",
    "getVelocity, WORLD": "pin.getVelocity(m, d, end, pin.WORLD)",
    "getAcceleration": "pin.getAcceleration(m, d, end, pin.LOCAL)",
    "getClassicalAcceleration": "pin.getClassicalAcceleration(m, d, end, pin.LOCAL)",
    "getFrameVelocity": "pin.getFrameVelocity(m, d, last, pin.LOCAL)",
    "getFrameVelocity, LOCAL_WORLD_ALIGNED": "pin.getFrameVelocity(m, d, last, pin.LOCAL_WORLD_ALIGNED)",
    "getFrameVelocity at a placement": "pin.getFrameVelocity(m, d, end, M, pin.LOCAL)",
    "getFrameAcceleration": "pin.getFrameAcceleration(m, d, last, pin.LOCAL)",
    "getFrameClassicalAcceleration": "pin.getFrameClassicalAcceleration(m, d, last, pin.LOCAL)",
    "computeJointJacobians": "pin.computeJointJacobians(m, d, q)",
    "getJointJacobian": "pin.getJointJacobian(m, d, end, pin.LOCAL)",
    "getFrameJacobian": "pin.getFrameJacobian(m, d, last, pin.LOCAL)",
    "getFrameJacobian at a placement": "pin.getFrameJacobian(m, d, end, M, pin.LOCAL)",
    "computeJointJacobian": "pin.computeJointJacobian(m, d, q, end)",
    "computeFrameJacobian": "pin.computeFrameJacobian(m, d, q, last, pin.LOCAL_WORLD_ALIGNED)",
    "rnea": "pin.rnea(m, d, q, v, a)",
    "rnea with forces": "pin.rnea(m, d, q, v, a, fext)",
    "jointBodyRegressor": "pin.jointBodyRegressor(m, d, end)",
    "crba": "pin.crba(m, d, q)",
    "data.Ycrb[-1]": "d.Ycrb[end]",
    "cholesky.decompose": "pin.cholesky.decompose(m, d)",
    "aba": "pin.aba(m, d, q, v, tau)",
    "crba, WORLD": "pin.crba(m, d, q, pin.Convention.WORLD)",
    "aba, WORLD": "pin.aba(m, d, q, v, tau, pin.Convention.WORLD)",
    "aba with forces": "pin.aba(m, d, q, v, tau, fext)",
    "nonLinearEffects": "pin.nonLinearEffects(m, d, q, v)",
    "computeGeneralizedGravity": "pin.computeGeneralizedGravity(m, d, q)",
    "computeCoriolisMatrix": "pin.computeCoriolisMatrix(m, d, q, v)",
    "computeMinverse": "pin.computeMinverse(m, d, q)",
    "computeAllTerms": "pin.computeAllTerms(m, d, q, v)",
    "computeRNEADerivatives": "pin.computeRNEADerivatives(m, d, q, v, a)",
    "computeABADerivatives": "pin.computeABADerivatives(m, d, q, v, tau)",
    "centerOfMass": "pin.centerOfMass(m, d, q)",
    "jacobianCenterOfMass": "pin.jacobianCenterOfMass(m, d, q)",
    "ccrba": "pin.ccrba(m, d, q, v)",
    "computeKineticEnergy": "pin.computeKineticEnergy(m, d, q, v)",
    "computeTotalMass": "pin.computeTotalMass(m)",
    "computeSubtreeMasses": "pin.computeSubtreeMasses(m, d)",
}
WITHOUT_Q = {
    "computeMinverse": "pin.computeMinverse(m, after_aba)",
    "computeABADerivatives": "pin.computeABADerivatives(m, after_aba)",
    "computeABADerivatives with forces": "pin.computeABADerivatives(m, after_aba, fext)",
    "getCoriolisMatrix": "pin.getCoriolisMatrix(m, derived)",
    "getCentroidalDynamicsDerivatives": "pin.getCentroidalDynamicsDerivatives(m, derived)",
    "computeJointJacobians": "pin.computeJointJacobians(m, d)",
    "computeKineticEnergy": "pin.computeKineticEnergy(m, d)",
    "computePotentialEnergy": "pin.computePotentialEnergy(m, d)",
    "centerOfMass": "pin.centerOfMass(m, d)",
    "centerOfMass, POSITION": "pin.centerOfMass(m, d, pin.POSITION)",
    "jacobianCenterOfMass": "pin.jacobianCenterOfMass(m, d)",
    "computeCentroidalMomentum": "pin.computeCentroidalMomentum(m, d)",
    "computeCentroidalMomentumTimeVariation": "pin.computeCentroidalMomentumTimeVariation(m, d)",
    "getJointVelocityDerivatives": "pin.getJointVelocityDerivatives(m, moved, end, pin.LOCAL)",
    "getFrameVelocityDerivatives": "pin.getFrameVelocityDerivatives(m, moved, last, pin.LOCAL)",
    "getFrameAccelerationDerivatives": "pin.getFrameAccelerationDerivatives(m, moved, last, pin.LOCAL)",
    "getPointVelocityDerivatives": "pin.getPointVelocityDerivatives(m, moved, end, M, pin.LOCAL)",
    "getPointClassicAccelerationDerivatives": "pin.getPointClassicAccelerationDerivatives(m, moved, end, M, pin.LOCAL)",
    "computeJointKinematicRegressor": "pin.computeJointKinematicRegressor(m, d, end, pin.LOCAL)",
    "computeFrameKinematicRegressor": "pin.computeFrameKinematicRegressor(m, d, last, pin.LOCAL)",
}
"""Calls on what earlier ones left in a Data."""
CONFIGURATIONS = {
    "neutral": "pin.neutral(m)",
    "integrate": "pin.integrate(m, q, v)",
    "difference": "pin.difference(m, q, k)",
    "interpolate": "pin.interpolate(m, q, k, 0.3)",
    "distance": "pin.distance(m, q, k)",
    "normalize": "pin.normalize(m, q)",
    "isSameConfiguration": "pin.isSameConfiguration(m, q, k, 1e-9)",
    "isNormalized": "pin.isNormalized(m, q)",
    "squaredDistance": "pin.squaredDistance(m, q, k)",
    "dIntegrate": "pin.dIntegrate(m, q, v)",
    "dIntegrate by v": "pin.dIntegrate(m, q, v, pin.ARG1)",
    "dDifference by q1": "pin.dDifference(m, q, k, pin.ARG1)",
    "tangentMap": "pin.tangentMap(m, q)",
    "compactTangentMap": "pin.compactTangentMap(m, q)",
    "tangentMapProduct": "pin.tangentMapProduct(m, q, columns)",
    "lieGroup": "pin.lieGroup(m)",
    "randomConfiguration(low, high)": "pin.randomConfiguration(m, low, high)",
    "randomConfiguration": "pin.randomConfiguration(bounded)",
    "LieGroup.integrate": "group.integrate(q, v)",
    "LieGroup.difference": "group.difference(q, k)",
}
MODELS = {
    "model.copy": "m.copy()",
    "Model(model)": "pin.Model(m)",
    "copy.deepcopy(model)": "copy.deepcopy(m)",
    "pickle.dumps(model)": "pickle.dumps(m)",
    "pickle.loads(model)": "pickle.loads(model_bytes)",
    "model == model": "m == other",
    "str(model)": "str(m)",
    "createData": "m.createData()",
    "Data(model)": "pin.Data(m)",
    "data.copy": "d.copy()",
    "copy.deepcopy(data)": "copy.deepcopy(d)",
    "pickle.dumps(data)": "pickle.dumps(d)",
    "pickle.loads(data)": "pickle.loads(data_bytes)",
    "model.copy, a frame read": "c = m.copy(); c.frames[last].placement",
    "model.copy, an inertia read": "c = m.copy(); c.inertias[end].mass",
    "model.copy, limits read": "c = m.copy(); c.lowerPositionLimit",
    "buildReducedModel": "pin.buildReducedModel(m, [end], q)",
    "buildReducedModel, others each time": "pin.buildReducedModel(m, next(pairs), q)",
    "buildReducedModel, first at these joints": "pin.buildReducedModel(next(new_models), [end], q)",
    "appendModel": "pin.appendModel(m, hand, last, M)",
    "buildModelFromUrdf of the same file again": "pin.buildModelFromUrdf(urdf, *roots)",
}
GETTERS = {
    "data.oMi[i]": "d.oMi[end]",
    "data.oMi[i].translation": "d.oMi[end].translation",
    "data.oMi[i].rotation": "d.oMi[end].rotation",
    "data.oMi[i].homogeneous": "d.oMi[end].homogeneous",
    "data.oMf[i]": "d.oMf[last]",
    "data.v[i].linear": "d.v[end].linear",
    "data.a[i].vector": "d.a[end].vector",
    "data.f[i]": "d.f[end]",
    "data.liMi[i]": "d.liMi[end]",
    "data.com[0]": "d.com[0]",
    "data.M": "d.M",
    "data.J": "d.J",
    "data.tau": "d.tau",
    "for M in data.oMi": "for M in d.oMi: pass",
    "[M.translation for M in data.oMi]": "[M.translation for M in d.oMi]",
    "len(data.oMi)": "len(d.oMi)",
    "data.oMi[1:3]": "d.oMi[1:3]",
    "data.oMi.tolist()": "d.oMi.tolist()",
    "model.frames[i]": "m.frames[last]",
    "model.frames[i].placement": "m.frames[last].placement",
    "model.frames[i].name": "m.frames[last].name",
    "for frame in model.frames": "for f in m.frames: pass",
    "model.joints[i].idx_q": "m.joints[end].idx_q",
    "model.inertias[i].mass": "m.inertias[end].mass",
    "model.inertias[i].inertia": "m.inertias[end].inertia",
    "model.jointPlacements[i]": "m.jointPlacements[end]",
    "model.names[i]": "m.names[end]",
    "list(model.names)": "list(m.names)",
    "model.parents[i]": "m.parents[end]",
    "model.nq": "m.nq",
    "model.lowerPositionLimit": "m.lowerPositionLimit",
    "model.gravity.linear": "m.gravity.linear",
    "model.getFrameId": "m.getFrameId(frame_name)",
    "model.getJointId": "m.getJointId(joint_name)",
    "model.existFrame": "m.existFrame(frame_name)",
}
OBJECTS = {
    "SE3.Random": "pin.SE3.Random()",
    "Motion.Random": "pin.Motion.Random()",
    "Force.Random": "pin.Force.Random()",
    "Inertia.Random": "pin.Inertia.Random()",
    "SE3.Identity": "pin.SE3.Identity()",
    "SE3(R, p)": "pin.SE3(R, p)",
    "SE3(M)": "pin.SE3(M)",
    "Motion(v)": "pin.Motion(six)",
    "Motion.Zero": "pin.Motion.Zero()",
    "Force(linear, angular)": "pin.Force(p, p)",
    "Inertia(mass, lever, inertia)": "pin.Inertia(2.0, p, moments)",
    "SE3 * SE3": "M * N",
    "SE3 * point": "M * p",
    "SE3.act(Motion)": "M.act(x)",
    "SE3.actInv(Force)": "M.actInv(y)",
    "SE3.act(Inertia)": "M.act(Y)",
    "SE3.inverse": "M.inverse()",
    "SE3.actInv(SE3)": "M.actInv(N)",
    "SE3.translation": "M.translation",
    "SE3.rotation": "M.rotation",
    "SE3.homogeneous": "M.homogeneous",
    "SE3.action": "M.action",
    "SE3.copy": "M.copy()",
    "SE3 == SE3": "M == N",
    "SE3.isApprox": "M.isApprox(N)",
    "SE3.translation = p": "N.translation = p",
    "Motion + Motion": "x + x",
    "Motion - Motion": "x - x",
    "-Motion": "-x",
    "Motion * 2": "x * 2.0",
    "2 * Motion": "2.0 * x",
    "Motion.cross(Motion)": "x.cross(x)",
    "Motion.dot(Force)": "x.dot(y)",
    "Motion.vector": "x.vector",
    "Motion.linear": "x.linear",
    "Motion.copy": "x.copy()",
    "Force + Force": "y + y",
    "Inertia + Inertia": "Y + Y",
    "Inertia * Motion": "Y * x",
    "Inertia.mass": "Y.mass",
    "Inertia.lever": "Y.lever",
    "Inertia.inertia": "Y.inertia",
    "Inertia.matrix": "Y.matrix()",
    "Inertia.copy": "Y.copy()",
    "str(SE3)": "str(M)",
    "str(Motion)": "str(x)",
    "str(Inertia)": "str(Y)",
    "repr(SE3)": "repr(M)",
    "pickle of SE3": "pickle.loads(pickle.dumps(M))",
    "Quaternion(R)": "pin.Quaternion(R)",
    "Quaternion * Quaternion": "quat * quat",
    "Quaternion.matrix": "quat.matrix()",
    "exp6": "pin.exp6(x)",
    "log6(SE3)": "pin.log6(M)",
    "exp3": "pin.exp3(p)",
    "log3": "pin.log3(R)",
    "skew": "pin.skew(p)",
    "SE3ToXYZQUAT": "pin.SE3ToXYZQUAT(M)",
    "XYZQUATToSE3": "pin.XYZQUATToSE3(seven)",
    "rpy.rpyToMatrix": "pin.rpy.rpyToMatrix(0.1, 0.2, 0.3)",
    "rpy.matrixToRpy": "pin.rpy.matrixToRpy(R)",
    "buildSampleModelHumanoidRandom": "pin.buildSampleModelHumanoidRandom()",
}
CONSTRAINTS = {
    "constraintDynamics": "pin.constraintDynamics(m, d, q, v, tau, cs, ds, s)",
    "computeConstraintDynamicsDerivatives": "pin.computeConstraintDynamicsDerivatives(m, d, cs, ds, s)",
    "impulseDynamics": "pin.impulseDynamics(m, d, q, v, cs, ds, 0.3, s)",
    "computeImpulseDynamicsDerivatives": "pin.computeImpulseDynamicsDerivatives(m, d, cs, ds, 0.3, s)",
    "getConstraintJacobian": "pin.getConstraintJacobian(m, d, c, x)",
    "getConstraintsJacobian": "pin.getConstraintsJacobian(m, d, cs, ds)",
    "computeDelassusMatrix": "pin.computeDelassusMatrix(m, d, q, cs, ds, 0.0)",
    "forwardDynamics(q, v, tau, J, drift)": "pin.forwardDynamics(m, d, q, v, tau, J, drift)",
    "forwardDynamics(tau, J, drift)": "pin.forwardDynamics(m, d, tau, J, drift)",
    "impulseDynamics(q, v, J)": "pin.impulseDynamics(m, d, q, v, J)",
    "ContactCholeskyDecomposition.compute": "chol.compute(m, d, cs, ds, 1e-6)",
    "the same, and solve": "chol.compute(m, d, cs, ds, 1e-6); chol.solve(b)",
    "the same, and inverse": "chol.compute(m, d, cs, ds, 1e-6); chol.inverse()",
    "U": "chol.U",
    "matrix": "chol.matrix()",
    "getInverseMassMatrix": "chol.getInverseMassMatrix()",
    "getOperationalSpaceInertiaMatrix": "chol.getOperationalSpaceInertiaMatrix()",
    "solve of its Delassus operator": "G.solve(drift)",
    "computeDampedDelassusMatrixInverse": "pin.computeDampedDelassusMatrixInverse(m, d, q, cs, ds, 1e-3)",
    "computeKKTContactDynamicMatrixInverse": "pin.computeKKTContactDynamicMatrixInverse(m, d, q, J, 1e-3)",
    "getKKTContactDynamicMatrixInverse": "pin.getKKTContactDynamicMatrixInverse(m, d, J)",
    "cholesky.decompose": "pin.cholesky.decompose(m, d)",
    "cholesky.solve": "pin.cholesky.solve(m, d, tau)",
    "cholesky.computeMinv": "pin.cholesky.computeMinv(m, d)",
}
GEOMETRIES = {
    "GeometryModel.createData": "gm.createData()",
    "GeometryModel.copy": "gm.copy()",
    "GeometryObject == its copy": "gm.geometryObjects[0] == one_geometry",
    "GeometryObject.placement": "gm.geometryObjects[0].placement",
    "updateGeometryPlacements(q)": "pin.updateGeometryPlacements(m, d, gm, gd, q)",
    "updateGeometryPlacements": "pin.updateGeometryPlacements(m, d, gm, gd)",
    "gd.oMg[i]": "gd.oMg[0]",
    "computeCollision of a pair": "pin.computeCollision(gm, gd, 0)",
    "computeDistance of a pair": "pin.computeDistance(gm, gd, 0)",
    "computeCollisions": "pin.computeCollisions(gm, gd, False)",
    "computeCollisions(q)": "pin.computeCollisions(m, d, gm, gd, q, False)",
    "computeDistances": "pin.computeDistances(gm, gd)",
    "gd.distanceResults[i].min_distance": "gd.distanceResults[0].min_distance",
    "computeCollisions of spheres": "pin.computeCollisions(spheres, spheres_data, False)",
    "computeDistances of spheres": "pin.computeDistances(spheres, spheres_data)",
}
SOLVERS = {
    f"{name}ConstraintSolver, {count} contacts": f"{name}{count}.solve(*problem{count}, settings{name}, result{name})"
    for name in ("PGS", "ADMM")
    for count in (1, 2, 4, 8, 16, 32)
}
GROUPS = {
    "algorithms": ALGORITHMS,
    "without q": WITHOUT_Q,
    "configurations": CONFIGURATIONS,
    "models": MODELS,
    "getters": GETTERS,
    "objects": OBJECTS,
    "assignments": ASSIGNMENTS,
    "constructors": CONSTRUCTORS,
    "operations": OPERATIONS,
    "joints": JOINTS,
    "constraints": CONSTRAINTS,
    "geometries": GEOMETRIES,
    "solvers": SOLVERS,
}


def prepared(group: str, source: str, root: str, feet: str) -> Callable[[], dict[str, float]]:
    """All calls of a group, ready to be measured [us].

    Args:
        group: One of `GROUPS`.
        source: The path of a URDF, or `KINDS`.
        root: "floating" for a free flyer as the first joint.
        feet: Names of the joints on contacts, after the kind of these, such as "CONTACT_6D,left,right".
    """
    import pinocchio as pin

    roots = [pin.JointModelFreeFlyer()] if root == "floating" else []
    m = _all_kinds(pin) if source == KINDS else pin.buildModelFromUrdf(source, *roots)
    names = _state_of(pin, m) | {"urdf": source, "roots": roots}
    more: dict[str, Callable[[], dict[str, Any]]] = {
        "algorithms": lambda: _algorithm_inputs(pin, names),
        "without q": lambda: _filled_data(pin, names),
        "configurations": lambda: _configuration_inputs(pin, names),
        "models": lambda: _model_inputs(pin, names),
        "getters": lambda: _algorithm_inputs(pin, names),
        "objects": lambda: _small_objects(pin),
        **dict.fromkeys(("assignments", "constructors", "operations"), lambda: _changing_objects(pin, names)),
        "joints": lambda: joints_to_change(pin, names),
        "constraints": lambda: _contacts(pin, names, *feet.split(",")),
        "geometries": lambda: _shapes(pin, names, source),
        "solvers": lambda: _contact_problems(pin, m),
    }
    return _measured(GROUPS[group], names | more[group]())


def _contact_problems(pin: Any, m: Any) -> dict[str, Any]:
    """Contacts with friction, of random Delassus matrices, and solvers with their default settings."""
    import numpy as np

    names: dict[str, Any] = {}
    data = m.createData()
    pin.forwardKinematics(m, data, pin.neutral(m))
    for name in ("PGS", "ADMM"):
        names[f"settings{name}"] = getattr(pin, f"{name}SolverSettings")()
        names[f"result{name}"] = getattr(pin, f"{name}SolverResult")()
    for count in (1, 2, 4, 8, 16, 32):
        rng, rows = np.random.default_rng(7), 3 * count
        models, datas = pin.StdVec_ConstraintModel(), pin.StdVec_ConstraintData()
        models.extend([pin.PointContactConstraintModel(m, 1) for _ in range(count)])
        datas.extend([one.createData() for one in models])
        for one, known in zip(models, datas, strict=True):
            one.calc(m, data, known)
        root = rng.normal(size=(rows, rows + 4))
        g = rng.normal(size=rows)
        g[2::3] = -abs(g[2::3])
        delassus = pin.DelassusOperatorDense(root @ root.T / rows + 0.1 * np.eye(rows))
        names[f"problem{count}"] = delassus, g, models, datas
        for name in ("PGS", "ADMM"):
            names[f"{name}{count}"] = getattr(pin, f"{name}ConstraintSolver")(rows)
    return names


def _measured(calls: dict[str, str], names: dict[str, Any]) -> Callable[[], dict[str, float]]:
    """Measures all calls [us]; `refill(n)` among the names is asked before every measurement of n calls."""
    loops = {}
    refill = names.get("refill", lambda title, count: None)
    for title, call in calls.items():
        exec(f"def loop(n):\n start = clock()\n for _ in range(n):\n  {call}\n return clock() - start", names)
        loops[title] = names["loop"]
        refill(title, 44)
        loops[title](20)
    counts = {}
    for title, loop in loops.items():
        refill(title, 20)
        counts[title] = min(max(int(SPAN * 20 / loop(20)), 2), 2000)

    def measure() -> dict[str, float]:
        next(iter(loops.values()))(1000)  # awake again
        found = {}
        for title, loop in loops.items():
            refill(title, counts[title] + 1)
            loop(1)  # a copied model has frames that are bound anew
            found[title] = loop(counts[title]) / counts[title] * 1e6
        return found

    return measure


def _all_kinds(pin: Any) -> Any:
    """A chain of joints of all kinds, in turns about 0.1 m apart."""
    import numpy as np

    m, parent, place = pin.Model(), 0, pin.SE3(np.eye(3), np.array([0.0, 0.1, 0.1]))
    axis = np.array([0.6, 0.0, 0.8])
    joints = [
        pin.JointModelFreeFlyer(),
        *(getattr(pin, f"JointModel{kind}{x}")() for kind in ("R", "P", "RUB") for x in "XYZ"),
        *(
            getattr(pin, f"JointModel{kind}")()
            for kind in ("Planar", "Spherical", "SphericalZYX", "Translation")
        ),
        pin.JointModelRevoluteUnaligned(axis),
        pin.JointModelPrismaticUnaligned(axis),
        pin.JointModelHelicalUnaligned(axis, 0.1),
        pin.JointModelUniversal(np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])),
    ]
    for k, joint in enumerate(joints):
        parent = m.addJoint(parent, joint, place, f"joint {k}")
        m.appendBodyToJoint(parent, pin.Inertia.FromBox(1.0, 0.1, 0.2, 0.3), place)
        m.addBodyFrame(f"body {k}", parent, place, 0)
    return m


def _state_of(pin: Any, m: Any) -> dict[str, Any]:
    import numpy as np

    rng = np.random.default_rng(0)
    q, k = (pin.integrate(m, pin.neutral(m), rng.uniform(-1.0, 1.0, m.nv)) for _ in range(2))
    v, a, tau = rng.normal(size=(3, m.nv))
    names = {"pin": pin, "copy": copy, "pickle": pickle, "clock": time.perf_counter}
    names |= {"m": m, "d": m.createData(), "q": q, "k": k, "v": v, "a": a, "tau": tau}
    return names | {"end": m.njoints - 1, "last": m.nframes - 1, "M": pin.SE3.Random()}


def _algorithm_inputs(pin: Any, names: dict[str, Any]) -> dict[str, Any]:
    m, d, q, v, a = (names[x] for x in ("m", "d", "q", "v", "a"))
    forces = pin.StdVec_Force()
    forces.extend([pin.Force.Random() for _ in range(m.njoints)])
    pin.forwardKinematics(m, d, q, v, a)
    pin.framesForwardKinematics(m, d, q)
    pin.computeJointJacobians(m, d, q)
    pin.rnea(m, d, q, v, a)
    pin.crba(m, d, q)
    pin.centerOfMass(m, d, q)
    return {"fext": forces, "frame_name": m.frames[m.nframes - 1].name, "joint_name": m.names[m.njoints - 1]}


def _filled_data(pin: Any, names: dict[str, Any]) -> dict[str, Any]:
    """Data that algorithms filled."""
    m, q, v, a = (names[x] for x in ("m", "q", "v", "a"))
    more = _algorithm_inputs(pin, names)
    after_aba, derived, moved = (m.createData() for _ in range(3))
    pin.aba(m, after_aba, q, v, names["tau"], more["fext"], pin.Convention.WORLD)
    pin.computeRNEADerivatives(m, derived, q, v, a)
    pin.computeForwardKinematicsDerivatives(m, moved, q, v, a)
    return more | {"after_aba": after_aba, "derived": derived, "moved": moved}


def _configuration_inputs(pin: Any, names: dict[str, Any]) -> dict[str, Any]:
    import numpy as np

    m = names["m"]
    low, high, bounded = np.full(m.nq, -1.0), np.ones(m.nq), m.copy()
    bounded.lowerPositionLimit, bounded.upperPositionLimit = low, high
    made = {"group": pin.lieGroup(m), "columns": np.ones((m.nv, 3))}
    return made | {"low": low, "high": high, "bounded": bounded}


def _model_inputs(pin: Any, names: dict[str, Any]) -> dict[str, Any]:
    m, d, last = names["m"], names["d"], names["last"]
    made, waiting = itertools.count(), list[Any]()

    def refill(title: str, count: int) -> None:
        """Models with a name that none had before, of which nothing can be known."""
        for _ in range(count if "first at" in title else 0):
            named = m.copy()
            named.frames[last].name = f"frame {next(made)}"
            waiting.append(named.copy())

    def models() -> Iterator[Any]:
        while True:
            yield waiting.pop()

    first = 2 if names["roots"] else 1
    pairs = itertools.cycle([list(pair) for pair in itertools.combinations(range(first, m.njoints), 2)])
    bytes_of = {"model_bytes": pickle.dumps(m), "data_bytes": pickle.dumps(d)}
    return bytes_of | {
        "hand": _hand(pin), "pairs": pairs, "new_models": models(), "refill": refill, "other": m.copy()
    }  # fmt: skip


def _hand(pin: Any) -> Any:
    m = pin.Model()
    for name in ("thumb", "finger"):
        joint = m.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), name)
        m.appendBodyToJoint(joint, pin.Inertia.Identity(), pin.SE3.Identity())
        m.addBodyFrame(f"{name} tip", joint, pin.SE3.Identity(), 0)
    return m


def _small_objects(pin: Any) -> dict[str, Any]:
    import numpy as np

    M, p = pin.SE3.Random(), np.array([0.1, -0.2, 0.3])
    return {
        **{"M": M, "N": pin.SE3.Random(), "p": p, "R": M.rotation.copy(), "six": np.arange(6.0)},
        **{"x": pin.Motion.Random(), "y": pin.Force.Random(), "Y": pin.Inertia.Random()},
        **{
            "moments": np.diag([1.0, 1.1, 1.2]),
            "seven": pin.SE3ToXYZQUAT(M),
            "quat": pin.Quaternion(M.rotation),
        },
    }


def _changing_objects(pin: Any, names: dict[str, Any]) -> dict[str, Any]:
    small = _small_objects(pin)
    return small | objects_to_change(pin, names | small)


def _contacts(pin: Any, names: dict[str, Any], kind: str, *joints: str) -> dict[str, Any]:
    import numpy as np

    m, d, q, v, tau = (names[x] for x in ("m", "d", "q", "v", "tau"))
    rng, kind_of = np.random.default_rng(0), getattr(pin.ContactType, kind)
    cs, ds = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
    for joint in joints:
        cs.append(pin.RigidConstraintModel(kind_of, m, m.getJointId(joint), pin.LOCAL_WORLD_ALIGNED))
        ds.append(cs[-1].createData())
    s = pin.ProximalSettings(1e-12, 0.0, 1)
    pin.initConstraintDynamics(m, d, cs, ds)
    chol = pin.ContactCholeskyDecomposition(m, d, cs, ds)
    pin.constraintDynamics(m, d, q, v, tau, cs, ds, s)
    J, drift = pin.getConstraintsJacobian(m, d, cs, ds), rng.normal(size=len(d.lambda_c))
    chol.compute(m, d, cs, ds, 1e-6)
    return {
        **{"cs": cs, "ds": ds, "s": s, "c": cs[0], "x": ds[0], "chol": chol, "J": J, "drift": drift},
        **{"b": rng.normal(size=chol.size()), "G": chol.getDelassusOperatorCholeskyExpression()},
    }


def _shapes(pin: Any, names: dict[str, Any], urdf: str) -> dict[str, Any]:
    """The shapes of a robot with all pairs, and 20 spheres in the world with all pairs."""
    import coal
    import numpy as np

    m, d, q = names["m"], names["d"], names["q"]
    gm = pin.buildGeomFromUrdf(m, urdf, pin.GeometryType.COLLISION, package_dirs=str(Path(urdf).parents[4]))
    gm.addAllCollisionPairs()
    spheres, rng = pin.GeometryModel(), np.random.default_rng(0)
    for k in range(20):
        place = pin.SE3(np.eye(3), rng.uniform(-1.0, 1.0, 3))
        spheres.addGeometryObject(pin.GeometryObject(f"sphere {k}", k % m.njoints, place, coal.Sphere(0.1)))
    spheres.addAllCollisionPairs()
    gd, spheres_data = gm.createData(), spheres.createData()
    pin.updateGeometryPlacements(m, d, gm, gd, q)
    pin.updateGeometryPlacements(m, d, spheres, spheres_data, q)
    pin.computeDistances(gm, gd)
    one = gm.geometryObjects[0].copy()
    return {"gm": gm, "gd": gd, "spheres": spheres, "spheres_data": spheres_data, "one_geometry": one}
