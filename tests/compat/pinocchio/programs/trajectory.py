"""A path between two configurations, and its torques."""

import itertools

import numpy as np
import pinocchio as pin

model = pin.buildSampleModelHumanoid(True)
rng = np.random.RandomState(5)
q0 = pin.neutral(model)
q1 = pin.integrate(model, q0, rng.uniform(-1, 1, model.nv))
path = [pin.interpolate(model, q0, q1, t) for t in np.linspace(0, 1, 11)]
v = [pin.difference(model, a, b) / 0.1 for a, b in itertools.pairwise(path)]
print(
    np.round(path[5], 5).tolist(),
    np.round(v[3] - v[4], 9).max(),
    pin.distance(model, q0, q1).__round__(8),
    pin.squaredDistance(model, q0, q1).round(6).sum(),
    pin.isNormalized(model, path[3]),
    pin.isSameConfiguration(model, q0, q0, 1e-9),
)
data = model.createData()
tau = np.array([pin.rnea(model, data, q, w, np.zeros(model.nv)) for q, w in zip(path, v, strict=False)])
print(tau.shape, np.round(tau[4], 4).tolist())
fext = pin.StdVec_Force() if hasattr(pin, "StdVec_Force") else []
for i in range(model.njoints):
    fext.append(pin.Force(np.arange(6.0) * (i == 5)))
print(
    np.round(pin.rnea(model, data, q1, v[0], v[1], fext) - pin.rnea(model, data, q1, v[0], v[1]), 5).tolist()
)
print(
    np.round(pin.computeStaticTorque(model, data, q1, fext), 4).tolist(),
    pin.normalize(model, q1 * 1.0).round(4).sum(),
)
print(
    pin.neutral(model).tolist()[:7],
    [data.mass[i].__round__(6) for i in range(3)],
    np.round(pin.computeCoriolisMatrix(model, data, q1, v[0]) @ v[0] + data.g * 0, 4).sum(),
)
