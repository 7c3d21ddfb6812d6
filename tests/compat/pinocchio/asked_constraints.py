"""What Ulna's package and Pinocchio are both asked about constraints; see asked.py.

`python asked_constraints.py out.json robot file root joints`: the joints, separated by commas, are held one by one, and
the first two to each other.
"""

import json
import sys

import numpy as np
import pinocchio as pin
from asked import answers

SOLVED = """
! pin.initConstraintDynamics(m, d, cs, ds)
d.lambda_c; d.osim.shape; pin.constraintDynamics(m, d, q, v, tau, cs, ds, s); d.ddq; d.lambda_c; [x.contact_force for x in ds]
np.triu(d.M); d.nle; d.J; list(d.oMi); [x.oMc1 for x in ds]; [x.oMc2 for x in ds]; [x.c1Mc2 for x in ds]
[x.contact1_velocity for x in ds]; [x.contact2_velocity for x in ds]; [x.contact_placement_error for x in ds]
[x.contact_velocity_error for x in ds]; [x.contact_acceleration_error for x in ds]; [c.residualSize() for c in cs]
pin.getConstraintsJacobian(m, d, cs, ds); pin.getConstraintJacobian(m, d, cs[0], ds[0])
d.constraint_chol.matrix(); d.constraint_chol.U; d.constraint_chol.D; d.constraint_chol.Dinv; d.constraint_chol.size()
d.constraint_chol.constraintDim(); d.constraint_chol.inverse(); d.constraint_chol.solve(np.arange(m.nv + len(d.lambda_c)) * 1.0)
d.constraint_chol.getInverseMassMatrix(); d.constraint_chol.getOperationalSpaceInertiaMatrix()
d.constraint_chol.getInverseOperationalSpaceInertiaMatrix(); d.constraint_chol.getDamping()
d.constraint_chol.getDelassusOperatorCholeskyExpression().matrix(); d.constraint_chol.getMassMatrixChoeslkyDecomposition(m, d).matrix()
"""

DECOMPOSED = """
! chol = pin.ContactCholeskyDecomposition(m, d, cs, ds); mus = np.linspace(1e-3, 1e-1, chol.constraintDim()); b = np.arange(chol.size()) - 2.0
! chol.compute(m, d, cs, ds, 1e-4); before = chol.solve(b), chol.U.copy(), chol.D.copy(); chol.compute(m, d, cs, ds, mus)
before; chol.U; chol.D; chol.Dinv; chol.matrix(); chol.inverse(); chol.solve(b); chol.getDamping(); chol.getInverseMassMatrix()
chol.getOperationalSpaceInertiaMatrix(); chol.getInverseOperationalSpaceInertiaMatrix(); chol.getMassMatrixChoeslkyDecomposition(m, d).U
! G, c = chol.getDelassusOperatorCholeskyExpression(), np.arange(chol.constraintDim()) - 2.0
G.matrix(); G.solve(c); G.inverse()
! none, of_none = listed([])
! chol = pin.ContactCholeskyDecomposition(m, d, none, of_none); chol.compute(m, d, none, of_none, 0.0)
chol.U; chol.D; chol.solve(d.nle); chol.inverse(); chol.constraintDim()
"""

ONE_ROUND = """
pin.constraintDynamics(m, d, q, v, tau, cs, ds)
"""

DERIVATIVES = """
! pin.constraintDynamics(m, d, q, v, tau, cs, ds, s); found = pin.computeConstraintDynamicsDerivatives(m, d, cs, ds, s)
found; d.ddq_dq; d.ddq_dv; d.ddq_dtau; d.dlambda_dq; d.dlambda_dv; d.dlambda_dtau; d.osim; d.dac_da
"""

IMPACT = """
pin.impulseDynamics(m, d, q, v, cs, ds, 0.3, s); d.dq_after; d.impulse_c; [x.contact_force for x in ds]
"""

IMPACT_DERIVATIVES = """
! pin.computeImpulseDynamicsDerivatives(m, d, cs, ds, 0.3, s)
d.ddq_dq; d.ddq_dv; d.dlambda_dq; d.dlambda_dv
"""

DELASSUS = """
pin.computeDelassusMatrix(m, d, q, cs, ds); pin.computeDelassusMatrix(m, d, q, cs, ds, 1e-3)
"""

