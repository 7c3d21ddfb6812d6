"""Ctrl-C while native code works: the wait ends at once, the work goes on apart, and the process ends properly."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import ulna
from ulna.compiler import compile, trace
from ulna.compiler.runtime import jit, method_call
from ulna.compiler.runtime.interrupt import interruptible

pytestmark = pytest.mark.skipif(os.name == "nt", reason="sends signals as POSIX has them")

_PRELUDE = """
import os, signal, sys, threading, time
from ulna.compiler.runtime.interrupt import interruptible
started = threading.Event()
def work(seconds):
    started.set()
    time.sleep(seconds)
    print("worked", flush=True)
def interrupt():
    started.wait()
    os.kill(os.getpid(), signal.SIGINT)
threading.Thread(target=interrupt, daemon=True).start()
"""


def run(script: str, timeout: float = 600.0) -> tuple[int, str, str, float]:
    start = time.monotonic()
    process = subprocess.run(
        [sys.executable, "-c", _PRELUDE + script],
        capture_output=True,
        text=True,
        timeout=timeout,
        check=False,
    )
    return process.returncode, process.stdout, process.stderr, time.monotonic() - start


def test_it_returns_and_raises_what_the_work_does() -> None:
    assert interruptible(lambda: 7) == 7
    with pytest.raises(ZeroDivisionError):
        interruptible(lambda: 1 // 0)


def test_work_goes_on_where_no_thread_can_be_started(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(self: threading.Thread) -> None:
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr(threading.Thread, "start", refused)
    monkeypatch.setattr(method_call, "is_ready", lambda: False)
    assert interruptible(lambda: 7) == 7
    with pytest.raises(ZeroDivisionError):
        interruptible(lambda: 1 // 0)
    robot = ulna.load("panda")
    assert robot.fk(np.zeros(robot.nq)).shape == (4, 4)


def test_the_main_thread_alone_needs_another_thread() -> None:
    names: list[str] = []

    def work() -> None:
        names.append(threading.current_thread().name)

    interruptible(work)
    other = threading.Thread(target=interruptible, args=(work,), name="mine")
    other.start()
    other.join()
    assert names == ["ulna compiler", "mine"]


def test_watchers_are_called_by_the_thread_that_compiles(monkeypatch) -> None:
    """They may take locks that it holds."""
    monkeypatch.setenv("ULNA_CACHE", "0")
    monkeypatch.setattr(jit, "_ANNOUNCE_FROM", 0.0)
    reported: list[tuple[str, str]] = []
    monkeypatch.setattr(
        jit, "watchers", [lambda *_: reported.append((threading.current_thread().name, _[1]))]
    )
    compile(trace(lambda q: q * 1.2345 + 6.0, q=()))(1.0)  # without the fast call, the first call compiles
    assert reported and {name for name, _ in reported} == {threading.current_thread().name}
    assert reported[-1][1] == ""


def test_an_interruption_that_nobody_catches_ends_the_process_at_once() -> None:
    code, out, err, seconds = run("interruptible(lambda: work(500.0))")
    assert code == -signal.SIGINT
    assert "KeyboardInterrupt" in err and "worked" not in out
    assert seconds < 500.0


def test_an_interruption_that_is_caught_lets_the_program_go_on() -> None:
    code, out, _, _ = run("""
leave = threading.Event()
def long_work():
    started.set()
    leave.wait()
    work(1.0)
try:
    interruptible(long_work)
except KeyboardInterrupt:
    print("interrupted", flush=True)
