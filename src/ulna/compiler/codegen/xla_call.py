"""Writes the function that XLA calls: buffers from its call frame go to the loop over a batch.

The structures are those of XLA's C interface for foreign functions (xla/ffi/api/c_api.h), which only
ever grow at their ends.
"""

from __future__ import annotations

from ulna.compiler.codegen.instructions import Instructions
from ulna.compiler.codegen.ir_text import BYTES, DType
from ulna.compiler.codegen.module import emit_batch
from ulna.compiler.codegen.target import Target
from ulna.compiler.language.function import Function

VERSION = (0, 1)
"""The first version of the interface that asks for one; later ones accept it."""

# Offsets in bytes: of the call frame, of its lists of arguments and results, of a buffer, of the extension by which
# XLA asks for the version of the interface, and of its metadata.
_EXTENSION, _ARGUMENTS, _RESULTS, _ITEMS = 8, 40, 80, 32
_DATA, _RANK, _LENGTHS = 24, 32, 40
_TYPE, _NEXT, _METADATA, _MAJOR, _MINOR = 8, 16, 24, 24, 28
_METADATA_QUERY = 1


def emit_xla_call(f: Function, target: Target, element: DType = "double") -> str:
    """IR of `ptr xla(ptr frame)`, a handler of XLA's foreign function interface on the CPU.

    All buffers are row-major and have the same leading axes; their last axes are those of the ports. Whoever makes the
    call takes care of it; nothing is checked here.

    Args:
        f: The function.
        target: The processor to write for.
        element: Type of the array elements, "double" or "float".

    Returns:
        The text of an LLVM module.
    """
    w = Instructions()
    w.begin_function("define ptr @xla(ptr %frame)")
    extension = w.field("extension", "%frame", _EXTENSION)
    w.branch(w.let("runs", f"icmp eq ptr {extension}, null"), "run", "extended")
    _answer(w)
    w.open_block("run")
    _evaluate(w, f, element)
    w.write("ret ptr null")
    w.end_function()
    return emit_batch(f, target, element) + w.text()


def _answer(w: Instructions) -> None:
    """Writes the version of the interface, where XLA asks for it."""
    w.open_block("extended")
    kind = w.field("kind", "%extension", _TYPE, "i32")
    w.branch(w.let("asked", f"icmp eq i32 {kind}, {_METADATA_QUERY}"), "answer", "run")
    w.open_block("answer")
    metadata = w.field("metadata", "%extension", _METADATA)
    # The version is a structure inside the metadata, after its size.
    for name, offset, value in (("major", _MAJOR, VERSION[0]), ("minor", _MINOR, VERSION[1])):
        place = w.let(name, f"getelementptr i8, ptr {metadata}, i64 {offset}")
        w.write(f"store i32 {value}, ptr {place}")
    w.write("ret ptr null")


def _evaluate(w: Instructions, f: Function, element: DType) -> None:
    """Calls the loop over the batch with the addresses of the buffers."""
    ports = [*f.inputs, *f.outputs]
    axes = sum(len(p.shape) for p in ports)
    w.let("data", f"alloca ptr, i64 {len(ports)}")
    w.let("steps", f"alloca i64, i64 {len(ports) + axes}")
    w.let("count", f"alloca i64, i64 {1 + axes}")
    inputs = w.field("inputs", "%frame", _ARGUMENTS + _ITEMS)
    outputs = w.field("outputs", "%frame", _RESULTS + _ITEMS)
    inner = len(ports)
    for k, port in enumerate(ports):
        number = k - len(f.inputs)
        buffer = w.item(f"b{k}", inputs if number < 0 else outputs, k if number < 0 else number)
        address = w.field(f"a{k}", buffer, _DATA)
        _put(w, f"data{k}", "ptr", "%data", k, address)
        _put(w, f"step{k}", "i64", "%steps", k, BYTES[element] * port.size)
        stride = BYTES[element] * port.size
        for axis, length in enumerate(port.shape):
            stride //= length
            _put(w, f"stride{k}.{axis}", "i64", "%steps", inner + axis, stride)
        inner += len(port.shape)
    _count_samples(w, f"%b{len(f.inputs)}", len(f.outputs[0].shape))
    w.write("store i64 %samples, ptr %count")
    w.write("call void @batch(ptr %data, ptr %count, ptr %steps, ptr null)")


def _put(w: Instructions, name: str, kind: str, base: str, index: int, value: object) -> None:
    place = w.let(name, f"getelementptr {kind}, ptr {base}, i64 {index}")
    w.write(f"store {kind} {value}, ptr {place}")


def _count_samples(w: Instructions, buffer: str, core: int) -> None:
    """The product of all lengths of a buffer but those of its last `core` axes, as %samples."""
    rank = w.field("rank", buffer, _RANK, "i64")
    lengths = w.field("lengths", buffer, _LENGTHS)
    w.let("leading", f"sub i64 {rank}, {core}")
    w.jump("axis")
    w.open_block("axis")
    w.let("k", "phi i64 [ 0, %run ], [ %k1, %multiply ]")
    w.let("samples", "phi i64 [ 1, %run ], [ %product, %multiply ]")
    w.branch(w.let("more", "icmp slt i64 %k, %leading"), "multiply", "counted")
    w.open_block("multiply")
    w.let("length.p", f"getelementptr i64, ptr {lengths}, i64 %k")
    w.let("length", "load i64, ptr %length.p")
    w.let("product", "mul i64 %samples, %length")
    w.let("k1", "add i64 %k, 1")
    w.jump("axis")
    w.open_block("counted")
