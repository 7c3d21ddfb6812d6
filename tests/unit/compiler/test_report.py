"""`kernel.report()`: what a kernel costs."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ulna
from support.long_robots import long_robot
from ulna.compiler import compile
from ulna.compiler.runtime import jit
from ulna.compiler.runtime import report as module
from ulna.errors import InputError


def squares(x: Any) -> Any:
    return x * x + 1.0


def test_counts_and_sizes_of_a_small_kernel(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("ULNA_CACHE", str(tmp_path / "cache"))
    kernel = compile(squares, x=(3,))
    report = kernel.report()
    assert (report.name, report.signature, report.dtype) == ("squares", "(3)->(3)", "float64")
    assert report.operations == kernel.operations == 6 and report.counts == {"add": 3, "mul": 3}
    assert report.bytes_moved == 6 * 8 and report.intensity == 6 / 48
    assert (report.batch, report.lanes) == (False, 1)
    assert 50 < report.code_bytes < 5000 and 0 <= report.stack_bytes < 1000
    assert report.compile_seconds > 0.0
    assert report.limit == "arithmetic"  # of a single call, which reads from the cache of the processor
    with pytest.raises(dataclasses.FrozenInstanceError):
        report.lanes = 2  # type: ignore[misc]


def test_batches_use_lanes_and_small_functions_wait_for_memory() -> None:
    for dtype, size in (("float64", 8), ("float32", 4)):
        report = compile(squares, dtype, x=(3,)).report(batch=True)
        assert report.batch and report.lanes == max(jit.target().register_bytes // size, 2)
        assert report.bytes_moved == 6 * size and report.limit == "memory"


def test_large_code_and_many_functions_are_separate_limits(monkeypatch: pytest.MonkeyPatch) -> None:
    functions = compile(lambda x: np.sin(np.exp(np.sin(np.exp(np.sin(x))))), x=(2,)).report(batch=True)
    assert functions.limit == "arithmetic"
    monkeypatch.setattr(module, "_INSTRUCTION_CACHE", 1024)
    large = ulna.load("panda").kernel("inverse_dynamics").report()
    assert large.code_bytes > 1024 and large.limit == "code"
    if large.spills is not None:
        assert large.spills > 5 and large.stack_bytes > 50


def test_the_state_of_the_cache(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("ULNA_CACHE", str(tmp_path / "cache"))
    kernel = compile(lambda x: x * 3.25, x=(2,))
    before = kernel.report(batch=True)
    kernel(np.ones((4, 2)))
    assert (before.cache, kernel.report(batch=True).cache) == ("not stored", "stored")
    assert dataclasses.replace(
        kernel.report(batch=True), cache="", compile_seconds=0.0
    ) == dataclasses.replace(before, cache="", compile_seconds=0.0)
    monkeypatch.setenv("ULNA_CACHE", "0")
    assert kernel.report().cache == "off"


def test_it_prints_as_a_table() -> None:
    text = str(compile(squares, x=(3,)).report())
    assert text.splitlines()[0] == "squares(3)->(3), float64, single call"
    assert "operations   6 (3 add, 3 mul)" in text and "limit        arithmetic (estimate)" in text
    assert "samples at once" in str(compile(squares, x=(3,)).report(batch=True))


def test_kernels_that_loop_over_joints_have_code_but_no_operations() -> None:
    kernel = ulna.Robot(long_robot(1000)).kernel("inverse_dynamics")
    report = kernel.report()
    assert report.operations is None and report.counts == {} and report.intensity is None
    assert report.code_bytes > 1000 and "a loop over joints" in str(report)


def test_what_is_not_compiled_has_no_report() -> None:
    kernel = compile(lambda x: x[:0], x=(3,))
    with pytest.raises(InputError, match="not compiled"):
        kernel.report(batch=True)
