"""Arguments that are no NumPy arrays, and what is said of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ulna.checks.arrays import batched_shape
from ulna.compiler.language.function import Function
from ulna.compiler.language.ports import Port
from ulna.errors import InputError

_TABLES = ("pandas", "polars", "xarray", "pyarrow")


def is_foreign(value: Any) -> bool:
    """Whether an argument brings its own meaning of ufuncs: subclasses of ndarray, Dask arrays and the like."""
    return (
        type(value) is not np.ndarray
        and hasattr(value, "__array_ufunc__")
        and not isinstance(value, np.generic)
    )


def refuse_tables(port: Port, value: Any) -> None:
    """Refuses tables with named columns: their order need not be that of the numbers in an array.

    Args:
        port: Name and shape of the input.
        value: What was passed.

    Raises:
        InputError: If the value is one.
    """
    if _library(value) not in _TABLES:
        return
    name = type(value).__name__
    advice = "Take its columns in the order of the joints: q[list(robot.joint_names)].to_numpy()."
    if name != "DataFrame":
        advice = "Take its numbers: q.to_numpy()."
    raise InputError(
        f"`{port.name}` is a {name} of {_library(value)}; expected an array {batched_shape(port.shape)}. "
        + advice.replace("q[", f"{port.name}[").replace("q.", f"{port.name}.")
    )


def refuse_lazy(f: Function, args: Sequence[Any]) -> None:
    """Says what to do with Dask arrays, of which ufuncs with core axes do not know the shapes.

    Args:
        f: The function.
        args: What was passed for its inputs.

    Raises:
        InputError: If there is one among the arguments.
    """
    for a, port in zip(args, f.inputs, strict=True):
        if _library(a) == "dask":
            raise InputError(
                f"`{port.name}` is a Dask array of shape {a.shape}; "
                f"expected a NumPy array {batched_shape(port.shape)}. A kernel takes Dask arrays lazily: "
                f'robot.kernel("{f.name}").dask({port.name}), with the last axis in one chunk; or pass '
                f"{port.name}.compute()."
            ) from None


def _library(value: Any) -> str:
    """The package that the type of a value comes from."""
    return type(value).__module__.partition(".")[0]
