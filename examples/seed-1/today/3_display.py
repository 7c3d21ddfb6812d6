"""The robot in the viewer, one of its pieces moved by hand, and a sphere beside it, in today's spelling.

Run it by `ulna run`. You should see the arm in your browser, its first wrist away from it, and a red sphere.
"""

from time import sleep

import pinocchio as pin
from example_robot_data import load
from pinocchio.visualize import GepettoVisualizer

robot = load("ur5")
viz = GepettoVisualizer(robot.model, robot.collision_model, robot.visual_model)
robot.setVisualizer(viz, init=False)
robot.initViewer(loadModel=True)

piece = robot.visual_model.geometryObjects[4]
name = robot.getViewerNodeName(piece, pin.GeometryType.VISUAL)
print(piece.name, name)

gui = robot.viewer.gui
gui.applyConfiguration(name, [1, 1, 1, 0, 0, 0, 1])  # x, y, z, and a quaternion xyzw
gui.refresh()

gui.addSphere("world/sphere", 0.1, [1.0, 0.2, 0.2, 1.0])
sleep(0.5)
robot.display(robot.q0)

robot.displayCollisions(True)
robot.displayVisuals(False)
robot.displayCollisions(False)
robot.displayVisuals(True)
print(gui.getNodeList())
gui.captureFrame("python-pinocchio", "display.png")
