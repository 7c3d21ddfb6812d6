"""What every algorithm leaves in every field of a Data, fresh or used: asked of whichever pinocchio is imported.

`python asked_fields.py out.json file root mimic used`, where `used` says what comes before on a Data: `nothing`,
`everything` at once, or `each` of some calls. The answers of a fresh one are the same before `everything` and `each`: of the
latter the package is not asked for them again.
"""

import json
import sys
import warnings

import numpy as np
import pinocchio as pin

warnings.simplefilter("ignore")
CALLS = """
forwardKinematics(m, d, q)
forwardKinematics(m, d, q, v)
forwardKinematics(m, d, q, v, a)
framesForwardKinematics(m, d, q)
rnea(m, d, q, v, a); updateGlobalPlacements(m, d)
forwardKinematics(m, d, q, v, a); updateFramePlacements(m, d)
forwardKinematics(m, d, q, v, a); updateFramePlacement(m, d, last)
rnea(m, d, q, v, a)
rnea(m, d, q, v, a, fext)
nonLinearEffects(m, d, q, v)
computeGeneralizedGravity(m, d, q)
computeStaticTorque(m, d, q, fext)
aba(m, d, q, v, tau)
aba(m, d, q, v, tau, fext)
aba(m, d, q, v, tau, pin.Convention.WORLD)
aba(m, d, q, v, tau, fext, pin.Convention.WORLD)
crba(m, d, q)
crba(m, d, q, pin.Convention.WORLD)
computeMinverse(m, d, q)
aba(m, d, q, v, tau, pin.Convention.WORLD); computeMinverse(m, d)
computeCoriolisMatrix(m, d, q, v)
computeRNEADerivatives(m, d, q, v, a); getCoriolisMatrix(m, d)
computeAllTerms(m, d, q, v)
computeRNEADerivatives(m, d, q, v, a)
computeRNEADerivatives(m, d, q, v, a, fext)
computeABADerivatives(m, d, q, v, tau)
computeABADerivatives(m, d, q, v, tau, fext)
aba(m, d, q, v, tau, pin.Convention.WORLD); computeABADerivatives(m, d)
aba(m, d, q, v, tau, fext, pin.Convention.WORLD); computeABADerivatives(m, d, fext)
computeGeneralizedGravityDerivatives(m, d, q)
computeStaticTorqueDerivatives(m, d, q, fext)
computeForwardKinematicsDerivatives(m, d, q, v)
computeForwardKinematicsDerivatives(m, d, q, v, a)
computeJointJacobians(m, d, q)
forwardKinematics(m, d, q, v, a); computeJointJacobians(m, d)
computeJointJacobian(m, d, q, end)
computeFrameJacobian(m, d, q, last, pin.LOCAL)
computeFrameJacobian(m, d, q, last, pin.WORLD)
computeJointJacobians(m, d, q); getJointJacobian(m, d, end, pin.LOCAL)
computeJointJacobians(m, d, q); getFrameJacobian(m, d, last, pin.LOCAL)
computeJointJacobiansTimeVariation(m, d, q, v)
computeJointJacobiansTimeVariation(m, d, q, v); getFrameJacobianTimeVariation(m, d, last, pin.LOCAL)
frameJacobianTimeVariation(m, d, q, v, last, pin.LOCAL)
computeJointKinematicHessians(m, d, q)
computeJointJacobians(m, d, q); computeJointKinematicHessians(m, d)
computeJointKinematicHessians(m, d, q); getJointKinematicHessian(m, d, end, pin.LOCAL)
computeJointKinematicHessians(m, d, q); getFrameKinematicHessian(m, d, last, pin.LOCAL)
forwardKinematics(m, d, q, v, a); getVelocity(m, d, end, pin.LOCAL)
forwardKinematics(m, d, q, v, a); getFrameVelocity(m, d, last, pin.LOCAL)
forwardKinematics(m, d, q, v, a); getFrameAcceleration(m, d, last, pin.LOCAL)
computeForwardKinematicsDerivatives(m, d, q, v, a); getFrameVelocityDerivatives(m, d, last, pin.LOCAL)
computeForwardKinematicsDerivatives(m, d, q, v, a); getFrameAccelerationDerivatives(m, d, last, pin.LOCAL)
computeForwardKinematicsDerivatives(m, d, q, v, a); getJointAccelerationDerivatives(m, d, end, pin.LOCAL)
computeForwardKinematicsDerivatives(m, d, q, v, a); getPointVelocityDerivatives(m, d, end, M, pin.LOCAL)
centerOfMass(m, d, q, v); computeForwardKinematicsDerivatives(m, d, q, v, a); getCenterOfMassVelocityDerivatives(m, d)
computeRNEADerivatives(m, d, q, v, a); getCentroidalDynamicsDerivatives(m, d)
centerOfMass(m, d, q)
centerOfMass(m, d, q, False)
centerOfMass(m, d, q, v)
centerOfMass(m, d, q, v, a)
forwardKinematics(m, d, q, v, a); centerOfMass(m, d)
forwardKinematics(m, d, q, v, a); centerOfMass(m, d, pin.KinematicLevel.VELOCITY)
jacobianCenterOfMass(m, d, q)
forwardKinematics(m, d, q, v, a); jacobianCenterOfMass(m, d)
jacobianCenterOfMass(m, d, q, False)
jacobianSubtreeCenterOfMass(m, d, q, 2)
forwardKinematics(m, d, q, v, a); jacobianSubtreeCenterOfMass(m, d, 2)
jacobianCenterOfMass(m, d, q); getJacobianSubtreeCenterOfMass(m, d, 2)
computeTotalMass(m, d)
computeSubtreeMasses(m, d)
ccrba(m, d, q, v)
dccrba(m, d, q, v)
computeCentroidalMap(m, d, q)
computeCentroidalMapTimeVariation(m, d, q, v)
computeCentroidalMomentum(m, d, q, v)
forwardKinematics(m, d, q, v, a); computeCentroidalMomentum(m, d)
computeCentroidalMomentumTimeVariation(m, d, q, v, a)
forwardKinematics(m, d, q, v, a); computeCentroidalMomentumTimeVariation(m, d)
computeCentroidalDynamicsDerivatives(m, d, q, v, a)
computeKineticEnergy(m, d, q, v)
forwardKinematics(m, d, q, v, a); computeKineticEnergy(m, d)
computePotentialEnergy(m, d, q)
forwardKinematics(m, d, q, v, a); computePotentialEnergy(m, d)
computeMechanicalEnergy(m, d, q, v)
forwardKinematics(m, d, q, v, a); computeMechanicalEnergy(m, d)
computeJointTorqueRegressor(m, d, q, v, a)
computeStaticRegressor(m, d, q)
computeKineticEnergyRegressor(m, d, q, v)
computePotentialEnergyRegressor(m, d, q)
rnea(m, d, q, v, a); jointBodyRegressor(m, d, end)
rnea(m, d, q, v, a); frameBodyRegressor(m, d, last)
forwardKinematics(m, d, q, v, a); computeFrameKinematicRegressor(m, d, last, pin.LOCAL)
forwardKinematics(m, d, q, v, a); computeJointKinematicRegressor(m, d, end, pin.LOCAL)
rnea(m, d, q, v, a); computeSupportedForceByFrame(m, d, last)
forwardKinematics(m, d, q, v, a); computeSupportedInertiaByFrame(m, d, last, True)
crba(m, d, q); cholesky.decompose(m, d)
crba(m, d, q); cholesky.decompose(m, d); cholesky.computeMinv(m, d)
crba(m, d, q); cholesky.decompose(m, d); cholesky.solve(m, d, v)
forwardDynamics(m, d, q, v, tau, Jc, drift, 1e-6)
computeAllTerms(m, d, q, v); forwardDynamics(m, d, tau, Jc, drift, 1e-6)
impulseDynamics(m, d, q, v, Jc, 0.3, 1e-6)
crba(m, d, q); impulseDynamics(m, d, v, Jc, 0.3, 1e-6)
computeKKTContactDynamicMatrixInverse(m, d, q, Jc, 1e-6)
forwardDynamics(m, d, q, v, tau, Jc, drift, 1e-6); getKKTContactDynamicMatrixInverse(m, d, Jc)
initConstraintDynamics(m, d, cm, cm_data)
constraintDynamics(m, d, q, v, tau, cm, cm_data)
constraintDynamics(m, d, q, v, tau, cm, cm_data, pin.ProximalSettings(1e-12, 1e-6, 1))
impulseDynamics(m, d, q, v, cm, cm_data)
constraintDynamics(m, d, q, v, tau, cm, cm_data); computeConstraintDynamicsDerivatives(m, d, cm, cm_data)
impulseDynamics(m, d, q, v, cm, cm_data); computeImpulseDynamicsDerivatives(m, d, cm, cm_data)
computeDelassusMatrix(m, d, q, cm, cm_data)
computeDampedDelassusMatrixInverse(m, d, q, cm, cm_data, 1e-6)
forwardKinematics(m, d, q); computeJointJacobians(m, d, q); getConstraintsJacobian(m, d, cm, cm_data)
computeJointMinimalOrdering(m, d, cm); lcaba(m, d, q, v, tau, cm, cm_data, pin.ProximalSettings(1e-12, 1e-6, 1))
"""
EARLIER = """
rnea(m, d, q, v, a, fext)
aba(m, d, q, v, tau)
computeGeneralizedGravity(m, d, q)
computeCoriolisMatrix(m, d, q, v)
computeABADerivatives(m, d, q, v, tau)
computeStaticTorqueDerivatives(m, d, q, fext)
centerOfMass(m, d, q, v, a)
computeCentroidalDynamicsDerivatives(m, d, q, v, a)
computeJointTorqueRegressor(m, d, q, v, a)
constraintDynamics(m, d, q, v, tau, cm, cm_data); computeConstraintDynamicsDerivatives(m, d, cm, cm_data)
"""
"""What each of the calls follows on a separate Data."""
FIELDS = """
M Minv C J dJ Ag dAg Jcom tau nle g ddq dtau_dq dtau_dv ddq_dq ddq_dv ddq_dtau dHdq dFdq dFdv dFda dq_after
kineticEnergyRegressor potentialEnergyRegressor jointTorqueRegressor staticRegressor lambda_c impulse_c
dlambda_dq dlambda_dv dlambda_dtau oMi oMf liMi v a a_gf ov oa oa_gf f h of oh com vcom acom mass hg dhg Ig
kinetic_energy potential_energy mechanical_energy joints
"""
TRUTHS = {
    "framesForwardKinematics(m, d, q)": "oMi oMf liMi",
    "forwardKinematics(m, d, q, v, {a})": "v a",
    "rnea(m, d, q, v, {a})": "tau a_gf f h",
    "rnea(m, d, q, 0 * v, 0 * v)": "a_gf f",
    "rnea(m, d, q, v, {a}, fext)": "tau f",
    "rnea(m, d, q, 0 * v, 0 * v, fext)": "f",
    "computeABADerivatives(m, d, q, v, tau)": "Minv",
    "computeMinverse(m, d, q)": "Minv",
    "computeRNEADerivatives(m, d, q, v, {a})": "dFda dtau_dq dtau_dv",
    "centerOfMass(m, d, q, v, a)": "com vcom acom",
    "computeSubtreeMasses(m, d)": "mass",
    "ccrba(m, d, q, v)": "J Ag hg Ig",
    "dccrba(m, d, q, v)": "dJ dAg",
    "crba(m, d, q)": "M",
    "nonLinearEffects(m, d, q, v)": "nle",
    "computeKineticEnergy(m, d, q, v)": "kinetic_energy",
}
"""What fields mean: the calls that fill them, of accelerations given, none, or those that torques give."""
IN_WORLD = {"v": "ov", "a": "oa", "a_gf": "oa_gf", "f": "of", "h": "oh"}
"""The fields that are others in the world's frame."""
LAST = "computeCentroidalMomentumTimeVariation(m, d, q, v, a)"
"""After everything: computeAllTerms of Pinocchio adds to `dhg` at every call."""
PARTS = "dHdq dFdq dFdv dFda"
"""What computeCentroidalDynamicsDerivatives returns."""


