"""What constraints of all kinds share: variants, comparison, rows, and limits of floating joints."""

from __future__ import annotations

import pickle
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using


@pytest.fixture(scope="module")
def pin() -> Iterator[Any]:
    with using("pinocchio"):
        import pinocchio

        yield pinocchio


@pytest.fixture(scope="module")
def model(pin: Any) -> Any:
    return pin.buildSampleModelHumanoid()


def _all(pin: Any, model: Any) -> list[Any]:
    here = pin.SE3.Identity()
    return [
        pin.PointContactConstraintModel(model, 3, here, 5, here),
        pin.PointAnchorConstraintModel(model, 3, here),
        pin.FrameAnchorConstraintModel(model, 3, here, 5, here),
        pin.JointLimitConstraintModel(model, [3, 4]),
        pin.JointFrictionConstraintModel(model, [3, 4]),
    ]


def test_a_constraint_of_any_kind_is_a_constraint_model(pin: Any, model: Any) -> None:
    for one in _all(pin, model):
        variant = pin.ConstraintModel(one)
        assert isinstance(variant, pin.ConstraintModel) and variant is not one and variant == one
        assert variant.shortname() == type(one).__name__ == type(one).classname()
        assert str(variant) == f"{type(one).__name__}\n" and type(variant.extract()) is type(one)
        data = variant.createData()
        assert isinstance(data, pin.ConstraintData) and data == one.createData()
        assert data.shortname() == type(one).__name__.replace("Model", "Data") == type(data).classname()
        assert pin.ConstraintData(data).extract() == data
    with pytest.raises(TypeError, match="nothing"):
        pin.ConstraintData()
    with pytest.raises(TypeError, match="expected one object"):
        pin.ConstraintModel(model)


def test_constraints_are_compared_by_what_they_hold(pin: Any, model: Any) -> None:
    def contact() -> Any:
        return pin.PointContactConstraintModel(model, 3)

    assert contact() == contact() and contact() != pin.PointAnchorConstraintModel(model, 3)
    for change in (
        lambda c: c.setFriction(0.1),
        lambda c: setattr(c, "name", "other"),
        lambda c: c.setCompliance(np.ones(3)),
        lambda c: setattr(c, "desired_constraint_offset", np.ones(3)),
        lambda c: setattr(c, "joint1_placement", pin.SE3.Random()),
        lambda c: setattr(c.baumgarte_corrector_parameters, "Kp", 2.0),
    ):
        other = contact()
        change(other)
        assert other != contact()
    limits = pin.JointLimitConstraintModel(model, [3])
    assert limits == limits.copy() and limits != pin.JointLimitConstraintModel(model, [4])


def test_constraints_and_their_data_are_kept_in_files(pin: Any, model: Any, tmp_path: Path) -> None:
    data = model.createData()
    pin.forwardKinematics(model, data, pin.randomConfiguration(model), np.ones(model.nv))
    for one in _all(pin, model):
        known = one.createData()
        one.calc(model, data, known)
        for thing, fresh in ((one, one.copy()), (known, one.createData())):
            fresh.loadFromString(thing.saveToString())
            assert fresh == thing
            thing.saveToBinary(tmp_path / "kept")
            fresh.loadFromBinary(tmp_path / "kept")
            assert fresh == thing and pickle.loads(pickle.dumps(thing)) == thing
    anchor = pin.PointAnchorConstraintModel(model, 3)
    read = pickle.loads(pickle.dumps(anchor))
    read.joint1_placement.translation = np.ones(3)  # what algorithms read is what users write
    pin.forwardKinematics(model, data, pin.neutral(model))
    known = read.createData()
    read.calc(model, data, known)
    np.testing.assert_allclose(known.oMc1.translation, data.oMi[3].act(np.ones(3)))
    with pytest.raises(ValueError, match="holds a PointAnchorConstraintModel"):
        pin.JointLimitConstraintModel(model).loadFromString(anchor.saveToString())


