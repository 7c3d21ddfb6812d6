"""Constraints of Ulna's package: what Pinocchio answers, derivatives where it errs, and what is refused."""

from __future__ import annotations

import copy
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using
from support.two_pythons import both
from ulna.errors import InputError, ShapeError
from ulna.robots.example_robot_data import share_folder

ROBOTS = {  # on a base and on a free flyer; a second arm would be asked the same
    "ur5": ("ur_description/urdf/ur5_robot.urdf", "", "wrist_3_joint,elbow_joint"),
    "solo12": ("solo_description/robots/solo12.urdf", "FreeFlyer", "FL_KFE,HR_KFE"),
}
SLOW = ("solo12",)


@pytest.mark.parametrize("robot", [pytest.param(r, marks=[pytest.mark.slow] * (r in SLOW)) for r in ROBOTS])
def test_equals_pinocchio(robot: str, tmp_path: Path) -> None:
    share = share_folder()
    if share is None:
        pytest.skip("example-robot-data is not installed")
    file, *words = ROBOTS[robot]
    own, wanted = both(
        Path(__file__).parent / "asked_constraints.py", tmp_path, str(share / "robots" / file), *words
    )
    assert list(own) == list(wanted)
    assert [line for line in wanted if not _close(own[line], wanted[line])] == []


def _close(own: Any, wanted: Any) -> bool:
    """Whether arrays, or lists of them, are equal to 1e-9 of the largest entry, or of one; texts to the letter."""
    if isinstance(wanted, str):
        return own == wanted
    try:
        a, b = np.asarray(own, dtype=float), np.asarray(wanted, dtype=float)
    except ValueError:  # of several shapes
        return len(own) == len(wanted) and all(_close(a, b) for a, b in zip(own, wanted, strict=True))
    error, size = np.abs(a - b).max(initial=0.0), np.abs(b).max(initial=1.0)
    return a.shape == b.shape and bool(error <= 1e-9 * size)


# refusals, and what works here though not there ------------------------------------------------------------


@pytest.fixture(scope="module")
def pin() -> Iterator[Any]:
    with using("pinocchio"):
        import pinocchio

        yield pinocchio


def _arm(pin: Any) -> tuple[Any, Any, Any, Any, Any]:
    """A model, its data, a state, and a constraint."""
    model = pin.buildSampleModelManipulator()
    q, v = np.linspace(-1.0, 1.0, 6), np.linspace(0.5, -0.5, 6)
    held = pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, model, 6, pin.LOCAL_WORLD_ALIGNED)
    return model, model.createData(), q, v, held


def test_constraints_are_checked_when_they_are_made(pin: Any) -> None:
    model, _, _, _, _ = _arm(pin)
    point = pin.ContactType.CONTACT_3D
    for wrong, word in (
        ((point, model, 60), "expected 0 to 6"),
        ((point, model, 3, 3), "binds nothing"),
        ((point, model, 3, pin.WORLD), "LOCAL or LOCAL_WORLD_ALIGNED"),
        ((3, model, 3), "CONTACT_6D"),
        ((pin.ContactType.CONTACT_UNDEFINED, model, 3), "CONTACT_6D"),
        ((point, "arm", 3), "pinocchio.Model"),
        ((point, model), "getJointId"),
        ((point, model, 3, "here"), "an SE3"),
    ):
        with pytest.raises(InputError, match=word):
            pin.RigidConstraintModel(*wrong)
    with pytest.raises(InputError, match="joint3_id"):
        pin.RigidConstraintModel(point, model, 3, joint3_id=2)
    with pytest.raises(AttributeError):
        pin.RigidConstraintModel(point, model, 3).corrector = 1.0


