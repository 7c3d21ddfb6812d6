"""LLVM's relocatable WebAssembly object as a module that needs nothing: own memory and stack, and exports.

A single object needs no linker: its code refers to functions, data and the stack pointer by the numbers that they keep
in the module, as long as no function is imported. Only the imported memory and stack pointer are replaced by own ones
(WebAssembly Core Specification 2.0, chapter 5; WebAssembly tool conventions, "Object file linking").
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import final

from ulna.errors import CompileError, TooLargeError

PAGE = 65536
"""Unit of a module's memory [byte]."""

_CUSTOM, _TYPE, _IMPORT, _FUNCTION, _MEMORY, _GLOBAL, _EXPORT, _DATA_COUNT, _CODE, _DATA = (
    0, 1, 2, 3, 5, 6, 7, 12, 10, 11,
)  # fmt: skip
_LINKER_SYMBOLS = {"__linear_memory", "__stack_pointer"}
_MOST_LOCALS, _MOST_BYTES = 50_000, 7_654_321  # of one function, in the engines of Chrome, Firefox and Safari


@final
@dataclass(frozen=True)
class Linked:
    """A module.

    Attributes:
        binary: Its bytes.
        free: Where in its memory nothing lies, from here to the end [byte].
        pages: How large its memory is [65536 byte].
    """

    binary: bytes
    free: int
    pages: int


def linked(content: bytes, exports: Mapping[str, str], stack: int, data_size: int) -> Linked:
    """The module of a relocatable object.

    Args:
        content: The object.
        exports: The names of its functions that the module exports, and the names they are exported by.
        stack: How large the stack is [byte].
        data_size: How much memory is wanted beside it, for arguments and results [byte].

    Returns:
        The module.

    Raises:
        CompileError: If the code calls functions that are not in it.
        TooLargeError: If a function is larger than browsers accept.
    """
    sections = list(_sections(content))
    _check_imports(dict(sections)[_IMPORT])
    code = {number: body for number, body in sections if number != _CUSTOM}
    _check_sizes(code[_CODE])
    functions = _function_numbers([body for number, body in sections if number == _CUSTOM])
    top = _aligned(_data_end(code.get(_DATA, b"")) + stack)
    pages = -(-(top + data_size) // PAGE)
    code[_MEMORY] = b"\x01\x01" + _number(pages) + _number(pages)
    code[_GLOBAL] = b"\x01\x7f\x01\x41" + _signed(top) + b"\x0b"
    entries = [_name("memory") + b"\x02\x00"]
    entries += [
        _name(exported_name) + b"\x00" + _number(functions[name]) for name, exported_name in exports.items()
    ]
    code[_EXPORT] = _number(len(entries)) + b"".join(entries)
    order = (_TYPE, _FUNCTION, _MEMORY, _GLOBAL, _EXPORT, _DATA_COUNT, _CODE, _DATA)
    parts = [bytes([n]) + _number(len(code[n])) + code[n] for n in order if n in code]
    return Linked(content[:8] + b"".join(parts), top, pages)


def _sections(content: bytes) -> Iterator[tuple[int, bytes]]:
    """Number and content of each section."""
    position = 8
    while position < len(content):
        number = content[position]
        size, start = _read(content, position + 1)
        yield number, content[start : start + size]
        position = start + size


def _check_imports(content: bytes) -> None:
    """Refuses objects that need more than a memory and a stack."""
    count, position = _read(content, 0)
    missing = []
    for _ in range(count):
        _, position = _text(content, position)
        name, position = _text(content, position)
        kind = content[position]
        if name not in _LINKER_SYMBOLS:
            missing.append(name)
        if kind == 2:  # a memory: whether it has a limit, and its limits
            has_limit, position = content[position + 1], _read(content, position + 2)[1]
            position = _read(content, position)[1] if has_limit & 1 else position
        elif kind == 3:
            position += 3
        else:
            position = _read(content, position + 1)[1]
            if kind == 1:  # a table: its element type was read
                break
    if missing:
        raise CompileError(
            f"The WebAssembly code calls {', '.join(missing)}, which is a bug in Ulna; report it."
        )


def _check_sizes(content: bytes) -> None:
    """Refuses functions that browsers refuse."""
    count, position = _read(content, 0)
    for _ in range(count):
        size, start = _read(content, position)
        position = start + size
        groups, inside = _read(content, start)
        numbers = 0
        for _ in range(groups):
            several, inside = _read(content, inside)
            numbers, inside = numbers + several, inside + 1
        if size > _MOST_BYTES or numbers > _MOST_LOCALS:
            raise TooLargeError(
                f"A function of the WebAssembly module has {numbers:,} variables and {size:,} bytes; browsers accept "
                f"{_MOST_LOCALS:,} and {_MOST_BYTES:,}. robot.lock(...) takes joints out; or export fewer quantities."
            )


def _function_numbers(custom: Sequence[bytes]) -> dict[str, int]:
    """The numbers of functions by name, from the symbol table."""
    function_numbers: dict[str, int] = {}
    for section in custom:
        name, position = _text(section, 0)
        if name != "linking":
            continue
        _, position = _read(section, position)  # the version
        while position < len(section):
            kind = section[position]
            size, start = _read(section, position + 1)
            if kind == 8:
                function_numbers.update(_symbols(section[start : start + size]))
            position = start + size
    return function_numbers


def _symbols(table: bytes) -> Iterator[tuple[str, int]]:
    """The functions of a symbol table."""
    count, position = _read(table, 0)
    for _ in range(count):
        kind = table[position]
        flags, position = _read(table, position + 1)
        if kind == 3:  # a section
            _, position = _read(table, position)
            continue
        is_defined, is_named = not flags & 0x10, bool(flags & 0x40)
        number = 0
        if kind != 1:
            number, position = _read(table, position)
        if kind == 1 or is_defined or is_named:
            name, position = _text(table, position)
            if kind == 0:
                yield name, number
        if kind == 1 and is_defined:
            for _ in range(3):  # segment, offset, size
                _, position = _read(table, position)


def _data_end(content: bytes) -> int:
    """Where the data end in memory."""
    if not content:
        return 0
    end, (count, position) = 0, _read(content, 0)
    for _ in range(count):
        position += 2  # the kind of the segment, and the instruction i32.const
        offset, position = _read(content, position)
        size, position = _read(content, position + 1)
        end, position = max(end, offset + size), position + size
    return end


def _aligned(address: int) -> int:
    return (address + 15) & ~15


def _read(content: bytes, position: int) -> tuple[int, int]:
    """A number in LEB128, and where it ends."""
    value = shift = 0
    while True:
        byte = content[position]
        position += 1
        value |= (byte & 127) << shift
        shift += 7
        if byte < 128:
            return value, position


def _number(value: int) -> bytes:
    """A number in LEB128."""
    out = bytearray()
    while True:
        value, low = value >> 7, value & 127
        out.append(low | (128 if value else 0))
        if not value:
            return bytes(out)


def _signed(value: int) -> bytes:
    """A number, not negative, in signed LEB128: its last byte has a bit for the sign."""
    plain = _number(value)
    return plain if plain[-1] < 64 else plain[:-1] + bytes([plain[-1] | 128, 0])


def _text(content: bytes, position: int) -> tuple[str, int]:
    size, start = _read(content, position)
    return content[start : start + size].decode(), start + size


def _name(text: str) -> bytes:
    data = text.encode()
    return _number(len(data)) + data
