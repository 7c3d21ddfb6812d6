"""Arguments that are no NumPy arrays, and what is said of them."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.checks.arrays import batched_shape
from ulna.compiler.language.ports import Port
from ulna.errors import InputError
from ulna.lazy import is_deferred

_TABLES = ("pandas", "polars", "xarray", "pyarrow", "dask", "dask_expr")


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
    if _library(value) not in _TABLES or is_deferred(value):
        return
    name = type(value).__name__
    advice = "Take its columns in the order of the joints: q[list(robot.joint_names)].to_numpy()."
    if _library(value).startswith("dask"):
        advice = "Take its columns in the order of the joints: q[list(robot.joint_names)].to_dask_array(lengths=True)."
    elif name != "DataFrame":
        advice = "Take its numbers: q.to_numpy()."
    raise InputError(
        f"`{port.name}` is a {name} of {_library(value)}; expected an array {batched_shape(port.shape)}. "
        + advice.replace("q[", f"{port.name}[").replace("q.", f"{port.name}.")
    )


def _library(value: Any) -> str:
    """The package that the type of a value comes from."""
    return type(value).__module__.partition(".")[0]
