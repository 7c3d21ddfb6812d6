"""What all spatial types share: leading batch axes, indexing, comparison and text."""

from __future__ import annotations

import functools
import inspect
import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator
from typing import Any, ClassVar, Self, TypeVar

import numpy as np

from ulna.checks.arrays import batched_array, batched_shape, check_core_shape, real_array
from ulna.checks.values import short_repr
from ulna.errors import InputError, ShapeError, UnknownOperation
from ulna.numeric import dot, is_symbolic, sqrt
from ulna.typing import Array, ArrayLike

F = TypeVar("F", bound=Callable[..., Any])
FLOAT = np.dtype(float)
_WHOLE = "biu"  # kinds of whole numbers: products of small ones overflow, and unsigned ones have no negative


def component(name: str, value: Any) -> Any:
    """One number of a rotation or translation, or a batch of them; traced scalars and symbols stay.

    Args:
        name: The name of the argument, for the message.
        value: What was passed.

    Returns:
        The number [any], or an array (...).

    Raises:
        DtypeError, NonFiniteError: It is no finite number, such as None, a text or a complex number.
    """
    if isinstance(value, float) and math.isfinite(value):
        return value
    return batched_array(name, value, ())[()]


class Batched(ABC):
    """Arrays with common leading batch axes, which broadcast as NumPy's do."""

    __slots__ = ()
    __array_ufunc__ = None  # so that `array * motion` comes to Motion.__rmul__ instead of an object array

    _ranks: ClassVar[dict[str, int]]
    """For each field, the number of its own axes; those in front of them are batch axes."""

    @abstractmethod
    def _dense(self) -> Array:
        """The one array that stands for the whole, for `np.asarray`."""

    @property
    def batch_shape(self) -> tuple[int, ...]:
        """The shape of the batch; () for a single one."""
        shapes = []
        for name, rank in self._ranks.items():
            shape = np.shape(getattr(self, name))
            shapes.append(shape[: len(shape) - rank])
        return np.broadcast_shapes(*shapes)

    def _fields(self, batch: tuple[int, ...]) -> Iterator[Array]:
        """The array of each field, with all batch axes."""
        for name, rank in self._ranks.items():
            value = np.asarray(getattr(self, name))
            yield np.broadcast_to(value, batch + value.shape[value.ndim - rank :])

    def __len__(self) -> int:
        shape = self.batch_shape
        if not shape:
            raise TypeError(f"A single {type(self).__name__} has no length; its batch_shape is ().")
        return shape[0]

    def __bool__(self) -> bool:
        """False for an empty batch only, as of a list."""
        return not self.batch_shape or len(self) > 0

    def __getitem__(self, index: Any) -> Self:
        """The part of the batch that `index` picks, as for a NumPy array of shape `batch_shape`."""
        batch = self.batch_shape
        index = index if isinstance(index, tuple) else (index,)
        try:
            np.broadcast_to(0.0, batch)[index]  # raises where the index reaches beyond the batch axes
        except IndexError as error:
            raise IndexError(
                f"{error}. An index picks from a batch, of shape {batch} here; entries are those of the arrays, such "
                "as T.matrix()[..., :3, 3] or T.translation[..., 0]."
            ) from None
        has_ellipsis = any(i is Ellipsis for i in index)
        ranks = self._ranks.values()
        return type(self)(
            *(
                field[(*index, *[slice(None)] * rank)] if has_ellipsis else field[index]
                for field, rank in zip(self._fields(batch), ranks, strict=True)
            )
        )

    def __iter__(self) -> Iterator[Self]:
        for i in range(len(self)):
            yield self[i]

    @classmethod
    def stack(cls, items: Iterable[Self]) -> Self:
        """Joins `items` along a new first batch axis.

        Raises:
            InputError: There are none, or something among them is of another type.
            ShapeError: Their batch axes do not broadcast.
        """
        items = list(items) if isinstance(items, Iterable) else []
        if not items:
            raise InputError(f"`items` is empty; expected at least one {cls.__name__} to stack.")
        for item in items:
            if not isinstance(item, cls):
                raise InputError(
                    f"`items` holds {short_repr(item)}; expected objects of {cls.__name__} only."
                )
        shapes = [item.batch_shape for item in items]
        try:
            batch = np.broadcast_shapes(*shapes)
        except ValueError:
            raise ShapeError("items", shapes[-1], f"batch axes that broadcast with {shapes[0]}") from None
        return cls(
            *(np.stack(fields) for fields in zip(*(item._fields(batch) for item in items), strict=True))
        )

    def __eq__(self, other: object) -> bool:
        """Whether both are batches of one shape and hold the same numbers; `is_close` allows for rounding."""
        if type(other) is not type(self):
            return NotImplemented
        pairs = [(getattr(self, name), getattr(other, name)) for name in self._ranks]
        if all(np.shape(a) == np.shape(b) for a, b in pairs):
            return all(np.array_equal(a, b) for a, b in pairs)
        batch = self.batch_shape  # a field without batch axes is the same for the whole batch
        return other.batch_shape == batch and all(
            np.array_equal(a, b) for a, b in zip(self._fields(batch), other._fields(batch), strict=True)
        )

    def __hash__(self) -> int:
        # Adding 0.0 turns -0.0, which equals 0.0, into it.
        parts = self._fields(self.batch_shape)
        return hash(tuple((p.shape, tuple(p.flat) if is_symbolic(p) else (p + 0.0).tobytes()) for p in parts))

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Array:
        return np.asarray(self._dense(), dtype=dtype)

    def __repr__(self) -> str:
        name, batch = type(self).__name__, self.batch_shape
        if not batch:
            return name + "(" + self._show(len(name) + 1) + ")"
        count = int(np.prod(batch))
        items = [self[np.unravel_index(i, batch)]._show(2) for i in range(min(count, 3))]
        more = [f"  ... {count} in all"] if count > 3 else []
        return "\n".join([f"{name} batch of shape {batch}:", *("  " + item for item in items), *more])

    def _show(self, indent: int) -> str:
        """A single one's fields as text; lines after the first are indented."""
        labels = [f"{name}=" for name in self._ranks]
        texts = [numbers(getattr(self, name), indent + len(name) + 1) for name in self._ranks]
        join = ",\n" + " " * indent
        return join.join(label + text for label, text in zip(labels, texts, strict=True))


