"""Random trees of all kinds of joints: integration, derivatives against differences, identities of dynamics."""

import numpy as np
import pinocchio as pin

rng = np.random.default_rng(1)
kinds = [
    pin.JointModelRX(),
    pin.JointModelPZ(),
    pin.JointModelSpherical(),
    pin.JointModelRevoluteUnaligned(np.array([0.6, 0.0, 0.8])),
    pin.JointModelFreeFlyer(),
    pin.JointModelTranslation(),
    pin.JointModelRUBX(),
    pin.JointModelPlanar(),
    pin.JointModelSphericalZYX(),
    pin.JointModelPrismaticUnaligned(np.array([0.0, 0.6, 0.8])),
    pin.JointModelHX(0.2),
    pin.JointModelUniversal(np.array([1.0, 0, 0]), np.array([0, 0, 1.0])),
]


def some_pose():
    return pin.exp6(pin.Motion(rng.uniform(-0.7, 0.7, 6)))


def some_inertia():
    mass, lever, axes = rng.uniform(1, 3), rng.uniform(-0.2, 0.2, 3), rng.uniform(0.1, 0.4, 3)
    return pin.Inertia.FromEllipsoid(mass, *axes).se3Action(pin.SE3(np.eye(3), lever))


def tree(count):
    model = pin.Model()
    for k in range(count):
        parent = int(rng.integers(0, model.njoints))
        joint = kinds[int(rng.integers(len(kinds)))]
        new = model.addJoint(parent, joint, some_pose(), f"j{k}")
        model.appendBodyToJoint(new, some_inertia(), some_pose())
        model.addBodyFrame(f"b{k}", new, some_pose(), 0)
    return model


def configuration(model):
    return pin.integrate(model, pin.neutral(model), rng.uniform(-1, 1, model.nv))


for n in (2, 4, 6):
    model = tree(n)
    data = model.createData()
    q, v, a = configuration(model), rng.uniform(-1, 1, model.nv), rng.uniform(-1, 1, model.nv)
    q2 = configuration(model)
    print(model.nq, model.nv, [j.shortname() for j in model.joints][1:])
    tau = pin.rnea(model, data, q, v, a)
    print(np.round(tau, 4))
    print(np.allclose(pin.aba(model, data, q, v, tau), a))
    pin.computeRNEADerivatives(model, data, q, v, a)
    dq, eps = np.zeros(model.nv), 1e-6
    differences = np.zeros((model.nv, model.nv))
    for k in range(model.nv):
        dq[k] = eps
        other = model.createData()
        differences[:, k] = (pin.rnea(model, other, pin.integrate(model, q, dq), v, a) - tau) / eps
        dq[k] = 0.0
    print(np.allclose(differences, data.dtau_dq, atol=1e-3), np.round(np.linalg.norm(data.dtau_dv), 4))
    jq, jv = pin.dIntegrate(model, q, v)
    print(
        np.round(np.trace(jq), 4),
        np.round(np.trace(jv), 4),
        np.round(np.trace(pin.dDifference(model, q, q2, pin.ARG1)), 4),
    )
    print(
        round(pin.distance(model, q, q2), 5),
        pin.isSameConfiguration(model, q, q, 1e-9),
        np.round(pin.interpolate(model, q, q2, 0.3), 4),
    )
    C = pin.computeCoriolisMatrix(model, data, q, v)
    print(np.allclose(C @ v + pin.computeGeneralizedGravity(model, data, q), pin.nle(model, data, q, v)))
    Y = pin.computeJointTorqueRegressor(model, data, q, v, a)
    phi = np.concatenate([I.toDynamicParameters() for I in model.inertias[1:]])
    print(Y.shape, np.allclose(Y @ phi, tau))
    pin.computeCentroidalMomentumTimeVariation(model, data, q, v, a)
    print(data.hg, data.dhg)
    J = pin.computeJointJacobian(model, data, q, model.njoints - 1)
    pin.forwardKinematics(model, data, q, v)
    print(
        np.allclose(J @ v, data.v[model.njoints - 1].vector),
        np.round(pin.computeKineticEnergy(model, data), 5),
    )
    print(
        np.round(pin.squaredDistance(model, q, q2), 4), [round(float(x), 4) for x in data.oMi[-1].translation]
    )
