"""Compiled functions inside of PyTorch and JAX, with their compiled derivatives."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ulna.checks.values import short_repr
from ulna.compiler import Function, KernelBase
from ulna.compiler.runtime.cuda_kernel import CudaKernel
from ulna.errors import InputError, MissingExtra

if TYPE_CHECKING:
    from ulna.interop.jax_functions import JaxFunction
    from ulna.interop.torch_functions import TorchFunction


def to_torch(kernel: Any) -> TorchFunction:
    """A function of PyTorch tensors that runs a kernel, and its compiled derivatives in `backward`.

    It takes float32 or float64 tensors of shape (..., n) with any leading batch axes, which broadcast; all must be of
    one type, and on one device, the CPU or (experimental) an NVIDIA GPU. Tensors are read where they lie, and the
    result is not copied. It works with `backward`, `torch.autograd.grad`, forward-mode derivatives, derivatives of
    derivatives, and `torch.func`.

    Args:
        kernel: A kernel, as `robot.kernel("fk")` and `ulna.compile(f, robot)` return, or a traced `Function`.

    Returns:
        The function; it is called as the kernel is, with tensors.

    Raises:
        InputError: If `kernel` is neither.
        MissingExtra: If PyTorch is not installed.

    Example:
        >>> import torch
        >>> fk = ulna.interop.to_torch(ulna.load("panda").kernel("fk"))
        >>> q = torch.zeros(7, requires_grad=True)
        >>> fk(q)[2, 3].backward()  # the height of the tool
        >>> q.grad.shape
        torch.Size([7])
    """
    function = _function_of(kernel)
    try:
        from ulna.interop.torch_functions import TorchFunction
    except ModuleNotFoundError as error:
        raise _missing(error, "torch", "A function of tensors") from None
    return TorchFunction(function)


def to_jax(kernel: Any) -> JaxFunction:
    """A function of JAX arrays that runs a kernel on the CPU, inside of `jax.jit` too, with its compiled derivatives.

    It takes arrays of shape (..., n) with any leading batch axes, which broadcast, and computes in float32, or in
    float64 where an argument is float64. It works with `jax.jit`, `vmap`, `grad`, `jacfwd`, `jacrev`, `hessian`,
    `jvp`, `vjp` and `linearize`. Calls are native (the foreign function interface of XLA); Python takes no part.

    Args:
        kernel: A kernel, as `robot.kernel("fk")` and `ulna.compile(f, robot)` return, or a traced `Function`.

    Returns:
        The function; it is called as the kernel is, with arrays.

    Raises:
        InputError: If `kernel` is neither.
        MissingExtra: If JAX is not installed.
    """
    function = _function_of(kernel)
    try:
        from ulna.interop.jax_functions import JaxFunction
    except ModuleNotFoundError as error:
        raise _missing(error, "jax", "A function of JAX arrays") from None
    return JaxFunction(function)


def _missing(error: ModuleNotFoundError, package: str, purpose: str) -> Exception:
    """What to raise where a module is missing: the advice to install the package, if it is that one."""
    return MissingExtra(package, package, purpose) if (error.name or "").startswith(package) else error


def _function_of(kernel: Any) -> Function:
    """The traced function behind a kernel, or that function."""
    function = kernel.function if isinstance(kernel, KernelBase | CudaKernel) else kernel
    if not isinstance(function, Function):
        raise InputError(
            f"`kernel` is {short_repr(kernel)}; expected a kernel, such as robot.kernel('fk') or "
            "ulna.compile(f, robot) returns. Methods of robots have kernels of the same names."
        )
    if function.lanes > 1 or not function.inputs or not function.outputs:
        raise InputError(
            f"`kernel` is {function.name}; expected one with inputs and outputs that evaluates one sample in one "
            "lane. Searches have no derivatives."
        )
    return function


__all__ = ["to_jax", "to_torch"]
