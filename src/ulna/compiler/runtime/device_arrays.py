"""Arrays in a GPU's memory as a kernel takes them: their addresses and two strides, whatever library they come from."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, final

from ulna.checks.arrays import batched_shape
from ulna.compiler.language.ports import Port
from ulna.errors import DtypeError, InputError, ShapeError

Shape = tuple[int, ...]


@final
@dataclass(frozen=True)
class DeviceArray:
    """An array in a GPU's memory.

    Attributes:
        address: Where it begins.
        shape: Its shape.
        strides: From entry to entry along each axis [entries].
        dtype: The name of its type, such as "float64"; empty for one that NumPy does not know.
        device: The number of the GPU; -1 for memory that no GPU reaches.
        is_readonly: Whether it must not be written to.
        owner: The array as it was passed.
    """

    address: int
    shape: Shape
    strides: Shape
    dtype: str
    device: int
    is_readonly: bool
    owner: Any


def dense_strides(shape: Sequence[int]) -> Shape:
    """Strides of an array whose entries lie one after the other, row-major [entries]."""
    strides, step = [], 1
    for length in reversed(shape):
        strides.append(step)
        step *= length
    return tuple(reversed(strides))


def check_array(port: Port, array: DeviceArray, dtype: str, device: int) -> None:
    """Refuses an array of another type, on another device or of another shape than a kernel takes.

    Args:
        port: The input or output.
        array: The array.
        dtype: The type that the kernel computes in.
        device: The number of the GPU that it runs on.

    Raises:
        InputError: For an array on the CPU or on another GPU.
        DtypeError: For another type.
        ShapeError: If the last axes are not those of the port.
    """
    name = port.name
    if array.device < 0:
        raise InputError(
            f"`{name}` is in the memory of the CPU; expected an array on the GPU. tensor.cuda(), cupy.asarray(x) and "
            'jax.device_put(x) copy it there; kernels without device="cuda" take NumPy arrays.'
        )
    if array.device != device:
        raise InputError(
            f"`{name}` is on GPU {array.device}; expected GPU {device}, where the first array is. Move one of them."
        )
    if array.dtype != dtype:
        other = "float32" if dtype == "float64" else "float64"
        raise DtypeError(
            name,
            array.dtype or "unknown",
            dtype,
            f"Convert it, or ask for a kernel of {other}: robot.kernel(..., device='cuda', dtype='{other}').",
        )
    lead = len(array.shape) - len(port.shape)
    if lead < 0 or array.shape[lead:] != port.shape:
        raise ShapeError(name, array.shape, batched_shape(port.shape))


def two_strides(port: Port, array: DeviceArray, batch: Shape) -> tuple[int, int]:
    """The strides from sample to sample and from number to number, with samples and numbers counted row-major.

    Args:
        port: The input or output.
        array: The array; its leading axes broadcast to `batch`.
        batch: The leading axes of all arrays together.

    Returns:
        Both strides [entries].

    Raises:
        InputError: If the leading axes, or the others, have no single stride.
    """
    lead = len(array.shape) - len(port.shape)
    shape = (1,) * (len(batch) - lead) + array.shape[:lead]
    strides = (0,) * (len(batch) - lead) + array.strides[:lead]
    # Along axes that it is repeated along, an array does not move.
    strides = tuple(0 if n == 1 and m != 1 else s for n, m, s in zip(shape, batch, strides, strict=True))
    sample = _single_stride(batch, strides)
    number = _single_stride(port.shape, array.strides[lead:])
    if sample is None or number is None:
        axes = "leading axes" if sample is None else "last axes"
        raise InputError(
            f"`{port.name}` has shape {array.shape} and strides {array.strides}, whose {axes} cannot be counted "
            f"through with one stride (all leading axes together: {batch}); expected an array that is contiguous, or "
            "the same for all samples. x.expand(...).contiguous() makes one."
        )
    return sample, number


def _single_stride(shape: Shape, strides: Shape) -> int | None:
    """The stride by which all entries follow each other, row-major; 0 where there is one; None where there is none."""
    moving = [(n, s) for n, s in zip(shape, strides, strict=True) if n != 1]
    if not moving or math.prod(shape) == 0:
        return 0
    for (_, outer), (n, inner) in pairwise(moving):
        if outer != n * inner:
            return None
    return moving[-1][1]
