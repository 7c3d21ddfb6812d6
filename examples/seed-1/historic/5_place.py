"""Exercise: the arm moves, and the ball sticks to its end effector, in historic spelling.

Run it by `ulna run`. You should see the ball travel with the tool.
"""

# ruff: noqa: F403, F405, RUF005 (spelled as the tutorial did)

from time import sleep

import numpy as np
from example_robot_data import getModelPath
from pinocchio.robot_wrapper import RobotWrapper
from pinocchio.utils import *

robot = RobotWrapper.BuildFromURDF(getModelPath("ur_description") + "/ur_description/urdf/ur5_gripper.urdf")
robot.initViewer(loadModel=True)
gui = robot.viewer.gui
gui.addSphere("world/sphere", 0.05, [1.0, 0.2, 0.2, 1.0])

# A configuration that touches [.5, .1, .2]
q0 = np.array([-0.018356143091380325, -0.9446860506922987, 1.4794477825519143, 0.6726634246775824, 0.0, 0.0])

for i in range(200):
    t = 0.02 * i
    q = q0 + 0.5 * np.sin(t) * np.array([1.0, 0.5, -0.5, 1.0, -1.0, 2.0])
    ball = robot.placement(q, 6).translation
    gui.applyConfiguration("world/sphere", tuple(ball) + (1.0, 0.0, 0.0, 0.0))
    robot.display(q)
    sleep(0.005)

where = np.array(gui.getNodeGlobalTransform("world/sphere")[:3])
print("ball", where)
print("gap", npl.norm(where - robot.placement(q, 6).translation))
assert npl.norm(where - robot.placement(q, 6).translation) < 1e-12
gui.captureFrame("python-pinocchio", "place.png")
