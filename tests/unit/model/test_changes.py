"""Models made out of models: joints locked, grippers attached, other roots, tools and positions."""

from __future__ import annotations

import numpy as np
import pytest

from support.random_models import random_model
from support.small_robots import arm, arm_builder, gripper
from ulna.algorithms.kinematics.configuration_space import random as random_position
from ulna.algorithms.kinematics.forward_kinematics import frame_poses
from ulna.errors import InputError, ModelError, UnknownName
from ulna.model import (
    Fixed,
    FreeFlyer,
    Model,
    ModelBuilder,
    Planar,
    Prismatic,
    attach,
    lock_joints,
    position,
    with_configuration,
    with_disabled_pairs,
    with_gravity,
    with_root_joint,
    with_tool,
)
from ulna.model.reduce import rebuilt
from ulna.spatial import SE3


def poses(model: Model, q: np.ndarray, prefix: str = "") -> dict[tuple[str, str], np.ndarray]:
    """The pose of each frame by name and by what it is at heart, a joint's or not."""
    names = [(f.name.removeprefix(prefix), "joint" if "joint" in f.kind else "point") for f in model.frames]
    return dict(zip(names, [T.matrix() for T in frame_poses(model, q, model.frames)], strict=True))


def assert_same_poses(whole: dict, part: dict, moved: np.ndarray | None = None, atol: float = 1e-14) -> None:
    assert part.keys() <= whole.keys()
    for name, T in part.items():
        np.testing.assert_allclose(
            whole[name], T if moved is None else moved @ T, atol=atol, err_msg=str(name)
        )


# -------- rebuilding


@pytest.mark.parametrize("seed", range(6))
def test_rebuilding_changes_nothing_at_all(seed: int) -> None:
    rng = np.random.default_rng(seed)
    m = random_model(rng, root="free_flyer" if seed % 2 else None, mimics=2)
    assert rebuilt(m) == m


def test_rebuilding_the_arm_changes_nothing_at_all() -> None:
    assert rebuilt(arm()) == arm()


# -------- locking


def test_locked_joints_stand_at_the_position_passed() -> None:
    m = arm()
    q = np.array([0.3, -0.2, 0.7, 0.02])
    small = lock_joints(m, {"j1": -0.2})
    assert small.joint_names == ("j0", "j2", "grip", "grip2")
    assert_same_poses(poses(m, q), poses(small, q[[0, 2, 3]]))
    assert small.frame("j1").kind == "fixed_joint"
    assert small.tool == "tcp"
    assert small.mass == pytest.approx(m.mass)
    assert small.joint("j2").limits == m.joint("j2").limits
    assert small.joint("j2").armature == m.joint("j2").armature
    assert small.link("link1").visuals == m.link("link1").visuals
    assert small.disabled_pairs == m.disabled_pairs
    assert small.groups["all"] == ("j0", "j2")
    np.testing.assert_array_equal(small.configurations["home"], m.configurations["home"][[0, 2, 3]])
    assert small.name == m.name
    assert small.source == m.source


def test_locking_at_a_position_of_the_whole() -> None:
    m = arm()
    q = np.array([0.3, -0.2, 0.7, 0.02])
    for locked_at in (q, dict(zip(m.position_names, q, strict=True))):
        small = lock_joints(m, ["j0", "j2"], locked_at)
        assert_same_poses(poses(m, q), poses(small, q[[1, 3]]))
    home = lock_joints(m, ["j0", "j2"], "home")
    at_home = m.configurations["home"]
    assert_same_poses(poses(m, at_home), poses(home, at_home[[1, 3]]))
    assert_same_poses(poses(m, m.neutral), poses(lock_joints(m, ["j2"]), m.neutral[[0, 1, 3]]))


def test_a_mimic_is_locked_with_its_source() -> None:
    m = arm()
    q = np.array([0.3, -0.2, 0.7, 0.03])
    small = lock_joints(m, {"grip": 0.03})
    assert small.joint_names == ("j0", "j1", "j2")
    assert_same_poses(poses(m, q), poses(small, q[:3]))


