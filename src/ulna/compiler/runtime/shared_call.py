"""Calls of a large batch whose arrays machine code examines: a batch begins before Python could look at them.

After a large batch the processor's caches hold its rows; the Python code that examines arrays is then fetched anew,
which takes 0.1 to 0.2 ms. This code takes the plain case: arrays of the very type, of one axis more than a sample, or
inputs of one sample.
"""

from __future__ import annotations

import ctypes
from array import array
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any, final

import numpy as np

from ulna.compiler.codegen.shared_batch import APART, SHARE_IR, WORDS, word_type
from ulna.compiler.language.ports import Port
from ulna.compiler.runtime import jit
from ulna.compiler.runtime.batch_helpers import helpers
from ulna.compiler.runtime.fast_call import load_at
from ulna.compiler.runtime.object_layout import (
    ALIGNED,
    ARRAY_DESCRIPTOR,
    DATA,
    FLAGS,
    LENGTHS,
    MAY_WRITE,
    NDIM,
    STEPS,
    TUPLE_ITEMS,
    TYPE,
    c_function,
    fast_call_works,
)

MOST_THREADS = 256
"""Beyond so many their numbers would take much of the stack."""

PLAN = (
    "loop",
    "arrays",
    "inputs",
    "block",
    "inner",
    "kind",
    "descriptor",
    "bytes",
    "ports",
    "detach",
    "attach",
)
"""Words that describe a kernel: NumPy's inner loop, how many arrays and inputs there are, rows in a block, axes of all
samples together, the type of arrays and of numbers, the bytes of a number, a table of ports, and CPython's functions
that let go of the interpreter's lock and take it."""
_PORT = 3  # words: how many axes a sample has, where their lengths are, how many axes the ports before have


def _load(base: str, *names: str) -> str:
    pointers = {"loop", "kind", "descriptor", "ports", "detach", "attach"}
    return "\n".join(
        f"  %{name}.p = getelementptr i64, ptr %{base}, i64 {PLAN.index(name)}\n"
        f"  %{name} = load {'ptr' if name in pointers else 'i64'}, ptr %{name}.p"
        for name in names
    )


def _put(table: str, index: str, value: str, kind: str = "i64") -> str:
    """Lines that store a word of a table."""
    place = f"%{table}.{index}.to"
    return f"  {place} = getelementptr i64, ptr %{table}, i64 %{index}\n  store {kind} %{value}, ptr {place}"


