"""What algorithms leave in a Data that held another state before: asked of whichever pinocchio is imported, by a test."""

import json
import sys

import numpy as np
import pinocchio as pin

ALGORITHMS = {
    "rnea": (lambda m, d, q, v, a: pin.rnea(m, d, q, v, a), "v a_gf f liMi"),
    "nle": (lambda m, d, q, v, a: pin.nle(m, d, q, v), "v a_gf f"),
    "aba": (lambda m, d, q, v, a: pin.aba(m, d, q, v, a), "v a_gf"),
    "aba, WORLD": (lambda m, d, q, v, a: pin.aba(m, d, q, v, a, convention=pin.Convention.WORLD), "J oMi"),
    "crba, WORLD": (lambda m, d, q, v, a: pin.crba(m, d, q, pin.Convention.WORLD), "J oMi"),
    "gravity": (lambda m, d, q, v, a: pin.computeGeneralizedGravity(m, d, q), "f a_gf v a"),
    "all terms": (lambda m, d, q, v, a: pin.computeAllTerms(m, d, q, v), "v a dAg Ig ov J dJ"),
    "coriolis": (lambda m, d, q, v, a: pin.computeCoriolisMatrix(m, d, q, v), "v ov J dJ oMi"),
    "rnea derivatives": (
        lambda m, d, q, v, a: pin.computeRNEADerivatives(m, d, q, v, a),
        "v a ov oa J dJ oMi",
    ),
    "gravity derivatives": (
        lambda m, d, q, v, a: pin.computeGeneralizedGravityDerivatives(m, d, q),
        "g J oMi",
    ),
    "kinematics derivatives": (
        lambda m, d, q, v, a: pin.computeForwardKinematicsDerivatives(m, d, q, v, a),
        "v a ov oa J dJ",
    ),
    "centroidal derivatives": (
        lambda m, d, q, v, a: pin.computeCentroidalDynamicsDerivatives(m, d, q, v, a),
        "v a J dJ Ag hg dhg Ig oMi com0",
    ),
    "momentum rate": (
        lambda m, d, q, v, a: pin.computeCentroidalMomentumTimeVariation(m, d, q, v, a),
        "v a hg dhg",
    ),
    "dccrba": (lambda m, d, q, v, a: pin.dccrba(m, d, q, v), "Ag dAg hg Ig v J dJ"),
    "regressor": (lambda m, d, q, v, a: pin.computeJointTorqueRegressor(m, d, q, v, a), "v a_gf liMi"),
    "energy": (lambda m, d, q, v, a: pin.computeKineticEnergy(m, d, q, v), "v oMi"),
    "mass": (lambda m, d, q, v, a: pin.computeTotalMass(m, d), "mass0"),
}
NO_ACCELERATIONS = ("aba", "aba, WORLD")  # there `data.a` is that of an intermediate step


def numbers(value):
    if isinstance(value, (np.ndarray, float)):
        return np.asarray(value).tolist()
    if isinstance(value, pin.Inertia):
        return value.matrix().tolist()
    for name in ("homogeneous", "vector"):
        if isinstance(value, (pin.SE3,) if name == "homogeneous" else (pin.Motion, pin.Force)):
            return np.asarray(getattr(value, name)).tolist()
    return [numbers(value[i]) for i in range(1, len(value))]  # the universe's are left as they were


def articulated(m, d):
    """What aba leaves of its recursion."""
    joints = [d.joints[i] for i in range(1, m.njoints)]
    terms = {
        n: [np.asarray(getattr(joint, n)).ravel().tolist() for joint in joints]
        for n in ("U", "Dinv", "UDinv")
    }
    rows = {n: list(getattr(d, n)) for n in ("non_mimic_parents_fromRow", "mimic_parents_fromRow")}
    rows["extended"] = list(d.idx_vExtended_to_idx_v_fromRow)
    return {"Yaba": numbers(d.Yaba), **terms, **rows}


def main(target, file, root):
    m = pin.buildModelFromUrdf(file, *((getattr(pin, f"JointModel{root}")(),) if root else ()))
    rng = np.random.default_rng(7)
    found = {}
    for name, (algorithm, fields) in ALGORITHMS.items():
        states = []
        for _ in range(2):
            q = pin.integrate(m, pin.neutral(m), 0.6 * rng.standard_normal(m.nv))
            states.append((q, rng.standard_normal(m.nv), rng.standard_normal(m.nv)))
        d = m.createData()
        pin.forwardKinematics(m, d, *states[0])
        pin.computeJointJacobiansTimeVariation(m, d, *states[0][:2])
        pin.updateFramePlacements(m, d)
        algorithm(m, d, *states[1])
        for field in fields.split():
            value = getattr(d, field.rstrip("0"))
            found[f"{name}: {field}"] = numbers(value[0] if field.endswith("0") else value)
        for rf in (pin.LOCAL, pin.WORLD, pin.LOCAL_WORLD_ALIGNED):
            joint, frame = m.njoints - 1, m.nframes - 1
            if name != "aba, WORLD":  # there `data.v` keeps the state before, and `data.ov` has the new
                found[f"{name}: velocities {rf}"] = numbers(pin.getVelocity(m, d, joint, rf)) + numbers(
                    pin.getFrameVelocity(m, d, frame, rf)
                )
            if name not in NO_ACCELERATIONS:
                for of in (pin.getFrameAcceleration, pin.getFrameClassicalAcceleration):
                    found[f"{name}: {of.__name__} {rf}"] = numbers(of(m, d, frame, rf))
            pin.getFrameJacobian(m, d, frame, rf)
            found[f"{name}: placed by getFrameJacobian {rf}"] = numbers(d.oMf[frame])
        if name == "aba":
            found |= articulated(m, d)
        if name == "rnea":
            found["body regressor"] = numbers(pin.frameBodyRegressor(m, d, frame))
    with open(target, "w", encoding="utf-8") as out:
        out.write(json.dumps({"file": pin.__file__, "answers": found}))


if __name__ == "__main__":
    main(*sys.argv[1:])
