"""Connects to a Dask scheduler at an address, or starts a LocalCluster."""

from __future__ import annotations

import asyncio
import logging
import socket
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from multiprocessing import current_process
from typing import Any

from ulna.checks.values import short_repr
from ulna.errors import InputError, VersionMismatch, needed
from ulna.lazy import check_versions, versions
from ulna.scale import ctrl_c
from ulna.scale.tasks import Interrupted
from ulna.system.processors import processor_count
from ulna.system.shared_context import SharedContext

_MAX_ANSWER_TIME = 15.0  # s to wait for a scheduler to answer
_ENVIRONMENT = {"MALLOC_TRIM_THRESHOLD_": 2**28, "MALLOC_MMAP_THRESHOLD_": 2**28}
"""Of the workers of a LocalCluster: Dask's own setting makes malloc allocate every array above 128 KiB by mmap."""

_REDUCED_MONITORING = {
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "2s",
    "distributed.admin.tick.cycle": "5s",
    "distributed.admin.system-monitor.interval": "5s",
    "distributed.worker.memory.monitor-interval": "500ms",
    "distributed.scheduler.active-memory-manager.start": False,
}
"""What a LocalCluster leaves out or does less often: Dask looks at the stack of each task every 10 ms, and at the event
loop every 20 ms, for its dashboard, at the memory of each worker every 100 ms, and every 2 s for results that several
workers have, which jobs do not make; that takes processor time from the work."""

_SEND_INTERVAL = 0.001
"""s that the client of a LocalCluster waits between two messages. Dask's 10 ms are for clients that send thousands of
tasks; here a worker would wait as long for its next one."""

_MISSING_MAIN_GUARD = (
    "The workers of a cluster of this machine did not start. In a script, put the call below "
    "`if __name__ == '__main__':`, because each worker imports the script again; `workers=0` needs none."
)

_LOGS = ("distributed.client", "distributed.batched", "distributed.protocol.core")
_SPAWN, _PRELOAD = "distributed.nanny.pre-spawn-environ", "distributed.worker.preload"


@contextmanager
def connected(scheduler: Any, workers: int | None, patience: float) -> Iterator[Any]:
    """A client of a scheduler whose workers have the same version of Ulna.

    Args:
        scheduler: Its address ("tcp://host:8786"), a `distributed.Client`, or None for a cluster of this machine that
            ends with the job.
        workers: How many processes that cluster has; None for as many as there are processors.
        patience: Timeout for the first worker, and, up to 15 s, for the scheduler to answer [s].

    Yields:
        The client.

    Raises:
        InputError: If no scheduler answers at the address, or the workers of this machine do not start.
        Interrupted: If it has no workers.
        VersionMismatch: If a worker has another version, or no Ulna.
        MissingExtra: If Dask's scheduler is not installed.
    """
    with needed("distributed", "cluster", "Working on a cluster"):
        from distributed import Client  # pyright: ignore[reportMissingImports]
    if scheduler is None:
        with _local_client(processor_count() if workers is None else workers) as client:
            yield client
        return
    with ExitStack() as stack:
        is_client = isinstance(scheduler, Client)
        if not is_client:
            stack.enter_context(_WITHOUT_MESSAGES())
        client = scheduler if is_client else stack.enter_context(_client_at(scheduler, patience))
        _check_workers(client, patience)
        yield client


@contextmanager
def _without_messages() -> Iterator[None]:
    """Dask logs no errors of connections within the block: tracebacks of a lost scheduler, which the job reports."""
    levels = [(logger, logger.level) for logger in map(logging.getLogger, _LOGS)]
    for logger, _ in levels:
        logger.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        for logger, level in levels:
            logger.setLevel(level)


_WITHOUT_MESSAGES = SharedContext(_without_messages)


