"""Generated LLVM IR in which every load and store is checked against the memory that it may touch.

`instrumented` puts a call before each load and store. It compares address, size and alignment with a table of areas:
those that the test opened (arguments, results), the constants of the module, and what `alloca` made in functions that
have not returned. An access that lies in no area is counted and goes to a spare place instead, so nothing crashes.
"""

from __future__ import annotations

import ctypes
import re
from collections.abc import Iterable

import numpy as np

from ulna.compiler.runtime import jit

READ, WRITE = 1, 2
MOST = 1 << 14  # areas
_GAP = 128  # bytes after what alloca makes
_BITS = {"double": 64, "float": 32, "ptr": 64}
_KIND = r"(<\d+ x \w+>|\w+)"
_LOAD = re.compile(rf"  (%\S+) = load {_KIND}, ptr (\S+?)(?:, align (\d+))?$")
_STORE = re.compile(rf"  store {_KIND} (.+), ptr (\S+?)(?:, align (\d+))?$")
_ALLOCA = re.compile(rf"  (%\S+) = alloca {_KIND}(?:, i64 (\d+))?$")
_CONSTANT = re.compile(r"(@\S+) = .*\bconstant \[(\d+) x (\w+)\] ")
_OTHER = re.compile(
    r"(%\S+ = )?(load|store|alloca|atomicrmw|cmpxchg|va_arg)\b|.*\bcall\b.*@llvm\.(mem|masked|vp)"
)

_CHECK = f"""
@areas = internal global [{3 * MOST} x i64] zeroinitializer
@count = internal global i64 0
@faults = internal global [5 x i64] zeroinitializer
@spare = internal global [4096 x i8] zeroinitializer, align 4096

define ptr @areas.at() {{
  ret ptr @areas
}}
define ptr @count.at() {{
  ret ptr @count
}}
define ptr @faults.at() {{
  ret ptr @faults
}}
; Appends an area: its first address, the address after its last, and the rights.
define internal void @opened(ptr %p, i64 %size, i64 %rights) noinline {{
entry:
  %n = load i64, ptr @count
  %k = mul i64 %n, 3
  %a = getelementptr i64, ptr @areas, i64 %k
  %start = ptrtoint ptr %p to i64
  store i64 %start, ptr %a
  %b = getelementptr i64, ptr %a, i64 1
  %end = add i64 %start, %size
  store i64 %end, ptr %b
  %c = getelementptr i64, ptr %a, i64 2
  store i64 %rights, ptr %c
  %m = add i64 %n, 1
  store i64 %m, ptr @count
  ret void
}}
; Takes the last areas away.
define internal void @closed(i64 %number) noinline {{
entry:
  %n = load i64, ptr @count
  %m = sub i64 %n, %number
  store i64 %m, ptr @count
  ret void
}}
; The pointer, or a spare place where one area does not hold all of what is accessed; such accesses are counted.
define internal ptr @checked(ptr %p, i64 %site, i64 %size, i64 %align, i64 %right) noinline {{
entry:
  %start = ptrtoint ptr %p to i64
  %end = add i64 %start, %size
  %low = sub i64 %align, 1
  %odd = and i64 %start, %low
  %even = icmp eq i64 %odd, 0
  %n = load i64, ptr @count
  br i1 %even, label %next, label %fault
next:
  %k = phi i64 [ %n, %entry ], [ %j, %look ]
  %more = icmp ugt i64 %k, 0
  br i1 %more, label %look, label %fault
look:
  %j = sub i64 %k, 1
  %at = mul i64 %j, 3
  %a = getelementptr i64, ptr @areas, i64 %at
  %from = load i64, ptr %a
  %b = getelementptr i64, ptr %a, i64 1
  %to = load i64, ptr %b
  %c = getelementptr i64, ptr %a, i64 2
  %rights = load i64, ptr %c
  %left = icmp uge i64 %start, %from
  %within = icmp ule i64 %end, %to
  %granted = and i64 %rights, %right
  %may = icmp ne i64 %granted, 0
  %both = and i1 %left, %within
  %good = and i1 %both, %may
  br i1 %good, label %fine, label %next
fine:
  ret ptr %p
fault:
  %f = load i64, ptr @faults
  %g = add i64 %f, 1
  store i64 %g, ptr @faults
  %first = icmp eq i64 %f, 0
  br i1 %first, label %note, label %spared
note:
  %q1 = getelementptr i64, ptr @faults, i64 1
  store i64 %site, ptr %q1
  %q2 = getelementptr i64, ptr @faults, i64 2
  store i64 %start, ptr %q2
  %q3 = getelementptr i64, ptr @faults, i64 3
  store i64 %size, ptr %q3
  %q4 = getelementptr i64, ptr @faults, i64 4
  store i64 %right, ptr %q4
  br label %spared
spared:
  ret ptr @spare
}}
"""


