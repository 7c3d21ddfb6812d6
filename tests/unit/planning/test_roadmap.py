"""Roadmaps: their edges are free, plans along them are certified, and trees help where they do not reach."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

import ulna
from ulna.collision import World
from ulna.errors import InputError
from ulna.geometry import Box, Geometry
from ulna.model import Continuous, ModelBuilder
from ulna.planning import Planner, roadmap
from ulna.planning.search import Search


@cache
def robot() -> Any:
    return ulna.load("panda")


@cache
def planner() -> Planner:
    world = World().add("table", Box((1.2, 1.6, 0.04)), (0.5, 0.0, -0.02), touches=["panda_link0"])
    world = world.add("wall", Box((0.3, 0.02, 0.4)), (0.55, 0.0, 0.2))
    return Planner(robot(), world, roadmap=400)


def free_configurations(count: int, seed: int) -> Any:
    random = np.random.default_rng(seed)
    q = random.uniform(robot().limits.lower, robot().limits.upper, (40 * count, 7))
    free = q[~robot().collides(q, planner().scene.world, method="spheres", margin=0.02)]
    return free[:count]


def test_all_its_motions_are_free() -> None:
    roadmap = planner()._search.roadmap  # type: ignore[attr-defined]
    assert len(roadmap.nodes) > 50 and len(roadmap.edges) > 100
    a, b = (roadmap.nodes[roadmap.edges[:, k]] for k in range(2))
    np.testing.assert_allclose(np.linalg.norm(a - b, axis=1), roadmap.lengths, rtol=1e-5)
    assert len(np.unique(np.sort(roadmap.edges, axis=1), axis=0)) == len(roadmap.edges)
    assert (a != b).any(axis=1).all()
    for t in (0.0, 0.25, 0.5, 0.75, 1.0):
        touching = robot().collides(a + t * (b - a), planner().scene.world, method="spheres")
        assert touching.mean() < 0.02  # steps of the search are long


def test_plans_along_it_are_certified_and_repeatable(monkeypatch: pytest.MonkeyPatch) -> None:
    q = free_configurations(12, 0)
    grown: list[Any] = []
    grow = Search._grow

    def counted(self: Any, run: Any) -> bool:
        grown.append(run)
        return grow(self, run)

    monkeypatch.setattr(Search, "_grow", counted)
    for a, b in zip(q[:6], q[6:], strict=True):
        p, again = planner().plan(a, b), planner().plan(a, b)
        assert p and p.is_certified
        np.testing.assert_array_equal(p.points, again.points)
        np.testing.assert_array_equal(p.points[[0, -1]], [a, b])
    assert len([run for run in grown if run.options.coarse == 8.0]) < 6  # most need no trees


def test_the_nearest_of_several_goals_is_reached() -> None:
    q = free_configurations(6, 3)
    p = planner().plan(q[0], q[1:])
    assert p and p.is_certified and 0 <= p.goal < 5
    np.testing.assert_array_equal(p.points[-1], q[1 + p.goal])
    singles = [planner().plan(q[0], goal).cost for goal in q[1:]]
    assert p.cost <= 2.0 * min(singles)


def test_joints_that_stay_and_improvement_work_as_without() -> None:
    q = free_configurations(2, 5)
    p = planner().plan(q[0], q[1], improve=500)
    assert p.is_certified and p.cost <= planner().plan(q[0], q[1]).cost + 1e-6
    goal = q[0].copy()
    goal[0] = -goal[0]
    p = planner().plan(q[0], goal, joints=robot().joint_names[:3], timeout=5.0)
    assert not p or (p.points[:, 3:] == q[0][3:]).all()


def test_roadmaps_that_cannot_be_made() -> None:
    for wrong in (-1, 2.5, "many"):
        with pytest.raises(InputError, match="roadmap"):
            Planner(robot(), roadmap=wrong)  # type: ignore[arg-type]
    b = ModelBuilder("one").add_link("base").add_link("arm", collisions=[Geometry("", Box((0.4, 0.1, 0.1)))])
    b.add_joint("turn", Continuous((0, 0, 1)), "base", "arm")
    with pytest.raises(InputError, match="'turn' has no limits"):
        Planner(ulna.Robot(b.build()), roadmap=100)
    everywhere = World().add("block", Box((4.0, 4.0, 4.0)), touches=["panda_link0"])
    p = Planner(robot(), everywhere, roadmap=50).plan(
        free_configurations(1, 0)[0], robot().configurations["ready"]
    )
    assert p.outcome == "start"
    one = Planner(robot(), planner().scene.world, roadmap=1)
    q = free_configurations(2, 7)
    assert one.plan(q[0], q[1])


def test_its_motions_are_looked_at_in_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = Planner(robot(), planner().scene.world, roadmap=60)._search.roadmap  # type: ignore[attr-defined]
    monkeypatch.setattr(roadmap, "_AT_ONCE", 7)
    parts = Planner(robot(), planner().scene.world, roadmap=60)._search.roadmap  # type: ignore[attr-defined]
    np.testing.assert_array_equal(parts.nodes, whole.nodes)
    np.testing.assert_array_equal(parts.edges, whole.edges)
