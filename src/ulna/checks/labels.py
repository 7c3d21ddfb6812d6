"""Arrays of xarray and tables whose last axis has names: their numbers are put in the order of the names."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ulna.checks.values import short_repr
from ulna.errors import InputError


def is_labelled(value: Any) -> bool:
    """Whether `value` is a `DataArray` of xarray."""
    kind = type(value)
    return kind.__name__ == "DataArray" and kind.__module__.startswith("xarray.") and hasattr(value, "dims")


_TABLES = {"DataFrame", "Series"}


def in_order(name: str, value: Any, labels: Sequence[str]) -> Any:
    """An array whose last axis has the order of `labels`: those with names are put in it, others stay.

    Args:
        name: The name of the argument, for the message.
        value: What was passed: an array of xarray, a table or series of pandas or polars, or anything else.
        labels: The names in order.

    Returns:
        The numbers without names, or whatever `value` is.

    Raises:
        InputError: The names of the array are others, or stand along another axis.
    """
    names = _table_labels(value)
    if names is not None:
        if sorted(names) != sorted(labels):
            raise InputError(
                f"`{name}` has labels {short_repr(names)}; expected {list(labels)}, in any order. "
                f"{name}.to_numpy() leaves them out; then numbers count by their places."
            )
        return np.asarray(value)[..., [names.index(label) for label in labels]]
    if not is_labelled(value) or not value.ndim:
        return value
    dim = value.dims[-1]
    return ordered(name, value, (dim,), labels).drop_vars(dim, errors="ignore")


def refuse_labels(name: str, value: Any) -> None:
    """Refuses arrays and tables whose last axis has names, where nothing is known of their order.

    Args:
        name: The name of the argument, for the message.
        value: What was passed.

    Raises:
        InputError: There are names.
    """
    if isinstance(value, (list, tuple)):  # rows of labelled arrays have labels
        if value:
            refuse_labels(f"{name}[0]", value[0])
        return
    names = _table_labels(value)
    if names is not None:
        raise InputError(
            f"`{name}` has labels, {short_repr(names)}; the order of its numbers is not known by names. Put them in "
            f"order and leave the labels out: {name}.to_numpy()."
        )
    if is_labelled(value) and value.ndim:
        ordered(name, value, value.dims[-1:], None)


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


def _table_labels(value: Any) -> list[str] | None:
    """The names of the columns of a table, or of the entries of a series; None where there are none."""
    kind = type(value)
    if kind.__name__ not in _TABLES or kind.__module__.partition(".")[0] not in ("pandas", "polars"):
        return None
    names = list(value.columns if kind.__name__ == "DataFrame" else getattr(value, "index", ()))
    return [str(x) for x in names] if any(isinstance(x, str) for x in names) else None


def _labels_along(array: Any, dim: Any) -> list[str] | None:
    """The names along a dimension; None where it has none."""
    if dim not in array.coords or array[dim].dtype.kind not in "OUST":
        return None
    return [str(label) for label in array[dim].values.tolist()]