JACOBIAN = """
! J, k = rng.normal(size=(3, m.nv)), rng.normal(size=3)
pin.forwardDynamics(m, d, q, v, tau, J, k); d.lambda_c; d.ddq; pin.getKKTContactDynamicMatrixInverse(m, d, J)
pin.forwardDynamics(m, d, q, v, tau, J, k, 1e-3); d.lambda_c; pin.forwardDynamics(m, d, tau, J, k, 1e-2)
pin.impulseDynamics(m, d, q, v, J, 0.3, 1e-3); d.impulse_c; d.dq_after; pin.impulseDynamics(m, d, v, J)
pin.computeKKTContactDynamicMatrixInverse(m, d, q, J, 1e-3); pin.computeKKTContactDynamicMatrixInverse(m, d, q, J)
! none = np.zeros((0, m.nv)); twice = np.vstack([J, J])
pin.forwardDynamics(m, d, q, v, tau, none, none[:, 0]); d.lambda_c; pin.impulseDynamics(m, d, q, v, none); d.impulse_c
pin.forwardDynamics(m, d, q, v, tau, twice, np.arange(6.0), 1.0); d.lambda_c; pin.getKKTContactDynamicMatrixInverse(m, d, twice)
pin.impulseDynamics(m, d, q, v, twice, 0.5, 1.0); d.impulse_c; pin.computeKKTContactDynamicMatrixInverse(m, d, q, twice, 1.0)
pin.cholesky.solve(m, d, v); pin.cholesky.decompose(m, d)
"""

SEEN = """
! pin.forwardKinematics(m, d, q, v, a); pin.computeJointJacobians(m, d, q); pin.forwardKinematics(m, d, q, v, a); pin.crba(m, d, q)
! ds = listed([c.createData() for c in cs], "Data"); [c.calc(m, d, x) for c, x in zip(cs, ds)]
[c.residualSize() for c in cs]; [c.shortname() for c in cs]; [x.oMc1 for x in ds]; [x.oMc2 for x in ds]; [x.c1Mc2 for x in ds]
[x.constraint_position_error for x in ds]; [x.constraint_velocity_error for x in ds]
[x.constraint_acceleration_error for x in ds]; [c.jacobian(m, d, x) for c, x in zip(cs, ds)]
[c.jacobianMatrixProduct(m, d, x, np.eye(m.nv)) for c, x in zip(cs, ds)]; [c.retrieveCompliance() for c in cs]
[c.jacobianTransposeMatrixProduct(m, d, x, np.eye(c.residualSize())) for c, x in zip(cs, ds)]
[x.A1_local for x in ds]; [x.A2_local for x in ds]; [x.A1_world for x in ds]; [x.A2_world for x in ds]; [x.A_local for x in ds]
[(c.depth_joint1, c.depth_joint2) for c in cs]; [x.constraint_acceleration_biais_term for x in ds]
! moved = motions(m)
[mapped(m, d, c, x) for c, x in zip(cs, ds)]; [mapped(m, d, c, x, pin.WORLD) for c, x in zip(cs, ds)]
[c.mapJointSpaceToConstraintMotion(m, d, x, moved, v) for c, x in zip(cs, ds)]
[c.mapJointSpaceToConstraintMotion(m, d, x, moved, v, pin.WORLD) for c, x in zip(cs, ds)]
"""

CONTACTS = (
    SEEN
    + """
! settings = pin.ProximalSettings(1e-12, 1e-12, 1e-2, 300); zero = np.zeros(3 * len(cs))
pin.contactInverseDynamics(m, d, q, v, a, 1e-2, cs, ds, zero - 0.1, settings); d.tau
! settings = pin.ProximalSettings(1e-6, 1e-6, 1e-2, 5)
pin.contactInverseDynamics(m, d, q, v, a, 1e-2, cs, ds, zero - 0.1, settings, zero + 1.0, False)
"""
)

CONVERTED = """
[pin.convertToRigidConstraintModel(m, c).residualSize() for c in cs]
[pin.convertToRigidConstraintModel(m, c, pin.LOCAL_WORLD_ALIGNED).joint1_placement for c in cs]
"""

