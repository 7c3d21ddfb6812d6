"""Matrices, displacements, velocities and forces, as the tutorial spelled them.

Run it by `ulna run`. You should see the 2 x 1 product, a random 6 x 6 matrix, and a placement, a velocity and a force.
"""

# ruff: noqa: F403, F405 (spelled as the tutorial did)

import numpy as np
import pinocchio as pin
from pinocchio.utils import *

A = np.matrix([[1, 2, 3, 4], [5, 6, 7, 8]])  # Define a 2x4 matrix
b = np.zeros([4, 1])  # Define a 4 vector (ie a 4x1 matrix) initialized with 0
c = A * b  # Obtain c by multiplying A by b.
print(c)

eye(6)  # Return a 6x6 identity matrix
zero(6)  # Return a zero 6x1 vector
zero([6, 4])  # Return a zero 6x4 matrix
rand(6)  # Random 6x1 vector
isapprox(zero(6), rand(6))  # Test epsilon equality
mprint(rand([6, 6]))  # Matlab-style print
skew(rand(3))  # Skew "cross-product" 3x3 matrix from a 3x1 vector
cross(rand(3), rand(3))  # Cross product of R^3
rotate("x", 0.4)  # Build a rotation matrix of 0.4rad around X.

R = eye(3)
p = zero(3)
M0 = pin.SE3(R, p)
M = pin.SE3.Random()
M.translation = p
M.rotation = R
print(M)

v = zero(3)
w = zero(3)
nu0 = pin.Motion(v, w)
nu = pin.Motion.Random()
nu.linear = v
nu.angular = w
print(nu)

f = zero(3)
tau = zero(3)
phi0 = pin.Force(f, tau)
phi = pin.Force.Random()
phi.linear = f
phi.angular = tau
print(phi)
assert M == M0 and nu == nu0 and phi == phi0