def test_a_mimic_can_be_locked_alone() -> None:
    small = lock_joints(arm(), {"grip2": 0.005})
    assert small.joint_names == ("j0", "j1", "j2", "grip")
    assert small.link("right").placement.is_close(
        small.link("hand").placement @ SE3.trans(0.0, -0.015, 0.1), 1e-15
    )


def fingers() -> Model:
    """A slide, one that follows it, one that follows that one, and so on, in an order of their own."""
    builder = ModelBuilder("fingers")
    builder.add_link("base", inertia=None)
    follows = {
        "third": ("second", -2.0, 0.01),
        "first": None,
        "second": ("first", 0.5, 0.1),
        "fourth": ("third", 3, 0),
    }
    for name, leader in follows.items():
        builder.add_link(f"{name}_link")
        builder.add_joint(name, Prismatic((1, 0, 0)), "base", f"{name}_link", mimic=leader)
    return builder.build()


def places(model: Model, q: list[float]) -> list[float]:
    """Where the four fingers stand."""
    at = poses(model, np.array(q))
    return [at[f"{name}_link", "point"][0, 3] for name in ("first", "second", "third", "fourth")]


def test_a_mimic_of_a_locked_mimic_follows_the_locked_value() -> None:
    m = fingers()
    assert m.joint_names == ("third", "first", "second", "fourth")
    np.testing.assert_allclose(places(m, [0.2]), [0.2, 0.2, -0.39, -1.17])
    small = lock_joints(m, {"second": 0.3})
    assert small.joint_names == ("first",)
    np.testing.assert_allclose(places(small, [0.2]), [0.2, 0.3, -0.59, -1.77])
    np.testing.assert_allclose(places(lock_joints(m, ["second"], [0.4]), [0.2]), [0.2, 0.3, -0.59, -1.77])
    third = lock_joints(m, {"third": 1.0})
    assert third.joint_names == ("first", "second")
    np.testing.assert_allclose(places(third, [0.2]), [0.2, 0.2, 1.0, 3.0])


def test_the_nearest_locked_leader_counts_in_any_order() -> None:
    m = fingers()
    for order in (1, -1):
        values = dict(list({"first": 0.2, "second": None, "third": 0.0}.items())[::order])
        np.testing.assert_allclose(places(lock_joints(m, values), []), [0.2, 0.2, 0.0, 0.0])
        names = ["first", "second", "third", "fourth"][::order]
        np.testing.assert_allclose(places(lock_joints(m, names, [0.2]), []), [0.2, 0.2, -0.39, -1.17])


def test_copies_keep_which_mimic_a_joint_follows() -> None:
    m = fingers()
    assert rebuilt(m) == m
    both = attach(m, fingers(), "base", prefix="other_")
    locked = lock_joints(both, {"other_second": 0.3})
    assert locked.joint_names == ("third", "first", "second", "fourth", "other_first")
    there = poses(locked, np.array([0.7, 0.2]), "other_")
    assert there["fourth_link", "point"][0, 3] == pytest.approx(-1.77)


def test_locking_everything_leaves_a_statue() -> None:
    m = arm()
    q = np.array([0.3, -0.2, 0.7, 0.03])
    statue = lock_joints(m, m.joint_names, q)
    assert statue.nq == 0
    assert statue.base_inertia.mass == pytest.approx(m.mass)
    assert_same_poses(poses(m, q), poses(statue, np.zeros(0)))
    assert lock_joints(m, []) == m


@pytest.mark.parametrize("seed", range(4))
def test_locking_in_random_robots(seed: int) -> None:
    rng = np.random.default_rng(seed)
    m = random_model(rng, root="free_flyer", mimics=2)
    q = random_position(m, rng)
    locked = [j.name for j in m.joints if rng.random() < 0.5]
    small = lock_joints(m, locked, q)
    rest = np.concatenate(
        [j.q_of(q) for j in m.joints if j.mimic is None and j.name not in locked] or [np.zeros(0)]
    )
    assert_same_poses(poses(m, q), poses(small, rest), atol=1e-13)
    assert small.mass == pytest.approx(m.mass)


