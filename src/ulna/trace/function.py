"""Traces a Python function of arrays into a `Function`: a graph with named, shaped inputs and outputs."""

from __future__ import annotations

import operator
import re
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import prod
from typing import Any

import numpy as np

from ulna import numeric
from ulna.errors import InputError, ShapeError, TraceError
from ulna.numeric import is_symbolic
from ulna.trace.graph import Graph, Loop
from ulna.trace.interpret import interpret
from ulna.trace.ops import TABLE, Op
from ulna.trace.scalar import Scalar, Value, index_in, innermost, number_in, tracing

Shape = tuple[int, ...]


@dataclass(frozen=True)
class Port:
    """An input or output: its name and the shape of one sample."""

    name: str
    shape: Shape

    @property
    def size(self) -> int:
        """How many numbers one sample holds."""
        return prod(self.shape)


@dataclass(frozen=True, eq=False)
class Function:
    """A traced function: arrays in, arrays out, every number a node of one graph.

    Call it with floats (leading batch axes allowed) to interpret it with NumPy, or inside another trace to inline it.
    `compile(function)` makes machine code of it.
    """

    name: str
    graph: Graph
    inputs: tuple[Port, ...]
    outputs: tuple[Port, ...]
    results: tuple[int, ...]  # the nodes of all outputs, flat, one after the other
    single: bool = True  # whether calls return the only output instead of a tuple
    doc: str = field(default="", repr=False)
    lanes: int = 1  # more than 1 for a race, which one sample runs in so many lanes; see `ulna.trace.race`

    def __call__(self, *args: Any) -> Any:
        """Evaluates on floats by interpretation, or inlines into the trace under way."""
        if len(args) != len(self.inputs):
            names = ", ".join(p.name for p in self.inputs)
            raise TypeError(
                f"{self.name}({names}) takes {len(self.inputs)} arguments; {len(args)} were given."
            )
        if is_symbolic(*args):
            if self.lanes > 1:
                raise TraceError(
                    f"{self.name} is a race of lanes and takes numbers only; it cannot be inlined."
                )
            return self._inline(args)
        arrays = [np.asarray(a, dtype=float) for a in args]
        batches = [_batch_of(a, port) for a, port in zip(arrays, self.inputs, strict=True)]
        batch = np.broadcast_shapes(*batches)
        flat: list[Any] = []
        for a, port in zip(arrays, self.inputs, strict=True):
            rows = np.broadcast_to(a, batch + port.shape).reshape(*batch, port.size)
            flat.extend(rows[..., k] for k in range(port.size))
        if self.lanes == 1:
            values = interpret(self.graph, flat, self.results)
        else:  # the lanes are one more axis, and lane 0 speaks for all
            values = interpret(self.graph, [x[..., None] for x in flat], self.results)
            values = [np.broadcast_to(v, (*batch, self.lanes))[..., 0] for v in values]
        columns = [np.broadcast_to(np.asarray(v, dtype=float), batch) for v in values]
        return self._pack(
            columns, lambda part: np.stack(part, axis=-1) if part else np.zeros((*batch, 0)), batch
        )

    def _pack(self, flat: Sequence[Any], join: Callable[[Sequence[Any]], Any], batch: Shape = ()) -> Any:
        arrays, start = [], 0
        for port in self.outputs:
            arrays.append(join(flat[start : start + port.size]).reshape(batch + port.shape)[()])
            start += port.size
        return arrays[0] if self.single else tuple(arrays)

    def _inline(self, args: Sequence[Any]) -> Any:
        flat: list[Any] = []
        for a, port in zip(args, self.inputs, strict=True):
            array = np.asarray(a, dtype=object)
            if array.shape != port.shape:
                raise ShapeError(
                    port.name, array.shape, str(port.shape), "A traced call takes one sample, no batch."
                )
            flat.extend(array.reshape(-1))
        if not any(isinstance(v, Value) for v in flat):  # symbols of another kind
            return self._pack(_replay_on_objects(self, flat), lambda part: np.array(part, dtype=object))
        graph = innermost(*flat)
        nodes = copy_into(graph, self.graph, self.results, [index_in(graph, v) for v in flat])
        return self._pack([Scalar(graph, n) for n in nodes], _object_array)

    @cached_property
    def operation_counts(self) -> dict[str, int]:
        """How often each operation occurs; a loop's body counts once."""
        return dict(sorted(_count(self.graph, self.results).items()))

    @property
    def operations(self) -> int:
        """How many scalar operations one evaluation takes; a loop's body counts once."""
        return sum(self.operation_counts.values())

    @cached_property
    def has_loops(self) -> bool:
        """Whether the graph iterates."""
        return Op.LOOP in self.graph.op

    @property
    def signature(self) -> str:
        """The signature as NumPy writes a generalised ufunc's, with frozen sizes: "(7)->(4,4)"."""

        def side(ports: Sequence[Port]) -> str:
            return ",".join("(" + ",".join(map(str, p.shape)) + ")" for p in ports)

        return f"{side(self.inputs)}->{side(self.outputs)}"

    @cached_property
    def fingerprint(self) -> str:
        """A hash of what is computed, the same in every process."""
        return self.graph.fingerprint(self.results)

    def jvp(self) -> Function:
        """Forward derivative: inputs and their tangents in, tangents of the outputs out."""
        from ulna.trace.differentiate import jvp

        return jvp(self)

    def vjp(self) -> Function:
        """Reverse derivative: inputs and cotangents of the outputs in, cotangents of the inputs out."""
        from ulna.trace.differentiate import vjp

        return vjp(self)

    def jacobian(self, wrt: str | int = 0) -> Function:
        """Derivative of every output by input `wrt`: shape output + input; the cheaper sweep is taken."""
        from ulna.trace.differentiate import jacobian

        return jacobian(self, wrt)

    def draw(self, path: str | None = None) -> str:
        """The graph as an SVG picture, layered by depth; written to `path` when one is given."""
        from ulna.trace.draw import draw

        return draw(self, path)


