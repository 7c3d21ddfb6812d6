"""Writes the operations of the imperative language on numbers and lanes as LLVM instructions."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

from ulna.compiler.codegen.elementary import OPERATIONS, elementary_ir
from ulna.compiler.codegen.ir_text import DType
from ulna.compiler.codegen.ir_text import Lanes as Layout
from ulna.compiler.codegen.procedure_types import DIVISION_BY_ZERO, WORDS, number, suffix, word
from ulna.compiler.codegen.procedure_values import ValueWriter
from ulna.compiler.codegen.sincos import sincos_ir
from ulna.compiler.imperative import tree as t
from ulna.compiler.imperative.types import BOOL, INT, Lanes, Type, element_of, lanes_of

_sincos_ir, _elementary_ir = cache(sincos_ir), cache(elementary_ir)
_REAL = {"add": "fadd", "sub": "fsub", "mul": "fmul", "div": "fdiv"}
_INTEGER = {"add": "add", "sub": "sub", "mul": "mul", "and": "and", "or": "or", "xor": "xor"}
_REAL_PREDICATES = {"lt": "olt", "le": "ole", "gt": "ogt", "ge": "oge", "eq": "oeq", "ne": "une"}
_INTEGER_PREDICATES = {"lt": "slt", "le": "sle", "gt": "sgt", "ge": "sge", "eq": "eq", "ne": "ne"}


def write_operation(w: ValueWriter, e: t.Operation) -> str:
    """The value of an operation.

    Args:
        w: Where it is written.
        e: The operation.

    Returns:
        Its name or literal.
    """
    if e.name == "lane_numbers":
        assert isinstance(e.type, Lanes)
        element = e.type.element
        return (
            "<" + ", ".join(f"{WORDS[element.name]} {number(k, element)}" for k in range(e.type.count)) + ">"
        )
    values = [w.scalar(a) for a in e.arguments]
    kind = e.arguments[0].type
    special = _WRITERS.get(e.name)
    if special is not None:
        return special(w, e, values)
    element = element_of(kind)
    if e.name in _REAL_PREDICATES:
        predicates, opcode = (_INTEGER_PREDICATES, "icmp") if element == INT else (_REAL_PREDICATES, "fcmp")
        return w.emit(f"{opcode} {predicates[e.name]} {word(kind)} {values[0]}, {values[1]}")
    if element is not None and element.is_real:
        if e.name in _REAL:
            return w.emit(f"{_REAL[e.name]}{w.contract} {word(kind)} {values[0]}, {values[1]}")
        return _elementary(w, e, values)
    return w.emit(f"{_INTEGER[e.name]} {word(kind)} {values[0]}, {values[1]}")


def _elementary(w: ValueWriter, e: t.Operation, values: list[str]) -> str:
    element, kind = element_of(e.type), word(e.type)
    assert element is not None
    dtype: DType = "float" if element.name == "f32" else "double"
    count = lanes_of(e.type) or 1
    typed = [f"{kind} {v}" for v in values]
    if e.name in ("sin", "cos"):
        code = _sincos_ir(count, dtype)
        w.module.use(code)
        pair = Layout(count, dtype).pair
        both = w.emit(f"call {pair} @{code.name}({typed[0]})")
        return w.emit(f"extractvalue {pair} {both}, {0 if e.name == 'sin' else 1}")
    if e.name in OPERATIONS:
        code = _elementary_ir(e.name, count, dtype)
        w.module.use(code)
        return w.emit(f"call {kind} @{code.name}({', '.join(typed)})")
    return w.intrinsic(f"{e.name}.{suffix(e.type)}", kind, *((kind, v) for v in values))


def _negative(w: ValueWriter, e: t.Operation, values: list[str]) -> str:
    if element_of(e.type) == INT:
        return w.emit(f"sub {word(e.type)} {_all(w, '0', e.type)}, {values[0]}")
    return w.emit(f"fneg {word(e.type)} {values[0]}")


def _absolute(w: ValueWriter, e: t.Operation, values: list[str]) -> str:
    kind = word(e.type)
    if element_of(e.type) == INT:
        return w.intrinsic(f"abs.{suffix(e.type)}", kind, (kind, values[0]), ("i1", "false"))
    return w.intrinsic(f"fabs.{suffix(e.type)}", kind, (kind, values[0]))


def _inverted(w: ValueWriter, e: t.Operation, values: list[str]) -> str:
    ones = "true" if element_of(e.type) == BOOL else "-1"
    return w.emit(f"xor {word(e.type)} {values[0]}, {_all(w, ones, e.type)}")


def _all(w: ValueWriter, value: str, type_: Type) -> str:
    """A literal in every lane of a type."""
    element = element_of(type_)
    assert element is not None
    return f"splat ({WORDS[element.name]} {value})" if lanes_of(type_) else value


def _extreme(w: ValueWriter, name: str, type_: Type, a: str, b: str) -> str:
    """b where it is smaller (larger) than a, else a."""
    kind = word(type_)
    opcode = "icmp s" if element_of(type_) == INT else "fcmp o"
    relation = "lt" if name == "minimum" else "gt"
    condition = w.emit(f"{opcode}{relation} {kind} {b}, {a}")
    mask = f"<{lanes_of(type_)} x i1>" if lanes_of(type_) else "i1"
    return w.emit(f"select {mask} {condition}, {kind} {b}, {kind} {a}")


def _select(w: ValueWriter, e: t.Operation, values: list[str]) -> str:
    kind = word(e.type)
    return w.emit(f"select {word(e.arguments[0].type)} {values[0]}, {kind} {values[1]}, {kind} {values[2]}")


def _shift(w: ValueWriter, e: t.Operation, values: list[str]) -> str:
    kind = word(e.type)
    amount = w.emit(f"and {kind} {values[1]}, {_all(w, '63', e.type)}")
    return w.emit(f"{'shl' if e.name == 'shl' else 'ashr'} {kind} {values[0]}, {amount}")


def _divide(w: ValueWriter, e: t.Operation, values: list[str]) -> str:
    """Division of integers towards minus infinity, as in Python, or its remainder."""
    a, b = values
    divisor = e.arguments[1]
    if not (isinstance(divisor, t.Constant) and divisor.value not in (0, -1)):
        w.leave_if(w.emit(f"icmp eq i64 {b}, 0"), DIVISION_BY_ZERO, e.line)
        # -(2^63) / -1 overflows: divide by 1 and negate
        is_minus_one = w.emit(f"icmp eq i64 {b}, -1")
        negated = w.emit(f"sub i64 0, {a}")
        a = w.emit(f"select i1 {is_minus_one}, i64 {negated}, i64 {a}")
        b = w.emit(f"select i1 {is_minus_one}, i64 1, i64 {b}")
    remainder = w.emit(f"srem i64 {a}, {b}")
    differs = w.emit(f"icmp slt i64 {w.emit(f'xor i64 {remainder}, {b}')}, 0")
    is_rest = w.emit(f"icmp ne i64 {remainder}, 0")
    below = w.emit(f"and i1 {differs}, {is_rest}")
    if e.name == "mod":
        return w.emit(f"add i64 {remainder}, {w.emit(f'select i1 {below}, i64 {b}, i64 0')}")
    quotient = w.emit(f"sdiv i64 {a}, {b}")
    return w.emit(f"sub i64 {quotient}, {w.emit(f'zext i1 {below} to i64')}")


def _reduce(w: ValueWriter, e: t.Operation, values: list[str]) -> str:
    """Lanes to one number: the upper half meets the lower one until one is left."""
    kind = e.arguments[0].type
    assert isinstance(kind, Lanes)
    value, count, element = values[0], kind.count, kind.element
    while count > 1:
        half = count // 2
        wide = word(Lanes(element, count)) if count > 1 else WORDS[element.name]
        halves = []
        for start in (0, half):
            places = ", ".join(f"i32 {start + k}" for k in range(half))
            halves.append(w.emit(f"shufflevector {wide} {value}, {wide} poison, <{half} x i32> <{places}>"))
        value, count = _combine(w, e.name, Lanes(element, half), *halves), half
    return w.emit(f"extractelement <1 x {WORDS[element.name]}> {value}, i64 0")


def _combine(w: ValueWriter, name: str, type_: Lanes, a: str, b: str) -> str:
    if name == "sum_of":
        return w.emit(f"{'add' if type_.element == INT else 'fadd'} {word(type_)} {a}, {b}")
    return _extreme(w, "minimum" if name == "least_of" else "maximum", type_, a, b)


def _reduce_mask(w: ValueWriter, e: t.Operation, values: list[str]) -> str:
    count = lanes_of(e.arguments[0].type)
    bits = w.emit(f"bitcast <{count} x i1> {values[0]} to i{count}")
    if e.name == "any_of":
        return w.emit(f"icmp ne i{count} {bits}, 0")
    if e.name == "all_of":
        return w.emit(f"icmp eq i{count} {bits}, -1")
    # in 64 bits, with a bit beyond the mask for "none"
    wide = bits if count == 64 else w.emit(f"zext i{count} {bits} to i64")
    if e.name == "count_of":
        return w.intrinsic("ctpop.i64", "i64", ("i64", wide))
    if count < 64:
        wide = w.emit(f"or i64 {wide}, {1 << count}")
    return w.intrinsic("cttz.i64", "i64", ("i64", wide), ("i1", "false"))


_WRITERS: dict[str, Callable[[ValueWriter, t.Operation, list[str]], str]] = {
    "neg": _negative, "abs": _absolute, "not": _inverted, "where": _select, "shl": _shift, "shr": _shift,
    "floordiv": _divide, "mod": _divide, "sum_of": _reduce, "least_of": _reduce, "greatest_of": _reduce,
    "any_of": _reduce_mask, "all_of": _reduce_mask, "count_of": _reduce_mask, "first_of": _reduce_mask,
    "minimum": lambda w, e, v: _extreme(w, "minimum", e.type, *v),
    "maximum": lambda w, e, v: _extreme(w, "maximum", e.type, *v),
}  # fmt: skip
