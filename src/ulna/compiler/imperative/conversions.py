"""The rules by which numbers and lanes meet in an operation: literals, conversions, broadcasting, folding.

A literal, or a constant made of literals, takes the type of what it meets. A variable int meets f64 as f64, as in
Python. Other mixtures are refused: f32 with f64, f32 with a variable int, lanes of different counts. A number meets
lanes in every lane.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Sequence
from typing import Any

from ulna.compiler.imperative import tree as t
from ulna.compiler.imperative.operations import TABLE
from ulna.compiler.imperative.types import (
    BOOL,
    F64,
    INT,
    Lanes,
    Number,
    Type,
    element_of,
    lanes_of,
    with_element,
)


class Mismatch(Exception):
    """Values that do not fit together; the reader adds the line.

    Args:
        text: What does not fit together.
        fix: How to correct it.
    """

    def __init__(self, text: str, fix: str = "") -> None:
        super().__init__(text)
        self.text, self.fix = text, fix


_PYTHON: dict[str, Callable[..., Any]] = {
    "add": operator.add, "sub": operator.sub, "mul": operator.mul, "div": operator.truediv, "neg": operator.neg,
    "floordiv": operator.floordiv, "mod": operator.mod, "shl": operator.lshift, "shr": operator.rshift,
    "and": operator.and_, "or": operator.or_, "xor": operator.xor, "lt": operator.lt, "le": operator.le,
    "gt": operator.gt, "ge": operator.ge, "eq": operator.eq, "ne": operator.ne, "abs": abs,
    "minimum": min, "maximum": max,
}  # fmt: skip


def literal(value: bool | int | float, line: int) -> t.Constant:
    """A number of the source, which takes the type of what it meets.

    Args:
        value: The number.
        line: Where it stands.

    Returns:
        The constant, of type bool, int or f64.

    Raises:
        Mismatch: If it is an integer of more than 64 bits.
    """
    if isinstance(value, bool):
        return t.Constant(value, BOOL, line)
    if isinstance(value, int):
        if not -(2**63) <= value < 2**63:
            raise Mismatch(f"{value} does not fit into 64 bits")
        return t.Constant(value, INT, line)
    return t.Constant(value, F64, line)


def converted(value: t.Expression, target: Type) -> t.Expression | None:
    """A value as a type that an assignment, a parameter or an operation expects, where no digits can be lost.

    Args:
        value: The value.
        target: The type.

    Returns:
        The value, converted where needed; None where that is not possible.
    """
    if value.type == target:
        return value
    goal, element = element_of(target), element_of(value.type)
    if goal is None or element is None or (lanes_of(value.type) not in (0, lanes_of(target))):
        return None
    if isinstance(value, t.Constant) and value.is_literal:
        if element == goal:
            number: t.Expression = value
        elif goal.is_real and element != BOOL:
            number = t.Constant(float(value.value), goal, value.line, is_literal=False)
        else:
            return None
    elif element == goal:
        number = value
    elif (element, goal) == (INT, F64):
        number = t.Convert(value, with_element(value.type, F64), value.line)
    else:
        return None
    if isinstance(target, Lanes) and not lanes_of(number.type):
        return t.Broadcast(number, target, value.line)
    return number


def _common(values: Sequence[t.Expression]) -> Type:
    """The type in which values meet."""
    counts = {lanes_of(v.type) for v in values} - {0}
    if len(counts) > 1:
        raise Mismatch(f"lanes of different counts meet: {', '.join(map(str, sorted(counts)))}")
    settled = [v for v in values if not (isinstance(v, t.Constant) and v.is_literal)] or list(values)
    elements = {element_of(v.type) for v in settled}
    if None in elements:
        kinds = ", ".join(str(v.type) for v in values if element_of(v.type) is None)
        raise Mismatch(
            f"numbers are expected, not {kinds}", "Index the array, or name a field of the record."
        )
    if elements == {INT} and any(element_of(v.type) == F64 for v in values):
        elements = {F64}
    if elements == {INT, F64}:
        elements = {F64}
    if len(elements) > 1:
        names = " and ".join(sorted(str(e) for e in elements))
        raise Mismatch(f"{names} meet", "Convert one of them: f32(x), f64(x), int(x).")
    element = next(iter(elements))
    assert element is not None
    return Lanes(element, counts.pop()) if counts else element


def unified(values: Sequence[t.Expression]) -> list[t.Expression]:
    """The values in their common type.

    Raises:
        Mismatch: If they have none.
    """
    common = _common(values)
    result = []
    for value in values:
        same = converted(value, common)
        if same is None:
            raise Mismatch(f"{value.type} does not become {common}", "Convert it: f32(x), f64(x), int(x).")
        result.append(same)
    return result


def operate(name: str, values: Sequence[t.Expression], line: int) -> t.Expression:
    """An operation of the table on values; constants are computed at once.

    Args:
        name: The operation.
        values: Its arguments.
        line: Where it stands.

    Returns:
        The expression.

    Raises:
        Mismatch: If the arguments are not of the kind it takes.
    """
    row = TABLE[name]
    if len(values) != row.arity:
        raise Mismatch(f"{name} takes {row.arity} arguments, not {len(values)}")
    constants = [v.value for v in values if isinstance(v, t.Constant) and v.is_literal]
    if len(constants) == len(values) and name in _PYTHON:
        try:
            return literal(_PYTHON[name](*constants), line)
        except (ArithmeticError, ValueError, TypeError) as error:
            raise Mismatch(f"the constant cannot be computed: {error}") from None
    return _TYPED[row.kind](name, values, line)


def _arithmetic(name: str, values: Sequence[t.Expression], line: int) -> t.Expression:
    same = unified(values)
    if element_of(same[0].type) == BOOL:
        raise Mismatch(f"{name} takes numbers, not bool")
    return t.Operation(name, tuple(same), same[0].type, line)


def _integer(name: str, values: Sequence[t.Expression], line: int) -> t.Expression:
    same = unified(values)
    if element_of(same[0].type) != INT:
        raise Mismatch(f"{name} takes integers, not {same[0].type}")
    if name in ("floordiv", "mod") and lanes_of(same[0].type):
        raise Mismatch(f"{name} takes single integers, not lanes")
    return t.Operation(name, tuple(same), same[0].type, line)


def _bits(name: str, values: Sequence[t.Expression], line: int) -> t.Expression:
    same = unified(values)
    if element_of(same[0].type) not in (INT, BOOL):
        raise Mismatch(f"{name} takes integers, bools or masks, not {same[0].type}")
    return t.Operation(name, tuple(same), same[0].type, line)


def _real(name: str, values: Sequence[t.Expression], line: int) -> t.Expression:
    same = unified(values)
    element = element_of(same[0].type)
    if element == INT:  # as in Python: 1 / 2 and sqrt(2) are floats
        same = [converted(v, with_element(v.type, F64)) or v for v in same]
    elif element is None or not element.is_real:
        raise Mismatch(f"{name} takes numbers, not {same[0].type}")
    return t.Operation(name, tuple(same), same[0].type, line)


def _comparison(name: str, values: Sequence[t.Expression], line: int) -> t.Expression:
    same = unified(values)
    if element_of(same[0].type) == BOOL:
        raise Mismatch(f"{name} compares numbers, not bool", "Use ^ for bools.")
    return t.Operation(name, tuple(same), with_element(same[0].type, BOOL), line)


def _selection(name: str, values: Sequence[t.Expression], line: int) -> t.Expression:
    condition, *rest = values
    if element_of(condition.type) != BOOL:
        raise Mismatch(f"where takes a condition first, not {condition.type}")
    a, b = unified(rest)
    count = lanes_of(condition.type)
    if count and not lanes_of(a.type):
        element = element_of(a.type)
        assert element is not None
        a, b = (t.Broadcast(x, Lanes(element, count), line) for x in (a, b))
    if lanes_of(a.type) != count and count:
        raise Mismatch(f"the mask has {count} lanes, the values {lanes_of(a.type)}")
    return t.Operation(name, (condition, a, b), a.type, line)


def _reduction(name: str, values: Sequence[t.Expression], line: int) -> t.Expression:
    (value,) = values
    if not isinstance(value.type, Lanes) or value.type.element == BOOL:
        raise Mismatch(f"{name} takes lanes of numbers, not {value.type}")
    return t.Operation(name, (value,), value.type.element, line)


def _mask_reduction(name: str, values: Sequence[t.Expression], line: int) -> t.Expression:
    (value,) = values
    if not isinstance(value.type, Lanes) or value.type.element != BOOL:
        raise Mismatch(f"{name} takes a mask, the result of a comparison of lanes, not {value.type}")
    return t.Operation(name, (value,), BOOL if name in ("any_of", "all_of") else INT, line)


_TYPED: dict[str, Callable[[str, Sequence[t.Expression], int], t.Expression]] = {
    "arithmetic": _arithmetic, "integer": _integer, "bits": _bits, "real": _real, "comparison": _comparison,
    "selection": _selection, "reduction": _reduction, "mask_reduction": _mask_reduction,
}  # fmt: skip


def converted_explicitly(value: t.Expression, element: Number, line: int) -> t.Expression:
    """A conversion that the source asks for: `int(x)`, `f32(x)`, `f64(x)`, `bool(x)`.

    Args:
        value: Numbers or lanes.
        element: What they become.
        line: Where it stands.

    Returns:
        The expression; a float becomes an integer towards zero, the nearest one where it does not fit, nan becomes 0.

    Raises:
        Mismatch: If the value holds no numbers.
    """
    source = element_of(value.type)
    if source is None:
        raise Mismatch(f"{element}(...) takes numbers or lanes, not {value.type}")
    if element == BOOL and source != BOOL:
        raise Mismatch("bool(...) takes a bool", "Compare instead: x != 0.")
    if isinstance(value, t.Constant) and value.is_literal:
        number = {"int": int, "bool": bool}.get(element.name, float)(value.value)
        return t.Constant(number, element, line, is_literal=element == INT)
    if source == element:
        return value
    return t.Convert(value, with_element(value.type, element), line)
