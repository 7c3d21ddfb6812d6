"""Operations, numbers and names as text of C99."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence

import numpy as np

from ulna.compiler.language.ops import TABLE, Op

_RESERVED_WORDS = """
    alignas alignof and and_eq asm auto bitand bitor bool break case catch char class compl complex const const_cast
    constexpr continue decltype default delete do double dynamic_cast else enum errno explicit export extern false
    float for friend goto if imaginary inline int long mutable namespace new noexcept not not_eq nullptr operator or
    or_eq private protected public register reinterpret_cast requires restrict return short signed sizeof static
    static_assert static_cast struct switch template this thread_local throw true try typedef typeid typename union
    unsigned using virtual void volatile wchar_t while xor xor_eq I unix linux NAN INFINITY HUGE_VAL HUGE_VALF NULL EOF
"""
"""Words of C, C++ and their headers that no argument may have as its name."""

_INFIX = {Op.ADD: "+", Op.SUB: "-", Op.MUL: "*", Op.DIV: "/"}
_COMPARE = {Op.LT: "<", Op.LE: "<=", Op.EQ: "=="}
_LOGIC = {Op.AND: "&&", Op.OR: "||"}
_CALLS = {row.op: row.c for row in TABLE if row.c}
_TAKEN = {*_RESERVED_WORDS.split(), *(name + suffix for name in _CALLS.values() for suffix in ("", "f"))}


def expression(op: int, x: Sequence[str], real: str, prefix: str) -> str:
    """The right side of the assignment that an operation is.

    Args:
        op: A member of `Op` with operands.
        x: The names of the operands.
        real: "double" or "float".
        prefix: What names of functions of the export begin with.

    Returns:
        The expression.
    """
    operation = Op(op)
    if operation in _INFIX:
        return f"{x[0]} {_INFIX[operation]} {x[1]}"
    if operation in _COMPARE:
        return f"{x[0]} {_COMPARE[operation]} {x[1]}"
    if operation in _LOGIC:
        return f"{x[0]} {_LOGIC[operation]} {x[1]}"
    if operation == Op.NEG:
        return f"-{x[0]}"
    if operation == Op.NOT:
        return f"!{x[0]}"
    if operation == Op.SELECT:
        return f"{x[0]} ? {x[1]} : {x[2]}"
    if operation in (Op.MIN, Op.MAX):
        return f"{prefix}_{operation.name.lower()}({x[0]}, {x[1]})"
    return f"{_CALLS[operation]}{'f' if real == 'float' else ''}({', '.join(x)})"


def number(value: float, real: str) -> str:
    """The literal of a number, rounded to the type.

    Args:
        value: The number [any].
        real: "double" or "float".

    Returns:
        The literal, in parentheses where it is negative.
    """
    if real == "float":
        with np.errstate(over="ignore"):
            single = np.float32(value)
        value, text = float(single), str(single)
    else:
        text = repr(float(value))
    if math.isnan(value):
        return "NAN" if real == "float" else "(double)NAN"
    if math.isinf(value):
        infinity = "HUGE_VALF" if real == "float" else "HUGE_VAL"
        return infinity if value > 0 else f"(-{infinity})"
    text += "f" if real == "float" else ""
    return f"({text})" if text.startswith("-") else text


def argument_names(names: Iterable[str]) -> list[str]:
    """Names of arguments that are no words of C or C++, and differ from each other, from values and functions called.

    Args:
        names: The names as in Python.

    Returns:
        A name for each.
    """
    made: list[str] = []
    for name in names:
        plain = "".join(c if c.isascii() and (c.isalnum() or c == "_") else "_" for c in name)
        is_value = re.fullmatch(r"[vcask]\d+|[win]", plain) is not None
        if plain in _TAKEN or is_value or not plain[:1].isalpha():
            plain = f"arg_{plain}"
        while plain in made:
            plain += "_"
        made.append(plain)
    return made


def wrapped(words: Sequence[str], lead: str, most: int = 110) -> list[str]:
    """Words in lines, each of which begins with `lead`.

    Args:
        words: What stands in the lines, with its commas.
        lead: Blanks in front.
        most: The longest line.

    Returns:
        The lines.
    """
    lines, line = [], lead
    for word in words:
        if len(line) + len(word) > most and line.strip():
            lines.append(line.rstrip())
            line = lead
        line += word + " "
    return [*lines, line.rstrip()] if line.strip() else lines
