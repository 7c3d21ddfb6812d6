"""The types of the imperative language, and how annotations of Python name them.

| type | annotation or value | content |
|---|---|---|
| `Number` | `bool`, `int`, `f32`, `f64` (or `float`) | a truth value, an integer of 64 bits, a float of 32 or 64 bits |
| `Lanes` | a slice of constant width, `a[i : i + 8]` | numbers in one SIMD register; lanes of `bool` are a mask |
| `ArrayType` | `Array1[f32]`, `Array2[int]`, ... | a C-contiguous array; its shape is known when the code runs |
| `RecordType` | a class derived from `NamedTuple` | named values that are passed together |
| `KernelType` | `Kernel` | machine code of a traced function, called by its address on arrays |
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Annotated, Any, Literal, Protocol, TypeVar, get_args, get_origin, get_type_hints

import numpy as np

from ulna.data_classes import dataclass

f32 = np.float32
f64 = np.float64

_Element = TypeVar("_Element", np.float32, np.float64, np.int64)
Array1 = Annotated[np.ndarray[tuple[Any, ...], np.dtype[_Element]], 1]
"""A C-contiguous array with one axis, as annotation: `Array1[f32]`; elements are f32, f64 or np.int64."""
Array2 = Annotated[np.ndarray[tuple[Any, ...], np.dtype[_Element]], 2]
"""A C-contiguous array with two axes."""
Array3 = Annotated[np.ndarray[tuple[Any, ...], np.dtype[_Element]], 3]
"""A C-contiguous array with three axes."""


class Kernel(Protocol):
    """Annotation of a parameter that is a traced function, compiled for lanes: `kernel(inputs, outputs)`."""

    def __call__(self, inputs: Any, outputs: Any) -> None:
        """Computes all samples; see `lanes_kernel`.

        Args:
            inputs: Shape (numbers in, lanes).
            outputs: Shape (numbers out, lanes); overwritten.
        """


@dataclass(frozen=True)
class Number:
    """One number."""

    name: Literal["bool", "int", "f32", "f64"]

    @property
    def is_real(self) -> bool:
        """Whether it is a floating-point number."""
        return self.name in ("f32", "f64")

    @property
    def dtype(self) -> np.dtype[Any]:
        """The NumPy type of the same numbers."""
        return _DTYPES[self.name]

    def __str__(self) -> str:
        return self.name


@dataclass(frozen=True)
class Lanes:
    """Several numbers in one SIMD register."""

    element: Number
    count: int

    def __str__(self) -> str:
        return f"{self.count} lanes of {self.element}"


@dataclass(frozen=True)
class ArrayType:
    """A C-contiguous array whose shape is known when the code runs."""

    element: Number
    rank: int

    def __str__(self) -> str:
        return f"Array{self.rank}[{self.element}]"


@dataclass(frozen=True)
class RecordType:
    """Named values that are passed together."""

    name: str
    fields: tuple[tuple[str, Type], ...]

    def __str__(self) -> str:
        return self.name


@dataclass(frozen=True)
class KernelType:
    """The address of a compiled traced function.

    Attributes:
        ports: The number of arrays that a call takes: inputs and outputs.
    """

    ports: int = 2

    def __str__(self) -> str:
        return "Kernel"


Type = Number | Lanes | ArrayType | RecordType | KernelType

BOOL, INT, F32, F64 = Number("bool"), Number("int"), Number("f32"), Number("f64")
_DTYPES = {
    "bool": np.dtype(np.bool_),
    "int": np.dtype(np.int64),
    "f32": np.dtype(np.float32),
    "f64": np.dtype(np.float64),
}
NUMBERS: dict[Any, Number] = {
    bool: BOOL, np.bool_: BOOL, int: INT, np.int64: INT, f32: F32, f64: F64, float: F64,
}  # fmt: skip
"""The classes that name numbers, in annotations and as conversions."""


def element_of(type_: Type) -> Number | None:
    """The numbers of a value that calculates: a number or lanes; None for other types."""
    return type_ if isinstance(type_, Number) else type_.element if isinstance(type_, Lanes) else None


def lanes_of(type_: Type) -> int:
    """How many lanes a value has; 0 for a number."""
    return type_.count if isinstance(type_, Lanes) else 0


def with_element(type_: Type, element: Number) -> Type:
    """The type of as many numbers of another kind.

    Args:
        type_: A number or lanes.
        element: The other kind.

    Returns:
        The type.
    """
    return Lanes(element, type_.count) if isinstance(type_, Lanes) else element


def annotated_types(function: Callable[..., Any]) -> dict[str, Any]:
    """The annotations of a function's parameters, resolved; those it has not are left out.

    Raises:
        TypeError: If an annotation cannot be evaluated.
    """
    try:
        hints = get_type_hints(function, include_extras=True)
    except (NameError, AttributeError, SyntaxError) as error:
        raise TypeError(f"an annotation of {function.__qualname__} cannot be evaluated: {error}") from None
    return {name: hints[name] for name in inspect.signature(function).parameters if name in hints}


def type_named(annotation: Any) -> Type | None:
    """The type that an annotation names; None where it names none."""
    if annotation is Kernel:
        return KernelType()
    if isinstance(annotation, type) and annotation in NUMBERS:
        return NUMBERS[annotation]
    if get_origin(annotation) is Annotated:
        array, rank = get_args(annotation)[:2]
        element = NUMBERS.get(get_args(get_args(array)[1])[0]) if len(get_args(array)) == 2 else None
        return ArrayType(element, rank) if element is not None else None
    if isinstance(annotation, type) and issubclass(annotation, tuple) and hasattr(annotation, "_fields"):
        hints = get_type_hints(annotation, include_extras=True)
        fields = [(name, type_named(hints.get(name))) for name in vars(annotation)["_fields"]]
        known = tuple((name, type_) for name, type_ in fields if type_ is not None)
        return RecordType(annotation.__name__, known) if len(known) == len(fields) else None
    return None


def records_in(annotation: Any) -> list[type]:
    """The NamedTuple that an annotation names, and those among its fields."""
    if not (isinstance(annotation, type) and hasattr(annotation, "_fields")):
        return []
    hints = get_type_hints(annotation, include_extras=True)
    return [annotation, *(record for hint in hints.values() for record in records_in(hint))]