def test_data_of_other_constraints_are_refused(pin: Any) -> None:
    model, data, q, v, held = _arm(pin)
    frame = pin.RigidConstraintModel(pin.ContactType.CONTACT_6D, model, 6)
    with pytest.raises(InputError, match="createData"):
        pin.constraintDynamics(model, data, q, v, v, [held], [frame.createData()])
    shared = held.createData()
    with pytest.raises(InputError, match="each its own"):
        pin.constraintDynamics(model, data, q, v, v, [held, held], [shared, shared])
    with pytest.raises(InputError, match="expected as many"):
        pin.initConstraintDynamics(model, data, [held], [])
    with pytest.raises(InputError, match="RigidConstraintModel"):
        pin.constraintDynamics(model, data, q, v, v, ["held"], [held.createData()])
    with pytest.raises(InputError, match="ProximalSettings"):
        pin.constraintDynamics(model, data, q, v, v, [held], [held.createData()], 1e-6)
    with pytest.raises(ShapeError):
        pin.constraintDynamics(model, data, q, v, v[:5], [held], [held.createData()])
    other = pin.Model()
    small = pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, model, 6)
    joint = other.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), "only")
    other.appendBodyToJoint(joint, pin.Inertia.Random(), pin.SE3.Identity())
    with pytest.raises(InputError, match="another model"):
        pin.constraintDynamics(other, other.createData(), [0.1], [0.0], [0.0], [small], [small.createData()])


def test_derivatives_want_the_dynamics_first(pin: Any) -> None:
    model, data, q, v, held = _arm(pin)
    known = held.createData()
    with pytest.raises(InputError, match="Call constraintDynamics"):
        pin.computeConstraintDynamicsDerivatives(model, data, [held], [known])
    pin.constraintDynamics(model, data, q, v, v, [held], [known])
    with pytest.raises(InputError, match="Call impulseDynamics"):
        pin.computeImpulseDynamicsDerivatives(model, data, [held], [known])
    with pytest.raises(InputError, match="Call forwardKinematics"):
        pin.getConstraintJacobian(model, model.createData(), held, known)
    with pytest.raises(InputError, match="crba"):
        pin.forwardDynamics(model, model.createData(), v, np.eye(3, 6), np.zeros(3))
    with pytest.raises(InputError, match="compute"):
        pin.ContactCholeskyDecomposition(model, data, [held], [known]).inverse()


def test_a_jacobian_of_many_rows(pin: Any) -> None:
    """Too many to be compiled as a whole; the numbers are those of dense matrices."""
    model, data, q, v, _ = _arm(pin)
    J, drift = np.random.default_rng(3).normal(size=(40, 6)), np.linspace(-1.0, 1.0, 40)
    a = pin.forwardDynamics(model, data, q, v, v, J, drift, 1e-2)
    K = np.block([[data.M, J.T], [J, -1e-2 * np.eye(40)]])
    wanted = np.linalg.solve(K, np.concatenate([v - data.nle, -drift]))
    np.testing.assert_allclose(np.concatenate([a, -data.lambda_c]), wanted, atol=1e-9)
    np.testing.assert_allclose(
        pin.getKKTContactDynamicMatrixInverse(model, data, J) @ K, np.eye(46), atol=1e-9
    )
    with pytest.raises(InputError, match="rank 6"):
        pin.forwardDynamics(model, data, v, J, drift)


