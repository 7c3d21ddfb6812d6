"""A model's content as bytes, the same in every process and on every machine, and its fingerprint.

Python's own hashes differ from one process to the next, and pickles from one version to the next; compiled
kernels are found again on disk by this one.
"""

from __future__ import annotations

import dataclasses
import hashlib
import struct
from collections.abc import Mapping
from functools import cache
from pathlib import PurePosixPath
from typing import Any

import numpy as np

from ulna.geometry import Material, Mesh

_VERSION = "ulna model 1"
"""Changed with every change to what this file writes, so that no old fingerprint means something new."""


def fingerprint(*values: Any) -> str:
    """The SHA-256 of the values' content, 64 hexadecimal digits."""
    out = bytearray(_VERSION.encode())
    for value in values:
        _write(value, out)
    return hashlib.sha256(out).hexdigest()


def _write(value: Any, out: bytearray) -> None:
    """Appends a value's bytes, led by its type and length, so that no two values run into each other."""
    if value is None:
        out += b"n"
    elif isinstance(value, (bool, np.bool_)):
        out += b"t" if value else b"f"
    elif isinstance(value, (float, np.floating)):
        out += b"d" + _FLOAT(float(value) + 0.0)  # + 0.0: -0.0 is the same number as 0.0
    elif isinstance(value, (int, np.integer)):
        _text(b"i", str(int(value)), out)
    elif isinstance(value, str):
        _text(b"s", value, out)
    elif isinstance(value, np.ndarray):
        _write(value.shape, out)
        out += b"a" + (value.astype("<f8") + 0.0).tobytes()
    elif isinstance(value, (tuple, list)):
        out += b"l" + _LENGTH(len(value))
        for item in value:
            _write(item, out)
    elif isinstance(value, Mapping):
        out += b"m" + _LENGTH(len(value))
        for key in value:
            _write(key, out)
            _write(value[key], out)
    elif isinstance(
        value, Mesh
    ):  # not its folder, nor whether it was found: those are facts about one machine
        _write(("Mesh", value.file_name, value.scale), out)
    elif isinstance(value, Material):
        texture = PurePosixPath(value.texture.replace("\\", "/")).name if value.texture else None
        _write(("Material", value.name, value.rgba, texture), out)
    elif dataclasses.is_dataclass(value):
        title, names = _layout(type(value))
        _text(b"o", title, out)
        for name in names:
            _write(getattr(value, name), out)
    else:
        raise TypeError(f"{type(value).__name__} has no defined content; make it a frozen dataclass.")


_FLOAT = struct.Struct("<d").pack
_LENGTH = struct.Struct("<Q").pack


def _text(tag: bytes, text: str, out: bytearray) -> None:
    payload = text.encode()
    out += tag + _LENGTH(len(payload)) + payload


@cache
def _layout(kind: type) -> tuple[str, tuple[str, ...]]:
    """The full name of a dataclass and the names of its fields."""
    return f"{kind.__module__}.{kind.__qualname__}", tuple(field.name for field in dataclasses.fields(kind))
