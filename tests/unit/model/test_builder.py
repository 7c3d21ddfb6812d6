"""A builder makes models out of parts, and says what is wrong with parts that do not fit."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable

import numpy as np
import pytest

from support.small_robots import arm, arm_builder
from ulna.errors import ModelError, ModelWarning, UnknownName
from ulna.geometry import Box, Geometry
from ulna.model import (
    Composite,
    Continuous,
    Fixed,
    FreeFlyer,
    JointKind,
    Mimic,
    Model,
    ModelBuilder,
    Prismatic,
    Revolute,
    Spherical,
    lock_joints,
)
from ulna.spatial import SE3, Inertia

HINGE = Revolute((0, 0, 1))


def pair() -> ModelBuilder:
    return ModelBuilder("pair").add_link("a").add_link("b")


# -------- what comes out


def test_joints_and_links_come_depth_first_in_the_order_of_adding() -> None:
    b = ModelBuilder("tree")
    for name in ("tip2", "root", "a", "b", "a1", "tip1"):
        b.add_link(name)
    b.add_joint("to_b", HINGE, "root", "b")
    b.add_joint("deep", HINGE, "a1", "tip1")
    b.add_joint("to_a", HINGE, "root", "a")
    b.add_joint("down", HINGE, "a", "a1")
    b.add_joint("side", HINGE, "b", "tip2")
    m = b.build()
    assert m.joint_names == ("to_b", "side", "to_a", "down", "deep")
    assert m.link_names == ("root", "b", "tip2", "a", "a1", "tip1")
    assert [j.parent for j in m.joints] == [-1, 0, -1, 2, 3]
    assert m.children(-1) == (0, 2)
    assert m.children(2) == (3,)
    assert m.support(4) == (2, 3, 4)
    assert m.support(-1) == ()
    assert m.subtree(2) == (2, 3, 4)
    assert m.subtree(-1) == (0, 1, 2, 3, 4)
    assert m.subtree(1) == (1,)


def test_a_deep_chain_needs_no_recursion() -> None:
    b = ModelBuilder("snake").add_link("l0")
    for i in range(1, 2001):
        b.add_link(f"l{i}").add_joint(f"j{i}", Fixed(), f"l{i - 1}", f"l{i}", SE3.trans(0.0, 0.0, 0.001))
    assert b.build().link("l2000").placement.translation[2] == pytest.approx(2.0)


def test_the_parts_of_the_arm() -> None:
    m = arm()
    assert (m.nq, m.nv, len(m.joints)) == (4, 4, 5)
    assert m.joint_names == ("j0", "j1", "j2", "grip", "grip2")
    np.testing.assert_array_equal(m.lower_position, [-1.0, -0.5, -np.inf, 0.0])
    np.testing.assert_array_equal(m.upper_position, [2.0, 0.5, np.inf, 0.04])
    np.testing.assert_array_equal(m.velocity_limit, [3.0, np.inf, np.inf, np.inf])
    np.testing.assert_array_equal(m.effort_limit, [20.0, np.inf, np.inf, np.inf])
    np.testing.assert_array_equal(m.damping, [0.0, 0.1, 0.0, 0.0])
    np.testing.assert_array_equal(m.friction, [0.0, 0.0, 0.2, 0.0])
    np.testing.assert_array_equal(m.armature, [0.0, 0.0, 0.01, 0.0])
    np.testing.assert_array_equal(m.neutral, np.zeros(4))
    np.testing.assert_array_equal(m.gravity, [0.0, 0.0, -9.81])
    np.testing.assert_array_equal(m.configurations["home"], [1.0, 0.0, -0.5, 0.02])
    assert m.position_names == ("j0", "j1", "j2", "grip")
    assert m.mass == pytest.approx(8.7)
    assert m.source == "arm.urdf"
    assert m.disabled_pairs == (("hand", "left"), ("hand", "right"))
    assert dict(m.groups) == {"all": ("j0", "j1", "j2"), "fingers": ("grip",)}
    assert m.joint("j1").parent_link == "link0"
    assert m.joint("j1").child_link == "link1"


def test_everything_in_a_model_is_read_only() -> None:
    m = arm()
    arrays = [m.gravity, m.lower_position, m.neutral, m.damping, m.configurations["home"]]
    arrays += [m.joint("j1").placement.rotation, m.link("hand").placement.translation, m.inertias[0].com]
    arrays += [m.link("link0").inertia.inertia, m.frame("tcp").origin.rotation, m.base_inertia.com]
    arrays += [m.link("link0").visuals[0].placement.translation]
    for array in arrays:
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 1.0
    with pytest.raises(AttributeError):
        m.tool = "hand"  # type: ignore[misc]


def test_fixed_joints_are_merged_and_their_links_keep_their_place() -> None:
    m = arm()
    hand = m.link("hand")
    place = SE3.from_rpy((0.0, 0.0, 0.5), (0.0, 0.0, 0.1))
    assert hand.joint == m.joint_index("j2")
    assert hand.placement.is_close(place, 1e-15)
    assert (hand.parent, hand.parent_joint) == ("link2", "wrist")
    assert m.joint("grip").parent == m.joint_index("j2")
    assert m.joint("grip").placement.is_close(place @ SE3.trans(0.0, 0.02, 0.1), 1e-15)
    assert m.joint("grip").parent_link == "hand"
    assert m.link("link1").placement == SE3.identity()
    assert m.link("base").joint == -1


def test_the_inertias_add_up() -> None:
    m = arm()
    hand = SE3.from_rpy((0.0, 0.0, 0.5), (0.0, 0.0, 0.1)).act(Inertia.from_point(0.5, (0.0, 0.0, 0.1)))
    expected = m.link("link2").inertia + hand
    assert m.inertias[m.joint_index("j2")].is_close(expected, 1e-15)
    assert m.inertias[0].is_close(m.link("link0").inertia, 0.0)
    assert m.base_inertia.is_close(m.link("base").inertia, 0.0)
    assert m.mass == pytest.approx(m.base_inertia.mass + sum(i.mass for i in m.inertias))


def test_bodies_without_inertia_are_nothing() -> None:
    m = pair().add_joint("j", HINGE, "a", "b").build()
    assert m.link("b").inertia.mass == 0.0
    assert m.inertias[0].mass == 0.0
    assert np.isfinite(m.inertias[0].com).all()


def test_frames_of_links_joints_and_points() -> None:
    m = arm()
    kinds = {(f.name, f.kind) for f in m.frames}
    assert {("base", "link"), ("j0", "joint"), ("wrist", "fixed_joint"), ("hand", "link")} <= kinds
    assert {("tcp", "tool"), ("camera", "user")} <= kinds
    tcp = m.frame("tcp")
    assert tcp.link == "hand"
    assert tcp.joint == m.joint_index("j2")
    assert tcp.placement.is_close(m.link("hand").placement @ tcp.origin, 1e-15)
    assert m.frame("wrist").placement == m.link("hand").placement
    assert m.frame("j1").placement == SE3.identity()
    assert m.frames[m.frame_index("camera")].name == "camera"


def test_where_a_link_and_a_joint_share_a_name_the_link_wins() -> None:
    m = pair().add_joint("b", HINGE, "a", "b", offset=SE3.trans(1.0, 0.0, 0.0)).build()
    assert m.frame("b").kind == "link"
    assert m.frame("b", "joint").placement == SE3.identity()
    assert m.frame("b").placement.translation[0] == 1.0
    assert m.frame_names == ("a", "joint:b", "b")
    assert m.frame("joint:b") is m.frame("b", "joint")
    assert [m.frame_index(name) for name in m.frame_names] == [0, 1, 2]
    assert [m.frame_name(frame) for frame in m.frames] == list(m.frame_names)
    with pytest.raises(UnknownName, match="No tool frame named 'b'"):
        m.frame("b", "tool")


def test_an_offset_puts_the_child_beside_the_joint() -> None:
    beside = SE3.from_rpy((0.1, 0.2, 0.3), (0.4, 0.5, 0.6))
    m = (
        pair()
        .add_link("c")
        .add_joint("j", HINGE, "a", "b", SE3.trans(0.0, 0.0, 1.0), offset=beside)
        .add_joint("k", Fixed(), "b", "c", SE3.trans(0.0, 1.0, 0.0), offset=beside)
        .build()
    )
    assert m.link("b").placement.is_close(beside, 1e-15)
    assert m.link("c").placement.is_close(beside @ SE3.trans(0.0, 1.0, 0.0) @ beside, 1e-15)
    assert m.frame("k").placement.is_close(beside @ SE3.trans(0.0, 1.0, 0.0), 1e-15)
    for frame in m.frames:
        assert frame.placement.is_close(m.link(frame.link).placement @ frame.origin, 1e-15)


def test_quarter_turns_leave_no_rounding_noise() -> None:
    b = ModelBuilder("chain").add_link("l0")
    for i in range(1, 6):
        pose = SE3.from_rpy((math.pi / 2, 0.0, -math.pi / 2), (0.1, 0.0, 0.3))
        b.add_link(f"l{i}").add_joint(f"j{i}", Fixed(), f"l{i - 1}", f"l{i}", pose)
    for link in b.build().links:
        assert set(np.abs(link.placement.rotation).ravel()) == {0.0, 1.0}


# -------- mimics


def test_a_mimic_joint_has_no_entry_in_q() -> None:
    m = arm()
    grip, follower = m.joint("grip"), m.joint("grip2")
    assert follower.mimic == Mimic(m.joint_index("grip"), -1.0, 0.01)
    assert (follower.nq, follower.nv) == (0, 0)
    assert (follower.idx_q, follower.idx_v) == (grip.idx_q, grip.idx_v)
    q = np.array([[0.0, 0.0, 0.0, 0.03], [0.0, 0.0, 0.0, 0.01]])
    np.testing.assert_allclose(follower.q_of(q), [[-0.02], [0.0]])
    np.testing.assert_allclose(follower.v_of(q), [[-0.03], [-0.01]])
    np.testing.assert_allclose(grip.q_of(q), [[0.03], [0.01]])


def test_mimics_of_mimics_are_resolved_and_may_come_first() -> None:
    b = ModelBuilder("chain").add_link("r")
    for name in "abc":
        b.add_link(name)
    b.add_joint("ja", HINGE, "r", "a", mimic=("jb", 2.0, 0.1))
    b.add_joint("jb", HINGE, "r", "b", mimic=("jc", 3.0, 0.2))
    b.add_joint("jc", HINGE, "r", "c")
    m = b.build()
    assert m.nq == 1
    assert m.joint("ja").mimic == Mimic(2, 6.0, pytest.approx(0.5), (1, 2.0, 0.1))
    assert m.joint("jb").mimic == Mimic(2, 3.0, 0.2)
    np.testing.assert_allclose(m.joint("ja").q_of(np.array([1.0])), [6.5])


@pytest.mark.parametrize(
    ("kind", "ratio", "free"),
    [(HINGE, -2.0, True), (HINGE, 0.5, False), (Continuous(), 1.0, True), (Prismatic(), 1.0, False)],
)
def test_a_free_joint_with_a_gear_counts_its_turns(kind: JointKind, ratio: float, free: bool) -> None:
    b = pair().add_link("c").add_joint("j", Continuous((1, 0, 0)), "a", "b")
    m = b.add_joint("k", kind, "b", "c", mimic=("j", ratio, 0.1)).build()
    assert m.joint("j").kind == (Continuous((1, 0, 0)) if free else Revolute((1, 0, 0)))
    a_turn_more = m.joint("j").kind.normalize(np.array([0.5 + 2 * math.pi]))
    there, here = (
        m.joint("k").kind.transform(m.joint("k").q_of(q))
        for q in (np.array([0.5 + 2 * math.pi]), a_turn_more)
    )
    assert there.is_close(here, 1e-14)


def test_a_free_joint_in_a_composite_counts_its_turns_too() -> None:
    place = SE3.trans(0.1, 0.2, 0.3)
    b = pair().add_link("c").add_joint("j", Composite((Continuous((1, 0, 0)),), (place,)), "a", "b")
    m = b.add_joint("k", Prismatic(), "b", "c", mimic=("j", 0.1, 0.0)).build()
    assert m.joint("j").kind == Composite((Revolute((1, 0, 0)),), (place,))
    assert m.joint("j").kind.normalize(np.array([7.0])).tolist() == [7.0]


def test_a_mimic_may_be_named_by_its_source_alone() -> None:
    b = pair().add_link("c").add_joint("j", HINGE, "a", "b").add_joint("k", HINGE, "a", "c", mimic="j")
    assert b.build().joint("k").mimic == Mimic(0, 1.0, 0.0)


# -------- tool, root, positions


def test_the_default_tool_is_the_leaf_behind_the_most_joints() -> None:
    b = ModelBuilder("m").add_link("r").add_link("short").add_link("long1").add_link("long2").add_link("tip")
    b.add_joint("s", HINGE, "r", "short")
    b.add_joint("l1", HINGE, "r", "long1")
    b.add_joint("l2", HINGE, "long1", "long2")
    b.add_joint("f", Fixed(), "long2", "tip")
    assert b.build().tool == "tip"
    assert b.set_tool("l1").build().tool == "l1"
    b.add_link("other").add_joint("o", HINGE, "long1", "other")
    assert b.set_tool("tip").build().tool == "tip"


def test_mimic_joints_do_not_make_a_tool() -> None:
    b = pair().add_link("c").add_link("d")
    b.add_joint("x", HINGE, "a", "b")
    b.add_joint("y", HINGE, "a", "c", mimic="x").add_joint("z", HINGE, "c", "d", mimic="x")
    assert b.build().tool == "b"


def test_a_root_joint_moves_the_root_link() -> None:
    b = pair().add_joint("j", HINGE, "a", "b")
    m = b.root_joint(FreeFlyer(), placement=SE3.trans(0.0, 0.0, 1.0)).build()
    assert m.joint_names == ("root_joint", "j")
    assert (m.nq, m.nv) == (8, 7)
    assert m.joint("root_joint").parent_link is None
    assert m.joint("root_joint").parent == -1
    assert m.link("a").joint == 0
    np.testing.assert_array_equal(m.neutral, [0, 0, 0, 0, 0, 0, 1, 0])
    assert m.position_names[:2] == ("root_joint.x", "root_joint.y")
    assert m.velocity_names[5:] == ("root_joint.wz", "j")
    standing = b.root_joint(Fixed(), "stand", SE3.trans(0.0, 0.0, 1.0)).build()
    assert standing.nq == 1
    assert standing.link("a").placement.translation[2] == 1.0
    assert standing.joint("j").placement.translation[2] == 1.0
    assert standing.frame("stand").kind == "fixed_joint"


def test_configurations_by_joint_name() -> None:
    b = pair().add_link("c").add_joint("ball", Spherical(), "a", "b").add_joint("j", HINGE, "b", "c")
    b.add_configuration("turned", {"ball": [0.0, 0.0, 0.6, 0.8001], "j": 1.0}).add_configuration("rest", {})
    m = b.build()
    np.testing.assert_allclose(np.linalg.norm(m.configurations["turned"][:4]), 1.0, rtol=1e-15)
    np.testing.assert_array_equal(m.configurations["rest"], m.neutral)
    m2 = arm_builder().add_configuration("with a follower", {"grip2": 0.3, "grip": 0.02}).build()
    np.testing.assert_array_equal(m2.configurations["with a follower"], [0.0, 0.0, 0.0, 0.02])


def test_a_builder_can_go_on_after_building() -> None:
    b = pair().add_joint("j", HINGE, "a", "b")
    first = b.build()
    second = b.add_link("c").add_joint("k", HINGE, "b", "c").build()
    assert first.link_names == ("a", "b")
    assert second.link_names == ("a", "b", "c")
    assert first != second


def test_a_link_alone_is_a_model() -> None:
    m = ModelBuilder("rock").add_link("rock").build()
    assert (m.nq, m.nv, m.tool) == (0, 0, "rock")
    assert m.neutral.shape == (0,)
    assert isinstance(m, Model)


# -------- what is wrong

NAN = math.nan
Build = Callable[[], object]

REFUSED: dict[str, tuple[Build, str]] = {
    "no link": (lambda: ModelBuilder("m").build(), "has no links"),
    "two links of a name": (lambda: pair().add_link("a"), "two links named 'a'"),
    "two joints of a name": (
        lambda: pair().add_joint("j", HINGE, "a", "b").add_joint("j", HINGE, "b", "a"),
        "two joints named 'j'",
    ),
    "two frames of a name": (lambda: pair().add_frame("f", "a").add_frame("f", "b"), "two frames named 'f'"),
    "a frame named like a link": (
        lambda: pair().add_joint("j", HINGE, "a", "b").add_frame("b", "a").build(),
        "Frame 'b' has the name of a link",
    ),
    "a frame named like a joint": (
        lambda: pair().add_joint("j", Fixed(), "a", "b").add_frame("j", "a").build(),
        "Frame 'j' has the name of a fixed joint",
    ),
    "several roots": (lambda: pair().build(), "2 root links, 'a', 'b'; expected one"),
    "a circle": (
        lambda: pair().add_joint("j", HINGE, "a", "b").add_joint("k", HINGE, "b", "a").build(),
        "no root link: the joints run in a circle, 'a' -> 'b' -> 'a'",
    ),
    "a circle beside the tree": (
        lambda: pair().add_link("r").add_joint("j", HINGE, "a", "b").add_joint("k", HINGE, "b", "a").build(),
        "link 'a' is not connected to the root 'r'; the joints run in a circle",
    ),
    "two parents": (
        lambda: (
            pair()
            .add_link("c")
            .add_joint("j", HINGE, "a", "c")
            .add_joint("k", HINGE, "b", "c", where="f.urdf:7")
            .build()
        ),
        "f.urdf:7: Link 'c' is the child of two joints, 'j' and 'k'",
    ),
    "itself": (lambda: pair().add_joint("j", HINGE, "a", "a"), "connects link 'a' with itself"),
    "an empty name": (lambda: pair().add_link(""), "A link is named ''"),
    "an invalid name": (
        lambda: pair().add_joint("j", HINGE, "a", None),
        "child of joint 'j' is named None",
    ),  # type: ignore[arg-type]
    "a class for a kind": (lambda: pair().add_joint("j", Revolute, "a", "b"), r"write Revolute\(\.\.\.\)"),  # type: ignore[arg-type]
    "no kind": (lambda: pair().add_joint("j", "revolute", "a", "b"), "'revolute'; expected a JointKind"),  # type: ignore[arg-type]
    "limits swapped": (
        lambda: pair().add_joint("j", HINGE, "a", "b", lower=1.0, upper=-1.0, where="f:3"),
        "f:3: Joint 'j' has the lower limit 1 and the upper limit -1",
    ),
    "limits of nan": (
        lambda: pair().add_joint("j", HINGE, "a", "b", lower=NAN),
        "`lower` of joint 'j' holds nan",
    ),
    "limits of another shape": (
        lambda: pair().add_joint("j", HINGE, "a", "b", upper=[1.0, 2.0]),
        r"`upper` of joint 'j' has shape \(2,\); expected one number or 1 of them",
    ),
    "limits of text": (lambda: pair().add_joint("j", HINGE, "a", "b", upper="wide"), "expected numbers"),  # type: ignore[arg-type]
    "a negative speed": (
        lambda: pair().add_joint("j", HINGE, "a", "b", velocity=-1.0),
        "`velocity` .* is -1",
    ),
    "infinite damping": (
        lambda: pair().add_joint("j", HINGE, "a", "b", damping=np.inf),
        "`damping` of joint 'j' is infinite",
    ),
    "infinite armature": (
        lambda: pair().add_joint("j", HINGE, "a", "b", armature=np.inf),
        "`armature` of joint 'j' is infinite",
    ),
    "negative damping": (lambda: pair().add_joint("j", HINGE, "a", "b", damping=-1.0), "`damping` .* is -1"),
    "a placement of nan": (
        lambda: pair().add_joint("j", HINGE, "a", "b", SE3.identity() @ SE3(np.eye(3), np.full(3, NAN))),
        "placement of joint 'j' holds nan",
    ),
    "a placement that mirrors": (
        lambda: pair().add_joint("j", HINGE, "a", "b", SE3(np.diag([1.0, 1.0, -1.0]), np.zeros(3))),
        "placement of joint 'j' does not turn by a rotation",
    ),
    "a placement that is a matrix": (
        lambda: pair().add_joint("j", HINGE, "a", "b", np.eye(4)),  # type: ignore[arg-type]
        "placement of joint 'j' is a ndarray; expected an SE3",
    ),
    "a batch of placements": (
        lambda: pair().add_frame("f", "a", SE3(np.eye(3), np.zeros((2, 3)))),
        "placement of frame 'f' is a batch",
    ),
    "negative mass": (
        lambda: pair().add_link("c", Inertia(-1.0, np.zeros(3), np.eye(3)), where="f:9"),
        "f:9: Link 'c' has the mass -1 kg",
    ),
    "inertia of nan": (
        lambda: pair().add_link("c", Inertia(1.0, np.full(3, NAN), np.eye(3))),
        "holds nan or inf",
    ),
    "inertia askew": (
        lambda: pair().add_link("c", Inertia(1.0, np.zeros(3), np.triu(np.ones((3, 3))))),
        "not symmetric",
    ),
    "inertia that is a mass": (lambda: pair().add_link("c", 1.0), "float; expected an Inertia or None"),  # type: ignore[arg-type]
    "a visual that is a shape": (
        lambda: pair().add_link("c", visuals=[Box((1, 1, 1))]),  # type: ignore[list-item]
        "visuals of link 'c' is a Box; expected Geometry",
    ),
    "a visual not in a list": (
        lambda: pair().add_link("c", visuals=Geometry("g", Box((1, 1, 1)))),  # type: ignore[arg-type]
        "expected a list",
    ),
    "a frame of another kind": (lambda: pair().add_frame("f", "a", kind="link"), "expected 'user' or 'tool'"),
    "mimics in a circle": (
        lambda: (
            pair()
            .add_link("c")
            .add_joint("j", HINGE, "a", "b", mimic="k")
            .add_joint("k", HINGE, "a", "c", mimic="j")
            .build()
        ),
        "in a circle: 'j' -> 'k' -> 'j'",
    ),
    "a mimic of itself": (
        lambda: pair().add_joint("j", HINGE, "a", "b", mimic="j").build(),
        "in a circle: 'j' -> 'j'",
    ),
    "a mimic without numbers": (
        lambda: pair().add_joint("j", HINGE, "a", "b", mimic=("k", "fast", 0)),  # type: ignore[arg-type]
        "expected .name of the joint to follow, multiplier, offset",
    ),
    "a mimic with nan": (
        lambda: pair().add_joint("j", HINGE, "a", "b", mimic=("k", NAN, 0.0)),
        "`mimic` of joint 'j'",
    ),
    "a ball that mimics": (
        lambda: pair().add_joint("j", Spherical(), "a", "b", mimic="k"),
        "only joints with one coordinate can",
    ),
    "a mimic of a ball": (
        lambda: (
            pair()
            .add_link("c")
            .add_joint("j", Spherical(), "a", "b")
            .add_joint("k", HINGE, "a", "c", mimic="j")
            .build()
        ),
        "only joints with one coordinate can be followed",
    ),
    "a root joint that mimics": (lambda: pair().root_joint(HINGE, mimic="j"), "it cannot"),
    "a root joint named like another": (
        lambda: pair().add_joint("j", HINGE, "a", "b").root_joint(HINGE, "j").build(),
        "both named 'j'",
    ),
    "gravity of two numbers": (lambda: setattr(pair(), "gravity", (0, 1)), "`gravity`"),
    "gravity of words": (lambda: setattr(pair(), "gravity", "down"), "`gravity`"),
    "a configuration of another length": (
        lambda: arm_builder().add_configuration("bad", [1.0, 2.0]).build(),
        r"configuration 'bad' has shape \(2,\); expected \(4,\), one number for each of j0, j1",
    ),
    "a configuration of nan": (
        lambda: arm_builder().add_configuration("bad", {"j0": NAN}).build(),
        "joint 'j0' in configuration 'bad' holds nan",
    ),
    "a configuration off the sphere": (
        lambda: pair().add_joint("j", Spherical(), "a", "b").add_configuration("bad", [0, 0, 0, 2.0]).build(),
        "quaternion of joint 'j' in configuration 'bad' is not of unit length",
    ),
    "a group that is a string": (lambda: pair().add_group("g", "abc"), "expected a list of names"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refused(name: str) -> None:
    make, says = REFUSED[name]
    with pytest.raises(ModelError, match=says):
        make()


UNKNOWN: dict[str, tuple[Build, str, str]] = {
    "parent": (
        lambda: pair().add_joint("j", HINGE, "aa", "b", where="f:2").build(),
        "a",
        "f:2: It is the parent of",
    ),
    "child": (lambda: pair().add_joint("j", HINGE, "a", "bb").build(), "b", "It is the child of joint 'j'"),
    "frame": (lambda: arm_builder().add_frame("f", "hnd").build(), "hand", "Frame 'f' is to be on it"),
    "tool": (lambda: arm_builder().set_tool("tpc").build(), "tcp", "It is to be the tool"),
    "mimic": (
        lambda: pair().add_joint("joint1", HINGE, "a", "b", mimic="joint2").build(),
        "joint1",
        "Joint 'joint1' is to mimic it",
    ),
    "mimic of a fixed joint": (
        lambda: (
            pair()
            .add_link("c")
            .add_joint("j1", Fixed(), "a", "b")
            .add_joint("j2", HINGE, "a", "c", mimic="j1")
            .build()
        ),
        "j2",
        "No movable joint named 'j1'",
    ),
    "configuration": (
        lambda: arm_builder().add_configuration("c", {"gripp": 0.0}).build(),
        "grip",
        "It is in configuration 'c'",
    ),
    "pair": (lambda: arm_builder().disable_pair("hand", "lefft").build(), "left", "collision check"),
    "group": (lambda: arm_builder().add_group("g", ["wrst"]).build(), "wrist", "in group 'g'"),
    "joint of the model": (lambda: arm().joint("j9"), "j2", "No joint named 'j9'"),
    "fixed joint of the model": (lambda: arm().joint("wrist"), "", "That joint is fixed"),
    "link of the model": (lambda: arm().link("hnd"), "hand", "No link named"),
    "frame of the model": (lambda: arm().frame("camra"), "camera", "No frame named"),
    "configuration of the model": (lambda: arm().configurations["hom"], "home", "No configuration named"),
    "group of the model": (lambda: arm().groups["finger"], "fingers", "No group named"),
}


@pytest.mark.parametrize("name", UNKNOWN)
def test_unknown_names_offer_the_nearest(name: str) -> None:
    make, nearest, says = UNKNOWN[name]
    with pytest.raises(UnknownName, match=says) as error:
        make()
    if nearest:
        assert nearest in str(error.value)


def test_impossible_inertias_are_warned_of_and_used() -> None:
    b = pair().add_joint("j", HINGE, "a", "b")
    b.add_link("c", Inertia(1.0, np.zeros(3), np.diag([-0.1, 1.0, 1.0])), where="f:4")
    b.add_joint("k", Prismatic(), "b", "c")
    with pytest.warns(ModelWarning, match=r"f:4: 'c' \(-0.1 kg m\^2\)"):
        m = b.build()
    assert m.inertias[1].inertia[0, 0] == -0.1


def test_a_moment_larger_than_the_others_together_is_warned_of_once_with_the_worst() -> None:
    b = pair().add_joint("j", HINGE, "a", "b")
    for name, moments in {"c": [1.0, 1.0, 2.3], "d": [0.5, 1.0, 2.0]}.items():
        b.add_link(name, Inertia(1.0, np.zeros(3), np.diag(moments)), where=f"f:{name}")
        b.add_joint(f"to_{name}", Prismatic(), "b", name)
    with pytest.warns(ModelWarning, match=r"at 2 links, the worst f:d: 'd': 2 > 1 \+ 0.5 kg m\^2") as caught:
        b.build()
    assert len(caught) == 1


def test_thin_plates_and_placeholders_are_not_warned_of() -> None:
    b = pair().add_joint("j", HINGE, "a", "b")
    b.add_link("plate", Inertia(1.0, np.zeros(3), np.diag([0.34, 0.34, 0.69])))  # rounded to two digits
    b.add_link("mark", Inertia(1e-6, np.zeros(3), np.diag([1e-6, 1e-6, 3e-6])))
    b.add_link(
        "sheet", Inertia(0.0, np.zeros(3), np.diag([0.0, 0.35, 0.0]))
    )  # as the first body of the Puma is described
    for name in ("plate", "mark", "sheet"):
        b.add_joint(f"to_{name}", Prismatic(), "b", name)
    assert b.build().nq == 4


def test_the_warning_is_given_once() -> None:
    b = pair().add_joint("j", HINGE, "a", "b")
    b.add_link("c", Inertia(1.0, np.zeros(3), np.diag([-0.1, 1.0, 1.0]))).add_joint(
        "k", Prismatic(), "b", "c"
    )
    with pytest.warns(ModelWarning):
        m = b.build()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert lock_joints(m, ["k"]).nq == 1


def test_possible_inertias_are_not_warned_of() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        b = pair().add_joint("j", HINGE, "a", "b")
        b.add_link("thin", Inertia(1.0, np.zeros(3), np.diag([0.0, 1.0, 1.0])))
        b.add_joint("k", Prismatic(), "b", "thin")
        noise = np.zeros((3, 3))
        noise[0, 2] = noise[2, 0] = 1.4e-20  # a point mass, as a program that cancels writes it
        b.add_link("point", Inertia(0.3, np.zeros(3), noise))
        b.add_joint("l", Prismatic(), "thin", "point").build()