def test_arguments_of_dynamics_with_a_jacobian(pin: Any) -> None:
    model, data, q, v, _ = _arm(pin)
    J, drift = np.random.default_rng(3).normal(size=(3, 6)), np.array([0.1, 0.2, 0.3])
    a = pin.forwardDynamics(model, data, q, v, v, J, drift)
    np.testing.assert_array_equal(pin.forwardDynamics(model, data, v.tolist(), J.tolist(), drift.tolist()), a)
    np.testing.assert_array_equal(pin.forwardDynamics(model, data, v, np.asfortranarray(J), drift), a)
    named = {"tau": v, "constraint_jacobian": J, "constraint_drift": drift}
    np.testing.assert_array_equal(pin.forwardDynamics(model, data, q=q, v=v, **named), a)
    pin.forwardDynamics(model, data, v, J[:2], drift[:2])  # one row less, and back
    with pytest.raises(InputError, match="was .2, 6."):
        pin.getKKTContactDynamicMatrixInverse(model, data, J)
    np.testing.assert_array_equal(pin.forwardDynamics(model, data, v, J, drift), a)
    for wrong, name in (((v, J[:, :5], drift), "jacobian"), ((v[:5], J, drift), "tau"), ((v, J, v), "drift")):
        with pytest.raises(ShapeError, match=name):
            pin.forwardDynamics(model, data, *wrong)
    with pytest.raises(InputError, match="damping is -1"):
        pin.forwardDynamics(model, data, v, J, drift, -1.0)
    with pytest.raises(InputError, match="not finite"):
        pin.forwardDynamics(model, data, v, np.full((3, 6), np.nan), drift)
    with pytest.raises(InputError, match="expected forwardDynamics"):
        pin.forwardDynamics(model, data, v, J)
    model.addJoint(6, pin.JointModelRX(), pin.SE3.Identity(), "more")
    with pytest.raises(InputError, match="createData"):
        pin.forwardDynamics(model, data, v, J, drift)


@pytest.mark.parametrize("rows", [3, 30])
def test_kkt_inverse_is_of_the_mass_matrix_of_the_last_dynamics(pin: Any, rows: int) -> None:
    model, data, q, v, _ = _arm(pin)
    J, damping = np.random.default_rng(3).normal(size=(rows, 6)), 0.1
    pin.forwardDynamics(model, data, q, v, v, J, np.zeros(rows), damping)
    K = np.block([[data.M.copy(), J.T], [J, -damping * np.eye(rows)]])
    other = pin.crba(model, data, 3.0 * q)
    for _ in range(2):
        inverse = pin.getKKTContactDynamicMatrixInverse(model, data, J)
        np.testing.assert_allclose(inverse @ K, np.eye(6 + rows), atol=1e-9)
    J[0, 1] += 1.0  # another Jacobian than that of the dynamics, in the same array
    K = np.block([[K[:6, :6], J.T], [J, K[6:, 6:]]])
    inverse = pin.getKKTContactDynamicMatrixInverse(model, data, np.asfortranarray(J))
    np.testing.assert_allclose(inverse @ K, np.eye(6 + rows), atol=1e-9)
    model.armature[2] += 1.0  # other kernels
    pin.crba(model, data, q)
    inverse = pin.getKKTContactDynamicMatrixInverse(model, data, J)
    np.testing.assert_allclose(inverse @ K, np.eye(6 + rows), atol=1e-9)
    np.testing.assert_allclose(pin.crba(model, data, 3.0 * q), data.M)
    assert np.abs(data.M - other).max() > 1e-3
    with pytest.raises(InputError):
        pin.forwardDynamics(model, data, v, np.zeros((rows, 6)), np.zeros(rows))
    with pytest.raises(InputError, match="Call forwardDynamics"):
        pin.getKKTContactDynamicMatrixInverse(model, data, J)


def test_factors_of_the_mass_matrix_last_until_the_next_ones(pin: Any) -> None:
    model, data, q, v, _ = _arm(pin)
    M = pin.crba(model, data, q)
    U = pin.cholesky.decompose(model, data)
    np.testing.assert_allclose(pin.cholesky.solve(model, data, M), np.eye(6), atol=1e-12)
    other = pin.crba(model, data, -q)
    np.testing.assert_allclose(M @ pin.cholesky.solve(model, data, v), v, atol=1e-12)
    pin.impulseDynamics(model, data, v, np.eye(1, 6))  # decomposes, too
    np.testing.assert_allclose(pin.cholesky.computeMinv(model, data) @ other, np.eye(6), atol=1e-12)
    assert np.abs(pin.cholesky.decompose(model, data) - U).max() > 1e-3
    with pytest.raises(InputError, match="crba"):
        pin.cholesky.decompose(model, model.createData())
    with pytest.raises(ShapeError):
        pin.cholesky.solve(model, data, v[:5])


