"""Kernels under threads, forks, signals and little memory: nothing hangs, crashes or computes something else."""

from __future__ import annotations

import os
import subprocess
import sys
import textwrap

import pytest

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork and signals")

_HEAD = """
import os, random, resource, signal, sys, threading, time
import numpy as np
import ulna
from ulna.compiler import compile

def make(n, size=40):
    def f(q):
        x = q
        for k in range(size):
            x = np.sin(x + k * n) * x[::-1] + q
        return x
    return f

def check(n, size=40):
    # compiles, calls, compares with the same function on arrays, and drops
    kernel, q = compile(make(n, size), q=(5,)), np.linspace(0.1, 0.9, 5)
    wanted = make(n, size)(q)
    np.testing.assert_allclose(kernel(q), wanted, rtol=1e-7)
    np.testing.assert_allclose(kernel(np.tile(q, (33, 1))), np.tile(wanted, (33, 1)), rtol=1e-7)
"""


def _run(text: str, endings: tuple[tuple[int, str], ...] = ()) -> str:
    """What a program prints. It ends well, or with one of some exit codes and words."""
    done = subprocess.run(
        [sys.executable, "-W", "ignore::DeprecationWarning", "-c", _HEAD + textwrap.dedent(text)],
        capture_output=True,
        text=True,
        timeout=900,
        env={**os.environ, "ULNA_CACHE": "0", "ULNA_QUIET": "1"},
        check=False,
    )
    known = any(done.returncode == code and words in done.stderr for code, words in endings)
    assert done.returncode == 0 or known, f"{done.returncode}: {done.stdout[-1000:]}{done.stderr[-4000:]}"
    return done.stdout


def test_a_process_ends_while_daemon_threads_compile():
    # LLVM was torn down under them: every third process ended by a signal
    for _ in range(3):
        _run(
            """
            def forever():
                n = 0
                while True:
                    n += 1
                    compile(make(float(n)), q=(5,))
            for _ in range(2):
                threading.Thread(target=forever, daemon=True).start()
            time.sleep(1.0)
            """
        )


@pytest.mark.slow
def test_threads_compile_call_and_drop_while_children_are_forked():
    _run(
        """
        end, wrong = time.monotonic() + 8.0, []
        shared = compile(make(0.5), q=(5,))
        wanted = shared(np.ones(5))
        def work(seed):
            chance = random.Random(seed)
            try:
                while time.monotonic() < end:
                    check(chance.choice([1.0, 2.0, chance.random()]))
                    assert (shared(np.ones(5)) == wanted).all()
            except BaseException as error:
                wrong.append(repr(error))
        threads = [threading.Thread(target=work, args=(k,)) for k in range(4)]
        for thread in threads:
            thread.start()
        while time.monotonic() < end:
            number = os.fork()
            if number == 0:
                signal.alarm(600)  # a hang ends by SIGALRM
                try:
                    check(random.random())
                    os._exit(0)
                finally:
                    os._exit(1)
            assert os.waitpid(number, 0)[1] == 0
        for thread in threads:
            thread.join()
        assert not wrong, wrong
        """
    )


@pytest.mark.slow
def test_a_storm_of_ctrl_c_leaves_everything_usable():
    out = _run(
        """
        check(0.25)
        end, count, n = time.monotonic() + 8.0, 0, 0.0
        ready = threading.Event()  # no signal comes while the last one is being handled
        def storm():
            while time.monotonic() < end or count < 6:
                time.sleep(random.uniform(0.01, 0.2))
                if ready.wait(0.1):
                    before = count
                    signal.pthread_kill(threading.main_thread().ident, signal.SIGINT)
                    waited = 0
                    while count == before and waited < 100:  # Python drops some: those in a destructor
                        time.sleep(0.05)
                        waited += 1
        def work():
            global n
            ready.set()
            while thread.is_alive():
                n += 1.0
                check(n)
        thread = threading.Thread(target=storm)
        thread.start()
        while True:
            try:
                work()
                break
            except KeyboardInterrupt:
                ready.clear()
                count += 1
        thread.join()
        check(0.75)
        print(count)
        """
    )
    assert int(out) > 5


@pytest.mark.slow
@pytest.mark.parametrize("room", [5, 12, 30])
def test_little_memory_raises_or_ends_in_words_of_llvm(room):
    # LLVM, and the C library when a thread starts, end the process when they get no memory (docs/compiler.md)
    out = _run(
        f"""
        check(0.25)
        with open("/proc/self/statm") as file:
            now = int(file.read().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (now + {room} * 2**20,) * 2)
        try:
            check(0.5, 300)
            print("done")
        except (MemoryError, ulna.errors.UlnaError, RuntimeError) as error:
            print(type(error).__name__)
        """,
        endings=(
            (-6, "LLVM ERROR"),
            (-6, "Can not add null object"),
            (-6, "std::bad_alloc"),
            (127, "cannot allocate memory for thread-local data"),
        ),
    )
    assert out in ("", "done\n", "MemoryError\n", "CompileError\n", "RuntimeError\n")
