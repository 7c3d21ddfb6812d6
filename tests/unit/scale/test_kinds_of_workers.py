"""Clusters whose machines differ: each worker compiles for its own processor, once, and finds it after a restart."""

from __future__ import annotations

import os
import platform
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ulna
from support import older_processor
from ulna import scale

da = pytest.importorskip("dask.array")
pytest.importorskip("distributed")

_ROWS = 64


@pytest.fixture
def folders(tmp_path: Path) -> tuple[Path, Path]:
    """The caches of the two workers."""
    return tmp_path / "new", tmp_path / "old"


@pytest.fixture
def client(folders: tuple[Path, Path]) -> Iterator[Any]:
    """Two workers of one thread with caches of their own; the second has an older processor."""
    from distributed import Client, Nanny, Scheduler, SpecCluster

    def worker(folder: Path, *preload: str) -> dict[str, Any]:
        found = os.pathsep.join([str(Path(older_processor.__file__).parents[1]), *sys.path])
        environment = {"ULNA_CACHE": str(folder), "PYTHONPATH": found}
        options = {"nthreads": 1, "env": environment, "preload": list(preload), "silence_logs": 50}
        return {"cls": Nanny, "options": options}

    specs = dict(enumerate([worker(folders[0]), worker(folders[1], "support.older_processor")]))
    scheduler = {"cls": Scheduler, "options": {"dashboard_address": ":0", "port": 0}}
    with SpecCluster(specs, scheduler, silence_logs=50) as local, Client(local) as client:
        client.wait_for_workers(2)
        yield client


def _register_bytes() -> int:
    from ulna.compiler.runtime.jit import target

    return target().register_bytes


def _cannot_compile() -> None:
    """From now on this process has only what its cache has."""
    from ulna.compiler.runtime import jit

    def refuse(*_: Any) -> bytes:
        raise AssertionError("compiled again")

    jit._object = refuse


def _on_each(client: Any, Q: Any) -> list[Any]:
    """Poses as each worker computes them, the older processor first."""
    robot, widths = ulna.load("panda"), client.run(_register_bytes)
    lazy = [robot.fk(da.from_array(Q, chunks=(len(Q), 7), name=False)) for _ in widths]
    names = sorted(widths, key=lambda name: widths[name])
    return [client.compute(x, workers=[name]).result() for x, name in zip(lazy, names, strict=True)]


@pytest.mark.skipif(platform.machine() not in ("x86_64", "AMD64"), reason="the older processor is an x86-64")
def test_workers_with_other_processors_and_caches(client: Any, folders: tuple[Path, Path]) -> None:
    robot = ulna.load("panda")
    Q = robot.random_configuration(_ROWS, seed=0)
    widths = client.run(_register_bytes)
    assert min(widths.values()) == 16, "one of them has the registers of SSE2"
    old, new = _on_each(client, Q)
    np.testing.assert_array_equal(new, robot.fk(Q))
    np.testing.assert_allclose(old, new, atol=1e-14)
    found = scale.reach(robot, 40_000, voxel=0.2, chunk=2_000, scheduler=client, progress=False)
    alone = scale.reach(robot, 40_000, voxel=0.2, chunk=2_000, workers=0, progress=False)
    assert found.count.sum() == 40_000 and abs(found.count - alone.count).sum() <= 4, "of samples at an edge"
    names = [{path.name for path in folder.iterdir() if len(path.name) == 64} for folder in folders]
    assert all(names) and not names[0] & names[1], "no code of one for the other"

    client.restart(timeout=600)
    client.run(_cannot_compile)
    for again, before in zip(_on_each(client, Q), (old, new), strict=True):
        np.testing.assert_array_equal(again, before)
    with pytest.raises(AssertionError, match="compiled again"):
        client.compute(robot.manipulability(da.zeros((2, 7)))).result()
