"""Traces a Python function of arrays into a `Function`: a graph with named, shaped inputs and outputs."""

from __future__ import annotations

import operator
import re
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import field
from math import prod
from typing import Any, Protocol

import numpy as np

from ulna.compiler.language.graph import Graph, Loop
from ulna.compiler.language.interpreter import copy_into, evaluate_symbols, interpret
from ulna.compiler.language.methods.derivatives import Differentiable
from ulna.compiler.language.methods.packing import Packable
from ulna.compiler.language.ops import TABLE, Op
from ulna.compiler.language.ports import Port, Shape
from ulna.compiler.language.scalar import Scalar, Value, index_in, innermost, number_in, tracing
from ulna.data_classes import dataclass
from ulna.errors import InputError, ShapeError, TraceError
from ulna.numeric import is_symbolic
from ulna.system.cached import cached_property


class SecondForm(Protocol):
    """Another way to compute a function: of columns, or in stages (`ulna.compiler.forms.stages`)."""

    @property
    def inputs(self) -> tuple[Port, ...]:
        """The inputs of the function."""
        ...

    @property
    def outputs(self) -> tuple[Port, ...]:
        """The outputs of the function."""
        ...

    @property
    def operations(self) -> int:
        """How many operations are written out."""
        ...

    @property
    def serves_batches(self) -> bool:
        """Whether samples of a batch are computed in this form, too, one by one."""
        ...


@dataclass(frozen=True, eq=False)
class Function(Differentiable, Packable):
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
    lanes: int = 1  # above 1, one sample is evaluated in so many SIMD lanes; see `ulna.compiler.forms.lanes`
    columns: SecondForm | None = field(default=None, repr=False)

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
                    f"{self.name} evaluates one sample in {self.lanes} lanes and takes numbers only, so it cannot be "
                    "part of a compiled function. Call it outside, and pass what it finds as an argument."
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
            return self._pack(
                evaluate_symbols(self.graph, flat, self.results), lambda part: np.array(part, dtype=object)
            )
        graph = innermost(*flat)
        nodes = copy_into(graph, self.graph, self.results, [index_in(graph, v) for v in flat])
        return self._pack([Scalar(graph, n) for n in nodes], _object_array)

    @cached_property
    def operation_counts(self) -> dict[str, int]:
        """How often each operation occurs; a loop's body counts once."""
        counts = _own_counts(self.graph, self.results)
        for loop in _loops(self.graph, self.results):
            counts += _own_counts(loop.graph, [loop.condition, *loop.following])
        return dict(sorted(counts.items()))

    @property
    def operations(self) -> int:
        """How many scalar operations one evaluation takes; a loop's body counts once."""
        return sum(self.operation_counts.values())

    @cached_property
    def has_loops(self) -> bool:
        """Whether the graph iterates."""
        return Op.LOOP in self.graph.op

    @cached_property
    def recorded_numbers(self) -> int:
        """How many numbers the records of its loops hold, on the stack while it runs."""
        return sum(x.limit * x.size for x in _loops(self.graph, self.results) if x.is_recorded)

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

    def draw(self, path: str | None = None) -> str:
        """The graph as an SVG picture, layered by depth; written to `path` when one is given."""
        from ulna.compiler.language.methods.drawing import draw  # with what it imports, for few

        title = f"{self.name}{self.signature}: {self.operations} operations"
        return draw(title, self.graph, self.inputs, self.outputs, self.results, path)


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
        lanes: A power of two; above 1 it evaluates each sample in so many SIMD lanes; see
            `ulna.compiler.forms.lanes`.
        **shapes: Shape of each argument in order, `q=(7,)`; `()` is a number.

    Returns:
        The traced function; calling it evaluates its graph.

    Raises:
        TraceError: If `f` branches on a traced value or returns something that is not numbers.
        InputError: If `rules` is neither "relaxed" nor "exact".
    """
    if rules not in ("relaxed", "exact"):
        raise InputError(f"rules={rules!r}; expected 'relaxed' or 'exact'.")
    graph = Graph(relaxed=rules == "relaxed", lanes=lanes)
    inputs = tuple(Port(key, _shape(key, shape)) for key, shape in shapes.items())
    arguments = [_traced_array(graph, port.shape) for port in inputs]
    with tracing(graph):
        returned = _returned(f, arguments)
    single = not isinstance(returned, tuple)
    arrays = [np.asarray(value, dtype=object) for value in ((returned,) if single else returned)]
    if any(isinstance(element, np.ndarray) for array in arrays for element in array.flat):
        raise TraceError(
            "The function returned a list of arrays of different shapes; return a tuple of them."
        )
    outputs = tuple(Port("out" if single else f"out{k}", array.shape) for k, array in enumerate(arrays))
    results = tuple(number_in(graph, element) for array in arrays for element in array.flat)
    title = name or getattr(f, "__name__", "function").strip("<>")
    doc = doc or getattr(f, "__doc__", "") or ""
    return Function(title, graph, inputs, outputs, results, single, doc, lanes)


def _traced_array(graph: Graph, shape: Shape) -> Any:
    """An array of new inputs of the graph; without axes a single one."""
    return _object_array([Scalar(graph, graph.input()) for _ in range(prod(shape))]).reshape(shape)[()]


def _returned(f: Callable[..., Any], arguments: Sequence[Any]) -> Any:
    """What `f` returns for traced arguments."""
    try:
        return f(*arguments)
    except TraceError:
        raise
    except (TypeError, AttributeError) as error:
        if not re.search(r"Scalar|Condition|dtype\('O'\)|not supported for the input types", str(error)):
            raise
        raise TraceError(f"Traced values cannot do this: {error}. {_KNOWN}") from error


_KNOWN = (
    f"They know + - * / // % **, comparisons, abs, np.{', '.join(n for n in vars(Scalar) if n[0] != '_')}, "
    "and where, minimum, maximum, clip and loop of ulna.numeric; ulna.linalg solves small systems."
)


def _shape(name: str, value: Any) -> Shape:
    try:
        shape = tuple(map(operator.index, value if isinstance(value, (tuple, list)) else (value,)))
    except TypeError:
        shape = (-1,)
    if min(shape, default=0) < 0:
        raise InputError(
            f"{name}={value!r}: expected a shape, a whole number or a tuple of them, none negative."
        )
    return shape


def _object_array(values: Sequence[Any]) -> Any:
    array = np.empty(len(values), dtype=object)
    array[:] = values
    return array


def _batch_of(array: Any, port: Port) -> Shape:
    core = len(port.shape)
    if array.ndim < core or array.shape[array.ndim - core :] != port.shape:
        raise ShapeError(port.name, array.shape, "(..., " + ", ".join(map(str, port.shape)) + ")")
    return array.shape[: array.ndim - core]


def _own_counts(graph: Graph, nodes: Sequence[int]) -> Counter[str]:
    """How often each operation occurs in a graph, without the bodies of its loops."""
    counts = Counter(map(graph.op.__getitem__, graph.live(nodes)))
    return Counter(
        {TABLE[op].op.name.lower(): n * TABLE[op].cost for op, n in counts.items() if TABLE[op].cost}
    )


def _loops(graph: Graph, nodes: Sequence[int]) -> Iterator[Loop]:
    """The loops that nodes depend on, and those within them."""
    for data in (graph.data[index] for index in graph.live(nodes)):
        if isinstance(data, Loop):
            yield data
            yield from _loops(data.graph, [data.condition, *data.following])
