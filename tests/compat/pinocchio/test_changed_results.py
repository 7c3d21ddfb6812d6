"""What programs write into results of a Data is what later calls read, at the first calls of a model and at later ones."""

from __future__ import annotations

import json

import numpy as np
import pytest

from support.two_pythons import printed

_JACOBIANS = """
import json, numpy as np, pinocchio as pin
found = []
for model in (pin.buildSampleModelManipulator(), pin.buildSampleModelHumanoid()):
    data = model.createData()
    q = pin.integrate(model, pin.neutral(model), np.linspace(-0.5, 0.8, model.nv))
    placement = pin.SE3(pin.exp3(np.array([0.3, -0.2, 0.5])), np.array([-0.1, 0.4, 0.7]))

    def read():
        for reference in (pin.LOCAL, pin.WORLD, pin.LOCAL_WORLD_ALIGNED):
            for joint in (0, 1, 3, model.njoints - 1):
                found.append(pin.getJointJacobian(model, data, joint, reference).tolist())
                found.append(pin.getFrameJacobian(model, data, joint, placement, reference).tolist())
            found.append(pin.getFrameJacobian(model, data, model.nframes - 1, reference).tolist())
        found.append(data.oMf[model.nframes - 1].homogeneous.tolist())

    for turn in range(ROUNDS):
        pin.computeJointJacobians(model, data, q)
        read()
        data.oMi[3] = placement
        data.oMi[model.njoints - 1].translation = np.ones(3)
        read()
        data.J[:] = 2.0 * data.J
        read()
        data.J = np.arange(6.0 * model.nv).reshape(6, model.nv)
        read()
print(json.dumps(found))
"""


def test_jacobians_are_of_the_columns_and_placements_that_are_there() -> None:
    """At first calls, and later when all of them are compiled and bound."""
    rounds = 4
    pytest.importorskip("pinocchio")
    own, wanted = map(json.loads, printed(_JACOBIANS.replace("ROUNDS", str(rounds))))
    assert len(own) == len(wanted) == 2 * 4 * 28 * rounds
    for mine, theirs in zip(own, wanted, strict=True):
        np.testing.assert_allclose(mine, theirs, rtol=1e-9, atol=1e-9)


_FACTORS = """
import json, numpy as np, pinocchio as pin
model = pin.buildSampleModelManipulator()
data, q, v = model.createData(), np.linspace(0.1, 0.6, 6), np.linspace(-1.0, 1.0, 6)
found = [data.U.tolist(), data.D.tolist()]
for change in ("data.M *= 2.0", "pin.crba(model, data, 2.0 * q)", "data.D = v", "data.D[0] = 9.0", "data.M = np.eye(6)",
               "pin.forwardDynamics(model, data, q, v, v, np.eye(3, 6), np.zeros(3), 0.0)", "data.D[1] = 3.0"):
    pin.crba(model, data, q)
    found.append(pin.cholesky.decompose(model, data).tolist())
    exec(change)
    found += [data.U.tolist(), data.D.tolist(), pin.cholesky.solve(model, data, v).tolist()]
print(json.dumps(found))
"""


def test_factors_of_the_mass_matrix_are_those_of_the_last_decomposition() -> None:
    pytest.importorskip("pinocchio")
    own, wanted = map(json.loads, printed(_FACTORS))
    assert len(own) == len(wanted) == 30
    for mine, theirs in zip(own, wanted, strict=True):
        np.testing.assert_allclose(mine, theirs, rtol=1e-9, atol=1e-9)


