"""A robot by its name: what its model and its data hold, and the short calls of RobotWrapper, in today's spelling.

Run it by `ulna run`. You should see its joints, where the wrist is, the centre of mass, and where joint 3 is.
"""

import numpy as np
import pinocchio as pin
from example_robot_data import load

robot = load("ur5")
print(robot.model)
print(robot.model.jointPlacements[1])
print(robot.model.inertias[2])
print(robot.model.gravity)

idx = robot.index("wrist_3_joint")
q = pin.neutral(robot.model)
placement = robot.placement(q, idx)  # a reference into robot.data: .copy() keeps it
assert placement == robot.data.oMi[idx].copy()
print(placement)

q = pin.randomConfiguration(robot.model)
v = np.random.default_rng(0).uniform(-1, 1, robot.nv)
print(robot.com(q))
print(robot.placement(q, 3))
assert robot.Jcom(q).shape == (3, robot.nv)
assert np.allclose(robot.mass(q), robot.mass(q).T)
assert np.allclose(robot.nle(q, np.zeros(robot.nv)), robot.gravity(q))
assert np.allclose(robot.Jcom(q) @ v, robot.vcom(q, v))
