"""Long searches show how many samples they have taken, and batches how many problems are done."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np
import pytest

import ulna
from ulna.collision import World
from ulna.geometry import Box
from ulna.planning import Planner, planner, run, search

Shown = list[tuple[str, int, int]]


@pytest.fixture
def shown(monkeypatch: pytest.MonkeyPatch) -> Shown:
    """What is reported; searches count as long from their beginning."""
    seen: Shown = []

    @contextmanager
    def progress(what: str) -> Iterator[Callable[[int, int], None]]:
        yield lambda done, of: seen.append((what, done, of))
        seen.append((what, -1, -1))

    monkeypatch.setattr(run, "_SHORT", -1.0)
    monkeypatch.setattr(
        search, "_SLICE_SECONDS", np.inf
    )  # else the first samples are taken before a look at the clock
    for module in (run, planner):
        monkeypatch.setattr(module, "progress", progress)
    return seen


@pytest.mark.parametrize("method", ["spheres", "exact"])
def test_a_long_search_shows_its_samples(method: planner.Method, shown: Shown) -> None:
    if method == "exact":
        pytest.importorskip("coal")
    robot = ulna.load("panda", visuals="simple")
    wall = World().add("wall", Box((0.2, 0.02, 0.4)), (0.3, 0.0, 0.5))
    q = robot.configurations["ready"]
    start, goal = q + np.eye(7)[0] * 0.8, q - np.eye(7)[0] * 0.8
    plan = Planner(robot, wall, method=method).plan(start, goal, iterations=60)
    assert plan.nodes > 0
    assert {what for what, _, _ in shown} == {"Planning"}
    assert shown[0][1:] == (0, 60) and shown[-1][1:] == (-1, -1)


def test_a_batch_shows_its_problems_only(shown: Shown) -> None:
    robot = ulna.load("panda", visuals="simple")
    q = robot.configurations["ready"]
    planned = Planner(robot)
    planned.plan_all(q, [q + 0.1, q - 0.1])
    assert [(done, of) for _, done, of in shown] == [(0, 2), (1, 2), (-1, -1)]
    assert planned._batches == 0
