"""What is assigned to attributes: wrong values raise and change nothing, right ones are copied, as in Pinocchio."""

from __future__ import annotations

import json
import pickle
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent))

from differential import compare, documented, properties
from generated_writes import DOCUMENTED, writes

from support.compat_packages import using
from support.two_pythons import printed, variables

WRONG = (
    ("m", "name", "3"),
    ("m", "nq", "3"),
    ("m", "names", "['a']"),
    ("m", "frames", "[3]"),
    ("m", "jointPlacements", "np.zeros(7)"),
    ("m", "inertias", "m.inertias"),
    ("m", "armature", "pin.Motion.Zero()"),
    ("m.joints[2]", "idx_q", "0"),
    ("m.frames[2]", "name", "3"),
    ("m.frames[2]", "type", "2"),
    ("m.frames[2]", "placement", "np.eye(4)"),
    ("d", "oMi", "3"),
    ("d", "oMi", "d.oMi.tolist()[1:]"),
    ("d", "v", "[3] * 7"),
    ("d", "M", "np.zeros((2, 2))"),
    ("d", "M", "np.full((6, 6), None)"),
    ("d", "hg", "pin.Motion.Zero()"),
    ("d", "lastChild", "list(d.lastChild)[1:]"),
    ("c", "reference_frame", "3"),
    ("c", "type", "3"),
    ("c", "joint1_id", "1.5"),
    ("c", "joint1_placement", "np.eye(4)"),
    ("c", "desired_contact_velocity", "pin.Force.Zero()"),
    ("c", "name", "None"),
    ("g.geometryObjects[0]", "parentJoint", "'a'"),
    ("g.geometryObjects[0]", "overrideMaterial", "2.5"),
    ("g.geometryObjects[0]", "geometry", "3"),
    ("g", "collisionPairs", "[]"),
    ("pin.CollisionPair(0, 1)", "first", "-1"),
    ("pin.AngleAxis(0.1, np.array([1.0, 0.0, 0.0]))", "angle", "'a'"),
    ("pin.Inertia.Identity()", "mass", "np.array(1j)"),
    ("pin.Inertia.Identity()", "mass", "np.array('a')"),
    ("pin.ADMMSolverSettings()", "rho_max", "'a'"),
    ("pin.ProximalSettings()", "iter", "3"),
    ("pin.JointModelHX(0.1)", "pitch", "None"),
)
"""Objects, attributes and values that neither package takes."""


@pytest.fixture(scope="module")
def pin() -> Iterator[Any]:
    with using("pinocchio"):
        import pinocchio

        yield pinocchio


def scope(pin: Any) -> dict[str, Any]:
    """What the names in `WRONG` mean."""
    m = pin.buildSampleModelManipulator()
    c = pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, m, 3, pin.LOCAL)
    d = m.createData()
    pin.forwardKinematics(m, d, np.zeros(6), np.zeros(6))
    return {"pin": pin, "np": np, "m": m, "d": d, "c": c, "g": pin.buildSampleGeometryModelManipulator(m)}


ASKED = """
import sys
sys.path.insert(0, {folder!r})
import pinocchio as pin
from test_attributes import WRONG, scope
for target, name, value in WRONG:
    names = scope(pin)
    try:
        setattr(eval(target, names), name, eval(value, names))
    except Exception:
        continue
    print(target, name, value)
"""


@pytest.mark.parametrize("target, name, value", WRONG)
def test_wrong_values_raise_and_change_nothing(pin: Any, target: str, name: str, value: str) -> None:
    names = scope(pin)
    changed = eval(target, names)
    before = str(getattr(changed, name))
    with pytest.raises((TypeError, AttributeError, IndexError), match=f"`?{name}|index") as caught:
        setattr(changed, name, eval(value, names))
    if not isinstance(caught.value, AttributeError):  # Python raises those of properties that are read only
        assert type(caught.value).__module__.startswith(("pinocchio", "ulna"))
    assert str(getattr(changed, name)) == before


def test_pinocchio_takes_none_of_them_but_matrices_of_other_sizes() -> None:
    pytest.importorskip("pinocchio")
    folder = str(Path(__file__).parent)
    done = subprocess.run(
        [sys.executable, "-c", ASKED.format(folder=folder)],
        env=variables(None), capture_output=True, text=True, check=True,
    )  # fmt: skip
    taken = done.stdout.split("\n")[:-1]
    assert {tuple(line.split()[:2]) for line in taken} <= {("d", "oMi"), ("d", "M"), ("d", "lastChild")}, (
        taken
    )


