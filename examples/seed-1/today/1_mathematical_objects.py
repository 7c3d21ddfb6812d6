"""Matrices, displacements, velocities and forces, in today's spelling.

Run it by `ulna run`. You should see the product of length 2, a random 6 x 6 matrix, and a placement, a velocity and a
force.
"""

import numpy as np
import pinocchio as pin
from pinocchio.utils import eye, isapprox, mprint, rand, rotate, zero

A = np.array([[1, 2, 3, 4], [5, 6, 7, 8]])
b = np.zeros(4)
print(A @ b)

assert eye(6).shape == (6, 6) and zero(6).shape == (6,) and zero([6, 4]).shape == (6, 4)
assert not isapprox(zero(6), rand(6))
mprint(rand([6, 6]))
u, v = rand(3), rand(3)
assert isapprox(pin.skew(u) @ v, np.cross(u, v))
assert isapprox(rotate("x", 0.4), pin.rpy.rpyToMatrix(0.4, 0.0, 0.0))

M = pin.SE3.Random()
M.translation = zero(3)
M.rotation = eye(3)
assert M == pin.SE3(eye(3), zero(3)) == pin.SE3.Identity()
print(M)

nu = pin.Motion.Random()
nu.linear, nu.angular = zero(3), zero(3)
assert nu == pin.Motion(zero(3), zero(3)) == pin.Motion.Zero()
print(nu)

phi = pin.Force.Random()
phi.linear, phi.angular = zero(3), zero(3)
assert phi == pin.Force(zero(3), zero(3)) == pin.Force.Zero()
print(phi)
