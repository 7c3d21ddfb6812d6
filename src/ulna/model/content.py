"""A model's content as bytes, the same in every process and on every machine, and its fingerprint.

Python's own hashes differ from one process to the next, and pickles from one version to the next; compiled
kernels are found again on disk by this one.
"""

from __future__ import annotations

import dataclasses
import hashlib
import struct
from collections.abc import Iterator, Mapping
from pathlib import PurePosixPath
from typing import Any

import numpy as np

from ulna.geometry import Material, Mesh

_VERSION = "ulna model 1"
"""Changed with every change to what this file writes, so that no old fingerprint means something new."""


def fingerprint(*values: Any) -> str:
    """The SHA-256 of the values' content, 64 hexadecimal digits."""
    digest = hashlib.sha256(_VERSION.encode())
    for value in values:
        for piece in _pieces(value):
            digest.update(piece)
    return digest.hexdigest()


def _pieces(value: Any) -> Iterator[bytes]:
    """The bytes of a value, led by its type and length, so that no two values run into each other."""
    if value is None:
        yield b"n"
    elif isinstance(value, (bool, np.bool_)):
        yield b"t" if value else b"f"
    elif isinstance(value, (int, np.integer)):
        yield _headed(b"i", str(int(value)).encode())
    elif isinstance(value, (float, np.floating)):
        yield b"d" + struct.pack("<d", float(value) + 0.0)  # + 0.0: -0.0 is the same number as 0.0
    elif isinstance(value, str):
        yield _headed(b"s", value.encode())
    elif isinstance(value, np.ndarray):
        yield from _pieces(value.shape)
        yield _headed(b"a", (value.astype("<f8") + 0.0).tobytes())
    elif isinstance(value, (tuple, list)):
        yield _headed(b"l", str(len(value)).encode())
        for item in value:
            yield from _pieces(item)
    elif isinstance(value, Mapping):
        yield _headed(b"m", str(len(value)).encode())
        for key in value:
            yield from _pieces(key)
            yield from _pieces(value[key])
    elif isinstance(
        value, Mesh
    ):  # not its folder, nor whether it was found: those are facts about one machine
        yield from _pieces(("Mesh", value.file_name, value.scale))
    elif isinstance(value, Material):
        texture = PurePosixPath(value.texture.replace("\\", "/")).name if value.texture else None
        yield from _pieces(("Material", value.name, value.rgba, texture))
    elif dataclasses.is_dataclass(value):
        kind = type(value)
        yield from _pieces((kind.__module__, kind.__qualname__))
        yield from _pieces([getattr(value, field.name) for field in dataclasses.fields(value)])
    else:
        raise TypeError(f"{type(value).__name__} has no defined content; make it a frozen dataclass.")


def _headed(tag: bytes, payload: bytes) -> bytes:
    return tag + struct.pack("<Q", len(payload)) + payload
