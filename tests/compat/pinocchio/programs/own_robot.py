"""Subclasses of RobotWrapper: an arm with a cache of its state, and a wrapper with tasks; URDF from a string."""

import numpy as np
import pinocchio as pin
from pinocchio.robot_wrapper import RobotWrapper
from pinocchio.utils import eye, npToTuple, rotate, zero

np.set_printoptions(precision=6, suppress=True)
URDF = """<robot name="two"><link name="base"><inertial><mass value="2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="upper"><inertial><origin xyz="0 0 0.25"/><mass value="1.5"/><inertia ixx="0.1" iyy="0.1" izz="0.02" ixy="0" ixz="0.01" iyz="0"/></inertial></link>
<link name="lower"><inertial><origin xyz="0 0 0.2"/><mass value="1"/><inertia ixx="0.05" iyy="0.05" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="tip"/>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="30" velocity="4"/><dynamics damping="0.1" friction="0.05"/></joint>
<joint name="elbow" type="continuous"><parent link="upper"/><child link="lower"/><origin xyz="0 0 0.5" rpy="0 0.1 0"/><axis xyz="0 1 0"/><limit effort="20" velocity="5"/></joint>
<joint name="end" type="fixed"><parent link="lower"/><child link="tip"/><origin xyz="0 0 0.4"/></joint></robot>"""


class Arm(RobotWrapper):
    def __init__(self, urdf=URDF, root=None):
        model = pin.buildModelFromXML(urdf) if root is None else pin.buildModelFromXML(urdf, root)
        super().__init__(model, pin.GeometryModel(), pin.GeometryModel())
        self.tip = self.model.getFrameId("tip")
        self.cached = None

    def update(self, q, v=None):
        v = zero(self.nv) if v is None else v
        pin.computeAllTerms(self.model, self.data, q, v)
        pin.updateFramePlacements(self.model, self.data)
        self.cached = q.copy(), v.copy()
        return self

    @property
    def tip_pose(self):
        return self.data.oMf[self.tip]

    def gravity(self, q):
        return super().gravity(q) * 1.0


arm = Arm()
print(arm.nq, arm.nv, arm.q0, arm.model.names.tolist(), isinstance(arm, RobotWrapper))
q, v, a = pin.neutral(arm.model), np.array([0.3, -0.2]), np.array([1.0, 0.5])
q[0] = 0.4
print(arm.mass(q), arm.nle(q, v), arm.gravity(q), arm.com(q), arm.com(q, v), arm.Jcom(q))
print(arm.placement(q, 2), arm.velocity(q, v, 2), arm.acceleration(q, v, a, 2), arm.index("elbow"))
print(
    arm.framePlacement(q, arm.tip), arm.frameVelocity(q, v, arm.tip), arm.frameAcceleration(q, v, a, arm.tip)
)
print(
    arm.frameClassicalAcceleration(q, v, a, arm.tip),
    arm.getFrameJacobian(arm.tip, pin.LOCAL),
    arm.computeFrameJacobian(q, arm.tip),
)
print(
    arm.computeJointJacobian(q, 2), arm.centroidal(q, v), arm.centroidalMomentum(q, v), arm.centroidalMap(q)
)
arm.forwardKinematics(q, v, a)
arm.framesForwardKinematics(q)
print(arm.update(q, v).tip_pose, arm.cached)
flying = Arm(root=pin.JointModelFreeFlyer())
print(flying.nq, flying.nv, flying.q0, flying.model.joints[1].shortname())
reduced = flying.buildReducedRobot([flying.model.getJointId("elbow")], flying.q0)
print(
    reduced.nq,
    reduced.model.names.tolist(),
    type(reduced).__name__,
    reduced.buildReducedRobot(["shoulder"]).nq,
)
print(
    pin.SE3ToXYZQUAT(arm.tip_pose),
    pin.XYZQUATToSE3([0.1, 0.2, 0.3, 0, 0, 0, 1]),
    npToTuple(eye(2)),
    rotate("x", 0.3),
)
arm.model.effortLimit *= 0.5
print(arm.model.effortLimit, arm.model.damping, arm.model.friction, arm.model.upperPositionLimit[0])
copy = RobotWrapper(arm.model.copy(), arm.collision_model, arm.visual_model)
copy.rebuildData()
copy.q0 = q
copy.v0 = v
print(copy.q0, len(copy.data.oMf), copy.model == arm.model)