OF_JOINTS = """
! some = [1, m.njoints - 1]; f = pin.JointFrictionConstraintModel(m, some); x = f.createData()
! lower, upper = np.full(m.nq, -1.0), np.full(m.nq, 1.0); near = np.full(m.nq, 0.3); last = [m.njoints - 2, m.njoints - 1]
! l = pin.JointLimitConstraintModel(m, last, lower, upper, near); f.calc(m, d, x)
f.residualSize(); list(f.getActiveDofs()); list(f.getActiveJoints()); f.getTimeStep(); f.jacobian(m, d, x); f.shortname()
f.jacobianMatrixProduct(m, d, x, np.eye(m.nv)); f.jacobianTransposeMatrixProduct(m, d, x, np.eye(f.residualSize()))
f.mapJointSpaceToConstraintMotion(m, d, x, motions(m), v); mapped(m, d, f, x)
l.residualSize(); list(l.getSelectedJoints()); l.getActivablePositionLimit(); list(l.active_idx_in_activable())
! z = pin.neutral(m); z[m.joints[last[0]].idx_q], z[m.joints[last[1]].idx_q] = 0.8, -1.2; l.makeSelectionFilteredByLimitProximity(z)
! pin.forwardKinematics(m, d, z); y = l.createData(); l.calc(m, d, y)
l.residualSize(); l.residualSize(pin.ConstraintSelectionType.MAXIMAL); list(l.active_idx_in_activable()); l.lowerResidualSize()
l.upperResidualSize(); l.jacobian(m, d, y); l.set(y).project(np.array([-1.0, 2.0])); l.shortname(); l.retrieveCompliance()
! l.setCompliance(np.array([3.0, 4.0])); l.setCompliance(l.retrieveCompliance(pin.ConstraintSelectionType.MAXIMAL) + 1.0, pin.ConstraintSelectionType.MAXIMAL)
l.retrieveCompliance(); l.retrieveCompliance(pin.ConstraintSelectionType.MAXIMAL); l.jacobianMatrixProduct(m, d, y, np.eye(m.nv))
l.mapJointSpaceToConstraintMotion(m, d, y, motions(m), v); mapped(m, d, l, y)
! f.setFrictionLowerLimit(-np.ones(f.residualSize())); f.setFrictionUpperLimit(np.ones(f.residualSize())); f.setTimeStep(0.1)
f.getFrictionLowerLimit(); f.getFrictionUpperLimit(); f.getTimeStep()
! s, t = pin.PGSSolverSettings(), pin.ADMMSolverSettings()
s.absolute_feasibility_tol; s.relative_feasibility_tol; s.absolute_complementarity_tol; s.relative_complementarity_tol
s.max_iterations; s.over_relaxation; s.solve_ncp; t.mu_prox; t.tau; t.max_iterations; t.ratio_primal_dual; t.rho_min; t.rho_max
t.absolute_feasibility_tol; t.relative_feasibility_tol; t.absolute_complementarity_tol; t.relative_complementarity_tol
"""

PUSHED = """
! pin.forwardKinematics(m, d, q, v, a); pin.computeJointJacobians(m, d, q); pin.crba(m, d, q)
! f = pin.JointFrictionConstraintModel(m, [m.njoints - 1], -np.full(m.nv, 0.002), np.full(m.nv, 0.002))
! ms = pin.StdVec_ConstraintModel(); ms.extend([cs[0], f])
! ds = pin.StdVec_ConstraintData(); ds.extend([c.createData() for c in ms])
! [c.calc(m, d, x) for c, x in zip(ms, ds)]
! J = pin.getConstraintsJacobian(m, d, ms, ds); G = J @ np.linalg.solve(pin.crba(m, d, q), J.T)
! g = J @ (v + 1e-2 * pin.aba(m, d, q, v, tau)); settings, result = pin.PGSSolverSettings(), pin.PGSSolverResult()
! settings.max_iterations = 100000; g[2] -= 1.0
! settings.absolute_feasibility_tol = settings.absolute_complementarity_tol = 1e-13
! settings.relative_feasibility_tol = settings.relative_complementarity_tol = 1e-13
! solver = pin.PGSConstraintSolver(len(g)); solver.solve(pin.DelassusOperatorDense(G), g, ms, ds, settings, result)
J; result.converged; result.problem_size; result.constraintSize(); result.isValid(); solver.isValid()
result.retrieveConstraintImpulses()
"""

POINT, FRAME = pin.ContactType.CONTACT_3D, pin.ContactType.CONTACT_6D


def cases(m, joints, M, N):
    """Constraints, damping and rounds; and whether Pinocchio's derivatives are those of what it computes.

    Those of two bodies of one chain are not, nor those of frames with gains along the world's axes.
    """
    here, aligned = pin.LOCAL, pin.LOCAL_WORLD_ALIGNED
    yield "points", [pin.RigidConstraintModel(POINT, m, j, M, 0, N, here) for j in joints], (1e-3, 5), True
    yield (
        "points aligned",
        [pin.RigidConstraintModel(POINT, m, j, M, aligned) for j in joints],
        (0.0, 1),
        True,
    )
    yield "frame", [pin.RigidConstraintModel(FRAME, m, joints[0], M, 0, N)], (1e-6, 20), True
    yield "frame aligned", [pin.RigidConstraintModel(FRAME, m, joints[0], aligned)], (0.0, 1), False
    ends = (joints[0], M, joints[1], N)
    yield "points joined", [pin.RigidConstraintModel(POINT, m, *ends, here)], (0.0, 1), False
    if m.nv > 12:  # legs
        yield "frames joined", [pin.RigidConstraintModel(FRAME, m, *ends, here)], (1e-5, 10), True


