"""A cart with poles, built joint by joint, copied and pickled."""

import copy
import pickle

import numpy as np
import pinocchio as pin

m = pin.Model()
m.name = "cart"
parent = 0
j = m.addJoint(
    0,
    pin.JointModelPX(),
    pin.SE3.Identity(),
    "cart",
    np.array([10.0]),
    np.array([5.0]),
    np.array([-1.0]),
    np.array([1.0]),
)
m.appendBodyToJoint(j, pin.Inertia.FromBox(1.0, 0.2, 0.1, 0.1), pin.SE3.Identity())
m.addBodyFrame("cart_body", j, pin.SE3.Identity(), 0)
for k in range(3):
    j = m.addJoint(
        j,
        pin.JointModelRUBY() if k == 1 else pin.JointModelRY(),
        pin.SE3(np.eye(3), np.array([0, 0, 0.5 * (k > 0)])),
        f"pole{k}",
    )
    m.appendBodyToJoint(
        j, pin.Inertia.FromCylinder(0.3, 0.02, 0.5), pin.SE3(np.eye(3), np.array([0, 0, 0.25]))
    )
    m.addJointFrame(j, -1)
tip = m.addFrame(
    pin.Frame(
        "tip", j, m.getFrameId("pole2"), pin.SE3(np.eye(3), np.array([0, 0, 0.5])), pin.FrameType.OP_FRAME
    )
)
print(m, m.nq, m.nv, tip, [str(f) for f in m.frames][-1], m.upperPositionLimit.tolist()[:1])
d = pin.Data(m)
q = pin.neutral(m)
v = np.array([0.1, 0.2, 0.3, -0.4])
for _ in range(200):
    a = pin.aba(m, d, q, v, np.zeros(4))
    v = v + 0.002 * a
    q = pin.integrate(m, q, 0.002 * v)
print(np.round(q, 6), np.round(v, 6), round(pin.computeMechanicalEnergy(m, d, q, v), 6))
m2 = copy.deepcopy(m)
m2.inertias[1].mass = 5
print(
    m2 == m,
    m.inertias[1].mass,
    pickle.loads(pickle.dumps(m)) == m,
    m.existBodyName("cart_body"),
    m.getFrameId("nope") == m.nframes,
)
app = pin.appendModel(m, pin.buildSampleModelManipulator(), tip, pin.SE3.Identity())
print(app.nq, [f.name for f in app.frames][-4:], app.frames[-1])
print(
    pin.SE3.Random().isIdentity(),
    m.joints[2],
    m.joints[2].idx_q,
    m.joints[3].nq,
    m.inertias[2],
    m.gravity,
    list(m.nqs),
    d.oMi[2].homogeneous.shape,
)
