"""Exercise: the end effector touches a sphere, then takes a box by a face, in historic spelling.

Run it by `ulna run`. You should see the tool at the red sphere, and then aligned with the box.
"""

# ruff: noqa: F403, F405, B007 (spelled as the tutorial did)

import numpy as np
import pinocchio as pin
from example_robot_data import getModelPath
from pinocchio.robot_wrapper import RobotWrapper
from pinocchio.utils import *

robot = RobotWrapper.BuildFromURDF(getModelPath("ur_description") + "/ur_description/urdf/ur5_gripper.urdf")
robot.initDisplay(loadModel=True)
gui = robot.viewer.gui

# The target, as a sphere
target = np.array([0.5, 0.1, 0.2])
gui.addSphere("world/sphere", 0.1, [1.0, 0.2, 0.2, 1.0])
gui.applyConfiguration("world/sphere", (0.5, 0.1, 0.2, 1.0, 0.0, 0.0, 0.0))
gui.refresh()  # Refresh the window.

# Newton's steps towards it: the translation is chosen, the rotation is free
q = np.array([-0.375, -1.2, 1.71, -0.51, -0.375, 0.0])
for step in range(20):
    M = robot.position(q, 6)
    gap = M.rotation.T @ (target - M.translation)
    q = q + npl.pinv(robot.jointJacobian(q, 6)[:3]) @ gap
robot.display(q)
print("reached", robot.placement(q, 6).translation)
assert npl.norm(robot.placement(q, 6).translation - target) < 1e-9

# The target, as a box whose rotation is imposed
gui.deleteNode("world/sphere", True)
gui.addBox("world/box", 0.1, 0.2, 0.1, [0.2, 0.3, 0.9, 1.0])
oMbox = pin.SE3(rotate("x", -np.pi / 2), np.array([0.4, 0.2, 0.3]))
gui.applyConfiguration("world/box", pin.utils.se3ToXYZQUAT(oMbox))
boxMtool = pin.SE3(rotate("y", np.pi / 2), np.array([-0.05, 0.0, 0.0]))  # on the middle of a face
goal = oMbox * boxMtool
for step in range(200):
    gap = pin.log(robot.position(q, 6).inverse() * goal).vector
    change = npl.pinv(robot.jointJacobian(q, 6), 1e-3) @ gap
    q = q + change * min(1.0, 0.2 / max(npl.norm(change), 1e-12))
robot.display(q)
print("aligned", robot.placement(q, 6))
assert npl.norm(pin.log(robot.placement(q, 6).inverse() * goal).vector) < 1e-9
gui.captureFrame("python-pinocchio", "pick.png")
