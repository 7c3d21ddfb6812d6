"""Tests on clusters, none of which may wait for ever."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from support.clusters import cluster
from support.hang_guard import ends_within


@pytest.fixture(autouse=True)
def _ends() -> Iterator[None]:
    with ends_within(1200):
        yield


@pytest.fixture(scope="session")
def client() -> Iterator[Any]:
    """One cluster of two processes for all tests of jobs."""
    pytest.importorskip("distributed")
    with cluster() as client:
        client.run(find_tests)
        yield client


def find_tests() -> None:
    """Lets a worker import the jobs of the tests."""
    sys.path.insert(0, str(Path(__file__).parents[2]))
