"""Inverse dynamics of a legged robot by tasks, with contacts as equality constraints (a KKT system each step)."""

import numpy as np
import pinocchio as pin

np.set_printoptions(precision=4, suppress=True)
rmodel = pin.buildSampleModelHumanoid()
rdata = rmodel.createData()
rmodel.gravity.linear = np.array([0.0, 0.0, -9.81])
q = pin.neutral(rmodel)
q[2] = 0.9
v = pin.utils.zero(rmodel.nv)
feet = [i for i, name in enumerate(rmodel.names) if name.endswith("leg6_joint")] or [rmodel.njoints - 1]
print(rmodel.nq, rmodel.nv, [rmodel.names[i] for i in feet])
hand = rmodel.getJointId(next(name for name in rmodel.names if "arm" in name))
S = np.hstack([np.zeros((rmodel.nv - 6, 6)), np.eye(rmodel.nv - 6)])


class FootContact:
    def __init__(self, joint, kp=100.0):
        self.joint, self.kp, self.kd = joint, kp, 2 * np.sqrt(kp)
        self.reference = None

    def rows(self, data):
        oMi = data.oMi[self.joint]
        if self.reference is None:
            self.reference = oMi.copy()
        J = pin.getJointJacobian(rmodel, data, self.joint, pin.ReferenceFrame.LOCAL)
        drift = pin.getClassicalAcceleration(rmodel, data, self.joint, pin.ReferenceFrame.LOCAL)
        error = (
            pin.log6(oMi.actInv(self.reference)) * self.kp
            - pin.getVelocity(rmodel, data, self.joint) * self.kd
        )
        return J, error.vector - np.r_[drift.linear, drift.angular]


contacts = [FootContact(j) for j in feet]
dt, log = 2e-3, []
for _step in range(8):
    pin.forwardKinematics(rmodel, rdata, q, v, np.zeros(rmodel.nv))
    pin.computeJointJacobians(rmodel, rdata, q)
    pin.centerOfMass(rmodel, rdata, q, v)
    M = pin.crba(rmodel, rdata, q)
    M[np.tril_indices(rmodel.nv, -1)] = M.transpose()[np.tril_indices(rmodel.nv, -1)]
    h = pin.nonLinearEffects(rmodel, rdata, q, v)
    J, wanted = map(np.concatenate, zip(*[c.rows(rdata) for c in contacts], strict=False))
    Jcom = pin.jacobianCenterOfMass(rmodel, rdata, q)
    acc_com = 20 * (np.array([0.0, 0.0, 0.85]) - rdata.com[0]) - 9 * rdata.vcom[0]
    A = np.vstack([J, Jcom])
    a = np.linalg.lstsq(A, np.concatenate([wanted, acc_com]), rcond=1e-10)[0]
    full = M @ a + h
    forces = np.linalg.lstsq(J.T[:6], full[:6], rcond=1e-10)[0]
    tau = S @ (full - J.T @ forces)
    v = v + a * dt
    q = pin.integrate(rmodel, q, v * dt)
    log.append([rdata.com[0][2], np.linalg.norm(forces), np.linalg.norm(tau)])
print(np.array(log))
fext = pin.StdVec_Force()
for _i in range(rmodel.njoints):
    fext.append(pin.Force.Zero())
for contact, f in zip(contacts, forces.reshape(-1, 6), strict=False):
    fext[contact.joint] = pin.Force(f)
tau_id = pin.rnea(rmodel, rdata, q, v, a, fext)
print(tau_id[:6], rdata.f[1], rdata.tau[6:9])
print(rdata.oMi[hand].act(np.array([0.0, 0.0, 0.1])), rdata.hg, pin.computeKineticEnergy(rmodel, rdata, q, v))
pin.ccrba(rmodel, rdata, q, v)
print(rdata.hg.linear / rdata.mass[0], rdata.vcom[0], rdata.Ig.mass)
