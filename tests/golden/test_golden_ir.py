"""The IR text of three tiny functions, so that a change of the emitter is seen and read before it is merged."""

from __future__ import annotations

import hashlib
import sysconfig
from dataclasses import replace

import numpy as np
import pytest

from ulna import numeric as nm
from ulna.compiler import Function, trace
from ulna.compiler.codegen.arithmetic import Arithmetic
from ulna.compiler.codegen.elementary import OPERATIONS, elementary_ir
from ulna.compiler.codegen.module import emit_batch, emit_single
from ulna.compiler.codegen.sincos import sincos_ir
from ulna.compiler.codegen.target import Target
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

WIDE = Target("x86_64-unknown-linux-gnu", "generic", "+avx512f", "", register_bytes=64)
TEXTS = {
    "affine_single.ll": lambda: emit_single(AFFINE, WIDE),
    "affine_batch_4.ll": lambda: emit_batch(AFFINE, replace(WIDE, register_bytes=32)),
    "affine_entry.ll": lambda: entry_ir(AFFINE, WIDE, checked=True),
    "choose_single_float.ll": lambda: emit_single(CHOOSE, WIDE, "float"),
    "choose_batch_2.ll": lambda: emit_batch(
        CHOOSE, replace(WIDE, register_bytes=16, arithmetic=Arithmetic(fused_multiply_add=False))
    ),
    "halve_single.ll": lambda: emit_single(HALVE, WIDE),
    "halve_batch_8.ll": lambda: emit_batch(HALVE, WIDE),
}


@pytest.mark.parametrize("name", TEXTS)
def test_ir(golden, name):
    if name == "affine_entry.ll" and sysconfig.get_config_var("Py_GIL_DISABLED"):
        pytest.skip("the entry point reads fields of objects, which lie elsewhere in a free-threaded CPython")
    golden(name, TEXTS[name]())


def test_elementary_functions(golden):
    """What of this processor's elementary functions changes, every kernel changes with; hashes, as they are long."""
    functions = [sincos_ir(n, dtype) for n, dtype in ((1, "double"), (8, "double"), (16, "float"))]
    functions += [elementary_ir(op, 8, "double") for op in OPERATIONS]
    texts = {f.name: "\n".join([*f.declarations, f.text]) for f in functions}
    lines = [f"{name} {hashlib.sha256(text.encode()).hexdigest()}\n" for name, text in texts.items()]
    golden("elementary.txt", "".join(lines))


def test_fingerprints(golden):
    """They name kernels in the cache of every user: a change makes all of them compile anew, once."""
    functions: list[Function] = [AFFINE, CHOOSE, HALVE]
    golden("fingerprints.txt", "".join(f"{f.name} {f.fingerprint}\n" for f in functions))
