"""A humanoid squats: inverse kinematics of both feet and the centre of mass."""

import numpy as np
import pinocchio as pin

model = pin.buildSampleModelHumanoid(True)
data = model.createData()
q = pin.neutral(model)
rng = np.random.RandomState(3)
q = pin.integrate(model, q, rng.uniform(-0.2, 0.2, model.nv))
feet = [model.getFrameId(n) for n in ("rleg_effector_body", "lleg_effector_body")]
pin.framesForwardKinematics(model, data, q)
pin.centerOfMass(model, data, q)
feet_ref = [data.oMf[f].copy() for f in feet]
com_ref = data.com[0].copy() - np.array([0, 0, 0.1])
for it in range(60):  # noqa: B007
    pin.computeJointJacobians(model, data, q)
    pin.updateFramePlacements(model, data)
    e, J = [], []
    for f, ref in zip(feet, feet_ref, strict=False):
        M = data.oMf[f].actInv(ref)
        e.append(pin.log6(M).vector)
        J.append(pin.Jlog6(M.inverse()) @ pin.getFrameJacobian(model, data, f, pin.LOCAL))
    J.append(pin.jacobianCenterOfMass(model, data, q))
    e.append(com_ref - data.com[0])
    J, e = np.vstack(J), np.concatenate(e)
    if np.linalg.norm(e) < 1e-8:
        break
    dq = J.T @ np.linalg.solve(J @ J.T + 1e-6 * np.eye(len(J)), e)
    q = pin.integrate(model, q, dq)
print(it, np.linalg.norm(e) < 1e-6, np.round(q, 5).tolist())
print(np.round(pin.computeGeneralizedGravity(model, data, q), 4).tolist())
