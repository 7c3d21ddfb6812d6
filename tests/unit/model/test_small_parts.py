"""Small parts of models: descriptions, refusals with what was given, and paths that few robots take."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import ulna
from ulna.errors import InputError, ModelError, ShapeError, UnknownAttribute, UnknownName
from ulna.model import ModelBuilder, position
from ulna.model.constraint import FrameContact, FrameLoop, PointContact, PointLoop, frame_pairs
from ulna.model.inertial import dynamic_parameters, with_dynamic_parameters
from ulna.model.joints import (
    Circle,
    Composite,
    ConstantVelocity,
    Continuous,
    Cylindrical,
    Fixed,
    FreeFlyer,
    Helical,
    JointKind,
    Planar,
    PlanarCircle,
    Prismatic,
    Revolute,
    Rolling,
    Spherical,
    Translation,
    Universal,
)
from ulna.model.named import Named
from ulna.spatial import SE3

SKEWED = (0.6, 0.8, 0.0)
KINDS: list[tuple[JointKind, str, str, int]] = [
    (Revolute(), "revolute z", "R", 1),
    (Continuous((-1.0, 0.0, 0.0)), "continuous -x", "R", 1),
    (Revolute(SKEWED), "revolute (0.6, 0.8, 0)", "R", 1),
    (Prismatic((0.0, 1.0, 0.0)), "prismatic y", "P", 1),
    (Circle(), "continuous z (cos, sin)", "R", 2),
    (Helical((1.0, 0.0, 0.0), 0.25), "helical x, 0.25 m/rad", "H", 1),
    (Cylindrical(SKEWED), "cylindrical (0.6, 0.8, 0)", "C", 2),
    (ConstantVelocity(), "constant velocity", "K", 2),
    (ConstantVelocity(0.04), "constant velocity, 0.04 m", "K", 2),
    (Rolling(0.02, 0.01), "rolling 0.01 m on 0.02 m", "O", 1),
    (Planar(), "planar z", "", 3),
    (PlanarCircle(), "planar z (cos, sin)", "", 4),
    (Spherical(), "spherical", "", 4),
    (FreeFlyer(), "free flyer", "", 7),
    (Translation(), "translation", "", 3),
    (Fixed(), "fixed", "", 0),
    (Composite((Revolute(), Prismatic((1.0, 0.0, 0.0)))), "revolute z + prismatic x", "RP", 2),
]


@pytest.mark.parametrize(("kind", "text", "symbol", "nq"), KINDS, ids=[text for _, text, _, _ in KINDS])
def test_joints_are_described(kind: JointKind, text: str, symbol: str, nq: int) -> None:
    assert kind.describe() == text
    assert kind.nq == nq
    assert kind.symbol == symbol or not symbol
    if isinstance(kind, Universal):
        assert kind.nv == 2


@pytest.mark.parametrize("kind", [kind for kind, *_ in KINDS if kind.nq])
def test_coordinate_rates_are_those_of_a_small_step(kind: JointKind) -> None:
    rng = np.random.default_rng(3)
    q, v = np.asarray(kind.random(rng)), rng.normal(size=kind.nv)
    h = 1e-6
    forward, backward = (np.asarray(kind.integrate(q, sign * h * v)) for sign in (1.0, -1.0))
    np.testing.assert_allclose(kind.coordinate_rates(q, v), (forward - backward) / (2 * h), atol=1e-8)
    assert np.asarray(kind.random(rng, size=(5,))).shape == (5, kind.nq)
    np.testing.assert_allclose(kind.normalize(np.asarray(kind.random(rng))).shape, (kind.nq,))


def test_random_positions_are_drawn_within_the_limits_there_are() -> None:
    rng, kind, inf = np.random.default_rng(2), Prismatic(), np.inf
    free = kind.coordinates[0]
    width = free.high - free.low
    for low, high, expected in (
        (-3.0, -2.5, (-3.0, -2.5)),
        (5.0, inf, (5.0, 5.0 + width)),
        (-inf, -5.0, (-5.0 - width, -5.0)),
        (-inf, inf, (free.low, free.high)),
    ):
        drawn = np.asarray(kind.random(rng, np.array([low]), np.array([high]), (2000,)))
        assert expected[0] <= drawn.min() < expected[0] + 0.1 * (expected[1] - expected[0])
        assert expected[1] >= drawn.max() > expected[1] - 0.1 * (expected[1] - expected[0])
    places = np.asarray(PlanarCircle().random(rng, np.full(4, -0.5), np.full(4, 0.5), (2000,)))
    assert 0.45 < np.abs(places[:, :2]).max() <= 0.5
    np.testing.assert_allclose(np.linalg.norm(places[:, 2:], axis=1), 1.0)
    angles = np.arctan2(places[:, 3], places[:, 2])
    assert angles.min() < -3.1 and angles.max() > 3.1


@pytest.mark.parametrize(
    ("make", "error", "text"),
    [
        (lambda: Composite(()), InputError, "`kinds` is empty"),
        (lambda: Composite((Fixed(),)), InputError, "among the kinds"),
        (lambda: Composite((Composite((Revolute(),)),)), InputError, "among the kinds"),
        (lambda: Composite((3,)), InputError, "3 is among the kinds"),  # type: ignore[arg-type]
        (
            lambda: Composite((Revolute(), Revolute()), (SE3.identity(),)),
            InputError,
            "2 kinds but 1 placements",
        ),
        (lambda: PointContact(3), InputError, "`frame` is 3; expected the name"),  # type: ignore[arg-type]
        (lambda: PointLoop("a", 3), InputError, "expected the name of a frame"),  # type: ignore[arg-type]
        (lambda: PointContact("a", (1, 2)), ShapeError, r"\(3,\)"),  # type: ignore[arg-type]
        (lambda: PointContact("a", np.ones((2, 3))), ShapeError, r"\(3,\)"),  # type: ignore[arg-type]
        (lambda: PointContact("a", axes="locla"), UnknownName, "'local'"),  # type: ignore[arg-type]
        (lambda: FrameContact("a", np.eye(4)), InputError, "expected one SE3"),  # type: ignore[arg-type]
        (lambda: FrameContact("a", SE3(np.eye(3), np.ones((2, 3)))), InputError, "expected one SE3"),
    ],
)
def test_joints_and_constraints_are_checked_when_they_are_made(
    make: Callable[[], Any], error: type[Exception], text: str
) -> None:
    with pytest.raises(error, match=text):
        make()


def test_constraints_keep_copies_of_poses() -> None:
    T = np.eye(4)
    contact = FrameContact("a", SE3(T))
    T[:3, 3] = 0.5
    assert contact == FrameContact("a") and not contact.placement.translation.flags.writeable


def test_constraints_are_equal_by_value_and_name_what_they_hold() -> None:
    assert PointContact("a", (1, 2, 3)) == PointContact("a", (1.0, 2.0, 3.0))
    assert hash(PointContact("a")) == hash(PointContact("a"))
    assert PointContact("a") != PointContact("b") != FrameContact("b")
    assert PointContact("a") != PointContact("a", axes="local")
    assert PointContact("a").size == 3 and FrameContact("a").size == 6
    assert PointContact("a").is_contact and not PointLoop("a", "b").is_contact
    ((name, pose),) = PointContact("a", (1, 2, 3)).ends()
    assert name == "a"
    np.testing.assert_array_equal(pose.translation, (1, 2, 3))
    ((name, pose),) = FrameContact("b", SE3(np.eye(3), np.ones(3))).ends()
    assert name == "b"
    np.testing.assert_array_equal(pose.translation, 1.0)


def test_constraints_that_bind_nothing_are_refused() -> None:
    model = ulna.load("panda").model
    tip, base = model.tool, model.links[0].name
    (frame_pair,) = frame_pairs(model, FrameContact(tip, axes="local"))
    assert frame_pair.size == 6 and frame_pair.local is True and frame_pair.second is None
    assert frame_pairs(model, [PointContact(tip)])[0].local is False
    for constraints, text in (
        ([], "`constraints` is empty"),
        (["a"], "expected a list of PointContact"),
        (FrameContact(base), "no joint moves"),
        (FrameLoop(tip, tip), "between frames of one body"),
    ):
        with pytest.raises(InputError, match=text):
            frame_pairs(model, constraints)  # type: ignore[arg-type]
    with pytest.raises(UnknownName):
        frame_pairs(model, PointContact("nothing"))


def test_named_values_are_read_by_name_only() -> None:
    named: Named[Any] = Named("joint", {"a": np.arange(3.0), "b": 2.0})
    assert len(named) == 2 and list(named) == ["a", "b"] and "a" in named and "c" not in named
    assert named.get("c", 7) == 7 and named.get("b") == 2.0 and named.get("c") is None
    assert named == {"a": [0.0, 1.0, 2.0], "b": 2.0}
    assert all(named != other for other in ({"a": [0.0, 1.0, 3.0], "b": 2.0}, {"b": 2.0}, 3))
    assert pickle.loads(pickle.dumps(named)) == named
    assert repr(Named("joint", {"x": 1})) == "{'x': 1}"
    with pytest.raises(ValueError, match="read-only"):
        named["a"][0] = 5.0
    with pytest.raises(UnknownName, match="No joint named 'c'"):
        _ = named["c"]
    with pytest.raises(UnknownAttribute, match=r'\["a"\]'):
        _ = named.a
    with pytest.raises(AttributeError, match="has no attribute 'c'"):
        _ = named.c


def test_massless_bodies_keep_their_inertia() -> None:
    model = ulna.load("ur5").model
    parameters = dynamic_parameters(model).reshape(-1, 10).copy()
    parameters[2] = (0, 0, 0, 0, 0.3, 0.01, 0.4, 0.02, 0.03, 0.5)
    changed = with_dynamic_parameters(model, parameters)
    np.testing.assert_allclose(dynamic_parameters(changed).reshape(-1, 10)[2], parameters[2], atol=1e-12)
    parameters[2, 1] = 0.1
    with pytest.raises(ModelError, match="no mass, but the first moments"):
        with_dynamic_parameters(model, parameters)
    parameters[2] = (1, 0, 0, 0, 0.1, 0, 0.1, 0, 0, 0.5)  # breaks the triangle inequality
    with pytest.raises(ModelError):
        with_dynamic_parameters(model, parameters)
    assert with_dynamic_parameters(model, parameters, check=False).nq == 6
    assert dynamic_parameters(ulna.load('<robot name="r"><link name="a"/></robot>').model).shape == (0,)


def test_models_show_their_sizes() -> None:
    model = ulna.load("ur5").model
    assert repr(model) == f"<Model {model.name!r}: 6 joints, nq=6, nv=6, tool={model.tool!r}>"
    assert str(model) == model.table()


def test_positions_that_are_none_are_refused() -> None:
    builder = ModelBuilder("r").add_link("a").add_link("b").add_link("c")
    builder.add_joint("turn", Circle(), "a", "b").add_joint("ball", Spherical(), "b", "c")
    circles, panda = builder.build(), ulna.load("panda").model
    for model, q, base, text in (
        (
            circles,
            {"turn": [0.0, 0.0]},
            None,
            r"\(cosine, sine\) of joint 'turn' in q is not of unit length, but of 0\.",
        ),
        (
            circles,
            {"turn": [0.0, 2.0]},
            None,
            r"\(cosine, sine\) of joint 'turn' in q is not of unit length, but of 2\.",
        ),
        (
            circles,
            {"ball": 2.0 * np.eye(4)[3]},
            None,
            "quaternion of joint 'ball' in q is not of unit length",
        ),
        (panda, {}, np.zeros(3), r"base has shape \(3,\); expected \(7,\)"),
        (panda, np.zeros(7, dtype=complex), None, "expected 7 numbers"),
        (panda, ["0"] * 7, None, "expected 7 numbers"),
        (panda, {"panda_joint1": "0.5"}, None, "expected 1 numbers"),
        (panda, {"panda_joint1": 0.5j}, None, "expected 1 numbers"),
    ):
        with pytest.raises(ModelError, match=text):
            position(model, q, base=base)
    q = np.arange(7.0) / 10.0
    assert not np.shares_memory(position(panda, q), q)
    np.testing.assert_array_equal(position(panda, {"panda_joint1": 1}, base=q), [1.0, *q[1:]])
    np.testing.assert_allclose(position(circles, {"turn": [0.0, 1.0005]})[:2], [0.0, 1.0])
