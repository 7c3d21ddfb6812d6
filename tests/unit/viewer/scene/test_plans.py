"""Plans in the viewer: the path of the tool and the trees of the search, where the robot's kinematics puts them."""

from __future__ import annotations

import numpy as np
import pytest

import ulna
from ulna.collision import World
from ulna.errors import InputError, UnknownName
from ulna.geometry import Box

POST = World().add("post", Box((0.1, 0.1, 1.0)), (0.45, 0.0, 0.3))


@pytest.fixture(scope="module")
def robot() -> ulna.Robot:
    return ulna.load("panda")


@pytest.fixture(scope="module")
def plan(robot: ulna.Robot) -> ulna.planning.Plan:
    q = robot.configurations["ready"] + [0, 0.3, 0, 0, 0, 0, 0]
    turn = np.array([0.7, 0, 0, 0, 0, 0, 0])
    return robot.plan(
        q - turn, q + turn, POST.add("top", Box((0.5, 0.6, 0.04)), (0.5, 0.0, 0.75)), keep_tree=True
    )


def test_the_tree_holds_the_search(robot: ulna.Robot, plan: ulna.planning.Plan) -> None:
    tree = plan.tree
    assert tree is not None and plan and len(tree) == plan.nodes
    np.testing.assert_allclose(tree.nodes[0], plan.points[0], atol=1e-6)
    assert tree.parents[0] == -1 and tree.is_from_start[0] and not tree.is_from_start[-1]
    parents, children = tree.edges.T
    assert (tree.is_from_start[parents] == tree.is_from_start[children]).all() and (parents < children).all()
    roots = np.flatnonzero(tree.parents < 0)
    np.testing.assert_allclose(tree.nodes[roots[1:]], plan.points[-1:], atol=1e-6)
    assert (np.linalg.norm(tree.nodes[parents] - tree.nodes[children], axis=1) < 1.0 + 1e-5).all()
    assert not robot.collides(tree.nodes, POST, method="spheres").any()
    assert repr(tree).startswith("<search tree, ")


def test_only_those_who_ask_get_the_tree(robot: ulna.Robot) -> None:
    q = robot.configurations["ready"]
    assert robot.plan(q, q + 0.1).tree is None
    assert robot.plan(q, q + 0.1, keep_tree=True).tree is None  # straight ahead: there was no search
    stuck = robot.plan(q - 0.3, q + [1.5, 0, 0, 0, 0, 0, 0], POST, iterations=3, keep_tree=True, seed=1)
    assert stuck.tree is None or len(stuck.tree) >= 2


def test_lines_lie_where_the_tool_goes(robot: ulna.Robot, plan: ulna.planning.Plan) -> None:
    viewer = ulna.Viewer(page=False)
    arm = viewer.add(robot, "ready", pose=(1.0, 2.0, 0.0))
    handles = viewer.plan(plan, frame="panda_hand")
    assert list(handles) == ["path", "from start", "from goal"]
    segments = handles["path"]._content().segments
    np.testing.assert_allclose(segments[0, 0], robot.fk(plan.points[0], "panda_hand")[:3, 3], atol=1e-12)
    np.testing.assert_allclose(segments[-1, 1], robot.fk(plan.points[-1], "panda_hand")[:3, 3], atol=1e-12)
    np.testing.assert_array_equal(segments[1:, 0], segments[:-1, 1])
    assert np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1).max() < 0.1
    np.testing.assert_allclose(handles["path"].world_pose[:3, 3], (1.0, 2.0, 0.0))
    arm.pose = (0.0, 0.0, 1.0)  # the lines go where the robot goes
    np.testing.assert_allclose(handles["path"].world_pose[:3, 3], (0.0, 0.0, 1.0))


def test_wrong_input_says_what_is_missing(robot: ulna.Robot, plan: ulna.planning.Plan) -> None:
    viewer = ulna.Viewer(page=False)
    with pytest.raises(InputError, match="expected the handle that viewer.add"):
        viewer.plan(plan)
    viewer.add(robot, "ready")
    with pytest.raises(InputError, match=r"expected a Plan, as robot.plan"):
        viewer.plan(plan.points)
    with pytest.raises(UnknownName, match="panda_hand"):
        viewer.plan(plan, frame="panda_hnad")
    q = robot.configurations["ready"]
    with pytest.raises(InputError, match="no path and no tree"):
        viewer.plan(robot.plan(q, q))
    other = ulna.Viewer(page=False)
    other.add(ulna.load("ur5"))
    with pytest.raises(InputError, match="whose joints are not those"):
        other.plan(plan)
