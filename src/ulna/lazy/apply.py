"""A function of arrays on Dask arrays: lazy, cut along the leading axes, of known shape and type."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ulna.checks.arrays import batched_shape, check_core_shape, real_array
from ulna.checks.labels import is_labelled
from ulna.errors import DtypeError, InputError, ShapeError, needed
from ulna.lazy.portable import Portable
from ulna.lazy.slot import Slot


def is_dask(value: Any) -> bool:
    """Whether `value` is a Dask array."""
    kind = type(value)
    return kind.__name__ == "Array" and kind.__module__.startswith("dask.")


def is_deferred(value: Any) -> bool:
    """Whether `value` is an array of Dask or of xarray, which `apply` takes."""
    return type(value) is not np.ndarray and (is_dask(value) or is_labelled(value))


def apply(
    function: Callable[..., Any],
    arguments: Sequence[Any],
    inputs: Sequence[Slot],
    outputs: Sequence[Slot],
    *,
    is_single: bool = True,
) -> Any:
    """A function of arrays with any leading axes, applied to Dask arrays or to arrays of xarray.

    Leading axes broadcast. Nothing is computed of Dask arrays, and the function is not called to learn shapes or types.

    Args:
        function: Takes NumPy arrays with any leading axes; it can be pickled.
        arguments: Arrays (..., *shape) of NumPy, Dask or xarray, at least one of the latter two.
        inputs: What the function takes.
        outputs: What it returns.
        is_single: Whether it returns one array; else a tuple.

    Returns:
        A Dask array (..., *shape), an array of xarray if there is one among the arguments, or a tuple of such.

    Raises:
        ShapeError: If the last axes of an argument are not as they must be, or leading axes do not broadcast.
        DtypeError: If an argument holds something else than real numbers.
        InputError: If an array of xarray has labels that are not those of its slot.
        MissingExtra: If Dask is not installed.
    """
    portable = function if isinstance(function, Portable) else Portable(function)
    if any(is_labelled(value) for value in arguments):
        from ulna.lazy.labelled import apply_labelled  # imported here: rarely needed

        def run(*arrays: Any) -> Any:
            if not any(is_dask(array) for array in arrays):
                return portable.function(*arrays)
            return _on_dask(portable, arrays, inputs, outputs, is_single)

        return apply_labelled(run, arguments, inputs, outputs, is_single)
    return _on_dask(portable, arguments, inputs, outputs, is_single)


def _on_dask(
    function: Portable,
    arguments: Sequence[Any],
    inputs: Sequence[Slot],
    outputs: Sequence[Slot],
    is_single: bool,
) -> Any:
    with needed("dask", "cluster", "Working on Dask arrays"):
        import dask.array as da  # pyright: ignore[reportMissingImports]
    arrays = [_operand(value, slot) for value, slot in zip(arguments, inputs, strict=True)]
    _check_batch(arrays, inputs)
    names = [
        [f"s{k}_{axis}" for axis in range(len(slot.shape))] for k, slot in enumerate((*inputs, *outputs))
    ]
    terms = [f"({','.join(axes)})" for axes in names]
    sizes = {
        name: length
        for axes, slot in zip(names[len(inputs) :], outputs, strict=True)
        for name, length in zip(axes, slot.shape, strict=True)
    }
    kinds: Any = [slot.dtype for slot in outputs]
    signature = ",".join(terms[: len(inputs)]) + "->" + ",".join(terms[len(inputs) :])
    if not is_single and len(outputs) == 1:
        signature += ","
    return da.apply_gufunc(
        function,
        signature,
        *arrays,
        output_dtypes=kinds[0] if is_single else kinds,
        output_sizes=sizes,
        allow_rechunk=True,
    )


def _operand(value: Any, slot: Slot) -> Any:
    """An argument with its last axes in one block."""
    if slot.dtype is object and not is_dask(value):
        return np.asarray(value, dtype=object)
    if not is_dask(value):
        if is_deferred(value) or not hasattr(value, "__array_ufunc__") or isinstance(value, np.ndarray):
            value = real_array(slot.name, value, shape=batched_shape(slot.shape), dtype=np.dtype(slot.dtype))
        check_core_shape(slot.name, value, slot.shape)
        return value
    if value.dtype.kind not in ("O" if slot.dtype is object else "fiub"):
        expected = "objects" if slot.dtype is object else "real numbers"
        raise DtypeError(slot.name, str(value.dtype), expected)
    start = value.ndim - len(slot.shape)
    known = value.shape[start:] if start >= 0 else ()
    if start < 0 or any(
        not math.isnan(a) and a != b for a, b in zip(known, slot.shape, strict=True)
    ):  # a length that is not known is examined with the numbers
        check_core_shape(slot.name, value, slot.shape)
    single_chunk = {axis: -1 for axis in range(start, value.ndim) if len(value.chunks[axis]) > 1}
    if single_chunk and any(math.isnan(n) for n in known):
        raise InputError(
            f"`{slot.name}` is cut along its last axes into blocks of unknown lengths; expected "
            f"{batched_shape(slot.shape)}. {slot.name}.compute_chunk_sizes() finds them."
        )
    return value.rechunk(single_chunk) if single_chunk else value


def _check_batch(arrays: Sequence[Any], inputs: Sequence[Slot]) -> None:
    """Refuses leading axes that do not broadcast; lengths that are not known fit 1 only."""
    batches = [a.shape[: a.ndim - len(slot.shape)] for a, slot in zip(arrays, inputs, strict=True)]
    for axis in range(1, max(map(len, batches)) + 1):
        lengths = [batch[-axis] if len(batch) >= axis else 1 for batch in batches]
        longer = [k for k, n in enumerate(lengths) if n != 1]
        unknown = [k for k in longer if math.isnan(lengths[k])]
        if len({lengths[k] for k in longer if k not in unknown}) > 1:
            shapes = ", ".join(f"`{slot.name}` {a.shape}" for a, slot in zip(arrays, inputs, strict=True))
            last = next(k for k in reversed(longer) if k not in unknown)
            raise ShapeError(
                inputs[last].name, arrays[last].shape, "leading axes that broadcast", f"Together: {shapes}."
            )
        if unknown and len(longer) > 1:
            name, other = (inputs[k].name for k in (unknown[0], next(k for k in longer if k != unknown[0])))
            raise InputError(
                f"`{name}` has blocks of unknown lengths, beside `{other}`; expected known ones. "
                f"{name}.compute_chunk_sizes() finds them."
            )
