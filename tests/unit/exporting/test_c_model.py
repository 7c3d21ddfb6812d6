"""Constants of a robot in exported C, and names that they leave to functions."""

from __future__ import annotations

import ctypes
from pathlib import Path

import numpy as np
import pytest

import ulna
from support.c_library import library
from ulna.errors import InputError
from ulna.model import Prismatic, Revolute


def doubles(lib: ctypes.CDLL, name: str, count: int) -> list[float]:
    """An array of doubles of a library."""
    return list((ctypes.c_double * count).in_dll(lib, name))


def test_limits_and_configurations_are_those_of_the_robot(tmp_path: Path) -> None:
    builder = ulna.ModelBuilder('two "joints"')
    for link in ("base", "one", "two"):
        builder.add_link(link)
    builder.add_joint("turn \\ é1", Revolute((0, 0, 1)), "base", "one")
    builder.add_joint("slide", Prismatic((1, 0, 0)), "one", "two", lower=-0.5, upper=0.25)
    robot = ulna.Robot(builder.build())
    lib = library(ulna.export(robot, "fk", to="c", path=tmp_path / "x", name="t"))
    assert doubles(lib, "t_lower_position", 2) == [-np.inf, -0.5]
    assert doubles(lib, "t_upper_position", 2) == [np.inf, 0.25]
    assert doubles(lib, "t_effort_limit", 2) == robot.limits.effort.tolist()
    width = max(len(name.encode()) for name in robot.joint_names) + 1
    names = (ctypes.c_char * width * 2).in_dll(lib, "t_joint_names")
    assert [name.value.decode() for name in names] == list(robot.joint_names)


def test_named_configurations(panda: ulna.Robot, tmp_path: Path) -> None:
    lib = library(ulna.export(panda, "fk", to="c", path=tmp_path / "x"))
    assert doubles(lib, "panda_configuration_qr", 7) == panda.configurations["qr"].tolist()
    assert doubles(lib, "panda_velocity_limit", 7) == panda.limits.velocity.tolist()


def test_configurations_whose_names_are_alike_in_c_stay_apart(tmp_path: Path) -> None:
    builder = ulna.ModelBuilder("r").add_link("base").add_link("arm")
    builder.add_joint("turn", Revolute((0, 0, 1)), "base", "arm")
    expected = {
        "home 1": "home_1_3",
        "home-1": "home_1_4",
        "home_1": "home_1",
        "home_1_2": "home_1_2",
        "é": "_",
    }
    for k, name in enumerate(expected):
        builder.add_configuration(name, {"turn": 0.1 * k})
    place = ulna.export(ulna.Robot(builder.build()), "fk", to="c", path=tmp_path / "x")
    lib = library(place)
    for k, name in enumerate(expected.values()):
        assert doubles(lib, f"r_configuration_{name}", 1) == [0.1 * k]
    assert "configuration_home_1_4  is the configuration 'home-1'" in (place / "r.h").read_text()


def test_a_robot_without_joints(tmp_path: Path) -> None:
    builder = ulna.ModelBuilder("stone")
    builder.add_link("base")
    robot = ulna.Robot(builder.build())
    place = ulna.export(robot, {"pose": ("fk", {"frame": "base"})}, to="c", path=tmp_path / "x")
    lib, pose, q = library(place), np.zeros((4, 4)), np.zeros(1)
    lib.stone_pose(ctypes.c_void_p(q.ctypes.data), ctypes.c_void_p(pose.ctypes.data))
    np.testing.assert_array_equal(pose, np.eye(4))


@pytest.mark.parametrize("name", ["sincos", "lower_position", "nq", "ik_defaults", "configuration_qr"])
def test_functions_cannot_have_names_that_are_taken(panda: ulna.Robot, tmp_path: Path, name: str) -> None:
    with pytest.raises(
        InputError, match=rf"A function has the name '{name}', which the folder of C uses itself"
    ):
        ulna.export(panda, {name: "fk", "ik": "ik"}, to="c", path=tmp_path / "x")
    assert list(tmp_path.iterdir()) == []


def test_kernels_made_before_say_their_frame(panda: ulna.Robot, tmp_path: Path) -> None:
    kernel = panda.kernel("jacobian", frame="panda_hand", reference="local")
    text = (ulna.export(panda, kernel, to="c", path=tmp_path / "x") / "panda.h").read_text()
    assert "Frame: panda_hand. Reference: local." in " ".join(text.replace(" * ", " ").split())


def test_parameters_of_the_model_are_inputs(panda: ulna.Robot, tmp_path: Path) -> None:
    place = ulna.export(panda, [("inverse_dynamics", {"parameters": "inertia"})], to="c", path=tmp_path / "x")
    assert "const double inertia[70]" in (place / "panda.h").read_text()
    library(place)


@pytest.mark.parametrize("name", ["math", "string", "stdint"])
def test_files_hide_no_header_of_c(tmp_path: Path, name: str) -> None:
    """math.h in the folder is found before that of C, and nothing compiles."""
    with pytest.raises(
        InputError, match=f'{name}.h is a header of C itself. Choose another: name="{name}_robot"'
    ):
        ulna.export(ulna.load("ur5"), "fk", to="c", path=tmp_path / name, name=name)