def test_invalid_locks_are_refused() -> None:
    with pytest.raises(InputError, match=r"expected names in a list, such as \['j1'\]"):
        lock_joints(arm(), "j1")
    with pytest.raises(UnknownName, match="No movable joint named 'wrist'"):
        lock_joints(arm(), ["wrist"])
    with pytest.raises(ModelError, match=r"position to lock joint 'j1' at has shape \(2,\); expected \(1,\)"):
        lock_joints(arm(), {"j1": [1.0, 2.0]})
    with pytest.raises(ModelError, match="holds nan"):
        lock_joints(arm(), {"j1": float("nan")})
    with pytest.raises(ModelError, match="q has shape"):
        lock_joints(arm(), ["j1"], [1.0])
    with pytest.raises(UnknownName, match="No configuration named 'hom'"):
        lock_joints(arm(), ["j1"], "hom")


# -------- attaching


def test_a_gripper_on_an_arm() -> None:
    a, g = lock_joints(arm(), ["grip"]), gripper()
    place = SE3.from_rpy((0.1, 0.2, 0.3), (0.0, 0.0, 0.05))
    both = attach(a, g, placement=place)
    assert both.joint_names == (*a.joint_names, "close")
    assert both.tool == "pinch"
    assert both.name == "arm"
    assert both.mass == pytest.approx(a.mass + g.mass)
    q = np.array([0.3, -0.2, 0.7, 0.02])
    there = poses(both, q)
    assert_same_poses(there, poses(a, q[:3]))
    assert_same_poses(there, poses(g, q[3:]), there["tcp", "point"] @ place.matrix())
    np.testing.assert_array_equal(both.configurations["home"], [*a.configurations["home"], 0.01])
    np.testing.assert_array_equal(both.configurations["zero"], [0.0, 0.0, 0.0, 0.0])
    np.testing.assert_array_equal(both.configurations["open"], [0.0, 0.0, 0.0, 0.05])
    assert both.joint("close").limits == g.joint("close").limits
    assert both.link("palm").parent_joint == "palm_mount"


def test_two_arms_on_a_body() -> None:
    body = (
        ModelBuilder("body").add_link("torso").add_frame("left_shoulder", "torso", SE3.trans(0.0, 0.3, 1.0))
    )
    torso = body.add_frame("right_shoulder", "torso", SE3.trans(0.0, -0.3, 1.0)).build()
    one = attach(torso, arm(), "left_shoulder", prefix="left_")
    two = attach(one, arm(), "right_shoulder", prefix="right_", name="two arms")
    assert two.name == "two arms"
    assert two.nq == 8
    assert two.tool == "left_tcp"
    assert two.joint("right_grip2").mimic is not None
    assert two.joints[two.joint("right_grip2").mimic.source].name == "right_grip"  # type: ignore[union-attr]
    assert two.groups["left_fingers"] == ("left_grip",)
    assert ("right_hand", "right_left") in two.disabled_pairs
    home = arm().configurations["home"]
    np.testing.assert_array_equal(two.configurations["home"], [*home, *home])
    q = np.array([0.3, -0.2, 0.7, 0.02, -0.4, 0.1, 0.2, 0.01])
    there = poses(two, q, "right_")
    assert_same_poses(there, poses(arm(), q[4:]), there["shoulder", "point"])
    there = poses(two, q, "left_")
    assert_same_poses(there, poses(arm(), q[:4]), there["shoulder", "point"])
    assert attach(one, arm(), "right_shoulder", prefix="r_", tool="r_tcp").tool == "r_tcp"


def test_attaching_something_that_flies_keeps_its_joint() -> None:
    both = attach(arm(), with_root_joint(gripper(), FreeFlyer(), "float"), "camera", prefix="x_")
    assert both.joint("x_float").parent_link == "link1"
    assert both.nq == 4 + 8
    np.testing.assert_array_equal(both.configurations["open"][-8:], [0, 0, 0, 0, 0, 0, 1, 0.05])


