"""Base parameters of an arm: regressors, QR with pivoting, and pseudo inertias."""

import numpy as np
import pinocchio as pin

np.set_printoptions(precision=5, suppress=True)
model = pin.buildSampleModelManipulator()
data = model.createData()
rng = np.random.default_rng(4)
rows, torques = [], []
parameters = np.concatenate([model.inertias[i].toDynamicParameters() for i in range(1, model.njoints)])
for _ in range(40):
    q, v, a = rng.uniform(-1, 1, (3, model.nv))
    rows.append(pin.computeJointTorqueRegressor(model, data, q, v, a).copy())
    torques.append(pin.rnea(model, data, q, v, a).copy())
W, tau = np.vstack(rows), np.concatenate(torques)
print(W.shape, np.linalg.matrix_rank(W), np.abs(W @ parameters - tau).max() < 1e-10)
found = np.linalg.lstsq(W, tau, rcond=None)[0]
print(np.abs(W @ found - tau).max() < 1e-10, round(float(np.linalg.norm(found)), 4))
pin.rnea(model, data, q, v, a)
print(pin.jointBodyRegressor(model, data, 3)[0])
print(pin.frameBodyRegressor(model, data, model.nframes - 1)[2])
print(pin.bodyRegressor(pin.Motion(np.arange(6.0)), pin.Motion(np.ones(6)))[1])
print(pin.computeStaticRegressor(model, data, q)[:, :6])
print(pin.computeKineticEnergyRegressor(model, data, q, v)[:8])
print(pin.computePotentialEnergyRegressor(model, data, q)[:8])
Y = model.inertias[2]
P = Y.toPseudoInertia() if hasattr(Y, "toPseudoInertia") else None
print(P.toMatrix() if P is not None else None)
print(pin.Inertia.FromDynamicParameters(Y.toDynamicParameters()).isApprox(Y, 1e-9))
print(Y.vxiv(pin.Motion(np.ones(6))), Y.variation(pin.Motion(np.ones(6)))[0])
