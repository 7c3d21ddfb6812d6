"""Writes expressions of the imperative language as LLVM instructions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from ulna.compiler.codegen.instructions import Instructions
from ulna.compiler.codegen.node_writer import Module
from ulna.compiler.codegen.procedure_types import (
    OUT_OF_BOUNDS,
    SIZES,
    WORDS,
    ArrayValue,
    Value,
    number,
    operands,
    result_word,
    suffix,
    word,
)
from ulna.compiler.imperative import tree as t
from ulna.compiler.imperative.types import (
    BOOL,
    F32,
    INT,
    Lanes,
    Number,
    Type,
    element_of,
    lanes_of,
)  # fmt: skip

_LIMITS = ("oge", 2.0**63, 2**63 - 1), ("olt", -(2.0**63), -(2**63)), ("uno", 0.0, 0)


class ValueWriter(Instructions):
    """Writes expressions into the function that is being written.

    Attributes:
        module: Where declarations and helper functions go.
        number: The number of the instance, for statuses.
        names: Parameters that are never assigned to, and arrays.
        variables: The variables and the storage of each.
        is_checked: Whether accesses to arrays are checked.

    Args:
        module: Where declarations and helper functions go.
        number_: The number of the instance, for statuses.
        is_checked: Whether accesses to arrays are checked.
        contract: Whether products and sums may be fused.
    """

    def __init__(self, module: Module, number_: int, is_checked: bool, contract: bool) -> None:
        super().__init__()
        self.module, self.number, self.is_checked = module, number_, is_checked
        self.contract = " contract" if contract else ""
        self.names: dict[str, Value] = {}
        self.variables: dict[str, Type] = {}
        self.allocas: list[str] = []
        self.result = "i64"
        self._count = 0

    def fresh(self, hint: str = "t") -> str:
        """A name that is not in use, without its sign."""
        self._count += 1
        return f"{hint}.{self._count}"

    def emit(self, text: str) -> str:
        """Appends an instruction with a result, and returns its name."""
        return self.let(self.fresh(), text)

    def intrinsic(self, name: str, result: str, *arguments: tuple[str, str]) -> str:
        """A call of an LLVM intrinsic; arguments are pairs of a type and a value.

        Args:
            name: Its name without `llvm.`, with the suffixes of its types.
            result: The type of its result.
            *arguments: Pairs of a type and a value.

        Returns:
            The name of the result.
        """
        self.module.declare(f"declare {result} @llvm.{name}({', '.join(kind for kind, _ in arguments)})")
        typed = ", ".join(f"{kind} {value}" for kind, value in arguments)
        return self.emit(f"call {result} @llvm.{name}({typed})")

    def value(self, e: t.Expression) -> Value:
        """The value of an expression."""
        return WRITERS[type(e)](self, e)

    def scalar(self, e: t.Expression) -> str:
        """The value of an expression that is a number or lanes."""
        value = self.value(e)
        assert isinstance(value, str)
        return value

    def array(self, e: t.Expression) -> ArrayValue:
        """The value of an expression that is an array."""
        value = self.value(e)
        assert isinstance(value, ArrayValue)
        return value

    # failures -------------------------------------------------------------------------------------------

    def leave_if(self, condition: str, kind: int, line: int, details: Sequence[str] = ()) -> None:
        """Returns with a status where a condition holds; details are stored for the message.

        Args:
            condition: An i1.
            kind: `OUT_OF_BOUNDS` or `DIVISION_BY_ZERO`.
            line: The line of the source.
            details: Integers.
        """
        bad, good = self.fresh("bad"), self.fresh("good")
        self.write(f"br i1 {condition}, label %{bad}, label %{good}, !prof !0")
        self.open_block(bad)
        for k, detail in enumerate(details):
            place = self.emit(f"getelementptr i64, ptr %fault, i64 {k}")
            self.write(f"store i64 {detail}, ptr {place}")
        self.return_status(str(self.number << 32 | kind << 24 | line))
        self.open_block(good)

    def return_status(self, status: str) -> None:
        """Returns a status without results."""
        if self.result == "i64":
            self.write(f"ret i64 {status}")
        else:
            value = self.emit(f"insertvalue {self.result} poison, i64 {status}, 0")
            self.write(f"ret {self.result} {value}")

    def check(self, index: str, extent: str, width: int, line: int) -> None:
        """Checks, where accesses are checked, that `index` to `index + width` lie in an axis.

        Args:
            index: An i64.
            extent: The length of the axis.
            width: How many elements are read or written.
            line: The line of the source.
        """
        if not self.is_checked:
            return
        last = self.emit(f"sub i64 {extent}, {width}")
        below = self.emit(f"icmp slt i64 {index}, 0")
        above = self.emit(f"icmp sgt i64 {index}, {last}")
        end = self.emit(f"add i64 {index}, {width - 1}")
        begins_outside = self.emit(f"or i1 {below}, {self.emit(f'icmp sge i64 {index}, {extent}')}")
        shown = self.emit(f"select i1 {begins_outside}, i64 {index}, i64 {end}")
        self.leave_if(self.emit(f"or i1 {below}, {above}"), OUT_OF_BOUNDS, line, (shown, extent))

    # expressions ----------------------------------------------------------------------------------------

    def _constant(self, e: t.Constant) -> Value:
        return number(e.value, e.type)

    def _local(self, e: t.Local) -> Value:
        if e.name in self.variables:
            return self.emit(f"load {word(e.type)}, ptr %{e.name}.v")
        return self.names[e.name]

    def _convert(self, e: t.Convert) -> Value:
        value, source, target = self.scalar(e.value), element_of(e.value.type), element_of(e.type)
        a, b = word(e.value.type), word(e.type)
        if source is not None and source.is_real and target == INT:
            if lanes_of(e.type):
                return self._saturated(value, e)
            return self.intrinsic(f"fptosi.sat.{suffix(e.type)}.{suffix(e.value.type)}", b, (a, value))
        if source == BOOL:
            return self.emit(f"{'zext' if target == INT else 'uitofp'} {a} {value} to {b}")
        if source == INT:
            return self.emit(f"sitofp {a} {value} to {b}")
        return self.emit(f"{'fptrunc' if target == F32 else 'fpext'} {a} {value} to {b}")

    def _saturated(self, value: str, e: t.Convert) -> str:
        """Lanes of floats as integers, as `fptosi.sat` has them, which LLVM computes lane by lane, with branches."""
        element, kind, wide = element_of(e.value.type), word(e.value.type), word(e.type)
        assert element is not None
        whole = self.emit(f"fptosi {kind} {value} to {wide}")  # poison where it does not fit: replaced below
        for relation, limit, instead in _LIMITS:
            splat = f"splat ({WORDS[element.name]} {number(limit, element)})"
            is_beyond = self.emit(f"fcmp {relation} {kind} {value}, {splat}")
            choice = f"select <{lanes_of(e.type)} x i1> {is_beyond}"
            whole = self.emit(f"{choice}, {wide} splat (i64 {instead}), {wide} {whole}")
        return whole

    def _broadcast(self, e: t.Broadcast) -> Value:
        return self.in_all_lanes(self.scalar(e.value), e.type)

    def in_all_lanes(self, value: str, type_: Lanes) -> str:
        """A number in every lane.

        Args:
            value: The number.
            type_: The type of the lanes.

        Returns:
            The name of the result.
        """
        kind = word(type_)
        one = self.emit(f"insertelement {kind} poison, {WORDS[type_.element.name]} {value}, i64 0")
        return self.emit(f"shufflevector {kind} {one}, {kind} poison, <{type_.count} x i32> zeroinitializer")

    def _choice(self, e: t.Choice) -> Value:
        yes, no, after, place = (self.fresh(h) for h in ("yes", "no", "after", "choice"))
        self.allocas.append(f"%{place} = alloca {word(e.type)}")
        self.write(f"br i1 {self.scalar(e.condition)}, label %{yes}, label %{no}")
        for label, branch in ((yes, e.if_true), (no, e.if_false)):
            self.open_block(label)
            self.write(f"store {word(e.type)} {self.scalar(branch)}, ptr %{place}")
            self.write(f"br label %{after}")
        self.open_block(after)
        return self.emit(f"load {word(e.type)}, ptr %{place}")

    def _field(self, e: t.Field) -> Value:
        record = self.value(e.record)
        assert isinstance(record, dict)
        return record[e.name]

    def _extent(self, e: t.Extent) -> Value:
        return self.array(e.array).extents[e.axis]

    def _view(self, e: t.View) -> Value:
        array = self.array(e.array)
        indices = self.indices(array, e.indices, e.line)
        rest = array.extents[len(indices) :]
        offset = self.offset(array, [*indices, *["0"] * len(rest)])
        return ArrayValue(self._pointer(array, offset, e.type.element), rest)

    def indices(
        self, array: ArrayValue, indices: Sequence[t.Expression], line: int, width: int = 1
    ) -> list[str]:
        """Indices of the first axes, checked; the last one has room for `width` elements.

        Args:
            array: The array.
            indices: The indices of its first axes; the last one may be lanes.
            line: The line of the source.
            width: How many elements are read or written from the last index on.

        Returns:
            Their values.
        """
        values = []
        for axis, index in enumerate(indices):
            value = self.scalar(index)
            is_last = axis == len(indices) - 1
            if lanes_of(index.type):
                self._check_lanes(value, index.type, array.extents[axis], line)
            else:
                self.check(value, array.extents[axis], width if is_last else 1, line)
            values.append(value)
        return values

    def _check_lanes(self, index: str, type_: Type, extent: str, line: int) -> None:
        if not self.is_checked or not isinstance(type_, Lanes):
            return
        for lane in range(type_.count):
            self.check(self.emit(f"extractelement {word(type_)} {index}, i64 {lane}"), extent, 1, line)

    def offset(self, array: ArrayValue, indices: Sequence[str]) -> str:
        """How many elements into the array an element lies.

        Args:
            array: The array.
            indices: An index for each axis.

        Returns:
            An i64.
        """
        total = indices[0]
        for index, extent in zip(indices[1:], array.extents[1:], strict=True):
            total = self.emit(f"mul i64 {total}, {extent}")
            total = total if index == "0" else self.emit(f"add i64 {total}, {index}")
        return total

    def _pointer(self, array: ArrayValue, offset: str, element: Number) -> str:
        return self.emit(f"getelementptr {WORDS[element.name]}, ptr {array.pointer}, i64 {offset}")

    def place(self, e: t.Element | t.Slice) -> str:
        """The address of an element, or of the first element of a slice."""
        array = self.array(e.array)
        width = e.type.count if isinstance(e, t.Slice) else 1
        indices = self.indices(array, e.indices, e.line, width)
        element = element_of(e.type)
        assert element is not None
        return self._pointer(array, self.offset(array, indices), element)

    def _read(self, e: t.Element | t.Slice) -> Value:
        if isinstance(e, t.Element) and isinstance(e.type, Lanes):
            return self._gather(e, e.type)
        element = element_of(e.type)
        assert element is not None
        return self.emit(f"load {word(e.type)}, ptr {self.place(e)}, align {SIZES[element.name]}")

    def addresses(self, e: t.Element, type_: Lanes) -> str:
        """The addresses of the elements of all lanes.

        Args:
            e: The place.
            type_: The type of the lanes.

        Returns:
            The name of a vector of pointers.
        """
        array = self.array(e.array)
        *first, last = self.indices(array, e.indices, e.line)
        start = self.offset(array, [*first, "0"]) if first else "0"
        element = WORDS[type_.element.name]
        pointer = self.emit(f"getelementptr {element}, ptr {array.pointer}, i64 {start}")
        return self.emit(f"getelementptr {element}, ptr {pointer}, <{type_.count} x i64> {last}")

    def _gather(self, e: t.Element, type_: Lanes) -> str:
        addresses, n, kind = self.addresses(e, type_), type_.count, word(type_)
        mask = f"<{n} x i1> splat (i1 true)"
        size = SIZES[type_.element.name]
        name = f"@llvm.masked.gather.{suffix(type_)}.v{n}p0"
        self.module.declare(f"declare {kind} {name}(<{n} x ptr>, i32, <{n} x i1>, {kind})")
        return self.emit(f"call {kind} {name}(<{n} x ptr> {addresses}, i32 {size}, {mask}, {kind} poison)")

    def scatter(self, e: t.Element, type_: Lanes, value: str) -> None:
        """Writes the numbers of all lanes, in the order of the lanes.

        Args:
            e: The place.
            type_: The type of the lanes.
            value: The numbers.
        """
        addresses, n, kind = self.addresses(e, type_), type_.count, word(type_)
        mask = f"<{n} x i1> splat (i1 true)"
        name = f"@llvm.masked.scatter.{suffix(type_)}.v{n}p0"
        self.module.declare(f"declare void {name}({kind}, <{n} x ptr>, i32, <{n} x i1>)")
        size = SIZES[type_.element.name]
        self.write(f"call void {name}({kind} {value}, <{n} x ptr> {addresses}, i32 {size}, {mask})")

    def _laneitem(self, e: t.LaneItem) -> Value:
        assert isinstance(e.value.type, Lanes)
        value, index = self.scalar(e.value), self.scalar(e.index)
        self.check(index, str(e.value.type.count), 1, e.line)
        inside = self.emit(f"and i64 {index}, {e.value.type.count - 1}")
        return self.emit(f"extractelement {word(e.value.type)} {value}, i64 {inside}")

    def _call(self, e: t.Call) -> Value:
        return self.call(e.instance, e.arguments)[0]

    def call(self, instance: t.Instance, arguments: Sequence[t.Expression]) -> list[str]:
        """The results of another procedure; a status other than 0 is returned at once.

        Args:
            instance: The procedure.
            arguments: Its arguments.

        Returns:
            The names of the results.
        """
        typed = ["ptr %fault"]
        for value in arguments:
            typed += operands(self.value(value), value.type)
        kind = result_word(instance)
        result = self.emit(f"call {kind} @{instance.name}({', '.join(typed)})")
        status = result if kind == "i64" else self.emit(f"extractvalue {kind} {result}, 0")
        failed, bad, good = self.emit(f"icmp ne i64 {status}, 0"), self.fresh("bad"), self.fresh("good")
        self.write(f"br i1 {failed}, label %{bad}, label %{good}, !prof !0")
        self.open_block(bad)
        self.return_status(status)
        self.open_block(good)
        return [self.emit(f"extractvalue {kind} {result}, {k + 1}") for k in range(len(instance.results))]


WRITERS: dict[type, Callable[[ValueWriter, Any], Value]] = {
    t.Constant: ValueWriter._constant, t.Local: ValueWriter._local, t.Convert: ValueWriter._convert,
    t.Broadcast: ValueWriter._broadcast, t.Choice: ValueWriter._choice, t.Field: ValueWriter._field,
    t.Extent: ValueWriter._extent, t.View: ValueWriter._view, t.Element: ValueWriter._read,
    t.Slice: ValueWriter._read, t.LaneItem: ValueWriter._laneitem, t.Call: ValueWriter._call,
}  # fmt: skip