def test_attaching_the_same_names_asks_for_a_prefix() -> None:
    with pytest.raises(ModelError, match=r"'arm' has a link named 'base' already .* such as prefix='arm_'"):
        attach(arm(), arm())
    with pytest.raises(UnknownName, match=r"No frame named 'tpc'\. Did you mean 'tcp'"):
        attach(arm(), gripper(), "tpc")
    eye = ModelBuilder("o").add_link("x").add_frame("camera", "x").build()
    with pytest.raises(ModelError, match="has a frame named 'camera' already"):
        attach(arm(), eye)
    other = ModelBuilder("o").add_link("x").add_link("y").add_joint("j0", Fixed(), "x", "y").build()
    with pytest.raises(ModelError, match="has a joint named 'j0' already"):
        attach(arm(), other)


def test_groups_of_one_name_are_joined() -> None:
    b = (
        ModelBuilder("g")
        .add_link("x")
        .add_link("y")
        .add_joint("j9", Planar(), "x", "y")
        .add_group("all", ["j9"])
    )
    assert attach(arm(), b.build()).groups["all"] == ("j0", "j1", "j2", "j9")


def test_models_side_by_side() -> None:
    cell = ModelBuilder("cell").add_link("floor")
    cell.add_model(arm(), "floor", SE3.trans(0.0, 1.0, 0.0), prefix="a_")
    cell.add_model(arm(), "floor", SE3.trans(0.0, -1.0, 0.0), prefix="b_", joint="bolts")
    m = cell.build()
    assert m.nq == 8
    assert m.link("b_base").parent_joint == "bolts"
    assert m.link("b_base").placement.translation[1] == -1.0
    with pytest.raises(UnknownName, match="add it first"):
        cell.add_model(gripper(), "ceiling")


# -------- root joints


def test_another_root_joint() -> None:
    m = arm()
    flying = with_root_joint(m, FreeFlyer())
    assert flying.nq == m.nq + 7
    assert flying.tool == m.tool
    np.testing.assert_array_equal(
        flying.configurations["home"], [0, 0, 0, 0, 0, 0, 1, *m.configurations["home"]]
    )
    q = np.array([0.1, 0.2, 0.3, 0.0, 0.6, 0.0, 0.8, 0.3, -0.2, 0.7, 0.02])
    moved = FreeFlyer().transform(q[:7]).matrix()
    assert_same_poses(poses(flying, q), poses(m, q[7:]), moved)
    rolling = with_root_joint(flying, Planar(), "wheels", lower=[-1, -2, -np.inf], upper=[1, 2, np.inf])
    assert rolling.joint_names[0] == "wheels"
    assert rolling.nq == m.nq + 3
    np.testing.assert_array_equal(rolling.upper_position[:3], [1.0, 2.0, np.inf])
    standing = with_root_joint(rolling, Fixed(), placement=SE3.trans(0.0, 0.0, 1.0))
    assert_same_poses(poses(standing, q[7:]), poses(m, q[7:]), SE3.trans(0.0, 0.0, 1.0).matrix())
    assert [j.name for j in standing.joints] == [j.name for j in m.joints]


def test_a_root_joint_that_goes_leaves_its_groups() -> None:
    b = arm_builder().root_joint(FreeFlyer()).add_group("body", ["root_joint", "j0"])
    m = b.add_configuration("zero", {}).build()
    assert m.groups["body"] == ("root_joint", "j0")
    assert with_root_joint(m, Planar(), "wheels").groups["body"] == ("j0",)
    assert with_root_joint(m, Planar()).groups["body"] == ("root_joint", "j0")
    assert with_root_joint(m, Fixed()).groups["body"] == ("j0",)


