"""A robot from its file: what its model and its data hold, and the short calls of RobotWrapper, in historic spelling.

Run it by `ulna run`. You should see what the model offers, the wrist, the centre of mass, joint 3.
"""

# ruff: noqa: F403, F405, UP031 (spelled as the tutorial did)

from example_robot_data import getModelPath
from pinocchio.robot_wrapper import RobotWrapper
from pinocchio.utils import *

URDF = getModelPath("ur_description") + "/ur_description/urdf/ur5_gripper.urdf"
robot = RobotWrapper.BuildFromURDF(URDF)

for name, function in robot.model.__class__.__dict__.items():
    print(" **** %s: %s" % (name, function.__doc__))

print(robot.model.names)
print(robot.model.parents)
print(robot.model.jointPosition[1])
print(robot.model.inertias[2])
print(robot.model.gravity)

# Get index of end effector
idx = robot.index("wrist_3_joint")

# Compute and get the placement of joint number idx
q = zero(6)
placement = robot.placement(q, idx)
# Only get the placement
placement = robot.data.oMi[idx].copy()
print(placement)

q = rand(robot.nq)
v = rand(robot.nv)
print(robot.com(q))  # Compute the robot center of mass.
print(robot.placement(q, 3))  # Compute the placement of joint 3
robot.Jcom(q)
robot.mass(q)
robot.gravity(q)
robot.position(q, 3)
robot.velocity(q, v, 3)
assert isapprox(robot.biais(q, zero(robot.nv)), robot.gravity(q))
assert isapprox(robot.biais(q, v), robot.bias(q, v)) and isapprox(robot.biais(q, v), robot.nle(q, v))
