"""Writes procedures of the imperative language as LLVM IR: statements, functions, and the entry for Python.

Every function returns a status, 0 where all is well, and after it its results. Variables have storage on the stack,
which LLVM turns into registers. The entry reads its arguments from an array of 64-bit words and writes the results
there.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import Any

from ulna.compiler.codegen.node_writer import Module
from ulna.compiler.codegen.procedure_operations import write_operation
from ulna.compiler.codegen.procedure_types import (
    OUT_OF_BOUNDS,
    WORDS,
    ArrayValue,
    KernelValue,
    flattened,
    result_word,
    word,
)
from ulna.compiler.codegen.procedure_values import WRITERS, ValueWriter
from ulna.compiler.imperative import tree as t
from ulna.compiler.imperative.types import ArrayType, Lanes, Number, element_of, lanes_of

WRITERS[t.Operation] = write_operation

INLINE_BELOW = 120
"""Instances of fewer lines of IR, inlined callees included, are always inlined."""

NO_INLINE_ABOVE = 1000
"""Instances of more lines are inlined only if called from one place: copies would take long to compile."""


def procedure_ir(
    instances: Sequence[t.Instance], is_checked: bool, contract: bool, register_bytes: int
) -> str:
    """The module of a procedure.

    Args:
        instances: The procedure last, and before it all that it calls.
        is_checked: Whether accesses to arrays are checked.
        contract: Whether a product and a sum may become one instruction that rounds once, in all instances; else only
            in those that say so.
        register_bytes: Width of the widest SIMD register [byte].

    Returns:
        LLVM IR with `i64 entry(ptr words, ptr fault)`.
    """
    module = Module()
    for number, instance in enumerate(instances):
        writer = _FunctionWriter(module, number, is_checked, contract or instance.contract)
        module.definitions[instance.name] = writer.function(instance)
    _choose_inlining(module.definitions, [instance.name for instance in instances])
    module.definitions["entry"] = _entry(instances[-1])
    bits = 8 * register_bytes
    attributes = f'attributes #0 = {{ "prefer-vector-width"="{bits}" "min-legal-vector-width"="{bits}" }}'
    text = module.text() + f'\n{attributes}\n!0 = !{{!"branch_weights", i32 1, i32 1000000}}\n'
    return text if text.isascii() else _NOT_ASCII.sub(_quoted, text)


_NOT_ASCII = re.compile(r"([%@])([\w.]*[^\x00-\x7f][\w.]*)")


def _quoted(name: re.Match[str]) -> str:
    """A name with characters that LLVM takes only by the bytes of their UTF-8, within quotes."""
    letters = (c if c.isascii() else "".join(f"\\{byte:02X}" for byte in c.encode()) for c in name[2])
    return f'{name[1]}"{"".join(letters)}"'


def _choose_inlining(definitions: dict[str, str], names: Sequence[str]) -> None:
    """Says of each function whether LLVM must, may or must not inline it; callees come before their callers."""
    sites = {name: sum(text.count(f"@{name}(") for text in definitions.values()) - 1 for name in names}
    sizes: dict[str, int] = {}
    inlined: set[str] = set()
    for name in names:
        text = definitions[name]
        sizes[name] = text.count("\n") + sum(text.count(f"@{callee}(") * sizes[callee] for callee in inlined)
        choice = ""
        if sites[name] <= 1 or sizes[name] < INLINE_BELOW:
            choice = "alwaysinline "
            inlined.add(name)
        elif sizes[name] > NO_INLINE_ABOVE:
            choice = "noinline "
        definitions[name] = text.replace(") nounwind #0 {", f") {choice}nounwind #0 {{", 1)


def _entry(instance: t.Instance) -> str:
    """`i64 entry(ptr words, ptr fault)`: reads the arguments, calls, writes the results after the arguments."""
    lines, typed, position = [], ["ptr %fault"], 0
    for name, type_ in instance.parameters:
        for kind, part in flattened(f"p.{name}", type_)[0]:
            place, value = f"%at.{position}", part
            lines.append(f"  {place} = getelementptr i64, ptr %words, i64 {position}")
            lines.append(f"  {value} = load {'i8' if kind == 'i1' else kind}, ptr {place}, align 8")
            if kind == "i1":
                lines.append(f"  {value}.bit = trunc i8 {value} to i1")
                value = f"{value}.bit"
            typed.append(f"{kind} {value}")
            position += 1
    kind = result_word(instance)
    lines.append(f"  %result = call {kind} @{instance.name}({', '.join(typed)})")
    if kind == "i64":
        return _define("entry", "i64", ["ptr %words", "ptr %fault"], [*lines, "  ret i64 %result"], "")
    for k, result in enumerate(instance.results):
        lines.append(f"  %r.{k} = extractvalue {kind} %result, {k + 1}")
        lines.append(f"  %rp.{k} = getelementptr i64, ptr %words, i64 {position}")
        value, wide = f"%r.{k}", word(result)
        if result == Number("bool"):
            lines.append(f"  %rb.{k} = zext i1 %r.{k} to i64")
            value, wide = f"%rb.{k}", "i64"
        lines.append(f"  store {wide} {value}, ptr %rp.{k}, align 8")
        position += result_words(result)
    lines += [f"  %status = extractvalue {kind} %result, 0", "  ret i64 %status"]
    return _define("entry", "i64", ["ptr %words", "ptr %fault"], lines, "")


def result_words(type_: Number | Lanes) -> int:
    """How many 64-bit words a result takes in the array that the entry writes."""
    return lanes_of(type_) or 1


def _define(name: str, result: str, parameters: Sequence[str], lines: Sequence[str], linkage: str) -> str:
    head = f"define {linkage}{result} @{name}({', '.join(parameters)}) nounwind #0 {{"
    return "\n".join([head, "start:", *lines, "}", ""])


class _FunctionWriter(ValueWriter):
    """Writes the function of one instance."""

    def __init__(self, module: Module, number: int, is_checked: bool, contract: bool) -> None:
        super().__init__(module, number, is_checked, contract)
        self._loops: list[tuple[str, str]] = []  # where `continue` and `break` go

    def function(self, instance: t.Instance) -> str:
        """The definition."""
        self.result = result_word(instance)
        parameters = ["ptr %fault"]
        assigned = dict(instance.variables)
        for name, type_ in instance.parameters:
            words, value = flattened(f"{name}.a", type_)  # a dot, as no other name here has in that place
            parameters += [f"{kind} {part}" for kind, part in words]
            self.names[name] = value
            if name in assigned:
                self.write(f"store {word(type_)} {value}, ptr %{name}.v")
        for name, type_ in instance.variables:
            if not isinstance(type_, ArrayType):
                self.variables[name] = type_
                self.allocas.append(f"%{name}.v = alloca {word(type_)}")
        if not self.block(instance.body):
            if instance.results:
                self.write("unreachable")
            else:
                self.return_status("0")
        lines = [*("  " + line for line in self.allocas), *self.lines]
        return _define(instance.name, self.result, parameters, lines, "internal ")

    def block(self, body: Sequence[t.Statement]) -> bool:
        """Writes statements; returns whether control never reaches the end of the block."""
        return any(_STATEMENTS[type(statement)](self, statement) for statement in body)

    def _assign(self, s: t.Assign) -> None:
        value = self.scalar(s.value)
        self.write(f"store {word(s.value.type)} {value}, ptr %{s.name}.v")

    def _call_statement(self, s: t.CallStatement) -> None:
        results = self.call(s.instance, s.arguments)
        for name, value, type_ in zip(s.names, results, s.instance.results, strict=False):
            self.write(f"store {word(type_)} {value}, ptr %{name}.v")

    def _kernel_call(self, s: t.KernelCall) -> None:
        kernel = self.value(s.kernel)
        assert isinstance(kernel, KernelValue)
        pointers = []
        for k, array in enumerate(s.arrays):
            value = self.array(array)
            self._check_size(value, kernel.sizes[k], s.line)
            pointers.append(f"ptr {value.pointer}")
        self.write(f"call void {kernel.pointer}({', '.join(pointers)})")

    def _check_size(self, array: ArrayValue, size: str, line: int) -> None:
        """Checks, where accesses are checked, that an array holds what a kernel reads or writes."""
        if not self.is_checked:
            return
        total = array.extents[0]
        for extent in array.extents[1:]:
            total = self.emit(f"mul i64 {total}, {extent}")
        last = self.emit(f"sub i64 {size}, 1")
        self.leave_if(self.emit(f"icmp slt i64 {total}, {size}"), OUT_OF_BOUNDS, line, (last, total))

    def _new_array(self, s: t.NewArray) -> None:
        element, size = WORDS[s.type.element.name], 1
        for extent in s.shape:
            size *= extent
        self.allocas.append(f"%{s.name}.a = alloca [{size} x {element}], align 64")
        self.names[s.name] = ArrayValue(f"%{s.name}.a", tuple(map(str, s.shape)))
        if s.is_zero:
            count = size * s.type.element.dtype.itemsize
            self.module.declare("declare void @llvm.memset.p0.i64(ptr, i8, i64, i1)")
            self.write(
                f"call void @llvm.memset.p0.i64(ptr align 64 %{s.name}.a, i8 0, i64 {count}, i1 false)"
            )

    def _store(self, s: t.Store) -> None:
        value = self.scalar(s.value)
        if isinstance(s.place, t.Element) and isinstance(s.place.type, Lanes):
            self.scatter(s.place, s.place.type, value)
            return
        element = element_of(s.place.type)
        assert element is not None
        align = element.dtype.itemsize
        self.write(f"store {word(s.value.type)} {value}, ptr {self.place(s.place)}, align {align}")

    def _if(self, s: t.If) -> bool:
        yes, no, after = self.fresh("then"), self.fresh("else"), self.fresh("after")
        self.write(f"br i1 {self.scalar(s.condition)}, label %{yes}, label %{no}")
        ended = []
        for label, body in ((yes, s.body), (no, s.otherwise)):
            self.open_block(label)
            ended.append(self.block(body))
            if not ended[-1]:
                self.write(f"br label %{after}")
        if all(ended):
            return True
        self.open_block(after)
        return False

    def _while(self, s: t.While) -> bool:
        head, body, after = self.fresh("while"), self.fresh("body"), self.fresh("after")
        self.write(f"br label %{head}")
        self.open_block(head)
        self.write(f"br i1 {self.scalar(s.condition)}, label %{body}, label %{after}")
        self.open_block(body)
        self._body(s.body, head, after)
        self.open_block(after)
        if isinstance(s.condition, t.Constant) and s.condition.value and not _breaks(s.body):
            self.write("unreachable")
            return True
        return False

    def _for(self, s: t.For) -> None:
        start, stop = self.scalar(s.start), self.scalar(s.stop)
        head, body, following, after = (self.fresh(h) for h in ("for", "body", "next", "after"))
        counter = f"%{self.fresh('k')}"
        self.allocas.append(f"{counter} = alloca i64")
        self.write(f"store i64 {start}, ptr {counter}")
        self.write(f"br label %{head}")
        self.open_block(head)
        k = self.emit(f"load i64, ptr {counter}")
        goes_on = self.emit(f"icmp {'slt' if s.step > 0 else 'sgt'} i64 {k}, {stop}")
        self.write(f"br i1 {goes_on}, label %{body}, label %{after}")
        self.open_block(body)
        self.write(f"store i64 {k}, ptr %{s.name}.v")
        self._body(s.body, following, after)
        self.open_block(following)
        before = self.emit(f"load i64, ptr {counter}")
        self.write(f"store i64 {self.emit(f'add i64 {before}, {s.step}')}, ptr {counter}")
        self.write(f"br label %{head}")
        self.open_block(after)

    def _body(self, body: Sequence[t.Statement], again: str, after: str) -> None:
        self._loops.append((again, after))
        if not self.block(body):
            self.write(f"br label %{again}")
        self._loops.pop()

    def _break(self, s: t.Break) -> bool:
        self.write(f"br label %{self._loops[-1][1]}")
        return True

    def _continue(self, s: t.Continue) -> bool:
        self.write(f"br label %{self._loops[-1][0]}")
        return True

    def _return(self, s: t.Return) -> bool:
        if not s.values:
            self.return_status("0")
            return True
        typed = [("i64", "0"), *((word(v.type), self.scalar(v)) for v in s.values)]
        result = "poison"
        for k, (kind, value) in enumerate(typed):
            result = self.emit(f"insertvalue {self.result} {result}, {kind} {value}, {k}")
        self.write(f"ret {self.result} {result}")
        return True


def _breaks(body: Sequence[t.Statement]) -> bool:
    """Whether a `break` of this very loop is among statements."""
    return any(
        isinstance(s, t.Break) or (isinstance(s, t.If) and (_breaks(s.body) or _breaks(s.otherwise)))
        for s in body
    )


_STATEMENTS: dict[type, Callable[[_FunctionWriter, Any], bool | None]] = {
    t.Assign: _FunctionWriter._assign, t.CallStatement: _FunctionWriter._call_statement,
    t.KernelCall: _FunctionWriter._kernel_call, t.NewArray: _FunctionWriter._new_array,
    t.Store: _FunctionWriter._store, t.If: _FunctionWriter._if, t.While: _FunctionWriter._while,
    t.For: _FunctionWriter._for, t.Break: _FunctionWriter._break, t.Continue: _FunctionWriter._continue,
    t.Return: _FunctionWriter._return,
}  # fmt: skip
