"""Costs and gradients written by hand as for an optimiser: chain rules, checks by differences, and a Newton step."""

import numpy as np
import pinocchio as pin

np.set_printoptions(precision=6, suppress=True)
model = pin.buildSampleModelManipulator()
data = model.createData()
frame = model.nframes - 1
goal = pin.SE3(pin.rpy.rpyToMatrix(0.2, -0.3, 0.5), np.array([0.3, 0.2, 0.4]))
W = np.diag([10.0, 10, 10, 1, 1, 1])


def cost(q):
    pin.framesForwardKinematics(model, data, q)
    e = pin.log(data.oMf[frame].actInv(goal)).vector
    g = pin.computeGeneralizedGravity(model, data, q)
    return 0.5 * e @ W @ e + 1e-4 * g @ g


def gradient(q):
    J = pin.computeFrameJacobian(model, data, q, frame, pin.LOCAL)
    pin.framesForwardKinematics(model, data, q)
    M = data.oMf[frame].actInv(goal)
    e = pin.log6(M).vector
    dg = pin.computeGeneralizedGravityDerivatives(model, data, q)
    g = pin.computeGeneralizedGravity(model, data, q)
    return -J.T @ pin.Jlog6(M.inverse()).T @ W @ e + 2e-4 * dg.T @ g, J


q = 0.3 * np.ones(model.nq)
g, _ = gradient(q)
by_differences = np.array([(cost(q + h) - cost(q - h)) / 2e-6 for h in 1e-6 * np.eye(model.nq)])
print(np.abs(g - by_differences).max() < 1e-4, round(cost(q), 6))
for _ in range(25):
    g, J = gradient(q)
    step = np.linalg.solve(J.T @ W @ J + 0.05 * np.eye(model.nv), -g)
    size = 1.0
    while cost(pin.integrate(model, q, size * step)) > cost(q) and size > 1e-4:
        size /= 2
    q = pin.integrate(model, q, size * step)
print(q, round(cost(q), 6))
pin.computeRNEADerivatives(model, data, q, q, q)
print(data.dtau_dq[0], data.dtau_dv[1])
pin.computeForwardKinematicsDerivatives(model, data, q, q, q)
dv_dq, dv_dv = pin.getFrameVelocityDerivatives(model, data, frame, pin.LOCAL)
da = pin.getFrameAccelerationDerivatives(model, data, frame, pin.LOCAL_WORLD_ALIGNED)
print(dv_dq[0], dv_dv[3], [x[0, 0].round(6) for x in da])
pin.computeJointKinematicHessians(model, data, q)
H = pin.getJointKinematicHessian(model, data, 4, pin.LOCAL)
print(H.shape, round(float(np.abs(H).sum()), 5))
