"""Functions whose results are matrices, column after column by one body: all columns of a register at once.

A graph of a matrix has a node for each operation of each column. For one sample that is much straight-line code, and
fetching it takes longer than computing. Where all columns come from the same operations on other numbers, a function
can have a second form: a head, and a body that is evaluated for many columns, one in each SIMD lane. The graph remains
the definition of the function; batches, derivatives and other languages use it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import accumulate
from typing import Any, NamedTuple

import numpy as np

from ulna.compiler.language.function import ColumnForm, Function, trace
from ulna.compiler.language.graph import Graph
from ulna.compiler.language.ports import Port
from ulna.errors import TraceError
from ulna.system.cached import cached_property


class Columns(NamedTuple):
    """Matrices as a function of their columns.

    Attributes:
        table: The numbers that all columns share.
        matrices: One for each result, (n, m): its columns are passed to the body. A float stands for that multiple of
            the unit matrix.
        body: The column of a result, (n,), from the table, as an array, and a column of the matrix, (n,).
        rows: How many entries a column has, n.
        paths: Where the table is to be factored first. It has the rows of a symmetric matrix M = L^T diag(d) L then,
            where `row_places` says; the body gets the rows of L, whose diagonal it must not use, and then 1/d. Row k
            has entries in the columns of its path, in rising order, and on the diagonal, then zeros. The path of a
            column i of a path is that path's part before i. Empty for a table that the body gets as it is.
    """

    table: Sequence[Any]
    matrices: Sequence[Any]
    body: Callable[[Any, Any], Any]
    rows: int
    paths: Sequence[Sequence[int]] = ()


PADDING = 8
"""The rows of a matrix that is to be factored begin at multiples of this."""


def row_places(paths: Sequence[Sequence[int]]) -> tuple[list[int], int]:
    """Where the rows of a matrix that is to be factored begin in the table.

    Args:
        paths: For each row its columns before the diagonal.

    Returns:
        The place of the first entry of each row, and the size of all rows.
    """
    ends = list(accumulate((len(path) // PADDING + 1) * PADDING for path in paths))
    return [0, *ends[:-1]], ends[-1]


def with_columns(f: Function, form: Callable[..., Columns], **shapes: Any) -> Function:
    """The same function with a second form, in which single calls are compiled where registers are wide.

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
    forms: list[Columns] = []

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
    sizes = {port.shape for port in traced.outputs[1:]} or {(n, n)}
    (shape,) = sizes if len(sizes) == 1 else [()]
    if len(shape) != 2 or shape[0] != n or body.outputs[0].shape != (n,):
        raise TraceError(
            f"The matrices of {name!r} have the shapes {sorted(sizes)}; expected one shape ({n}, m)."
        )
    return ColumnForm(traced, body, units, shape, tuple(map(tuple, columns.paths)))


class DeferredFunction(Function):
    """A function that is known by its form of columns, and traced as a whole when its graph is first asked for.

    Args:
        name: As for `Function`.
        doc: As for `Function`.
        columns: Its form of columns.
        make: Traces it.
    """

    has_loops = False  # type: ignore[assignment]

    def __init__(self, name: str, doc: str, columns: ColumnForm, make: Callable[[], Function]) -> None:
        single = len(columns.units) == 1
        names = ["out"] if single else [f"out{k}" for k in range(len(columns.units))]
        outputs = tuple(Port(name, columns.shape) for name in names)
        self.__dict__.update(name=name, doc=doc, columns=columns, single=single, lanes=1)
        self.__dict__.update(inputs=columns.head.inputs, outputs=outputs, _make=make)

    def __reduce__(self) -> tuple[Any, ...]:
        f = self._traced
        fields = (f.name, f.graph, f.inputs, f.outputs, f.results, f.single, f.doc, f.lanes, self.columns)
        return Function, fields

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
