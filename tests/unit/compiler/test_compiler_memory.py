"""What LLVM needed to compile a kernel is freed."""

from __future__ import annotations

import gc
import os
from pathlib import Path

import pytest

from ulna import numeric as nm
from ulna.compiler import compile
from ulna.compiler.runtime import jit

STATUS = Path("/proc/self/statm")


@pytest.mark.skipif(not STATUS.exists(), reason="reads the memory of the process as Linux has it")
def test_compiling_kernels_with_loops_keeps_no_memory(monkeypatch):
    sources: list[str] = []
    original = jit.optimised
    monkeypatch.setattr(
        jit, "optimised", lambda ir, loops, machine: (sources.append(ir), original(ir, loops, machine))[1]
    )
    monkeypatch.setenv("ULNA_CACHE", "0")
    kernel = compile(lambda x: nm.loop(lambda n: n < 10.0, lambda n: (n + 1.625,), (x,), 20)[0], x=())
    assert kernel(0.0) == 11.375
    assert sources

    def used() -> int:
        gc.collect()
        return int(STATUS.read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")

    for _ in range(20):
        original(sources[0], True, jit._machine())
    before, count = used(), 100
    for _ in range(count):
        original(sources[0], True, jit._machine())
    assert (used() - before) / count < 20e3  # bytes; it was 70,000
