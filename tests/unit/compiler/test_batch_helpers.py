"""Threads that compute rows of batches: they sleep, end, are used again, and nobody waits for one that does not come."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from support.callers import call_at_once
from support.patience import LONGEST_WAIT, patient
from ulna.compiler import compile
from ulna.compiler.codegen.shared_batch import BOX
from ulna.compiler.runtime import array_call, batch_helpers, shared_batch, shared_call

wait = patient()
needs_fork = pytest.mark.skipif(not hasattr(os, "fork"), reason="has no fork")
ROWS = 5000


@pytest.fixture(autouse=True)
def helpers(monkeypatch: pytest.MonkeyPatch) -> batch_helpers.Helpers:
    """Helpers of the test's own, and parts of 16 rows, so that small batches have many."""
    own = batch_helpers.Helpers()
    for module in (batch_helpers, shared_batch, shared_call):
        monkeypatch.setattr(module, "helpers", own)
    monkeypatch.setattr(array_call, "_LEAST_WORK", 1)
    return own


@pytest.fixture(scope="module")
def kernel() -> Any:
    return compile(lambda x: np.sin(x) @ np.cos(x) + np.exp(x), x=(3,))


def _rows(count: int = ROWS) -> np.ndarray:
    return np.random.default_rng(5).uniform(-1, 1, (count, 3))


def _check(kernel: Any, threads: int = 2, times: int = 1) -> None:
    x = _rows()
    wanted = kernel(x)
    for _ in range(times):
        np.testing.assert_array_equal(kernel(x, threads=threads), wanted)


def test_a_helper_is_used_again(kernel: Any, helpers: batch_helpers.Helpers) -> None:
    _check(kernel)
    (first,) = helpers.idle
    _check(kernel, times=50)
    assert helpers.idle == [first]
    _check(kernel, 4, 50)
    assert len(helpers.idle) == 3 and first in helpers.idle


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="has no /proc")
def test_an_idle_helper_sleeps(kernel: Any, helpers: batch_helpers.Helpers) -> None:
    _check(kernel, times=10)
    task = Path(f"/proc/self/task/{helpers.idle[0].thread.native_id}/stat")

    def state() -> str:
        return task.read_text().rpartition(")")[2].split()[0]

    assert wait(lambda: state() == "S")


