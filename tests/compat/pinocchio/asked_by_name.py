"""What Ulna's package and Pinocchio are both asked with arguments by name."""

import json
import sys

import numpy as np
import pinocchio as pin
from asked import answers

BY_NAME = """
! I = pin.SE3.Identity(); m = pin.Model(); _ = m.addJoint(parent_id=0, joint_model=pin.JointModelRX(), joint_placement=I, joint_name="a")
! _ = m.addJoint(1, pin.JointModelRY(), M, "b", max_effort=one * 3, max_velocity=one * 2, min_config=-one, max_config=one)
! Y = pin.Inertia(mass=1.0, lever=w, inertia=np.eye(3)); m.appendBodyToJoint(joint_id=1, body_inertia=Y, body_placement=I)
! m.appendBodyToJoint(2, Y, M); _ = m.addFrame(pin.Frame(name="f", parent_joint=2, placement=M, type=pin.FrameType.OP_FRAME))
! _ = m.addBodyFrame(body_name="h", parentJoint=1, body_placement=I, previous_frame=0), m.addJointFrame(joint_id=1, frame_id=0)
finite(m.upperEffortLimit); finite(m.lowerEffortLimit); finite(m.upperVelocityLimit); finite(m.lowerPositionLimit); [f.parentFrame for f in m.frames]
pin.SE3(rotation=np.eye(3), translation=w); pin.SE3(quat=pin.Quaternion.Identity(), translation=w); pin.Motion(linear=w, angular=2 * w)
pin.Force(linear=w, angular=2 * w); pin.Inertia.FromBox(mass=1.0, length_x=1.0, length_y=2.0, length_z=3.0); m.getFrameId(name="f")
! d = m.createData(); q, v, a = np.arange(6.0).reshape(3, 2); pin.forwardKinematics(model=m, data=d, q=q, v=v, a=a)
pin.getFrameVelocity(model=m, data=d, frame_id=1, reference_frame=pin.LOCAL); pin.getFrameVelocity(m, d, joint_id=2, placement=M, reference_frame=pin.WORLD)
pin.getFrameAcceleration(m, d, 1, reference_frame=pin.WORLD); pin.getFrameClassicalAcceleration(m, d, frame_id=1, reference_frame=pin.LOCAL)
pin.rnea(model=m, data=d, q=q, v=v, a=a); pin.aba(m, d, q=q, v=v, tau=a); pin.centerOfMass(model=m, data=d, q=q, compute_subtree_coms=True)
pin.difference(model=m, q1=q, q2=v); pin.interpolate(model=m, q1=q, q2=v, alpha=0.3); pin.dDifference(m, q1=q, q2=v, argument_position=pin.ARG1)
pin.distance(m, q1=q, q2=v); pin.randomConfiguration(m, lower_bound=q, upper_bound=q); pin.exp6(motion=pin.Motion(w, w)); pin.skew(u=w)
pin.rpy.rpyToMatrix(roll=0.1, pitch=0.2, yaw=0.3); pin.rpy.rpyToMatrix(rpy=w); pin.JointModelRevoluteUnaligned(axis=np.array([0.6, 0.8, 0.0])).axis
pin.JointModelRevoluteUnaligned(x=0.0, y=0.0, z=1.0).axis; pin.JointModelUniversal(axis1=pin.XAxis, axis2=pin.YAxis).nq
! c = pin.JointModelComposite(); _ = c.addJoint(joint_model=pin.JointModelRX(), joint_placement=I, name="x")
c.nq; str(pin.CollisionPair(index1=1, index2=2)); pin.transformJointIntoMimic(m, index_mimicked=1, index_mimicking=2, scaling=1.0, offset=0.0).nq
"""


def finite(limits):
    return np.clip(limits, -1e9, 1e9)


if __name__ == "__main__":
    names = {"w": np.array([0.1, 0.2, 0.3]), "one": np.ones(1), "finite": finite}
    names["M"] = pin.XYZQUATToSE3(np.array([0.1, 0.2, 0.3, 0.0, 0.0, np.sin(0.2), np.cos(0.2)]))
    with open(sys.argv[1], "w", encoding="utf-8") as out:
        out.write(json.dumps({"file": pin.__file__, "answers": answers(BY_NAME, names)}))
