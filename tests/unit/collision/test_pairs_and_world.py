"""Which pairs are checked, and worlds as values."""

from __future__ import annotations

import copy
import pickle
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from ulna.collision import Checker, World, link_pairs, robot_poses, survey
from ulna.errors import InputError, NonFiniteError, ShapeError, UnknownName
from ulna.geometry import Box, Cylinder, Geometry, Sphere
from ulna.model import Fixed, Model, ModelBuilder, Revolute
from ulna.robots.panda import panda
from ulna.robots.ur5 import ur5
from ulna.spatial import SE3


def chain(*fixed: int) -> Model:
    """Links 0, 1, 2 ... in a row, each with a ball; joint k turns unless it is among `fixed`."""
    builder = ModelBuilder("chain")
    for k in range(5):
        builder.add_link(f"link{k}", collisions=(Geometry("", Sphere(0.05)),))
    for k in range(4):
        kind = Fixed() if k in fixed else Revolute((0.0, 0.0, 1.0))
        builder.add_joint(
            f"joint{k}", kind, f"link{k}", f"link{k + 1}", SE3.from_translation((0.2, 0.0, 0.0))
        )
    return builder.build()


def test_adjacent_and_rigidly_joined_links_are_left_out() -> None:
    assert link_pairs(chain()) == tuple((f"link{i}", f"link{j}") for i in range(5) for j in range(i + 2, 5))
    # links 1 and 2 are one body: its neighbours are 0 and 3
    expected = {("link0", "link3"), ("link0", "link4"), ("link1", "link4"), ("link2", "link4")}
    assert set(link_pairs(chain(1))) == expected
    assert ("link0", "link1") in link_pairs(chain(), adjacent=True)
    assert ("link1", "link2") not in link_pairs(chain(1), adjacent=True)


def test_disabled_pairs_and_those_named_are_left_out() -> None:
    model = panda()
    pairs = link_pairs(model)
    assert not {frozenset(p) for p in pairs} & {frozenset(p) for p in model.disabled_pairs}
    assert ("panda_link5", "panda_hand") in link_pairs(model, disabled=True)
    assert ("panda_link0", "panda_hand") not in link_pairs(model, without=[("panda_hand", "panda_link0")])
    assert not any("panda_hand_tcp" in pair for pair in pairs)  # it has no geometry


@pytest.mark.parametrize(
    ("pair", "error", "text"),
    [
        (("panda_link0", "panda_linkk5"), UnknownName, "panda_link5"),
        (("panda_link0", "panda_link0"), InputError, "twice"),
        ("panda_link0", InputError, "no pair"),
    ],
)
def test_invalid_pairs_are_refused(pair: object, error: type, text: str) -> None:
    with pytest.raises(error, match=text):
        link_pairs(panda(), without=[pair])  # type: ignore[list-item]
    with pytest.raises(error, match=text):
        Checker(panda(), pairs=[pair])  # type: ignore[list-item]


def test_a_world_is_a_value() -> None:
    empty = World()
    world = empty.add("ball", Sphere(0.1), (1.0, 0.0, 0.0)).add("box", Box((1.0, 1.0, 1.0)))
    assert len(empty) == 0 and world.names == ("ball", "box") and "ball" in world
    moved = world.move("ball", (2.0, 0.0, 0.0))
    np.testing.assert_array_equal(world["ball"].pose.translation, (1.0, 0.0, 0.0))
    np.testing.assert_array_equal(moved["ball"].pose.translation, (2.0, 0.0, 0.0))
    assert moved.names == world.names and moved.remove("ball").names == ("box",)
    assert world.fingerprint != moved.fingerprint
    assert world.fingerprint == moved.move("ball", (1.0, 0.0, 0.0)).fingerprint


def test_invalid_obstacles_are_refused() -> None:
    world = World().add("ball", Sphere(0.1))
    with pytest.raises(InputError, match="has an obstacle named 'ball' already.*remove"):
        world.add("ball", Sphere(0.2))
    with pytest.raises(UnknownName, match="'ball'"):
        world.move("bal", (0.0, 0.0, 0.0))
    with pytest.raises(UnknownName, match="'ball'"):
        world.remove("balll")
    with pytest.raises(InputError, match=r"expected a shape of ulna\.geometry"):
        world.add("x", 0.1)  # type: ignore[arg-type]
    with pytest.raises(NonFiniteError):
        world.add("x", Sphere(0.1), (np.nan, 0.0, 0.0))
    with pytest.raises(ShapeError):
        world.add("x", Sphere(0.1), (0.0, 0.0))
    with pytest.raises(InputError, match="list of link names"):
        world.add("x", Sphere(0.1), touches="panda_link0")
    with pytest.raises(UnknownName, match="panda_link0"):
        Checker(panda(), World().add("x", Sphere(0.1), touches=["panda_lnk0"]))