def test_matrices_of_the_joints_make_the_jacobian(pin: Any, model: Any) -> None:
    data = model.createData()
    q, v = pin.randomConfiguration(model), np.linspace(-1.0, 1.0, model.nv)
    pin.computeJointJacobians(model, data, q)
    pin.forwardKinematics(model, data, q, v)
    for one in _all(pin, model)[:3]:
        known = one.createData()
        assert not known.A1_local.any()
        one.calc(model, data, known)
        for frame in (pin.LOCAL, pin.WORLD, pin.LOCAL_WORLD_ALIGNED):
            moved = [pin.getVelocity(model, data, k, frame) for k in range(model.njoints)]
            given = one.mapJointSpaceToConstraintMotion(model, data, known, moved, v, frame)
            np.testing.assert_allclose(given, one.jacobian(model, data, known) @ v, atol=1e-12)
            forces = [pin.Force.Zero() for _ in range(model.njoints)]
            pushed = np.arange(1.0, one.residualSize() + 1.0)
            assert not one.mapConstraintForceToJointSpace(model, data, known, pushed, forces, frame).any()
            power = sum(f.vector @ u.vector for f, u in zip(forces, moved, strict=True))
            assert power == pytest.approx(pushed @ given)
        with pytest.raises(ValueError, match="one for each joint"):
            one.mapConstraintForceToJointSpace(model, data, known, pushed, forces[1:])
        with pytest.raises(TypeError, match="createData"):
            one.getA1(pin.JointLimitConstraintModel(model).createData(), pin.LOCAL)
        if one.joint1_id and one.joint2_id:
            with pytest.raises(ValueError, match="between them is a workspace"):
                one.appendCouplingConstraintInertias(model, data, known, pushed)
    weights = np.array([1.0, 2.0, 3.0])
    inertia = _all(pin, model)[0].computeConstraintSpatialInertia(pin.SE3.Random(), weights)
    np.testing.assert_allclose(np.linalg.eigvalsh(inertia)[:3], 0.0, atol=1e-12)
    assert inertia.shape == (6, 6) and np.trace(inertia[:3, :3]) == pytest.approx(6.0)


def test_data_of_other_constraints_and_incomplete_places_are_refused(pin: Any, model: Any) -> None:
    data, here = model.createData(), pin.SE3.Identity()
    pin.forwardKinematics(model, data, pin.neutral(model))
    everything = _all(pin, model)
    for one, other in zip(everything, everything[1:] + everything[:1], strict=True):
        for call in (one.jacobian, one.calc, lambda *known, one=one: one.getRowIndexes(*known, 0)):
            with pytest.raises(TypeError, match="createData"):
                call(model, data, other.createData())
        with pytest.raises(TypeError, match=type(one).__name__):
            type(one.createData())(other)
    for kind in everything[:3]:
        assert type(kind)(model).joint1_id == 0
        with pytest.raises(TypeError, match="two joints"):
            type(kind)(model, 2, here, 3)
    for solver in (pin.PGSConstraintSolver, pin.ADMMConstraintSolver):
        with pytest.raises(OverflowError, match="problem_size"):
            solver(-1)
    with pytest.raises(OverflowError, match="max_iterations"):
        pin.ADMMSolverStats(-1)
    with pytest.raises(TypeError, match="complex128"):
        pin.getKKTContactDynamicMatrixInverse(model, data, np.ones((2, model.nv)) + 1j)


def test_inertias_of_rows_are_added_to_the_joint_that_is_held(pin: Any, model: Any) -> None:
    data, q = model.createData(), pin.neutral(model)
    pin.forwardKinematics(model, data, q)
    for kind in (pin.PointAnchorConstraintModel, pin.FrameAnchorConstraintModel):
        one = kind(model, 3, pin.SE3(pin.exp3(np.array([0.1, 0.2, 0.3])), np.ones(3)))
        known, weights = one.createData(), np.arange(1.0, one.residualSize() + 1.0)
        one.calc(model, data, known)
        for frame, A in ((pin.LOCAL, known.A1_local), (pin.WORLD, known.A1_world)):
            before = data.oYaba_augmented[3].copy()
            one.appendCouplingConstraintInertias(model, data, known, weights, frame)
            np.testing.assert_allclose(
                data.oYaba_augmented[3] - before, A.T @ np.diag(weights) @ A, atol=1e-12
            )
        empty = type(known)()
        one.calc(model, data, empty)
        np.testing.assert_array_equal(empty.constraint_position_error, known.constraint_position_error)
    other = pin.buildSampleModelManipulator()
    elsewhere = other.createData()
    pin.forwardKinematics(other, elsewhere, pin.neutral(other))
    for one in (pin.JointFrictionConstraintModel(model, [2]), pin.JointLimitConstraintModel(model, [2])):
        with pytest.raises(ValueError, match="was made for a model of"):
            one.calc(other, elsewhere, one.createData())
    with pytest.raises(TypeError, match="createData"):
        pin.PointContactConstraintModel(model, 3).set(3)