_MOTIONS = """
import json, numpy as np, pinocchio as pin
found = []
references = pin.LOCAL, pin.WORLD, pin.LOCAL_WORLD_ALIGNED
placement = pin.SE3(pin.exp3(np.array([0.3, -0.2, 0.5])), np.array([-0.1, 0.4, 0.7]))


def moved(list_, k):
    entry = list_[k]
    list_[k] = entry * placement if isinstance(entry, pin.SE3) else pin.Motion(1.5 * entry.vector + 0.1 * k)


def changed(data, name):
    if name in ("J", "dJ"):
        getattr(data, name)[1:4] *= 1.5
    elif name:
        for k in range(1, len(getattr(data, name))):
            moved(getattr(data, name), k)


for model in (pin.buildSampleModelManipulator(), pin.buildSampleModelHumanoid()):
    data = model.createData()
    q = pin.integrate(model, pin.neutral(model), np.linspace(-0.5, 0.8, model.nv))
    v, a = np.linspace(-1.0, 1.0, model.nv), np.linspace(0.3, 2.0, model.nv)
    for name in ("", "oMi", "v", "ov", "a", "oa", "J", "dJ") * ROUNDS:
        pin.computeForwardKinematicsDerivatives(model, data, q, v, a)
        changed(data, name)
        for joint in (0, 2, model.njoints - 1):
            for reference in references:
                found.append(pin.getJointJacobianTimeVariation(model, data, joint, reference).tolist())
                for call in (pin.getJointVelocityDerivatives, pin.getJointAccelerationDerivatives):
                    found += [x.tolist() for x in call(model, data, joint, reference)]
                for call in (pin.getFrameVelocityDerivatives, pin.getFrameAccelerationDerivatives):
                    found += [x.tolist() for x in call(model, data, model.nframes - 1, reference)]
                    found += [x.tolist() for x in call(model, data, joint, placement, reference)]
                if reference == pin.WORLD:
                    continue
                for call in (pin.getPointVelocityDerivatives, pin.getPointClassicAccelerationDerivatives):
                    found += [x.tolist() for x in call(model, data, joint, placement, reference)]
        for reference in references:
            found.append(pin.getFrameJacobianTimeVariation(model, data, model.nframes - 1, reference).tolist())
        found.append(data.oMf[model.nframes - 1].homogeneous.tolist())
print(json.dumps(found))
"""


def test_rates_and_derivatives_are_of_the_motions_and_columns_that_are_there() -> None:
    """At first calls, and in the second round, when all of them are compiled and bound."""
    rounds = 2
    pytest.importorskip("pinocchio")
    own, wanted = map(json.loads, printed(_MOTIONS.replace("ROUNDS", str(rounds))))
    assert len(own) == len(wanted) == 2 * 8 * (3 * (3 * 19 + 2 * 6) + 4) * rounds
    for mine, theirs in zip(own, wanted, strict=True):
        np.testing.assert_allclose(mine, theirs, rtol=1e-9, atol=1e-9)


_SUMS = """
import json, numpy as np, pinocchio as pin
found = []
placement = pin.SE3(pin.exp3(np.array([0.3, -0.2, 0.5])), np.array([-0.1, 0.4, 0.7]))


def changed(data, name):
    for k in range(1, len(getattr(data, name)) if name else 0):
        entry = getattr(data, name)[k]
        getattr(data, name)[k] = entry * placement if isinstance(entry, pin.SE3) else pin.Motion(1.5 * entry.vector + k)


def center(model, data):
    return [pin.centerOfMass(model, data), *data.com, *data.vcom, *data.acom, *data.mass]


def momentum(model, data):
    return [pin.computeCentroidalMomentum(model, data).vector, data.com[0], *(h.vector for h in data.h)]


def rate(model, data):
    momentum = pin.computeCentroidalMomentumTimeVariation(model, data)
    return [momentum.vector, data.hg.vector, *(f.vector for f in data.f)]


def energies(model, data):
    mechanical = pin.computeMechanicalEnergy(model, data)
    return [mechanical, data.kinetic_energy, data.potential_energy]


def columns(model, data):
    return [pin.computeJointJacobians(model, data), pin.getJointJacobian(model, data, 2, pin.LOCAL)]


def center_columns(model, data):
    return [pin.jacobianCenterOfMass(model, data), data.com[0], data.J, data.mass[1]]


for model in (pin.buildSampleModelManipulator(), pin.buildSampleModelHumanoid()):
    model.armature = np.linspace(0.1, 0.5, model.nv)
    data = model.createData()
    q = pin.integrate(model, pin.neutral(model), np.linspace(-0.5, 0.8, model.nv))
    v, a = np.linspace(-1.0, 1.0, model.nv), np.linspace(0.3, 2.0, model.nv)
    calls = (center, momentum, rate, energies, columns, center_columns, lambda *x: [pin.computeKineticEnergy(*x)],
             lambda *x: [pin.computePotentialEnergy(*x)])
    for name in ("", "oMi", "liMi", "v", "a") * ROUNDS:
        for call in calls:
            pin.forwardKinematics(model, data, q, v, a)
            changed(data, name)
            model.inertias[2].mass *= 1.1
            found += [np.array(x).tolist() for x in call(model, data)]
            found += [M.homogeneous.tolist() for M in data.oMi] + [V.vector.tolist() for V in data.v]
print(json.dumps(found))
"""


