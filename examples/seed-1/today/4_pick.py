"""Exercise: the end effector touches a sphere, then takes a box by a face, in today's spelling.

Run it by `ulna run`. You should see the tool at the red sphere, and then aligned with the box.
"""

import numpy as np
import pinocchio as pin
from example_robot_data import load

robot = load("ur5")
robot.initViewer(loadModel=True)
gui = robot.viewer.gui
tool = robot.index("wrist_3_joint")

target = np.array([0.5, 0.1, 0.2])
gui.addSphere("world/sphere", 0.1, [1.0, 0.2, 0.2, 1.0])
gui.applyConfiguration("world/sphere", [*target, 0.0, 0.0, 0.0, 1.0])
gui.refresh()

q = np.array([-0.375, -1.2, 1.71, -0.51, -0.375, 0.0])
for _ in range(20):  # Newton's steps: the translation is chosen, the rotation is free
    M = robot.placement(q, tool)
    J = robot.computeJointJacobian(q, tool)[:3]
    q = pin.integrate(robot.model, q, np.linalg.pinv(J) @ M.actInv(target))
robot.display(q)
print("reached", robot.placement(q, tool).translation)
assert np.linalg.norm(robot.placement(q, tool).translation - target) < 1e-9

gui.deleteNode("world/sphere", True)
gui.addBox("world/box", 0.1, 0.2, 0.1, [0.2, 0.3, 0.9, 1.0])
oMbox = pin.SE3(pin.rpy.rotate("x", -np.pi / 2), np.array([0.4, 0.2, 0.3]))
gui.applyConfiguration("world/box", pin.SE3ToXYZQUATtuple(oMbox))
goal = oMbox * pin.SE3(pin.rpy.rotate("y", np.pi / 2), np.array([-0.05, 0.0, 0.0]))
for _ in range(200):
    gap = pin.log6(robot.placement(q, tool).actInv(goal)).vector
    change = np.linalg.pinv(robot.computeJointJacobian(q, tool), 1e-3) @ gap
    q = pin.integrate(robot.model, q, change * min(1.0, 0.2 / max(np.linalg.norm(change), 1e-12)))
robot.display(q)
print("aligned", robot.placement(q, tool))
assert np.linalg.norm(pin.log6(robot.placement(q, tool).actInv(goal)).vector) < 1e-9
gui.captureFrame("python-pinocchio", "pick.png")
