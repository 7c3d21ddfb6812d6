"""Drawings of robots in figures have handles: one robot in several configurations, colours, and what steps move."""

from __future__ import annotations

import importlib
import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from support.compat_packages import using

pytest.importorskip("spatialmath")
matplotlib = pytest.importorskip("matplotlib")


@pytest.fixture
def env() -> Iterator[Any]:
    matplotlib.use("agg")
    with using("roboticstoolbox"):
        figure = importlib.import_module("roboticstoolbox.backends.PyPlot").PyPlot()
        figure.launch(limits=[-3, 3])
        yield figure
        figure.close()


@pytest.fixture
def robot(env: Any) -> Any:
    return importlib.import_module("roboticstoolbox").models.DH.Planar3()


def test_one_robot_is_drawn_in_two_configurations(env: Any, robot: Any) -> None:
    from roboticstoolbox.backends.PyPlot.RobotPlot import RobotPlot

    follows, pinned = env.add(robot), env.add(robot, q=[0.5, 0.5, 0.5], color="r")
    assert isinstance(pinned, RobotPlot) and env.robots == [follows, pinned] and env.ellipses == []
    robot.q = [0.1, 0.2, 0.3]
    assert follows.q.tolist() == [0.1, 0.2, 0.3] and pinned.q.tolist() == [0.5, 0.5, 0.5]
    before = env.picture()
    pinned.q = [-0.5, 0.2, 0.1]
    pinned.draw()
    assert (env.picture() != before).any() and robot.q.tolist() == [0.1, 0.2, 0.3]
    with pytest.raises(ValueError, match="q"):
        pinned.q = [1, 2]
    env.remove(pinned)
    assert env.robots == [follows]


def test_looks_have_their_effect(env: Any, robot: Any) -> None:
    pictures = []
    for looks in (
        {},
        {"color": "r"},
        {"options": {"robot": {"color": "r"}}},
        {"shadow": False},
        {"eeframe": False},
        {"display": False},
    ):
        plot = env.add(robot, **looks)
        pictures.append(env.picture())
        env.remove(plot)
    assert (pictures[1] == pictures[2]).all()
    different = [pictures[0], pictures[1], *pictures[3:]]
    assert all((a != b).any() for i, a in enumerate(different) for b in different[:i])
    with pytest.warns(UserWarning, match="jointlabels"):
        env.add(robot, jointlabels=True)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        env.add(robot, jointaxes=True, name=True)


def test_a_step_moves_each_robot_once(env: Any, robot: Any) -> None:
    env.add(robot), env.add(robot, q=[0, 0, 0])
    robot.q, robot.qd = np.zeros(3), np.array([0.2, 0, 0])
    env.step(0.5)
    np.testing.assert_allclose(robot.q, [0.1, 0, 0])
    env.reset()
    env.add(robot, readonly=True)
    env.step(0.5)
    np.testing.assert_allclose(robot.q, [0.1, 0, 0])
    ellipse = env.add(robot.vellipse([0.1, 0.2, 0.3]))
    assert len(env.ellipses) == 1
    env.remove(ellipse)
    assert env.ellipses == []


def test_ellipses_are_made_by_their_class_too(env: Any, robot: Any) -> None:
    from roboticstoolbox.backends.PyPlot.EllipsePlot import EllipsePlot

    q = np.array([0.1, 0.2, 0.3])
    ours, made = (
        robot.vellipse(np.degrees(q), unit="deg", scale=0.5),
        EllipsePlot(robot, q, "v", centre="ee", scale=0.5),
    )
    assert isinstance(ours, EllipsePlot)
    np.testing.assert_allclose(made.points, ours.points, atol=1e-12)
    np.testing.assert_allclose(EllipsePlot(robot, q, "f", centre=[1, 2, 3]).centre, [1, 2, 3])
    env.add(made)
    assert env.ellipses == [made]
    for wrong in ({"etype": "x"}, {"etype": "v", "opt": "both"}):
        with pytest.raises(ValueError):
            EllipsePlot(robot, q, **wrong)
