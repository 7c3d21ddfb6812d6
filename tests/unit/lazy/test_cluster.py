"""Dask arrays on a real scheduler with worker processes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import ulna
from support.clusters import cluster
from ulna.collision import World
from ulna.errors import NonFiniteError, VersionMismatch
from ulna.geometry import Box

da = pytest.importorskip("dask.array")
pytest.importorskip("distributed")


@pytest.fixture(scope="module")
def client() -> Iterator[Any]:
    with cluster() as client:
        yield client


def _compiled() -> int:
    """How many functions this process has rebuilt."""
    from ulna.lazy import portable

    return len(portable._known)


def _pretend(version: str) -> None:
    """Makes this process one with another version of Ulna."""
    from ulna import version as module
    from ulna.lazy import portable

    module.__version__ = version
    portable._known.clear()


def test_kernels_searches_and_plans_on_workers(client: Any) -> None:
    robot = ulna.load("panda")
    world = World().add("post", Box((0.1, 0.1, 1.0)), (0.5, 0.0, 0.3))
    Q = robot.random_configuration(60, seed=0)
    lazy = da.from_array(Q, chunks=(3, 7))
    kernel = robot.kernel("fk")
    np.testing.assert_array_equal(kernel(lazy).compute(), robot.fk(Q))
    np.testing.assert_array_equal(kernel.dask(lazy).compute(), robot.fk(Q))
    np.testing.assert_array_equal(robot.mass_matrix(lazy).compute(), robot.mass_matrix(Q))
    own = ulna.compile(lambda q: q[0] * np.cos(q[1]), robot)
    np.testing.assert_array_equal(own(lazy).compute(), own(Q))
    counts = client.run(_compiled)
    assert all(count <= 4 for count in counts.values()), "each process compiles a function once"
    assert robot.ik(robot.fk(lazy)).compute().success.all()
    np.testing.assert_array_equal(robot.collides(lazy, world).compute(), robot.collides(Q, world))
    free = Q[~robot.collides(Q, world, method="spheres")][:3]
    plans = robot.plan(da.from_array(free[:2], chunks=(1, 7)), free[2], world).compute()
    np.testing.assert_array_equal(plans[0].points, robot.plan(free[0], free[2], world).points)
    with pytest.raises(NonFiniteError, match="`q"):
        robot.fk(da.full((3, 7), np.nan, chunks=(1, 7))).compute()


def test_another_version_on_a_worker_is_named(client: Any) -> None:
    robot = ulna.load("ur5")
    lazy = da.zeros((4, 6), chunks=(1, 6))
    client.run(_pretend, "0.0.1")
    try:
        with pytest.raises(VersionMismatch, match=r"made with Ulna 0.1.0, but this worker .* has Ulna 0.0.1"):
            robot.fk(lazy).compute()
    finally:
        client.run(_pretend, ulna.__version__)
    np.testing.assert_array_equal(robot.fk(lazy).compute(), robot.fk(np.zeros((4, 6))))
