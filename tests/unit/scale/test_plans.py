"""Many plans: those of the planner, each with its own seed, the same after kills and stops."""

from __future__ import annotations

import os
import signal
import threading
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ulna
from ulna import scale
from ulna.collision import World
from ulna.errors import InputError, ShapeError, UnknownName
from ulna.geometry import Box
from ulna.planning import Planner

WORLD = World().add("post", Box((0.1, 0.1, 1.0)), (0.5, 0.0, 0.3))
QUIET: Any = {"workers": 0, "progress": False}


@pytest.fixture(scope="module")
def panda() -> ulna.Robot:
    return ulna.load("panda")


def _assert_same(a: scale.PlanSet, b: scale.PlanSet) -> None:
    for field in fields(scale.PlanSet):
        if field.name != "job":
            np.testing.assert_array_equal(getattr(a, field.name), getattr(b, field.name), err_msg=field.name)


def test_plans_are_those_of_the_planner(panda: ulna.Robot) -> None:
    found = scale.plans(panda, 12, WORLD, seed=3, chunk=5, **QUIET)
    assert len(found) == 12 and found.success.all() and found.certified.all()
    assert not panda.collides(found.starts, WORLD, method="spheres").any()
    planner = Planner(panda, WORLD)
    for k in (0, 7, 11):
        seed = int(np.random.SeedSequence(3, spawn_key=(k,)).generate_state(1)[0])
        alone = planner.plan(found.starts[k], found.goals[k], seed=seed)
        np.testing.assert_array_equal(found.path(k), alone.points)
        assert found.cost[k] == alone.cost and found.iterations[k] == alone.iterations
    assert "12 of 12 problems solved, 12 certified" in repr(found)


def test_custom_problems_in_several_worlds(panda: ulna.Robot) -> None:
    q = np.array(panda.configurations["qr"])
    starts = q + np.array([[-0.6], [-0.6], [0.5], [0.0]]) * np.eye(7)[0]
    goals = np.array(panda.fk(q + 0.6 * np.eye(7)[0]))
    goals = np.stack([goals, goals, goals, goals])
    goals[3, :3, 3] = 9.0
    inside = World().add("box", Box((3.0, 3.0, 3.0)), (0.0, 0.0, 2.0))
    found = scale.plans(panda, None, [WORLD, inside], starts=starts, goals=goals, chunk=1, **QUIET)
    assert found.worlds.tolist() == [0, 0, 1, 1]
    assert [found.outcome(k) for k in range(4)] == ["solved", "solved", "start", "unreachable"]
    assert "'box'" in found.reason(2) and found.reason(0) == "" and len(found.path(2)) == 0
    np.testing.assert_allclose(panda.fk(found.path(1)[-1]), goals[1], atol=1e-5)
    assert np.isnan(found.cost[2:]).all() and found.counts()["start"] == 1


def test_plans_are_the_same_on_a_cluster_that_loses_a_worker(client: Any, tmp_path: Path) -> None:
    expected = scale.plans("panda", 24, WORLD, chunk=3, **QUIET)

    def stop(progress: scale.Progress) -> None:
        if progress.done == 1:
            raise KeyboardInterrupt

    to = tmp_path / "plans.zarr"
    with pytest.raises(KeyboardInterrupt):
        scale.plans("panda", 24, WORLD, chunk=3, to=to, workers=0, progress=stop)
    killed = threading.Event()

    def kill(progress: scale.Progress) -> None:
        if not killed.is_set():
            killed.set()
            os.kill(next(iter(client.run(os.getpid).values())), signal.SIGKILL)

    found = scale.plans("panda", 24, WORLD, chunk=3, to=to, scheduler=client, progress=kill)
    assert killed.is_set()
    _assert_same(found, expected)
    _assert_same(scale.PlanSet.load(to), expected)
    _assert_same(scale.plans("panda", 24, WORLD, chunk=3, to=to, **QUIET), expected)  # it is there
    with pytest.raises(InputError, match="its seed is 0, here it is 1"):
        scale.plans("panda", 24, WORLD, chunk=3, to=to, seed=1, **QUIET)


def test_invalid_plans_are_refused(panda: ulna.Robot, tmp_path: Path) -> None:
    q = np.zeros(7)
    for arguments, error, text in (
        ({}, InputError, "Expected `problems`"),
        ({"problems": 3, "starts": q}, InputError, "beside `starts`"),
        ({"starts": q, "goals": np.zeros(6)}, ShapeError, r"`goals`.*\(6,\)"),
        ({"starts": np.zeros((2, 7)), "goals": np.zeros((3, 7))}, ShapeError, "as many as `starts`"),
        ({"problems": 2, "world": [WORLD] * 3}, InputError, "3 worlds for 2 problems"),
        ({"problems": 2, "world": ["post"]}, InputError, "expected a World"),
        ({"problems": 2, "world": "post"}, InputError, "`world` is 'post'; expected a World"),
        ({"problems": 1e30}, InputError, "from 1 to 9e15"),
        (
            {"problems": 2, "worker": 1},
            UnknownName,
            "No option of a job named 'worker'. Did you mean 'workers'",
        ),
        ({"problems": 2, "frame": "hand"}, UnknownName, "panda_hand"),
        ({"problems": 2, "margin": -1.0}, InputError, "`margin`"),
        ({"problems": 2, "iterations": 0}, InputError, "`iterations`"),
    ):
        with pytest.raises(error, match=text):
            scale.plans(panda, to=tmp_path / "plans.zarr", **QUIET, **arguments)  # type: ignore[arg-type]
    assert not list(tmp_path.iterdir()), "other arguments can be given now"
    with pytest.raises(InputError, match="`number` is 1"):
        scale.plans(panda, 1, **QUIET).path(1)
