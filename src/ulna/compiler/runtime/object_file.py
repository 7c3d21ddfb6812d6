"""Whether bytes look like the object file that LLVM makes here, examined before LLVM's loader trusts them."""

from __future__ import annotations

import struct

_MACHINES = {"x86_64": 62, "amd64": 62, "aarch64": 183, "arm64": 183}  # ELF
_COFF = {"x86_64": 0x8664, "amd64": 0x8664, "aarch64": 0xAA64, "arm64": 0xAA64}
_RELOCATABLE, _NO_BITS = 1, 8
_SYMBOLS, _RELOCATIONS = 2, 4
_SIZES = {_SYMBOLS: 24, _RELOCATIONS: 24}


def is_sound(content: bytes, triple: str) -> bool:
    """Whether `content` is an object file for the machine of `triple` whose parts lie within it.

    Args:
        content: The bytes of the file.
        triple: LLVM's target triple, such as "x86_64-unknown-linux-gnu".

    Returns:
        False for another machine, another format or a truncated file.
    """
    machine = triple.partition("-")[0].lower()
    if "windows" in triple:
        return len(content) > 20 and struct.unpack_from("<H", content)[0] == _COFF.get(machine)
    if "darwin" in triple or "macos" in triple:
        return len(content) > 32 and content[:4] == b"\xcf\xfa\xed\xfe"
    try:
        return _is_sound_elf(content, _MACHINES.get(machine))
    except struct.error:  # too short
        return False


def _is_sound_elf(content: bytes, machine: int | None) -> bool:
    """ELF, 64 bits, little endian: the header and the table of sections (System V ABI, chapter 4)."""
    if content[:7] != b"\x7fELF\x02\x01\x01":
        return False
    kind, found_machine = struct.unpack_from("<HH", content, 16)
    at = struct.unpack_from("<Q", content, 40)[0]
    width, count, names = struct.unpack_from("<HHH", content, 58)
    if kind != _RELOCATABLE or (machine is not None and found_machine != machine):
        return False
    if width != 64 or not 0 < names < count or at + width * count > len(content):
        return False
    sections = [struct.unpack_from("<IIQQQQIIQQ", content, at + width * k) for k in range(count)]
    end_of_names = sections[names][5]
    for name, type_, _, _, offset, size, link, info, align, each in sections:
        if name >= end_of_names or (type_ != _NO_BITS and offset + size > len(content)):
            return False
        if link >= count or align & (align - 1):
            return False
        if type_ in _SIZES and (each != _SIZES[type_] or size % each):
            return False
        if type_ == _RELOCATIONS and not 0 < info < count:
            return False
    return all(_links_hold(content, section, sections) for section in sections)


def _links_hold(content: bytes, section: tuple[int, ...], sections: list[tuple[int, ...]]) -> bool:
    """Whether symbols lie in sections that exist, and relocations name symbols and places that exist."""
    type_, offset, size, link, info = section[1], section[4], section[5], section[6], section[7]
    if type_ == _SYMBOLS:
        words = sections[link][5]
        for at in range(offset, offset + size, 24):
            name, _, _, index, value, length = struct.unpack_from("<IBBHQQ", content, at)
            if name >= max(words, 1) or (index >= len(sections) and index < 0xFF00):
                return False
            if 0 < index < 0xFF00 and value + length > sections[index][5]:
                return False
    if type_ == _RELOCATIONS:
        symbols = sections[link][5] // 24 if sections[link][1] == _SYMBOLS else 0
        for at in range(offset, offset + size, 24):
            place, what = struct.unpack_from("<QQ", content, at)
            if what >> 32 >= symbols or place >= max(sections[info][5], 1):
                return False
    return True
