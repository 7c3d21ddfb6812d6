"""Kernels on arrays that end or begin at a page nobody may touch: a read or write too far would crash the child."""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np
import pytest

from support.fenced import fenced
from ulna.compiler import compile, trace

HERE = os.path.dirname(__file__)
FOLDERS = (HERE, os.path.dirname(os.path.dirname(HERE)))


def sweep() -> int:
    """Random kernels over fenced arrays of every size and stride; returns how many calls were compared."""
    rng = np.random.default_rng(5)
    calls = 0
    for number, size in enumerate((1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 13, 16, 17, 19)):
        dtype = (np.float64, np.float32)[number % 2]
        order, pick = rng.permutation(size), rng.integers(0, size, 5)
        kernel = compile(
            trace(lambda a, s, o=order, p=pick: (a[o] * s, a[p] + a[-1], s), a=(size,), s=()), dtype
        )
        for rows in (0, 1, 2, 3, 5, 7, 8, 9, 15, 16, 17, 23, 33):
            for at_end in (True, False):
                a = fenced(rows * size, dtype, at_end).reshape(rows, size)
                s = fenced(rows, dtype, at_end)
                a[...], s[...] = rng.normal(size=a.shape), rng.normal(size=s.shape)
                out = tuple(fenced(rows * n, dtype, at_end).reshape(rows, n) for n in (size, 5))
                out = (*out, fenced(rows, dtype, at_end))
                by_columns = fenced(rows * size, dtype, at_end).reshape(size, rows)
                by_columns[...] = a.T
                variants = [(a, s), (by_columns.T, s), (a[::-1], s[::-1]), (a[:, ::-1], s), (a[::2], s[::2])]
                if rows:
                    variants += [(np.broadcast_to(a[-1], a.shape), s), (a[:, :1].repeat(size, 1), s[-1])]
                for x, y in variants:
                    expected = (x[:, order] * np.reshape(y, (-1, 1)), x[:, pick] + x[:, -1:], y)
                    target = tuple(o[: len(x)] for o in out)
                    kernel(x, y, out=target)
                    for g, e in zip(target, expected, strict=True):
                        assert np.array_equal(g, np.broadcast_to(e, g.shape)), (size, rows, dtype)
                    calls += 1
                if rows:
                    one = kernel(a[0], s[0].reshape(()))
                    assert np.array_equal(one[0], a[0][order] * s[0])
                    kernel(a[-1], s[-1:].reshape(()))
                    calls += 2
    return calls


@pytest.mark.skipif(sys.platform == "win32", reason="needs mprotect")
def test_nothing_beyond_an_array_is_touched():
    code = "import sys; sys.path[:0] = sys.argv[1:]; import test_memory_safety as t; print(t.sweep())"
    child = subprocess.run(
        [sys.executable, "-X", "faulthandler", "-c", code, *FOLDERS],
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    assert child.returncode == 0, child.stdout + child.stderr
    assert int(child.stdout) > 1500


@pytest.mark.skipif(sys.platform == "win32", reason="needs mprotect")
def test_reads_past_the_end_end_the_process():
    """Proof that the test above would see a read one number too far."""
    code = (
        "import sys; sys.path[:0] = sys.argv[1:]; import numpy as np; from support.fenced import fenced; "
        "a = fenced(5, float, True); np.lib.stride_tricks.as_strided(a, (6,)).sum()"
    )
    child = subprocess.run(
        [sys.executable, "-c", code, *FOLDERS], capture_output=True, timeout=600, check=False
    )
    assert child.returncode != 0
