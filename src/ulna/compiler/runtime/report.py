"""What a kernel costs: operations, machine code, stack, time to compile, and what limits its speed."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, final

from ulna.compiler.codegen.heap_arrays import bytes_on_heap
from ulna.compiler.language.ops import TABLE
from ulna.compiler.runtime import jit
from ulna.errors import InputError, TooLargeError

_INSTRUCTION_CACHE = 32 * 2**10
# Rough figures of one core of today's processors, per cycle.
_VECTOR_INSTRUCTIONS = 2.0
_BYTES_OF_MEMORY = 4.0
_BYTES_OF_CODE = 8.0  # beyond the instruction cache
_FRAMES = (r"^\s+sub[lq]?\s+\$(\d+), %[er]sp", r"^\s+sub\s+sp, sp, #(\d+)$")
_SPILLS = (r"^\s+v?mov\w*\s+%\w+, -?\d*\(%rsp\)", r"^\s+st[rp]u?\s+.*\[sp")


@final
@dataclass(frozen=True)
class KernelReport:
    """What one kernel costs, on this machine; `print` shows it as a table.

    Attributes:
        name: The kernel.
        signature: Shapes of its arguments and results.
        dtype: The type computed in.
        batch: Whether this is the loop over a batch; else the single call.
        lanes: How many samples, or numbers of one, an instruction computes.
        operations: Scalar operations for one sample; None for loops over joints whose function is not traced.
        counts: How often each of them occurs.
        code_bytes: Size of the machine code [byte].
        stack_bytes: Size of the largest stack frame [byte].
        heap_bytes: Size of the arrays of functions that would need much of the stack, and have them on the heap [byte].
        spills: How many instructions put a register on the stack; None where the processor's are not known.
        bytes_moved: Size of arguments and results of one sample [byte].
        compile_seconds: How long LLVM takes to compile it [s].
        cache: "stored", "not stored" or "off": whether the code is in the disk cache.
        limit: What probably takes most of the time: "arithmetic", "memory" (of a large batch) or "code" (that does not
            fit the instruction cache). An estimate from these counts and rough figures of processors.
    """

    name: str
    signature: str
    dtype: str
    batch: bool
    lanes: int
    operations: int | None
    counts: Mapping[str, int]
    code_bytes: int
    stack_bytes: int
    heap_bytes: int
    spills: int | None
    bytes_moved: int
    compile_seconds: float
    cache: str
    limit: str

    @property
    def intensity(self) -> float | None:
        """Operations for each byte moved [1/byte]."""
        return None if self.operations is None else self.operations / max(self.bytes_moved, 1)

    def __str__(self) -> str:
        kinds = ", ".join(
            f"{count} {name}" for name, count in sorted(self.counts.items(), key=lambda c: -c[1])
        )
        rows = {
            "operations": "a loop over joints"
            if self.operations is None
            else f"{self.operations:,} ({kinds})",
            "code": f"{self.code_bytes:,} bytes",
            "stack": f"{self.stack_bytes:,} bytes"
            + ("" if self.spills is None else f", {self.spills:,} spills"),
            "heap": f"{self.heap_bytes:,} bytes",
            "moved": f"{self.bytes_moved:,} bytes a sample",
            "compiled in": f"{self.compile_seconds * 1e3:,.0f} ms",
            "cache": self.cache,
            "limit": f"{self.limit} (estimate)",
        }
        what = f"batch, {self.lanes} samples at once" if self.batch else "single call"
        lines = [f"{self.name}{self.signature}, {self.dtype}, {what}"]
        return "\n".join([*lines, *(f"  {title:<12} {text}" for title, text in rows.items())])


def report(kernel: Any, batch: bool = False) -> KernelReport:
    """What a kernel costs.

    Args:
        kernel: The kernel.
        batch: Whether the loop over a batch is meant; else the single call.

    Returns:
        The report.

    Raises:
        InputError: If the kernel has no machine code, because it has no outputs or an axis of length 0.
    """
    call = kernel._array_call
    if call.interpreted and (batch or not call.function.outputs):
        raise InputError(f"`{call.function.name}` has no outputs or an axis of length 0; it is not compiled.")
    counts, operations = _operations(kernel)
    ir = kernel.ir(batch)
    code = jit.examined(call.function, ir)
    ports = (*call.function.inputs, *call.function.outputs)
    moved = sum(port.size for port in ports) * call.dtype.itemsize
    lanes = jit.target().lanes(call.element) if batch else 1
    return KernelReport(
        name=call.function.name,
        signature=kernel.signature,
        dtype=call.dtype.name,
        batch=batch,
        lanes=lanes,
        operations=operations,
        counts=counts,
        code_bytes=code.size,
        stack_bytes=max(_numbers(_FRAMES, code.assembly), default=0),
        heap_bytes=bytes_on_heap(ir),
        spills=_spills(code.assembly),
        bytes_moved=moved,
        compile_seconds=code.seconds,
        cache=code.cache,
        limit=_limit(counts, lanes, code.size, moved if batch else 0),
    )


def _operations(kernel: Any) -> tuple[dict[str, int], int | None]:
    """By kind, and all; a kernel that loops over joints has no graph to count in, another one too large a graph."""
    try:
        return kernel.operation_counts, kernel.operations
    except (InputError, TooLargeError):
        return {}, None


def _limit(counts: Mapping[str, int], lanes: int, code: int, moved: int) -> str:
    """What takes most cycles of one sample."""
    costs = {row.op.name.lower(): row.cost for row in TABLE}
    cycles = {
        "arithmetic": sum(costs[kind] * n for kind, n in counts.items()) / lanes / _VECTOR_INSTRUCTIONS,
        "memory": moved / _BYTES_OF_MEMORY,
        "code": (code / lanes / _BYTES_OF_CODE) if code > _INSTRUCTION_CACHE else 0.0,
    }
    return max(cycles, key=cycles.__getitem__)


def _numbers(patterns: tuple[str, ...], text: str) -> list[int]:
    return [int(number) for pattern in patterns for number in re.findall(pattern, text, re.MULTILINE)]


def _spills(text: str) -> int | None:
    """How many instructions put a register on the stack, on x86-64 and 64-bit Arm."""
    if not jit.target().triple.startswith(("x86_64", "amd64", "aarch64", "arm64")):
        return None
    return sum(len(re.findall(pattern, text, re.MULTILINE)) for pattern in _SPILLS)
