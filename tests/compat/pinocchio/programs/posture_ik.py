"""Inverse kinematics of an arm: log6 errors, Levenberg-Marquardt, limits, null space, several starts."""

import numpy as np
import pinocchio as pin
from numpy.linalg import norm, solve

np.set_printoptions(precision=5, suppress=True)
model = pin.buildSampleModelManipulator()
data = model.createData()
TOOL = model.addFrame(
    pin.Frame(
        "tool",
        model.njoints - 1,
        model.getFrameId("effector_body"),
        pin.SE3(np.eye(3), np.array([0.0, 0.0, 0.1])),
        pin.FrameType.OP_FRAME,
    )
)
data = model.createData()
model.lowerPositionLimit[:] = -np.pi
model.upperPositionLimit[:] = np.pi
q_goal = np.array([0.5, -0.4, 0.8, 1.1, -0.3, 0.6])
pin.forwardKinematics(model, data, q_goal)
goal = pin.updateFramePlacement(model, data, TOOL).copy()
print(goal)


def error_of(q):
    pin.framesForwardKinematics(model, data, q)
    return pin.log6(data.oMf[TOOL].actInv(goal)).vector


def clipped(q):
    return np.minimum(np.maximum(q, model.lowerPositionLimit), model.upperPositionLimit)


def levenberg(q, damping=1e-2, steps=60):
    err = error_of(q)
    for _ in range(steps):
        if norm(err) < 1e-10:
            break
        J = pin.computeFrameJacobian(model, data, q, TOOL, pin.ReferenceFrame.LOCAL)
        J = -pin.Jlog6(data.oMf[TOOL].actInv(goal).inverse()) @ J
        H = J.T @ J + damping * norm(err) ** 2 * np.eye(model.nv)
        dq = -solve(H, J.T @ err)
        trial = clipped(pin.integrate(model, q, dq))
        new = error_of(trial)
        if norm(new) < norm(err):
            q, err, damping = trial, new, damping * 0.5
        else:
            damping *= 4
    return q, norm(err)


for k, start in enumerate([pin.neutral(model), q_goal + 0.3, -q_goal]):
    q, residual = levenberg(start)
    print(k, residual < 1e-8, pin.distance(model, q, q_goal) < 1e-6)

# null space of the position task
q = q_goal.copy()
for _ in range(30):
    pin.computeJointJacobians(model, data, q)
    pin.updateFramePlacements(model, data)
    J = pin.getFrameJacobian(model, data, TOOL, pin.LOCAL_WORLD_ALIGNED)[:3]
    pull = goal.translation - data.oMf[TOOL].translation
    pinv = np.linalg.pinv(J)
    null = np.eye(model.nv) - pinv @ J
    q = pin.integrate(model, q, pinv @ pull + null @ pin.difference(model, q, np.zeros(model.nq)) * 0.1)
print(q, norm(data.oMf[TOOL].translation - goal.translation) < 1e-3)
v = pin.Motion(np.linalg.pinv(pin.computeFrameJacobian(model, data, q, TOOL)) @ pin.log(goal).vector)
print(v, pin.exp(v).isApprox(pin.exp6(v)), pin.SE3.Interpolate(goal, goal * pin.exp6(v), 0.5))
