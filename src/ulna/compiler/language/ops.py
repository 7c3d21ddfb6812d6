"""The closed table of operations: arity, function on arrays, LLVM instruction, derivatives, names, drawing, cost.

A new operation is one member of `Op` and one row here, one method of `Scalar`, a generator in `codegen.elementary` if
LLVM has no instruction for it, and a function of `ulna.numeric` if NumPy has none.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from dataclasses import KW_ONLY
from enum import IntEnum
from typing import Any

import numpy as np

from ulna import numeric
from ulna.data_classes import dataclass


class Op(IntEnum):
    """What a node of a graph does."""

    INPUT = 0
    CONST = 1
    BOOL = 2  # a constant condition
    NEG = 3
    ABS = 4
    SQRT = 5
    SIN = 6
    COS = 7
    TAN = 8
    ASIN = 9
    ACOS = 10
    EXP = 11
    LOG = 12
    FLOOR = 13
    ADD = 14
    SUB = 15
    MUL = 16
    DIV = 17
    MIN = 18
    MAX = 19
    ATAN2 = 20
    LT = 21
    LE = 22
    EQ = 23
    AND = 24
    OR = 25
    NOT = 26
    SELECT = 27
    LOOP = 28  # iterate a subgraph until its condition fails; data = Loop
    ITEM = 29  # one result of a LOOP; data = its number
    LANE = 30  # the number of the SIMD lane; data = how many lanes
    ANY = 31  # whether a condition holds in any lane
    LEAST = 32  # the smallest number in any lane; nan does not count
    EXPM1 = 33
    LOG1P = 34
    SINH = 35
    ERF = 36


Partial = Callable[..., Any]
"""Partial derivative with respect to one argument, a function of (arguments..., result), all scalars."""


@dataclass(frozen=True)
class Row:
    """What the compiler knows of one operation."""

    op: Op
    arity: int
    numpy: Callable[..., Any] | None = None  # on arrays; of `ulna.numeric` where NumPy has no such function
    llvm: str = ""  # an instruction, or "@name" for the intrinsic llvm.name; empty: the node writer knows
    partials: tuple[Partial | None, ...] = ()  # None where the derivative is zero almost everywhere
    kind: str = "function"  # the group it belongs to in drawings
    sign: str = ""  # what stands between two arguments in drawings
    symbols: Callable[..., Any] | str = ""  # on symbols of other packages: a function, or SymPy's name
    _: KW_ONLY
    c: str = ""  # the function of C's math.h
    commutes: bool = False
    is_condition: bool = False
    cost: int = 1  # how many sums take about as long; 0: not counted as an operation


def _unary(op: Op, numpy: Any, llvm: str, partial: Partial | None, symbols: Any, c: str = "") -> Row:
    return Row(op, 1, numpy, llvm, (partial,), "sum", symbols=symbols, c=c)


def _function(
    op: Op, numpy: Any, *partials: Partial, llvm: str = "", symbols: Any = "", cost: int = 14
) -> Row:
    """A function; in C, and in SymPy if nothing else is given, its name is that of the operation in lower case."""
    name = op.name.lower()
    return Row(op, len(partials), numpy, llvm, partials, symbols=symbols or name, c=name, cost=cost)


def _condition(op: Op, numpy: Any, llvm: str, sign: str, symbols: Any, commutes: bool = False) -> Row:
    return Row(
        op, 2, numpy, llvm, (None, None), "choice", sign, symbols, commutes=commutes, is_condition=True
    )


def _any_lane(c: Any) -> Any:
    return np.any(c, axis=-1, keepdims=True) if np.ndim(c) else c


def _least_lane(x: Any) -> Any:
    return np.fmin.reduce(x, axis=-1, keepdims=True) if np.ndim(x) else x


def _log_of_one_more(a: Any) -> Any:
    import sympy

    return sympy.log(1 + a)


_ADD = (lambda a, b, y: 1.0, lambda a, b, y: 1.0)
_SUB = (lambda a, b, y: 1.0, lambda a, b, y: -1.0)
_MUL = (lambda a, b, y: b, lambda a, b, y: a)
_DIV = (lambda a, b, y: 1.0 / b, lambda a, b, y: -(y / b))
_MIN = (lambda a, b, y: (b < a)._where_(0.0, 1.0), lambda a, b, y: (b < a)._where_(1.0, 0.0))
_MAX = (lambda a, b, y: (a < b)._where_(0.0, 1.0), lambda a, b, y: (a < b)._where_(1.0, 0.0))
_ATAN2 = (lambda a, b, y: b / (a * a + b * b), lambda a, b, y: -(a / (a * a + b * b)))

TABLE: tuple[Row, ...] = (
    Row(Op.INPUT, 0, kind="input", cost=0),
    Row(Op.CONST, 0, kind="constant", cost=0),
    Row(Op.BOOL, 0, kind="constant", is_condition=True, cost=0),
    _unary(Op.NEG, np.negative, "fneg", lambda a, y: -1.0, operator.neg),
    _unary(Op.ABS, np.abs, "@fabs", lambda a, y: (a < 0.0)._where_(-1.0, 1.0), abs, "fabs"),
    _function(Op.SQRT, np.sqrt, lambda a, y: 0.5 / y, llvm="@sqrt", cost=6),
    _function(Op.SIN, np.sin, lambda a, y: a.cos()),
    _function(Op.COS, np.cos, lambda a, y: -a.sin()),
    _function(Op.TAN, np.tan, lambda a, y: 1.0 + y * y),
    _function(Op.ASIN, np.arcsin, lambda a, y: 1.0 / (1.0 - a * a).sqrt()),
    _function(Op.ACOS, np.arccos, lambda a, y: -1.0 / (1.0 - a * a).sqrt()),
    _function(Op.EXP, np.exp, lambda a, y: y),
    _function(Op.LOG, np.log, lambda a, y: 1.0 / a),
    _unary(Op.FLOOR, np.floor, "@floor", None, "floor", "floor"),
    Row(Op.ADD, 2, np.add, "fadd", _ADD, "sum", "+", operator.add, commutes=True),
    Row(Op.SUB, 2, np.subtract, "fsub", _SUB, "sum", "−", operator.sub),
    Row(Op.MUL, 2, np.multiply, "fmul", _MUL, "product", "×", operator.mul, commutes=True),
    Row(Op.DIV, 2, np.divide, "fdiv", _DIV, "product", "÷", operator.truediv, cost=6),
    Row(Op.MIN, 2, np.minimum, "@minimum", _MIN, "choice", "min", numeric.minimum, commutes=True),
    Row(Op.MAX, 2, np.maximum, "@maximum", _MAX, "choice", "max", numeric.maximum, commutes=True),
    _function(Op.ATAN2, np.arctan2, *_ATAN2),
    _condition(Op.LT, np.less, "fcmp olt", "<", operator.lt),
    _condition(Op.LE, np.less_equal, "fcmp ole", "≤", operator.le),
    _condition(Op.EQ, np.equal, "fcmp oeq", "=", "Eq", commutes=True),
    _condition(Op.AND, np.logical_and, "and", "and", operator.and_, commutes=True),
    _condition(Op.OR, np.logical_or, "or", "or", operator.or_, commutes=True),
    Row(Op.NOT, 1, np.logical_not, "", (None,), "choice", symbols=operator.invert, is_condition=True),
    Row(Op.SELECT, 3, np.where, "select", kind="choice", symbols=numeric.where),
    Row(Op.LOOP, -1, kind="loop", cost=0),
    Row(Op.ITEM, 1, cost=0),
    Row(Op.LANE, 0, cost=0),
    Row(Op.ANY, 1, _any_lane, is_condition=True),
    Row(Op.LEAST, 1, _least_lane),
    _function(Op.EXPM1, np.expm1, lambda a, y: y + 1.0, symbols=lambda a: numeric.exp(a) - 1),
    _function(Op.LOG1P, np.log1p, lambda a, y: 1.0 / (1.0 + a), symbols=_log_of_one_more),
    _function(Op.SINH, np.sinh, lambda a, y: abs(y) + (-abs(a)).exp()),
    _function(Op.ERF, numeric.erf, lambda a, y: 2.0 / np.pi**0.5 * (-(a * a)).exp()),
)
assert all(row.op == number for number, row in enumerate(TABLE)), "rows of TABLE stand in the order of Op"
