"""A four-bar linkage closed by a constraint, a hopping mass with impacts, and forward dynamics by hand."""

import numpy as np
import pinocchio as pin

np.set_printoptions(precision=5, suppress=True)
model = pin.Model()
rod = pin.Inertia.FromBox(1.0, 0.05, 0.05, 1.0)
half = pin.SE3(np.eye(3), np.array([0.0, 0.0, 0.5]))
full = pin.SE3(np.eye(3), np.array([0.0, 0.0, 1.0]))
ids = []
for parent, name, place in (
    (0, "left", pin.SE3.Identity()),
    (1, "top", full),
    (0, "right", pin.SE3(np.eye(3), np.array([1.0, 0.0, 0.0]))),
):
    ids.append(model.addJoint(parent, pin.JointModelRY(), place, name))
    model.appendBodyToJoint(ids[-1], rod, half)
closing = pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, model, ids[1], full, ids[2], full, pin.LOCAL)
closing.name = "pin joint"
models, datas = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
models.append(closing)
datas.append(closing.createData())
data = model.createData()
q = np.array([0.1, np.pi / 2 - 0.05, 0.1])

# close the loop by Newton steps
for _step in range(30):
    pin.computeJointJacobians(model, data, q)
    closing.calc(model, data, datas[0])
    c1 = data.oMi[ids[1]] * closing.joint1_placement
    c2 = data.oMi[ids[2]] * closing.joint2_placement
    error = c1.rotation.T @ (c2.translation - c1.translation)
    J = pin.getConstraintJacobian(model, data, closing, datas[0])
    if np.linalg.norm(error) < 1e-12:
        break
    q = pin.integrate(model, q, np.linalg.lstsq(J, error, rcond=1e-8)[0])
print(np.round(error, 6), np.round(J, 4))
v = np.zeros(model.nv)
pin.initConstraintDynamics(model, data, models, datas)
settings = pin.ProximalSettings(1e-12, 1e-10, 20)
for _step in range(10):
    a = pin.constraintDynamics(model, data, q, v, np.array([0.0, 0.5, 0.0]), models, datas, settings)
    v = v + 1e-3 * a
    q = pin.integrate(model, q, 1e-3 * v)
print(q, v, datas[0].contact_force.linear, settings.iter > 0)
pin.computeConstraintDynamicsDerivatives(model, data, models, datas, settings)
print(data.ddq_dv, data.ddq_dtau, data.dlambda_dq.shape)
K = pin.computeKKTContactDynamicMatrixInverse(
    model, data, q, pin.getConstraintJacobian(model, data, closing, datas[0]), 1e-8
)
print(K.shape)
pin.crba(model, data, q)
chol = pin.ConstraintCholeskyDecomposition(model, data, models, datas)
chol.compute(model, data, models, datas, 1e-6)
print(
    chol.size(),
    chol.constraintDim(),
    np.round(chol.matrix()[0, 0], 3),
    chol.getInverseOperationalSpaceInertiaMatrix().shape,
)

# a contact that begins: impulse, then forces
legs = pin.buildSampleModelHumanoid()
ldata = legs.createData()
lq, lv = pin.neutral(legs), np.linspace(-0.1, 0.1, legs.nv)
foot = max(i for i, name in enumerate(legs.names) if "leg" in name)
touch = pin.RigidConstraintModel(pin.ContactType.CONTACT_6D, legs, foot, pin.LOCAL_WORLD_ALIGNED)
contacts, contact_datas = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
contacts.append(touch)
contact_datas.append(touch.createData())
pin.initConstraintDynamics(legs, ldata, contacts, contact_datas)
after = pin.impulseDynamics(
    legs, ldata, lq, lv, contacts, contact_datas, 0.0, pin.ProximalSettings(1e-10, 1e-10, 10)
)
pin.forwardKinematics(legs, ldata, lq, after)
print(np.linalg.norm(pin.getVelocity(legs, ldata, foot).vector) < 1e-5, np.linalg.norm(after))
acc = pin.constraintDynamics(
    legs, ldata, lq, after, np.zeros(legs.nv), contacts, contact_datas, pin.ProximalSettings(1e-10, 1e-10, 10)
)
print(np.linalg.norm(acc), contact_datas[0].contact_force)
J = pin.computeJointJacobian(legs, ldata, lq, foot)
print(
    np.linalg.norm(pin.forwardDynamics(legs, ldata, lq, after, np.zeros(legs.nv), J, np.zeros(6), 1e-8)),
    np.linalg.norm(ldata.lambda_c),
)
