"""Compile one IR function of floats for this processor, for tests: NumPy arrays in, NumPy arrays out."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

import llvmlite.binding as llvm
import numpy as np
import pytest

from ulna.compiler.codegen.ir_text import DType, IRFunction, Lanes

mpmath = pytest.importorskip("mpmath")
llvm.initialize_native_target()
llvm.initialize_native_asmprinter()

NUMPY = {"double": np.float64, "float": np.float32}
DIGITS = {
    "double": (53, -1074),
    "float": (24, -149),
}  # bits of the significand, exponent of the least denormal


def module_text(*functions: IRFunction) -> str:
    """The functions and all they need, each text once, in the order of first use."""
    parts: dict[str, None] = {}
    for function in functions:
        parts.update(dict.fromkeys((*function.declarations, function.text)))
    return "\n".join(parts) + "\n"


def compiled(
    function: IRFunction, lanes: int, dtype: DType, arguments: int = 1, results: int = 1
) -> Callable[..., tuple[np.ndarray, ...]]:
    """The function over arrays of any length; the last block is filled up with ones."""
    kind = Lanes(lanes, dtype)
    returned = kind.real if results == 1 else kind.pair
    names = [f"in{k}" for k in range(arguments)] + [f"out{k}" for k in range(results)]
    lines = [
        f"define void @run({', '.join(f'ptr %{n}' for n in names)}, i64 %n) {{",
        "entry:",
        "  br label %loop",
    ]
    lines += ["loop:", "  %i = phi i64 [ 0, %entry ], [ %j, %loop ]"]
    lines += [f"  %{n}.p = getelementptr {dtype}, ptr %{n}, i64 %i" for n in names]
    lines += [f"  %x{k} = load {kind.real}, ptr %in{k}.p, align 4" for k in range(arguments)]
    call = ", ".join(f"{kind.real} %x{k}" for k in range(arguments))
    lines.append(f"  %r = call {returned} @{function.name}({call})")
    for k in range(results):
        value = "%r"
        if results > 1:
            value = f"%r{k}"
            lines.append(f"  {value} = extractvalue {returned} %r, {k}")
        lines.append(f"  store {kind.real} {value}, ptr %out{k}.p, align 4")
    lines += [f"  %j = add i64 %i, {lanes}", "  %more = icmp slt i64 %j, %n"]
    lines += ["  br i1 %more, label %loop, label %out", "out:", "  ret void", "}"]

    module = llvm.parse_assembly(module_text(function) + "\n".join(lines))
    module.verify()
    machine = llvm.Target.from_default_triple().create_target_machine(
        cpu=llvm.get_host_cpu_name(), features=llvm.get_host_cpu_features().flatten(), opt=1, jit=True
    )
    options = llvm.create_pipeline_tuning_options(speed_level=1)
    options.slp_vectorization = options.loop_vectorization = False
    builder = llvm.create_pass_builder(machine, options)
    builder.getModulePassManager().run(module, builder)
    engine = llvm.create_mcjit_compiler(module, machine)
    engine.finalize_object()
    pointers = [ctypes.c_void_p] * (arguments + results)
    run = ctypes.CFUNCTYPE(None, *pointers, ctypes.c_int64)(engine.get_function_address("run"))

    def apply(*inputs: np.ndarray) -> tuple[np.ndarray, ...]:
        size = len(inputs[0])
        padded = -(-size // lanes) * lanes
        blocks = []
        for given in inputs:
            block = np.ones(padded, NUMPY[dtype])
            block[:size] = given
            blocks.append(block)
        outputs = [np.empty(padded, NUMPY[dtype]) for _ in range(results)]
        assert engine  # the code lives as long as this closure
        run(*(b.ctypes.data for b in (*blocks, *outputs)), padded)
        return tuple(o[:size] for o in outputs)

    return apply


def worst_ulp(got: np.ndarray, exact: Callable[..., Any], dtype: DType, *arguments: np.ndarray) -> float:
    """The largest error [ULP] against a function of mpmath numbers; zero must be zero."""
    bits, least = DIGITS[dtype]
    worst = 0.0
    for value, *given in zip(got, *arguments, strict=True):
        reference = exact(*(mpmath.mpf(float(x)) for x in given))
        if reference == 0:
            assert value == 0.0
            continue
        ulp = mpmath.ldexp(1, max(mpmath.frexp(reference)[1] - bits, least))
        worst = max(worst, float(abs(mpmath.mpf(float(value)) - reference) / ulp))
    return worst


def worst_ulp_extended(got: np.ndarray, exact: np.ndarray, dtype: DType) -> float:
    """The same against an array of higher precision than `dtype`."""
    spacing = np.spacing(np.abs(exact).astype(NUMPY[dtype]))
    return float(np.max(np.abs((got.astype(exact.dtype) - exact) / spacing)))