def test_energies_momenta_and_centres_are_of_the_placements_and_motions_that_are_there() -> None:
    """Of the masses of the moment, as a change of them shows; none of these calls overwrites what it reads."""
    rounds = 2
    pytest.importorskip("pinocchio")
    own, wanted = map(json.loads, printed(_SUMS.replace("ROUNDS", str(rounds))))
    assert len(own) == len(wanted) > 4000 * rounds
    for mine, theirs in zip(own, wanted, strict=True):
        np.testing.assert_allclose(mine, theirs, rtol=1e-9, atol=1e-9)


_ENTRIES = """
import json, numpy as np, pinocchio as pin
model = pin.buildSampleModelManipulator()
data, q, v, a = model.createData(), np.linspace(0.1, 0.6, 6), np.linspace(-1.0, 1.0, 6), np.linspace(0.0, 1.0, 6)
found = []
for change in (lambda entry, x: x, lambda entry, x: 2.0 * x, lambda entry, x: x.reshape(x.shape + (1,) * (x.ndim == 1))):
    for name in ("com", "vcom", "acom", "B"):
        pin.computeCoriolisMatrix(model, data, q, v)
        pin.crba(model, data, q)
        pin.centerOfMass(model, data, q, v, a)
        entries = getattr(data, name)
        entry = entries[2]
        found.append(np.array(entry).tolist())
        entries[2] = change(entry, np.array(entry) + 1.0)
        found += [np.array(entries[2]).tolist(), np.array(getattr(data, name)[2]).tolist()]
print(json.dumps(found))
"""


def test_entries_that_were_assigned_are_filled_by_the_next_call() -> None:
    """An array that is put into a list of a Data is copied there, so that the next call writes over it."""
    pytest.importorskip("pinocchio")
    own, wanted = map(json.loads, printed(_ENTRIES))
    assert len(own) == len(wanted) == 36
    for mine, theirs in zip(own, wanted, strict=True):
        np.testing.assert_allclose(mine, theirs, rtol=1e-9, atol=1e-9)


_DERIVATIVES = """
import json, numpy as np, pinocchio as pin
found = []


def add(data, name):
    random = np.random.default_rng(sum(map(ord, name)) + 7000)
    value = getattr(data, name)
    if isinstance(value, np.ndarray):
        value += random.normal(size=value.shape)
        return
    for k in range(1, len(value)):  # that of the universe does not count
        entry = value[k]
        if isinstance(entry, np.ndarray):
            entry += random.normal(size=entry.shape)
        elif isinstance(entry, pin.SE3):
            value[k] = entry * pin.exp6(random.normal(size=6))
        elif isinstance(entry, float):
            value[k] = 1.5 * entry
        else:
            value[k] = type(entry)(entry.vector + random.normal(size=6))


CASES = (
    ("pin.computeRNEADerivatives(model, data, q, v, a)", "pin.getCoriolisMatrix(model, data)", "J dJ oh"),
    ("pin.computeRNEADerivatives(model, data, q, v, a)", "pin.getCentroidalDynamicsDerivatives(model, data)",
     "dFdq dFdv of oh"),
    ("pin.computeForwardKinematicsDerivatives(model, data, q, v, a); pin.centerOfMass(model, data, q, v, a)",
     "pin.getCenterOfMassVelocityDerivatives(model, data)", "com vcom mass"),
    ("pin.jacobianCenterOfMass(model, data, q)", "pin.getJacobianSubtreeCenterOfMass(model, data, 0)", "Jcom"),
    ("pin.jacobianCenterOfMass(model, data, q)", "pin.getJacobianSubtreeCenterOfMass(model, data, 3)", "Jcom J mass"),
    ("pin.forwardKinematics(model, data, q)", "pin.jacobianSubtreeCenterOfMass(model, data, 3)", "oMi"),
)
for model in (pin.buildSampleModelManipulator(), pin.buildSampleModelHumanoid()):
    model.armature = np.linspace(0.1, 0.5, model.nv)
    q = pin.integrate(model, pin.neutral(model), np.linspace(-0.5, 0.8, model.nv))
    v, a = np.linspace(-1.0, 1.0, model.nv), np.linspace(0.5, -0.7, model.nv)
    for first, call, fields in CASES:
        data = model.createData()
        for turn in range(ROUNDS):
            for name in ("", *fields.split()):
                exec(first)
                if name == "mass" and "Subtree" in call:
                    data = model.createData()
                    exec(first)
                if name:
                    add(data, name)
                result = eval(call)
                found += [x.tolist() for x in (result if isinstance(result, tuple) else (result,))]
print(json.dumps(found))
"""


