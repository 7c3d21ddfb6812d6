"""Functions as PTX, the assembly text of NVIDIA GPUs, and the same code on the CPU."""

from __future__ import annotations

import ctypes
import re
from collections.abc import Sequence
from typing import Any

import numpy as np

from ulna.compiler.codegen.gpu_kernel import emit_kernels, emit_on_cpu
from ulna.compiler.codegen.ir_text import DType
from ulna.compiler.codegen.target import Target
from ulna.compiler.language.function import Function
from ulna.compiler.runtime import jit
from ulna.compiler.runtime.array_call import ELEMENT
from ulna.compiler.runtime.cross_compile import cross_compile
from ulna.errors import InputError, UnknownName

ARCHITECTURES = ("sm_75", "sm_80", "sm_86", "sm_89", "sm_90", "sm_100", "sm_120")
"""GPUs that PTX is written for, from Turing to Blackwell; text for one runs on all later ones."""


def gpu_target(architecture: str = "sm_75") -> Target:
    """The target record of a GPU.

    Args:
        architecture: One of `ARCHITECTURES`.

    Returns:
        The target: one sample for each thread, one lane.

    Raises:
        UnknownName: For another architecture.
    """
    if architecture not in ARCHITECTURES:
        raise UnknownName("GPU architecture", architecture, ARCHITECTURES)
    return Target(
        triple="nvptx64-nvidia-cuda",
        cpu=architecture,
        features="",  # LLVM then takes the oldest version of PTX that knows the GPU
        llvm="",
        register_bytes=8,
        packed_sines=1,
        search_lanes=1,
    )


def ptx(functions: Sequence[tuple[str, Function]], dtype: Any, architecture: str = "sm_75") -> str:
    """The PTX of a kernel for each function; see `ulna.compiler.codegen.gpu_kernel.emit_kernels`.

    Args:
        functions: Pairs of a name and a function; names are identifiers.
        dtype: The type to compute in, float64 or float32.
        architecture: One of `ARCHITECTURES`.

    Returns:
        The text.

    Raises:
        InputError: If a function evaluates one sample in several lanes.
        UnknownName: For another architecture.
        CompileError: If LLVM generates no code.
    """
    target, element = gpu_target(architecture), ELEMENT[np.dtype(dtype).name]
    for name, f in functions:
        if f.lanes > 1:
            raise InputError(
                f"{name} evaluates one sample in {f.lanes} lanes; expected one, as for a thread."
            )
    has_loops = any(f.has_loops for _, f in functions)
    text = cross_compile(emit_kernels(functions, target, element), target, has_loops, "assembly").decode()
    return _without_comments(text)


def _without_comments(text: str) -> str:
    return re.sub(r"[ \t]*//[^\n]*", "", text).lstrip("\n")


def run_on_cpu(f: Function, arrays: Sequence[Any], dtype: Any, rows: bool = True) -> tuple[Any, ...]:
    """Runs the code of a GPU's threads on the CPU, one after the other: how it is tested without a GPU.

    Args:
        f: The function.
        arrays: An array for each input, (..., n), with leading axes that broadcast.
        dtype: The type to compute in, float64 or float32.
        rows: Whether the samples of the results lie row after row in memory; else number after number.

    Returns:
        An array for each output.
    """
    element: DType = ELEMENT[np.dtype(dtype).name]
    converted = [np.asarray(x, dtype) for x in arrays]
    batch = np.broadcast_shapes(
        *(x.shape[: x.ndim - len(p.shape)] for x, p in zip(converted, f.inputs, strict=True))
    )
    count = int(np.prod(batch, dtype=int))
    flat = [
        np.broadcast_to(x, batch + p.shape).reshape(count, p.size)
        for x, p in zip(converted, f.inputs, strict=True)
    ]
    results = [np.full((count, p.size) if rows else (p.size, count), np.nan, dtype) for p in f.outputs]
    named = [*flat, *(r if rows else r.T for r in results)]
    code = jit.load(f, emit_on_cpu([("f", f)], gpu_target(), element), ("f.all",))
    call = ctypes.CFUNCTYPE(
        None, ctypes.c_int64, *[ctypes.c_void_p, ctypes.c_int64, ctypes.c_int64] * len(named)
    )
    size = np.dtype(dtype).itemsize
    words = [w for x in named for w in (x.ctypes.data, x.strides[0] // size, x.strides[1] // size)]
    call(code.address("f.all"))(count, *words)
    output_arrays = named[len(flat) :]
    return tuple(x.reshape(batch + p.shape) for x, p in zip(output_arrays, f.outputs, strict=True))
