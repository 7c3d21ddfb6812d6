"""Arguments and results of procedures, as the 64-bit words that machine code reads and writes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ulna.compiler.imperative.types import (
    BOOL,
    F32,
    INT,
    ArrayType,
    KernelType,
    Lanes,
    Number,
    RecordType,
    Type,
)
from ulna.compiler.language.ports import wrong_count
from ulna.compiler.runtime.lanes_kernel import LanesKernel
from ulna.errors import DtypeError, InputError, ShapeError


def layout(array: Any) -> tuple[Any, ...]:
    """Where an array lies, whether it may be written to, and its shape."""
    return (*array.__array_interface__["data"], array.shape)


def check_count(procedure: str, parameters: Sequence[tuple[str, Type]], arguments: Sequence[Any]) -> None:
    """Refuses a call with too many or too few arguments.

    Args:
        procedure: Its name.
        parameters: Names and types of its parameters.
        arguments: What was passed.

    Raises:
        TypeError: If there are not as many as parameters.
    """
    names = [name for name, _ in parameters]
    if len(arguments) != len(names):
        raise wrong_count(procedure, names, arguments)


def words_of(name: str, type_: Type, value: Any, is_written: bool) -> tuple[list[int], list[Any]]:
    """The words that an argument becomes, and what must stay alive for them.

    Args:
        name: The name of the parameter.
        type_: Its type.
        value: The argument.
        is_written: Whether the procedure may write to it.

    Returns:
        The words, and the objects that must live as long as they are used.

    Raises:
        InputError: If the argument is not of the type.
    """
    if isinstance(type_, ArrayType):
        _check_array(name, type_, value, is_written)
        return [value.__array_interface__["data"][0], *value.shape], [value]
    if isinstance(type_, KernelType):
        if not isinstance(value, LanesKernel):
            raise InputError(
                f"`{name}` is a {type(value).__name__}; expected a kernel made by lanes_kernel(function)."
            )
        return [value.address, *value.sizes], [value]
    if isinstance(type_, RecordType):
        words, alive = [], []
        for field, kind in type_.fields:
            if not hasattr(value, field):
                raise InputError(f"`{name}` is a {type(value).__name__}; expected a {type_} with `{field}`.")
            part, buffers = words_of(f"{name}.{field}", kind, getattr(value, field), is_written)
            words += part
            alive += buffers
        return words, alive
    return [_word_of(name, type_, value)], []


def _word_of(name: str, type_: Type, value: Any) -> int:
    kinds = {"bool": (bool, np.bool_), "int": (int, np.integer), "f32": (int, float, np.integer, np.floating)}
    assert isinstance(type_, Number)
    if not isinstance(value, kinds.get(type_.name, kinds["f32"])) or (
        type_ != BOOL and isinstance(value, bool)
    ):
        raise InputError(f"`{name}` is a {type(value).__name__}; expected {type_}.")
    if type_ in (BOOL, INT):
        if not -(2**63) <= int(value) < 2**63:
            raise InputError(f"`{name}` is {value}; expected an integer of 64 bits.")
        return int(value)
    if type_ == F32:
        with np.errstate(over="ignore"):
            return int(np.float32(value).view(np.int32))
    return int(np.float64(value).view(np.int64))


def _check_array(name: str, type_: ArrayType, value: Any, is_written: bool) -> None:
    if type(value) is not np.ndarray:
        raise InputError(f"`{name}` is a {type(value).__name__}; expected a NumPy array, {type_}.")
    if value.dtype != type_.element.dtype:
        raise DtypeError(name, str(value.dtype), str(type_.element.dtype), "Convert it with astype.")
    if value.ndim != type_.rank:
        raise ShapeError(name, value.shape, f"an array with {type_.rank} axes")
    if not value.flags.c_contiguous or not value.flags.aligned:
        raise InputError(
            f"`{name}` has gaps; expected a C-contiguous array. Pass np.ascontiguousarray({name})."
        )
    if is_written and not value.flags.writeable:
        raise InputError(f"`{name}` is read-only, and the procedure may write to it. Pass a copy.")


def interpreted(type_: Type, value: Any) -> Any:
    """An argument as the interpreter takes it.

    Args:
        type_: The type of the parameter.
        value: The argument.

    Returns:
        The number, record, array or kernel.
    """
    if isinstance(type_, Number):
        return type_.dtype.type(value)
    if isinstance(type_, RecordType):
        return type(value)(*(interpreted(kind, getattr(value, field)) for field, kind in type_.fields))
    return value


def result_from(type_: Number | Lanes, words: Any) -> Any:
    """A result, from the words it lies in.

    Args:
        type_: The type of the result.
        words: The words from the result on.

    Returns:
        A number, or an array of shape (lanes,).
    """
    if isinstance(type_, Lanes):
        if type_.element == BOOL:
            bits = np.unpackbits(words.view(np.uint8), bitorder="little")
            return bits[: type_.count].astype(bool)
        return words.view(type_.element.dtype)[: type_.count].copy()
    return python_number(type_, words[0] != 0 if type_ == BOOL else words.view(type_.dtype)[0])


def python_number(type_: Number | Lanes, value: Any) -> Any:
    """A number as Python has it; float32 and lanes stay NumPy's.

    Args:
        type_: The type.
        value: The number, as NumPy has it.

    Returns:
        The number.
    """
    return value if isinstance(type_, Lanes) or type_ == F32 else value.item()


def one_or_all(results: Sequence[Any]) -> Any:
    """What a call returns: None, the one result, or a tuple of all."""
    return None if not results else results[0] if len(results) == 1 else tuple(results)