@pytest.mark.parametrize("rounds", [1, 3])
def test_derivatives_are_of_the_fields_that_are_there(rounds: int) -> None:
    pytest.importorskip("pinocchio")
    own, wanted = map(json.loads, printed(_DERIVATIVES.replace("ROUNDS", str(rounds))))
    assert len(own) == len(wanted) == 2 * (4 + 5 * 4 + 4 + 2 + 4 + 2) * rounds
    for mine, theirs in zip(own, wanted, strict=True):
        np.testing.assert_allclose(mine, theirs, rtol=1e-8, atol=1e-8)


_FORWARD = """
import json, numpy as np, pinocchio as pin
found = []
world = pin.Convention.WORLD
DEFINITIONS
for model in (pin.buildSampleModelManipulator(), pin.buildSampleModelHumanoid()):
    model.armature = np.linspace(0.1, 0.5, model.nv)
    q = pin.integrate(model, pin.neutral(model), np.linspace(-0.5, 0.8, model.nv))
    v, tau = np.linspace(-1.0, 1.0, model.nv), np.linspace(0.5, -0.7, model.nv)
    forces = pin.StdVec_Force()
    forces.extend([pin.Force(np.arange(6.0) + k) for k in range(model.njoints)])
    for first, call, fields in CASES:
        data = model.createData()
        for turn in range(ROUNDS):
            for name in ("", *fields.split()):
                exec(first)
                if name:
                    add(data, name)
                result = eval(call)
                found += [x.tolist() for x in (result if isinstance(result, tuple) else (result,))]
                if "ABA" in call:
                    found += [getattr(data, x).tolist() for x in "dtau_dq dtau_dv dJ dAdq dAdv dFdq dFdv dFda".split()]
                    found.append([force.vector.tolist() for force in list(data.of)[1:]])
                found.append(data.J.tolist())
print(json.dumps(found))
"""
_ADD = _DERIVATIVES[_DERIVATIVES.index("def add") : _DERIVATIVES.index("CASES")]
_AFTER_ABA = """CASES = (
    ("pin.aba(model, data, q, v, tau, world)", "pin.computeMinverse(model, data)", "J oMi"),
    ("pin.aba(model, data, q, v, tau, world)", "pin.computeABADerivatives(model, data)", "J ov oa_gf oh oMi v ddq"),
    ("pin.aba(model, data, q, v, tau, forces, world)", "pin.computeABADerivatives(model, data, forces)",
     "J ov oa_gf oh"),
)
"""


