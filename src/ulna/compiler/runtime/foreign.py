"""Arguments that are no NumPy arrays, and the messages about them."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.checks.arrays import batched_shape
from ulna.compiler.language.ports import Port
from ulna.errors import InputError
from ulna.lazy import is_deferred

_TABLES = ("pandas", "polars", "xarray", "pyarrow", "dask", "dask_expr")

_TENSORS = {
    "torch": "ulna.interop.to_torch(kernel) makes a function of tensors, with derivatives.",
    "jax": "ulna.interop.to_jax(kernel) makes a function for jax.jit, vmap and grad.",
    "jaxlib": "ulna.interop.to_jax(kernel) makes a function of JAX arrays.",
}


def is_foreign(value: Any) -> bool:
    """Whether an argument brings its own meaning of ufuncs: subclasses of ndarray, Dask arrays and the like.

    Objects that take no part in ufuncs, such as poses, say so by None; they are read as arrays.
    """
    return (
        type(value) is not np.ndarray
        and getattr(value, "__array_ufunc__", None) is not None
        and not isinstance(value, np.generic)
    )


def reject_tables(port: Port, value: Any) -> None:
    """Refuses tables with named columns: their order need not be that of the numbers in an array.

    Args:
        port: Name and shape of the input.
        value: What was passed.

    Raises:
        InputError: If the value is one.
    """
    if package_of(value) not in _TABLES or is_deferred(value):
        return
    name = type(value).__name__
    advice = "Take its columns in the order of the joints: q[list(robot.joint_names)].to_numpy()."
    if package_of(value).startswith("dask"):
        advice = "Take its columns in the order of the joints: q[list(robot.joint_names)].to_dask_array(lengths=True)."
    elif name != "DataFrame":
        advice = "Take its numbers: q.to_numpy()."
    raise InputError(
        f"`{port.name}` is a {name} of {package_of(value)}; expected an array {batched_shape(port.shape)}. "
        + advice.replace("q[", f"{port.name}[").replace("q.", f"{port.name}.")
    )


def readable(port: Port, value: Any) -> Any:
    """An argument as NumPy can read it: tensors of PyTorch and arrays of JAX as arrays, all else as it is.

    Args:
        port: Name and shape of the input.
        value: What was passed.

    Returns:
        The array over the tensor's memory, or the value.

    Raises:
        InputError: If the tensor records derivatives, is on a GPU, or stands for one in a transformation.
    """
    library = package_of(value)
    if library not in _TENSORS:
        return value
    try:
        return np.asarray(value)
    except (RuntimeError, TypeError) as error:
        raise InputError(
            f"`{port.name}` is a {type(value).__name__} of {library} that NumPy cannot read: "
            f"{str(error).splitlines()[0]} {_TENSORS[library]}"
        ) from None


def package_of(value: Any) -> str:
    """The package that the type of a value comes from."""
    return type(value).__module__.partition(".")[0]
