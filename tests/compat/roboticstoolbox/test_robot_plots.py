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


def test_plots_share_a_figure(robot: Any) -> None:
    first, second = np.array([0.1, 0.2, 0.3]), np.array([0.5, -0.4, 0.9])
    env = robot.plot(first, backend="pyplot", color="gray", block=False)
    assert robot.plot(second, env=env, color="red", shadow=False, block=False) is env
    assert [plot.looks["color"] for plot in env.robots] == [(128 / 255,) * 3, (1.0, 0.0, 0.0)]
    assert np.array_equal(env.robots[0].q, first) and np.array_equal(env.robots[1].q, second)
    robot.vellipse(second), robot.fellipse(second, add=False)
    assert len(env.ellipses) == 1 and len(env.robots) == 2
    taught = robot.teach(second, backend="pyplot", vellipse=True, block=False)
    assert taught.robots[0].ellipsoids == ("velocity",) and len(taught.robots[0].ellipsoid_points()) == 1
    robot.fellipse(second)
    assert len(taught.ellipses) == 1 and len(env.ellipses) == 1
    assert robot.copy()._figure is None
    with pytest.raises(ValueError, match="x, y, z from and to"):
        robot.plot(second, backend="pyplot", limits=[1, 2, 3], block=False)


def test_teaching_starts_at_rows_columns_and_numbers(robot: Any) -> None:
    import roboticstoolbox as rtb

    q = np.array([0.1, 0.2, 0.3])
    for start in (q, q.reshape(1, 3), q.reshape(3, 1), q.tolist()):
        robot.q = np.zeros(3)
        env = robot.teach(start, backend="pyplot", block=False)
        assert np.array_equal(robot.q, q) and np.array_equal(env.robots[0].q, q)
        env.close()
    for wrong in (q[:2], np.zeros((2, 3)), 0.5):
        with pytest.raises(ValueError, match="q"):
            robot.teach(wrong, backend="pyplot", block=False)
    single = rtb.DHRobot([rtb.RevoluteDH(a=1.0)])
    env = single.teach(0.5, backend="pyplot", block=False)
    assert single.q.tolist() == [0.5] and env.sliders[0].val == 0.5
    env.close()


def test_a_scene_that_is_there_keeps_how_it_was_made_but_can_be_looked_at_otherwise(robot: Any) -> None:
    q = np.array([0.1, 0.2, 0.3])
    env = robot.plot(q, backend="pyplot", limits=[-1, 1], view="xz", block=False)
    assert (env.ax.elev, env.ax.azim) == (0, -90) and list(env.limits) == [-1, 1] * 3
    robot.plot(q, env=env, view="xy", backend="swift", block=False)  # the backend of the scene is used
    assert (env.ax.elev, env.ax.azim) == (90, -90) and len(env.robots) == 2
    for given in ({"limits": [-2, 2]}, {"fig": "other"}, {"ax": env.ax}, {"notebook": False}):
        with pytest.raises(ValueError, match=f"env and {next(iter(given))}"):
            robot.plot(q, env=env, block=False, **given)
    with pytest.raises(ValueError, match="diagonal"):
        robot.plot(q, env=env, view="diagonal", block=False)
    assert len(env.robots) == 2


def test_the_viewer_refuses_what_it_cannot_do_and_shows_a_robot_twice(robot: Any) -> None:
    q = np.array([0.1, 0.2, 0.3])
    for given in ({"limits": [-1, 1]}, {"fig": "a"}, {"view": "xy"}, {"vellipse": True}, {"movie": "a.gif"}):
        with pytest.raises(ValueError, match=f"{next(iter(given))} of plot: matplotlib's figures have it"):
            robot.plot(q, backend="swift", block=False, **given)
    env = robot.plot(q, backend="swift", block=False)
    assert robot.plot([q, 2 * q], env=env, block=False) is env
    assert [item.q.tolist() for item in (env[0], env[1])] == [q.tolist(), (2 * q).tolist()]
    env.close()