@pytest.mark.parametrize("rounds", [1, 3])
def test_forward_dynamics_are_of_the_columns_and_motions_that_are_there(rounds: int) -> None:
    """What Pinocchio does not read, `oMi`, `v` and `ddq`, does not count here either."""
    lines = _FORWARD.replace("DEFINITIONS", _ADD + _AFTER_ABA).replace("ROUNDS", str(rounds))
    own, wanted = map(json.loads, printed(lines))
    assert len(own) == len(wanted) == 2 * (3 * 2 + (8 + 5) * 13) * rounds
    for mine, theirs in zip(own, wanted, strict=True):
        scale = np.abs(theirs).max()
        np.testing.assert_allclose(mine, theirs, rtol=1e-8, atol=1e-9 * max(1.0, scale))


_OTHERS = """
import json, numpy as np, pinocchio as pin
model = pin.buildSampleModelHumanoid()
q = pin.integrate(model, pin.neutral(model), np.linspace(-0.5, 0.8, model.nv))
p = pin.integrate(model, q, np.linspace(0.1, -0.3, model.nv))
v, tau = np.linspace(-1.0, 1.0, model.nv), np.linspace(0.5, -0.7, model.nv)
data, found = model.createData(), []
for turn in range(4):
    for convention in (pin.Convention.LOCAL, pin.Convention.WORLD):
        for other in ("pin.forwardKinematics(model, data, p, v, v)", "pin.rnea(model, data, p, tau, v)", "0",
                      "pin.computeJointJacobians(model, data, p)", "pin.computeCoriolisMatrix(model, data, p, tau)",
                      "pin.computeCentroidalDynamicsDerivatives(model, data, q, v, data.ddq.copy())",
                      "pin.computeStaticTorque(model, data, q, [pin.Force.Zero()] * model.njoints)"):
            pin.aba(model, data, q, v, tau, convention)
            eval(other)
            [*data.ov], [*data.oh], [*data.oa_gf], data.J
            found.append([x.tolist() for x in (pin.computeMinverse(model, data), *pin.computeABADerivatives(model, data))])
print(json.dumps(found))
"""


def test_fields_that_other_calls_left_are_no_inputs_of_forward_dynamics() -> None:
    own = json.loads(printed(_OTHERS)[0])
    assert len(own) == 4 * 2 * 7
    for mine in own:
        for one, first in zip(mine, own[0], strict=True):
            np.testing.assert_allclose(one, first, rtol=1e-8, atol=1e-8)


_CONSTRAINTS = """
import json, numpy as np, pinocchio as pin
found = []
for model in (pin.buildSampleModelManipulator(), pin.buildSampleModelHumanoid()):
    q = pin.integrate(model, pin.neutral(model), np.linspace(-0.5, 0.8, model.nv))
    M = pin.SE3(pin.exp3(np.array([0.3, -0.2, 0.5])), np.array([-0.1, 0.4, 0.7]))
    N = pin.SE3(pin.exp3(np.array([0.1, 0.6, -0.5])), np.array([0.3, 0.2, -0.3]))
    end, data = model.njoints - 1, model.createData()
    rigid, datas = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
    for kind in (pin.ContactType.CONTACT_3D, pin.ContactType.CONTACT_6D):
        for reference in (pin.LOCAL, pin.LOCAL_WORLD_ALIGNED):
            rigid.append(pin.RigidConstraintModel(kind, model, end, M, reference))
            rigid.append(pin.RigidConstraintModel(kind, model, end, M, 2, N, reference))
    datas.extend([one.createData() for one in rigid])
    anchors = [pin.PointAnchorConstraintModel(model, end, M, 2, N), pin.FrameAnchorConstraintModel(model, end, M, 2, N),
               pin.PointContactConstraintModel(model, 2, M)]
    known = [one.createData() for one in anchors]
    for turn in range(ROUNDS):
        for change in (lambda: 0, lambda: data.J.__imul__(1.5), lambda: data.J.__iadd__(np.arange(6.0 * model.nv).reshape(6, -1)),
                       lambda: data.oMi[2].translation.__iadd__(np.ones(3))):
            pin.forwardKinematics(model, data, q)
            pin.computeJointJacobians(model, data, q)
            for one, its in zip([*rigid, *anchors], [*datas, *known]):
                one.calc(model, data, its)
            change()
            found += [pin.getConstraintJacobian(model, data, *pair).tolist() for pair in zip(rigid, datas)]
            found += [one.jacobian(model, data, its).tolist() for one, its in zip(anchors, known)]
            found.append(pin.getConstraintsJacobian(model, data, rigid, datas).tolist())
print(json.dumps(found))
"""


