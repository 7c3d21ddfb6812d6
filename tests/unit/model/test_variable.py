"""The parameters of a model by name: what is refused, and what stays."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

import ulna
from support.random_models import random_model
from support.small_robots import arm
from ulna import kernels
from ulna.errors import DtypeError, InputError, ModelError, NonFiniteError, ShapeError, UnknownName
from ulna.model import (
    Composite,
    Helical,
    JointKind,
    Revolute,
    Spherical,
    Translation,
    parameter_names,
    parameters,
    with_parameters,
    with_root_joint,
)
from ulna.robot import Robot
from ulna.spatial import SE3


def test_names_and_shapes() -> None:
    model = arm()
    assert parameter_names(model) == (
        *("base", "placement", "shift", "offset", "tool", "inertia", "gravity"),
        *("armature", "damping", "friction", "frame:tcp", "frame:camera"),
    )
    shapes = {name: parameters(model, name).shape for name in parameter_names(model)}
    assert shapes["inertia"] == (50,) and shapes["placement"] == (5, 6) and shapes["shift"] == (5, 3)
    assert shapes["offset"] == (4,)
    assert shapes["armature"] == (4,) and shapes["gravity"] == (3,) and shapes["frame:camera"] == (6,)
    assert parameters(with_root_joint(model, Spherical()), "offset").shape == (4,)


@pytest.mark.parametrize("name", ["placment", "frame:camra"])
def test_unknown_names_offer_the_nearest(name: str) -> None:
    for ask in (
        lambda: parameters(arm(), name),
        lambda: with_parameters(arm(), {name: np.zeros(6)}),
        lambda: kernels.function(arm(), "fk", parameters=(name,)),
        lambda: kernels.kernel(arm(), "fk", parameters=(name,)),
    ):
        with pytest.raises(UnknownName, match=r"Did you mean '(placement|camera)'"):
            ask()


def test_unknown_parameters_are_refused() -> None:
    model = arm()
    with pytest.raises(ShapeError, match=r"`placement` has shape \(30,\); expected .*5, 6\)"):
        with_parameters(model, {"placement": np.zeros(30)})
    with pytest.raises(ShapeError, match=r"`base` has shape \(7, 6\); expected \(6,\).*robot.kernel"):
        with_parameters(model, {"base": np.zeros((7, 6))})
    with pytest.raises(DtypeError, match="`gravity`"):
        with_parameters(model, {"gravity": "down"})
    with pytest.raises(NonFiniteError, match=r"`placement\[1, 2\]` is nan"):
        with_parameters(model, {"placement": np.where(np.arange(30).reshape(5, 6) == 8, np.nan, 0.0)})
    with pytest.raises(ModelError, match="'j0' cannot exist"):
        with_parameters(model, {"inertia": -parameters(model, "inertia")})
    with pytest.raises(InputError, match="none below zero"):
        with_parameters(model, {"damping": -np.ones(4)})
    with pytest.raises(InputError, match="names 'base' 2 times"):
        kernels.kernel(model, "fk", parameters=("base", "base"))
    link = ulna.model.with_tool(model, "hand")
    for ask in (lambda: parameters(link, "tool"), lambda: kernels.kernel(link, "fk", parameters="tool")):
        with pytest.raises(InputError, match=r"'hand', the frame of a link.*robot.with_tool\('hand'"):
            ask()
    composite = random_model(np.random.default_rng(0), ["composite"], mimics=0)
    with pytest.raises(InputError, match=r"'joint0'.*parameters=\(\"offset\",\)"):
        with_parameters(composite, {"offset": np.ones(4)})
    assert with_parameters(composite, {"offset": np.zeros(4)}) == composite


@pytest.mark.parametrize("kind", [Revolute((0, 1, 0)), Helical((1, 2, 0), 0.3), Translation()])
def test_an_offset_of_a_composite_of_one_kind_is_part_of_the_model(kind: JointKind) -> None:
    """The kind has a placement of its own, on which the offset comes."""
    builder = ulna.ModelBuilder("one").add_link("base").add_link("arm")
    place = SE3.from_rpy((0.3, -0.4, 0.5), (0.1, 0.2, 0.3))
    model = builder.add_joint("j", Composite((kind,), (place,)), "base", "arm", place).build()
    offset, q = np.full(kind.nq, 0.7), np.full(kind.nq, 0.2)
    changed = Robot(with_parameters(model, {"offset": offset}))
    np.testing.assert_allclose(changed.function("fk")(q), Robot(model).function("fk")(q + offset), atol=1e-15)


def test_links_and_limits_follow() -> None:
    model = arm()
    moved = with_parameters(model, {"placement": np.full((5, 6), 0.1), "gravity": [0.0, 0.0, -1.62]})
    assert (moved.gravity == [0.0, 0.0, -1.62]).all()
    assert moved.link("link1").origin.is_close(moved.joint("j1").placement)
    assert (moved.lower_position == model.lower_position).all()
    assert dict(moved.configurations).keys() == dict(model.configurations).keys()
    assert (moved.joint("j0").placement.rotation.flags.writeable, moved == model) == (False, False)


def test_kernels_are_kept_pickled_and_checked() -> None:
    robot = Robot(arm())
    kernel = robot.kernel("fk", parameters=["placement", "frame:tcp"])
    assert kernel is robot.kernel("fk", parameters=("placement", "frame:tcp"))
    assert kernel is not robot.kernel("fk", parameters=("frame:tcp", "placement"))
    assert kernel.function.name == "fk" and "Parameters: placement, frame:tcp" in kernel.__doc__
    q, own = robot.configurations["home"], [robot.parameters(name) for name in ("placement", "frame:tcp")]
    np.testing.assert_allclose(kernel(q, *own), robot.fk(q), atol=1e-15)
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(kernel))(q, *own), kernel(q, *own))
    checked = robot.kernel("fk", parameters="base", checked=True)
    with pytest.raises(NonFiniteError, match="`base"):
        checked(q, np.full(6, np.nan))
    with pytest.raises(ShapeError, match="base"):
        checked(q, np.zeros(5))


def test_a_robot_with_nothing_to_offset() -> None:
    robot = Robot(random_model(np.random.default_rng(0), ["spherical"], mimics=0))
    kernel = robot.kernel("fk", parameters="offset")
    q = robot.random_configuration(seed=0)
    np.testing.assert_allclose(kernel(q, robot.parameters("offset")), robot.fk(q))


def test_operation_counts_of_parameters() -> None:
    """Scalar operations of the Panda's inverse dynamics; the kernel with constants has 624."""
    model = ulna.load("panda").model
    for names, budget in {
        "inertia": 720,
        "gravity": 650,
        "offset": 635,
        "shift": 890,
        "placement": 1750,
    }.items():
        assert kernels.function(model, "inverse_dynamics", parameters=names).operations <= budget, names


def test_a_robot_with_other_parameters() -> None:
    robot = Robot(arm())
    half = robot.with_parameters(
        {"inertia": 0.5 * robot.dynamic_parameters, "tool": [0.0, 0.0, 0.1, 0.0, 0.0, 0.0]}
    )
    assert half.total_mass() == pytest.approx(0.5 * robot.total_mass())
    q = robot.configurations["home"]
    np.testing.assert_allclose(half.fk(q), robot.fk(q) @ SE3.trans(0.0, 0.0, 0.1).matrix(), atol=1e-14)
