"""Lists of Pinocchio: entries of one kind, which are copied, as are parts of lists. What Pinocchio does is compared by `differential.py --containers`."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using
from support.two_pythons import printed
from ulna.errors import InputError


@pytest.fixture(scope="module")
def pin() -> Iterator[Any]:
    with using("pinocchio"):
        import pinocchio

        yield pinocchio


def test_parts_and_copies_of_lists_stand_alone(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    data = model.createData()
    pin.forwardKinematics(model, data, np.full(6, 0.3))
    part, before = data.oMi[1:3], [M.copy() for M in data.oMi]
    copies = pin.StdVec_SE3(data.oMi), data.oMi.copy(), copy.copy(data.oMi), data.oMi.tolist(True)
    same = data.oMi.tolist(), list(data.oMi)
    pin.forwardKinematics(model, data, np.zeros(6))
    assert list(part) == before[1:3] and all(list(each) == before for each in copies)
    assert all(list(each) == list(data.oMi) != before for each in same)
    joints = model.joints[1:3]
    joints[0].setIndexes(9, 9, 9)
    assert model.joints[1].id == 1


def test_what_is_put_in_is_copied(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    for kind, entry in (
        ("RigidConstraintModel", pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, model, 2)),
        ("PointAnchorConstraintModel", pin.PointAnchorConstraintModel(model, 2)),
        ("Frame", pin.Frame("f", 1, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME)),
        ("GeometryObject", pin.buildSampleGeometryModelManipulator(model).geometryObjects[0]),
        ("Model", model.copy()),
    ):
        cls, name = getattr(pin, f"StdVec_{kind}"), entry.name
        entries = cls([entry])
        entries.append(entry)
        entries.extend([entry])
        entries.insert(0, entry)
        entries += [entry]
        entries[0:1] = [entry, entry]
        entry.name = "changed"
        assert [each.name for each in (*entries, *cls(2, entry))][:6] == [name] * 6
        assert len(entries) == 6 and type(entries[1:]) is type(entries) is cls
        assert isinstance(pickle.loads(pickle.dumps(pin.StdVec_Double([1.0]))), pin.StdVec_Double)
    data = pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, model, 2).createData()
    several = pin.StdVec_RigidConstraintData([data])
    several[0].contact_force = pin.Force(np.ones(6))
    assert data.contact_force == pin.Force.Zero() != several[0].contact_force


def test_data_in_lists_are_those_that_constraint_dynamics_fills(pin: Any) -> None:
    model = pin.buildSampleModelHumanoidRandom()
    data, q = model.createData(), pin.neutral(model)
    models = pin.StdVec_RigidConstraintModel([pin.RigidConstraintModel(pin.ContactType.CONTACT_6D, model, 7)])
    datas = pin.StdVec_RigidConstraintData([models[0].createData()])
    pin.initConstraintDynamics(model, data, models, datas)
    v, tau = np.full(model.nv, 0.1), np.zeros(model.nv)
    pin.constraintDynamics(model, data, q, v, tau, models, datas, pin.ProximalSettings(1e-12, 0.0, 1))
    wrench = datas[0].contact_force.vector
    np.testing.assert_allclose(wrench, data.lambda_c, atol=1e-12)
    assert np.abs(wrench).max() > 0.1


@pytest.mark.parametrize(
    ("kind", "right", "wrong"),
    [
        ("SE3", "pin.SE3.Identity()", ("None", "'a'", "np.eye(4)", "pin.Motion.Zero()", "2")),
        ("Motion", "pin.Motion.Zero()", ("pin.Force.Zero()", "np.zeros(6)")),
        ("Double", "2", ("'a'", "None", "1j", "[]")),
        ("Index", "True", ("0.5", "-1", "None")),
        ("Bool", "0", ("0.5", "'a'")),
        ("StdString", "'a'", ("2", "None", "b'a'")),
        ("Vector3", "[1, 2, 3]", ("np.zeros(2)", "2.0", "np.full(3, 1j)", "np.full(3, None)")),
        ("Matrix6x", "np.eye(6, 2)", ("np.eye(5)", "'a'")),
        ("Matrix6", "np.eye(6)", ("np.ones(6)", "np.eye(5)")),
        ("IndexVector", "[1, 2]", ("[0.5]", "None")),
        ("JointModelVector", "pin.JointModelRX()", ("2", "pin.SE3.Identity()")),
    ],
)
def test_lists_have_entries_of_one_kind(pin: Any, kind: str, right: str, wrong: tuple[str, ...]) -> None:
    names = {"pin": pin, "np": np}
    cls, entry = getattr(pin, f"StdVec_{kind}"), eval(right, names)
    entries = cls([entry, entry])
    for text in wrong:
        no = eval(text, names)
        for call in (
            lambda no=no: entries.append(no),
            lambda no=no: entries.extend([entry, no]),
            lambda no=no: entries.insert(0, no),
            lambda no=no: entries.__setitem__(0, no),
            lambda no=no: entries.__setitem__(slice(0, 1), [no]),
            lambda no=no: cls([no]),
            lambda no=no: cls(2, no),
        ):
            with pytest.raises(InputError, match="expected"):
                call()
    assert len(entries) == 2
    for no in (None, 3.5, "text", object()):
        with pytest.raises(InputError, match=r"expected (its )?entries") as caught:
            entries.extend(no)
        assert isinstance(caught.value, (AttributeError, TypeError))


@pytest.mark.parametrize("kind", ["StdVec_Motion", "StdVec_Index", "StdVec_Matrix6x", "StdVec_Model"])
def test_a_wrong_value_is_named_before_a_missing_place(pin: Any, kind: str) -> None:
    with pytest.raises(TypeError, match="expected"):
        getattr(pin, kind)()[0] = object()
    with pytest.raises(IndexError):
        pin.StdVec_Motion()[0] = pin.Motion.Random()


def test_lists_of_a_model_are_of_their_kind(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    assert isinstance(model.inertias, pin.StdVec_Inertia) and not isinstance(model.inertias, pin.StdVec_SE3)
    assert isinstance(model.names, pin.StdVec_StdString) and not isinstance([], pin.StdVec_StdString)
    assert not isinstance(pin.StdVec_Motion(), pin.StdVec_Force)
    for entries, wrong in ((model.parents, "text"), (model.names, 2), (model.inertias, pin.SE3.Identity())):
        with pytest.raises(TypeError, match="expected"):
            entries.append(wrong)
        with pytest.raises((TypeError, ValueError), match="expected"):
            entries[0] = wrong


def test_arrays_in_lists_are_found_and_compared(pin: Any) -> None:
    rows = pin.StdVec_Vector3([np.zeros(3), np.ones(3)])
    assert np.ones(3) in rows and np.full(3, 2.0) not in rows and None not in rows
    same = rows
    assert rows == same and rows != rows.copy() and rows != rows[:1] and rows != [np.zeros(3), np.ones(3)]
    first = rows[0]
    rows[0] = np.full(3, 5.0)
    assert first.tolist() == [5.0, 5.0, 5.0]
    assert pin.SE3.Identity() in pin.StdVec_SE3([pin.SE3.Identity()]) and hash(rows) == hash(rows)


def test_operators_change_what_stands_left_of_them(pin: Any) -> None:
    Y, I, Q, v = (
        pin.Symmetric3(np.eye(3)),
        pin.Inertia.Random(),
        pin.Quaternion.Identity(),
        pin.Motion.Random(),
    )
    for this, text in (
        (Y, "this *= 2.0"),
        (Y, "this += this"),
        (I, "this += this"),
        (I, "this -= this"),
        (Q, "this *= this"),
    ):
        names = {"this": this}
        exec(text, names)
        assert names["this"] is this
    assert np.array_equal(Y.matrix(), 4.0 * np.eye(3)) and I.mass == 0.0
    for text in ("I += 1.0", "I -= v", "v += I", "v -= None", "Q *= v", "Y *= v"):
        with pytest.raises(TypeError, match="expected"):
            exec(text, {"I": I, "v": v, "Q": Q, "Y": Y})


def test_displacements_and_inertias_are_matrices_to_numpy(pin: Any) -> None:
    M, T, I = pin.SE3.Random(), pin.SE3.Random().homogeneous, pin.Inertia.Random()
    assert np.array_equal(T @ M, T @ M.homogeneous) and np.array_equal(M @ T, M.homogeneous @ T)
    assert np.array_equal(M - T, M.homogeneous - T) and np.array_equal(I + np.eye(6), I.matrix() + np.eye(6))
    assert np.array_equal(I * np.eye(6), I.matrix() * np.eye(6))
    v = pin.Motion.Random()
    np.testing.assert_allclose(I * v.vector, (I * v).vector)
    np.testing.assert_allclose(M * np.ones((3, 1)), M.rotation @ np.ones(3) + M.translation)


@pytest.mark.parametrize("name", ["com", "vcom", "mass"])
def test_all_that_reads_values_of_joints_computes_them(pin: Any, name: str) -> None:
    model = pin.buildSampleModelManipulator()

    def values() -> Any:
        data = model.createData()
        pin.computeAllTerms(model, data, np.linspace(0.1, 0.6, 6), np.ones(6))
        return getattr(data, name)

    right = list(values())
    assert np.abs(right).max() > 0.1
    np.testing.assert_array_equal(list(reversed(values())), right[::-1])
    np.testing.assert_array_equal([*(values() * 2), *(values() + [])], right * 3)
    if name == "mass":
        assert values().index(right[3]) == right.index(right[3]) and values().count(right[3]) == 1
    else:
        assert right[3] in values()


LIKE_PINOCCHIO = """
import numpy as np, pinocchio as pin
m = pin.buildSampleModelManipulator()
d = m.createData()
M, N = pin.SE3.Identity(), pin.SE3(np.eye(3), np.ones(3))
places = [m.jointPlacements, d.oMi, pin.StdVec_SE3([M, N, M])]
for l in places:
    print(l == l, l == l.copy(), l != l[:], l == list(l), list(l) == l, type(l[:]) is type(l), type(l.copy()) is type(l))
    l[0:1] = N
    l[2:1] = N
    print(len(l), l[0] == N)