def test_a_decomposition_follows_its_constraints(pin: Any) -> None:
    model, data, q, v, held = _arm(pin)
    known = held.createData()
    chol = pin.ContactCholeskyDecomposition(model, data, [held], [known])
    assert chol.size() == 9 and not chol.matrix().any() and chol == chol.copy()
    pin.computeAllTerms(model, data, q, v)
    chol.compute(model, data, [held], [known])
    G, first = chol.getDelassusOperatorCholeskyExpression(), chol.copy()
    np.testing.assert_allclose(chol.solve(chol.matrix()), np.eye(9), atol=1e-9)
    G.updateDamping(0.1)
    np.testing.assert_allclose(chol.getInverseOperationalSpaceInertiaMatrix(), G.matrix())
    np.testing.assert_allclose(chol.inverse() @ chol.matrix(), np.eye(9), atol=1e-9)
    pin.computeAllTerms(model, data, -q, v)
    chol.compute(model, data, [held], [known], 0.1)
    assert chol != first and np.abs(first.inverse() @ first.matrix() - np.eye(9)).max() < 1e-9
    held.joint1_id = 5
    chol.compute(model, data, [held], [known], np.array([0.3, 0.1, 0.2]))
    np.testing.assert_allclose(chol.inverse() @ chol.matrix(), np.eye(9), atol=1e-9)
    assert not chol.matrix()[:3, 8].any()  # the last joint moves nothing that is held
    with pytest.raises(InputError, match="not below zero"):
        chol.updateDamping(-1.0)
    with pytest.raises(ShapeError):
        chol.solve(np.ones(8))


def test_settings_are_checked(pin: Any) -> None:
    for wrong in ((1e-12, -1.0, 3), (1e-12, np.inf, 3), (1e-12, 1e-6, 0), (-1.0, 1e-6, 3), (1e-12, 1e-6)):
        with pytest.raises(InputError):
            pin.ProximalSettings(*wrong)
    assert repr(pin.ProximalSettings(1e-12, 0.25, 12)) == "ProximalSettings(1e-12, 1e-12, 0.25, 12)"
    assert pin.ProximalSettings(accuracy=1e-9, mu=0.5, max_iter=2).relative_accuracy == 1e-9


def test_constraints_that_depend_on_each_other(pin: Any) -> None:
    """Without damping nothing is nan, and where answers are not unique, it is said."""
    model, data, q, v, held = _arm(pin)
    twice, known = [held, held], [held.createData(), held.createData()]
    once = pin.constraintDynamics(model, data, q, v, v, [held], [known[0]])
    np.testing.assert_allclose(pin.constraintDynamics(model, data, q, v, v, twice, known), once, atol=1e-6)
    with pytest.raises(InputError, match="depend on each other"):
        pin.computeConstraintDynamicsDerivatives(model, data, twice, known)
    with pytest.raises(InputError, match="depend on each other"):
        data.constraint_chol.inverse()
    with pytest.raises(InputError, match="rank 1"):
        pin.forwardDynamics(model, data, q, v, v, np.ones((2, 6)), np.zeros(2))
    settings = pin.ProximalSettings(1e-10, 1e-6, 50)
    again = pin.constraintDynamics(model, data, q, v, v, twice, known, settings)
    np.testing.assert_allclose(again, once, atol=1e-6)
    assert 1 < settings.iter < 50 and settings.absolute_residual <= 1e-10
    np.testing.assert_allclose(known[0].contact_force.vector, known[1].contact_force.vector, atol=1e-6)


