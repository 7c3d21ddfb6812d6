"""A quadruped-like tree falls, meets the ground, and stands: impulses, contact forces with Baumgarte gains."""

import numpy as np
import pinocchio as pin

np.set_printoptions(precision=5, suppress=True)
model = pin.Model()
model.name = "walker"
base = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "base")
model.appendBodyToJoint(base, pin.Inertia.FromBox(4.0, 0.4, 0.2, 0.1), pin.SE3.Identity())
model.addBodyFrame("trunk", base, pin.SE3.Identity(), 0)
for k, (x, y) in enumerate([(0.2, 0.1), (0.2, -0.1), (-0.2, 0.1), (-0.2, -0.1)]):
    hip = model.addJoint(base, pin.JointModelRY(), pin.SE3(np.eye(3), np.array([x, y, 0.0])), f"hip{k}")
    model.appendBodyToJoint(
        hip, pin.Inertia.FromCylinder(0.3, 0.02, 0.2), pin.SE3(np.eye(3), np.array([0, 0, -0.1]))
    )
    knee = model.addJoint(hip, pin.JointModelRY(), pin.SE3(np.eye(3), np.array([0, 0, -0.2])), f"knee{k}")
    model.appendBodyToJoint(
        knee, pin.Inertia.FromSphere(0.2, 0.03), pin.SE3(np.eye(3), np.array([0, 0, -0.1]))
    )
    model.addFrame(
        pin.Frame(f"foot{k}", knee, pin.SE3(np.eye(3), np.array([0, 0, -0.2])), pin.FrameType.OP_FRAME)
    )
data = model.createData()
print(model.nq, model.nv, model.nframes, round(pin.computeTotalMass(model), 4))
feet = [model.getFrameId(f"foot{k}") for k in range(4)]
q = pin.neutral(model)
q[7:] = np.array([0.5, -1.0] * 4)
pin.framesForwardKinematics(model, data, q)
q[2] -= data.oMf[feet[0]].translation[2]
contacts = []
for f in feet:
    frame = model.frames[f]
    c = pin.RigidConstraintModel(
        pin.ContactType.CONTACT_3D, model, frame.parentJoint, frame.placement, pin.LOCAL_WORLD_ALIGNED
    )
    c.m_baumgarte_parameters.Kd = 20.0
    contacts.append(c)
datas = [c.createData() for c in contacts]
settings = pin.ProximalSettings(1e-12, 1e-8, 10)
v = np.zeros(model.nv)
v[2] = -0.5
pin.initConstraintDynamics(model, data, contacts, datas)
v = pin.impulseDynamics(model, data, q, v, contacts, datas, 0.0, settings)
print("after the impact", v[:6])
kp, kd, rest = 60.0, 2.0, q.copy()
for step in range(60):
    tau = np.zeros(model.nv)
    tau[6:] = -kp * (q[7:] - rest[7:]) - kd * v[6:]
    a = pin.constraintDynamics(model, data, q, v, tau, contacts, datas, settings)
    v = v + 1e-3 * a
    q = pin.integrate(model, q, 1e-3 * v)
    if step % 20 == 19:
        print(step, q[:3], sum(d.contact_force.linear[2] for d in datas).round(4))
pin.framesForwardKinematics(model, data, q)
print(np.array([data.oMf[f].translation[2] for f in feet]))
J = pin.getConstraintsJacobian(model, data, contacts, datas)
print(J.shape, np.linalg.matrix_rank(J))
pin.computeAllTerms(model, data, q, v)
print(
    round(
        float(
            np.linalg.norm(
                data.M @ a + data.nle - tau - J.T @ np.concatenate([d.contact_force.linear for d in datas])
            )
        ),
        1,
    )
)
