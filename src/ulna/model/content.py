"""A model's content as bytes, the same in every process and on every machine, and its fingerprint.

Python's own hashes differ from one process to the next, and pickles from one version to the next; compiled
kernels are found again on disk by this one.
"""

from __future__ import annotations

import dataclasses
import struct
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import PurePosixPath
from typing import Any

import numpy as np

from ulna.geometry import Material, Mesh

_VERSION = "ulna model 1"
"""Changed with every change to what this file writes, so that no old fingerprint means something new."""


def fingerprint(*values: Any) -> str:
    """The SHA-256 of the values' content, 64 hexadecimal digits."""
    import hashlib  # with OpenSSL, which takes as long as fifty files of ours

    out = bytearray(_VERSION.encode())
    for value in values:
        _write(value, out)
    return hashlib.sha256(out).hexdigest()


def _write(value: Any, out: bytearray) -> None:
    """Appends a value's bytes, led by its type and length, so that no two values run into each other."""
    _writer(type(value))(value, out)


@cache
def _writer(kind: type) -> Callable[[Any, bytearray], None]:
    """What writes the values of a type."""
    for kinds, writer in _WRITERS:
        if issubclass(kind, kinds):
            return writer
    if dataclasses.is_dataclass(kind):
        return _dataclass_writer(kind)
    raise TypeError(f"{kind.__name__} has no defined content; make it a frozen dataclass.")


def _write_array(value: Any, out: bytearray) -> None:
    _write(value.shape, out)
    out += b"a" + (value.astype("<f8") + 0.0).tobytes()


def _write_list(value: Any, out: bytearray) -> None:
    out += b"l" + _LENGTH(len(value))
    for item in value:
        _write(item, out)


def _write_mapping(value: Any, out: bytearray) -> None:
    out += b"m" + _LENGTH(len(value))
    for key in value:
        _write(key, out)
        _write(value[key], out)


def _write_mesh(value: Any, out: bytearray) -> None:
    """Not its folder, nor whether it was found: those are facts about one machine."""
    _write(("Mesh", value.file_name, value.scale), out)


def _write_material(value: Any, out: bytearray) -> None:
    texture = PurePosixPath(value.texture.replace("\\", "/")).name if value.texture else None
    _write(("Material", value.name, value.rgba, texture), out)


def _dataclass_writer(kind: type) -> Callable[[Any, bytearray], None]:
    """Writes the full name of a dataclass, then its fields."""
    head = bytearray()
    _text(b"o", f"{kind.__module__}.{kind.__qualname__}", head)
    names = tuple(field.name for field in dataclasses.fields(kind))

    def write(value: Any, out: bytearray) -> None:
        out += head
        for name in names:
            _write(getattr(value, name), out)

    return write


def _text(tag: bytes, text: str, out: bytearray) -> None:
    payload = text.encode()
    out += tag + _LENGTH(len(payload)) + payload


_FLOAT = struct.Struct("<d").pack
_LENGTH = struct.Struct("<Q").pack


def _append(make: Callable[[Any], bytes]) -> Callable[[Any, bytearray], None]:
    def write(value: Any, out: bytearray) -> None:
        out += make(value)

    return write


_WRITERS: tuple[tuple[Any, Callable[[Any, bytearray], None]], ...] = (
    (type(None), _append(lambda value: b"n")),
    ((bool, np.bool_), _append(lambda value: b"t" if value else b"f")),
    # + 0.0: -0.0 is the same number as 0.0
    ((float, np.floating), _append(lambda value: b"d" + _FLOAT(float(value) + 0.0))),
    ((int, np.integer), lambda value, out: _text(b"i", str(int(value)), out)),
    (str, lambda value, out: _text(b"s", value, out)),
    (np.ndarray, _write_array),
    ((tuple, list), _write_list),
    (Mapping, _write_mapping),
    (Mesh, _write_mesh),
    (Material, _write_material),
)
"""What writes the values of which types; the first that fits."""