def test_a_place_in_the_world_can_be_moved_without_compiling_anew(pin: Any) -> None:
    model, data, q, v, held = _arm(pin)
    known = held.createData()
    held.m_baumgarte_parameters.Kp = 100.0
    for _ in range(2):  # the first call compiles nothing
        pin.constraintDynamics(model, data, q, v, v, [held], [known])
    before, kernels = data.ddq.copy(), len(model._compiled().cache)
    held.joint2_placement.translation[0] = 0.3
    assert known.oMc2.translation[0] == 0.0  # as it was then
    pin.constraintDynamics(model, data, q, v, v, [held], [known])
    assert known.oMc2.translation[0] == 0.3
    assert np.abs(data.ddq - before).max() > 1e-3 and len(model._compiled().cache) == kernels + 1


def test_a_kernel_serves_until_something_changes(pin: Any) -> None:
    """Kinds of constraints, numbers of the model, other data, a copy: each is noticed at the next call."""
    model, data, q, v, held = _arm(pin)
    known = held.createData()

    # A first call is evaluated without a kernel, and differs by rounding.
    def solved(model: Any, data: Any, known: Any) -> Any:
        found = pin.constraintDynamics(model, data, q, v, v, [held], [known])
        fresh = held.createData()
        expected = pin.constraintDynamics(model, model.createData(), q, v, v, [held], [fresh])
        np.testing.assert_allclose(found, expected, atol=1e-10)
        np.testing.assert_allclose(known.contact_force.vector, fresh.contact_force.vector, atol=1e-10)
        return found.copy()

    first = solved(model, data, known)
    held.reference_frame = pin.LOCAL
    np.testing.assert_allclose(solved(model, data, known), first, atol=1e-9)
    copied = copy.deepcopy(data)
    before = pin.computeConstraintDynamicsDerivatives(model, data, [held], [known])
    held.joint1_id = 3
    assert np.abs(solved(model, data, known) - first).max() > 1e-3
    held.joint1_id = 6
    for mine, theirs in zip(
        pin.computeConstraintDynamicsDerivatives(model, copied, [held], [known]), before, strict=True
    ):
        np.testing.assert_allclose(mine, theirs, atol=1e-10)
    solved(model, copied, known)
    model.inertias[6] = pin.Inertia.FromSphere(3.0, 0.1)
    assert np.abs(solved(model, data, known) - first).max() > 1e-3
    np.testing.assert_array_equal(
        pin.constraintDynamics(model, data, q.tolist(), v.tolist(), v.tolist(), [held], [known]), data.ddq
    )


def test_no_constraints_leave_the_robot_free(pin: Any) -> None:
    model, data, q, v, _ = _arm(pin)
    free = pin.aba(model, data, q, v, v)
    np.testing.assert_array_equal(pin.constraintDynamics(model, data, q, v, v, [], []), free)
    np.testing.assert_array_equal(pin.impulseDynamics(model, data, q, v, [], []), v)


def test_an_impact_of_two_bodies_stops_what_lies_between_them(pin: Any) -> None:
    """There the velocity of the second body is not counted."""
    model, data, q, v, _ = _arm(pin)
    joined = pin.RigidConstraintModel(
        pin.ContactType.CONTACT_3D, model, 6, pin.SE3.Identity(), 2, pin.SE3.Identity()
    )
    after = pin.impulseDynamics(model, data, q, v, [joined], [joined.createData()])
    J = pin.getConstraintJacobian(model, data, joined, joined.createData())
    assert np.abs(J @ v).max() > 1e-2 and np.abs(J @ after).max() < 1e-9
    with pytest.raises(InputError, match="from 0 to 1"):
        pin.impulseDynamics(model, data, q, v, [joined], [joined.createData()], 1.5)


