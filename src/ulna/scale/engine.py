"""Runs jobs: parts on a cluster or in this process, put together in order, kept so that they can be continued."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any, final

from ulna.checks.values import count, number, one_of
from ulna.errors import InputError, JobStopped
from ulna.lazy import Portable
from ulna.scale.cluster import connected
from ulna.scale.job import Job, Samples, State
from ulna.scale.progress import Progress, Reporter, reporter
from ulna.scale.store import Kept, Store, check_result, job_folder, place
from ulna.scale.tasks import Interrupted, Tasks, is_storage_error

_CHECKPOINT = 15.0  # s between two writings of the state


def run(
    job: Job,
    to: str | os.PathLike[str] | None = None,
    *,
    scheduler: Any = None,
    workers: int | None = None,
    progress: bool | Reporter = True,
    retries: int = 30,
    patience: float = 60.0,
) -> Any:
    """Does a job, or what is left of it.

    Args:
        job: The job.
        to: Where its result is written, and beside it, in `TO.job`, its progress; None to keep all in memory. What is
            there already is returned if it is the result of this very job; `TO.job.json` says of which it is, unless
            the result itself does (`Job.describes_result`).
        scheduler: Address of a scheduler of Dask, or a `distributed.Client`; None for a cluster of this machine, which
            starts and ends with the job.
        workers: How many processes that cluster has; 0 for none: all is done in this process, without Dask. None for as
            many as there are processors.
        progress: Whether to say on standard error how far it is; or a function of a `Progress`.
        retries: How often a part is done again whose worker was lost.
        patience: How long to wait for workers, and for a scheduler that does not answer [s].

    Returns:
        What the job returns.

    Raises:
        JobStopped: If the job ended before all was done: the scheduler was lost, nothing can be written, or a part
            failed again and again. It says what is missing; the same call continues.
        InputError: If `to` holds another job or its result, an argument makes no sense, or `job.finish` wrote nothing
            to `to`.
        VersionMismatch: If a worker has another version of Ulna.
        MissingExtra: If Dask is not installed.

    Example:
        >>> class Mean(ulna.scale.Job):  # of a million random numbers, in 10 parts
        ...     kind, parts = "mean", 10
        ...     def description(self):
        ...         return {"kind": self.kind, "parts": self.parts}
        ...     def start(self):
        ...         return {"sum": np.zeros(())}
        ...     def work(self, part):
        ...         return {"sum": np.random.default_rng(part).random(100_000).sum()}
        ...     def fold(self, state, part, result):
        ...         state["sum"] += result["sum"]
        ...     def existing(self, to):
        ...         return np.load(to)
        ...     def finish(self, state, to):
        ...         if to is not None:
        ...             with to.open("wb") as file:  # np.save would add ".npy" to another name
        ...                 np.save(file, state["sum"] / 1_000_000)
        ...         return float(state["sum"]) / 1_000_000
        >>> round(ulna.scale.run(Mean(), workers=0, progress=False), 2)
        0.5
    """
    if workers is not None:
        count("workers", workers, least=0)
    count("retries", retries, least=0)
    number("patience", patience, "seconds, not below 0", least=0.0)
    if scheduler is not None and workers is not None:
        raise InputError("`workers` is given beside `scheduler`; the scheduler has its own. Leave one out.")
    where = place(to)
    try:
        with ExitStack() as stack:
            if where is not None and where.exists() and not job_folder(where).exists():
                if not job.describes_result:
                    check_result(where, _described(job))
                return job.existing(where)
            store = None if where is None else Store(where, _described(job))
            if store is not None:
                stack.callback(store.close)
            return _Run(job, where, store, reporter(progress, job.kind)).do(
                lambda parts: _results(job, parts, scheduler, workers, retries, patience)
            )
    except OSError as error:
        if not is_storage_error(error):
            raise
        raise JobStopped(
            f"Nothing can be written: {error}.", 0, job.parts, "" if where is None else str(job_folder(where))
        ) from error


def run_with(options: Mapping[str, Any], job: Job, to: str | os.PathLike[str] | None) -> Any:
    """`run` with options that a user passed to one of the jobs.

    Args:
        options: Options of `run` by name.
        job: The job.
        to: Where its result is written; None for nowhere.

    Returns:
        What the job returns.

    Raises:
        UnknownName: If there is no such option.
    """
    for name in options:
        one_of("option of a job", name, run.__kwdefaults__ or ())
    return run(job, to, **options)


def _described(job: Job) -> dict[str, Any]:
    """What a job depends on, its samples included: a job that goes on with another seed would mix both."""
    samples = getattr(job, "samples", None)
    return {**(vars(samples) if isinstance(samples, Samples) else {}), **job.description()}


def _results(
    job: Job, parts: Sequence[int], scheduler: Any, workers: int | None, retries: int, patience: float
) -> Iterator[tuple[int, State]]:
    """The results of parts, as they come."""
    if workers == 0:
        yield from ((part, job.work(part, *job.inputs(part))) for part in parts)
        return
    with connected(scheduler, workers, patience) as client:
        work = Portable(job.for_workers().work)
        yield from Tasks(client, work, parts, job.inputs, retries, patience).results()


@final
class _Run:
    """One run of a job: what it has found, and when it was last written."""

    def __init__(self, job: Job, to: Path | None, store: Store | None, report: Reporter) -> None:
        self._job, self._to, self._store, self._report = job, to, store, report
        known = store.load() if store is not None else None
        if known is None:
            try:
                job.prepare(to)
            except Exception:
                if store is not None:
                    store.finished()  # nothing has begun: other arguments may be given
                raise
        self._state, self._done, self._early = kept = known or Kept(job.start(), 0, {})
        self._first, self._began = kept.count, time.monotonic()
        self._written = time.monotonic()
        self._is_whole = True  # not while a part is being added, where Ctrl-C may come

    def do(self, results: Any) -> Any:
        """All parts that are missing, and the result.

        Args:
            results: A function of the numbers of parts that yields their results.

        Returns:
            What the job returns.
        """
        missing: Sequence[int] = range(self._done, self._job.parts)
        if self._early:
            missing = [part for part in missing if part not in self._early]
        self._report_progress()
        try:
            if missing:
                self._take(results(missing))
        except Interrupted as error:
            self._save_if_complete()
            raise self._stopped(str(error)) from error
        except KeyboardInterrupt:
            self._save_if_complete()
            print(f"\n{self._stopped('Stopped by Ctrl-C.')}", file=sys.stderr)
            raise
        except OSError as error:
            if is_storage_error(error):
                raise self._stopped(f"Nothing can be written: {error}.") from error
            raise
        except Exception:
            self._save_if_complete()
            raise
        self._save()
        result = self._job.finish(self._state, self._to)
        if self._to is not None and not self._to.exists():
            raise InputError(
                f"{type(self._job).__name__}.finish wrote nothing to {str(self._to)!r}; expected the result there. The "
                "parts are kept: write it where `to` is not None, then run the job again."
            )
        if self._store is not None:
            if not self._job.describes_result:
                self._store.describe_result()
            self._store.finished()
        return result

    def _take(self, results: Iterable[tuple[int, State]]) -> None:
        for number_, result in results:
            self._early[number_] = result
            while self._done in self._early:
                self._is_whole = False
                self._job.fold(self._state, self._done, self._early.pop(self._done))
                self._done += 1
                self._is_whole = True
            self._report_progress()
            if time.monotonic() - self._written > _CHECKPOINT:
                self._save()

    @property
    def _kept(self) -> Kept:
        return Kept(self._state, self._done, self._early)

    def _save(self) -> None:
        if self._store is not None:
            self._store.save(self._kept)
            self._written = time.monotonic()

    def _save_if_complete(self) -> None:
        """Writes the state at the end of a job that stops, unless that is impossible or half a part is in it."""
        if self._is_whole:
            with suppress(OSError):
                self._save()

    def _report_progress(self) -> None:
        seconds, done = time.monotonic() - self._began, self._kept.count
        self._report(Progress(done, self._job.parts, seconds, done - self._first))

    def _stopped(self, reason: str) -> JobStopped:
        """The error for the user: with as many parts as the store has."""
        done = self._kept.count
        if self._store is not None:
            known = self._store.load()
            done = known.count if known else 0
        return JobStopped(
            reason, done, self._job.parts, "" if self._to is None else str(job_folder(self._to))
        )
