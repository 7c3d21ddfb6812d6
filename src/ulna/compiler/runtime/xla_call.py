"""Compiled functions as handlers of XLA's foreign function interface."""

from __future__ import annotations

from ulna.compiler.codegen.xla_call import emit_xla_call
from ulna.compiler.language.function import Function
from ulna.compiler.runtime import jit
from ulna.compiler.runtime.array_call import ELEMENT


def load_xla_call(f: Function, dtype: str) -> tuple[int, jit.Code]:
    """The machine code of a handler, from the cache or from LLVM.

    Args:
        f: The function.
        dtype: Name of the type to compute in, "float64" or "float32".

    Returns:
        Its address, and the code, which must live as long as it may be called.
    """
    code = jit.load(f, emit_xla_call(f, jit.target(), ELEMENT[dtype]), ("xla",))
    return code.address("xla"), code
