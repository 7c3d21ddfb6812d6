"""Compiled functions on NVIDIA GPUs: loading and launching through cuda-core. Experimental: never run on a GPU yet."""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from functools import cache
from typing import Any, final

import numpy as np

from ulna.compiler.language.function import Function
from ulna.compiler.language.ports import Port, batch_shape, wrong_count
from ulna.compiler.runtime.device_arrays import (
    DeviceArray,
    check_array,
    dense_strides,
    two_strides,
)
from ulna.compiler.runtime.foreign import package_of
from ulna.compiler.runtime.kernel import element_of
from ulna.compiler.runtime.ptx import ptx
from ulna.errors import DeviceError, InputError, ShapeError, needed
from ulna.system import forks

BLOCK = 128
"""Threads of a block."""
_NAME = "ulna_kernel"
_LEGACY_STREAM = 1  # what DLPack calls the default stream, whose address is 0


@final
class CudaKernel:
    """A compiled function on an NVIDIA GPU: one thread for each sample. Experimental: it was never run on a GPU.

    It takes arrays in the GPU's memory (PyTorch, CuPy, JAX, Numba; `__cuda_array_interface__` or DLPack), of the
    kernel's type, with leading batch axes that broadcast, and is launched on the caller's stream without waiting.

    Args:
        function: The traced function.
        dtype: The type to compute in: float64 or float32.

    Raises:
        InputError: If the function has no inputs or outputs, or evaluates one sample in several lanes.
        DtypeError: If `dtype` is neither float64 nor float32.
    """

    def __init__(self, function: Function, dtype: Any = np.float64) -> None:
        self.function, self.dtype = function, element_of(dtype)
        if function.lanes > 1 or not function.inputs or not function.outputs:
            raise InputError(
                f"{function.name} cannot run on a GPU; expected a function with inputs and outputs, in one lane."
            )
        self._loaded: dict[int, Any] = {}
        self._lock = forks.lock(forks.KERNEL)

    def ptx(self) -> str:
        """The code: PTX, the assembly text of NVIDIA GPUs, for Turing and all later ones."""
        return ptx([(_NAME, self.function)], self.dtype)

    def __call__(self, *arrays: Any, out: Any = None, stream: Any = None) -> Any:
        """Launches the kernel.

        Args:
            *arrays: An array (..., n) on the GPU for each input. With the strides of a transposed (n, ...) array the
                GPU reads it fastest.
            out: An array of the results' shape to write to, or a tuple of several; None for new ones: tensors where
                the first array is one, CuPy's where it is one of these, else views of cuda-core that
                `jax.dlpack.from_dlpack` and others take. New ones have the shape (..., n) with the strides of a
                transposed (n, ...) array, so that the GPU writes them fastest.
            stream: The stream to launch on: an object of PyTorch, CuPy or cuda-core, or an address. None for the
                current one of the library of the first array.

        Returns:
            The result, or a tuple of several; computed when the stream has come to it.

        Raises:
            MissingExtra: If cuda-core is not installed.
            DeviceError: If there is no GPU or no driver.
            TypeError: If the number of arrays is not that of the inputs.
            InputError: If an array is on another device or cannot be counted through.
            DtypeError: If an array has another type than the kernel.
            ShapeError: If a shape does not fit.
        """
        f = self.function
        if len(arrays) != len(f.inputs):
            raise wrong_count(f.name, [p.name for p in f.inputs], arrays)
        core = cuda_core()
        views = [view_of(x, p.name) for x, p in zip(arrays, f.inputs, strict=True)]
        for port, array in zip(f.inputs, views, strict=True):
            check_array(port, array, self.dtype.name, views[0].device)
        batch = batch_shape(f.inputs, [view.shape for view in views])
        device = core.Device(views[0].device)
        device.set_current()
        queue = _stream(core, device, arrays[0], stream)
        for x, p in zip(arrays, f.inputs, strict=True):  # what other streams do to the arrays comes first
            view_of(x, p.name, int(queue.handle) or _LEGACY_STREAM)
        results = self._new(arrays[0], device, queue, batch) if out is None else self._checked(out, batch)
        made = [view_of(x, p.name) for x, p in zip(results, f.outputs, strict=True)]
        for port, array in zip(f.outputs, made, strict=True):
            check_array(port, array, self.dtype.name, views[0].device)
        self._launch(core, device, queue, [*views, *made], batch)
        return results[0] if f.single else tuple(results)

    def __repr__(self) -> str:
        f = self.function
        return f"<CUDA kernel {f.name}{f.signature} {self.dtype.name}, {f.operations} operations>"

    def __reduce__(self) -> tuple[Any, ...]:
        return CudaKernel, (self.function, self.dtype.name)

    def _launch(self, core: Any, device: Any, queue: Any, arrays: Sequence[DeviceArray], batch: Any) -> None:
        count = math.prod(batch)
        if count == 0:
            return
        ports = [*self.function.inputs, *self.function.outputs]
        words = [np.int64(count)]
        for port, array in zip(ports, arrays, strict=True):
            words += [np.int64(word) for word in (array.address, *two_strides(port, array, batch))]
        config = core.LaunchConfig(grid=-(-count // BLOCK), block=BLOCK)
        core.launch(queue, config, self._kernel(core, device), *words)

    def _kernel(self, core: Any, device: Any) -> Any:
        """The kernel on a GPU; compiled when first needed."""
        number = device.device_id
        with self._lock:
            if number not in self._loaded:
                code = core.ObjectCode.from_ptx(self.ptx().encode(), name=self.function.name)
                self._loaded[number] = code.get_kernel(_NAME)
            return self._loaded[number]

    def _checked(self, out: Any, batch: Any) -> tuple[Any, ...]:
        """The arrays to write to."""
        f = self.function
        targets = (out,) if f.single and not isinstance(out, tuple) else tuple(out)
        if len(targets) != len(f.outputs):
            raise InputError(f"`out` holds {len(targets)} arrays; {f.name} has {len(f.outputs)} outputs.")
        for target, port in zip(targets, f.outputs, strict=True):
            array = view_of(target, "out")
            if array.shape != batch + port.shape:
                raise ShapeError("out", array.shape, str(batch + port.shape))
            if array.is_readonly:
                raise InputError("`out` is read-only; expected an array that can be written to.")
        return targets

    def _new(self, like: Any, device: Any, queue: Any, batch: Any) -> tuple[Any, ...]:
        """New arrays for the results, of the library of the first argument, number after number in memory."""
        return tuple(_empty(like, device, queue, batch, port, self.dtype) for port in self.function.outputs)


@cache
def cuda_core() -> Any:
    """The package cuda-core, where there is a GPU.

    Returns:
        The module `cuda.core`.

    Raises:
        MissingExtra: If it is not installed.
        DeviceError: If there is no GPU or no driver.
    """
    with needed("cuda-core", "cuda", "Running a kernel on a GPU"):
        from cuda import core  # pyright: ignore[reportMissingImports]
    try:
        core.Device().set_current()  # pyright: ignore[reportAttributeAccessIssue]
    except Exception as error:  # of several classes: no driver, one that is too old, no device
        raise DeviceError(
            f"There is no usable NVIDIA GPU: {str(error) or type(error).__name__} "
            'Install the NVIDIA driver, or leave out device="cuda" to run the kernel on the CPU.'
        ) from error
    return core


def view_of(array: Any, name: str, stream: int | None = None) -> DeviceArray:
    """Where an array of any library lies.

    Args:
        array: An array with `__dlpack__` or `__cuda_array_interface__`.
        name: Its name, for the message.
        stream: Address of a stream that is to wait for what other streams do to it; None for none.

    Returns:
        Its description.

    Raises:
        InputError: If it is no such array.
    """
    from cuda.core.utils import StridedMemoryView  # pyright: ignore[reportMissingImports]

    source = array.detach() if hasattr(array, "detach") else array  # tensors that require derivatives refuse
    try:
        view = StridedMemoryView.from_any_interface(source, stream_ptr=-1 if stream is None else stream)
    except (BufferError, TypeError, AttributeError):
        raise InputError(
            f"`{name}` is of type {type(array).__name__}; expected an array on the GPU, with DLPack or "
            "__cuda_array_interface__, such as a tensor of PyTorch."
        ) from None
    device = view.device_id if view.is_device_accessible else -1
    strides = view.strides if view.strides is not None else dense_strides(view.shape)
    kind = view.dtype.name if view.dtype is not None else ""
    return DeviceArray(view.ptr, tuple(view.shape), tuple(strides), kind, device, view.readonly, array)


def _stream(core: Any, device: Any, first: Any, stream: Any) -> Any:
    """The stream to launch on."""
    if stream is None and package_of(first) == "torch":
        stream = sys.modules["torch"].cuda.current_stream(first.device)
    elif stream is None and package_of(first) == "cupy":
        stream = sys.modules["cupy"].cuda.get_current_stream()
    if stream is None:
        return device.default_stream
    if isinstance(stream, int):
        return core.Stream.from_handle(stream)
    if isinstance(stream, core.Stream):
        return stream
    if hasattr(stream, "__cuda_stream__"):
        return device.create_stream(stream)
    for attribute in ("cuda_stream", "ptr"):  # PyTorch, CuPy
        if hasattr(stream, attribute):
            return core.Stream.from_handle(int(getattr(stream, attribute)))
    raise InputError(
        f"`stream` is of type {type(stream).__name__}; expected a stream of PyTorch, CuPy or cuda-core, or an address."
    )


def _empty(like: Any, device: Any, queue: Any, batch: Any, port: Port, dtype: Any) -> Any:
    """A new array (*batch, *shape) of the library of `like`, whose memory is that of (size, count)."""
    count, size = math.prod(batch), math.prod(port.shape)
    if package_of(like) == "torch":
        torch = sys.modules["torch"]
        flat = torch.empty((size, count), dtype=getattr(torch, dtype.name), device=like.device)
        return flat.T.view(*batch, *port.shape)
    if package_of(like) == "cupy":
        flat = sys.modules["cupy"].empty((size, count), dtype)
        return flat.T.reshape(*batch, *port.shape)
    from cuda.core.utils import StridedMemoryView  # pyright: ignore[reportMissingImports]

    buffer = device.allocate(max(count * size, 1) * dtype.itemsize, stream=queue)
    strides = (*dense_strides(batch), *(count * s for s in dense_strides(port.shape)))
    return StridedMemoryView.from_buffer(buffer, (*batch, *port.shape), strides, dtype=dtype)
