"""Derivatives compared with differences."""

import numpy as np
import pinocchio as pin

model = pin.buildSampleModelHumanoidRandom(True) if False else pin.buildSampleModelHumanoid(True)
data = model.createData()
rng = np.random.RandomState(7)
q = pin.integrate(model, pin.neutral(model), rng.uniform(-0.4, 0.4, model.nv))
v, tau = rng.uniform(-1, 1, (2, model.nv))
pin.computeABADerivatives(model, data, q, v, tau)
A = data.ddq_dq.copy()
B = data.ddq_dv.copy()
C = data.Minv.copy()


def num(f, n, h=1e-7):
    return np.array([(f(h * e) - f(-h * e)) / (2 * h) for e in np.eye(n)]).T


d2 = model.createData()
Aq = num(lambda x: pin.aba(model, d2, pin.integrate(model, q, x), v, tau).copy(), model.nv)
Bv = num(lambda x: pin.aba(model, d2, q, v + x, tau).copy(), model.nv)
print(
    np.allclose(A, Aq, atol=2e-4 * abs(Aq).max()),
    np.allclose(B, Bv, atol=1e-4),
    round(float(np.triu(C).sum()), 5),
    round(float(A.sum()), 3),
)
a = pin.aba(model, data, q, v, tau)
r = pin.computeRNEADerivatives(model, data, q, v, a)
print([round(float(np.triu(x).sum()), 4) for x in r], type(r).__name__)
pin.computeForwardKinematicsDerivatives(model, data, q, v, a)
fid = model.nframes - 1
print(
    [x.shape for x in pin.getFrameAccelerationDerivatives(model, data, fid, pin.LOCAL_WORLD_ALIGNED)],
    np.round(pin.getFrameVelocityDerivatives(model, data, fid, pin.LOCAL)[0], 3).sum(),
)
H = None
pin.computeJointKinematicHessians(model, data, q)
print(pin.getJointKinematicHessian(model, data, 5, pin.WORLD).shape)
print(
    np.round(pin.dIntegrate(model, q, v)[1], 4).sum(),
    np.round(pin.dDifference(model, q, pin.neutral(model))[0], 4).trace(),
)
