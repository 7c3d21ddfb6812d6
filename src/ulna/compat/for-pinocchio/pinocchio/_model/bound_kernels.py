"""Kernels bound to preallocated arrays, and kernels whose last inputs are parameters of a model."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, final

import numpy as np
from numpy.lib.array_utils import byte_bounds

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

    def into(self, *targets: Floats, trailing_inputs: Sequence[Floats] = (), **options: Any) -> Any:
        """The kernel bound to arrays; see `KernelBase.into`.

        Args:
            *targets: Arrays (...) for the outputs.
            trailing_inputs: Arrays (...) for the last inputs before the parameters.
            **options: Other arguments of `KernelBase.into`.

        Returns:
            The bound kernel.
        """
        return self.kernel.into(*targets, trailing_inputs=(*trailing_inputs, *self.parameters), **options)


def not_read(kernel: Any, watch: list[tuple[Array, Array]]) -> list[tuple[Array, Array]]:
    """The pairs of watched arrays that a kernel does not read at every call anyway.

    Args:
        kernel: The kernel.
        watch: Pairs of an array (...) and a copy of it.

    Returns:
        Those pairs, (...) each.
    """
    read = kernel.parameters if isinstance(kernel, ParameterKernel) else ()
    return [pair for pair in watch if not any(_contains(x, pair[0]) for x in read)]


def _contains(whole: Floats, part: Array) -> bool:
    """Whether all entries of an array are among those of another that has no gaps."""
    (first, end), (low, high) = byte_bounds(whole), byte_bounds(part)
    return whole.flags.forc and first <= low and high <= end


@final
class BoundKernel:
    """A kernel of whose first output every call returns a copy; NotImplemented for arguments that need conversion.

    Args:
        kernel: The kernel.
        watch: Pairs of an array and a copy; the kernel does not apply once they differ.
        others: Arrays for the other outputs.
        trailing_inputs: Arrays that its last inputs are read from at every call.
        holder: A class with one slot, of which every call returns an instance that holds the copy.
        input_holders: For each input that calls pass, a class with one slot of which an instance is passed in place of
            the array, or None.
        condition: The index of the output that is above zero where the kernel applies.
        otherwise: What is called where it does not.
    """

    def __init__(
        self,
        kernel: Any,
        watch: Any = (),
        others: Sequence[Floats] = (),
        trailing_inputs: Sequence[Floats] = (),
        holder: type | None = None,
        input_holders: Sequence[type | None] = (),
        condition: int | None = None,
        otherwise: Any = not_applicable,
    ) -> None:
        self.result: Floats = np.zeros(kernel.function.outputs[0].shape)
        targets = self.result, *others
        self.call = kernel.into(
            *targets,
            returns=(0,),
            watch=watch,
            otherwise=otherwise,
            trailing_inputs=trailing_inputs,
            holder=holder,
            input_holders=input_holders,
            condition=condition,
        )
