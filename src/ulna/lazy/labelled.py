"""A function of arrays on arrays of xarray: leading dimensions keep their names and coordinates."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from ulna.checks.arrays import batched_shape
from ulna.checks.values import short_repr
from ulna.errors import InputError, ShapeError
from ulna.lazy.slot import Slot

_NAMES = ("component", "row", "column")


def is_labelled(value: Any) -> bool:
    """Whether `value` is a `DataArray` of xarray."""
    kind = type(value)
    return kind.__name__ == "DataArray" and kind.__module__.startswith("xarray.") and hasattr(value, "dims")


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
        Arrays of xarray with all leading dimensions and their coordinates. A vector that is as long as one of an
        argument has the name of that dimension and its labels; else last dimensions are "component", or "row" and
        "column".

    Raises:
        ShapeError: If an array has too few dimensions.
        InputError: If the labels of a last dimension are not those of the slot.
    """
    import xarray  # pyright: ignore[reportMissingImports]

    ordered, cores = [], []
    for value, slot in zip(arguments, inputs, strict=True):
        array, dims = _core_dims(value, slot) if is_labelled(value) else (value, ())
        ordered.append(array)
        cores.append(list(dims))
    taken = {name for value in ordered if is_labelled(value) for name in value.dims}
    vectors = {
        slot.shape[0]: dims[0]
        for slot, dims in zip(inputs, cores, strict=True)
        if len(dims) == 1 and len(slot.shape) == 1
    }
    results = [_result_dims(slot, vectors, taken) for slot in outputs]
    applied = xarray.apply_ufunc(
        run, *ordered, input_core_dims=cores, output_core_dims=results, dask="allowed", keep_attrs=False
    )
    return applied if is_single or isinstance(applied, tuple) else (applied,)


def _core_dims(array: Any, slot: Slot) -> tuple[Any, tuple[Any, ...]]:
    """The array with its last dimension in the order of the slot's labels, and the names of its last dimensions."""
    count = len(slot.shape)
    if array.ndim < count:
        raise ShapeError(slot.name, array.shape, batched_shape(slot.shape))
    dims = array.dims[array.ndim - count :]
    for dim in dims:
        if dim not in array.coords or array[dim].dtype.kind not in "OUST":
            continue
        labels = [str(label) for label in array[dim].values.tolist()]
        if slot.labels is None:
            raise InputError(
                f"`{slot.name}` has labels along {dim!r}, {short_repr(labels)}; the order of its numbers is not known "
                f"by names. Put them in order and leave the labels out: {slot.name}.drop_vars({dim!r})."
            )
        if sorted(labels) != sorted(slot.labels):
            raise InputError(
                f"`{slot.name}` has labels {short_repr(labels)} along {dim!r}; expected {list(slot.labels)}, in any "
                f"order. {slot.name}.drop_vars({dim!r}) leaves them out; then numbers count by their places."
            )
        if labels != list(slot.labels):
            array = array.sel({dim: list(slot.labels)})
    return array, dims


def _result_dims(slot: Slot, vectors: dict[int, Any], taken: set[Any]) -> list[Any]:
    if not slot.shape:
        return []
    if len(slot.shape) == 1:
        if slot.shape[0] in vectors:
            return [vectors[slot.shape[0]]]
        names = [_NAMES[0]]
    else:
        names = [f"axis_{k}" for k in range(len(slot.shape) - 2)] + list(_NAMES[1:])
    return [name if name not in taken else f"{name}_of_{slot.name or 'result'}" for name in names]
