"""Centroidal momentum, its rate and derivatives."""

import numpy as np
import pinocchio as pin

model = pin.buildSampleModelHumanoid(True)
data = model.createData()
rng = np.random.RandomState(0)
q = pin.integrate(model, pin.neutral(model), rng.uniform(-0.5, 0.5, model.nv))
v, a = rng.uniform(-1, 1, (2, model.nv))
Ag = pin.ccrba(model, data, q, v)
print(np.round(data.hg.vector, 6), np.allclose(Ag @ v, data.hg.vector), np.round(data.Ig.inertia, 6))
pin.dccrba(model, data, q, v)
pin.computeCentroidalMomentumTimeVariation(model, data, q, v, a)
print(np.round(data.dhg, 5))
dh_dq, dhdot_dq, dhdot_dv, dhdot_da = pin.computeCentroidalDynamicsDerivatives(model, data, q, v, a)
eps, k = 1e-7, 9
dq = np.zeros(model.nv)
dq[k] = eps
d2 = model.createData()
pin.computeCentroidalMomentumTimeVariation(model, d2, pin.integrate(model, q, dq), v, a)
p = d2.dhg.vector.copy()
pin.computeCentroidalMomentumTimeVariation(model, d2, q, v, a)
print(
    np.round(np.abs((p - d2.dhg.vector) / eps - dhdot_dq[:, k]).max(), 3),
    data.hg,
    data.com[0].round(6),
    data.vcom[0].round(6),
)
print(
    pin.computeTotalMass(model),
    round(pin.computeKineticEnergy(model, data, q, v), 8),
    round(pin.computePotentialEnergy(model, data, q), 8),
)