def test_fields_of_the_way_to_a_result_are_refused_once_used(pin: Any, model: Any) -> None:
    data, q, v = model.createData(), pin.neutral(model), np.zeros(model.nv)
    rigid = pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, model, 3)
    known = rigid.createData()
    assert data.lambda_c_prox.shape == (0,) and not np.array(known.lambdas_joint1).any()
    pin.initConstraintDynamics(model, data, [rigid], [known])
    assert data.primal_dual_contact_solution.shape == (3 + model.nv,) and data.dvc_dq.shape == (3, model.nv)
    pin.constraintDynamics(model, data, q, v, v, [rigid], [known], pin.ProximalSettings(1e-9, 1e-6, 4))
    pin.computeDampedDelassusMatrixInverse(model, data, q, [rigid], [known], 1e-3)
    assert np.isfinite(data.lambda_c_prox).all() and np.isfinite(data.oK[3]).all()
    for name in ("contact1_acceleration_drift", "extended_motion_propagators_joint1"):
        with pytest.raises(ValueError, match="intermediate result"):
            getattr(known, name)
    assert not known.contact_acceleration_deviation.vector.any()
    pin.computeConstraintDynamicsDerivatives(model, data, [rigid], [known])
    assert data.dFdq.any() and data.dvc_dq.shape == (3, model.nv)
    pin.impulseDynamics(model, data, q, v, [rigid], [known])
    pin.computeImpulseDynamicsDerivatives(model, data, [rigid], [known])
    with pytest.raises(ValueError, match="intermediate result"):
        _ = data.dlambda_dtau


@pytest.mark.parametrize(
    ("size", "axes", "second"),
    [
        (3, "LOCAL", 0),
        (6, "LOCAL", 0),
        (3, "LOCAL_WORLD_ALIGNED", 0),
        (6, "LOCAL_WORLD_ALIGNED", 0),
        (6, "LOCAL", 13),
        (3, "LOCAL_WORLD_ALIGNED", 13),
        (6, "LOCAL_WORLD_ALIGNED", 13),
    ],
)
def test_velocities_along_constraints_change_by_q_as_differences_say(
    pin: Any, size: int, axes: str, second: int
) -> None:
    """`dvc_dq` is J(q) v by q; but for local points of two bodies, whose velocities turn with their own, as there."""
    model = pin.buildSampleModelHumanoidRandom()
    data, other = model.createData(), model.createData()
    kind = pin.ContactType.CONTACT_6D if size == 6 else pin.ContactType.CONTACT_3D
    M = pin.SE3(pin.exp3(np.array([0.3, 0.2, -0.5])), np.array([0.1, 0.2, 0.3]))
    ends = (second, M.inverse()) if second else ()
    one = pin.RigidConstraintModel(kind, model, 7, M, *ends, getattr(pin, axes))
    q = pin.integrate(model, pin.neutral(model), np.linspace(-0.7, 0.9, model.nv))
    v, tau = np.linspace(-1.0, 1.0, model.nv), np.zeros(model.nv)

    def along(x: Any) -> Any:
        pin.computeJointJacobians(model, other, x)
        return pin.getConstraintJacobian(model, other, one, one.createData()) @ v

    steps = 1e-6 * np.eye(model.nv)
    wanted = [(along(pin.integrate(model, q, e)) - along(pin.integrate(model, q, -e))) / 2e-6 for e in steps]
    known = one.createData()
    settings = pin.ProximalSettings(1e-12, 0.0, 1)
    pin.initConstraintDynamics(model, data, [one], [known])
    pin.constraintDynamics(model, data, q, v, tau, [one], [known], settings)
    pin.computeConstraintDynamicsDerivatives(model, data, [one], [known], settings)
    np.testing.assert_allclose(data.dvc_dq, np.transpose(wanted), atol=2e-8)
    kept = data.dac_dq.copy()
    data.dvc_dq[...] = 0.0
    pin.impulseDynamics(model, data, q, v, [one], [known], 0.3, settings)
    pin.computeImpulseDynamicsDerivatives(model, data, [one], [known], 0.3, settings)
    np.testing.assert_allclose(data.dvc_dq, np.transpose(wanted), atol=2e-8)
    np.testing.assert_array_equal(data.dac_dq, kept)  # an impact leaves what it was


def test_friction_has_no_gains_and_rigid_constraints_no_compliance(pin: Any, model: Any) -> None:
    friction = pin.JointFrictionConstraintModel(model, [3])
    with pytest.raises(RuntimeError, match="no drift"):
        friction.setBaumgarteCorrectorParameters(pin.BaumgarteCorrectorParameters(1.0, 2.0))
    rigid = pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, model, 3)
    assert not rigid.retrieveCompliance().any()
    with pytest.raises(AttributeError, match="contact_force"):
        rigid.createData().contact_forse


