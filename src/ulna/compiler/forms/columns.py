"""Functions that return matrices whose columns are computed by one shared body, a SIMD register of columns at a time.

A graph of a matrix has a node for each operation of each column. For one sample that is much straight-line code, and
fetching it takes longer than computing. Where all columns come from the same operations on other numbers, a function
can have a second form: a head, and a body that is evaluated for many columns, one in each SIMD lane. The graph remains
the definition of the function; batches, derivatives and other languages use it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from itertools import accumulate
from typing import Any, NamedTuple

import numpy as np

from ulna.compiler.forms.packed import packed_form
from ulna.compiler.forms.stages import StagedForm
from ulna.compiler.language.function import Function, trace
from ulna.compiler.language.graph import Graph
from ulna.compiler.language.ops import Op
from ulna.compiler.language.ports import Entries, Port, SecondForm
from ulna.data_classes import dataclass
from ulna.errors import TraceError
from ulna.system.cached import cached_property


class Columns(NamedTuple):
    """Matrices as a function of their columns.

    Attributes:
        table: The numbers that all columns share.
        matrices: One for each result, (n, m): its columns are passed to the body. A float stands for that multiple of
            the unit matrix, with rows of zeros below it where n > m.
        body: The column of a result, (k,), from the table, as an array, and a column of the matrix, (n,).
        rows: How many entries a column has, n.
        paths: Empty, or the sparsity of a symmetric matrix M whose rows the table holds (offsets: `row_places`). M is
            then factored as L^T diag(d) L before the body runs; the body receives the rows of L (diagonal entries
            undefined), followed by 1/d. Row k has its entries in the columns of path k, in rising order, then the
            diagonal, then zeros. For a column i of a path, path i is the part of that path before i.
        serves_batches: Whether batches are computed in this form as well, one sample after the other: for functions
            whose graph is so long that SIMD lanes of samples are no faster.
        inverts: Whether the results of multiples of the unit matrix are symmetric, as inverses of symmetric matrices.
    """

    table: Sequence[Any]
    matrices: Sequence[Any]
    body: Callable[[Any, Any], Any]
    rows: int
    paths: Sequence[Sequence[int]] = ()
    serves_batches: bool = False
    inverts: bool = False


@dataclass(frozen=True, eq=False)
class ColumnForm:
    """A second form of a function whose outputs are matrices of one shape.

    Attributes:
        head: Function of the same inputs: the table, then the matrices whose columns the body takes.
        body: A column of an output from the table and a column of its matrix.
        units: For each output the multiple of the unit matrix that stands for its matrix; None for one of the head's.
        shape: That of the outputs.
        paths: The columns of the rows before the diagonal, where the table is to be factored before the body gets it.
        serves_batches: Whether samples of a batch are computed in this form, too, one by one.
        inverts: Whether the outputs of multiples of the unit matrix are symmetric.
    """

    head: Function | SecondForm
    body: Function
    units: tuple[float | None, ...]
    shape: tuple[int, ...]
    paths: tuple[tuple[int, ...], ...] = ()
    serves_batches: bool = False
    inverts: bool = False

    @property
    def operations(self) -> int:
        """How many operations of the head are written out."""
        return self.head.operations

    @property
    def inputs(self) -> tuple[Port, ...]:
        """The inputs of the function."""
        return self.head.inputs

    @property
    def outputs(self) -> tuple[Port, ...]:
        """The outputs of the function."""
        names = ["out"] if len(self.units) == 1 else [f"out{k}" for k in range(len(self.units))]
        return tuple(Port(name, self.shape) for name in names)

    @property
    def entries(self) -> tuple[Entries, ...]:
        """What is known of each output."""
        return tuple(
            Entries(_set_entries(self.body, np.array(zeros).T), self.inverts and unit is not None)
            for unit, zeros in zip(self.units, zeros_of(self), strict=True)
        )


def zeros_of(form: ColumnForm) -> list[list[list[bool]]]:
    """For each matrix, column and row whether the entry that the body takes is zero whatever the inputs.

    Args:
        form: The form.

    Returns:
        The answers.
    """
    m, n = form.shape[1], form.body.inputs[1].size
    head, zeros = form.head, []
    given: Any = head.zeros[1:] if isinstance(head, StagedForm) else _zeros_of_graph(head, n, m)
    matrices = iter(given)
    for unit in form.units:
        of_unit = ~np.eye(n, m, dtype=bool)
        zeros.append((of_unit if unit is not None else next(matrices)).T.tolist())
    return zeros


def _zeros_of_graph(head: Any, n: int, m: int) -> list[Any]:
    """Which entries of each matrix of a head are constants that are zero, (n, m)."""
    g, start = head.graph, head.outputs[0].size
    nodes = head.results[start:]
    is_zero = np.array([g.op[node] == Op.CONST and g.data[node] == 0.0 for node in nodes], dtype=bool)
    return list(is_zero.reshape(-1, n, m))


def _set_entries(body: Function, zeros: Any) -> Any:
    """Which entries of the columns that a body returns are not always zero, (k, m), for columns (n, m) with zeros."""
    g, size = body.graph, body.inputs[0].size
    some = np.zeros(zeros.shape[1], dtype=bool)
    known = dict(zip(g.inputs, [some] * size + list(zeros), strict=True))
    for index in g.live(body.results):
        op, args = g.op[index], g.args[index]
        if op == Op.CONST:
            known[index] = ~some if g.data[index] == 0.0 else some
        elif op == Op.MUL:
            known[index] = known[args[0]] | known[args[1]]
        elif op in (Op.ADD, Op.SUB):
            known[index] = known[args[0]] & known[args[1]]
        elif op in (Op.NEG, Op.DIV):
            known[index] = known[args[0]]
        elif op != Op.INPUT:
            known[index] = some
    return ~np.array([known[index] for index in body.results])


PADDING = 8
"""The rows of a matrix that is to be factored begin at multiples of this."""


def row_places(paths: Sequence[Sequence[int]]) -> tuple[list[int], int]:
    """The offsets of the rows of a matrix that is to be factored in the table.

    Args:
        paths: For each row its columns before the diagonal.

    Returns:
        The offset of the first entry of each row, and the size of all rows.
    """
    ends = list(accumulate((len(path) // PADDING + 1) * PADDING for path in paths))
    return [0, *ends[:-1]], ends[-1]


def with_columns(f: Function, form: Callable[..., Columns], **shapes: Any) -> Function:
    """The same function with a second form, which is used for speed; the graph remains the definition.

    Single calls use it on processors with registers of 256 bits or more, where a matrix has at least as many columns as
    a register has lanes and the matrices fit on the stack. Batches use the graph unless the form has `serves_batches`.

    Args:
        f: The function; its outputs are matrices of one shape.
        form: Function of the same arrays that returns these matrices as a function of their columns.
        **shapes: Shape of each argument, as for `trace`.

    Returns:
        The function with its second form.

    Raises:
        TraceError: The form has other outputs than the function.
    """
    columns = column_form(form, f.name, **shapes)
    shape = f.outputs[0].shape
    alike = all(port.shape == shape for port in f.outputs) and columns.shape == shape
    if len(columns.units) != len(f.outputs) or not alike:
        raise TraceError(
            f"The columns of {f.name!r} are not those of its {len(f.outputs)} outputs; expected {len(f.outputs)} "
            f"matrices of the shape {shape}."
        )
    return replace(f, columns=columns)


def column_form(form: Callable[..., Columns], name: str, **shapes: Any) -> ColumnForm:
    """Traces the head and the body of a form.

    Args:
        form: Function of arrays that returns matrices as a function of their columns.
        name: The name of the function that the form belongs to.
        **shapes: Shape of each argument, as for `trace`.

    Returns:
        The form.

    Raises:
        TraceError: The matrices are not alike.
    """
    forms: list[Columns] = []  # the form, which `head` leaves here while it is traced

    def head(*arrays: Any) -> tuple[Any, ...]:
        forms.append(form(*arrays))
        table, matrices, *_ = forms[-1]
        return np.array(table, dtype=object), *(x for x in matrices if not isinstance(x, float))

    traced = trace(head, name=f"{name}_head", **shapes)
    columns = forms[0]
    n = columns.rows
    size = len(columns.table) + len(columns.paths)
    body = trace(columns.body, name=f"{name}_column", table=(size,), column=(n,))
    units = tuple(x if isinstance(x, float) else None for x in columns.matrices)
    shapes_of_matrices = {port.shape for port in traced.outputs[1:]} or {(n, n)}
    (shape,) = shapes_of_matrices if len(shapes_of_matrices) == 1 else [()]
    if len(shape) != 2 or shape[0] != n or len(body.outputs[0].shape) != 1:
        raise TraceError(
            f"The matrices of {name!r} have the shapes {sorted(shapes_of_matrices)}; expected one shape ({n}, m)."
        )
    results = (*body.outputs[0].shape, shape[1])
    paths = tuple(map(tuple, columns.paths))
    return ColumnForm(traced, body, units, results, paths, columns.serves_batches, columns.inverts)


class DeferredFunction(Function):
    """A function that is known by its form of columns, and traced as a whole when its graph is first asked for.

    Args:
        name: As for `Function`.
        doc: As for `Function`.
        columns: Its form of columns or of stages.
        make: Traces it.
    """

    def __init__(self, name: str, doc: str, columns: SecondForm, make: Callable[[], Function]) -> None:
        outputs = columns.outputs
        self.__dict__.update(name=name, doc=doc, columns=columns, single=len(outputs) == 1, lanes=1)
        self.__dict__.update(inputs=columns.inputs, outputs=outputs, _make=make)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.name, self.doc, self.columns, self.__dict__["_make"])

    def packed(self, zeros: bool = False) -> Any:
        """The same function with its matrices packed; see `Packable.packed`. The graph is not traced for it.

        Args:
            zeros: Whether entries that are always zero are stored, too.

        Returns:
            The function.

        Raises:
            InputError: If no output is a matrix.
        """
        assert self.columns is not None
        patterns = self._patterns(zeros)
        make = partial(_packed_graph, self, patterns)
        return DeferredFunction(f"{self.name}_packed", "", packed_form(self.columns, patterns), make)

    def _derived(self, *arguments: Any) -> Any:
        return self._traced._derived(*arguments)

    @property
    def untraced_operations(self) -> int | None:
        """How many operations its second form has, until the graph is traced."""
        return None if "_traced" in self.__dict__ or self.columns is None else self.columns.operations

    @property
    def graph(self) -> Graph:  # type: ignore[override]
        """The graph of the function."""
        return self._traced.graph

    @property
    def results(self) -> tuple[int, ...]:  # type: ignore[override]
        """The nodes of all outputs."""
        return self._traced.results

    @cached_property
    def _traced(self) -> Function:
        return self.__dict__["_make"]()


def _packed_graph(f: DeferredFunction, patterns: Any) -> Function:
    """The graph of a function with its matrices packed."""
    return f._traced._packed_as(patterns)
