"""A real Dask cluster of several processes, for tests."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any


@contextmanager
def cluster(workers: int = 2, **options: Any) -> Iterator[Any]:
    """A client of a scheduler with worker processes of one thread each, which ends with them.

    Args:
        workers: How many worker processes.
        **options: Of `distributed.LocalCluster`.

    Yields:
        The client.
    """
    from distributed import Client, LocalCluster

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        settings = {"threads_per_worker": 1, "dashboard_address": ":0", "silence_logs": 50} | options
        with LocalCluster(n_workers=workers, **settings) as local, Client(local) as client:
            local.adapt(
                minimum=workers, maximum=workers, interval="1s"
            )  # starts others in place of lost ones
            yield client
