"""A function of arrays on arrays of xarray: leading dimensions keep their names and coordinates."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from ulna.checks.arrays import batched_shape
from ulna.checks.labels import is_labelled, ordered
from ulna.errors import ShapeError
from ulna.lazy.slot import Slot

_NAMES = ("component", "row", "column")


def apply_labelled(
    run: Callable[..., Any],
    arguments: Sequence[Any],
    inputs: Sequence[Slot],
    outputs: Sequence[Slot],
    is_single: bool,
) -> Any:
    """A function on arrays of xarray, whose last dimensions are those of its slots, whatever their names.

    Args:
        run: Takes the data of the arrays, of NumPy or Dask.
        arguments: Arrays (..., *shape), at least one of xarray.
        inputs: What the function takes.
        outputs: What it returns.
        is_single: Whether it returns one array.

    Returns:
        Arrays of xarray with all leading dimensions and their coordinates. A vector with the labels of an argument, or
        without known ones and as long, has the name of its dimension and its labels; else last dimensions are
        "component", or "row" and "column".

    Raises:
        ShapeError: If an array has too few dimensions.
        InputError: If the labels of a last dimension are not those of the slot.
    """
    import xarray  # pyright: ignore[reportMissingImports]

    arrays, cores = [], []
    for value, slot in zip(arguments, inputs, strict=True):
        array, dims = _core_dims(value, slot) if is_labelled(value) else (value, ())
        arrays.append(array)
        cores.append(list(dims))
    taken = {name for value in arrays if is_labelled(value) for name in value.dims}
    vectors = [
        (slot, dims[0]) for slot, dims in zip(inputs, cores, strict=True) if len(dims) == len(slot.shape) == 1
    ]
    results = [_result_dims(slot, vectors, taken) for slot in outputs]
    applied = xarray.apply_ufunc(
        run, *arrays, input_core_dims=cores, output_core_dims=results, dask="allowed", keep_attrs=False
    )
    return applied if is_single or isinstance(applied, tuple) else (applied,)


def _core_dims(array: Any, slot: Slot) -> tuple[Any, tuple[Any, ...]]:
    """The array with its last dimension in the order of the slot's labels, and the names of its last dimensions."""
    count = len(slot.shape)
    if array.ndim < count:
        raise ShapeError(slot.name, array.shape, batched_shape(slot.shape))
    dims = array.dims[array.ndim - count :]
    return ordered(slot.name, array, dims, slot.labels), dims


def _result_dims(slot: Slot, vectors: Sequence[tuple[Slot, Any]], taken: set[Any]) -> list[Any]:
    if not slot.shape:
        return []
    alike = [dim for other, dim in vectors if other.shape == slot.shape and _may_be_labelled_as(slot, other)]
    if alike:
        return [alike[-1]]
    if len(slot.shape) == 1:
        names = [_NAMES[0]]
    else:
        names = [f"axis_{k}" for k in range(len(slot.shape) - 2)] + list(_NAMES[1:])
    return [name if name not in taken else f"{name}_of_{slot.name or 'result'}" for name in names]


def _may_be_labelled_as(result: Slot, argument: Slot) -> bool:
    if result.labels is None:
        return True
    return argument.labels is not None and list(argument.labels) == list(result.labels)