def test_operators_take_numbers_that_make_sense(pin: Any) -> None:
    G = pin.DelassusOperatorDense(np.diag([2.0, 3.0]))
    G.updateDamping(0.5)
    G.updateCompliance([0.5, 1.0])
    np.testing.assert_allclose(G.matrix(), np.diag([3.0, 4.5]))
    np.testing.assert_allclose(G.matrix(False, False), np.diag([2.5, 4.0]))
    np.testing.assert_allclose(G * [1.0, 1.0], [3.0, 4.5])
    np.testing.assert_allclose(G.solve([3.0, 9.0]), [1.0, 2.0])
    np.testing.assert_allclose(G.inverse() @ G.matrix(), np.eye(2))
    with pytest.raises(InputError, match="not below zero"):
        G.updateDamping(-1.0)
    with pytest.raises(ShapeError):
        G.solve(np.ones(3))
    with pytest.raises(ShapeError):
        pin.DelassusOperatorDense(np.ones((2, 3)))
    with pytest.raises(InputError, match="sparse matrix"):
        pin.DelassusOperatorSparse(np.eye(2))


def test_contacts_that_push_and_rub(pin: Any) -> None:
    """The impulses are within friction, what touches does not sink, and the convex problem is another one."""
    model, data, q, v, _ = _arm(pin)
    ground = pin.PointContactConstraintModel(model, 0, pin.SE3.Identity(), 6, pin.SE3.Identity())
    limit = pin.JointLimitConstraintModel(model, [2], np.full(6, -9.0), np.full(6, 9.0), np.ones(6))
    with pytest.raises(ShapeError, match="`vec`"):
        limit.setCompliance(np.zeros(limit.residualSize() + 1))
    held = pin.PointAnchorConstraintModel(model, 4)
    models = [ground, limit, held]
    datas = [one.createData() for one in models]
    pin.forwardKinematics(model, data, q, v)
    pin.crba(model, data, q)
    for one, known in zip(models, datas, strict=True):
        one.calc(model, data, known)
    decomposition = pin.ConstraintCholeskyDecomposition(model, data, models, datas)
    decomposition.compute(model, data, models, datas, 1e-3)
    G = decomposition.getDelassusOperatorCholeskyExpression()
    g = pin.getConstraintsJacobian(model, data, models, datas) @ v - np.array(
        [0.3, 0.2, 1.0, 1.0, 0.0, 0, 0, 0]
    )
    settings, result, solver = pin.PGSSolverSettings(), pin.PGSSolverResult(), pin.PGSConstraintSolver()
    settings.max_iterations = 20_000
    settings.relative_feasibility_tol = settings.relative_complementarity_tol = 0.0
    settings.absolute_feasibility_tol = settings.absolute_complementarity_tol = 1e-10
    with pytest.raises(InputError, match="solve"):
        result.retrieveConstraintImpulses()
    assert solver.solve(G, g, models, datas, settings, result)
    x, y = result.retrieveConstraintImpulses(), result.retrieveConstraintVelocities()
    np.testing.assert_allclose(G.matrix() @ x + g, y, atol=1e-8)
    np.testing.assert_allclose(ground.set(datas[0]).project(x[:3]), x[:3], atol=1e-9)
    assert x[2] > 0.0 and y[2] > -1e-9
    assert min(x[3], x[4]) >= 0.0 and y[3] > -1e-9 and np.abs(y[5:]).max() < 1e-9
    again = pin.PGSSolverResult()
    again.setConstraintImpulseGuess(x)
    assert solver.solve(G, g, models, datas, settings, again) and again.iterations <= 1
    settings.solve_ncp = False
    assert solver.solve(G, g, models, datas, settings, again)
    settings.over_relaxation = 2.5
    with pytest.raises(InputError, match="below 2"):
        solver.solve(G, g, models, datas, settings, result)
    settings.over_relaxation = 1.0
    with pytest.raises(ShapeError, match="as many rows"):
        solver.solve(np.eye(3), g[:3], models, datas, settings, result)