@pytest.mark.parametrize("rounds", [1, 4])
def test_constraint_jacobians_are_of_the_columns_that_are_there(rounds: int) -> None:
    """Placements count where `calc` read them."""
    pytest.importorskip("pinocchio")
    own, wanted = map(json.loads, printed(_CONSTRAINTS.replace("ROUNDS", str(rounds))))
    assert len(own) == len(wanted) == 2 * 4 * 12 * rounds
    for mine, theirs in zip(own, wanted, strict=True):
        np.testing.assert_allclose(mine, theirs, rtol=1e-9, atol=1e-9 * max(1.0, np.abs(theirs).max()))


_FOLLOWING = """
import json, numpy as np, pinocchio as pin
model = pin.buildSampleModelHumanoid()
q = pin.integrate(model, pin.neutral(model), np.linspace(-0.5, 0.8, model.nv))
v, a = np.linspace(-1.0, 1.0, model.nv), np.linspace(0.5, -0.7, model.nv)
data, found = model.createData(), []
for turn in range(ROUNDS):
    for name in ("", "oh", "ov", "dFdq", "dFda", "of"):
        pin.computeRNEADerivatives(model, data, q, v, a)
        if name:
            [*getattr(data, name)]
        for again in range(3):
            found.append([x.tolist() for x in pin.getCentroidalDynamicsDerivatives(model, data)])
            found.append([pin.getCoriolisMatrix(model, data).tolist(), data.hg.vector.tolist()])
            [*data.oh], [*data.dFda], [*data.com]
print(json.dumps(found))
"""


@pytest.mark.parametrize("rounds", [1, 3])
def test_results_that_a_call_left_are_not_its_inputs(rounds: int) -> None:
    own, _ = map(json.loads, printed(_FOLLOWING.replace("ROUNDS", str(rounds))))
    assert len(own) == 36 * rounds
    for k, mine in enumerate(own):
        for one, first in zip(mine, own[k % 2], strict=True):
            np.testing.assert_allclose(one, first, rtol=1e-8, atol=1e-8)


_HESSIANS = """
import json, numpy as np, pinocchio as pin
model, found = pin.buildSampleModelHumanoid(), []
q = pin.integrate(model, pin.neutral(model), np.linspace(-0.5, 0.8, model.nv))
data, placement = model.createData(), pin.SE3(pin.exp3(np.array([0.3, -0.2, 0.5])), np.array([-0.1, 0.4, 0.7]))
for reference in (pin.LOCAL, pin.WORLD, pin.LOCAL_WORLD_ALIGNED):
    for turn in range(4):
        pin.computeJointKinematicHessians(model, data, q)
        for factor in (1.0, 2.0):
            data.J *= factor
            found.append(pin.getJointKinematicHessian(model, data, 5, reference).tolist())
            found.append(pin.getFrameKinematicHessian(model, data, model.nframes - 1, reference).tolist())
            found.append(pin.getFrameKinematicHessian(model, data, 5, placement, reference).tolist())
print(json.dumps(found))
"""


def test_hessians_are_of_the_columns_that_are_there() -> None:
    pytest.importorskip("pinocchio")
    own, _ = map(json.loads, printed(_HESSIANS))
    for k in range(0, len(own), 6):
        for before, after in zip(own[k : k + 3], own[k + 3 : k + 6], strict=True):
            assert np.abs(before).max() > 0.1
            np.testing.assert_allclose(after, 4.0 * np.array(before), rtol=1e-9, atol=1e-9)


def test_composite_inertias_in_the_world_cannot_be_written_to() -> None:
    lines = """
import numpy as np, pinocchio as pin
model = pin.buildSampleModelManipulator()
data = model.createData()
pin.crba(model, data, np.zeros(6))
try:
    data.oYcrb[1].mass = 2.0
    print("written")
except ValueError as error:
    print("read-only" in str(error))
"""
    assert printed(lines)[0].strip() == "True"