print(interruptible(lambda: 5), flush=True)
leave.set()
""")
    assert code == 0
    assert out.split() == ["interrupted", "5", "worked"]  # at the end it waits for what is under way


@pytest.mark.slow
def test_llvm_is_left_at_once_and_a_second_attempt_finds_its_result(tmp_path, monkeypatch) -> None:
    """The compilation of 40,000 operations takes seconds; it is interrupted, and asked for again."""
    compile(lambda x: x, x=())  # what all kernels share is compiled now, before the one that is interrupted
    monkeypatch.setenv("ULNA_CACHE", str(tmp_path / "cache"))
    monkeypatch.setenv("ULNA_QUIET", "1")

    def many(q):
        for k in range(20000):
            q = q * (1.0 + 1e-9 * k) + 0.5 * k
        return q

    def interrupt() -> None:
        while not any(thread.name == "ulna compiler" for thread in threading.enumerate()):
            time.sleep(0.001)
        time.sleep(0.2)
        os.kill(os.getpid(), signal.SIGINT)

    f = trace(many, q=())
    threading.Thread(target=interrupt, daemon=True).start()
    with pytest.raises(KeyboardInterrupt):
        compile(f)(0.5)
    assert any(thread.name == "ulna compiler" for thread in threading.enumerate())
    assert compile(f)(0.5) == pytest.approx(f(0.5))


@pytest.mark.parametrize("registered_first", [True, False], ids=["before importing ulna", "after it"])
def test_functions_called_at_exit_can_compile(registered_first: bool) -> None:
    """Before, the first waited for a lock that the main thread held, and the second let llvmlite's objects fail."""
    imports, registers = (
        "import ulna",
        "atexit.register(lambda: print(robot.gravity_forces([0.0] * 6).shape))",
    )
    first, second = (registers, imports) if registered_first else (imports, registers)
    script = f"""
import atexit
{first}
{second}
robot = ulna.load("ur5", visuals="simple")
if {registered_first}:
    robot.fk([0.0] * 6)
"""
    environment = {**os.environ, "ULNA_CACHE": "0"}
    assert _ended(script, environment) == (0, "(6,)\n", "")


@pytest.mark.parametrize("cache", ["0", ""])
def test_a_function_called_at_exit_can_import_ulna_first(cache: str) -> None:
    """Before, objects of llvmlite failed and Python printed exceptions that were ignored."""
    script = """
import atexit

def late():
    import ulna
    robot = ulna.load("ur5", visuals="simple")
    print(robot.fk([0.0] * 6).shape, robot.gravity_forces([0.0] * 6).shape)

atexit.register(late)
"""
    environment = {**os.environ, **({"ULNA_CACHE": cache} if cache else {})}
    assert _ended(script, environment) == (0, "(4, 4) (6,)\n", "")


def test_functions_called_at_exit_plan_and_check_collisions_in_threads() -> None:
    """Before, the first import of thread pools failed, and so did a new pool."""
    script = """
import atexit
import numpy as np
import ulna
robot = ulna.load("ur5", visuals="simple")

def late():
    from ulna.collision import SphereChecker, World
    from ulna.geometry import Box
    from ulna.planning import Planner
    world = World().add("post", Box((0.1, 0.1, 1.0)), (2.0, 0.0, 0.3))
    Q = robot.random_configuration(3000, seed=1)
    checker = SphereChecker(robot, world)
    print((checker.collides(Q, threads=2) == checker.collides(Q)).all())
    print((checker.clearance(Q, threads=2) == checker.clearance(Q)).all())
    start = robot.configurations["qr"] if "qr" in robot.configurations else np.zeros(6)
    print([bool(plan) for plan in Planner(robot, world).plan_all(start, [start + 0.01, start + 0.02], threads=2)])

atexit.register(late)
"""
    quiet = {**os.environ, "ULNA_QUIET": "1"}  # what compiles may be stored already, or not
    assert _ended(script, quiet) == (0, "True\nTrue\n[True, True]\n", "")


def _ended(script: str, environment: dict[str, str]) -> tuple[int, str, str]:
    """What a process that runs a script returned and printed."""
    process = subprocess.run(
        [sys.executable, "-c", script],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
        env=environment,
    )
    return process.returncode, process.stdout, process.stderr