def test_another_robot_as_obstacles() -> None:
    arm, other = panda(), ur5()
    place = SE3.from_rpy((0.0, 0.0, 3.0), (0.5, 0.0, 0.0))
    world = World().add_robot("ur", other, None, place, moving=True)
    rng = np.random.default_rng(0)
    q = rng.uniform(-2.0, -0.1, (20, arm.nq))
    q_other = rng.uniform(-2.0, 2.0, (20, other.nq))
    checker = Checker(arm, world, pairs=())
    together = checker.collides(q, robot_poses("ur", other, q_other, place))
    assert 0 < together.sum() < 20
    for k in range(20):
        still = World().add_robot("ur", other, q_other[k], place)
        # links of the Panda's that never move are not checked against what never moves
        frozen = Checker(arm, still, pairs=()).collides(q[k])
        base = checker.touching(q[k], {n: T[k] for n, T in robot_poses("ur", other, q_other, place).items()})
        owners = [pair[0] for pair, hit in zip(checker.owners, base, strict=True) if hit]
        assert frozen == any(name != "panda_link0" for name in owners)
        assert together[k] == bool(owners)


def test_survey_finds_what_always_and_never_touches() -> None:
    builder = ModelBuilder("post")
    builder.add_link("base", collisions=(Geometry("", Cylinder(0.1, 0.2)),))
    builder.add_link("turret", collisions=(Geometry("", Cylinder(0.1, 0.2)),))  # overlaps the base
    builder.add_link("arm", collisions=(Geometry("", Sphere(0.05), SE3.from_translation((1.0, 0.0, 0.0))),))
    builder.add_joint(
        "turn", Revolute((0.0, 0.0, 1.0)), "base", "turret", SE3.from_translation((0.0, 0.0, 0.1))
    )
    builder.add_joint("swing", Revolute((0.0, 0.0, 1.0)), "turret", "arm")
    found = survey(builder.build(), 50)
    assert found.always == (("base", "turret"),)
    assert set(found.never) == {("base", "arm"), ("turret", "arm")} and not found.sometimes
    with pytest.raises(InputError, match="count"):
        survey(builder.build(), 0)


def test_worlds_made_of_one_keep_what_each_of_them_has() -> None:
    first = World().add("a", Sphere(0.1)).add("b", Sphere(0.1))
    left, right = first.add("c", Sphere(0.2)), first.add("c", Sphere(0.3), touches=["x"])
    further = left.add("d", Sphere(0.4))
    assert first.names == ("a", "b") and len(first) == 2 and "c" not in first
    assert left["c"].shape == Sphere(0.2) and right["c"].shape == Sphere(0.3)
    assert further.names == ("a", "b", "c", "d") and len(further.obstacles) == 4
    assert len({world.fingerprint for world in (first, left, right, further)}) == 4
    for world in (left, right, further):
        with pytest.raises(InputError, match="already"):
            world.add("c", Sphere(0.1))
    assert first.remove("a").add("c", Sphere(0.1)).add("a", Sphere(0.1)).names == ("b", "c", "a")
    assert further.move("a", (1.0, 0.0, 0.0)).add("e", Sphere(0.1)).names == ("a", "b", "c", "d", "e")
    for copied in (pickle.loads(pickle.dumps(first)), copy.copy(first), copy.deepcopy(first)):
        assert copied.names == first.names and copied.fingerprint == first.fingerprint
        assert copied.add("c", Sphere(0.1)).names == left.names
    assert World(left.obstacles).fingerprint == left.fingerprint
    held = left.attach("c", "hand", np.eye(4))
    assert held.names == ("a", "b") and [a.name for a in held.attachments] == ["c"]
    with pytest.raises(InputError, match="already"):
        held.add("c", Sphere(0.1))


def test_threads_that_add_to_one_world_get_their_own() -> None:
    start = World().add("a", Sphere(0.1))

    def grown(number: int) -> World:
        world = start
        for k in range(50):
            world = world.add(f"{number}.{k}", Sphere(0.1))
        return world

    with ThreadPoolExecutor(8) as pool:
        worlds = list(pool.map(grown, range(16)))
    for number, world in enumerate(worlds):
        assert world.names == ("a", *(f"{number}.{k}" for k in range(50)))
    assert start.names == ("a",)


def test_obstacles_stay_when_the_array_they_were_placed_by_changes() -> None:
    """As in a loop that writes one place after the other into one array."""
    T, p, pose, world = np.eye(4), np.zeros(3), SE3.identity(), World()
    for k in range(3):
        T[0, 3] = p[1] = pose.translation[2] = k
        world = (
            world.add(f"a{k}", Sphere(0.1), T).add(f"b{k}", Sphere(0.1), p).add(f"c{k}", Sphere(0.1), pose)
        )
        world = world.attach(f"d{k}", "link0", T, shape=Sphere(0.1)).move("a0", T)
    places = [world[f"{name}{k}"].pose.translation.tolist() for name in "abc" for k in range(1, 3)]
    assert places == [[1, 0, 0], [2, 0, 0], [0, 1, 0], [0, 2, 0], [0, 0, 1], [0, 0, 2]]
    assert [a.pose.translation[0] for a in world.attachments] == [0, 1, 2] and world["a0"].pose.translation[
        0
    ] == 2
    with pytest.raises(ValueError, match="read-only"):
        world["a1"].pose.translation[0] = 5.0
