"""A shown robot without a browser: what sliders, buttons and the target do, on robots of many kinds."""

import time
from collections.abc import Iterator

import numpy as np
import pytest

pytest.importorskip("viser", reason="viser, which serves the page, is not installed")

import ulna
from support.patience import patient
from ulna.errors import InputError, MissingExtra, NonFiniteError, ShapeError, UnknownName
from ulna.model import Continuous, FreeFlyer, ModelBuilder, Prismatic, Revolute, Spherical
from ulna.spatial import SE3
from ulna.viewer.robot.slider_coordinates import _without_common_prefix
from ulna.viewer.scene import Scene
from ulna.viewer.show import Show, configuration, show

wait = patient(pause=0.01)


@pytest.fixture(scope="module")
def panda() -> ulna.Robot:
    return ulna.load("panda", visuals="simple")


@pytest.fixture
def shown(panda: ulna.Robot) -> Iterator[Show]:
    with show(panda, port=0, browser=False) as page:
        yield page


def in_scene(shown: Show, link: str) -> np.ndarray:
    return shown.scene.poses[shown.scene.row(f"{shown.robot.name}/{link}")]


def test_it_starts_at_the_usual_configuration(shown: Show, panda: ulna.Robot) -> None:
    np.testing.assert_array_equal(shown.q, panda.configurations["qr"])
    assert shown.url in repr(shown)
    assert shown.url in shown._repr_html_()


def test_it_is_closed_by_name_and_at_the_end_of_a_block(panda: ulna.Robot) -> None:
    page = show(panda, port=0, browser=False)
    assert not page.page.closed
    page.close()
    assert page.page.closed
    page.close()  # twice is no mistake
    with show(panda, port=0, browser=False) as page:
        assert not page.page.closed
    assert page.page.closed


def test_setting_q_moves_everything(shown: Show, panda: ulna.Robot) -> None:
    shown.q = "qz"
    np.testing.assert_allclose(in_scene(shown, "panda_hand"), panda.fk(np.zeros(7), "panda_hand"), atol=1e-12)
    np.testing.assert_allclose(shown.tool, panda.fk(np.zeros(7)))
    assert wait(lambda: shown.teach_panel.sliders[1].value == 0.0)
    assert wait(lambda: bool(np.abs(shown.teach_panel.gizmo.pose - shown.tool).max() < 1e-6))
    x, _, z = shown.tool[:3, 3]
    assert wait(
        lambda: (
            f"{x:.3f} m" in shown.teach_panel.readout.value
            and f"{z:.3f} m" in shown.teach_panel.readout.value
        )
    )


def test_what_q_gives_cannot_be_written_to(shown: Show) -> None:
    with pytest.raises(ValueError, match="read-only"):
        shown.q[0] = 1.0
    assert shown.q[0] == 0.0


def test_a_target_within_reach_is_reached(shown: Show) -> None:
    goal = shown.tool @ SE3.from_rpy((0.1, 0.2, -0.3), (0.1, 0.1, 0.05)).matrix()
    shown.aim(goal)
    assert wait(lambda: bool(np.abs(shown.tool - goal).max() < 1e-8))


def test_from_out_of_reach_the_target_returns_to_the_tool(shown: Show, panda: ulna.Robot) -> None:
    goal = shown.tool
    goal[0, 3] = 3.0
    shown.aim(goal)
    assert wait(lambda: shown.teach_panel.goal is None)
    assert wait(lambda: bool(np.abs(shown.teach_panel.gizmo.pose - shown.tool).max() < 1e-6))
    assert panda.limits.contains(shown.q)
    assert shown.tool[0, 3] > 0.6


def test_while_it_is_held_the_target_stays_in_the_hand(shown: Show) -> None:
    goal = shown.tool
    goal[0, 3] = 3.0
    shown.teach_panel.gizmo.is_dragged = True
    shown.aim(goal)
    time.sleep(1.0)
    np.testing.assert_allclose(shown.teach_panel.gizmo.pose, goal, atol=1e-6)
    shown.teach_panel.gizmo.is_dragged = False
    assert wait(lambda: bool(np.abs(shown.teach_panel.gizmo.pose - shown.tool).max() < 1e-6))


def test_a_glide_ends_exactly_at_its_configuration(shown: Show, panda: ulna.Robot) -> None:
    shown.teach_panel.move_to(panda.configurations["qz"])
    assert wait(lambda: bool((shown.q == 0).all()))


def test_setting_q_ends_a_glide(shown: Show, panda: ulna.Robot) -> None:
    shown.teach_panel.move_to(panda.configurations["qz"])
    shown.q = "qr"
    time.sleep(0.3)
    np.testing.assert_array_equal(shown.q, panda.configurations["qr"])


