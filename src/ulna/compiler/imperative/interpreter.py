"""Runs the typed tree with NumPy: the reference for the machine code, with every access to an array checked.

Numbers are NumPy scalars of their types, so float32 rounds and integers wrap as they do in machine code. Storage that
was made with `np.empty` holds nan (integers: -(2^62)) until it is written.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from ulna.compiler.imperative import tree as t
from ulna.compiler.imperative.operations import TABLE
from ulna.compiler.imperative.types import INT, Lanes, Number
from ulna.data_classes import dataclass
from ulna.errors import DivisionByZero, OutOfBounds

UNWRITTEN = -(2**62)
"""What integers of storage hold before they are written."""


@dataclass(frozen=True)
class _Returned:
    """Marks that a return statement has run, with the results."""

    values: tuple[Any, ...]


def interpret(instance: t.Instance, arguments: Sequence[Any]) -> tuple[Any, ...]:
    """Runs a procedure.

    Args:
        instance: The procedure, for certain types.
        arguments: Numbers, arrays, records and kernels, in the types of its parameters.

    Returns:
        Its results: NumPy scalars, or arrays for lanes.

    Raises:
        OutOfBounds: If it reads or writes outside an array.
        DivisionByZero: If it divides an integer by zero.
    """
    variables = {name: value for (name, _), value in zip(instance.parameters, arguments, strict=True)}
    with np.errstate(all="ignore"):
        result = _Frame(instance, variables).block(instance.body)
    return result.values if isinstance(result, _Returned) else ()


class _Frame:
    """One call of a procedure."""

    def __init__(self, instance: t.Instance, variables: dict[str, Any]) -> None:
        self.file, self.variables = instance.file, variables

    # statements -----------------------------------------------------------------------------------------

    def block(self, body: Sequence[t.Statement]) -> _Returned | str | None:
        """Runs statements; returns how they ended: by `return`, "break", "continue", or at their end."""
        for statement in body:
            exit_by = getattr(self, f"_{type(statement).__name__.lower()}")(statement)
            if exit_by is not None:
                return exit_by
        return None

    def _assign(self, s: t.Assign) -> None:
        self.variables[s.name] = self.value(s.value)

    def _callstatement(self, s: t.CallStatement) -> None:
        results = interpret(s.instance, [self.value(a) for a in s.arguments])
        self.variables.update(zip(s.names, results, strict=False))

    def _kernelcall(self, s: t.KernelCall) -> None:
        kernel, arrays = self.value(s.kernel), [self.value(a) for a in s.arrays]
        for array, size in zip(arrays, kernel.sizes, strict=True):
            if array.size < size:
                raise OutOfBounds(self.file, s.line, size - 1, array.size)
        kernel.interpret(*arrays)

    def _newarray(self, s: t.NewArray) -> None:
        initial = 0 if s.is_zero else UNWRITTEN if s.type.element == INT else np.nan
        self.variables[s.name] = np.full(s.shape, initial, s.type.element.dtype)

    def _store(self, s: t.Store) -> None:
        value = self.value(s.value)
        array, index = self.place(s.place)
        array[index] = value

    def _if(self, s: t.If) -> _Returned | str | None:
        return self.block(s.body if self.value(s.condition) else s.otherwise)

    def _while(self, s: t.While) -> _Returned | None:
        while self.value(s.condition):
            exit_by = self.block(s.body)
            if exit_by == "break":
                break
            if isinstance(exit_by, _Returned):
                return exit_by
        return None

    def _for(self, s: t.For) -> _Returned | None:
        for k in range(int(self.value(s.start)), int(self.value(s.stop)), s.step):
            self.variables[s.name] = np.int64(k)
            exit_by = self.block(s.body)
            if exit_by == "break":
                break
            if isinstance(exit_by, _Returned):
                return exit_by
        return None

    def _break(self, s: t.Break) -> str:
        return "break"

    def _continue(self, s: t.Continue) -> str:
        return "continue"

    def _return(self, s: t.Return) -> _Returned:
        return _Returned(tuple(self.value(v) for v in s.values))

    # expressions ----------------------------------------------------------------------------------------

    def value(self, e: t.Expression) -> Any:
        """The value of an expression."""
        return _VALUES[type(e)](self, e)

    def _constant(self, e: t.Constant) -> Any:
        return e.type.dtype.type(e.value)

    def _local(self, e: t.Local) -> Any:
        return self.variables[e.name]

    def _operation(self, e: t.Operation) -> Any:
        if e.name == "lane_numbers":
            assert isinstance(e.type, Lanes)
            return np.arange(e.type.count, dtype=e.type.element.dtype)
        values = [self.value(a) for a in e.arguments]
        if e.name in ("floordiv", "mod") and not values[1]:
            raise DivisionByZero(self.file, e.line)
        result = TABLE[e.name].numpy(*values)
        return result if isinstance(e.type, Lanes) else np.asarray(result)[()]

    def _convert(self, e: t.Convert) -> Any:
        value = self.value(e.value)
        element = e.type.element if isinstance(e.type, Lanes) else e.type
        assert isinstance(element, Number)
        if element == INT and np.asarray(value).dtype.kind == "f":
            return _saturated(value)
        return np.asarray(value).astype(element.dtype)[()]

    def _broadcast(self, e: t.Broadcast) -> Any:
        return np.full(e.type.count, self.value(e.value), e.type.element.dtype)

    def _choice(self, e: t.Choice) -> Any:
        return self.value(e.if_true if self.value(e.condition) else e.if_false)

    def _field(self, e: t.Field) -> Any:
        return getattr(self.value(e.record), e.name)

    def _extent(self, e: t.Extent) -> Any:
        return np.int64(self.value(e.array).shape[e.axis])

    def _view(self, e: t.View) -> Any:
        array = self.value(e.array)
        indices = [self._checked(i, array.shape[axis], 1, e.line) for axis, i in enumerate(e.indices)]
        return array[tuple(indices)]

    def _read(self, e: t.Element | t.Slice) -> Any:
        array, index = self.place(e)
        return array[index].copy()

    def _laneitem(self, e: t.LaneItem) -> Any:
        value = self.value(e.value)
        return value[self._checked(e.index, len(value), 1, e.line)]

    def _call(self, e: t.Call) -> Any:
        return interpret(e.instance, [self.value(a) for a in e.arguments])[0]

    def place(self, e: t.Element | t.Slice) -> tuple[Any, Any]:
        """The array and the index that an element or a slice refers to."""
        array = self.value(e.array)
        width = e.type.count if isinstance(e, t.Slice) else 1
        *first, last = e.indices
        indices: list[Any] = [self._checked(i, array.shape[axis], 1, e.line) for axis, i in enumerate(first)]
        end = self._checked(last, array.shape[-1], width, e.line)
        return array, (*indices, slice(end, end + width) if isinstance(e, t.Slice) else end)

    def _checked(self, index: t.Expression, extent: int, width: int, line: int) -> Any:
        value = self.value(index)
        for k in np.atleast_1d(value).tolist():
            if not 0 <= k <= extent - width:
                raise OutOfBounds(self.file, line, k if k < 0 or k >= extent else k + width - 1, extent)
        return value if np.ndim(value) else int(value)


def _saturated(value: Any) -> Any:
    """Floats as integers, towards zero, the nearest integer where they do not fit, nan as 0."""
    number = np.nan_to_num(
        np.trunc(np.asarray(value, np.float64)), nan=0.0, posinf=2.0**64, neginf=-(2.0**64)
    )
    inside = np.clip(number, -(2.0**63), 2.0**63 - 1024).astype(np.int64)
    return np.where(number >= 2.0**63, np.int64(2**63 - 1), inside)[()]


_VALUES: Mapping[type, Callable[[_Frame, Any], Any]] = {
    t.Constant: _Frame._constant, t.Local: _Frame._local, t.Operation: _Frame._operation,
    t.Convert: _Frame._convert, t.Broadcast: _Frame._broadcast, t.Choice: _Frame._choice, t.Field: _Frame._field,
    t.Extent: _Frame._extent, t.View: _Frame._view, t.Element: _Frame._read, t.Slice: _Frame._read,
    t.LaneItem: _Frame._laneitem, t.Call: _Frame._call,
}  # fmt: skip
