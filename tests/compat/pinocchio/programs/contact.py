"""Forward dynamics of a humanoid on two contacts, and its derivatives."""

import numpy as np
import pinocchio as pin

rng = np.random.RandomState(1)
model = pin.buildSampleModelHumanoid(True)
data = model.createData()
q = pin.integrate(model, pin.neutral(model), rng.uniform(-0.3, 0.3, model.nv))
v = np.zeros(model.nv)
tau = np.zeros(model.nv)
cms, cds = pin.StdVec_RigidConstraintModel() if hasattr(pin, "StdVec_RigidConstraintModel") else [], None
for name in ("rleg_effector_body", "lleg_effector_body"):
    f = model.frames[model.getFrameId(name)]
    c = pin.RigidConstraintModel(pin.ContactType.CONTACT_6D, model, f.parentJoint, f.placement, pin.LOCAL)
    c.setBaumgarteCorrectorParameters(pin.BaumgarteCorrectorParameters(10.0, 6.0))
    cms.append(c)
cds = pin.StdVec_RigidConstraintData() if hasattr(pin, "StdVec_RigidConstraintData") else []
for c in cms:
    cds.append(c.createData())
pin.initConstraintDynamics(model, data, cms, cds)
s = pin.ProximalSettings(1e-10, 1e-10, 10)
for _k in range(20):
    a = pin.constraintDynamics(model, data, q, v, tau, cms, cds, s)
    v = v + 1e-3 * a
    q = pin.integrate(model, q, 1e-3 * v)
print(np.round(a, 4).tolist())
print(np.round(np.concatenate([d.contact_force.vector for d in cds]), 3).tolist(), np.round(q, 6).tolist())
pin.computeConstraintDynamicsDerivatives(model, data, cms, cds, s)
print(np.round(data.ddq_dtau.trace(), 5), data.lambda_c.shape)