def trace(
    f: Callable[..., Any],
    /,
    *,
    name: str | None = None,
    doc: str = "",
    rules: str = "relaxed",
    lanes: int = 1,
    **shapes: Shape | int,
) -> Function:
    """Calls `f` once with traced arrays and records what it computes.

    Args:
        f: Function of arrays, one for each of `shapes`, that returns an array, a number, or a tuple of them.
        name: Name for messages, IR and files; default `f.__name__`.
        doc: Text for the kernel's `__doc__`; default `f.__doc__`.
        rules: "relaxed" also uses simplifications that hold for finite numbers up to the sign of zero
            (x * 0 -> 0, x + 0 -> x, 0 - x -> -x, x - x -> 0); "exact" only those that hold bit for bit.
        lanes: A power of two above 1 makes a race: each sample is evaluated in so many lanes; see `ulna.trace.race`.
        **shapes: Shape of each argument in order, `q=(7,)`; `()` is a number.

    Raises:
        TraceError: If `f` branches on a traced value or returns something that is not numbers.
    """
    if rules not in ("relaxed", "exact"):
        raise ValueError(f"rules={rules!r}; expected 'relaxed' or 'exact'.")
    graph = Graph(relaxed=rules == "relaxed")
    ports, arguments = [], []
    for key, given in shapes.items():
        port = Port(key, _shape(key, given))
        ports.append(port)
        array = _object_array([Scalar(graph, graph.input()) for _ in range(port.size)]).reshape(port.shape)
        arguments.append(array if port.shape else array[()])
    with tracing(graph):
        try:
            returned = f(*arguments)
        except TraceError:
            raise
        except TypeError as error:
            if not re.search(r"Scalar|Condition|dtype\('O'\)|not supported for the input types", str(error)):
                raise
            raise TraceError(f"Traced values cannot do this: {error}. {_KNOWN}") from error
    single = not isinstance(returned, tuple)
    outputs, results = [], []
    for number, value in enumerate((returned,) if single else returned):
        array = np.asarray(value, dtype=object)
        if any(isinstance(element, np.ndarray) for element in array.reshape(-1)):
            raise TraceError(
                "The function returned a list of arrays of different shapes; return a tuple of them."
            )
        outputs.append(Port("out" if single else f"out{number}", array.shape))
        results.extend(number_in(graph, element) for element in array.reshape(-1))
    title = name or getattr(f, "__name__", "function").strip("<>")
    return Function(
        title,
        graph,
        tuple(ports),
        tuple(outputs),
        tuple(results),
        single,
        doc or (getattr(f, "__doc__", "") or ""),
        lanes,
    )


