"""Checks of arrays of numbers: types, shapes, finite entries, and rotations among them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from ulna.checks.labels import in_order, refuse_labels
from ulna.checks.masked import check_not_masked
from ulna.checks.values import MAX_LENGTH, short_repr
from ulna.errors import FIND_NAN, DtypeError, InputError, NonFiniteError, ShapeError, TraceError
from ulna.numeric import is_symbolic
from ulna.typing import Array, Floats

_FLOAT = np.dtype(float)
_ONE_THREAD = (
    8192  # entries; scalar products of more take threads of OpenBLAS, which wait by keeping processors busy
)
_NAMES_ARE_KEYS = 'Configurations with names are arrays in robot.configurations: robot.configurations["qr"].'
_OF_SOLUTION = "Pass its configuration, `.q`, after a look at `.success`."
_IN_ORDER = "Put its values in order: np.array([q[name] for name in robot.joint_names])."


def _never(_: object) -> bool:
    return False


def real_array(
    name: str,
    value: Any,
    expected: str = "real numbers",
    *,
    shape: str = "",
    dtype: Any = _FLOAT,
    kinds: str = "fiub",
    is_symbol: Callable[[Any], bool] = _never,
) -> Array:
    """An array of numbers, or of objects where an entry is a symbol; nan and inf pass.

    Args:
        name: The name of the argument, for the message.
        value: An array, a number, or nested lists of numbers.
        expected: What was expected, for messages.
        shape: The shape that was expected, for messages.
        dtype: The type of the numbers returned.
        kinds: The kinds of types that are accepted, as `dtype.kind` names them.
        is_symbol: Which objects stay as they are, such as traced scalars.

    Returns:
        The array (...) of type `dtype`, or of objects; the same array where it has that type already.

    Raises:
        DtypeError: It holds something else than real numbers.
        InputError: Rows differ in length, or entries are masked.
        TraceError: It holds traced values that are no symbols here.
    """
    if type(value) is not np.ndarray:
        check_not_masked(name, value)
        refuse_labels(name, value)
        try:
            value = np.asarray(value)
        except ValueError as error:
            text = f"`{name}` is made of rows of different lengths; expected {shape or expected}."
            raise InputError(f"{text} NumPy says: {error}") from None
    if value.dtype == dtype:
        return value
    if value.dtype == object:
        return _from_objects(name, value, expected, dtype, is_symbol)
    kind = value.dtype.kind
    if kind not in kinds:
        raise DtypeError(
            name, str(value.dtype), expected, _NAMES_ARE_KEYS if kind in "US" and name[:1] == "q" else ""
        )
    return value.astype(dtype)


def _from_objects(
    name: str, array: Array, expected: str, dtype: Any, is_symbol: Callable[[Any], bool]
) -> Array:
    """An array of objects as numbers of `dtype`, if none of them is a symbol."""
    if array.ndim == 0 and isinstance(array[()], Mapping):
        raise DtypeError(name, "dict", expected, _IN_ORDER)
    if array.ndim == 0 and hasattr(array[()], "q") and hasattr(array[()], "success"):
        raise DtypeError(name, type(array[()]).__name__, expected, _OF_SOLUTION)
    for x in array.flat:  # NumPy would make nan of None, parse text and drop imaginary parts
        if x is None or isinstance(x, (str, bytes, complex)):
            raise DtypeError(name, f"object and holds {short_repr(x)}", expected)
    if any(is_symbol(x) for x in array.flat):
        return array
    try:
        return array.astype(dtype)
    except TraceError:  # it says what to use instead
        raise
    except (TypeError, ValueError, OverflowError) as error:
        raise DtypeError(name, "object", expected, f"NumPy says: {error}.") from None


def batched_shape(core: tuple[int, ...]) -> str:
    """A shape with leading axes, as text."""
    return "(" + ", ".join(["...", *map(str, core)]) + ")"


def check_core_shape(name: str, array: Array, core: tuple[int, ...], fix: str = "") -> None:
    """Checks the last axes of an array.

    Args:
        name: The name of the argument, for the message.
        array: The array, shape (..., *core).
        core: The lengths that its last axes must have.
        fix: How to correct it, for the message; empty for advice found from the shapes.

    Raises:
        ShapeError: its last axes are not `core`.
    """
    start = array.ndim - len(core)
    if start < 0 or array.shape[start:] != core:
        raise ShapeError(name, array.shape, batched_shape(core), fix or _shape_advice(array.shape, core))


def _shape_advice(shape: tuple[int, ...], core: tuple[int, ...]) -> str:
    """What may be wrong with a shape of which the last axes should be `core`."""
    if shape and core and shape[::-1][: len(core)] == core:
        return "It looks transposed."
    if len(shape) == len(core) + 1 and shape[: len(core)] == core:
        return "The batch axis comes first: pass the transpose."
    if len(core) == 1 and shape and shape[-1] != core[0]:
        return f"The last axis holds the {core[0]} numbers of one sample."
    return ""


def check_finite(name: str, array: Floats, fix: str = FIND_NAN) -> None:
    """Checks that no entry of an array is nan or inf.

    Args:
        name: The name of the argument, for the message.
        array: The array, shape (...).
        fix: How to correct it, for the message.

    Raises:
        NonFiniteError: an entry is; names the first one.
    """
    if array.size <= _ONE_THREAD:
        total = np.vdot(array, array)  # one cheap pass in the good case
    else:
        with np.errstate(all="ignore"):
            total = array.sum()
    if math.isfinite(total):
        return
    bad = ~np.isfinite(array)
    if bad.any():
        index = tuple(int(i) for i in np.argwhere(bad)[0])
        raise NonFiniteError(name, index, float(array[index]), fix)


def check_not_negative(name: str, array: Floats, noun: str = "numbers") -> None:
    """Checks that no entry of an array of finite numbers is negative.

    Args:
        name: The name of the argument, for the message.
        array: The array, shape (...).
        noun: What the entries are, for the message.

    Raises:
        InputError: an entry is; names the least one.
    """
    array = np.asarray(array)
    if array.size and (least := array.min()) < 0.0:
        raise InputError(f"`{name}` holds {least:g}; expected {noun} of zero or more.")


def finite_array(name: str, value: Any, expected: str = "numbers") -> Floats:
    """A copy of finite numbers, in whatever shape; True and False are none.

    Args:
        name: The name of the argument, for the message.
        value: What was passed.
        expected: What was expected, for the message.

    Returns:
        A new array (...) in the shape of `value`.

    Raises:
        InputError: rows differ in length, or entries are masked.
        NonFiniteError: nan or inf among them.
        DtypeError: they are no numbers.
    """
    out = np.array(real_array(name, value, expected, kinds="fiu"))
    check_finite(name, out, "Look where it comes from.")
    return out


def read_only(array: Array) -> Array:
    """An array that NumPy refuses to write to: for copies, where writing would have no effect.

    Args:
        array: An array that nobody else holds, shape (...) [any].

    Returns:
        The same array, shape (...) [any].
    """
    array.setflags(write=False)
    return array


def known_limits(limits: Floats) -> Floats:
    """Limits of speed or effort; a limit of zero says in files that none is known, and is infinite here.

    Args:
        limits: Limits, shape (...) [any].

    Returns:
        The limits, shape (...) [any].
    """
    return np.where(limits > 0.0, limits, np.inf)


def shaped_array(
    name: str, value: Any, *shape: int | None, fix: str = "", labels: Sequence[str] | None = None
) -> Floats:
    """A copy of finite numbers of a given shape.

    Args:
        name: The name of the argument, for the message.
        value: What was passed.
        *shape: The lengths of the axes; None for any length.
        fix: How to correct it, for the message.
        labels: What the entries of the last axis are called: arrays of xarray are put in that order.

    Returns:
        A new array (...) of that shape.

    Raises:
        InputError: rows differ in length, entries are masked, or labels are others.
        ShapeError: another shape.
        NonFiniteError: nan or inf among them.
        DtypeError: they are no numbers.
    """
    if labels is not None:
        value = in_order(name, value, labels)
    out = finite_array(name, value)
    if out.shape != shape and (
        len(shape) != out.ndim or any(n not in (None, m) for n, m in zip(shape, out.shape, strict=True))
    ):
        wanted = str(tuple("n" if n is None else n for n in shape)).replace("'", "")
        raise ShapeError(name, out.shape, wanted if shape else "one number", fix)
    return out


def number_or_array(name: str, value: Any, count: int) -> Floats:
    """One number for all entries, or one for each; inf and nan pass.

    Args:
        name: The name of the argument, for the message.
        value: What was passed.
        count: The number of entries.

    Returns:
        A read-only array, shape (count,).

    Raises:
        InputError: rows differ in length, or entries are masked.
        ShapeError: another count.
        DtypeError: they are no numbers.
    """
    out = real_array(name, value, f"one number or ({count},)")
    if out.shape not in ((), (count,)):
        raise ShapeError(name, out.shape, f"one number or ({count},)")
    return np.broadcast_to(out, (count,))


def length_array(name: str, value: Any, *shape: int | None, fix: str = "") -> Floats:
    """As `shaped_array`, for lengths that a screen can show.

    Args:
        name: The name of the argument, for the message.
        value: What was passed [m].
        *shape: The lengths of the axes; None for any length.
        fix: How to correct it, for the message.

    Returns:
        A new array (...) of that shape [m].

    Raises:
        InputError: rows differ in length, entries are masked, or a length is above `MAX_LENGTH`.
        ShapeError: another shape.
        NonFiniteError: nan or inf among them.
        DtypeError: they are no numbers.
    """
    out = shaped_array(name, value, *shape, fix=fix)
    if out.size and max(out.max(), -out.min()) > MAX_LENGTH:
        raise InputError(
            f"`{name}` reaches as far as {np.abs(out).max():g} m; expected at most {MAX_LENGTH:g} m."
        )
    return out


def scale_factors(name: str, value: Any, *count: int) -> Floats:
    """Factors above zero along each axis.

    Args:
        name: The name of the argument, for the message.
        value: What was passed, shape (*count, 3), (3,) or one number [-].
        *count: The batch axes of the result.

    Returns:
        A new array, shape (*count, 3) [-].

    Raises:
        InputError: they are no numbers, not above zero, or above `MAX_LENGTH`.
        ShapeError: another shape.
        NonFiniteError: nan or inf among them.
    """
    out = finite_array(name, value, "a factor, or one along each axis")
    if out.shape not in ((), (3,), (*count, 3)):
        raise ShapeError(name, out.shape, f"{(*count, 3)}, (3,), or one number")
    if out.size and not (out.min() > 0.0 and out.max() <= MAX_LENGTH):
        raise InputError(
            f"`{name}` is {short_repr(value)}; expected factors above zero, at most {MAX_LENGTH:g}."
        )
    return np.array(np.broadcast_to(out, (*count, 3)))


def batched_array(name: str, value: Any, shape: tuple[int, ...], fix: str = "") -> Array:
    """An array of finite floats, or of traced scalars or symbols, with any leading batch axes.

    Args:
        name: The name of the argument, for the message.
        value: What was passed.
        shape: The trailing axes.
        fix: How to correct it, for the message.

    Returns:
        The array, shape (..., *shape).

    Raises:
        ShapeError: the trailing axes are not `shape`.
        DtypeError: not real numbers.
        NonFiniteError: nan or inf among the numbers.
        InputError: rows differ in length.
    """
    array = real_array(name, value, shape=batched_shape(shape), is_symbol=is_symbolic)
    check_core_shape(name, array, shape, fix)
    if array.dtype != object:
        check_finite(name, array)
    return array
