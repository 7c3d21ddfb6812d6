"""Buffers in memory that models, data and geometries are written to and read from."""

from __future__ import annotations

from typing import Any

from pinocchio._containers.arguments import ArgumentError
from pinocchio._containers.files import Saved
from pinocchio._containers.keywords import by_name
from ulna.errors import InputError

__all__ = ["StaticBuffer", "StreamBuffer", "buffer_copy", "loadFromBinary", "saveToBinary"]


class StreamBuffer:
    """A buffer that grows: `model.saveToBinary(buffer)`, `other.loadFromBinary(buffer)`."""

    def __init__(self) -> None:
        self._bytes = b""

    def write(self, data: bytes) -> None:
        """Replaces what is in it."""
        self._bytes = bytes(data)

    def tobytes(self) -> bytes:
        """What is in it."""
        return self._bytes

    def view(self) -> memoryview:
        """What is in it, not copied."""
        return memoryview(self._bytes)

    def size(self) -> int:
        """How many bytes are in it."""
        return len(self._bytes)

    def max_size(self) -> int:
        """How many bytes fit in."""
        return 2**63 - 1

    def prepare(self, n: int) -> StreamBuffer:
        """Itself; it grows as it needs to."""
        return self


class StaticBuffer(StreamBuffer):
    """A buffer of a fixed size in bytes; longer contents raise."""

    def __init__(self, size: int) -> None:
        super().__init__()
        self.reserve(size)

    def reserve(self, new_size: int) -> None:
        """Changes its size."""
        self._room = int(new_size)

    def size(self) -> int:
        """How many bytes fit in."""
        return self._room

    def write(self, data: bytes) -> None:
        """Replaces what is in it. InputError where it does not fit."""
        if len(data) > self._room:
            raise InputError(
                f"{len(data)} bytes do not fit into {self._room}. Call reserve({len(data)}) first."
            )
        super().write(data)


def buffer_copy(dest: StreamBuffer, source: StreamBuffer) -> None:
    """Replaces the content of a buffer by that of another.

    Args:
        dest: The buffer that is changed.
        source: The buffer that is read.
    """
    dest.write(source.tobytes())


@by_name("object stream_buffer", "object static_buffer", "object buffer")
def saveToBinary(object: Any, buffer: StreamBuffer) -> None:
    """Writes a model, its data or its geometries into a buffer.

    Args:
        object: The model, data or geometries.
        buffer: The buffer that is written.
    """
    _checked(object).saveToBinary(buffer)


@by_name("object stream_buffer", "object static_buffer", "object buffer")
def loadFromBinary(object: Any, buffer: StreamBuffer) -> None:
    """Replaces a model, its data or its geometries by what a buffer holds.

    Args:
        object: The object that is changed.
        buffer: The buffer that is read.
    """
    _checked(object).loadFromBinary(buffer)


def _checked(value: Any) -> Saved:
    if not isinstance(value, Saved):
        raise ArgumentError(
            f"A {type(value).__name__} is not written to buffers; expected a Model, Data, GeometryModel, GeometryData "
            "or GeometryObject. pickle takes all that is there."
        )
    return value