_CALL = f"""
; Examines the arrays in a tuple, inputs first, and computes their batch; 0 where they are not the plain case.
define i64 @call(ptr %plan, ptr %tuple, ptr %boxes, i64 %count) nounwind {{
entry:
{_load("plan", *PLAN)}
  %items = getelementptr i8, ptr %tuple, i64 {TUPLE_ITEMS}
  %threads = add i64 %count, 1
  %all.steps = add i64 %arrays, %inner
  %all.next = mul i64 %threads, {APART}
  %data = alloca i64, i64 %arrays
  %steps = alloca i64, i64 %all.steps
  %low = alloca i64, i64 %arrays
  %high = alloca i64, i64 %arrays
  %ends = alloca i64, i64 %threads
  %next = alloca i64, i64 %all.next
  %batch = alloca i64, i64 {len(WORDS)}
  %inner.steps = getelementptr i64, ptr %steps, i64 %arrays
  br label %array
array:  ; outputs first: they have the axis of the batch for sure
  %left = phi i64 [ %arrays, %entry ], [ %k, %array.done ]
  %rows = phi i64 [ -1, %entry ], [ %rows.now, %array.done ]
  %k = add i64 %left, -1
  %object.p = getelementptr ptr, ptr %items, i64 %k
  %object = load ptr, ptr %object.p
{load_at("object.kind", "object", TYPE)}
  %is.array = icmp eq ptr %object.kind, %kind
  br i1 %is.array, label %fields, label %refused
fields:
{load_at("object.descriptor", "object", ARRAY_DESCRIPTOR)}
{load_at("flags", "object", FLAGS, "i32")}
{load_at("ndim.32", "object", NDIM, "i32")}
{load_at("lengths", "object", LENGTHS)}
{load_at("strides", "object", STEPS)}
{load_at("address", "object", DATA, "i64")}
  %port.at = mul i64 %k, {_PORT}
  %port = getelementptr i64, ptr %ports, i64 %port.at
{load_at("axes", "port", 0, "i64")}
{load_at("wanted", "port", 8)}
{load_at("first", "port", 16, "i64")}
  %is.input = icmp slt i64 %k, %inputs
  %flags.wanted = select i1 %is.input, i32 {ALIGNED}, i32 {ALIGNED | MAY_WRITE}
  %flags.got = and i32 %flags, %flags.wanted
  %flags.ok = icmp eq i32 %flags.got, %flags.wanted
  %descriptor.ok = icmp eq ptr %object.descriptor, %descriptor
  %ndim = sext i32 %ndim.32 to i64
  %lead = sub i64 %ndim, %axes
  %is.batch = icmp eq i64 %lead, 1
  %is.one = icmp eq i64 %lead, 0
  %is.shared = and i1 %is.one, %is.input
  %lead.ok = or i1 %is.batch, %is.shared
  %two.ok = and i1 %flags.ok, %descriptor.ok
  %three.ok = and i1 %two.ok, %lead.ok
  br i1 %three.ok, label %place, label %refused
place:
  %above = add i64 %address, %bytes
  br i1 %is.batch, label %own.rows, label %core
own.rows:
  %rows.own = load i64, ptr %lengths
  %is.first = icmp eq i64 %rows, -1
  %is.equal = icmp eq i64 %rows, %rows.own
  %rows.ok = or i1 %is.first, %is.equal
  %some = icmp sgt i64 %rows.own, 0
  %rows.fit = and i1 %rows.ok, %some
  %step.own = load i64, ptr %strides
  %rows.less = add i64 %rows.own, -1
  %span = mul i64 %rows.less, %step.own
  br i1 %rows.fit, label %core, label %refused
core:
  %rows.now = phi i64 [ %rows, %place ], [ %rows.own, %own.rows ]
  %step = phi i64 [ 0, %place ], [ %step.own, %own.rows ]
  %reach = phi i64 [ 0, %place ], [ %span, %own.rows ]
  br label %axis
axis:
  %j = phi i64 [ 0, %core ], [ %j1, %axis.next ]
  %length.last = phi i64 [ %reach, %core ], [ %reach.j, %axis.next ]
  %low.before = phi i64 [ %address, %core ], [ %low.now, %axis.next ]
  %high.before = phi i64 [ %above, %core ], [ %high.now, %axis.next ]
  %down = call i64 @llvm.smin.i64(i64 %length.last, i64 0)
  %up = call i64 @llvm.smax.i64(i64 %length.last, i64 0)
  %low.now = add i64 %low.before, %down
  %high.now = add i64 %high.before, %up
  %axis.more = icmp slt i64 %j, %axes
  br i1 %axis.more, label %axis.check, label %array.done
axis.check:
  %place.j = add i64 %j, %lead
  %length.p = getelementptr i64, ptr %lengths, i64 %place.j
  %length = load i64, ptr %length.p
  %stride.p = getelementptr i64, ptr %strides, i64 %place.j
  %stride = load i64, ptr %stride.p
  %wanted.p2 = getelementptr i64, ptr %wanted, i64 %j
  %length.wanted = load i64, ptr %wanted.p2
  %length.ok = icmp eq i64 %length, %length.wanted
  br i1 %length.ok, label %axis.next, label %refused
axis.next:
  %inner.k = add i64 %first, %j
{_put("inner.steps", "inner.k", "stride")}
  %length.less = add i64 %length, -1
  %reach.j = mul i64 %length.less, %stride
  %j1 = add i64 %j, 1
  br label %axis
array.done:
{_put("data", "k", "address")}
{_put("steps", "k", "step")}
{_put("low", "k", "low.now")}
{_put("high", "k", "high.now")}
  %is.last = icmp eq i64 %k, 0
  br i1 %is.last, label %output, label %array
output:  ; none may lie where an input does
  %o = phi i64 [ %inputs, %array.done ], [ %o1, %apart ]
  %o.low.p = getelementptr i64, ptr %low, i64 %o
  %o.high.p = getelementptr i64, ptr %high, i64 %o
  %o.low = load i64, ptr %o.low.p
  %o.high = load i64, ptr %o.high.p
  br label %input
input:
  %i = phi i64 [ 0, %output ], [ %i1, %input.next ]
  %i.more = icmp slt i64 %i, %inputs
  br i1 %i.more, label %compare, label %apart
compare:
  %i.low.p = getelementptr i64, ptr %low, i64 %i
  %i.high.p = getelementptr i64, ptr %high, i64 %i
  %i.low = load i64, ptr %i.low.p
  %i.high = load i64, ptr %i.high.p
  %begins = icmp slt i64 %o.low, %i.high
  %goes.on = icmp slt i64 %i.low, %o.high
  %overlap = and i1 %begins, %goes.on
  br i1 %overlap, label %refused, label %input.next
input.next:
  %i1 = add i64 %i, 1
  br label %input
apart:
  %o1 = add i64 %o, 1
  %o.more = icmp slt i64 %o1, %arrays
  br i1 %o.more, label %output, label %range
range:
  %t = phi i64 [ 0, %apart ], [ %t1, %range ]
  %begin = phi i64 [ 0, %apart ], [ %end, %range ]
  %next.t = mul i64 %t, {APART}
{_put("next", "next.t", "begin")}
  %t1 = add i64 %t, 1
  %part = mul i64 %rows.now, %t1
  %even = udiv i64 %part, %threads
  %blocks = udiv i64 %even, %block
  %rounded = mul i64 %blocks, %block
  %is.end = icmp eq i64 %t1, %threads
  %end = select i1 %is.end, i64 %rows.now, i64 %rounded
{_put("ends", "t", "end")}
  br i1 %is.end, label %compute, label %range
compute:
{{stores}}
  %state = call ptr %detach()
  call void @run(ptr %batch, ptr %boxes, i64 %count)
  call void %attach(ptr %state)
  ret i64 1
refused:
  ret i64 0
}}
declare i64 @llvm.smin.i64(i64, i64)
declare i64 @llvm.smax.i64(i64, i64)
""".replace(
    "{stores}",
    "\n".join(
        f"  %batch.{name} = getelementptr i64, ptr %batch, i64 {k}\n"
        f"  store {word_type(name)} %{name}, ptr %batch.{name}"
        for k, name in enumerate(WORDS)
    ),
)


