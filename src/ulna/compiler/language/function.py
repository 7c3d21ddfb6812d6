"""Traces a Python function of arrays into a `Function`: a graph with named, shaped inputs and outputs."""

from __future__ import annotations

import operator
import re
from collections.abc import Callable, Sequence
from dataclasses import field
from math import prod
from typing import Any

import numpy as np

from ulna.checks.arrays import batched_shape, real_array
from ulna.checks.values import count
from ulna.compiler.language.graph import Graph
from ulna.compiler.language.interpreter import copy_into, interpret
from ulna.compiler.language.methods.counting import Countable
from ulna.compiler.language.methods.derivatives import Differentiable
from ulna.compiler.language.methods.fingerprints import fingerprint
from ulna.compiler.language.methods.packing import Packable
from ulna.compiler.language.ports import Port, SecondForm, Shape, batch_shape, wrong_count
from ulna.compiler.language.scalar import Scalar, Value, index_in, innermost, number_in, tracing
from ulna.data_classes import dataclass
from ulna.errors import InputError, ShapeError, TraceError
from ulna.numeric import is_symbolic
from ulna.numeric.arrays import object_vector
from ulna.system.cached import cached_property


@dataclass(frozen=True, eq=False)
class Function(Countable, Differentiable, Packable):
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
            raise wrong_count(self.name, [p.name for p in self.inputs], args)
        arrays = [
            real_array(p.name, a, shape=batched_shape(p.shape), is_symbol=is_symbolic)
            for p, a in zip(self.inputs, args, strict=True)
        ]
        if any(a.dtype == object for a in arrays):
            if self.lanes > 1:
                raise TraceError(
                    f"{self.name} evaluates one sample in {self.lanes} lanes and takes numbers only, so it cannot be "
                    "part of a compiled function. Call it outside, and pass what it finds as an argument."
                )
            return self._inline(arrays)
        batch = batch_shape(self.inputs, [a.shape for a in arrays])
        flat: list[Any] = []
        for a, port in zip(arrays, self.inputs, strict=True):
            rows = np.broadcast_to(a, batch + port.shape).reshape(*batch, port.size)
            flat.extend(rows[..., k] for k in range(port.size))
        if self.lanes == 1:
            values = interpret(self.graph, flat, self.results)
        else:  # the lanes are one more axis, and all hold the same results
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

    def _inline(self, arrays: Sequence[Any]) -> Any:
        flat: list[Any] = []
        for array, port in zip(arrays, self.inputs, strict=True):
            if array.shape != port.shape:
                raise ShapeError(
                    port.name, array.shape, str(port.shape), "A traced call takes one sample, no batch."
                )
            flat.extend(array.reshape(-1))
        if not any(isinstance(v, Value) for v in flat):  # symbols of another kind
            from ulna.compiler.language.methods.symbols import evaluate_symbols  # for few

            return self._pack(
                evaluate_symbols(self.graph, flat, self.results), lambda part: np.array(part, dtype=object)
            )
        graph = innermost(*flat)
        nodes = copy_into(graph, self.graph, self.results, [index_in(graph, v) for v in flat])
        return self._pack([Scalar(graph, n) for n in nodes], object_vector)

    @property
    def signature(self) -> str:
        """The signature as NumPy writes a generalised ufunc's, with frozen sizes: "(7)->(4,4)"."""

        def side(ports: Sequence[Port]) -> str:
            return ",".join("(" + ",".join(map(str, p.shape)) + ")" for p in ports)

        return f"{side(self.inputs)}->{side(self.outputs)}"

    @cached_property
    def fingerprint(self) -> str:
        """A hash of what is computed, the same in every process."""
        return fingerprint(self.graph, self.results)

    def draw(self, path: str | None = None) -> str:
        """The graph as an SVG picture, layered by depth; written to `path` when one is given."""
        from ulna.compiler.language.methods.drawing import draw  # rarely needed

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
        InputError: If `rules` is neither "relaxed" nor "exact", or `lanes` no power of two.
    """
    if rules not in ("relaxed", "exact"):
        raise InputError(f"rules={rules!r}; expected 'relaxed' or 'exact'.")
    if count("lanes", lanes) & (lanes - 1):
        raise InputError(f"`lanes` is {lanes}; expected a power of two.")
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
    return object_vector([Scalar(graph, graph.input()) for _ in range(prod(shape))]).reshape(shape)[()]


def _returned(f: Callable[..., Any], arguments: Sequence[Any]) -> Any:
    """What `f` returns for traced arguments."""
    try:
        return f(*arguments)
    except (TypeError, AttributeError) as error:
        if isinstance(error, TraceError) or not re.search(_OF_TRACED_VALUES, str(error)):
            raise
        raise TraceError(f"Traced values cannot do this: {error}. {_KNOWN}") from error


_OF_TRACED_VALUES = r"Scalar|Condition|dtype\('O'\)|for the input types|to Python scalars|'arctan2'|'hypot'"
_METHODS = [name for name in vars(Scalar) if name[0] != "_"]
_KNOWN = (
    f"They know + - * / // % **, comparisons, abs, np.{', '.join(n for n in _METHODS if hasattr(np, n))}, "
    f"and {', '.join(n for n in _METHODS if not hasattr(np, n))}, where, minimum, maximum, clip and loop of "
    "ulna.numeric; ulna.linalg solves small systems. np.hypot takes traced values first, numeric.arctan2 any."
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
