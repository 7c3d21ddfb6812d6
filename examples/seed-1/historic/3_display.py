"""The robot in the viewer, one of its pieces moved by hand, and a sphere beside it, in historic spelling.

Run it by `ulna run`. You should see the arm in your browser, its first wrist away from it, and a red sphere.
Historic scripts put the w of quaternions first; the first lines here say so.
"""

# ruff: noqa: F403, F405 (spelled as the tutorial did)

from time import sleep

import pinocchio as pin
from example_robot_data import getModelPath
from gepetto.corbaserver import quaternion_order
from pinocchio.robot_wrapper import RobotWrapper
from pinocchio.utils import *

quaternion_order("wxyz")
robot = RobotWrapper.BuildFromURDF(getModelPath("ur_description") + "/ur_description/urdf/ur5_gripper.urdf")

robot.initViewer(loadModel=True)

visualObj = robot.visual_model.geometryObjects[4]  # 3D object representing the robot forarm
visualName = visualObj.name  # Name associated to this object
visualRef = robot.getViewerNodeName(visualObj, pin.GeometryType.VISUAL)  # Viewer reference (string)
print(visualName, visualRef)

q1 = (1, 1, 1, 1, 0, 0, 0)  # x, y, z, quaternion
robot.viewer.gui.applyConfiguration(visualRef, q1)
robot.viewer.gui.refresh()  # Refresh the window.

rgbt = [1.0, 0.2, 0.2, 1.0]  # red, green, blue, transparency
robot.viewer.gui.addSphere("world/sphere", 0.1, rgbt)  # .1 is the radius
sleep(0.5)
robot.display(zero(robot.nq))  # the piece is back in its place

print(robot.viewer.gui.getNodeList())
robot.viewer.gui.captureFrame("python-pinocchio", "display.png")