class Composed(Batched):
    """Rotations and poses, which are composed and applied with `@`."""

    __slots__ = ()

    def __mul__(self, other: Any) -> Any:
        if isinstance(other, (type(self), np.ndarray, list, tuple)):
            kind = type(self).__name__
            raise UnknownOperation(
                f"{kind} has no `*`; compose and apply with `@`: T_a_b @ T_b_c, T @ points."
            )
        return NotImplemented

    __rmul__ = __mul__


def numbers(values: Any, indent: int = 0) -> str:
    """An array as text, with its columns aligned.

    Args:
        values: The array, of any shape.
        indent: Spaces before the lines after the first.

    Returns:
        The text.
    """
    array = np.asarray(values)
    if array.dtype != object:
        array = array + 0.0  # makes -0.0 a plain zero
    return np.array2string(
        array, max_line_width=110, precision=6, suppress_small=True, separator=", ", prefix=" " * indent
    )


def as_array(value: Any) -> Array:
    """`value` as it is when it is an array of floats or objects; all else as one."""
    if isinstance(value, np.ndarray):
        return value.astype(float) if value.dtype.kind in _WHOLE else value
    return np.array(value, dtype=object if is_symbolic(value) else float)


def unit_vectors(name: str, value: ArrayLike, size: int, expected: str, fix: str = "") -> Array:
    """Vectors of the user's, scaled to length one, however long or short they are.

    Args:
        name: The name of the argument, for the message.
        value: The vectors, shape (..., size) [any].
        size: How many entries each has.
        expected: What is to stand in place of zero, for the message.
        fix: How to correct a wrong shape, for the message.

    Returns:
        Unit vectors, shape (..., size).

    Raises:
        InputError: One of them is zero.
        ShapeError, DtypeError, NonFiniteError: They are no such vectors.
    """
    vectors = batched_array(name, value, (size,), fix)
    if vectors.dtype != object:
        largest = np.abs(vectors).max(axis=-1, keepdims=True, initial=0.0)
        if (largest == 0.0).any():
            raise InputError(f"`{name}` is zero; expected {expected}.")
        # Squares of others overflow, or lose digits.
        vectors = vectors / np.where((largest > 1e-100) & (largest < 1e100), 1.0, largest)
    return vectors / column(sqrt(dot(vectors, vectors)))


def column(value: Any, rank: int = 1) -> Any:
    """A number or batch of numbers, ready to multiply arrays that have further axes.

    Args:
        value: A number, or a batch of numbers as an array or list, shape (...).
        rank: The number of further axes.

    Returns:
        A batch has shape (..., 1) with `rank` ones; a number stays as it is.
    """
    if isinstance(value, (list, tuple)):
        value = np.asarray(value)
    return value.reshape(value.shape + (1,) * rank) if isinstance(value, np.ndarray) and value.ndim else value


def core_shapes(**cores: tuple[int, ...]) -> Callable[[F], F]:
    """A decorator of functions that read entries by their indices: longer arrays would lose their other entries.

    Lists become arrays. Values are not looked at.

    Args:
        **cores: The last axes of the arguments by name.

    Returns:
        The decorator. Its functions raise ShapeError and DtypeError.
    """

    def decorate(function: F) -> F:
        order = [(name, cores.get(name)) for name in inspect.signature(function).parameters]

        @functools.wraps(function)
        def checked(*args: Any, **keywords: Any) -> Any:
            arrays = [
                value if core is None else _shaped(name, value, core)
                for value, (name, core) in zip(args, order, strict=False)
            ]
            for name in keywords.keys() & cores.keys():
                keywords[name] = _shaped(name, keywords[name], cores[name])
            return function(*arrays, *args[len(arrays) :], **keywords)

        return checked  # type: ignore[return-value]

    return decorate


def _shaped(name: str, value: Any, core: tuple[int, ...]) -> Any:
    """A value whose last axes are as they should be."""
    shape = getattr(value, "shape", None)
    if shape is None or (isinstance(value, np.ndarray) and _needs_conversion(value)):
        value = real_array(name, value, shape=batched_shape(core), is_symbol=is_symbolic)
        shape = value.shape
    if shape[-len(core) :] != core:
        check_core_shape(name, value, core)
    return value


def _needs_conversion(array: Array) -> bool:
    """Whether an array of NumPy holds whole numbers, or may mask some."""
    if array.dtype.kind in _WHOLE:
        return True
    # Of a plain array `np.ma` is not read: NumPy imports it then, which takes a fifth of loading a robot.
    return type(array) is not np.ndarray and isinstance(array, np.ma.MaskedArray)
