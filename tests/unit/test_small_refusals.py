"""Defaults and messages that no other test looks at: mutation sampling found each of them unguarded."""

from __future__ import annotations

import builtins
import inspect
from typing import Any

import numpy as np
import pytest

import ulna
from support.random_models import random_model
from ulna.errors import InputError, MissingExtra, ModelError, UnknownName
from ulna.ik import ComTask, DifferentialIK, PostureTask
from ulna.model import ModelBuilder, PointContact, Revolute
from ulna.robot import Robot
from ulna.spatial import SO3
from ulna.trajectory import quintic
from ulna.viewer.page.port import checked_port


@pytest.fixture(scope="module")
def panda() -> Robot:
    return ulna.load("panda", visuals="simple")


def test_the_target_of_a_task_for_the_centre_of_mass_is_its_default(panda: Robot) -> None:
    q = np.array(panda.configurations["qr"])
    target = panda.center_of_mass(q) + [0.02, 0.01, -0.02]
    given = DifferentialIK(panda, [ComTask(target=target), PostureTask(1e-3, target="qr")])
    adjustable = DifferentialIK(panda, [ComTask(), PostureTask(1e-3, target="qr")])
    v = given.velocity(q, 0.01)
    np.testing.assert_allclose(v, adjustable.velocity(q, 0.01, com=target), atol=1e-12)
    assert np.abs(v).max() > 0.1
    np.testing.assert_allclose(given.velocity(q, 0.01, com=panda.center_of_mass(q)), 0.0, atol=1e-6)
    with pytest.raises((InputError, TypeError, UnknownName), match="com"):
        adjustable.velocity(q, 0.01)


@pytest.mark.parametrize(
    "axes",
    [
        "",
        "x",
        "xy",
        "xyzx",
        "xya",
        "axy",
        "xay",
        "XYZ",
        "xxy",
        "xyy",
        "xxx",
        None,
        3,
        1.5,
        ["xy", "z"],
        b"xyz",
    ],
)
def test_invalid_euler_axes_are_refused(axes: Any) -> None:
    rotation = SO3.rx(0.3)
    for call in (lambda: rotation.euler(axes), lambda: SO3.from_euler([0.1, 0.2, 0.3], axes)):
        with pytest.raises(InputError, match="`axes` is .*; expected three of the letters x, y, z"):
            call()


@pytest.mark.parametrize("axes", ["xyz", "zyz", "yxy", "zyx"])
def test_euler_axes_there_are(axes: str) -> None:
    angles = [0.1, 0.2, 0.3]
    np.testing.assert_allclose(SO3.from_euler(angles, axes).euler(axes), angles, atol=1e-12)


def test_pictures_of_trajectories_name_what_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    motion = quintic([0.0], [1.0], 1.0)
    real = builtins.__import__

    def refuse(name: str, *rest: Any, **more: Any) -> Any:
        if name.split(".", maxsplit=1)[0] == "matplotlib":
            raise ImportError(name)
        return real(name, *rest, **more)

    monkeypatch.setattr(builtins, "__import__", refuse)
    with pytest.raises(
        MissingExtra, match="Plotting a trajectory needs the package 'matplotlib'.*'matplotlib>="
    ) as e:
        motion.plot()
    assert (e.value.package, e.value.extra) == ("matplotlib", "plot")


@pytest.mark.parametrize("zeros", ["all", "some", "none"])
def test_impacts_of_joints_that_stand_still(zeros: str) -> None:
    robot = Robot(
        random_model(np.random.default_rng(5), ["revolute", "prismatic", "revolute"], root="free_flyer")
    )
    q = robot.random_configuration(seed=1)
    v = np.random.default_rng(2).standard_normal(robot.nv)
    v[{"all": slice(None), "some": slice(0, None, 2), "none": slice(0, 0)}[zeros]] = 0.0
    held = [PointContact("tip", (0.1, 0.0, 0.0))]
    impact = robot.impulse_dynamics(q, v, held)
    J, M = robot.constraint_jacobian(q, held), robot.mass_matrix(q)
    np.testing.assert_allclose(J @ impact.v, 0.0, atol=1e-9)
    np.testing.assert_allclose(M @ (impact.v - v), J.T @ impact.impulses, atol=1e-8)
    if zeros == "all":
        assert not impact.v.any() and not impact.impulses.any()
    else:
        assert np.abs(impact.impulses).max() > 1e-3
    plain = ulna.algorithms.impulse_dynamics  # the same on floats, without the compiler
    found = ulna.model.constraint.frame_pairs(robot.model, held)
    expected = plain(robot.model, q, v, found, np.zeros(1))
    np.testing.assert_allclose(impact.v, expected.v, atol=1e-8)
    np.testing.assert_allclose(impact.impulses, expected.impulses, atol=1e-8)


def test_an_unknown_joint_is_named_with_its_like(panda: Robot) -> None:
    with pytest.raises(UnknownName, match="No joint named 'panda_jonit3'. Did you mean 'panda_joint3'"):
        panda.model.joint_index("panda_jonit3")
    fixed = next(f.name for f in panda.model.frames if f.kind == "fixed_joint")
    with pytest.raises(UnknownName, match="That joint is fixed"):
        panda.model.joint_index(fixed)
    for call in (panda.model.joint, panda.model.joint_index):
        with pytest.raises(
            UnknownName, match="No joint named 'xyz'. There are: 'panda_joint1', 'panda_joint2'"
        ):
            call("xyz")


def test_long_lists_of_names_end_with_their_number() -> None:
    with pytest.raises(UnknownName) as caught:
        raise UnknownName("thing", "#", [f"name{k}" for k in range(13)])
    assert str(caught.value).endswith("'name11', ... (13 in all).")
    with pytest.raises(UnknownName) as caught:
        raise UnknownName("thing", "#", [f"name{k}" for k in range(12)])
    assert str(caught.value).endswith("'name10', 'name11'.")
    with pytest.raises(UnknownName, match="There is no thing at all"):
        raise UnknownName("thing", "#", [])


def test_the_first_of_two_of_a_name_is_named_with_its_place() -> None:
    builder = ModelBuilder("twice")
    builder.add_link("a", where="file.urdf:3")
    with pytest.raises(
        ModelError, match=r"file.urdf:9: There are two links named 'a', the first one at file.urdf:3\."
    ):
        builder.add_link("a", where="file.urdf:9")
    plain = ModelBuilder("twice").add_link("a").add_link("b").add_joint("j", Revolute(), "a", "b")
    with pytest.raises(ModelError, match=r"There are two joints named 'j'\. Rename one of them"):
        plain.add_joint("j", Revolute(), "a", "b")


def test_the_port_of_a_page_is_that_of_the_environment_or_8080(monkeypatch: pytest.MonkeyPatch) -> None:
    for opens in (ulna.show, ulna.Viewer.__init__):
        assert inspect.signature(opens).parameters["port"].default is None
    monkeypatch.delenv("ULNA_PORT", raising=False)
    assert (checked_port(None), checked_port(0)) == (8080, 0)
    monkeypatch.setenv("ULNA_PORT", " 9100")
    assert (checked_port(None), checked_port(7000)) == (9100, 7000)
    for wrong in ("80 80", "-1", "65536", "http", "²"):
        monkeypatch.setenv("ULNA_PORT", wrong)
        with pytest.raises(InputError, match=f"ULNA_PORT='{wrong}'.*0 .any free one. to 65535"):
            checked_port(None)
