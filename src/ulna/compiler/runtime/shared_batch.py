"""Batches whose rows threads share in machine code: between them nobody waits for the interpreter's lock."""

from __future__ import annotations

import ctypes
import math
from array import array
from collections.abc import Callable, Sequence
from functools import cache
from itertools import pairwise
from typing import Any

from ulna.compiler.codegen.shared_batch import APART
from ulna.compiler.language.ports import Port
from ulna.compiler.runtime.batch_helpers import code, helpers


def share(
    loop: int, ports: Sequence[Port], arrays: Sequence[Any], batch: tuple[int, ...], block: int, threads: int
) -> bool:
    """Computes a batch in threads where its arrays allow it.

    Args:
        loop: Address of NumPy's inner loop (see `module.emit_batch`).
        ports: Inputs, then outputs.
        arrays: An array of the loop's very type for each, (..., shape); outputs have all axes of the batch.
        batch: The axes of the batch.
        block: How many rows a thread takes at a time.
        threads: How many threads share them at most.

    Returns:
        Whether it was computed: not where the rows of an array do not lie at equal distances.
    """
    steps: list[int] = []
    for a, port in zip(arrays, ports, strict=True):
        step = _step(a, port, batch)
        if step is None:
            return False
        steps.append(step)
    rows = math.prod(batch)
    inner = [
        length for a, p in zip(arrays, ports, strict=True) for length in a.strides[a.ndim - len(p.shape) :]
    ]
    ends = [rows * (k + 1) // threads // block * block for k in range(threads - 1)] + [rows]
    following = [0] * (APART * threads)
    following[::APART] = [0, *ends[:-1]]
    addresses: list[int] = [
        a.__array_interface__["data"][0] for a in arrays
    ]  # a.ctypes takes three times as long
    tables = [array("q", numbers) for numbers in (addresses, steps + inner, ends, following)]
    words = array("q", [loop, len(arrays), block, threads, *(table.buffer_info()[0] for table in tables)])
    run = _function()
    helpers.compute(threads - 1, lambda boxes, count: run(words.buffer_info()[0], boxes, count))
    return True


def _step(a: Any, port: Port, batch: tuple[int, ...]) -> int | None:
    """The distance between rows of an array [byte], 0 where all are the same one; None where it differs."""
    if not a.flags.aligned:
        return None
    own = a.shape[: a.ndim - len(port.shape)]
    if math.prod(own) == 1:
        return 0
    if own != batch:
        return None
    axes = [(length, step) for length, step in zip(own, a.strides, strict=False) if length > 1]
    if any(step != length * finer for (_, step), (length, finer) in pairwise(axes)):
        return None
    return axes[-1][1]


@cache
def _function() -> Callable[..., None]:
    """The machine code, called without the interpreter's lock."""
    kind = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_ssize_t)
    return kind(code().address("run"))