_KNOWN = (
    "They know + - * / // % **, comparisons, abs, np.sqrt, square, hypot, exp, log, floor, ceil, sin, cos, tan, "
    "arcsin, arccos, arctan, arctan2, and where, minimum, maximum, clip and loop of ulna.numeric; "
    "ulna.linalg solves small systems."
)


def _shape(name: str, given: Any) -> Shape:
    try:
        shape = tuple(map(operator.index, given if isinstance(given, (tuple, list)) else (given,)))
    except TypeError:
        shape = (-1,)
    if min(shape, default=0) < 0:
        raise InputError(
            f"{name}={given!r}: expected a shape, a whole number or a tuple of them, none negative."
        )
    return shape


def copy_into(target: Graph, source: Graph, nodes: Sequence[int], inputs: Sequence[int]) -> list[int]:
    """Rebuilds `nodes` of `source` in `target`, with the nodes `inputs` of `target` as its inputs."""
    where: dict[int, Any] = {}
    for index in source.live(nodes):
        op, args, data = source.op[index], source.args[index], source.data[index]
        if op == Op.INPUT:
            where[index] = inputs[data]
        elif op == Op.CONST:
            where[index] = target.constant(data)
        elif op == Op.BOOL:
            where[index] = target.truth(data)
        elif op == Op.LANE:
            where[index] = target.lane(data)
        elif op == Op.LOOP:
            where[index] = target.loop(data, [where[a] for a in args])
        elif op == Op.ITEM:
            where[index] = where[args[0]][data]
        else:
            where[index] = target.node(op, *(where[a] for a in args))
    return [where[n] for n in nodes]


def _replay_on_objects(function: Function, flat: Sequence[Any]) -> list[Any]:
    """Evaluates on symbols of another kind, such as SymPy's."""
    graph = function.graph
    values: dict[int, Any] = {}
    for index in graph.live(function.results):
        op, args, data = graph.op[index], graph.args[index], graph.data[index]
        if op in (Op.LOOP, Op.ITEM, Op.LANE):
            raise TraceError(
                f"{function.name} has a loop and cannot be replayed on {type(flat[0]).__name__}."
            )
        if op == Op.INPUT:
            values[index] = flat[data]
        else:
            values[index] = data if op in (Op.CONST, Op.BOOL) else _on_symbols(op, [values[a] for a in args])
    return [values[r] for r in function.results]


def _on_symbols(op: int, args: Sequence[Any]) -> Any:
    row = TABLE[op]
    assert row.numpy is not None
    if not is_symbolic(*args):
        return row.numpy(*args)
    if op in _PYTHON:
        return _PYTHON[op](*args)
    name = row.numpy.__name__
    if op != Op.EQ and hasattr(args[0], name):
        return getattr(args[0], name)(*args[1:])
    import sympy

    return getattr(sympy, _SYMPY.get(name, name))(*args)


_PYTHON: dict[int, Callable[..., Any]] = {
    Op.NEG: operator.neg,
    Op.ABS: abs,
    Op.ADD: operator.add,
    Op.SUB: operator.sub,
    Op.MUL: operator.mul,
    Op.DIV: operator.truediv,
    Op.LT: operator.lt,
    Op.LE: operator.le,
    Op.AND: operator.and_,
    Op.OR: operator.or_,
    Op.NOT: operator.invert,
    Op.MIN: numeric.minimum,
    Op.MAX: numeric.maximum,
    Op.SELECT: numeric.where,
}
_SYMPY = {"arcsin": "asin", "arccos": "acos", "arctan2": "atan2", "equal": "Eq"}


def _object_array(values: Sequence[Any]) -> Any:
    array = np.empty(len(values), dtype=object)
    array[:] = values
    return array


def _batch_of(array: Any, port: Port) -> Shape:
    core = len(port.shape)
    if array.ndim < core or array.shape[array.ndim - core :] != port.shape:
        raise ShapeError(port.name, array.shape, "(..., " + ", ".join(map(str, port.shape)) + ")")
    return array.shape[: array.ndim - core]


def _count(graph: Graph, nodes: Sequence[int]) -> Counter[str]:
    counts: Counter[str] = Counter()
    for index in graph.live(nodes):
        row = TABLE[graph.op[index]]
        if isinstance(graph.data[index], Loop):
            inner = graph.data[index]
            counts += _count(inner.graph, [inner.condition, *inner.following])
        elif row.cost:
            counts[row.op.name.lower()] += row.cost
    return counts
