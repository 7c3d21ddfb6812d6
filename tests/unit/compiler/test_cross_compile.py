"""Code for other processors comes from a child process; where LLVM fails there, an error is raised here."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ulna.compiler import trace
from ulna.compiler.codegen.module import emit_library
from ulna.compiler.runtime import jit
from ulna.compiler.runtime.cross_compile import cross_compile
from ulna.errors import CompileError, InputError
from ulna.exporting.objects.processors import PROCESSORS

SMALL = trace(lambda x: np.sqrt(x) * 2.0, name="small", x=(3,))
ARM = PROCESSORS["aarch64-linux-gnu"].target


def test_objects_and_assembly_of_another_processor():
    ir = emit_library([("small", SMALL)], ARM)
    assert cross_compile(ir, ARM, False)[:4] == b"\x7fELF"
    assert b"fsqrt" in cross_compile(ir, ARM, False, "assembly")


def test_the_second_time_comes_from_the_cache(monkeypatch, tmp_path):
    monkeypatch.setenv("ULNA_CACHE", str(tmp_path / "cache"))
    ir = emit_library([("small", SMALL)], ARM)
    first = cross_compile(ir, ARM, False)

    def refuse(*_, **__):
        raise AssertionError("a child was started")

    monkeypatch.setattr("ulna.compiler.runtime.cross_compile.subprocess.run", refuse)
    assert cross_compile(ir, ARM, False) == first


@pytest.mark.parametrize(
    ("target", "error", "message"),
    [
        (replace(ARM, triple="z81-unknown-cpm"), CompileError, "no code for the processor 'z81-unknown-cpm'"),
        (replace(ARM, cpu="cortex-a7777"), InputError, "'cortex-a7777' is not a recognized processor"),
        (replace(ARM, features="+warp"), InputError, r"'\+warp' is not a recognized feature"),
    ],
)
def test_unknown_processors(target, error, message):
    with pytest.raises(error, match=message):
        cross_compile(emit_library([("small", SMALL)], target), target, False)


def test_a_back_end_that_aborts_leaves_this_process_alone(monkeypatch):
    monkeypatch.setenv("ULNA_CACHE", "0")
    target = replace(jit.target(), triple="amdgcn-amd-amdhsa", cpu="gfx90a", features="")
    ir = "define void @f(ptr %p) {\n %a = alloca double\n store ptr %a, ptr %p\n ret void\n}\n"
    with pytest.raises(CompileError, match="no code for the processor 'amdgcn-amd-amdhsa'"):
        cross_compile(ir, target, False)


def test_ir_that_is_wrong_is_reported():
    with pytest.raises(CompileError, match="no code for the processor"):
        cross_compile("define void @f( {", ARM, False)


def test_local_arrays_lie_in_the_address_space_of_the_target():
    large = trace(lambda x: np.cumsum(np.sin(np.outer(x, x)).ravel() * np.arange(900.0)), x=(30,))
    text = emit_library([("large", large)], replace(ARM, stack_space=5))
    assert "addrspace(5)" in text and "addrspacecast" in text
    assert "addrspace" not in emit_library([("large", large)], ARM)