def test_mistakes_are_named(shown: Show, panda: ulna.Robot) -> None:
    for wrong, error in ((np.zeros(6), ShapeError), ([np.nan] * 7, NonFiniteError), ("qy", UnknownName)):
        with pytest.raises(error):
            shown.q = wrong
    with pytest.raises(ShapeError, match="T_goal"):
        shown.aim(np.zeros(3))
    with pytest.raises(NonFiniteError, match="T_goal"):
        shown.aim(np.full((4, 4), np.inf))
    with pytest.raises(InputError, match="T_goal"):
        shown.aim(2.0 * np.eye(4))
    np.testing.assert_array_equal(shown.q, panda.configurations["qr"])


def test_a_page_that_cannot_open_leaves_the_scene_as_it_was(
    panda: ulna.Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    import sys

    scene = Scene()
    monkeypatch.setitem(sys.modules, "viser", None)
    with pytest.raises(MissingExtra):
        show(panda, port=0, browser=False, scene=scene)
    assert scene.names == ()


def odd_robot() -> ulna.Robot:
    """A floating base, a ball joint, a joint without limits, and a slide with another that follows it."""
    builder = ModelBuilder("odd")
    for name in ("base", "ball", "wheel", "slide", "follower"):
        builder.add_link(name)
    builder.add_joint("joint_ball", Spherical(), "base", "ball")
    builder.add_joint("joint_wheel", Continuous((0, 0, 1)), "ball", "wheel", SE3.trans(0, 0, 0.2))
    builder.add_joint(
        "joint_slide", Prismatic((1, 0, 0)), "wheel", "slide", SE3.trans(0.1, 0, 0), lower=0.0, upper=0.05
    )
    builder.add_joint(
        "joint_follower", Prismatic((1, 0, 0)), "slide", "follower", mimic=("joint_slide", 1.0, 0.0)
    )
    builder.root_joint(FreeFlyer())
    return ulna.Robot(builder.build())


def test_joints_of_several_coordinates_have_a_slider_for_each_and_stay_whole() -> None:
    robot = odd_robot()
    with show(robot, port=0, browser=False) as shown:
        labels = [dial.label for dial in shown.teach_panel.coordinates]
        assert len(labels) == len(shown.teach_panel.sliders) == 6 + 3 + 2
        assert any("yaw [rad]" in label for label in labels)
        for dial in shown.teach_panel.coordinates:
            q = dial.write(robot.neutral, 0.04)
            assert dial.read(q) == pytest.approx(0.04, abs=1e-9)
            np.testing.assert_allclose(robot.normalize(q), q, atol=1e-12)
            assert np.abs(robot.difference(q, robot.neutral)).max() > 0.01
        np.testing.assert_array_equal(shown.q, robot.neutral)
        goal = shown.tool
        goal[:3, 3] += (0.03, 0.02, 0.0)
        shown.aim(goal)
        assert wait(lambda: shown.teach_panel.goal is None)
        assert robot.limits.contains(shown.q)
        np.testing.assert_allclose(shown.q[:11], robot.neutral[:11])  # base and ball do not move


def test_a_robot_that_cannot_move_can_be_looked_at() -> None:
    robot = ulna.Robot(ModelBuilder("block").add_link("base").build())
    with show(robot, port=0, browser=False) as shown:
        assert shown.q.shape == (0,)
        assert not shown.teach_panel.sliders


def test_the_usual_configuration() -> None:
    builder = ModelBuilder("one").add_link("a").add_link("b")
    builder.add_joint("j", Revolute((0, 0, 1)), "a", "b", lower=-1, upper=1)
    assert configuration(ulna.Robot(builder.build()), None).tolist() == [0.0]
    builder.add_configuration("odd", [0.5])
    assert configuration(ulna.Robot(builder.build()), None).tolist() == [0.5]
    builder.add_configuration("home", [0.25])
    assert configuration(ulna.Robot(builder.build()), None).tolist() == [0.25]


@pytest.mark.parametrize(
    ("names", "short"),
    [
        (("panda_joint1", "panda_joint2"), ("joint1", "joint2")),
        (("shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint"), None),
        (("left_a_1", "left_a_2", "left_b"), ("a_1", "a_2", "b")),
        (("only_one",), None),
        (("a", "ab"), None),
        (("arm_", "arm_x"), ("arm_", "x")),
    ],
)
def test_names_lose_what_all_of_them_begin_with(
    names: tuple[str, ...], short: tuple[str, ...] | None
) -> None:
    assert tuple(_without_common_prefix(n, names) for n in names) == (short or names)
