"""The named, shaped inputs and outputs of a function."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from math import prod
from typing import NamedTuple, Protocol

import numpy as np

from ulna.checks.arrays import batched_shape
from ulna.data_classes import dataclass
from ulna.errors import ShapeError
from ulna.typing import Array

Shape = tuple[int, ...]


@dataclass(frozen=True)
class Port:
    """An input or output: its name and the shape of one sample."""

    name: str
    shape: Shape

    @property
    def size(self) -> int:
        """How many numbers one sample holds."""
        return prod(self.shape)


def element_names(ports: Sequence[Port]) -> Iterator[str]:
    """Names of all numbers of the ports, in order: `q[0]`, `T[1,3]`, `x`."""
    for port in ports:
        for index in product(*(range(n) for n in port.shape)):
            yield port.name + (f"[{','.join(map(str, index))}]" if index else "")


def wrong_count(name: str, names: Sequence[str], arguments: Sequence[object]) -> TypeError:
    """What to raise where a function is called with too few or too many arguments.

    Args:
        name: The name of the function.
        names: The names of its inputs.
        arguments: What was passed.

    Returns:
        The error.
    """
    return TypeError(f"{name}({', '.join(names)}) takes {len(names)} arguments; {len(arguments)} were given.")


def batch_shape(ports: Sequence[Port], shapes: Sequence[Shape]) -> Shape:
    """The leading axes of all arguments together.

    Args:
        ports: The inputs.
        shapes: Shape of each argument.

    Returns:
        The shape that the batch axes broadcast to.

    Raises:
        ShapeError: The last axes of an argument are not those of the input, or batch axes do not broadcast.
    """
    batches = []
    for port, shape in zip(ports, shapes, strict=True):
        axes = len(shape) - len(port.shape)
        if axes < 0 or tuple(shape[axes:]) != port.shape:
            raise ShapeError(port.name, tuple(shape), batched_shape(port.shape))
        batches.append(tuple(shape[:axes]))
    try:
        return np.broadcast_shapes(*batches)
    except ValueError:
        together = ", ".join(f"`{p.name}` {tuple(s)}" for p, s in zip(ports, shapes, strict=True))
        raise ShapeError(
            ports[-1].name, tuple(shapes[-1]), "leading axes that broadcast", f"Together: {together}."
        ) from None


class Entries(NamedTuple):
    """What is known of the entries of a matrix, whatever the inputs.

    Attributes:
        is_set: Which of them are not always zero, (n, m).
        is_symmetric: Whether the matrix is symmetric.
    """

    is_set: Array
    is_symmetric: bool


class SecondForm(Protocol):
    """Another way to compute a function: of columns, or in stages (`ulna.compiler.forms.stages`)."""

    @property
    def inputs(self) -> tuple[Port, ...]:
        """The inputs of the function."""
        ...

    @property
    def outputs(self) -> tuple[Port, ...]:
        """The outputs of the function."""
        ...

    @property
    def operations(self) -> int:
        """How many operations are written out."""
        ...

    @property
    def serves_batches(self) -> bool:
        """Whether samples of a batch are computed in this form, too, one by one."""
        ...

    @property
    def entries(self) -> tuple[Entries | None, ...]:
        """What is known of each output that is a matrix; None for the others."""
        ...