def numbers(value, name):
    """A field as a list of numbers, those of the universe first."""
    for part in ("homogeneous", "vector"):
        if isinstance(value, (pin.SE3,) if part == "homogeneous" else (pin.Motion, pin.Force)):
            return np.asarray(getattr(value, part)).ravel().tolist()
    if isinstance(value, pin.Inertia):
        return value.toDynamicParameters().tolist()
    if name == "joints":
        parts = [(j.M.homogeneous, j.S, j.v.vector, j.c.vector) for j in list(value)[1:]]
        return [float(x) for joint in parts for part in joint for x in np.ravel(part)]
    if isinstance(value, (np.ndarray, float)):
        return np.ravel(value).tolist()
    return [x for k in range(len(value)) for x in numbers(value[k], "")]


def field(data, name):
    """Its numbers, or what is said instead."""
    try:
        return numbers(getattr(data, name), name)
    except Exception as error:
        return f"{type(error).__name__}: {error}"


def state(model, rng):
    q = pin.integrate(model, pin.neutral(model), 0.6 * rng.standard_normal(model.nv))
    v, a, tau = rng.standard_normal((3, model.nv))
    fext = pin.StdVec_Force()
    for _ in range(model.njoints):
        fext.append(pin.Force(rng.standard_normal(6)))
    return {"q": q, "v": v, "a": a, "tau": tau, "fext": fext, "Jc": np.eye(model.nv)[:3], "drift": a[:3]}


