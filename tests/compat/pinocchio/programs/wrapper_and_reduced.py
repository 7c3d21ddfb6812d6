"""RobotWrapper, reduced models, appended models, frames, sizes and text."""

import numpy as np
import pinocchio as pin
from pinocchio.robot_wrapper import RobotWrapper

np.set_printoptions(precision=5, suppress=True)
model = pin.buildSampleModelHumanoid()
collision = pin.buildSampleGeometryModelHumanoid(model)
robot = RobotWrapper(model, collision, collision)
print(robot.nq, robot.nv, robot.model.nframes, robot.q0.shape, robot.mass(robot.q0).shape)
rng = np.random.default_rng(3)
q = pin.integrate(model, robot.q0, 0.1 * rng.normal(size=robot.nv))
v, a = rng.normal(size=(2, robot.nv))
print(robot.com(q), robot.com(q, v)[1])
print(robot.placement(q, 5), robot.velocity(q, v, 5), robot.acceleration(q, v, a, 5))
print(robot.nle(q, v)[:4], robot.gravity(q)[:4])
print(robot.Jcom(q)[0, :6])
frame = model.nframes - 1
print(robot.framePlacement(q, frame), robot.frameVelocity(q, v, frame))
print(robot.computeFrameJacobian(q, frame)[0, -6:])
locked = [model.getJointId(name) for name in list(model.names)[8:14]]
small, (geometry,) = pin.buildReducedModel(model, [collision], locked, robot.q0)
print(small.njoints, small.nq, geometry.ngeoms, [str(n) for n in small.names])
print(round(pin.computeTotalMass(small) - pin.computeTotalMass(model), 10))
arm = pin.buildSampleModelManipulator()
both = pin.appendModel(small, arm, small.nframes - 1, pin.SE3(np.eye(3), np.array([0.0, 0.0, 0.4])))
print(both.njoints, both.nq, [str(n) for n in both.names][-6:])
d = both.createData()
print(pin.rnea(both, d, pin.neutral(both), np.zeros(both.nv), np.zeros(both.nv))[-8:])
print(
    model.existFrame("nothing"),
    model.getFrameId("nothing") == model.nframes,
    model.getJointId("nothing") == model.njoints,
)
print(arm)
print(arm.frames[3])
print(arm.joints[2])