def _client_at(address: Any, patience: float) -> Any:
    """A client of the scheduler at an address."""
    from distributed import Client  # pyright: ignore[reportMissingImports]

    if not isinstance(address, str):
        raise InputError(
            f"`scheduler` is {short_repr(address)}; expected an address such as 'tcp://host:8786', a "
            "distributed.Client, or None for a cluster of this machine."
        )
    seconds = min(_MAX_ANSWER_TIME, max(patience, 0.1))
    try:
        _check_address(address)
        if not address.startswith("inproc://"):
            _check_handshake(address, seconds)
        return Client(address, timeout=seconds, set_as_default=False)
    except Exception as error:  # servers of other kinds send what Dask reads as lengths, types, or structures
        is_known = isinstance(error, OSError | ValueError) and str(error)
        reason = error if is_known else f"another kind of server does: {error or type(error).__name__}"
        if address.startswith("tls://"):
            reason = f"{reason}; pass a distributed.Client(address, security=...)"
        raise InputError(
            f"No scheduler answers at {address!r} ({reason}). `dask scheduler` starts one and prints its "
            "address; without `scheduler` a cluster of this machine starts by itself."
        ) from error


def _check_handshake(address: str, seconds: float) -> None:
    """Performs Dask's connection handshake with a timeout; a Client waits forever for a server that never replies.

    Args:
        address: The address.
        seconds: The longest time to wait [s].

    Raises:
        OSError: Nobody answers; and whatever Dask raises for other answers.
    """
    from distributed.comm.core import connect  # pyright: ignore[reportMissingImports]
    from distributed.security import Security  # pyright: ignore[reportMissingImports]

    async def shake_hands() -> None:
        connection = await connect(address, timeout=seconds, **Security().get_connection_args("client"))
        connection.abort()

    def run() -> None:
        try:
            asyncio.run(asyncio.wait_for(shake_hands(), 2.0 * seconds))
        except TimeoutError as error:
            text = str(error) or f"Timed out after {2.0 * seconds:g} s: a server is there, but says nothing"
            errors.append(TimeoutError(text))
        except BaseException as error:  # raised again by the thread that waits
            errors.append(error)

    errors: list[BaseException] = []
    thread = threading.Thread(target=run, daemon=True)  # this one may run an event loop already
    thread.start()
    thread.join()
    if errors:
        raise errors[0]


def _local_settings() -> Any:
    """A context with Dask's settings for a LocalCluster."""
    from dask import config  # pyright: ignore[reportMissingImports]

    preload = [*config.get(_PRELOAD, []), "ulna.scale.preload"]
    return config.set({**_REDUCED_MONITORING, _SPAWN: worker_environment(), _PRELOAD: preload})


_LOCAL_SETTINGS = SharedContext(_local_settings)


@contextmanager
def _local_client(count: int) -> Iterator[Any]:
    """A client of a cluster of this machine with so many processes, which ends with the block."""
    from distributed import Client  # pyright: ignore[reportMissingImports]

    with (
        _LOCAL_SETTINGS(),
        _local_cluster(count) as cluster,
        Client(cluster, set_as_default=False, direct_to_workers=True) as client,
    ):
        pool: Any = cluster
        pool.adapt(minimum=count, maximum=count, interval="2s")  # starts others in place of lost ones
        messages = getattr(client, "scheduler_comm", None)
        if messages is not None:
            messages.interval = _SEND_INTERVAL
        yield client


@contextmanager
def _local_cluster(count: int) -> Iterator[Any]:
    """A cluster of this machine with so many processes."""
    from distributed import LocalCluster  # pyright: ignore[reportMissingImports]

    settings = {"threads_per_worker": 1, "dashboard_address": ":0", "silence_logs": 50}
    if getattr(current_process(), "_inheriting", False):  # a worker that imports the script
        raise InputError(_MISSING_MAIN_GUARD)
    with ExitStack() as stack:
        with ctrl_c.later():
            try:
                cluster = LocalCluster(n_workers=count, processes=True, **settings)
            except RuntimeError as error:
                raise InputError(_MISSING_MAIN_GUARD) from error
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