def test_rows_say_which_velocities_move_them(pin: Any, model: Any) -> None:
    data = model.createData()
    pin.forwardKinematics(model, data, pin.neutral(model))
    sizes = {}
    for one in _all(pin, model):
        known = one.createData()
        one.calc(model, data, known)
        J = one.jacobian(model, data, known)
        for row in range(one.residualSize()):
            pattern = one.getRowSparsityPattern(model, data, known, row)
            assert pattern.shape == (model.nv,) and pattern[J[row] != 0.0].all() and not pattern.all()
            assert list(one.getRowIndexes(model, data, known, row)) == list(np.flatnonzero(pattern))
        with pytest.raises(IndexError, match="residualSize"):
            one.getRowSparsityPattern(model, data, known, one.residualSize())
        sizes[one.shortname()[:10]] = one.symmetricConeResidualSize()
    assert list(sizes.values()) == [3, 0, 0, 4, 4]  # Pinocchio's


def test_the_set_of_a_contact_can_be_assigned(pin: Any, model: Any) -> None:
    contact = pin.PointContactConstraintModel(model, 3)
    contact.set = pin.CoulombFrictionCone(0.4)
    assert contact.getFriction() == contact.set.mu == contact.set(contact.createData()).mu == 0.4
    with pytest.raises(TypeError, match="CoulombFrictionCone"):
        contact.set = 0.4


def test_anchors_may_hold_nothing(pin: Any, model: Any) -> None:
    data = model.createData()
    pin.forwardKinematics(model, data, pin.neutral(model), np.ones(model.nv))
    for kind in (
        pin.PointAnchorConstraintModel,
        pin.FrameAnchorConstraintModel,
        pin.PointContactConstraintModel,
    ):
        anchor = kind(model, 0)
        known = anchor.createData()
        anchor.calc(model, data, known)
        assert not anchor.jacobian(model, data, known).any() and not known.constraint_velocity_error.any()


def test_limits_of_floating_joints_are_rates_of_their_positions(pin: Any) -> None:
    model = pin.Model()
    last = 0
    for k, kind in enumerate(
        (pin.JointModelFreeFlyer, pin.JointModelRX, pin.JointModelPlanar, pin.JointModelSpherical)
    ):
        last = model.addJoint(last, kind(), pin.SE3.Random(), f"joint {k}")
    model.lowerPositionLimit[:], model.upperPositionLimit[:] = -1.0, 2.0
    limits, data = pin.JointLimitConstraintModel(model), model.createData()
    assert (limits.residualSize(), limits.lowerResidualSize()) == (12, 6)
    assert list(limits.getSelectedJoints()) == [1, 2, 3]
    assert (limits.getNqReduce(), limits.getMaxOfNvs()) == (12, 6)
    known, q = limits.createData(), pin.randomConfiguration(model)
    with pytest.raises(Exception, match="calc"):
        limits.jacobian(model, data, known)
    other = pin.Model()
    other.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), "one")
    with pytest.raises(Exception, match=f"was made for a model of {model.nv} velocities, not 1"):
        limits.jacobian(other, other.createData(), known)
    pin.forwardKinematics(model, data, q)
    limits.calc(model, data, known)
    J, before, v = (
        limits.jacobian(model, data, known),
        known.constraint_residual.copy(),
        np.linspace(-1, 1, model.nv),
    )
    pin.forwardKinematics(model, data, pin.integrate(model, q, 1e-7 * v))
    limits.calc(model, data, known)
    np.testing.assert_allclose((known.constraint_residual - before) / 1e-7, J @ v, atol=1e-6)


def test_infinite_limits_have_no_row(pin: Any, model: Any) -> None:
    assert pin.JointLimitConstraintModel(model, [1]).residualSize() == 0
    assert pin.JointLimitConstraintModel(model).residualSize() == 56  # as in Pinocchio


def _problem(pin: Any, model: Any) -> tuple[Any, ...]:
    """Two contacts, an anchor, a limit and a friction, with a Delassus matrix that couples all."""
    kinds = [pin.PointContactConstraintModel(model, 8), pin.PointContactConstraintModel(model, 14)]
    kinds += [pin.PointAnchorConstraintModel(model, 10), pin.JointLimitConstraintModel(model, [3])]
    kinds.append(pin.JointFrictionConstraintModel(model, [5]))
    kinds[0].setFriction(0.4)
    kinds[4].setFrictionLowerLimit([-0.1])
    kinds[4].setFrictionUpperLimit([0.2])
    data = model.createData()
    pin.forwardKinematics(model, data, pin.neutral(model))
    known = [one.createData() for one in kinds]
    for one, its in zip(kinds, known, strict=True):
        one.calc(model, data, its)
    size = sum(one.residualSize() for one in kinds)
    rng = np.random.default_rng(2)
    A = rng.normal(size=(size, size))
    g = rng.normal(size=size)
    g[[2, 5]] = -1.0, -2.0
    return A @ A.T + 0.1 * np.eye(size), g, kinds, known


