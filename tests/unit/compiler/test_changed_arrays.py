"""Bound kernels look at their arrays at every call: NumPy lets arrays be changed in place whoever else uses them."""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np
import pytest

from ulna.compiler import compile
from ulna.errors import DtypeError, InputError, ShapeError

Q = np.array([0.1, -0.7, 1.3])


@pytest.fixture(scope="module")
def twice():
    return compile(lambda q: 2.0 * q, q=(3,))


def _resize(a):
    a.resize(300_000, refcheck=False)


def _shrink(a):
    a.resize(1, refcheck=False)


def _read_only(a):
    a.flags.writeable = False


def _reshape(a):
    a.shape = (3, 1)


def _retype(a):
    a.dtype = np.int64


def _restate(a):
    a.__setstate__((1, (2,), np.dtype(float), False, bytes(16)))


CHANGES = {
    _resize: ShapeError, _shrink: ShapeError, _read_only: InputError,
    _reshape: ShapeError, _retype: DtypeError, _restate: ShapeError,
}  # fmt: skip


@pytest.mark.parametrize("change", CHANGES)
@pytest.mark.parametrize("guarded", [False, True])
def test_a_target_that_was_changed_is_refused(twice, change, guarded):
    row = np.zeros(3)
    options = {"watch": [(Q, Q.copy())], "otherwise": lambda *_: "otherwise"} if guarded else {}
    step = twice.into(row, returns=(0,), **options)
    assert step(Q).tolist() == (2.0 * Q).tolist()
    change(row)
    before = row.tobytes()
    with pytest.raises(CHANGES[change], match="changed after into"):
        step(Q)
    assert row.tobytes() == before


def test_a_target_is_written_where_it_now_lies(twice):
    row = np.zeros(3)
    step = twice.into(row, returns=(0,))
    step(Q)
    _resize(row)
    blocker = [np.full(3, 7.0) for _ in range(100)]  # takes the memory that the array had
    row.resize(3, refcheck=False)
    assert step(Q).tolist() == (2.0 * Q).tolist() == row.tolist()
    assert all((b == 7.0).all() for b in blocker)
    row.flags.writeable = False
    with pytest.raises(InputError, match="read-only"):
        step(Q)
    row.flags.writeable = True
    assert step(3.0 * Q).tolist() == (6.0 * Q).tolist()


@pytest.mark.parametrize("change", [_resize, _shrink, _reshape, _retype, _restate])
def test_a_given_array_that_was_changed_is_refused(change):
    add = compile(lambda q, v: q + v, q=(3,), v=(3,))
    row, last = np.zeros(3), np.ones(3)
    step = add.into(row, trailing_inputs=(last,))
    step(Q)
    change(last)
    with pytest.raises(InputError, match="changed after into"):
        step(Q)


@pytest.mark.parametrize("change", [_resize, _shrink, _reshape, _retype, _restate])
@pytest.mark.parametrize("side", [0, 1])
def test_a_watched_array_that_was_changed_differs(twice, change, side):
    pair = (np.arange(3.0), np.arange(3.0))
    step = twice.into(np.zeros(3), watch=[pair], otherwise=lambda *_: "otherwise")
    assert step(Q) is None
    change(pair[side])
    assert step(Q) == "otherwise"


def test_a_read_only_given_or_watched_array_is_read(twice):
    add = compile(lambda q, v: q + v, q=(3,), v=(3,))
    row, last, kept = np.zeros(3), np.ones(3), np.ones(3)
    step = add.into(row, trailing_inputs=(last,), watch=[(last, kept)], otherwise=lambda *_: "otherwise")
    last.flags.writeable = kept.flags.writeable = False
    assert step(Q) is None
    assert row.tolist() == (Q + 1.0).tolist()


def test_memory_that_was_freed_is_not_written():
    # glibc checks its free lists when asked to: a write into freed memory ends the process
    text = (
        "import numpy as np\nfrom ulna.compiler import compile\n"
        "f = compile(lambda q: 2.0 * q, q=(500,))\nq = np.ones(500)\n"
        "for _ in range(20):\n"
        "    a = np.zeros(500); step = f.into(a); step(q); a.resize(1, refcheck=False)\n"
        "    try: step(q)\n"
        "    except ValueError: pass\n"
        "    else: raise SystemExit('written')\n"
    )
    env = {**os.environ, "MALLOC_CHECK_": "3", "MALLOC_PERTURB_": "165"}
    done = subprocess.run(
        [sys.executable, "-c", text], capture_output=True, text=True, timeout=600, env=env, check=False
    )
    assert done.returncode == 0, done.stderr