@final
class SharedCall:
    """Computes plain batches of one kernel in threads.

    Args:
        loop: Address of NumPy's inner loop (see `module.emit_batch`), whose code must outlive this object.
        inputs: The inputs.
        outputs: The outputs.
        dtype: The type of numbers.
        block: How many rows a thread takes at a time.
    """

    def __init__(
        self, loop: int, inputs: Sequence[Port], outputs: Sequence[Port], dtype: np.dtype[Any], block: int
    ) -> None:
        ports = [*inputs, *outputs]
        lengths = [array("q", port.shape or (0,)) for port in ports]
        first = [sum(len(port.shape) for port in ports[:k]) for k in range(len(ports) + 1)]
        rows = zip(ports, lengths, first, strict=False)
        table = array("q", [word for p, n, at in rows for word in (len(p.shape), n.buffer_info()[0], at)])
        words = {
            "loop": loop,
            "arrays": len(ports),
            "inputs": len(inputs),
            "block": block,
            "inner": first[-1],
            "kind": id(np.ndarray),
            "descriptor": id(dtype),
            "bytes": dtype.itemsize,
            "ports": table.buffer_info()[0],
            "detach": c_function("PyEval_SaveThread"),
            "attach": c_function("PyEval_RestoreThread"),
        }
        plan = array("q", [words[name] for name in PLAN])
        self._plan, self._references = plan.buffer_info()[0], (plan, table, lengths, dtype)
        self._call = _function()

    def __call__(self, arrays: tuple[Any, ...], threads: int) -> bool:
        """Computes a batch.

        Args:
            arrays: As many arrays as inputs, then as many as outputs.
            threads: How many threads share the rows at most.

        Returns:
            Whether it was computed: not where an array is none of exactly the type, of the shape of a sample or, as all
            outputs, of one axis more, or where an output shares memory with an input.
        """
        if threads > MOST_THREADS:
            return False
        call, plan = self._call, self._plan
        return helpers.compute(threads - 1, lambda boxes, count: call(plan, arrays, boxes, count) == 1)


def shared_call(
    loop: int, inputs: Sequence[Port], outputs: Sequence[Port], dtype: np.dtype[Any], block: int
) -> SharedCall | None:
    """Makes a `SharedCall`; None where arrays do not lie in memory as machine code expects.

    Args:
        loop: See `SharedCall`.
        inputs: See `SharedCall`.
        outputs: See `SharedCall`.
        dtype: See `SharedCall`.
        block: See `SharedCall`.

    Returns:
        What computes plain batches, or None.
    """
    return SharedCall(loop, inputs, outputs, dtype, block) if fast_call_works() else None


@cache
def _function() -> Callable[[int, tuple[Any, ...], int, int], int]:
    """The machine code, which lets go of the interpreter's lock itself."""
    made = jit.load_text(SHARE_IR + _CALL, ("call",), has_loops=False)
    kind = ctypes.PYFUNCTYPE(
        ctypes.c_ssize_t, ctypes.c_void_p, ctypes.py_object, ctypes.c_void_p, ctypes.c_ssize_t
    )
    function = kind(made.address("call"))

    def call(plan: int, arrays: tuple[Any, ...], boxes: int, count: int) -> int:
        assert made is not None  # lives as long as the function
        return function(plan, arrays, boxes, count)

    return call
