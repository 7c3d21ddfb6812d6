"""Dynamic parameters out and in, drives, payloads, perturbed models."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from support.random_models import random_model
from support.small_robots import arm
from ulna.errors import InputError, ModelError, NonFiniteError, ShapeError, UnknownName
from ulna.model import (
    Drive,
    ModelBuilder,
    Revolute,
    dynamic_parameters,
    lock_joints,
    perturbed,
    with_drives,
    with_dynamic_parameters,
    with_joint_dynamics,
    with_link_inertias,
    with_payload,
)
from ulna.robot import Robot
from ulna.spatial import SE3, Inertia


def test_parameters_go_out_and_in() -> None:
    model = random_model(np.random.default_rng(0))
    p = dynamic_parameters(model)
    assert p.shape == (10 * len(model.joints),)
    assert with_dynamic_parameters(model, p) == model
    other = dynamic_parameters(perturbed(model, 0.3, seed=1))
    changed = with_dynamic_parameters(model, other.reshape(-1, 10))
    np.testing.assert_allclose(dynamic_parameters(changed), other, rtol=1e-12, atol=1e-14)
    assert [link.inertia.mass for link in changed.links if link.joint == -1] == [
        link.inertia.mass for link in model.links if link.joint == -1
    ]


def test_the_links_of_a_changed_body_add_up_to_it() -> None:
    model = arm()
    p = dynamic_parameters(model)
    p[20] *= 2.0  # the third joint carries link2 and the hand
    changed = with_dynamic_parameters(model, p)
    np.testing.assert_allclose(dynamic_parameters(with_link_inertias(changed, {})), p, atol=1e-14)
    assert changed.link("hand").inertia.mass == 0.0
    assert changed.link("link1").inertia.is_close(model.link("link1").inertia)
    np.testing.assert_allclose(
        dynamic_parameters(lock_joints(changed, ["grip"]))[:30], p[:30] + _fingers(model), atol=1e-12
    )


def _fingers(model) -> np.ndarray:
    extra = dynamic_parameters(lock_joints(model, ["grip"]))[:30] - dynamic_parameters(model)[:30]
    return extra


def test_bodies_that_cannot_be_are_refused() -> None:
    model = arm()
    p = dynamic_parameters(model)
    negative = p.copy()
    negative[0] = -1.0
    with pytest.raises(ModelError, match=r"'j0' cannot exist.*physical=True"):
        with_dynamic_parameters(model, negative)
    assert dynamic_parameters(with_dynamic_parameters(model, negative, check=False))[0] == -1.0
    massless = p.copy()
    massless[0] = 0.0
    with pytest.raises(ModelError, match="no mass, but the first moments"):
        with_dynamic_parameters(model, massless, check=False)
    with pytest.raises(ShapeError, match="ten for each of 5 bodies"):
        with_dynamic_parameters(model, p[:-1])
    with pytest.raises(NonFiniteError):
        with_dynamic_parameters(model, p * np.nan)
    with pytest.raises(UnknownName, match="link2"):
        with_link_inertias(model, {"link22": Inertia.from_point(1.0)})


def test_drives_are_seen_through_their_gears() -> None:
    model = with_drives(arm(), {"j0": Drive(2e-4, 1e-3, 0.5, gear=-60.0, torque=0.7)})
    assert model.armature[0] == pytest.approx(2e-4 * 3600)
    assert model.damping[0] == pytest.approx(1e-3 * 3600)
    assert model.friction[0] == pytest.approx(30.0)
    assert model.effort_limit[0] == pytest.approx(42.0)
    assert (model.armature[1:] == arm().armature[1:]).all()
    with pytest.raises(InputError, match="mimics another"):
        with_drives(model, {"grip2": Drive()})
    with pytest.raises(InputError, match="gear"):
        Drive(gear=0.0)
    with pytest.raises(InputError, match="inertia"):
        Drive(inertia=-1.0)


def test_what_mimic_joints_add_is_kept_beside_a_drive_and_replaced_by_the_whole() -> None:
    source, follower = arm().joint("grip"), arm().joint("grip2")
    assert follower.mimic is not None
    ratio, k = follower.mimic.multiplier, source.idx_v
    joints = [replace(j, armature=(0.5,), friction=(0.5,)) if j.name == "grip2" else j for j in arm().joints]
    model = replace(arm(), joints=tuple(joints))
    assert model.armature[k] == pytest.approx(source.armature[0] + ratio**2 * 0.5)
    assert model.friction[k] == pytest.approx(source.friction[0] + abs(ratio) * 0.5)
    driven = with_drives(model, {"grip": Drive(inertia=1e-3, gear=10.0)})
    assert driven.armature[k] == pytest.approx(0.1 + ratio**2 * 0.5)
    with_armature = with_joint_dynamics(model, armature=0.3)
    assert (with_armature.armature == 0.3).all()


def test_numbers_of_the_joints() -> None:
    model = with_joint_dynamics(arm(), damping=0.5, effort=[1.0, 2.0, np.inf, 4.0])
    assert (model.damping == 0.5).all()
    assert model.effort_limit[1] == 2.0
    with pytest.raises(UnknownName, match="damping"):
        with_joint_dynamics(model, dampin=1.0)
    with pytest.raises(ShapeError):
        with_joint_dynamics(model, damping=[1.0, 2.0])
    with pytest.raises(InputError, match="below zero"):
        with_joint_dynamics(model, armature=-1.0)


def test_a_payload_is_a_link_more() -> None:
    model = arm()
    loaded = with_payload(model, "camera", 2.0, (0.0, 0.1, 0.0), (0.1, 0, 0, 0.1, 0, 0.1))
    assert loaded.tool == model.tool
    assert set(loaded.link_names) - set(model.link_names) == {"payload"}
    np.testing.assert_array_equal(loaded.configurations["home"], model.configurations["home"])
    spot = model.frame("camera")
    body = Inertia.from_com(2.0, (0.0, 0.1, 0.0), (0.1, 0, 0, 0.1, 0, 0.1))
    expected = model.inertias[spot.joint] + spot.placement.act(body)
    assert loaded.inertias[spot.joint].is_close(expected, 1e-12)
    with pytest.raises(ModelError, match="name"):
        with_payload(loaded)
    both = with_payload(loaded, None, 1.0, name="cup")
    assert both.mass == pytest.approx(model.mass + 3.0)
    with pytest.raises(UnknownName, match="camera"):
        with_payload(model, "camra")
    with pytest.raises(InputError, match="mass"):
        with_payload(model, mass=-1.0)


def test_perturbed_models_are_near_and_possible() -> None:
    model = random_model(np.random.default_rng(3))
    other = perturbed(model, 0.2, seed=4, com=0.001)
    assert other == perturbed(model, 0.2, seed=4, com=0.001) != perturbed(model, 0.2, seed=5, com=0.001)
    for before, after in zip(model.links, other.links, strict=True):
        assert abs(after.inertia.mass / before.inertia.mass - 1.0) <= 0.2
        assert np.abs(after.inertia.com - before.inertia.com).max() <= 0.001
        assert after.inertia.is_physical()
    assert perturbed(model, 0.0).mass == pytest.approx(model.mass)
    for wrong in ({"fraction": 1.0}, {"fraction": -0.1}, {"com": -1.0}):
        with pytest.raises(InputError):
            perturbed(model, **wrong)


def test_a_changed_model_keeps_the_place_of_links() -> None:
    model = arm()
    loaded = with_payload(model, "tcp", 1.0)
    for name in model.link_names:
        before, after = model.link(name).placement, loaded.link(name).placement
        assert SE3.is_close(before, after)


def test_robots_offer_the_same() -> None:
    robot = Robot(arm())
    p = robot.dynamic_parameters
    assert robot.with_dynamic_parameters(p) == robot
    assert robot.with_link_inertias({robot.model.links[0].name: robot.model.links[0].inertia}) == robot
    assert robot.with_payload("camera", 2.0).model == with_payload(robot.model, "camera", 2.0)
    assert robot.perturbed(0.2, 1).model == perturbed(robot.model, 0.2, 1)
    negative = p.copy()
    negative[0] = -1.0
    assert robot.with_dynamic_parameters(negative, check=False).dynamic_parameters[0] == -1.0


def test_a_payload_at_a_joint_frame_is_not_put_on_the_link_of_that_name() -> None:
    builder = ModelBuilder("crossed").add_link("base")
    builder.add_link("shoulder").add_link("elbow")
    builder.add_joint("elbow", Revolute((0, 0, 1)), "base", "shoulder")
    builder.add_joint("shoulder", Revolute((0, 0, 1)), "shoulder", "elbow", SE3.trans(0.5, 0.0, 0.0))
    model = builder.build()
    loaded = with_payload(model, "joint:elbow", 2.0)
    assert loaded.frame("payload").joint == model.frame("joint:elbow").joint == 0
    assert loaded.link("payload").parent == "shoulder"
    assert dynamic_parameters(loaded)[[0, 10]].tolist() == [2.0, 0.0]


@pytest.mark.parametrize(
    "values",
    [
        {"inertia": "x"}, {"inertia": None}, {"friction": None}, {"inertia": np.ones(2)}, {"damping": -1.0},
        {"backward": -1.0}, {"torque": np.nan}, {"gear": None}, {"gear": 0.0}, {"gear": 1e200},
        {"inertia": 1e300, "gear": 1e10},
    ],
)  # fmt: skip
def test_drives_that_cannot_be_are_refused(values: dict[str, Any]) -> None:
    name = list(values)[-1]
    with pytest.raises(InputError, match=f"`{name}`.* is "):
        Drive(**values)


@pytest.mark.parametrize("drives", [None, ["joint1"], 3])
def test_drives_come_by_name_of_the_joint(drives: Any) -> None:
    with pytest.raises(InputError, match="expected drives by name of the joint"):
        with_drives(arm(), drives)
    name = arm().joints[0].name
    with pytest.raises(InputError, match=f"The drive of joint '{name}' is 3; expected a Drive"):
        with_drives(arm(), {name: 3})  # pyright: ignore[reportArgumentType]
