"""A program of pink's kind: an arm follows a moving target in MeshCat, without a screen."""

import meshcat.geometry
import numpy as np
import pink
import pinocchio as pin
from loop_rate_limiters import RateLimiter
from pink.tasks import FrameTask, PostureTask
from pink.visualization import start_meshcat_visualizer

model = pin.buildSampleModelManipulator()
shapes = pin.buildSampleGeometryModelManipulator(model)
model.lowerPositionLimit[:], model.upperPositionLimit[:] = -3.0, 3.0
robot = pin.RobotWrapper(model, shapes, shapes)
viz = start_meshcat_visualizer(robot, open=False)
viewer = viz.viewer
viewer["target"].set_object(
    meshcat.geometry.Sphere(0.05), meshcat.geometry.MeshLambertMaterial(color=0xFF0000, opacity=0.5)
)
viewer["axes"].set_object(meshcat.geometry.triad(0.2))
configuration = pink.Configuration(robot.model, robot.data, np.full(6, 0.3))
hand = FrameTask("effector_body", position_cost=1.0, orientation_cost=0.1)
posture = PostureTask(cost=1e-3)
posture.set_target_from_configuration(configuration)
start = configuration.get_transform_frame_to_world("effector_body")
rate = RateLimiter(frequency=100.0)
t = 0.0
while t < 1.0:
    goal = start * pin.SE3(np.eye(3), np.array([0.1 * np.sin(t), 0.0, -0.2 * t]))
    hand.set_target(goal)
    viewer["target"].set_transform(goal.homogeneous)
    viewer["axes"].set_transform(configuration.get_transform_frame_to_world("effector_body").np)
    configuration.integrate_inplace(
        pink.solve_ik(configuration, [hand, posture], rate.dt, solver="daqp"), rate.dt
    )
    viz.display(configuration.q)
    rate.sleep()
    t += rate.dt
assert hand.compute_error(configuration).max() < 0.1
viewer["target"].delete()