def test_a_new_root_joint_stands_at_neutral_in_every_configuration() -> None:
    flying = with_root_joint(arm(), FreeFlyer())
    high = with_configuration(flying, "high", {"root_joint": [0, 0, 9, 0, 0, 0, 1], "j0": 0.5})
    np.testing.assert_array_equal(
        with_root_joint(high, Planar()).configurations["high"], [0, 0, 0, 0.5, 0, 0, 0]
    )
    again = with_root_joint(high, FreeFlyer(), placement=SE3.trans(1.0, 0.0, 0.0)).configurations["high"]
    np.testing.assert_array_equal(again, [0, 0, 0, 0, 0, 0, 1, 0.5, 0, 0, 0])


def test_a_standing_model_is_attached_where_it_stands() -> None:
    raised = with_root_joint(gripper(), Fixed(), placement=SE3.trans(0.0, 0.0, 1.0))
    both = attach(arm(), raised, "base")
    assert both.link("palm").placement.translation.tolist() == [0.0, 0.0, 1.0]


# -------- tools, positions and the rest


def test_another_tool() -> None:
    m = arm()
    assert with_tool(m, "camera").tool == "camera"
    place = SE3.from_rpy((0.1, 0.2, 0.3), (0.0, 0.0, 0.05))
    longer = with_tool(m, "tcp", place)
    assert longer.tool == "tool"
    assert longer.frame("tool").kind == "tool"
    assert longer.frame("tool").link == "hand"
    assert longer.frame("tool").placement.is_close(m.frame("tcp").placement @ place, 1e-15)
    again = with_tool(longer, "hand", place)
    assert len(again.frames) == len(longer.frames)
    assert again.frame("tool").placement.is_close(m.link("hand").placement @ place, 1e-15)
    assert rebuilt(again) == again
    with pytest.raises(UnknownName, match="No frame named 'tpc'"):
        with_tool(m, "tpc")
    with pytest.raises(ModelError, match="'camera' is that of a user frame"):
        with_tool(m, "tcp", place, "camera")
    with pytest.raises(ModelError, match="placement of tool 'tool' is a ndarray"):
        with_tool(m, "tcp", np.eye(4))  # type: ignore[arg-type]


def test_another_configuration() -> None:
    m = with_configuration(arm(), "up", {"j0": 0.5})
    np.testing.assert_array_equal(m.configurations["up"], [0.5, 0.0, 0.0, 0.0])
    assert list(m.configurations) == ["home", "zero", "up"]
    np.testing.assert_array_equal(
        with_configuration(m, "up", "home").configurations["up"], m.configurations["home"]
    )
    with pytest.raises(ModelError, match="configuration 'up' has shape"):
        with_configuration(m, "up", [1.0])
    assert arm() != m


def test_positions_by_name_start_from_a_base() -> None:
    m = arm()
    q = position(m, {"j1": 0.2}, base=m.configurations["home"])
    np.testing.assert_array_equal(q, [1.0, 0.2, -0.5, 0.02])
    with pytest.raises(UnknownName, match="j9"):
        position(m, {"j9": 0.2})


def test_another_gravity_and_more_disabled_pairs() -> None:
    m = with_gravity(arm(), [0, 0, -1.62])
    np.testing.assert_array_equal(m.gravity, [0.0, 0.0, -1.62])
    with pytest.raises(ModelError, match="`gravity`"):
        with_gravity(m, [1.0])
    more = with_disabled_pairs(m, [("link1", "base"), ("left", "hand")])
    assert more.disabled_pairs == (("base", "link1"), ("hand", "left"), ("hand", "right"))
    with pytest.raises(UnknownName, match="No link named 'bse'"):
        with_disabled_pairs(m, [("bse", "hand")])


def test_gravity_and_tool_stay_through_every_change() -> None:
    b = arm_builder()
    b.gravity = (0.0, 1.0, 2.0)
    m = b.build()
    for changed in (lock_joints(m, ["j1"]), with_root_joint(m, FreeFlyer()), attach(m, gripper(), "base")):
        np.testing.assert_array_equal(changed.gravity, m.gravity)
        assert changed.tool == "tcp"
