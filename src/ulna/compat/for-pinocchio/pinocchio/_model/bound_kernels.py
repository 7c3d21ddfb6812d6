"""Kernels bound to arrays that stay, and kernels whose last inputs are parameters of a model."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, final

import numpy as np

from pinocchio._containers.arrays import not_applicable
from ulna.typing import Array, Floats


@final
class ParameterKernel:
    """A kernel whose last inputs are parameters of a model; they are passed with every call."""

    def __init__(self, kernel: Any, parameters: tuple[Floats, ...]) -> None:
        self.kernel, self.parameters = kernel, parameters
        self.function = kernel.function

    def __call__(self, *args: Any, **options: Any) -> Any:
        """Evaluates the kernel."""
        return self.kernel(*args, *self.parameters, **options)

    def into(self, *targets: Floats, last_inputs: Sequence[Floats] = (), **options: Any) -> Any:
        """The kernel bound to arrays; see `KernelBase.into`.

        Args:
            *targets: Arrays (...) for the outputs.
            last_inputs: Arrays (...) for the last inputs before the parameters.
            **options: Other arguments of `KernelBase.into`.

        Returns:
            The bound kernel.
        """
        return self.kernel.into(*targets, last_inputs=(*last_inputs, *self.parameters), **options)


def not_read(kernel: Any, watch: list[tuple[Array, Array]]) -> list[tuple[Array, Array]]:
    """The pairs of watched arrays that a kernel does not read at every call anyway.

    Args:
        kernel: The kernel.
        watch: Pairs of an array (...) and a copy of it.

    Returns:
        Those pairs, (...) each.
    """
    read = kernel.parameters if isinstance(kernel, ParameterKernel) else ()
    return [pair for pair in watch if not any(np.may_share_memory(pair[0], x) for x in read)]


@final
class BoundKernel:
    """A kernel of whose first output every call returns a copy; NotImplemented for arguments that need conversion.

    Args:
        kernel: The kernel.
        watch: Pairs of an array and a copy; the kernel does not apply once they differ.
        others: Arrays for the other outputs.
        last_inputs: Arrays that its last inputs are read from at every call.
        holder: A class with one slot, of which every call returns an instance that holds the copy.
    """

    def __init__(
        self,
        kernel: Any,
        watch: Any = (),
        others: Sequence[Floats] = (),
        last_inputs: Sequence[Floats] = (),
        holder: type | None = None,
    ) -> None:
        self.result: Floats = np.zeros(kernel.function.outputs[0].shape)
        targets = self.result, *others
        self.call = kernel.into(
            *targets,
            returns=(0,),
            watch=watch,
            otherwise=not_applicable,
            last_inputs=last_inputs,
            holder=holder,
        )
