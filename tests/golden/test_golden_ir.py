"""The IR text of three tiny functions, so that a change of the emitter is seen and read before it is merged."""

from __future__ import annotations

import numpy as np
import pytest

from ulna import numeric as nm
from ulna.compiler import Function, trace
from ulna.compiler.codegen.module import emit_batch, emit_single
from ulna.compiler.runtime.entry_point import entry_ir


def _affine(q):
    return 2.0 * q[::-1] + q[0]


def _choose(x, y):
    return nm.where((x < y) & ~(y == 0.0), np.sqrt(x), nm.minimum(abs(x), y)), y


def _halve(x):
    return nm.loop(lambda v, n: v > 1.0, lambda v, n: (v * 0.5, n + x), (x, 0.0), 20)


AFFINE = trace(_affine, q=(3,))
CHOOSE = trace(_choose, x=(), y=(), rules="exact")
HALVE = trace(_halve, x=())

TEXTS = {
    "affine_single.ll": lambda: emit_single(AFFINE),
    "affine_batch_4.ll": lambda: emit_batch(AFFINE, "double", 4),
    "affine_entry.ll": lambda: entry_ir(AFFINE, checked=True),
    "choose_single_float.ll": lambda: emit_single(CHOOSE, "float"),
    "choose_batch_2.ll": lambda: emit_batch(CHOOSE, "double", 2, contract=False),
    "halve_single.ll": lambda: emit_single(HALVE),
    "halve_batch_8.ll": lambda: emit_batch(HALVE, "double", 8),
}


@pytest.mark.parametrize("name", TEXTS)
def test_ir(golden, name):
    golden(name, TEXTS[name]())


def test_fingerprints(golden):
    """They name kernels in the cache of every user: a change makes all of them compile anew, once."""
    functions: list[Function] = [AFFINE, CHOOSE, HALVE]
    golden("fingerprints.txt", "".join(f"{f.name} {f.fingerprint}\n" for f in functions))