class Asked:
    """A model, and what calls are made of."""

    def __init__(self, file, root, mimic):
        root_joint = [getattr(pin, f"JointModel{root}")()] if root else []
        self.model = m = pin.buildModelFromUrdf(file, *root_joint, **({"mimic": True} if mimic else {}))
        rng = np.random.default_rng(11)
        self.first, self.second = state(m, rng), state(m, rng)
        M = pin.XYZQUATToSE3(np.array([0.1, 0.2, 0.3, 0.0, 0.0, np.sin(0.3), np.cos(0.3)]))
        self.contact = pin.RigidConstraintModel(
            pin.ContactType.CONTACT_3D, m, m.njoints - 1, M, 0, pin.SE3.Identity(), pin.LOCAL
        )
        self.names = {"pin": pin, "m": m, "end": m.njoints - 1, "last": m.nframes - 1, "M": M}
        self.used = {}

    def run(self, call, data, given, contacts):
        """Why it did not run, or None."""
        try:
            for one in call.split("; "):
                eval(f"pin.{one}", self.names | given | contacts | {"d": data})
        except Exception as error:
            return f"{type(error).__name__}: {error}"
        return None

    def after(self, before, call):
        """What a Data holds, before and after a call at the second state, that others preceded at the first."""
        if len(before) > 1 and "cm" not in call:
            data, contacts = self.used_by(before)[0].copy(), {}
        else:
            data, contacts = self.prepared(call, before)
        held = {name: field(data, name) for name in FIELDS.split()} if REAL else {}
        failed = self.run(call, data, self.second, contacts)
        return failed or [held, {name: field(data, name) for name in FIELDS.split()}]

    def used_by(self, before):
        """A Data that many calls were made with, of which copies are used: to make the calls again takes minutes."""
        key = tuple(before)
        if key not in self.used:
            self.used[key] = self.prepared("", before)
        return self.used[key]

    def prepared(self, call, before):
        """A Data on which calls were made at the first state, and constraints for `call`."""
        data, contacts = self.model.createData(), {}
        for name in ("cm", "none"):
            models, datas = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
            if name == "cm":
                models.append(self.contact)
                datas.append(self.contact.createData())
            contacts |= {name: models, f"{name}_data": datas}
        if any("cm" in one for one in (call, *before)):
            self.run("initConstraintDynamics(m, d, cm, cm_data)", data, {}, contacts)
        for one in before:
            self.run(one, data, self.first, contacts)
        return data, contacts

    def force_on_base(self, data):
        """The force on the joints that stand on the universe, (6,), where forces of joints are right."""
        standing = [k for k in range(1, self.model.njoints) if self.model.parents[k] == 0]
        return sum(data.oMi[k].act(data.f[k]).vector for k in standing).tolist()

    def truths(self, given):
        """For each field the values that it may have at a state."""
        found = {name: [] for name in FIELDS.split()}
        m, rest = self.model, 0 * given["v"]
        gains = [given["a"], rest]
        for forces in ([], [given["fext"]]):
            try:
                gains.append(pin.aba(m, m.createData(), given["q"], given["v"], given["tau"], *forces).copy())
            except Exception:
                continue  # not with mimic joints
        for call, names in TRUTHS.items():
            for gain in gains:
                data = m.createData()
                if self.run(call.format(a="gain"), data, given | {"gain": gain}, {}) is None:
                    pin.forwardKinematics(m, data, given["q"])
                    for name in names.split():
                        values = {name: field(data, name)}
                        if name in IN_WORLD:
                            moved = [M.act(one) for M, one in zip(data.oMi, getattr(data, name), strict=True)]
                            values[IN_WORLD[name]] = [x for one in moved for x in numbers(one, "")]
                        for field_name, one in values.items():
                            found[field_name].append(one)
                            if name == "f":
                                found[field_name].append([*self.force_on_base(data), *one[6:]])
        found["ddq_dtau"] = found["Minv"]
        try:
            parts = pin.computeCentroidalDynamicsDerivatives(m, m.createData(), *(given[k] for k in "qva"))
        except Exception:
            return found
        for name, part in zip(PARTS.split(), parts, strict=True):
            found[name].append(np.ravel(part).tolist())
        return found


def main(target, file, root, mimic, used):
    asked = Asked(file, root, mimic)
    calls = CALLS.strip().splitlines()
    asks = [("fresh", [], calls)]
    if used == "everything":
        asks.append((used, [*(call for call in calls if "lcaba" not in call), LAST], calls))
    elif (
        used == "each"
    ):  # a third of the calls after each, another one in turn; here fresh ones were asked before
        asks = asks if REAL else []
        asks += [(one, [one], calls[k % 3 :: 3]) for k, one in enumerate(EARLIER.strip().splitlines())]
    found = {f"{name} | {call}": asked.after(ones, call) for name, ones, last in asks for call in last}
    recorded = {"after": found}
    if REAL:
        recorded["truths"] = [asked.truths(asked.first), asked.truths(asked.second)]
    with open(target, "w", encoding="utf-8") as out:
        out.write(json.dumps({"file": pin.__file__, "answers": recorded}))


REAL = "site-packages" in pin.__file__
if __name__ == "__main__":
    main(*sys.argv[1:])