def listed(things, what=""):
    """The same as the vector that Pinocchio wants; for Ulna's package a list. Of no constraints, models and data."""
    if not things:
        return pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
    kind = type(things[0]).__name__.replace("Data", "").replace("Model", "")
    out = getattr(pin, f"StdVec_{kind}{what or 'Model'}")()
    out.extend(things)
    return out


def mapped(m, d, c, x, *rf):
    """What a constraint's forces are on the joints, added to forces that are there."""
    forces = pin.StdVec_Force()
    for k in range(m.njoints):
        forces.append(pin.Force(np.arange(6.0) + k))
    torques = c.mapConstraintForceToJointSpace(m, d, x, np.arange(1.0, c.residualSize() + 1.0), forces, *rf)
    return torques, list(forces)


def motions(m):
    """Motions of the joints."""
    found = pin.StdVec_Motion()
    for k in range(m.njoints):
        found.append(pin.Motion(np.arange(6.0) - k))
    return found


def seen(m, joints, M, N):
    """Constraints that tell where their second frame is, and the text that is asked of them."""
    ends = [(joints[0], M, 0, N), (joints[0], M, joints[1], N), (0, N, joints[1], M)]
    points = listed([pin.PointAnchorConstraintModel(m, *one) for one in ends])
    frames = listed([pin.FrameAnchorConstraintModel(m, *one) for one in ends])
    for cs, text in ((points, SEEN), (frames, SEEN + CONVERTED)):
        for k, c in enumerate(cs):
            c.desired_constraint_velocity = 0.2 * k * np.arange(c.residualSize())
            c.desired_constraint_acceleration = 0.3 * k * np.arange(c.residualSize())
        yield type(cs[0]).__name__, cs, text
    contacts = listed([pin.PointContactConstraintModel(m, 0, pin.SE3.Identity(), j, M) for j in joints[:2]])
    for k, c in enumerate(contacts):
        c.setFriction(0.3 + 0.4 * k)
    yield "contacts", contacts, CONTACTS
    if m.nv > 6:  # Pinocchio's solver does not converge on the UR5
        yield "pushed", contacts, PUSHED


if __name__ == "__main__":
    target, file, root, held = sys.argv[1:]
    m = pin.buildModelFromUrdf(file, *([getattr(pin, f"JointModel{root}")()] if root else []))
    rng = np.random.default_rng(5)
    q = pin.integrate(m, pin.neutral(m), rng.uniform(-1, 1, m.nv))
    v, tau, a = rng.normal(size=(3, m.nv))
    M = pin.XYZQUATToSE3(np.array([0.1, 0.2, 0.3, 0.0, 0.0, np.sin(0.3), np.cos(0.3)]))
    N = pin.XYZQUATToSE3(np.array([0.3, -0.2, 0.1, 0.0, np.sin(0.2), 0.0, np.cos(0.2)]))
    joints = [m.getJointId(name) for name in held.split(",")]
    names = {
        "m": m,
        "q": q,
        "v": v,
        "tau": tau,
        "a": a,
        "rng": rng,
        "listed": listed,
        "mapped": mapped,
        "motions": motions,
    }
    result = {}
    for name, cs, (mu, rounds), exact in cases(m, joints, M, N):
        for c in cs:
            c.m_baumgarte_parameters.Kp, c.m_baumgarte_parameters.Kd = 10.0, 3.0
        ds = [c.createData() for c in cs]
        for x in ds:
            x.contact_acceleration_desired = pin.Motion(np.arange(6.0))
        settings = pin.ProximalSettings(1e-12, mu, rounds)
        contact = all(c.joint2_id == 0 for c in cs)
        text = (
            SOLVED
            + DECOMPOSED
            + DERIVATIVES * exact
            + IMPACT * contact
            + (IMPACT_DERIVATIVES + ONE_ROUND) * (contact and mu == 0)
        )
        if contact and cs[0].reference_frame == pin.LOCAL:
            text += DELASSUS
        found = answers(text, names | {"d": m.createData(), "cs": cs, "ds": ds, "s": settings})
        result |= {f"{name}: {line}": value for line, value in found.items()}
    for name, cs, text in seen(m, joints, M, N):
        found = answers(text, names | {"d": m.createData(), "cs": cs})
        result |= {f"{name}: {line}": value for line, value in found.items()}
    result |= answers(OF_JOINTS, names | {"d": m.createData()})
    result |= answers(JACOBIAN, names | {"d": m.createData()})
    with open(target, "w", encoding="utf-8") as out:
        out.write(json.dumps({"file": pin.__file__, "answers": result}))
