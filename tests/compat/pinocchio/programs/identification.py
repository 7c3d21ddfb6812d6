"""Parameters of bodies found by regressors."""

import numpy as np
import pinocchio as pin

model = pin.buildSampleModelManipulator()
data = model.createData()
rng = np.random.RandomState(2)
W, b = [], []
for _ in range(60):
    q, v, a = rng.uniform(-2, 2, (3, 6))
    W.append(pin.computeJointTorqueRegressor(model, data, q, v, a).copy())
    b.append(pin.rnea(model, data, q, v, a))
W, b = np.vstack(W), np.concatenate(b)
phi = np.concatenate([I.toDynamicParameters() for I in model.inertias[1:]])
print(W.shape, np.linalg.matrix_rank(W, 1e-8), np.abs(W @ phi - b).max() < 1e-9)
est = np.linalg.lstsq(W, b, rcond=None)[0]
print(np.abs(W @ est - b).max() < 1e-8)
I = pin.Inertia.FromDynamicParameters(phi[20:30])
print(I, np.round(pin.jointBodyRegressor(model, data, 4) @ phi[30:40], 6))
ps = pin.PseudoInertia.FromInertia(model.inertias[3] + pin.Inertia.FromSphere(1.0, 0.1))
print(
    np.round(ps.toMatrix(), 6),
    np.round(pin.LogCholeskyParameters.FromPseudoInertia(ps).toDynamicParameters(), 6)
    if hasattr(pin.LogCholeskyParameters, "FromPseudoInertia")
    else "",
)
print(
    np.round(pin.computeStaticRegressor(model, data, q), 5).sum(),
    np.round(
        pin.computeKineticEnergyRegressor(model, data, q, v) @ phi
        - pin.computeKineticEnergy(model, data, q, v),
        9,
    ),
)
