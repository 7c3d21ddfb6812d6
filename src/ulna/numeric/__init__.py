"""Functions whose spelling differs between floats, traced scalars and symbols."""

from ulna.numeric.arrays import apply, cross, dot, matrix, skew, vector
from ulna.numeric.loops import loop
from ulna.numeric.scalars import (
    arctan2,
    ceil,
    clip,
    cos,
    exp,
    is_symbolic,
    less,
    maximum,
    minimum,
    sin,
    sincos,
    sqrt,
    tanh,
    where,
)

__all__ = [
    "apply",
    "arctan2",
    "ceil",
    "clip",
    "cos",
    "cross",
    "dot",
    "exp",
    "is_symbolic",
    "less",
    "loop",
    "matrix",
    "maximum",
    "minimum",
    "sin",
    "sincos",
    "skew",
    "sqrt",
    "tanh",
    "vector",
    "where",
]