def _bytes(kind: str) -> int:
    """The size of a type, as it lies in memory [byte]."""
    vector = re.fullmatch(r"<(\d+) x (\w+)>", kind)
    count, element = (int(vector[1]), vector[2]) if vector else (1, kind)
    bits = _BITS[element] if element in _BITS else int(element.removeprefix("i"))
    return -(-count * bits // 8)


def _natural(kind: str) -> int:
    """The alignment of a type where none is written [byte]: a power of two."""
    return 1 << (_bytes(kind) - 1).bit_length()


def instrumented(ir: str) -> tuple[str, list[str]]:
    """The IR with a call before each load and store, and the lines that have them, by number.

    Raises:
        ValueError: For an access to memory of another form.
    """
    sites: list[str] = []
    lines: list[str] = []
    constants: list[str] = []
    made = 0  # areas of the function under way

    def check(kind: str, pointer: str, align: str | None, right: int, line: str) -> str:
        name = f"%site{len(sites)}"
        arguments = f"i64 {len(sites)}, i64 {_bytes(kind)}, i64 {align or _natural(kind)}, i64 {right}"
        lines.append(f"  {name} = call ptr @checked(ptr {pointer}, {arguments})")
        sites.append(line.strip())
        return name

    for line in ir.splitlines():
        if line.startswith("define"):
            made = 0
            lines.append(line.replace(" memory(none)", ""))
        elif found := _LOAD.match(line):
            name = check(found[2], found[3], found[4], READ, line)
            lines.append(line.replace(f"ptr {found[3]}", f"ptr {name}"))
        elif found := _STORE.match(line):
            name = check(found[1], found[3], found[4], WRITE, line)
            align = f", align {found[4]}" if found[4] else ""
            lines.append(f"  store {found[1]} {found[2]}, ptr {name}{align}")
        elif found := _ALLOCA.match(line):
            made += 1
            size = int(found[3] or 1) * _bytes(found[2])
            room = int(found[3] or 1) + -(-_GAP // _bytes(found[2]))  # so that no other area follows at once
            lines.append(f"  {found[1]} = alloca {found[2]}, i64 {room}")
            lines.append(f"  call void @opened(ptr {found[1]}, i64 {size}, i64 {READ | WRITE})")
        elif _OTHER.match(line.strip()):
            raise ValueError(f"An access to memory that is not checked: {line.strip()}")
        elif line.strip().startswith("ret ") and made:
            lines += [f"  call void @closed(i64 {made})", line]
        else:
            lines.append(line)
        if found := _CONSTANT.match(line):
            size = int(found[2]) * _bytes(found[3])
            constants.append(f"  call void @opened(ptr {found[1]}, i64 {size}, i64 {READ})")
    opening = ["define void @open_constants() {", *constants, "  ret void", "}", ""]
    return "\n".join(lines) + _CHECK + "\n".join(opening), sites


def runs(addresses: Iterable[int], size: int) -> list[tuple[int, int]]:
    """The areas, as first address and address after the last, that elements of `size` bytes at `addresses` fill."""
    found: list[tuple[int, int]] = []
    for address in sorted(set(addresses)):
        if found and found[-1][1] == address:
            found[-1] = (found[-1][0], address + size)
        else:
            found.append((address, address + size))
    return found


class CheckedCode:
    """Machine code of instrumented IR."""

    def __init__(self, ir: str, *names: str) -> None:
        text, self.sites = instrumented(ir)
        self._code = jit.load_text(text, (*names, "areas.at", "count.at", "faults.at", "open_constants"))
        table, count, faults = (
            ctypes.CFUNCTYPE(ctypes.c_void_p)(self._code.address(f"{name}.at"))()
            for name in ("areas", "count", "faults")
        )
        self._table = np.ctypeslib.as_array((ctypes.c_int64 * (3 * MOST)).from_address(table)).reshape(
            MOST, 3
        )
        self._count = ctypes.c_int64.from_address(count)
        self._faults = np.ctypeslib.as_array((ctypes.c_int64 * 5).from_address(faults))
        ctypes.CFUNCTYPE(None)(self._code.address("open_constants"))()
        self._constants = self._count.value

    def address(self, name: str) -> int:
        """Where a function starts."""
        return self._code.address(name)

    def open(self, areas: Iterable[tuple[int, int, int]]) -> None:
        """What may be touched from now on, besides constants: first address, address after the last, rights."""
        rows = list(areas)
        end = self._constants + len(rows)
        assert end < MOST - 100, "too many areas"
        self._table[self._constants : end] = np.array(rows, np.int64).reshape(-1, 3)
        self._count.value = end
        self._faults[:] = 0

    def fault(self) -> str | None:
        """The first access that no area allows since `open`, and how many there were."""
        number, site, address, size, right = (int(x) for x in self._faults)
        if not number:
            return None
        near = min(self._table[: self._count.value], key=lambda row: _distance(row, address, address + size))
        word = "store" if right == WRITE else "load"
        return (
            f"{number} accesses outside; the first: {word} of {size} bytes, {address - int(near[0])} bytes after the start "
            f"of an area of {int(near[1] - near[0])} bytes with rights {int(near[2])}: {self.sites[site]}"
        )


def _distance(row: np.ndarray, start: int, end: int) -> int:
    return max(int(row[0]) - start, end - int(row[1]), 0)
