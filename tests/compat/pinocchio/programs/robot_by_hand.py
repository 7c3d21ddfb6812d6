"""A planar biped built joint by joint, then reduced, changed and simulated."""

import copy
import pickle

import numpy as np
import pinocchio as pin

np.set_printoptions(precision=5, suppress=True)
model = pin.Model()
model.name = "biped"
base = model.addJoint(0, pin.JointModelPlanar(), pin.SE3.Identity(), "base")
model.addJointFrame(base)
torso = pin.Inertia.FromCylinder(8.0, 0.1, 0.5)
model.appendBodyToJoint(base, torso, pin.SE3(np.eye(3), np.array([0.0, 0.0, 0.25])))
model.addBodyFrame("torso", base, pin.SE3.Identity(), model.getFrameId("base"))
for side, y in (("left", 0.1), ("right", -0.1)):
    hip = model.addJoint(
        base,
        pin.JointModelRY(),
        pin.SE3(np.eye(3), np.array([0.0, y, 0.0])),
        f"{side}_hip",
        np.array([50.0]),
        np.array([8.0]),
        np.array([-1.5]),
        np.array([1.5]),
    )
    model.addJointFrame(hip, -1)
    model.appendBodyToJoint(
        hip, pin.Inertia.FromCapsule(2.0, 0.05, 0.4), pin.SE3(np.eye(3), np.array([0.0, 0.0, -0.2]))
    )
    knee = model.addJoint(
        hip,
        pin.JointModelRevoluteUnaligned(np.array([0.0, 1.0, 0.0])),
        pin.SE3(pin.utils.rotate("z", 0.0), np.array([0.0, 0.0, -0.4])),
        f"{side}_knee",
    )
    model.addJointFrame(knee)
    model.appendBodyToJoint(
        knee, pin.Inertia(1.0, np.array([0.0, 0.0, -0.2]), np.diag([0.02, 0.02, 0.001])), pin.SE3.Identity()
    )
    model.addFrame(
        pin.Frame(
            f"{side}_foot",
            knee,
            model.getFrameId(f"{side}_knee"),
            pin.SE3(np.eye(3), np.array([0.0, 0.0, -0.4])),
            pin.FrameType.OP_FRAME,
        )
    )
print(model)
for frame in model.frames:
    print(frame)
for joint in model.joints:
    print(joint.id, joint.shortname(), joint.idx_q, joint.idx_v, joint.nq, joint.nv)
print(model.lowerPositionLimit, model.effortLimit, model.velocityLimit)
print(
    model.existJointName("left_knee"),
    model.existFrame("left_foot"),
    model.getBodyId("torso"),
    [list(s) for s in model.subtrees],
)
data = model.createData()
q, v = pin.neutral(model), np.zeros(model.nv)
q[1] = 0.8
q[model.idx_qs[model.getJointId("left_knee")]] = 0.4
for _step in range(20):
    tau = np.zeros(model.nv)
    tau[3:] = -20 * q[4:] - 1.0 * v[3:]
    a = pin.aba(model, data, q, v, tau)
    v += 1e-2 * a
    q = pin.integrate(model, q, 1e-2 * v)
print(q, v, pin.isNormalized(model, q), pin.computeMechanicalEnergy(model, data, q, v))
print(model.inertias[1], sum(inertia.mass for inertia in model.inertias), pin.computeTotalMass(model))
model.referenceConfigurations["stand"] = pin.neutral(model)
model.referenceConfigurations["crouch"] = q
reduced = pin.buildReducedModel(model, [model.getJointId("right_knee"), model.getJointId("right_hip")], q)
print(reduced, reduced.referenceConfigurations["crouch"], [f.name for f in reduced.frames])
rdata = reduced.createData()
pin.framesForwardKinematics(reduced, rdata, reduced.referenceConfigurations["crouch"])
pin.framesForwardKinematics(model, data, q)
foot = [m.getFrameId("right_foot") for m in (model, reduced)]
print(data.oMf[foot[0]].isApprox(rdata.oMf[foot[1]]), pin.computeTotalMass(reduced))
heavier = copy.deepcopy(model)
heavier.inertias[1].mass *= 2.0
heavier.jointPlacements[2].translation += np.array([0.0, 0.02, 0.0])
heavier.armature[:] = 0.1
print(
    pin.crba(heavier, heavier.createData(), q)[3:, 3:],
    heavier == model,
    pickle.loads(pickle.dumps(model)) == model,
)
both = pin.appendModel(pin.buildSampleModelManipulator(), model, 0, pin.SE3.Identity())
print(both.njoints, both.nq, both.names[-1], both.parents.tolist())
locked, geometry = pin.buildReducedModel(model, pin.GeometryModel(), [2], q)
print(locked.names.tolist(), geometry.ngeoms)
