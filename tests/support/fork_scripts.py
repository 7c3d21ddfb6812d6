"""Scripts whose forked children must end, each run in a separate interpreter."""

from __future__ import annotations

import os
import subprocess
import sys
import textwrap

_HEAD = """
import faulthandler, os, sys, threading, time
import numpy as np
import ulna
from ulna.system import forks
from ulna.compiler import compile

def child(work):
    # one fork whose child does `work`; its exit status, 99 after a hang
    number = os.fork()
    if number == 0:
        faulthandler.dump_traceback_later(300.0, exit=True)
        try:
            work()
            os._exit(0)
        except BaseException:
            import traceback
            traceback.print_exc()
        finally:
            os._exit(1)
    return os.waitstatus_to_exitcode(os.waitpid(number, 0)[1])

def heavy(n):
    # takes LLVM about 0.3 s
    def f(q):
        x = q
        for k in range(60):
            x = np.sin(x + k * n) * x[::-1] + np.cos(q * x)
        return x
    return compile(f, q=(8,))

def fresh():
    n = float(time.monotonic_ns())
    assert compile(lambda q: n * q, q=(3,))(np.ones(3))[0] == n
"""


def run_script(text: str, cache: str = "0") -> str:
    script = _HEAD + textwrap.dedent(text)
    done = subprocess.run(
        [sys.executable, "-W", "ignore::DeprecationWarning", "-c", script],
        capture_output=True,
        text=True,
        timeout=900,
        env={**os.environ, "ULNA_CACHE": cache, "ULNA_QUIET": "1"},
        check=False,
    )
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-6000:]
    return done.stdout
