"""A controller in operational space."""

import numpy as np
import pinocchio as pin

model = pin.buildSampleModelManipulator()
data = model.createData()
q = np.array([0.1, 0.5, -0.3, 0.8, 0.2, -0.4])
v = np.zeros(6)
dt = 1e-3
fid = model.nframes - 1
pin.framesForwardKinematics(model, data, q)
ref = data.oMf[fid].copy()
ref.translation += [0.05, -0.05, 0.05]
for _k in range(400):
    pin.forwardKinematics(model, data, q, v)
    pin.updateFramePlacements(model, data)
    J = pin.computeFrameJacobian(model, data, q, fid, pin.LOCAL_WORLD_ALIGNED)
    vel = pin.getFrameVelocity(model, data, fid, pin.LOCAL_WORLD_ALIGNED)
    e = np.concatenate(
        [
            ref.translation - data.oMf[fid].translation,
            data.oMf[fid].rotation @ pin.log3(data.oMf[fid].rotation.T @ ref.rotation),
        ]
    )
    Minv = pin.computeMinverse(model, data, q)
    L = np.linalg.inv(J @ Minv @ J.T + 1e-6 * np.eye(6))
    tau = J.T @ (L @ (200 * e - 28 * vel.vector)) + pin.nonLinearEffects(model, data, q, v)
    a = pin.aba(model, data, q, v, tau)
    v = v + dt * a
    q = pin.integrate(model, q, dt * v)
print(
    np.round(e, 4),
    np.round(q, 3),
    vel,
    np.round(pin.getFrameClassicalAcceleration(model, data, fid, pin.LOCAL).linear, 2).shape,
)