@pytest.mark.parametrize("sliding", [True, False])
@pytest.mark.parametrize("rule", ["OSQP", "SPECTRAL", "LINEAR", "CONSTANT"])
def test_alternating_directions_find_admissible_impulses(
    pin: Any, model: Any, rule: str, sliding: bool
) -> None:
    G, g, kinds, known = _problem(pin, model)
    settings, result = pin.ADMMSolverSettings(), pin.ADMMSolverResult()
    settings.absolute_feasibility_tol = settings.absolute_complementarity_tol = 1e-9
    settings.relative_feasibility_tol = settings.relative_complementarity_tol = 0.0
    settings.max_iterations, settings.solve_ncp, settings.stat_record = 20000, sliding, True
    settings.admm_update_rule = getattr(pin.ADMMUpdateRule, rule)
    solver = pin.ADMMConstraintSolver(len(g))
    assert solver.solve(pin.DelassusOperatorDense(G), g, kinds, known, settings, result) and solver.isValid()
    x, y, s = result.retrieveConstraintImpulses(), result.retrieveConstraintVelocities(), np.zeros(len(g))
    result.retrieveDesaxceTerm(s)
    np.testing.assert_allclose(y, G @ x + g, atol=1e-6)
    for at, one in ((0, kinds[0]), (3, kinds[1])):
        rows = slice(at, at + 3)
        np.testing.assert_allclose(one.set.project(x[rows]), x[rows], atol=1e-7)
        assert abs(x[rows] @ (y + s)[rows]) < 1e-8
        np.testing.assert_allclose(one.set.dual().project((y + s)[rows]), (y + s)[rows], atol=1e-7)
        shift = one.set.computeNormalCorrection(y[rows]) if sliding else np.zeros(3)
        np.testing.assert_allclose(s[rows], shift, atol=1e-12)
    np.testing.assert_allclose(y[6:9], 0.0, atol=1e-8)
    assert x[9:11].min() >= 0.0 and (y[9:11] >= -1e-8).all() and np.abs(x[9:11] * y[9:11]).max() < 1e-8
    assert -0.1 <= x[11] <= 0.2 and (abs(y[11]) < 1e-7 or x[11] in (-0.1, 0.2))
    stats = solver.stats
    assert stats.delassus_decomposition_update_count == result.delassus_decomposition_update_count
    assert max(stats.linear_system_residual) < 1e-9 and not any(stats.anderson_size)
    assert solver.stats.size() == result.iterations + 1 and solver.stats.rho[-1] == result.rho
    assert (solver.stats.rho[0] == result.rho) == (
        rule == "CONSTANT" or result.delassus_decomposition_update_count == 2
    )


def test_both_solvers_agree_and_start_from_guesses(pin: Any, model: Any) -> None:
    G, g, kinds, known = _problem(pin, model)
    impulses = []
    for name in ("PGS", "ADMM"):
        settings, result = getattr(pin, f"{name}SolverSettings")(), getattr(pin, f"{name}SolverResult")()
        settings.absolute_feasibility_tol = settings.absolute_complementarity_tol = 1e-9
        settings.relative_feasibility_tol = settings.relative_complementarity_tol = 0.0
        settings.max_iterations, settings.solve_ncp = 5000, True
        solver = getattr(pin, f"{name}ConstraintSolver")()
        assert solver.solve(G, g, kinds, known, settings, result)
        impulses.append(result.retrieveConstraintImpulses())
    np.testing.assert_allclose(*impulses, atol=1e-7)
    iterations = result.iterations
    result.setConstraintImpulseGuess(impulses[1])
    settings.warmstart_rho_with_previous_result = True
    power = result.spectral_rho_power
    settings.spectral_rho_power_init = power + 1.0  # of no account: the power goes on, as the weight does
    assert solver.solve(G, g, kinds, known, settings, result) and result.iterations < iterations
    assert abs(result.spectral_rho_power - power) < 0.5


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("tau", 1.7),
        ("dual_momentum", -0.1),
        ("rho_min", -1.0),
        ("rho_init", -1.0),
        ("mu_prox", -1.0),
    ],
)
def test_settings_that_have_no_meaning_are_refused(pin: Any, name: str, value: float) -> None:
    settings = pin.ADMMSolverSettings()
    settings.checkValidity()
    setattr(settings, name, value)
    with pytest.raises(Exception, match=name):
        settings.checkValidity()
