"""A mean of poses, and spaces of configurations."""

import numpy as np
import pinocchio as pin
from numpy.linalg import norm

rng = np.random.RandomState(4)
target = [pin.exp6(pin.Motion(rng.uniform(-1, 1, 6))) for _ in range(6)]
M = pin.SE3.Identity()
for it in range(50):  # noqa: B007 - a mean of poses by Gauss and Newton
    e = np.mean([pin.log6(M.actInv(T)).vector for T in target], axis=0)
    if norm(e) < 1e-12:
        break
    M = M * pin.exp6(e)
print(it, M)
print(pin.SE3ToXYZQUAT(M).round(8))
space = pin.liegroups.SE3() * pin.liegroups.R3()
q0, q1 = space.neutral, np.concatenate([pin.SE3ToXYZQUAT(target[0]), [1.0, 2, 3]])
d = space.difference(q0, q1)
print(
    space.name,
    space.nq,
    space.nv,
    np.round(d, 6),
    norm(space.integrate(q0, d) - q1) < 1e-9,
    np.round(space.interpolate(q0, q1, 0.3), 6),
)
J0, J1 = space.dDifference(q0, q1, pin.ARG0), space.dDifference(q0, q1, pin.ARG1)
print(np.round(J1 @ space.dIntegrate_dv(q0, d), 6).trace(), np.round(J0, 4).sum())
w = np.array([0.1, 2.0, -0.4])
R = pin.exp3(w)
print(
    pin.log3(R),
    np.round(pin.Jexp3(w) @ pin.Jlog3(R), 9).tolist(),
    pin.rpy.matrixToRpy(R).round(6),
    pin.Quaternion(R),
    pin.AngleAxis(R).angle.__round__(9),
)