def test_values_are_copied(pin: Any) -> None:
    names = scope(pin)
    M, gains, velocity = pin.SE3.Random(), pin.BaumgarteCorrectorParameters(2.0, 3.0), pin.Motion.Random()
    constraint = names["c"]
    constraint.joint1_placement, constraint.desired_contact_velocity = M, velocity
    constraint.m_baumgarte_parameters = gains
    kept = M.copy(), velocity.copy()
    M.setIdentity()
    velocity.setZero()
    gains.Kp = 0.0
    assert (constraint.joint1_placement, constraint.desired_contact_velocity) == kept
    assert constraint.m_baumgarte_parameters.Kp == 2.0
    anchor = pin.PointAnchorConstraintModel(names["m"], 3)
    offset = np.ones((3, 1), dtype=np.float32)
    anchor.desired_constraint_offset = offset
    offset[:] = 0.0
    assert np.array_equal(anchor.desired_constraint_offset, np.ones(3))


def test_lists_of_a_data_are_assigned_entry_by_entry(pin: Any) -> None:
    names = scope(pin)
    data = names["d"]
    reference, new = data.v[3], [pin.Motion.Random() for _ in range(7)]
    data.v = new
    assert data.v.tolist() == new and reference == new[3]
    new[3].setZero()
    assert data.v[3] != new[3]
    pin.rnea(names["m"], data, np.zeros(6), np.ones(6), np.zeros(6))
    forces = [pin.Force.Random() for _ in range(7)]
    data.f = forces  # `h` is computed with it when it is first read
    _ = data.h[2]
    assert data.f.tolist() == forces
    data.mass = list(range(7))
    assert list(data.mass) == list(range(7))
    M = data.M.copy() + 1.0
    pin.computeAllTerms(names["m"], data, np.zeros(6), np.ones(6))
    data.M = M
    _ = data.nle, data.J
    assert np.array_equal(data.M, M)


def test_lengths_and_axes_of_joints_count(pin: Any) -> None:
    screw = pin.JointModelHX(0.1)
    screw.pitch = 0.4
    data = screw.createData()
    screw.calc(data, np.array([2.0]))
    assert np.allclose(data.M.translation, [0.8, 0.0, 0.0])
    joint = pin.JointModelRevoluteUnaligned(np.array([1.0, 0.0, 0.0]))
    joint.axis = np.array([0.0, 0.0, 1.0])
    state = joint.createData()
    joint.calc(state, np.array([0.5]))
    assert np.allclose(state.M.rotation, pin.utils.rotate("z", 0.5))
    model = pin.Model()
    model.addJoint(0, joint, pin.SE3.Identity(), "turn")
    with pytest.raises(AttributeError, match="cannot be changed any more"):
        model.joints[1].axis = np.array([0.0, 1.0, 0.0])


@pytest.mark.slow
def test_generated_assignments_have_the_same_outcome() -> None:
    pytest.importorskip("pinocchio")
    pairs = list(writes(properties()))
    assert len(pairs) > 15000
    found = compare(pairs[::17])
    wrong = [(text, what) for _, text, what, *_ in found if what and not documented(what, text, DOCUMENTED)]
    print(Counter(what for _, what in wrong), wrong[:40])
    assert len(wrong) <= 0.01 * len(found)


AS_THERE = """
import numpy as np, pinocchio as pin
m = pin.buildSampleModelManipulator()
d = m.createData()
def plain(x):
    return [plain(one) for one in x] if hasattr(x, "__len__") else x
for target, names in ((m, "supports subtrees mimicked_joints"), (d, "lastChild parents_fromRow supports_fromRow")):
    for name in names.split():
        before = plain(getattr(target, name))
        setattr(target, name, getattr(target, name))
        setattr(target, name, getattr(target, name).copy())
        print(name, before, plain(getattr(target, name)) == before)
d.joints = d.joints
F = pin.Frame()
F.name = b"tool"
settings = pin.ADMMSolverSettings()
settings.stat_record, settings.measure_timings = 2, -1
print(F.name, settings.stat_record, settings.measure_timings)
known = pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, m, 3, pin.LOCAL).createData()
known.contact_acceleration = pin.Motion(np.arange(6.0))
print(known.contact_acceleration.vector)
print(pin.log6(homegeneous_matrix=pin.SE3.Identity().homogeneous).vector)
"""


