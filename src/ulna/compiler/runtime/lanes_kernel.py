"""Traced functions as procedures call them: compiled for lanes, by address."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import Any, final

import numpy as np

from ulna.compiler.codegen.lanes_kernel import lanes_kernel_ir
from ulna.compiler.language.function import Function
from ulna.compiler.runtime.jit import Code, load, target
from ulna.errors import DtypeError, InputError, ShapeError


@final
@dataclass(frozen=True, eq=False)
class LanesKernel:
    """A traced function of as many samples as there are lanes: `kernel(inputs, outputs)`.

    `inputs` has shape (numbers in, lanes), `outputs` (numbers out, lanes); column j is sample j. They may
    overlap: all inputs are read before any output is written.

    Attributes:
        function: The traced function.
        lanes: How many samples.
        dtype: The type of the numbers, float32 or float64.
        sizes: How many numbers both arrays hold.
        code: Its machine code.
    """

    function: Function
    lanes: int
    dtype: np.dtype[Any]
    sizes: tuple[int, int]
    code: Code

    @property
    def address(self) -> int:
        """Where the machine code begins."""
        return self.code.address("kernel")

    def __call__(self, inputs: Any, outputs: Any) -> None:
        """Computes all samples.

        Args:
            inputs: Shape (numbers in, lanes).
            outputs: Shape (numbers out, lanes); overwritten.

        Raises:
            DtypeError: If an array has another type of numbers.
            ShapeError: If it holds too few of them, or has gaps.
        """
        for name, array, size in (("inputs", inputs, self.sizes[0]), ("outputs", outputs, self.sizes[1])):
            if array.dtype != self.dtype:
                raise DtypeError(name, str(array.dtype), str(self.dtype))
            if array.size < size or not array.flags.c_contiguous:
                raise ShapeError(
                    name, array.shape, f"C-contiguous with ({size // self.lanes}, {self.lanes}) numbers"
                )
        function = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p)(self.address)
        function(inputs.ctypes.data, outputs.ctypes.data)

    def interpret(self, inputs: Any, outputs: Any) -> None:
        """The same by NumPy, through the interpreter of graphs: the reference.

        Args:
            inputs: Shape (numbers in, lanes).
            outputs: Shape (numbers out, lanes); overwritten.
        """
        rows = np.asarray(inputs, float).reshape(-1, self.lanes)
        columns, start = [], 0
        for port in self.function.inputs:
            columns.append(rows[start : start + port.size].T.reshape(self.lanes, *port.shape))
            start += port.size
        results = self.function(*columns)
        results = (results,) if self.function.single else results
        flat = [np.broadcast_to(r, (self.lanes, *p.shape)).reshape(self.lanes, -1)
                for r, p in zip(results, self.function.outputs, strict=True)]  # fmt: skip
        outputs.reshape(-1, self.lanes)[: self.sizes[1] // self.lanes] = np.concatenate(flat, axis=1).T


def lanes_kernel(function: Function, lanes: int | None = None, dtype: Any = np.float32) -> LanesKernel:
    """Compiles a traced function for procedures to call.

    Args:
        function: The traced function.
        lanes: How many samples at once, a power of two; None for a register full.
        dtype: The type of the numbers, float32 or float64.

    Returns:
        The kernel; pass it to a parameter annotated `Kernel`.

    Raises:
        InputError: If the lanes are not a power of two, or the function itself uses lanes.
        DtypeError: If the numbers are of another type.
    """
    kind = np.dtype(dtype)
    if kind not in (np.float32, np.float64):
        raise DtypeError("dtype", str(kind), "float32 or float64")
    element = "float" if kind == np.float32 else "double"
    count = target().lanes(element) if lanes is None else lanes
    if not 1 <= count <= 64 or count & (count - 1):
        raise InputError(f"`lanes` is {count}; expected a power of two from 1 to 64.")
    if function.lanes > 1:
        raise InputError(
            f"{function.name} uses {function.lanes} lanes for one sample; expected a function without."
        )
    ir = lanes_kernel_ir(function, count, element, target().arithmetic)
    inputs = sum(p.size for p in function.inputs) * count
    outputs = sum(p.size for p in function.outputs) * count
    return LanesKernel(function, count, kind, (inputs, outputs), load(function, ir, ("kernel",)))
