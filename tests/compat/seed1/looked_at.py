"""The second exercise, step by step: a line on standard input moves the arm with its ball, the end of it ends it."""

import sys

import numpy as np
from example_robot_data import load

robot = load("ur5")
robot.initViewer(loadModel=True)
gui = robot.viewer.gui
gui.addSphere("world/sphere", 0.05, [1.0, 0.2, 0.2, 1.0])
wrist = robot.getViewerNodeName(robot.visual_model.geometryObjects[6], 0)
print(robot.viewer.viewer.url, flush=True)
for i, _ in enumerate(sys.stdin):
    q = np.array([0.3 * i, -1.2, 1.71, -0.51, -0.375, 0.0])
    ball = robot.placement(q, 6).translation
    gui.applyConfiguration("world/sphere", [*ball, 0, 0, 0, 1])
    robot.display(q)
    print(*ball, *gui.getNodeGlobalTransform(wrist)[:3], flush=True)
