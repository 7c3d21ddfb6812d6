"""Chains of elementary transforms, as objects and as text."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ulna.algorithms.kinematics.forward_kinematics import frame_pose
from ulna.errors import InputError, ShapeError
from ulna.formats.ets import ET, ETS
from ulna.loading import load_model
from ulna.spatial import SE3

PANDA = """tz(0.333) Rz(q0) Rx(-90 deg) Rz(q1) Rx(90°) tz(0.316) Rz(q2) tx(0.0825) Rx(pi/2) Rz(q3)
 tx(-0.0825) Rx(-pi/2) tz(0.384) Rz(q4) Rx(pi/2) Rz(q5) tx(0.088) Rx(pi / 2) tz(0.107) Rz(q6)
 Rz(-45 degrees) tz(0.1034)"""


def test_text_gives_the_panda():
    chain = ETS.parse(PANDA)
    panda = load_model("panda", visuals="simple")
    model = chain.model("p", joint_names=panda.joint_names)
    tool = panda.frame("panda_hand_tcp")
    rng = np.random.default_rng(0)
    for q in (panda.configurations["qr"], rng.normal(size=7)):
        expected = frame_pose(panda, q, tool).matrix()
        np.testing.assert_allclose(chain.transform(q).matrix(), expected, atol=1e-14)
        np.testing.assert_allclose(
            frame_pose(model, q, model.frame(model.tool)).matrix(), expected, atol=1e-14
        )
    assert model.joint_names == panda.joint_names


def test_batches():
    chain = ETS.parse(PANDA)
    q = np.random.default_rng(1).normal(size=(4, 3, 7))
    poses = chain.transform(q).matrix()
    assert poses.shape == (4, 3, 4, 4)
    np.testing.assert_allclose(poses[2, 1], chain.transform(q[2, 1]).matrix(), atol=1e-15)


def test_symbols_and_traces():
    sympy = pytest.importorskip("sympy")
    from ulna.compiler import trace

    chain = ETS.parse("tz(0.5) Rz(q) tx(2) Rx(90 deg) tx(-q)")
    a, b = sympy.symbols("a b")
    pose = chain.transform(np.array([a, b], dtype=object))
    assert sympy.simplify(pose.translation[0] - (2 - b) * sympy.cos(a)) == 0
    function = trace(lambda q: chain.transform(q).matrix(), q=(2,))
    q = np.array([0.3, 0.7])
    np.testing.assert_allclose(function(q), chain.transform(q).matrix(), atol=1e-15)


def test_objects_compose():
    chain = ET.rz() * ET.tx(0.3) * ET.rz(flip=True) * (ET.tx(0.2) * ET.tz(limits=(0.0, 0.5)))
    assert chain.n == 3
    assert len(chain) == 5
    assert str(chain) == "Rz(q0) tx(0.3) Rz(-q1) tx(0.2) tz(q2)"
    assert ETS.parse(str(chain))[:4] == ETS.parse("Rz(q0)tx(.3)rz(-q1) * TX(0.2)")
    q = np.array([0.4, 0.1, 0.2])
    expected = SE3.rz(0.4) @ SE3.trans(0.3, 0, 0) @ SE3.rz(-0.1) @ SE3.trans(0.2, 0, 0.2)
    assert chain.transform(q).is_close(expected)
    model = chain.model(configurations={"home": q})
    assert frame_pose(model, q, model.frame("tool")).is_close(expected)
    assert (model.joints[2].limits.lower, model.joints[2].limits.upper) == ((0.0,), (0.5,))
    np.testing.assert_array_equal(model.configurations["home"], q)


def test_a_pose_and_a_repeated_coordinate():
    pose = SE3.from_rpy([0.1, 0.2, 0.3], [1.0, 2.0, 3.0])
    chain = ET.se3(pose) * ET.ry(index=0) * ET.tx(1.0) * ET.ry(index=0, flip=True) * ET.tx(0.5)
    assert chain.n == 1
    model = chain.model()
    assert (model.nq, len(model.joints)) == (1, 2)
    q = np.array([0.7])
    expected = pose @ SE3.ry(0.7) @ SE3.trans(1, 0, 0) @ SE3.ry(-0.7) @ SE3.trans(0.5, 0, 0)
    assert chain.transform(q).is_close(expected)
    assert frame_pose(model, q, model.frame("tool")).is_close(expected)
    assert str(chain).startswith("SE3(...) Ry(q0) tx(1) Ry(-q0)")


def test_right_angles_are_exact():
    rotation = ETS.parse("Rx(90 deg) Rz(q)").model().joints[0].placement.rotation
    np.testing.assert_array_equal(rotation, [[1, 0, 0], [0, 0, -1], [0, 1, 0]])


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("Rx(pi)", math.pi),
        ("Rx(-pi/2)", -math.pi / 2),
        ("Rx(3*pi/4)", 3 * math.pi / 4),
        ("Rx(-0.5pi)", -math.pi / 2),
        ("rx(90 deg)", math.pi / 2),
        ("RX( 1e-3 )", 1e-3),
    ],
)
def test_numbers(text, value):
    assert ETS.parse(text)[0].value == pytest.approx(value, abs=0.0, rel=1e-15)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "The chain is empty"),
        ("Rz(q0) foo(1)", "cannot be read at 'foo(1)' (character 7)"),
        ("Rz(q0", "cannot be read at 'Rz(q0'"),
        ("Rw(1)", "cannot be read at 'Rw(1)'"),
        ("tx(90 deg)", "tx(90 deg): a distance is in metres, not degrees."),
        ("Rx(one)", "'one' is neither a number (0.5, 90 deg, pi/2) nor a joint"),
        ("Rx(pi/0)", "is neither a number"),
        ("Rx(nan)", "expected a finite angle [rad]"),
        ("tx(inf)", "expected a finite distance [m]"),
        ("Rx()", "is neither a number"),
    ],
)
def test_refused_text(text, words):
    with pytest.raises(InputError) as caught:
        ETS.parse(text)
    assert words in str(caught.value)


def test_refusals():
    with pytest.raises(InputError, match="The chain has no joint"):
        ETS.parse("tx(1)").model()
    with pytest.raises(InputError, match="order q1, q0; expected q0, q1"):
        ETS.parse("Rz(q1) Rz(q0)").model()
    with pytest.raises(InputError, match="2 names; the chain has 1 joints"):
        ETS.parse("Rz(q)").model(joint_names=["a", "b"])
    with pytest.raises(InputError, match="a constant has no flip"):
        ET.rx(0.5, flip=True)
    with pytest.raises(ShapeError, match=r"\(\.\.\., 2\)"):
        ETS.parse("Rz(q) Rz(q)").transform([1.0])
    with pytest.raises(TypeError):
        ET.rx(0.5) * 3  # type: ignore[operator]
