"""The LLVM types and parameters that types of the imperative language become."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.compiler.imperative import tree as t
from ulna.compiler.imperative.types import (
    BOOL,
    F32,
    INT,
    ArrayType,
    KernelType,
    Number,
    RecordType,
    Type,
    element_of,
    lanes_of,
)  # fmt: skip
from ulna.data_classes import dataclass

WORDS = {"bool": "i1", "int": "i64", "f32": "float", "f64": "double"}
SIZES = {"int": 8, "f32": 4, "f64": 8}

OUT_OF_BOUNDS, DIVISION_BY_ZERO = 1, 2
"""What a status says; it is `instance << 32 | kind << 24 | line`, and 0 where all is well."""


@dataclass(frozen=True)
class ArrayValue:
    """Where an array begins, and its extents."""

    pointer: str
    extents: tuple[str, ...]


@dataclass(frozen=True)
class KernelValue:
    """Where a kernel begins, and how many numbers each of its arrays holds."""

    pointer: str
    sizes: tuple[str, ...]


Value = str | ArrayValue | KernelValue | dict[str, Any]


def word(type_: Type) -> str:
    """The LLVM type of numbers or lanes."""
    element = element_of(type_)
    assert element is not None
    count = lanes_of(type_)
    return f"<{count} x {WORDS[element.name]}>" if count else WORDS[element.name]


def suffix(type_: Type) -> str:
    """As LLVM spells the type in names of intrinsics: v8f32."""
    element = element_of(type_)
    assert element is not None
    short = {"bool": "i1", "int": "i64", "f32": "f32", "f64": "f64"}[element.name]
    return f"v{lanes_of(type_)}{short}" if lanes_of(type_) else short


def number(value: bool | int | float, type_: Number) -> str:
    """The literal of a number.

    Args:
        value: The number, rounded to the type.
        type_: Its type.

    Returns:
        The text.
    """
    if type_ == BOOL:
        return "true" if value else "false"
    if type_ == INT:
        return str(int(value))
    rounded = float(np.float32(value)) if type_ == F32 else float(value)
    return f"0x{np.float64(rounded).view(np.uint64):016X}"


def flattened(name: str, type_: Type) -> tuple[list[tuple[str, str]], Value]:
    """The LLVM parameters that a parameter becomes, as (type, name), and its value in terms of them.

    Args:
        name: The name of the parameter.
        type_: Its type.

    Returns:
        Pairs of a type and a name, and the value.
    """
    if isinstance(type_, ArrayType):
        extents = tuple(f"%{name}.{k}" for k in range(type_.rank))
        return [("ptr", f"%{name}"), *(("i64", e) for e in extents)], ArrayValue(f"%{name}", extents)
    if isinstance(type_, KernelType):
        sizes = tuple(f"%{name}.{k}" for k in range(type_.ports))
        return [("ptr", f"%{name}"), *(("i64", s) for s in sizes)], KernelValue(f"%{name}", sizes)
    if isinstance(type_, RecordType):
        parts = [(field, *flattened(f"{name}.{field}", kind)) for field, kind in type_.fields]
        return [p for _, words, _ in parts for p in words], {field: value for field, _, value in parts}
    return [(word(type_), f"%{name}")], f"%{name}"


def operands(value: Value, type_: Type) -> list[str]:
    """The LLVM arguments that a value becomes, typed, in the order of `flattened`.

    Args:
        value: The value.
        type_: Its type.

    Returns:
        The arguments as text.
    """
    if isinstance(value, ArrayValue):
        return [f"ptr {value.pointer}", *(f"i64 {e}" for e in value.extents)]
    if isinstance(value, KernelValue):
        return [f"ptr {value.pointer}", *(f"i64 {s}" for s in value.sizes)]
    if isinstance(value, dict):
        assert isinstance(type_, RecordType)
        return [part for name, kind in type_.fields for part in operands(value[name], kind)]
    return [f"{word(type_)} {value}"]


def result_word(instance: t.Instance) -> str:
    """The LLVM type that an instance returns: its status, and its results after it."""
    if not instance.results:
        return "i64"
    return "{ " + ", ".join(["i64", *map(word, instance.results)]) + " }"
