"""Calls in threads: all are made once and none goes on, whatever fails; helpers sleep, end, and are not missed in children."""

from __future__ import annotations

import contextvars
import itertools
import os
import signal
import subprocess
import sys
import threading
import weakref
from collections.abc import Callable
from pathlib import Path

import pytest

from support.patience import LONGEST_WAIT, patient
from ulna.system import helper_threads
from ulna.system.helper_threads import cuts, in_threads, results_in_threads

wait = patient()
needs_fork = pytest.mark.skipif(not hasattr(os, "fork"), reason="has no fork")


@pytest.fixture(autouse=True)
def _own_helpers(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(helper_threads, "_helpers", helper_threads._Helpers())


def _together(threads: int) -> Callable[[int], Callable[[], object]]:
    """Calls that wait until so many have begun, each in a thread of its own then."""
    barrier = threading.Barrier(threads)
    return lambda _: lambda: barrier.wait(LONGEST_WAIT)


def _helper() -> threading.Thread:
    found: list[threading.Thread] = []
    begun = threading.Barrier(2)

    def call() -> None:
        begun.wait(LONGEST_WAIT)
        if threading.current_thread().name == "ulna helper":
            found.append(threading.current_thread())

    assert in_threads(lambda _: call, 2, 2)
    return found[0]


@pytest.mark.parametrize(
    ("count", "threads", "least"),
    [(0, 2, 1), (1, 2, 1), (7, 2, 4), (1000, 2, 16), (999, 5, 10), (50, 100, 7)],
)
def test_parts_cover_all_and_none_is_too_small(count: int, threads: int, least: int) -> None:
    ends = cuts(count, threads, least)
    sizes = [b - a for a, b in itertools.pairwise(ends)]
    assert ends[0] == 0 and ends[-1] == count
    assert all(size >= least for size in sizes) or count < least
    assert sizes[:-1] == sorted(sizes[:-1], reverse=True) and sizes[0] <= max(2 * least, count // threads)


@pytest.mark.parametrize(("count", "threads"), [(0, 3), (1, 3), (5, 1), (40, 3), (3, 40)])
def test_every_call_is_made_once(count: int, threads: int) -> None:
    made: list[int] = []
    assert in_threads(lambda k: lambda: made.append(k), count, threads)
    assert sorted(made) == list(range(count))


@pytest.mark.parametrize(("count", "threads"), [(0, 3), (1, 3), (5, 1), (40, 3)])
def test_results_are_in_order(count: int, threads: int) -> None:
    assert results_in_threads(lambda k: 10 * k, count, threads) == [10 * k for k in range(count)]


def test_calls_run_in_as_many_threads_also_beyond_the_cores() -> None:
    assert in_threads(_together(16), 16, 16)


def test_a_helper_is_used_again_and_keeps_nothing() -> None:
    class Held:
        pass

    held = Held()
    gone = weakref.ref(held)
    first, call = _helper(), lambda _, held=held: lambda: held
    wait(lambda: helper_threads._helpers._idle)
    in_threads(call, 8, 2)
    wait(lambda: helper_threads._helpers._idle)
    assert _helper() is first
    del held, call
    assert wait(lambda: gone() is None)


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="has no /proc")
def test_an_idle_helper_sleeps() -> None:
    number = _helper().native_id

    def state() -> str:
        return Path(f"/proc/self/task/{number}/stat").read_text().rpartition(")")[2].split()[0]

    assert wait(lambda: state() == "S")


def test_helpers_without_work_end(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(helper_threads, "IDLE", 0.01)
    first = _helper()
    assert wait(lambda: not first.is_alive()) and not helper_threads._helpers._idle
    assert _helper() is not first


def test_calls_are_made_where_no_thread_can_be_started(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(thread: threading.Thread) -> None:
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr(threading.Thread, "start", refused)
    made: list[int] = []
    assert in_threads(lambda k: lambda: made.append(k), 5, 3)
    assert made == [0, 1, 2, 3, 4]


def test_helpers_see_the_context_of_the_caller() -> None:
    variable, barrier, seen = contextvars.ContextVar("variable", default=0), threading.Barrier(3), []
    variable.set(7)

    def call() -> None:
        barrier.wait(LONGEST_WAIT)
        seen.append(variable.get())

    in_threads(lambda _: call, 3, 3)
    assert seen == [7, 7, 7]


def test_an_error_in_a_helper_is_raised_and_no_further_call_begins() -> None:
    caller, begun, failed = threading.get_ident(), [], threading.Event()

    def call(k: int) -> None:
        begun.append(k)
        if threading.get_ident() == caller:
            failed.wait(LONGEST_WAIT)
            assert wait(lambda: helper_threads._helpers._idle)  # the helper has reported it
        else:
            failed.set()
            raise ZeroDivisionError(k)

    with pytest.raises(ZeroDivisionError):
        in_threads(lambda k: lambda: call(k), 10, 2)
    assert sorted(begun) == [0, 1]


def test_an_error_of_the_caller_comes_after_the_calls_under_way() -> None:
    ended, begun, last = [], threading.Event(), threading.Event()

    def call(k: int) -> None:
        if k == 0:
            begun.wait(LONGEST_WAIT)
            threading.Timer(0.05, last.set).start()
            raise KeyboardInterrupt
        begun.set()
        last.wait(LONGEST_WAIT)
        ended.append(k)

    with pytest.raises(KeyboardInterrupt):
        in_threads(lambda k: lambda: call(k), 10, 2)
    assert ended == [1]


@pytest.mark.skipif(os.name == "nt", reason="sends signals as POSIX has them")
def test_ctrl_c_does_not_end_the_wait_for_a_helper() -> None:
    ended, begun, last = [], threading.Event(), threading.Event()

    def interrupt_twice() -> None:
        for _ in range(2):
            signal.pthread_kill(threading.main_thread().ident, signal.SIGINT)  # type: ignore[arg-type]
            threading.Event().wait(0.05)
        last.set()

    def call(k: int) -> None:
        if k == 0:
            begun.wait(LONGEST_WAIT)
            threading.Thread(target=interrupt_twice).start()
            return
        begun.set()
        last.wait(LONGEST_WAIT)
        ended.append(k)

    with pytest.raises(KeyboardInterrupt):
        in_threads(lambda k: lambda: call(k), 2, 2)
    assert ended == [1]


def test_calls_within_calls_and_of_several_threads_at_once() -> None:
    made: list[tuple[int, int, int]] = []

    def outer(caller: int, k: int) -> None:
        in_threads(lambda j: lambda: made.append((caller, k, j)), 6, 3)

    callers = [
        threading.Thread(target=in_threads, args=(lambda k, n=n: lambda: outer(n, k), 5, 3)) for n in range(4)
    ]
    for caller in callers:
        caller.start()
    for caller in callers:
        caller.join()
    assert sorted(made) == [(n, k, j) for n in range(4) for k in range(5) for j in range(6)]


def _answer_of_child(work: Callable[[], bool]) -> int:
    """The exit code of a forked child: 0 where `work` is true."""
    child = os.fork()
    if child == 0:
        signal.alarm(int(LONGEST_WAIT))
        os._exit(0 if work() else 1)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


@needs_fork
def test_a_forked_child_has_helpers_of_its_own() -> None:
    _helper()
    assert wait(lambda: helper_threads._helpers._idle)
    assert _answer_of_child(lambda: in_threads(_together(3), 3, 3)) == 0
    assert in_threads(_together(3), 3, 3)


@needs_fork
def test_a_child_forked_among_the_calls_does_not_wait_for_helpers_of_its_parent() -> None:
    begun, last, codes, parent = threading.Event(), threading.Event(), [], os.getpid()

    def call(k: int) -> None:
        if k == 0:
            begun.wait(LONGEST_WAIT)
            child = os.fork()
            if child == 0:
                signal.alarm(int(LONGEST_WAIT))
                return
            codes.append(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
            last.set()
        elif k == 1:
            begun.set()
            last.wait(LONGEST_WAIT)

    done = in_threads(lambda k: lambda: call(k), 4, 2)
    if os.getpid() != parent:
        os._exit(3 if not done else 4)
    assert done and codes == [3]


@pytest.mark.parametrize("daemon", [False, True])
def test_idle_and_busy_helpers_let_the_process_end(daemon: bool) -> None:
    script = f"""
import threading
from ulna.system.helper_threads import in_threads
barrier = threading.Barrier(3)
in_threads(lambda _: lambda: barrier.wait({LONGEST_WAIT}), 3, 3)
begun = threading.Barrier(3)
def call():
    begun.wait({LONGEST_WAIT})
    if {daemon}:
        threading.Event().wait()
thread = threading.Thread(target=in_threads, args=(lambda _: call, 2, 2), daemon={daemon})
thread.start()
begun.wait({LONGEST_WAIT})
print("ends", flush=True)
"""
    process = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, timeout=2 * LONGEST_WAIT, check=False
    )
    assert (process.returncode, process.stdout, process.stderr) == (0, "ends\n", "")
