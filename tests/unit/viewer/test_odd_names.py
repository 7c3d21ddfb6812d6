"""Robots with names that are no names of nodes are shown, too."""

from __future__ import annotations

import pytest
from ulna.viewer.node import node_name

import ulna
from ulna.viewer.viewer import Viewer

TEXT = (
    '<robot name="{}"><link name="a/"/><link name="//"/><joint name="j" type="continuous">'
    '<parent link="a/"/><child link="//"/><axis xyz="0 0 1"/></joint></robot>'
)


@pytest.mark.parametrize(
    ("name", "node"),
    [("a//b", "a/b"), ("/a", "a"), ("a/", "a"), ("//", "robot"), ("a/ /b", "a/b"), ("ns/arm", "ns/arm")],
)
def test_robots_with_slashes_in_their_names_are_shown(name: str, node: str) -> None:
    robot = ulna.load(TEXT.format(name))
    assert robot.name == name and node_name(name) == node
    viewer = Viewer(page=False)
    handle = viewer.add(robot)
    assert handle.name == node
    handle.q = [0.5]
    assert viewer.add(robot).name == f"{node} 2"
