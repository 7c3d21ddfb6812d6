"""Compiled functions as PyTorch functions: kernels forwards, compiled derivatives backwards."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, final

import torch  # pyright: ignore[reportMissingImports]

from ulna.compiler import Function, compile
from ulna.compiler.language.ports import batch_shape
from ulna.compiler.runtime.cuda_kernel import CudaKernel
from ulna.errors import DtypeError, InputError
from ulna.interop.arguments import check_count
from ulna.interop.derivatives import derivatives_of
from ulna.system import forks

_DTYPES: dict[Any, str] = {torch.float64: "float64", torch.float32: "float32"}
DEVICES = ("cpu", "cuda")
"""Types of devices that tensors may be on."""
_lock = forks.lock(forks.RECIPES)


@final
class TorchFunction:
    """A compiled function of tensors; see `ulna.interop.to_torch`.

    Args:
        function: The traced function.
    """

    def __init__(self, function: Function) -> None:
        self.function = function
        self._kernels: dict[Any, Any] = {}
        self._derivatives: dict[Any, TorchFunction] = {}

    def __call__(self, *tensors: Any) -> Any:
        """Evaluates the function, and records it for derivatives where a tensor requires them.

        Args:
            *tensors: A tensor (..., n) for each input, float32 or float64, all of one type and on one device.

        Returns:
            A tensor, or a tuple of several, of that type and on that device.

        Raises:
            TypeError: If the number of tensors is not that of the inputs.
            InputError: If an argument is no tensor, or they are on different devices.
            DtypeError: If they are not all float32 or all float64.
            ShapeError: If a shape does not fit.
        """
        check_count(self.function, tensors)
        self._check(tensors)
        results = _evaluate(self, *tensors)
        return results[0] if self.function.single else results

    def __repr__(self) -> str:
        return f"<torch function {self.function.name}{self.function.signature}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return TorchFunction, (self.function,)

    def _check(self, tensors: Sequence[Any]) -> None:
        """Refuses what is no tensor, and tensors of different types or devices."""
        for port, x in zip(self.function.inputs, tensors, strict=True):
            if not isinstance(x, torch.Tensor):
                raise InputError(
                    f"`{port.name}` is of type {type(x).__name__}; expected a torch.Tensor. "
                    "torch.as_tensor(x) makes one; the kernel itself takes NumPy arrays."
                )
            if x.dtype not in _DTYPES:
                advice = f"{port.name}.double() or {port.name}.float() converts it."
                raise DtypeError(port.name, str(x.dtype), "torch.float32 or torch.float64", advice)
            if x.dtype != tensors[0].dtype:
                first = self.function.inputs[0].name
                advice = f"All must be of one type: {port.name}.to({first}.dtype)."
                raise DtypeError(port.name, str(x.dtype), f"{tensors[0].dtype} as `{first}` has", advice)
            if x.device != tensors[0].device:
                first = self.function.inputs[0].name
                raise InputError(
                    f"`{port.name}` is on {x.device}; expected {tensors[0].device}, where `{first}` is. "
                    f"{port.name}.to({first}.device) moves it."
                )

    def run(self, tensors: Sequence[Any]) -> tuple[Any, ...]:
        """The outputs as new tensors, without a record for derivatives.

        Args:
            tensors: A tensor (..., n) for each input.

        Returns:
            A tensor for each output.

        Raises:
            InputError: If they are on a device that no kernels are made for.
        """
        device, dtype = tensors[0].device.type, _DTYPES[tensors[0].dtype]
        if device not in DEVICES:
            raise InputError(
                f"`{self.function.inputs[0].name}` is on {tensors[0].device}; expected a tensor on the CPU, or on an "
                "NVIDIA GPU. tensor.cpu() copies it there."
            )
        kernel = self._kernel(device, dtype)
        if device == "cuda":
            return _several(self.function, kernel(*(x.detach() for x in tensors)))
        results = _several(self.function, kernel(*(x.detach().numpy() for x in tensors)))
        # A single number comes as a NumPy scalar, not as an array.
        return tuple(torch.from_numpy(r) if r.ndim else torch.as_tensor(r) for r in results)

    def derivative(self, direction: str, choice: tuple[bool, ...]) -> TorchFunction:
        """A directional derivative; made when first needed, and kept with the kernels that are compiled for it.

        Args:
            direction: "forward" or "reverse".
            choice: For each input, whether it has a tangent, or is differentiated by.

        Returns:
            The derivative; see `ulna.interop.derivatives`.
        """
        made = self._derivatives.get((direction, choice))
        if made is None:
            family = derivatives_of(self.function)
            function = family.forward(choice) if direction == "forward" else family.reverse(choice)
            made = self._derivatives.setdefault((direction, choice), TorchFunction(function))
        return made

    def _kernel(self, device: str, dtype: str) -> Any:
        """The kernel for a device and a type; compiled when first needed."""
        kernel = self._kernels.get((device, dtype))
        if kernel is None:
            with _lock:
                kernel = self._kernels.get((device, dtype))
                if kernel is None:
                    made = CudaKernel if device == "cuda" else compile
                    kernel = self._kernels[device, dtype] = made(self.function, dtype)
        return kernel


def _several(f: Function, results: Any) -> tuple[Any, ...]:
    return (results,) if f.single else results


@final
class _Evaluation(torch.autograd.Function):
    """One evaluation, and what PyTorch asks of it: both derivatives and the rule for `vmap`."""

    @staticmethod
    def forward(f: TorchFunction, *tensors: Any) -> Any:
        return f.run(tensors)

    @staticmethod
    def setup_context(ctx: Any, inputs: tuple[Any, ...], output: Any) -> None:
        ctx.f, *tensors = inputs
        ctx.save_for_backward(*tensors)
        ctx.save_for_forward(*tensors)

    @staticmethod
    def backward(ctx: Any, *cotangents: Any) -> Any:
        tensors, wanted = ctx.saved_tensors, ctx.needs_input_grad[1:]
        derivative = ctx.f.derivative("reverse", tuple(wanted))
        cotangents_of_inputs = iter(_evaluate(derivative, *tensors, *cotangents))
        # Where an input was broadcast along batch axes, its derivative is the sum along them.
        return None, *(
            next(cotangents_of_inputs).sum_to_size(x.shape) if w else None
            for x, w in zip(tensors, wanted, strict=True)
        )

    @staticmethod
    def jvp(ctx: Any, _: Any, *tangents: Any) -> Any:
        moving = tuple(t is not None for t in tangents)
        derivative = ctx.f.derivative("forward", moving)
        return _evaluate(derivative, *ctx.saved_tensors, *(t for t in tangents if t is not None))

    @staticmethod
    def vmap(info: Any, in_dims: tuple[int | None, ...], f: TorchFunction, *tensors: Any) -> Any:
        ports, dims = f.function.inputs, in_dims[1:]
        leads = [
            x.ndim - (d is not None) - len(p.shape) for x, d, p in zip(tensors, dims, ports, strict=True)
        ]
        most, moved = max(leads), []
        for x, d, lead in zip(tensors, dims, leads, strict=True):
            if d is None:
                moved.append(x)
                continue
            front = x.movedim(d, 0)  # then as many axes as there are batch axes elsewhere
            moved.append(front.reshape(front.shape[0], *(1,) * (most - lead), *front.shape[1:]))
        return _evaluate(f, *moved), (0,) * len(f.function.outputs)


def _evaluate(f: TorchFunction, *tensors: Any) -> tuple[Any, ...]:
    """The outputs, recorded for derivatives."""
    batch_shape(f.function.inputs, [tuple(x.shape) for x in tensors])
    return _Evaluation.apply(f, *tensors)  # pyright: ignore[reportReturnType]
