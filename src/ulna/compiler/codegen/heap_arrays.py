"""Moves large local arrays of functions from the stack to the heap, since threads may have small stacks.

Each function with many of them has one piece of memory for as long as the code is loaded, and a byte that says whether
a call uses it. Calls that find it in use, by another thread, take memory from `malloc` until they return. Where it has
none, they try again until the other thread is done: a call that has begun cannot fail. Functions with such arrays
call neither themselves nor Python, so the other thread gets there.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

MOST_ON_STACK = 2**14
"""Size of local arrays up to which a function keeps them on the stack [byte]; threads of musl have 128 kB for all."""

_SMALL = 2**9  # bytes that stay on the stack in any function, with all numbers that become registers
_LINE = 64  # bytes in a cache line, and in the widest register
_SIZES = {"double": 8, "float": 4, "ptr": 8, "i64": 8, "i32": 4, "i8": 1}
_ARRAY = re.compile(
    r"^  (?P<name>%\S+) = alloca (?:\[(?P<items>\d+) x (?P<item>\w+)\]|(?:<(?P<lanes>\d+) x )?(?P<kind>\w+)>?)"
    r"(?:, i64 (?P<count>\d+))?(?:, align \d+)?$",
    re.MULTILINE,
)
_GLOBAL = re.compile(r'^@".*\.memory" = internal global \[(\d+) x i8\]', re.MULTILINE)
_RETURN = re.compile(r"^  ret ", re.MULTILINE)
_NAME = re.compile(r'@([\w.$-]+|"[^"]+")\(')

_MEMORY = f"""
declare noalias ptr @malloc(i64)
declare void @free(ptr)

; The function's own memory, or as much from malloc, with its address before it.
define internal noalias ptr @heap.take(ptr %used, ptr %own, i64 %size) noinline nounwind {{
entry:
  br label %try
try:
  %was = atomicrmw xchg ptr %used, i8 1 acquire
  %is.free = icmp eq i8 %was, 0
  br i1 %is.free, label %first, label %more
first:
  ret ptr %own
more:
  %room = add i64 %size, {2 * _LINE}
  %block = call ptr @malloc(i64 %room)
  %none = icmp eq ptr %block, null
  br i1 %none, label %try, label %made
made:
  %at = ptrtoint ptr %block to i64
  %beyond = add i64 %at, {2 * _LINE - 1}
  %aligned = and i64 %beyond, -{_LINE}
  %memory = inttoptr i64 %aligned to ptr
  %before = getelementptr i8, ptr %memory, i64 -8
  store ptr %block, ptr %before
  ret ptr %memory
}}

define internal void @heap.give(ptr %used, ptr %own, ptr %memory) noinline nounwind {{
entry:
  %is.own = icmp eq ptr %memory, %own
  br i1 %is.own, label %first, label %more
first:
  store atomic i8 0, ptr %used release, align 1
  ret void
more:
  %before = getelementptr i8, ptr %memory, i64 -8
  %block = load ptr, ptr %before
  call void @free(ptr %block)
  ret void
}}
"""


def with_arrays_on_heap(ir: str) -> str:
    """The module with local arrays on the heap in functions where they take more than `MOST_ON_STACK`.

    Args:
        ir: The text of an LLVM module for this processor.

    Returns:
        The text; the same if no function has so many.
    """
    if " = alloca " not in ir:
        return ir
    first, *others = f"\n{ir}".split("\ndefine ")  # much faster than a regular expression
    parts = [f"define {part}\n" for part in others]
    changed = [_changed(part) if " = alloca " in part else part for part in parts]
    return ir if changed == parts else "".join((f"{first}\n", *changed, _MEMORY))


def bytes_on_heap(ir: str) -> int:
    """The size of all arrays that `with_arrays_on_heap` puts there [byte]."""
    return sum(map(int, _GLOBAL.findall(with_arrays_on_heap(ir))))


def _changed(text: str) -> str:
    """A definition, and what follows it in the module, with its arrays on the heap if they are large."""
    sizes = {found: _size(found) for found in _ARRAY.finditer(text)}
    if sum(sizes.values()) <= MOST_ON_STACK:
        return text
    name = _NAME.search(text)
    assert name is not None
    own = name[1].strip('"')
    used, memory = f'@"{own}.used"', f'@"{own}.memory"'
    large = [found for found, size in sizes.items() if size > _SMALL]
    starts, total = _side_by_side([sizes[found] for found in large])
    end = text.index("\n}") + 3
    body, rest = text[:end], text[end:]
    for k, (found, start) in enumerate(zip(large, starts, strict=True)):
        lines = [f"  {found['name']} = getelementptr i8, ptr %heap.memory, i64 {start}"]
        if k == 0:
            taken = f"call align {_LINE} ptr @heap.take(ptr {used}, ptr {memory}, i64 {total})"
            lines.insert(0, f"  %heap.memory = {taken}")
        body = body.replace(found[0], "\n".join(lines), 1)
    given = f"  call void @heap.give(ptr {used}, ptr {memory}, ptr %heap.memory)\n  ret "
    body = body.replace(" {\n", ' "stackrealign" {\n', 1)  # spilled registers stay within a cache line
    fields = (
        f"{used} = internal global i8 0, align {_LINE}\n"
        f"{memory} = internal global [{total} x i8] zeroinitializer, align {_LINE}\n"
    )
    return fields + _RETURN.sub(lambda _: given, body) + rest


def _size(found: re.Match[str]) -> int:
    """The size of a local array [byte]; zero for types whose size does not matter here."""
    each = _SIZES.get(found["item"] or found["kind"], 0)
    return each * int(found["items"] or 1) * int(found["lanes"] or 1) * int(found["count"] or 1)


def _side_by_side(sizes: Sequence[int]) -> tuple[list[int], int]:
    """Where arrays begin that lie one after the other, each in a cache line of its own, and the size of all."""
    starts, end = [], 0
    for size in sizes:
        starts.append(end)
        end += -(-size // _LINE) * _LINE
    return starts, end
