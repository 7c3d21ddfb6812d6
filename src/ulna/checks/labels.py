"""Arrays of xarray whose last axis has names: their numbers are put in the order of the names."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ulna.checks.values import short_repr
from ulna.errors import InputError


def is_labelled(value: Any) -> bool:
    """Whether `value` is a `DataArray` of xarray."""
    kind = type(value)
    return kind.__name__ == "DataArray" and kind.__module__.startswith("xarray.") and hasattr(value, "dims")


def in_order(name: str, value: Any, labels: Sequence[str]) -> Any:
    """An array whose last axis has the order of `labels`: that of xarray with names is put in it, others stay.

    Args:
        name: The name of the argument, for the message.
        value: What was passed.
        labels: The names in order.

    Returns:
        The array, or whatever `value` is.

    Raises:
        InputError: The names of the array are others, or stand along another axis.
    """
    if not is_labelled(value) or not value.ndim:
        return value
    return ordered(name, value, value.dims[-1:], labels)


def ordered(name: str, array: Any, dims: Sequence[Any], labels: Sequence[str] | None) -> Any:
    """An array of xarray with its last dimensions in order.

    Args:
        name: The name of the argument, for the message.
        array: The array.
        dims: Its last dimensions, which count.
        labels: What the entries of the last one are called, in order; None where nothing is known of that.

    Returns:
        The array in that order.

    Raises:
        InputError: Labels of these dimensions are others; or those that are expected stand along a dimension before.
    """
    for dim in dims:
        names = _labels_along(array, dim)
        if names is None:
            continue
        if labels is None:
            raise InputError(
                f"`{name}` has labels along {dim!r}, {short_repr(names)}; the order of its numbers is not known "
                f"by names. Put them in order and leave the labels out: {name}.drop_vars({dim!r})."
            )
        if sorted(names) != sorted(labels):
            raise InputError(
                f"`{name}` has labels {short_repr(names)} along {dim!r}; expected {list(labels)}, in any "
                f"order. {name}.drop_vars({dim!r}) leaves them out; then numbers count by their places."
            )
        if names != list(labels):
            array = array.sel({dim: list(labels)})
    for dim in array.dims[: array.ndim - len(dims)] if labels and dims else ():
        if sorted(_labels_along(array, dim) or ()) == sorted(labels or ()):
            raise InputError(
                f"`{name}` has the labels {short_repr(list(labels or ()))} along {dim!r}; expected them along its last "
                f"dimension: {name}.transpose(..., {dim!r})."
            )
    return array


def _labels_along(array: Any, dim: Any) -> list[str] | None:
    """The names along a dimension; None where it has none."""
    if dim not in array.coords or array[dim].dtype.kind not in "OUST":
        return None
    return [str(label) for label in array[dim].values.tolist()]
