"""Exercise: the arm moves, and ball and box stick to its end effector, in today's spelling.

Run it by `ulna run`. You should see both travel with the tool, the box turning with it.
"""

import numpy as np
import pinocchio as pin
from example_robot_data import load

robot = load("ur5")
robot.initViewer(loadModel=True)
gui = robot.viewer.gui
tool = robot.index("wrist_3_joint")
gui.addSphere("world/ball", 0.05, [1.0, 0.2, 0.2, 1.0])
gui.addBox("world/box", 0.1, 0.2, 0.1, [0.2, 0.3, 0.9, 1.0])

q0 = np.array([-0.018356143091380325, -0.9446860506922987, 1.4794477825519143, 0.6726634246775824, 0.0, 0.0])
oMbox = pin.SE3(np.eye(3), np.array([0.5, 0.3, 0.2]))
toolMbox = robot.placement(q0, tool).actInv(oMbox)  # what stays the same while the tool holds the box


def stick(q: np.ndarray) -> None:
    """Puts ball and box where the tool is."""
    M = robot.placement(q, tool)
    ball = pin.SE3(np.eye(3), M.translation)
    placements = [pin.SE3ToXYZQUATtuple(ball), pin.SE3ToXYZQUATtuple(M * toolMbox)]
    gui.applyConfigurations(["world/ball", "world/box"], placements)


trajectory = [q0 + 0.5 * np.sin(0.02 * i) * np.array([1.0, 0.5, -0.5, 1.0, -1.0, 2.0]) for i in range(200)]
stick(trajectory[0])
robot.viz.play(trajectory, 0.005, callback=lambda i: stick(trajectory[min(i + 1, 199)]))
gui.refresh()

where = np.array(gui.getNodeGlobalTransform("world/ball")[:3])
print("ball", where)
print("gap", np.linalg.norm(where - robot.placement(trajectory[-1], tool).translation))
assert np.linalg.norm(where - robot.placement(trajectory[-1], tool).translation) < 1e-12
gui.captureFrame("python-pinocchio", "place.png")
