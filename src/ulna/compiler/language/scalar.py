"""The traced scalar: stands for a number while a function is traced, and records what is done with it.

It travels in NumPy object arrays: `@`, `*`, `np.sin` and the like call the methods here, one for each element.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partialmethod
from typing import Any, NoReturn

import numpy as np

from ulna.compiler.language.graph import Graph, Loop
from ulna.compiler.language.ops import TABLE, Op
from ulna.errors import TraceError
from ulna.numeric import composed

_NUMBERS = (float, int, np.floating, np.integer)


class Value:
    """A node of a graph, as seen by the function under trace: a `Scalar` or a `Condition`.

    Args:
        graph: The graph.
        index: The node.
    """

    __slots__ = ("graph", "index")

    def __init__(self, graph: Graph, index: int) -> None:
        self.graph = graph
        self.index = index

    def __repr__(self) -> str:
        return f"<traced {TABLE[self.graph.op[self.index]].op.name.lower()} #{self.index}>"

    def __reduce__(self) -> NoReturn:
        raise TraceError("A traced value cannot be pickled or copied out of its trace; pickle the Function.")

    def __bool__(self) -> NoReturn:
        raise TraceError(
            "A traced value has no truth: `if`, `and`, `or`, `min()`, `max()`, np.minimum, np.sign and np.clip cannot "
            "branch on it, and `<` cannot compare an array of them. Use ulna.numeric.where, minimum, maximum, clip, "
            "and less for arrays, and ulna.numeric.loop for `while`; combine conditions with & | ~ ^ ==."
        )

    def _loop_(self, condition: Any, body: Any, state: tuple[Any, ...], limit: int) -> tuple[Any, ...]:
        """The hook of numeric.loop: iterates `body` on the flat `state` while `condition`, lane by lane."""
        outer = innermost(self, *state)
        current = under_trace() or outer
        if _is_inside(current, outer):  # the state may start from values further out
            outer = current
        inner = Graph(relaxed=outer.relaxed, parent=outer)
        variables = tuple(Scalar(inner, inner.input()) for _ in state)
        with tracing(inner):
            following = body(*variables)
            holds = condition(*variables)
        if not isinstance(following, (tuple, list)) or len(following) != len(state):
            is_sequence = isinstance(following, (tuple, list))
            returned = f"{len(following)} values" if is_sequence else type(following).__name__
            raise TraceError(
                f"The body of a loop returned {returned}; expected a tuple of {len(state)} numbers, "
                "the state that follows."
            )
        if not isinstance(holds, (Condition, bool, np.bool_)):
            raise TraceError(
                f"The condition of a loop returned {type(holds).__name__}; expected a comparison."
            )
        follows = tuple(number_in(inner, value) for value in following)
        loop = Loop(inner, len(state), index_in(inner, holds), follows, int(limit))
        args = [number_in(outer, value) for value in state] + inner.captured
        return tuple(Scalar(outer, item) for item in outer.loop(loop, args))


class Condition(Value):
    """A traced truth value; combine with `&`, `|`, `^`, `~`, `==`, use with `numeric.where`."""

    __slots__ = ()

    def _and_or(self, op: int, other: Any) -> Condition:
        if isinstance(other, (bool, np.bool_)):
            g, a, b = self.graph, self.index, self.graph.truth(bool(other))
        elif isinstance(other, Condition):
            g, a, b = meet(self, other)
        else:
            return NotImplemented
        return Condition(g, g.node(op, a, b))

    __and__ = __rand__ = partialmethod(_and_or, Op.AND)
    __or__ = __ror__ = partialmethod(_and_or, Op.OR)

    def __invert__(self) -> Condition:
        return Condition(self.graph, self.graph.node(Op.NOT, self.index))

    def __xor__(self, other: Any) -> Any:
        return (self | other) & ~(self & other)

    def __eq__(self, other: object) -> Any:
        return ~(self ^ other)

    __ne__ = __rxor__ = __xor__  # type: ignore[assignment]
    __hash__ = None  # type: ignore[assignment]

    def _where_(self, a: Any, b: Any) -> Any:
        """`a` where this holds, else `b`: the hook of numeric.where."""
        if isinstance(a, (Condition, bool, np.bool_)) and isinstance(b, (Condition, bool, np.bool_)):
            return (self & a) | (~self & b)
        g = innermost(self, a, b)
        return Scalar(g, g.node(Op.SELECT, index_in(g, self), number_in(g, a), number_in(g, b)))


def _binary_method(op: int, *, swap: bool = False, doc: str = "") -> Callable[[Scalar, Any], Any]:
    """A method that makes the node of `op` on the value and its argument, or the other way round."""
    is_condition, new = TABLE[op].is_condition, object.__new__
    op = int(op)  # a plain number: see simplify.py

    def method(self: Scalar, other: Any) -> Any:
        g = self.graph
        if type(other) is Scalar and other.graph is g:
            a, b = self.index, other.index
        elif isinstance(other, Scalar):
            g, a, b = meet(self, other)
        elif isinstance(other, _NUMBERS):
            a, b = self.index, g.constant(other)
        else:
            return NotImplemented
        made = new(Condition if is_condition else Scalar)
        made.graph = g
        made.index = g.pair(op, b, a) if swap else g.pair(op, a, b)
        return made

    method.__doc__ = doc
    return method


def _unary_method(op: int, doc: str) -> Callable[[Scalar], Scalar]:
    """A method that makes the node of `op` on the value."""

    def method(self: Scalar) -> Scalar:
        return Scalar(self.graph, self.graph.node(op, self.index))

    method.__doc__ = doc
    return method


class Scalar(Value):
    """A traced number."""

    __slots__ = ()

    @property
    def _known_(self) -> float | None:
        """The number, where it does not depend on any input."""
        return self.graph.data[self.index] if self.graph.op[self.index] == Op.CONST else None

    __add__ = __radd__ = _binary_method(Op.ADD)
    __sub__, __rsub__ = _binary_method(Op.SUB), _binary_method(Op.SUB, swap=True)
    __mul__ = __rmul__ = _binary_method(Op.MUL)
    __truediv__, __rtruediv__ = _binary_method(Op.DIV), _binary_method(Op.DIV, swap=True)
    __lt__, __gt__ = _binary_method(Op.LT), _binary_method(Op.LT, swap=True)
    __le__, __ge__ = _binary_method(Op.LE), _binary_method(Op.LE, swap=True)
    _equals = _binary_method(Op.EQ)
    __hash__ = None  # type: ignore[assignment]
    __neg__, __abs__ = _unary_method(Op.NEG, "The negative."), _unary_method(Op.ABS, "The absolute value.")

    def __eq__(self, other: object) -> Any:
        return self._equals(other)

    def __ne__(self, other: object) -> Any:
        equal = self._equals(other)
        return equal if equal is NotImplemented else ~equal

    def __mod__(self, other: Any) -> Any:
        """Remainder with the sign of the divisor, as np.mod."""
        return self - (self / other).floor() * other

    def __floordiv__(self, other: Any) -> Any:
        """The largest whole number not above the quotient."""
        return (self / other).floor()

    def __pow__(self, exponent: Any) -> Any:
        """Integer powers by repeated squaring, halves by the square root; others as exp(exponent * log(self)).

        The last form is off by about exponent * log(self) ULP.
        """
        if isinstance(exponent, _NUMBERS):
            if float(exponent).is_integer() and abs(exponent) <= 64:
                return composed.integer_power(self, int(exponent))
            if float(2.0 * exponent).is_integer() and abs(exponent) <= 64:
                half = composed.integer_power(self, int(abs(exponent) - 0.5)) * self.sqrt()
                return half if exponent > 0 else 1.0 / half
            if not float(exponent).is_integer():
                return (self.log() * exponent).exp()
            exponent = Scalar(self.graph, self.graph.constant(float(exponent)))
        return composed.power(self, exponent) if isinstance(exponent, Scalar) else NotImplemented

    def __rpow__(self, base: Any) -> Any:
        if not isinstance(base, _NUMBERS):
            return NotImplemented
        if base > 0.0:
            return (self * float(np.log(base))).exp()
        return composed.power(Scalar(self.graph, self.graph.constant(float(base))), self)

    def __float__(self) -> NoReturn:
        raise TraceError(
            "A traced value has no number yet, so float(), math.sin, np.array(..., dtype=float) and storing it in a "
            "float array cannot work. Use np.sin and the like, and build arrays with ulna.numeric.vector or matrix."
        )

    __int__ = __index__ = __round__ = __float__  # type: ignore[assignment]

    # The names that NumPy's ufuncs call on the elements of an object array.
    sqrt = _unary_method(Op.SQRT, "Square root.")
    sin = _unary_method(Op.SIN, "Sine [rad].")
    cos = _unary_method(Op.COS, "Cosine [rad].")
    tan = _unary_method(Op.TAN, "Tangent [rad].")
    arcsin = _unary_method(Op.ASIN, "Inverse sine [rad].")
    arccos = _unary_method(Op.ACOS, "Inverse cosine [rad].")
    exp = _unary_method(Op.EXP, "Exponential.")
    log = _unary_method(Op.LOG, "Natural logarithm.")
    expm1 = _unary_method(Op.EXPM1, "Exponential less 1, also of small numbers.")
    log1p = _unary_method(Op.LOG1P, "Natural logarithm of 1 more, also of small numbers.")
    sinh = _unary_method(Op.SINH, "Hyperbolic sine.")
    erf = _unary_method(Op.ERF, "Error function.")
    floor = _unary_method(Op.FLOOR, "The largest whole number that is not larger.")
    arctan2 = _binary_method(Op.ATAN2, doc="Angle of the point (other, self) [rad].")
    _minimum_, _maximum_ = _binary_method(Op.MIN), _binary_method(Op.MAX)

    def arctan(self) -> Scalar:
        """Inverse tangent [rad]."""
        return self.arctan2(1.0)

    def ceil(self) -> Scalar:
        """The smallest whole number that is not smaller."""
        return -((-self).floor())

    __floor__, __ceil__ = floor, ceil  # what NumPy calls for np.floor and np.ceil

    def square(self) -> Scalar:
        """The square."""
        return self * self

    hypot, cosh, tanh = composed.hypot, composed.cosh, composed.tanh
    deg2rad = radians = composed.deg2rad
    rad2deg = degrees = composed.rad2deg

    def conjugate(self) -> Scalar:
        """The value itself, which is real."""
        return self

    __pos__ = conjugate


class _UnderTrace(threading.local):
    """The graphs that this thread is making, innermost last."""

    def __init__(self) -> None:
        self.graphs: list[Graph] = []


_under_trace = _UnderTrace()


def under_trace() -> Graph | None:
    """The innermost graph that this thread is making, if any."""
    return _under_trace.graphs[-1] if _under_trace.graphs else None


@contextmanager
def tracing(graph: Graph) -> Iterator[None]:
    """While the block runs, `graph` is the one under trace: a loop met there becomes one of its nodes."""
    _under_trace.graphs.append(graph)
    try:
        yield
    finally:
        _under_trace.graphs.pop()


def index_in(graph: Graph, value: Any) -> int:
    """The node of `graph` that stands for `value`: a traced value, a number or a truth value.

    Args:
        graph: The graph that is being traced.
        value: A traced value, a number or a truth value.

    Returns:
        The node; a value of a graph around this one is captured.

    Raises:
        TraceError: If the value is none of these, or belongs to another trace.
    """
    if isinstance(value, Value):
        return value.index if value.graph is graph else graph.capture(value.graph, value.index)
    if isinstance(value, (bool, np.bool_)):
        return graph.truth(bool(value))
    if isinstance(value, _NUMBERS):
        return graph.constant(float(value))
    raise TraceError(
        f"A traced function met {value!r} of type {type(value).__name__}; expected a real number."
    )


def number_in(graph: Graph, value: Any) -> int:
    """As `index_in`, where a number is needed: a truth value counts as 1.0 or 0.0.

    Args:
        graph: The graph that is being traced.
        value: A traced value, a number or a truth value.

    Returns:
        The node of the number.
    """
    index = index_in(graph, value)
    if isinstance(value, (Condition, bool, np.bool_)):
        return graph.node(Op.SELECT, index, graph.constant(1.0), graph.constant(0.0))
    return index


def innermost(*values: Any) -> Graph:
    """The deepest graph among the traced values; numbers have none."""
    deepest: Graph | None = None
    for value in values:
        if isinstance(value, Value) and (deepest is None or _is_inside(value.graph, deepest)):
            deepest = value.graph
    if deepest is None:
        raise TraceError("None of the values is traced.")
    return deepest


def meet(a: Value, b: Value) -> tuple[Graph, int, int]:
    """Both values as nodes of the deeper one's graph.

    Args:
        a: A traced value.
        b: A traced value, of the same graph or of one around it or in it.

    Returns:
        The graph, and the nodes of both values in it.
    """
    graph = innermost(a, b)
    return graph, index_in(graph, a), index_in(graph, b)


def _is_inside(graph: Graph | None, other: Graph) -> bool:
    """Whether `graph` is `other` or the body of a loop in it, at any depth."""
    while graph is not None:
        if graph is other:
            return True
        graph = graph.parent
    return False