names = m.names
names[0:1] = "world"
print(list(names), names == list(names))
flags = pin.StdVec_Bool([None, 2])
flags.append(None)
flags[0:1] = None
print(list(flags), None in flags, 2 in flags, pin.StdVec_Bool(2, None)[0])
rows = pin.StdVec_IndexVector([[1, 2], [3]])
rows[0:1] = [4, 5]
print([list(row) for row in rows])
g = pin.buildSampleGeometryModelManipulator(m)
one = g.geometryObjects[0]
M = one.placement
g.geometryObjects[0] = g.geometryObjects[2]
print(one.name, one.parentJoint, M == g.geometryObjects[2].placement)
g.addAllCollisionPairs()
pair = g.collisionPairs[0]
g.collisionPairs[0] = pin.CollisionPair(1, 4)
print(pair.first, pair.second)
"""


def test_lists_are_compared_and_take_single_entries_as_there() -> None:
    pytest.importorskip("pinocchio")
    own, theirs = printed(LIKE_PINOCCHIO)
    assert own == theirs and len(own.splitlines()) == 11


def test_changes_that_would_have_no_effect_are_refused(pin: Any) -> None:
    model = pin.buildSampleModelManipulator()
    data = model.createData()
    lists = (
        model.nqs,
        model.nvs,
        model.idx_qs,
        model.idx_vs,
        model.supports,
        model.supports[2],
        model.subtrees,
        model.children,
    )
    for values in (*lists, data.lastChild, data.parents_fromRow, data.supports_fromRow):
        before = list(values)
        for change in (
            lambda values=values: values.append(values[0]),
            lambda values=values: values.__setitem__(1, values[0]),
            lambda values=values: values.clear(),
        ):
            with pytest.raises(InputError, match="computed when it is read") as caught:
                change()
            assert isinstance(caught.value, TypeError)
        assert list(values) == before and isinstance(values, pin.StdVec_Index) == isinstance(before[0], int)
        changed, read = values.copy(), pickle.loads(pickle.dumps(values))
        changed.append(values[0])
        read.append(values[0])
        assert len(changed) == len(read) == len(before) + 1


_CONSTRAINTS = """
import pinocchio as pin
model = pin.buildSampleModelManipulator()
made = [pin.PointAnchorConstraintModel(model, 3), pin.JointFrictionConstraintModel(model, [1]),
        pin.FrameAnchorConstraintModel(model, 2), pin.JointLimitConstraintModel(model, [1, 2])]
models, datas = pin.StdVec_ConstraintModel(), pin.StdVec_ConstraintData()
for one in made:
    models.append(one)
    models.append(pin.ConstraintModel(one))
for one in models:
    datas.append(one.createData())
models[0] = models[2]
models.extend(models[1:3])
datas[1] = datas[3]
del datas[0]
for entries in (models, datas, models[2:5], models.copy(), datas.tolist()):
    print(len(entries), [one.shortname() for one in entries])
for entries, wrong in ((models, 3), (models, datas[0]), (datas, made[0]), (datas, None)):
    try:
        entries.append(wrong)
    except Exception as error:
        print(isinstance(error, TypeError), len(entries))
"""


def test_lists_of_constraints_take_all_kinds() -> None:
    pytest.importorskip("pinocchio")
    own, wanted = printed(_CONSTRAINTS)
    assert own == wanted


def test_texts_are_made_a_list_of_their_kind(pin: Any) -> None:
    texts = pin.utils.fromListToVectorOfString(name for name in ("a", "b"))
    assert type(texts) is pin.StdVec_StdString and texts.tolist() == ["a", "b"]
    with pytest.raises(InputError, match="expected a str"):
        pin.utils.fromListToVectorOfString([3])
