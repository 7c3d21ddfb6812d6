"""PNG files, written with zlib and NumPy only."""

from __future__ import annotations

import os
import struct
import zlib
from pathlib import Path

import numpy as np

from ulna.checks.paths import checked_path
from ulna.errors import InputError, ShapeError
from ulna.typing import Array
from ulna.viewer.output.atomic_file import atomic_write

_SIGNATURE = b"\x89PNG\r\n\x1a\n"


def write_png(path: str | os.PathLike[str], image: Array) -> Path:
    """Write an image.

    Args:
        path: Where to; folders that do not exist are made.
        image: Shape (h, w, 3) for colour or (h, w, 4) with opacity, uint8.

    Returns:
        The path of the file.

    Raises:
        InputError: The image is not one, or the file cannot be written.
        UnknownName: The path does not end in .png.
    """
    target, content = checked_png_path(path), encode_png(image)
    with atomic_write(target, "picture") as file:
        file.write_bytes(content)
    return target


def checked_png_path(path: str | os.PathLike[str]) -> Path:
    """The path of a picture.

    Raises:
        UnknownName: It does not end in .png.
    """
    return checked_path(path, "picture", (".png",))


def encode_png(image: Array) -> bytes:
    """The content of a PNG file with an image of shape (h, w, 3) or (h, w, 4), uint8.

    Raises:
        InputError: The image is not one.
    """
    pixels = np.ascontiguousarray(image)
    if pixels.ndim != 3 or pixels.shape[2] not in (3, 4) or 0 in pixels.shape:
        raise ShapeError("image", pixels.shape, "(height, width, 3) or (height, width, 4)")
    if pixels.dtype != np.uint8:
        raise InputError(f"`image` has dtype {pixels.dtype}; expected uint8, from 0 to 255.")
    height, width, channels = pixels.shape
    rows = pixels.reshape(height, width * channels)
    above = np.vstack([np.zeros_like(rows[:1]), rows[:-1]])
    left = np.hstack([np.zeros((height, channels), np.uint8), rows[:, :-channels]])
    # each row as it is, less its left neighbour or less the row above: whichever leaves the smallest numbers
    choices = np.stack([rows, rows - left, rows - above])
    cost = np.abs(choices.view(np.int8).astype(np.int16)).sum(axis=2)
    best = cost.argmin(axis=0)
    filtered = np.take_along_axis(choices, best[None, :, None], axis=0)[0]
    data = np.concatenate([best[:, None].astype(np.uint8), filtered], axis=1).tobytes()
    header = struct.pack(">IIBBBBB", width, height, 8, 2 if channels == 3 else 6, 0, 0, 0)
    content = _chunk(b"IHDR", header) + _chunk(b"sRGB", b"\0") + _chunk(b"IDAT", zlib.compress(data, 6))
    return _SIGNATURE + content + _chunk(b"IEND", b"")


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
