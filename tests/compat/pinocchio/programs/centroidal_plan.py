"""Centroidal quantities along a motion: momentum, its rate by differences, capture point, zero moment point."""

import numpy as np
import pinocchio as pin

np.set_printoptions(precision=5, suppress=True)
model = pin.buildSampleModelHumanoid()
data, other = model.createData(), model.createData()
rng = np.random.default_rng(7)
q = pin.integrate(model, pin.neutral(model), 0.2 * rng.normal(size=model.nv))
v, a = 0.3 * rng.normal(size=(2, model.nv))
mass = pin.computeTotalMass(model, data)
for step in range(4):
    pin.centerOfMass(model, data, q, v, a)
    c, dc, ddc = data.com[0].copy(), data.vcom[0].copy(), data.acom[0].copy()
    h = pin.computeCentroidalMomentum(model, data, q, v).copy()
    dh = pin.computeCentroidalMomentumTimeVariation(model, data, q, v, a).copy()
    Ag = pin.ccrba(model, data, q, v)
    pin.dccrba(model, data, q, v)
    print(step, c, np.linalg.norm(h.linear - mass * dc) < 1e-10, np.linalg.norm(Ag @ v - h.vector) < 1e-10)
    print(dh, np.linalg.norm(data.dAg @ v + data.Ag @ a - dh.vector) < 1e-9)
    omega = np.sqrt(9.81 / max(abs(c[2]), 0.2))
    print("capture", (c + dc / omega)[:2])
    weight = pin.Force(mass * np.array([0, 0, -9.81]), np.zeros(3))
    w = dh - weight
    print("zmp", np.array([-w.angular[1], w.angular[0]]) / w.linear[2] + c[:2])
    _, _, dFdv, dFda = pin.computeCentroidalDynamicsDerivatives(model, data, q, v, a)
    print(np.linalg.norm(dFda - Ag) < 1e-9, dFdv[:2, :3].ravel())
    q, v = pin.integrate(model, q, 0.05 * v), v + 0.05 * a
print(pin.computeSubtreeMasses(model, data), [round(x, 5) for x in data.mass][:6])
print(pin.jacobianSubtreeCenterOfMass(model, data, q, 3)[0, :8])
print(
    round(pin.computeKineticEnergy(model, data, q, v), 6),
    round(pin.computePotentialEnergy(model, data, q), 6),
)
