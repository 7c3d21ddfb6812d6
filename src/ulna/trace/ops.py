"""The closed table of operations: arity, meaning in NumPy, LLVM spelling, derivative.

Adding an operation is one row here and, if LLVM has no word for it, one generator in `elementary`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Any

import numpy as np


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
    LANE = 30  # the number of the lane; data = how many lanes race
    ANY = 31  # whether a condition holds in any lane
    LEAST = 32  # the smallest number in any lane; nan does not count


Partial = Callable[..., Any]
"""Partial derivative with respect to one argument, a function of (arguments..., result), all scalars."""


@dataclass(frozen=True)
class Row:
    """What the compiler knows of one operation."""

    op: Op
    arity: int
    numpy: Callable[..., Any] | None = None
    llvm: str = ""  # an instruction on two values, or "@name" for the intrinsic llvm.name; else `emit` knows
    partials: tuple[Partial | None, ...] = ()  # None where the derivative is zero almost everywhere
    commutes: bool = False
    is_condition: bool = False
    cost: int = field(default=1)  # 0: not counted as an operation


def _half(y: Any) -> Any:
    return 0.5 / y


def _any_lane(c: Any) -> Any:
    return np.any(c, axis=-1, keepdims=True) if np.ndim(c) else c


def _least_lane(x: Any) -> Any:
    return np.fmin.reduce(x, axis=-1, keepdims=True) if np.ndim(x) else x


_ROWS = (
    Row(Op.INPUT, 0, cost=0),
    Row(Op.CONST, 0, cost=0),
    Row(Op.BOOL, 0, is_condition=True, cost=0),
    Row(Op.NEG, 1, np.negative, "fneg", (lambda a, y: -1.0,)),
    Row(Op.ABS, 1, np.abs, "@fabs", (lambda a, y: (a < 0.0)._where_(-1.0, 1.0),)),
    Row(Op.SQRT, 1, np.sqrt, "@sqrt", (lambda a, y: _half(y),)),
    Row(Op.SIN, 1, np.sin, "", (lambda a, y: a.cos(),)),
    Row(Op.COS, 1, np.cos, "", (lambda a, y: -a.sin(),)),
    Row(Op.TAN, 1, np.tan, "", (lambda a, y: 1.0 + y * y,)),
    Row(Op.ASIN, 1, np.arcsin, "", (lambda a, y: 1.0 / (1.0 - a * a).sqrt(),)),
    Row(Op.ACOS, 1, np.arccos, "", (lambda a, y: -1.0 / (1.0 - a * a).sqrt(),)),
    Row(Op.EXP, 1, np.exp, "", (lambda a, y: y,)),
    Row(Op.LOG, 1, np.log, "", (lambda a, y: 1.0 / a,)),
    Row(Op.FLOOR, 1, np.floor, "@floor", (None,)),
    Row(Op.ADD, 2, np.add, "fadd", (lambda a, b, y: 1.0, lambda a, b, y: 1.0), commutes=True),
    Row(Op.SUB, 2, np.subtract, "fsub", (lambda a, b, y: 1.0, lambda a, b, y: -1.0)),
    Row(Op.MUL, 2, np.multiply, "fmul", (lambda a, b, y: b, lambda a, b, y: a), commutes=True),
    Row(Op.DIV, 2, np.divide, "fdiv", (lambda a, b, y: 1.0 / b, lambda a, b, y: -(y / b))),
    Row(
        Op.MIN,
        2,
        np.minimum,
        "@minimum",
        (lambda a, b, y: (b < a)._where_(0.0, 1.0), lambda a, b, y: (b < a)._where_(1.0, 0.0)),
        commutes=True,
    ),
    Row(
        Op.MAX,
        2,
        np.maximum,
        "@maximum",
        (lambda a, b, y: (a < b)._where_(0.0, 1.0), lambda a, b, y: (a < b)._where_(1.0, 0.0)),
        commutes=True,
    ),
    Row(
        Op.ATAN2,
        2,
        np.arctan2,
        "",
        (lambda a, b, y: b / (a * a + b * b), lambda a, b, y: -(a / (a * a + b * b))),
    ),
    Row(Op.LT, 2, np.less, "fcmp olt", (None, None), is_condition=True),
    Row(Op.LE, 2, np.less_equal, "fcmp ole", (None, None), is_condition=True),
    Row(Op.EQ, 2, np.equal, "fcmp oeq", (None, None), commutes=True, is_condition=True),
    Row(Op.AND, 2, np.logical_and, "and", (None, None), commutes=True, is_condition=True),
    Row(Op.OR, 2, np.logical_or, "or", (None, None), commutes=True, is_condition=True),
    Row(Op.NOT, 1, np.logical_not, "", (None,), is_condition=True),
    Row(Op.SELECT, 3, np.where, "select"),
    Row(Op.LOOP, -1),
    Row(Op.ITEM, 1, cost=0),
    Row(Op.LANE, 0, cost=0),
    Row(Op.ANY, 1, _any_lane, is_condition=True),
    Row(Op.LEAST, 1, _least_lane),
)

TABLE: tuple[Row, ...] = _ROWS
assert all(row.op == number for number, row in enumerate(TABLE)), "rows of TABLE stand in the order of Op"
