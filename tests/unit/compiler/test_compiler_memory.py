"""What LLVM needed to compile a kernel is freed."""

from __future__ import annotations

from support.memory import least_growth
from ulna import numeric as nm
from ulna.compiler import compile
from ulna.compiler.runtime import jit


def test_compiling_kernels_with_loops_keeps_no_memory(monkeypatch):
    sources: list[str] = []
    original = jit.optimised
    monkeypatch.setattr(
        jit, "optimised", lambda ir, passes, machine: (sources.append(ir), original(ir, passes, machine))[1]
    )
    monkeypatch.setenv("ULNA_CACHE", "0")
    kernel = compile(lambda x: nm.loop(lambda n: n < 10.0, lambda n: (n + 1.625,), (x,), 20)[0], x=())
    assert kernel(0.0) == 11.375
    assert sources

    def compiled(count: int) -> None:
        for _ in range(count):
            original(sources[0], jit.Passes.LEVEL_1, jit._machine_of_level(2))

    compiled(20)
    most = 100 * 20e3  # bytes; it was 70,000 for each
    assert least_growth(lambda: compiled(100), most) < most
