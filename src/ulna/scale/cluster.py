"""A cluster of Dask to work on: the one at an address, or one of this machine that starts by itself."""

from __future__ import annotations

import logging
import os
import socket
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from multiprocessing import current_process
from typing import Any

from ulna.errors import InputError, MissingExtra, VersionMismatch
from ulna.lazy import check_versions, versions
from ulna.scale import ctrl_c
from ulna.scale.tasks import Interrupted

_ANSWER = 15.0  # s to wait for a scheduler to answer
_ENVIRONMENT = {"MALLOC_TRIM_THRESHOLD_": 2**28, "MALLOC_MMAP_THRESHOLD_": 2**28}
"""Of the workers of a cluster of this machine: Dask's own setting has every array above 128 KiB begin on new pages."""

_QUIET = {
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "500ms",
    "distributed.admin.system-monitor.interval": "5s",
    "distributed.worker.memory.monitor-interval": "500ms",
}
"""What such a cluster leaves out or does less often: Dask looks at the stack of each task every 10 ms, and at the event
loop every 20 ms, for its dashboard, and at the memory of each worker every 100 ms; that takes processor time from the
work."""

_MESSAGES = 0.001
"""s that the client of such a cluster waits between two messages. Dask's 10 ms are for clients that send thousands of
tasks; here a worker would wait as long for its next one."""

_UNGUARDED = (
    "The workers of a cluster of this machine did not start. In a script, put the call below "
    "`if __name__ == '__main__':`, because each worker imports the script again; `workers=0` needs none."
)

_LOGS = ("distributed.client", "distributed.batched")
_SPAWN, _PRELOAD = "distributed.nanny.pre-spawn-environ", "distributed.worker.preload"


@contextmanager
def connected(scheduler: Any, workers: int | None, patience: float) -> Iterator[Any]:
    """A client of a scheduler whose workers have the same version of Ulna.

    Args:
        scheduler: Its address ("tcp://host:8786"), a `distributed.Client`, or None for a cluster of this machine that
            ends with the job.
        workers: How many processes that cluster has; None for as many as there are processors.
        patience: How long to wait for a first worker [s].

    Yields:
        The client.

    Raises:
        InputError: If no scheduler answers at the address, or the workers of this machine do not start.
        Interrupted: If it has no workers.
        VersionMismatch: If a worker has another version, or no Ulna.
        MissingExtra: If Dask's scheduler is not installed.
    """
    try:
        from distributed import Client  # pyright: ignore[reportMissingImports]
    except ImportError:
        raise MissingExtra("distributed", "cluster", "Working on a cluster") from None
    if scheduler is None:
        with _local_client(os.cpu_count() or 1 if workers is None else workers) as client:
            yield client
        return
    with ExitStack() as stack:
        is_client = isinstance(scheduler, Client)
        if not is_client:
            stack.enter_context(_without_messages())
        client = scheduler if is_client else stack.enter_context(_answering(scheduler, patience))
        _check_workers(client, patience)
        yield client


@contextmanager
def _without_messages() -> Iterator[None]:
    """Dask's client logs no errors within the block: tracebacks where a scheduler is lost, which the job says."""
    levels = [(logger, logger.level) for logger in map(logging.getLogger, _LOGS)]
    for logger, _ in levels:
        logger.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        for logger, level in levels:
            logger.setLevel(level)


def _answering(address: Any, patience: float) -> Any:
    """A client of the scheduler at an address."""
    from distributed import Client  # pyright: ignore[reportMissingImports]

    if not isinstance(address, str):
        raise InputError(
            f"`scheduler` is a {type(address).__name__}; expected an address such as 'tcp://host:8786', a "
            "distributed.Client, or None for a cluster of this machine."
        )
    try:
        _check_address(address)
        return Client(address, timeout=min(_ANSWER, max(patience, 0.1)), set_as_default=False)
    except (OSError, ValueError) as error:
        raise InputError(
            f"No scheduler answers at {address!r} ({error}). `dask scheduler` starts one and prints its "
            "address; without `scheduler` a cluster of this machine starts by itself."
        ) from error


@contextmanager
def _local_client(count: int) -> Iterator[Any]:
    """A client of a cluster of this machine with so many processes, which ends with the block."""
    from dask import config  # pyright: ignore[reportMissingImports]
    from distributed import Client  # pyright: ignore[reportMissingImports]

    preload = [*config.get(_PRELOAD, []), "ulna.scale.preload"]
    with (
        config.set({**_QUIET, _SPAWN: worker_environment(), _PRELOAD: preload}),
        _local_cluster(count) as cluster,
        Client(cluster, set_as_default=False, direct_to_workers=True) as client,
    ):
        pool: Any = cluster
        pool.adapt(minimum=count, maximum=count, interval="2s")  # starts others in place of lost ones
        messages = getattr(client, "scheduler_comm", None)
        if messages is not None:
            messages.interval = _MESSAGES
        yield client


@contextmanager
def _local_cluster(count: int) -> Iterator[Any]:
    """A cluster of this machine with so many processes."""
    from distributed import LocalCluster  # pyright: ignore[reportMissingImports]

    settings = {"threads_per_worker": 1, "dashboard_address": ":0", "silence_logs": 50}
    if getattr(current_process(), "_inheriting", False):  # a worker that imports the script
        raise InputError(_UNGUARDED)
    with ExitStack() as stack:
        with ctrl_c.later():
            try:
                cluster = LocalCluster(n_workers=count, processes=True, **settings)
            except RuntimeError as error:
                raise InputError(_UNGUARDED) from error
            stack.enter_context(cluster)
        yield cluster


def _check_address(address: str) -> None:
    """Raises ValueError or OSError for what is no address; a Client of such ends half a minute late."""
    from distributed.comm.addressing import (  # pyright: ignore[reportMissingImports]
        get_address_host_port,
    )

    whole = address if "://" in address else f"tcp://{address}"
    if whole.startswith(("tcp://", "tls://")):
        host, _ = get_address_host_port(whole, strict=True)
        socket.getaddrinfo(host, None)
    elif not whole.startswith("inproc://"):
        get_address_host_port(whole)


def worker_environment() -> dict[str, Any]:
    """The variables of the workers of a cluster of this machine: Dask's, such as one thread of BLAS each, and ours."""
    from dask import config  # pyright: ignore[reportMissingImports]

    return {**config.get(_SPAWN, {}), **_ENVIRONMENT}


def _check_workers(client: Any, patience: float) -> None:
    answers = _versions_of_workers(client)
    if not answers:
        try:
            client.wait_for_workers(1, timeout=patience)
        except TimeoutError:
            address = client.scheduler.address
            raise Interrupted(
                f"The scheduler has no workers, after {patience:g} s: `dask worker {address}` starts one."
            ) from None
        answers = _versions_of_workers(client)
    for answer in answers.values():
        if isinstance(answer, VersionMismatch):
            raise answer
        if isinstance(answer, ImportError):
            raise VersionMismatch(
                f"A worker cannot import what this job needs: {answer}. Install Ulna {versions()['Ulna']} there."
            ) from answer


def _versions_of_workers(client: Any) -> dict[str, Any]:
    """For each worker None, or what is wrong with its version."""
    return client.run(check_versions, versions(), on_error="return")  # a worker may be lost meanwhile
