"""Model predictive control of an arm: linearised dynamics at each step, a Riccati recursion, feedback."""

import numpy as np
import pinocchio as pin

np.set_printoptions(precision=6, suppress=True)
model = pin.buildSampleModelManipulator()
data, sim = model.createData(), model.createData()
nq, nv, dt, horizon = model.nq, model.nv, 0.02, 12
goal = np.array([0.4, -0.3, 0.2, 0.6, -0.2, 0.1])
q, v = pin.neutral(model), np.zeros(nv)
Q = np.diag([40.0] * nv + [1.0] * nv)
R = 1e-3 * np.eye(nv)
for step in range(15):
    tau0 = pin.computeGeneralizedGravity(model, data, q)
    pin.computeABADerivatives(model, data, q, v, tau0)
    A = np.eye(2 * nv)
    A[:nv, nv:] = dt * np.eye(nv)
    A[nv:, :nv] = dt * data.ddq_dq
    A[nv:, nv:] += dt * data.ddq_dv
    B = np.vstack([np.zeros((nv, nv)), dt * data.Minv])
    B[:nv] = 0.5 * dt * dt * data.Minv
    drift = np.concatenate([dt * v, dt * data.ddq])
    drift[:nv] += pin.difference(model, goal, q) - pin.difference(model, goal, q)
    P = Q * 10
    for _ in range(horizon):
        K = np.linalg.solve(R + B.T @ P @ B, B.T @ P @ A)
        P = Q + A.T @ P @ (A - B @ K)
    x = np.concatenate([pin.difference(model, goal, q), v])
    u = tau0 - K @ x
    for _ in range(4):
        a = pin.aba(model, sim, q, v, u)
        v = v + 0.005 * a
        q = pin.integrate(model, q, 0.005 * v)
    if step % 5 == 4:
        print(step, q, np.linalg.norm(v).round(6))
print("energy", round(pin.computeMechanicalEnergy(model, sim, q, v), 6))
M = pin.crba(model, data, q)
print("condition", round(float(np.linalg.cond(M)), 3), np.allclose(M, M.T))
