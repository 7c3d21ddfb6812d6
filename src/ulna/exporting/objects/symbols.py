"""What an object file needs from elsewhere: its undefined symbols, of ELF, COFF and Mach-O.

Formats: Tool Interface Standard, ELF 1.2; Microsoft, PE Format; Apple, Mach-O (mach-o/nlist.h).
"""

from __future__ import annotations

import struct
from collections.abc import Iterator


def undefined_symbols(content: bytes) -> tuple[str, ...]:
    """The names that a linker has to find elsewhere, sorted.

    Args:
        content: An object file, little-endian.

    Returns:
        The names.
    """
    reader = _elf if content[:4] == b"\x7fELF" else _mach_o if content[:4] == b"\xcf\xfa\xed\xfe" else _coff
    return tuple(sorted({name for name in reader(content) if name}))


def _elf(content: bytes) -> Iterator[str]:
    is_64 = content[4] == 2
    start = struct.unpack_from("<Q", content, 40)[0] if is_64 else struct.unpack_from("<I", content, 32)[0]
    size, count = struct.unpack_from("<HH", content, 58 if is_64 else 46)
    layout, symbol = ("<IIQQQQIIQQ", "<IBBHQQ") if is_64 else ("<IIIIIIIIII", "<IIIBBH")
    sections = [struct.unpack_from(layout, content, start + k * size) for k in range(count)]
    for _, kind, _, _, offset, length, link, *_ in sections:
        if kind != 2:  # not the table of symbols
            continue
        names = sections[link][4]
        for at in range(offset, offset + length, struct.calcsize(symbol)):
            fields = struct.unpack_from(symbol, content, at)
            if (fields[3] if is_64 else fields[5]) == 0:
                yield _text(content, names + fields[0])


def _coff(content: bytes) -> Iterator[str]:
    table, count = struct.unpack_from("<II", content, 8)
    strings, k = table + 18 * count, 0
    while k < count:
        name, _, section, _, storage, auxiliary = struct.unpack_from("<8sIhHBB", content, table + 18 * k)
        zero, offset = struct.unpack("<II", name)
        if section == 0 and storage == 2:
            yield _text(content, strings + offset) if zero == 0 else name.rstrip(b"\0").decode()
        k += 1 + auxiliary


def _mach_o(content: bytes) -> Iterator[str]:
    commands, at = struct.unpack_from("<I", content, 16)[0], 32
    for _ in range(commands):
        command, size = struct.unpack_from("<II", content, at)
        if command == 2:
            table, count, strings, _ = struct.unpack_from("<IIII", content, at + 8)
            for k in range(count):
                name, kind, _, _, _ = struct.unpack_from("<IBBHQ", content, table + 16 * k)
                if not kind & 0xE0 and kind & 0x0E == 0 and kind & 1:
                    yield _text(content, strings + name)
        at += size


def _text(content: bytes, start: int) -> str:
    return content[start : content.index(b"\0", start)].decode()
