"""A model is a value: equal by content, its fingerprint the same in every process and on every machine."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from support.small_robots import arm, arm_builder
from ulna.errors import UnknownName
from ulna.geometry import Geometry, Material, Mesh, Sphere
from ulna.model import Fixed, FreeFlyer, Model, ModelBuilder, Revolute, with_root_joint
from ulna.model.content import fingerprint
from ulna.model.named import Named
from ulna.spatial import SE3, Inertia


def test_models_of_the_same_content_are_equal() -> None:
    a, b = arm(), arm()
    assert a is not b
    assert a == b
    assert hash(a) == hash(b)
    assert {a: 1}[b] == 1
    assert a != "arm"
    assert len(a.fingerprint) == 64


def test_a_model_survives_pickling() -> None:
    m = arm()
    assert m.nq == 4  # a cached property is there before
    copy = pickle.loads(pickle.dumps(m))
    assert copy == m
    assert copy.source == m.source
    assert list(copy.configurations) == list(m.configurations)
    assert copy.joint("grip2") == m.joint("grip2")
    with pytest.raises(ValueError, match="read-only"):
        copy.configurations["home"][0] = 1.0
    with pytest.raises(ValueError, match="read-only"):
        copy.gravity[0] = 1.0


CHANGES: dict[str, Callable[[], ModelBuilder]] = {
    "name": lambda: arm_builder("other"),
    "mesh": lambda: arm_builder(mesh="meshes/other.stl"),
    "link": lambda: arm_builder().add_link("x").add_joint("jx", Fixed(), "hand", "x"),
    "frame": lambda: arm_builder().add_frame("x", "hand"),
    "tool": lambda: arm_builder().set_tool("hand"),
    "configuration": lambda: arm_builder().add_configuration("home", {"j0": 1.0 + 1e-15}),
    "pair": lambda: arm_builder().disable_pair("base", "link0"),
    "group": lambda: arm_builder().add_group("fingers", ["j0"]),
    "root": lambda: arm_builder().root_joint(Fixed(), placement=SE3.trans(0.0, 0.0, 1e-9)),
}


@pytest.mark.parametrize("name", CHANGES)
def test_every_change_shows_in_the_fingerprint(name: str) -> None:
    assert CHANGES[name]().build() != arm()


def test_gravity_shows_in_the_fingerprint() -> None:
    b = arm_builder()
    b.gravity = (0.0, 0.0, -1.62)
    assert b.build() != arm()


def test_what_is_a_fact_of_one_machine_does_not_show() -> None:
    m = arm()
    assert arm_builder(mesh="/elsewhere/base.stl").build() == m
    assert replace(m, source="elsewhere.urdf") == m
    assert fingerprint(Mesh("a/b.stl", missing=True)) == fingerprint(Mesh("c/b.stl"))
    assert fingerprint(Mesh("a/b.stl")) != fingerprint(Mesh("a/b.stl", (2.0, 1.0, 1.0)))
    assert fingerprint(Material("m", None, "a/t.png")) == fingerprint(Material("m", None, "b/t.png"))
    assert fingerprint(Material("m", None, "a/t.png")) != fingerprint(Material("m", None, None))


def test_order_of_the_disabled_pairs_does_not_show() -> None:
    a = arm_builder().disable_pair("base", "link0").disable_pair("link1", "link0").build()
    b = arm_builder().disable_pair("link0", "link1").disable_pair("link0", "base").build()
    assert a == b


@pytest.mark.parametrize("seed", ["0", "1", "random"])
def test_the_fingerprint_is_the_same_in_another_process(seed: str) -> None:
    script = "from support.small_robots import arm; m = arm(); print(m.fingerprint, hash(m))"
    paths = [str(Path(__file__).parents[2]), *filter(None, [os.environ.get("PYTHONPATH")])]
    environment = {**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": os.pathsep.join(paths)}
    run = subprocess.run(
        [sys.executable, "-c", script], env=environment, capture_output=True, text=True, check=True
    )
    assert run.stdout.split() == [arm().fingerprint, str(hash(arm()))]


@dataclass(frozen=True)
class Pair:
    first: object
    second: object


def test_different_values_have_different_bytes() -> None:
    values = [
        None, True, False, 0, 1, 2, -1, 0.0, 1.0, -1.0, float("inf"), "", "a", "b", "ab", (), ("a",),
        ("a", "b"), ("ab",), (("a",), "b"), ("a", ("b",)), {}, {"a": 1}, {"a": 1.0}, {"b": 1}, np.zeros(2),
        np.zeros(3), np.zeros((1, 2)), np.ones(2), Pair(1, 2), Pair(2, 1), Pair((1,), 2), Sphere(1.0),
        Sphere(2.0), SE3.identity(), SE3.trans(1.0, 0.0, 0.0), Inertia.zero(), Mesh("a.stl"),
        Mesh(None), Material(""),
    ]  # fmt: skip
    assert len({fingerprint(v) for v in values}) == len(values)
    assert fingerprint("a", "b") != fingerprint("ab")


def test_equal_numbers_have_equal_bytes() -> None:
    assert fingerprint(-0.0) == fingerprint(0.0) == fingerprint(np.float64(0.0))
    assert fingerprint(np.array([-0.0, 1.0])) == fingerprint(np.array([0, 1]))
    assert fingerprint([1, 2]) == fingerprint((np.int64(1), 2))


def test_what_has_no_defined_content_is_refused() -> None:
    with pytest.raises(TypeError, match="object has no defined content"):
        fingerprint(object())


def test_links_joints_and_frames_are_values() -> None:
    a, b = arm(), with_root_joint(arm(), FreeFlyer())
    assert a.joint("j0") == arm().joint("j0")
    assert hash(a.joint("j0")) == hash(arm().joint("j0"))
    assert a.joint("j0") != b.joint("j0")
    assert a.frame("tcp") == arm().frame("tcp")
    assert len({a.link("hand"), arm().link("hand"), a.link("base")}) == 2


def test_a_named_collection_is_a_read_only_dictionary() -> None:
    named = Named("thing", {"one": np.arange(2.0), "two": np.zeros(2)})
    assert list(named) == ["one", "two"]
    assert len(named) == 2
    assert "one" in named
    assert "three" not in named
    assert named.get("three") is None
    assert named.get("one") is named["one"]
    assert dict(named) == dict(named.items())
    assert named == Named("thing", {"two": np.zeros(2), "one": np.arange(2.0)})
    assert named != Named("thing", {"one": np.arange(2.0)})
    assert named != Named("thing", {"one": np.arange(2.0), "two": np.ones(2)})
    assert named != 3
    assert "'one'" in repr(named)
    with pytest.raises(UnknownName, match=r"No thing named 'tow'\. Did you mean 'two'"):
        named["tow"]
    with pytest.raises(TypeError):
        named["one"] = 1  # type: ignore[index]


def test_models_share_no_arrays_with_what_they_are_made_of() -> None:
    q, gravity = np.zeros(1), np.array([0.0, 0.0, -9.81])
    place = SE3(np.eye(3), np.zeros(3))
    b = ModelBuilder("m").add_link("a").add_link("b", visuals=[Geometry("", Sphere(1.0), place)])
    b.add_joint("j", Revolute(), "a", "b", place).add_configuration("c", q)
    b.gravity = gravity
    m: Model = b.build()
    before = m.fingerprint
    q[:], gravity[:], place.translation[:], place.rotation[0, 0] = 1.0, 1.0, 1.0, 2.0
    assert replace(m).fingerprint == before
