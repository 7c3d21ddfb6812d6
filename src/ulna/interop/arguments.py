"""Checks of arrays of other libraries against the inputs of a function: shapes and batch axes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ulna.checks.arrays import batched_shape
from ulna.compiler import Function
from ulna.errors import InputError, ShapeError


def check_count(f: Function, arguments: Sequence[Any], named: Sequence[str] = ()) -> None:
    """Refuses another number of arguments than a function has.

    Args:
        f: The function.
        arguments: The arguments.
        named: Names of the arguments that were passed by name; none may be.

    Raises:
        TypeError: If their number differs.
        InputError: If there are named ones.
    """
    names = ", ".join(p.name for p in f.inputs)
    if named:
        raise InputError(f"{f.name}({names}) got `{named[0]}` by name; expected arguments by position.")
    if len(arguments) != len(f.inputs):
        raise TypeError(f"{f.name}({names}) takes {len(f.inputs)} arguments; {len(arguments)} were given.")


def batch_shape(f: Function, shapes: Sequence[tuple[int, ...]]) -> tuple[int, ...]:
    """The leading axes of all arguments together.

    Args:
        f: The function.
        shapes: Shape of each argument.

    Returns:
        The shape that the batch axes broadcast to.

    Raises:
        ShapeError: If the last axes of an argument are not those of the input, or batch axes do not broadcast.
    """
    batches = []
    for port, shape in zip(f.inputs, shapes, strict=True):
        lead = len(shape) - len(port.shape)
        if lead < 0 or tuple(shape[lead:]) != port.shape:
            raise ShapeError(port.name, tuple(shape), batched_shape(port.shape))
        batches.append(tuple(shape[:lead]))
    try:
        return np.broadcast_shapes(*batches)
    except ValueError:
        together = ", ".join(f"`{p.name}` {tuple(s)}" for p, s in zip(f.inputs, shapes, strict=True))
        raise ShapeError(
            f.inputs[-1].name,
            tuple(shapes[-1]),
            "leading axes that broadcast",
            f"Together: {together}.",
        ) from None
