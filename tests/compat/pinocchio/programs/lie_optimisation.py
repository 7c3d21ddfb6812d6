"""The mean of poses, a spline of rotations, and a filter on SE(3)."""

import numpy as np
import pinocchio as pin
from pinocchio import liegroups as groups

np.set_printoptions(precision=6, suppress=True)
rng = np.random.default_rng(0)
centre = pin.SE3(pin.exp3(np.array([0.3, -0.2, 0.5])), np.array([1.0, 0.5, -0.2]))
poses = [centre * pin.exp6(pin.Motion(0.2 * rng.normal(size=6))) for _ in range(12)]
mean = poses[0].copy()
for _ in range(10):
    step = sum((pin.log6(mean.inverse() * M).vector for M in poses), np.zeros(6)) / len(poses)
    mean = mean * pin.exp6(step)
print(mean)
print(np.linalg.norm(step) < 1e-9)
SE3 = groups.SE3()
a, b = (pin.SE3ToXYZQUAT(M) for M in poses[:2])
print(SE3.name, SE3.nq, SE3.nv, SE3.difference(a, b))
print(SE3.integrate(a, SE3.difference(a, b)) - b)
print(SE3.dIntegrate_dv(a, 0.1 * np.ones(6))[0], SE3.dDifference(a, b, pin.ARG1)[5])
print(SE3.interpolate(a, b, 0.25), SE3.distance(a, b), SE3.squaredDistance(a, b))
product = groups.SO3() * groups.R2()
print(product.name, product.nq, product.neutral)
q0, q1 = pin.Quaternion(poses[2].rotation), pin.Quaternion(poses[3].rotation)
for t in (0.0, 0.3, 1.0):
    print(q0.slerp(t, q1).coeffs() * np.sign(q0.slerp(t, q1).w))
w = np.array([0.4, -0.7, 0.2])
print(pin.Jexp3(w) @ pin.Jlog3(pin.exp3(w)))
print(pin.Hlog3(pin.exp3(w), w)[0])
print(pin.log3(pin.exp3(w)), pin.exp3_quat(w), pin.exp6_quat(np.concatenate([w, w])))