def test_what_is_held_is_taken_as_there() -> None:
    pytest.importorskip("pinocchio")
    own, theirs = printed(AS_THERE)
    assert own == theirs and "tool True True" in own


_OTHER_SIZES = """
import json, numpy as np, pinocchio as pin
model = pin.buildSampleModelManipulator()
data, q = model.createData(), np.linspace(0.1, 0.6, 6)
models, datas = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
models.append(pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, model, 3, pin.LOCAL))
datas.append(models[0].createData())
pin.initConstraintDynamics(model, data, models, datas)
found = []
for name in ("lambda_c", "impulse_c", "lambda_c_prox", "primal_rhs_contact", "q_in", "v_in", "a_in", "tau_in"):
    for value in (np.zeros(0), np.array([2.0]), np.arange(3.0), np.arange(7.0)):
        setattr(data, name, value)
        value[:] = 9.0
        found.append(getattr(data, name).tolist())
for name in ("osim", "dac_da", "dac_dq", "dac_dv", "dvc_dq"):
    for value in (np.array([2.0]), np.eye(2, 3), np.eye(5)):
        setattr(data, name, value)
        found.append(getattr(data, name).tolist())
for name in ("Ivx", "vxI"):
    setattr(data, name, getattr(data, name)[1:])
    found.append(len(getattr(data, name)))
print(json.dumps(found))
"""


def test_fields_whose_size_constraints_decide_take_arrays_of_any_size() -> None:
    """As do those that no algorithm reads."""
    pytest.importorskip("pinocchio")
    own, wanted = map(json.loads, printed(_OTHER_SIZES))
    assert len(own) == len(wanted) == 32 + 15 + 2
    for mine, theirs in zip(own, wanted, strict=True):
        np.testing.assert_allclose(mine, theirs, rtol=1e-9, atol=1e-9)


def test_what_fills_such_a_field_next_decides_its_size(pin: Any) -> None:
    """Native calls too; Pinocchio ends the process there."""
    model = pin.buildSampleModelManipulator()
    data, q = model.createData(), np.linspace(0.1, 0.6, 6)
    models = [pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, model, 3, pin.LOCAL)]
    datas = [models[0].createData()]
    pin.initConstraintDynamics(model, data, models, datas)
    for k in range(5):
        pin.constraintDynamics(model, data, k * q, q, q, models, datas)
        forces = data.lambda_c.copy()
        data.lambda_c = np.zeros(7)
        assert data.lambda_c.shape == (7,)
        pin.constraintDynamics(model, data, k * q, q, q, models, datas)
        np.testing.assert_allclose(data.lambda_c, forces, rtol=1e-9)


@pytest.mark.parametrize(
    ("name", "value"), [("lambda_c", np.eye(3)), ("q_in", None), ("osim", np.zeros((2, 2, 2)))]
)
def test_what_is_no_such_array_is_refused(pin: Any, name: str, value: Any) -> None:
    data = scope(pin)["d"]
    with pytest.raises((ValueError, TypeError), match=name):
        setattr(data, name, value)


def test_matrices_of_anchors_are_those_of_the_last_calc(pin: Any) -> None:
    """What is written into their placements changes them at the next `calc`, as there."""
    names = scope(pin)
    anchor = pin.PointAnchorConstraintModel(names["m"], 3)
    data = anchor.createData()
    anchor.calc(names["m"], names["d"], data)
    before = np.array(data.A1_local)
    data.oMc1 = pin.SE3(np.eye(3), np.arange(3.0))
    np.testing.assert_array_equal(data.A1_local, before)
    assert before.any()


def test_types_of_what_is_held_make_copies(pin: Any) -> None:
    names = scope(pin)
    pin.computeSubtreeMasses(names["m"], names["d"])
    for values in (names["d"].mass, names["d"].com):
        made = type(values)(values)
        assert made is not values and np.array_equal(list(made), list(values))
        again = pickle.loads(pickle.dumps(values))
        assert np.array_equal(list(again), list(values))
    material = names["g"].geometryObjects[0].meshMaterial
    assert type(material)(material) == material
    with pytest.raises(TypeError, match="GeometryNoMaterial"):
        pin.GeometryNoMaterial(3)