def test_forces_of_contacts_whose_motion_is_given(pin: Any) -> None:
    model, data, q, v, _ = _arm(pin)
    ground = pin.PointContactConstraintModel(model, 0, pin.SE3.Identity(), 6, pin.SE3.Identity())
    known = ground.createData()
    with pytest.raises(InputError, match="not unique"):
        pin.contactInverseDynamics(
            model, data, q, v, v, 1e-2, [ground], [known], np.zeros(3), pin.ProximalSettings()
        )
    with pytest.raises(InputError, match="time step"):
        pin.contactInverseDynamics(
            model, data, q, v, v, 0.0, [ground], [known], np.zeros(3), pin.ProximalSettings()
        )
    with pytest.raises(InputError, match="PointContactConstraintModel"):
        pin.computeInverseDynamicsConstraintForces(np.zeros(3), ["ground"], [known])
    ground.setCompliance(np.full(3, 0.1))
    settings = pin.ProximalSettings(1e-12, 1e-9, 200)
    done, forces = pin.computeInverseDynamicsConstraintForces(
        [0.01, 0.0, -1.0], [ground], [known], None, settings
    )
    assert done
    np.testing.assert_allclose(forces, [-0.1, 0.0, 10.0], atol=1e-9)  # sticks: c + R f = 0
    done, forces = pin.computeInverseDynamicsConstraintForces(
        [3.0, 0.0, -1.0], [ground], [known], None, settings
    )
    assert done and np.hypot(*forces[:2]) == pytest.approx(0.5 * forces[2])  # slides


def test_data_and_places_of_the_newer_constraints(pin: Any) -> None:
    model, data, q, v, _ = _arm(pin)
    anchor = pin.PointAnchorConstraintModel(model, 6, pin.SE3.Random(), 2, pin.SE3.Identity())
    known = anchor.createData()
    with pytest.raises(InputError, match="forwardKinematics"):
        anchor.calc(model, data, known)
    pin.forwardKinematics(model, data, q, v)
    with pytest.raises(InputError, match="calc"):
        anchor.jacobian(model, data, known)
    with pytest.raises(InputError, match="createData"):
        anchor.calc(model, data, pin.FrameAnchorConstraintModel(model, 6).createData())
    anchor.calc(model, data, known)
    other = anchor.copy()
    other.joint1_placement = pin.SE3.Identity()
    assert not np.allclose(other.joint1_placement.homogeneous, anchor.joint1_placement.homogeneous)
    with pytest.raises(InputError, match="each once"):
        pin.JointFrictionConstraintModel(model, [1, 1])
    with pytest.raises(InputError, match="not below zero"):
        pin.CoulombFrictionCone(-0.1)
    with pytest.raises(InputError, match="are above"):
        pin.BoxSet([1.0], [0.0])
    flying = pin.Model()
    flying.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root")
    assert pin.JointLimitConstraintModel(flying).residualSize() == 0  # it has no limits


def test_sets_of_forces(pin: Any) -> None:
    """There cones read freed memory when they are made from Python; here they are what they say."""
    cone = pin.CoulombFrictionCone(0.5)
    np.testing.assert_allclose(cone.project([2.0, 0.0, 1.0]), [0.8, 0.0, 1.6])
    np.testing.assert_allclose(cone.computeRadialProjection([3.0, 4.0, 2.0]), [0.6, 0.8, 2.0])
    np.testing.assert_allclose(cone.computeNormalCorrection([3.0, 4.0, 9.0]), [0.0, 0.0, 2.5])
    np.testing.assert_allclose(cone.weightedProject([2.0, 0.0, 1.0], [1.0, 1.0, 1.0]), [0.8, 0.0, 1.6])
    np.testing.assert_allclose(cone.dual().project([0.0, 0.0, -1.0]), 0.0)
    assert cone.isInside([0.4, 0.0, 1.0]) and not cone.isInside([0.6, 0.0, 1.0])
    assert cone == pin.CoulombFrictionCone(cone) and cone.dual().dual() == cone != pin.CoulombFrictionCone(
        0.6
    )
    box = pin.BoxSet([-1.0, 0.0], [1.0, 2.0])
    np.testing.assert_array_equal(box.project([3.0, -3.0]), [1.0, 0.0])
    assert box.isInside([0.0, 1.0]) and box.copy() == box
    np.testing.assert_array_equal(pin.NonNegativeOrthantCone().project([-1.0, 2.0]), [0.0, 2.0])
    np.testing.assert_array_equal(pin.FullSpaceCone().dual().project([-1.0, 2.0]), [0.0, 0.0])
    with pytest.raises(InputError, match="first two equal"):
        cone.weightedProject([2.0, 0.0, 1.0], [1.0, 2.0, 1.0])