def test_helpers_without_a_batch_end(
    kernel: Any, helpers: batch_helpers.Helpers, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(batch_helpers, "IDLE", 0.001)
    _check(kernel)
    thread = helpers.idle[0].thread if helpers.idle else None
    assert wait(lambda: not helpers.idle) and (thread is None or wait(lambda: not thread.is_alive()))
    _check(kernel)


def test_a_helper_that_ended_is_left_out(kernel: Any, helpers: batch_helpers.Helpers) -> None:
    _check(kernel)
    (helper,) = helpers.idle
    helper.box[BOX.index("state")] = batch_helpers.ENDED
    _check(kernel)
    assert helper not in helpers.idle and len(helpers.idle) == 1
    helper.box[BOX.index("state")] = 0


def test_batches_while_helpers_end_all_the_time(kernel: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(batch_helpers, "IDLE", 1e-6)
    x = _rows(100)
    wanted = kernel(x)
    for pause in [0.0, 0.002, 0.0021, 0.0022] * 20:
        np.testing.assert_array_equal(kernel(x, threads=4), wanted)
        if pause:
            threading.Event().wait(pause)


def test_the_caller_computes_the_rows_of_threads_that_do_not_come(
    kernel: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(threading.Thread, "start", lambda _: None)
    _check(kernel, 5, 3)


def test_batches_are_computed_where_no_thread_can_be_started(
    kernel: Any, helpers: batch_helpers.Helpers, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refused(thread: threading.Thread) -> None:
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr(threading.Thread, "start", refused)
    _check(kernel, 3, 2)
    assert not helpers.idle


def test_an_error_before_the_batch_gives_the_helpers_back(helpers: batch_helpers.Helpers) -> None:
    def fail(boxes: int, count: int) -> None:
        assert boxes and count == 2
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        helpers.compute(2, fail)
    assert len(helpers.idle) == 2


@pytest.mark.skipif(os.name == "nt", reason="sends signals as POSIX has them")
def test_ctrl_c_comes_after_the_batch(kernel: Any) -> None:
    x, out = _rows(400_000), np.full((400_000, 3), np.nan)
    wanted = kernel(x)
    kernel(x[:100], threads=2)
    main = threading.main_thread().ident
    timer = threading.Timer(0.002, signal.pthread_kill, (main, signal.SIGINT))
    with pytest.raises(KeyboardInterrupt):
        timer.start()
        for _ in range(10_000):
            kernel(x, out=out, threads=2)
    timer.join()
    _check(kernel, times=3)
    np.testing.assert_array_equal(kernel(x, out=out, threads=2), wanted)


def test_several_threads_call_at_once(kernel: Any) -> None:
    call_at_once(lambda: _check(kernel, 3, 200), 6)


def _answer_of_child(work: Callable[[], object]) -> int:
    """The exit code of a forked child: 0 where `work` raises nothing."""
    child = os.fork()
    if child == 0:
        signal.alarm(int(LONGEST_WAIT))
        try:
            work()
        except BaseException:
            os._exit(1)
        os._exit(0)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


@needs_fork
def test_a_forked_child_has_helpers_of_its_own(kernel: Any, helpers: batch_helpers.Helpers) -> None:
    _check(kernel, 3)

    def work() -> None:
        assert not helpers.idle
        _check(kernel, 3, 5)
        assert len(helpers.idle) == 2 and all(helper.thread.is_alive() for helper in helpers.idle)

    assert _answer_of_child(work) == 0
    _check(kernel, 3)


@needs_fork
def test_a_child_forked_before_the_batch_begins_computes_it_alone(
    kernel: Any, helpers: batch_helpers.Helpers
) -> None:
    """As where a handler of a signal forks between two instructions of Python."""
    x = _rows()
    wanted = kernel(x)
    _check(kernel)
    codes: list[int] = []
    compute = helpers.compute

    def forked(count: int, run: Callable[[int, int], Any]) -> Any:
        def later(boxes: int, given: int) -> Any:
            if not codes:
                codes.append(_answer_of_child(lambda: run(boxes, given)))
            return run(boxes, given)

        return compute(count, later)

    helpers.compute = forked  # type: ignore[method-assign]
    np.testing.assert_array_equal(kernel(x, threads=2), wanted)
    assert codes == [0]


@needs_fork
def test_children_forked_while_other_threads_compute(kernel: Any) -> None:
    stop, errors = threading.Event(), []

    def run() -> None:
        try:
            while not stop.is_set():
                _check(kernel, 3)
        except BaseException as error:
            errors.append(error)

    callers = [threading.Thread(target=run) for _ in range(2)]
    for caller in callers:
        caller.start()
    try:
        codes = [_answer_of_child(lambda: _check(kernel, 3, 3)) for _ in range(10)]
    finally:
        stop.set()
        for caller in callers:
            caller.join()
    assert codes == [0] * 10 and not errors


@pytest.mark.parametrize("is_busy", [False, True])
def test_helpers_let_the_process_end(is_busy: bool) -> None:
    script = f"""
import threading
import numpy as np
from ulna.compiler import compile
from ulna.compiler.runtime import array_call
array_call._LEAST_WORK = 1
kernel = compile(lambda x: np.sin(x), x=(3,))
x = np.zeros((10_000, 3))
kernel(x, threads=3)
begun = threading.Event()
def run():
    while True:
        kernel(x, threads=3)
        begun.set()
if {is_busy}:
    threading.Thread(target=run, daemon=True).start()
    begun.wait()
print("ends", flush=True)
"""
    process = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, timeout=2 * LONGEST_WAIT, check=False
    )
    assert (process.returncode, process.stdout, process.stderr) == (0, "ends\n", "")
