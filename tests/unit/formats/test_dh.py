"""Denavit-Hartenberg tables become models."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ulna.algorithms.kinematics.forward_kinematics import frame_pose
from ulna.errors import InputError, UnknownName
from ulna.formats.dh import DHRow, model_from_dh, prismatic, revolute
from ulna.spatial import SE3, Inertia


def product(rows, q, convention):
    """The table multiplied out with 4x4 matrices, straight from the book."""

    def rot(axis, angle):
        c, s = math.cos(angle), math.sin(angle)
        i, j = ((1, 2), (2, 0), (0, 1))["xyz".index(axis)]
        m = np.eye(4)
        m[i, i] = m[j, j] = c
        m[i, j], m[j, i] = -s, s
        return m

    def move(x=0.0, z=0.0):
        m = np.eye(4)
        m[0, 3], m[2, 3] = x, z
        return m

    out = [np.eye(4)]
    for row, value in zip(rows, q, strict=True):
        coordinate = row.offset + (-value if row.flip else value)
        theta = coordinate if row.moves == "revolute" else row.theta
        d = coordinate if row.moves == "prismatic" else row.d
        screw, twist = rot("z", theta) @ move(z=d), [move(x=row.a), rot("x", row.alpha)]
        step = screw @ twist[0] @ twist[1] if convention == "standard" else twist[1] @ twist[0] @ screw
        out.append(out[-1] @ step)
    return out


MIXED = [
    revolute(d=0.4, alpha=math.pi / 2, offset=0.3),
    revolute(a=0.5, flip=True, limits=(-1.0, 2.0)),
    prismatic(theta=0.7, a=0.1, alpha=-0.4, offset=0.2),
    prismatic(theta=-0.2, alpha=1.1, flip=True, name="slide"),
    revolute(d=0.1, a=-0.2, alpha=0.3, offset=-1.0, flip=True, velocity=2.0, effort=3.0),
]


@pytest.mark.parametrize("convention", ["standard", "modified"])
def test_frames_follow_the_book(convention):
    model = model_from_dh(MIXED, convention)
    for q in ([0.0] * 5, [0.1, -0.4, 0.3, 0.2, 2.5]):
        expected = product(MIXED, q, convention)
        for i in range(1, 6):
            pose = frame_pose(model, np.array(q), model.frame(f"link{i}"))
            np.testing.assert_allclose(pose.matrix(), expected[i], atol=1e-14)


def test_base_tool_and_limits():
    base, tool = SE3.trans(1.0, 2.0, 3.0), SE3.rx(0.5) @ SE3.trans(0.0, 0.0, 0.2)
    model = model_from_dh(MIXED, base=base, tool=tool, configurations={"home": np.full(5, 0.1)})
    q = model.configurations["home"]
    expected = base.matrix() @ product(MIXED, q, "standard")[-1] @ tool.matrix()
    np.testing.assert_allclose(frame_pose(model, q, model.frame(model.tool)).matrix(), expected, atol=1e-14)
    assert model.joint_names == ("joint1", "joint2", "joint3", "slide", "joint5")
    assert model.joints[1].limits.lower == (-1.0,)
    assert (model.velocity_limit[4], model.effort_limit[4]) == (2.0, 3.0)


def test_inertia_stays_in_the_frame_of_the_table():
    inertia = Inertia.from_com(2.0, [-0.1, 0.2, 0.3], np.diag([0.1, 0.2, 0.25]))
    model = model_from_dh([DHRow(d=0.3, a=0.4, alpha=0.5, inertia=inertia)])
    assert model.link("link1").inertia.is_close(inertia)


def test_plain_numbers():
    model = model_from_dh([(0.1, 0.2, 0.3, 0.4), (0.5, 0.0, 0.2, 0.0)], name="two")
    rows = [DHRow(offset=0.1, d=0.2, a=0.3, alpha=0.4), DHRow(offset=0.5, a=0.2)]
    pose = frame_pose(model, np.array([0.3, 0.4]), model.frame("tool")).matrix()
    np.testing.assert_allclose(pose, product(rows, [0.3, 0.4], "standard")[-1], atol=1e-15)


def test_right_angles_are_exact():
    rotation = model_from_dh([revolute(alpha=math.pi / 2), revolute()]).joints[1].placement.rotation
    np.testing.assert_array_equal(rotation, [[1, 0, 0], [0, 0, -1], [0, 1, 0]])


def test_refusals():
    with pytest.raises(UnknownName, match="Did you mean 'modified'"):
        model_from_dh([revolute()], "modfied")
    with pytest.raises(InputError, match="no rows"):
        model_from_dh([])
    with pytest.raises(InputError, match="Row 1 of the Denavit-Hartenberg table has 3 numbers"):
        model_from_dh([(1.0, 2.0, 3.0)])
    with pytest.raises(InputError, match=r"`alpha` of row 2 .* is nan"):
        model_from_dh([revolute(), revolute(alpha=math.nan)])
    with pytest.raises(InputError, match="write the constant part as `offset`"):
        revolute(theta=1.0)
    with pytest.raises(UnknownName, match="Did you mean 'alpha'"):
        prismatic(alhpa=1.0)
    with pytest.raises(UnknownName, match="revolute"):
        model_from_dh([DHRow(moves="revolut")])


@pytest.mark.parametrize(
    ("row", "said"),
    [
        (["x", 0, 0, 0], r"Row 1 .* is \['x', 0, 0, 0\]; expected theta, d, a, alpha"),
        (None, "Row 1 .* is None; expected"),
        (DHRow(a=None), "`a` of row 1 .* is None; expected a number"),  # type: ignore[arg-type]
        (DHRow(d="1"), "`d` of row 1 .* is '1'; expected a number"),  # type: ignore[arg-type]
    ],
)
def test_rows_that_are_no_numbers_are_refused(row, said):
    with pytest.raises(InputError, match=said):
        model_from_dh([row])