@pytest.mark.parametrize("count", [1, 5])
def test_damped_inverses_of_delassus_matrices_are_inverses(pin: Any, count: int) -> None:
    """For matrices that a kernel inverts, and for larger ones, which LAPACK does."""
    model, data, q, _, _ = _arm(pin)
    frames = [pin.SE3(np.eye(3), np.array([0.1 * k, 0.0, 0.2])) for k in range(count)]
    models = [pin.RigidConstraintModel(pin.ContactType.CONTACT_6D, model, 6, frame) for frame in frames]
    datas = [one.createData() for one in models]
    G = pin.computeDelassusMatrix(model, data, q, models, datas)
    assert G.shape == (6 * count, 6 * count)
    for mu in (1e-2, 3.0):
        inverse = pin.computeDampedDelassusMatrixInverse(model, data, q, models, datas, mu)
        np.testing.assert_allclose(inverse @ (G + mu * np.eye(len(G))), np.eye(len(G)), atol=1e-8)
        scaled = pin.computeDampedDelassusMatrixInverse(model, data, q, models, datas, mu, True)
        np.testing.assert_allclose(scaled, mu * inverse, rtol=1e-12, atol=1e-9)


def test_calls_with_a_jacobian_are_the_same_when_repeated() -> None:
    with using("pinocchio"):
        import pinocchio as pin

        model = pin.buildSampleModelManipulator()
        data, rng = model.createData(), np.random.default_rng(2)
        for k in range(6):
            if k == 3:
                model.inertias[3].mass = 4.0
            q, v, tau = rng.uniform(-1.0, 1.0, (3, model.nv))
            J, drift = rng.normal(size=(2 + (k == 5), model.nv)), rng.normal(size=2 + (k == 5))
            fresh = model.createData()
            M, h = pin.crba(model, fresh, q).copy(), pin.nonLinearEffects(model, fresh, q, v)
            zeros = np.zeros((len(J), len(J)))
            K = np.block([[M, J.T], [J, zeros]])
            for _ in range(2):
                x = np.linalg.solve(K, np.concatenate([tau - h, -drift]))
                a = pin.forwardDynamics(model, data, q, v, tau, J, drift)
                np.testing.assert_allclose(a, x[: model.nv], atol=1e-7)
                np.testing.assert_allclose(data.lambda_c, -x[model.nv :], atol=1e-7)
                np.testing.assert_allclose(pin.forwardDynamics(model, data, tau, J, drift), a, atol=1e-7)
                inverse = pin.getKKTContactDynamicMatrixInverse(model, data, J)
                np.testing.assert_allclose(inverse @ K, np.eye(len(K)), atol=1e-7)
                damped = pin.computeKKTContactDynamicMatrixInverse(model, data, q, J, 0.1)
                with_damping = K - np.diag([0.0] * model.nv + [0.1] * len(J))
                np.testing.assert_allclose(damped @ with_damping, np.eye(len(K)), atol=1e-8)
                after = pin.impulseDynamics(model, data, q, v, J)
                x = np.linalg.solve(K, np.concatenate([M @ v, np.zeros(len(J))]))
                np.testing.assert_allclose(after, x[: model.nv], atol=1e-7)
                np.testing.assert_allclose(pin.impulseDynamics(model, data, v, J), after, atol=1e-7)
            with pytest.raises(ValueError, match="constraint_jacobian"):
                pin.forwardDynamics(model, data, q, v, tau, J[:, 1:], drift)
            with pytest.raises(ValueError, match="v"):
                pin.impulseDynamics(model, data, v[1:], J)
