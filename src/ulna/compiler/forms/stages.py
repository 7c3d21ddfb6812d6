"""Functions computed in stages: straight-line code where a tree is walked, SIMD lanes of columns everywhere else.

A graph of a robot's derivatives has a node for each operation of each joint, and for each pair of joints. One sample
runs through it once, and fetching so much code takes longer than computing. Most of it is the same operations on the
numbers of other joints. A `StagedForm` keeps these numbers in tables with one column for each velocity of the robot,
and computes a table from others

- by straight-line code, where numbers of different columns meet (`straight`), or for one row after the other (`rows`),
- for a SIMD register of columns at a time (`lanes`), where tables may have other columns, such as one for each
  constraint,
- or, for matrices, for pairs of a row and a register of columns (`pairs`, `products`).

The graph remains the definition of the function; batches, derivatives and other languages use it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import field, replace
from itertools import accumulate
from typing import Any, Literal, NamedTuple

import numpy as np

from ulna.compiler.forms.scans import Scan, Walk, traced_pass
from ulna.compiler.language.function import Function, trace
from ulna.compiler.language.ports import Entries, Port
from ulna.data_classes import dataclass
from ulna.errors import TraceError


@dataclass(frozen=True, eq=False)
class Stage:
    """One step of a form.

    Attributes:
        kind: How `body` is evaluated: once ("straight"), for each row ("rows"), or for each column ("lanes").
        body: Arrays to arrays. An array is one row of a table, one column in lanes, or the whole table.
        reads: Names of the tables or inputs that it takes.
        writes: Names of the tables or outputs that it computes.
        columns: How many columns there are.
        whole: Names of the tables of which a column gets the whole.
    """

    kind: Literal["straight", "rows", "lanes"]
    body: Function
    reads: tuple[str, ...]
    writes: tuple[str, ...]
    columns: int
    whole: frozenset[str] = frozenset()


@dataclass(frozen=True, eq=False)
class Pairs:
    """Square matrices, whose entries come from pairs of columns of the tables.

    Attributes:
        below: Entries (i, j) where column i moves column j, or belongs to its joint: from column i of some tables and
            column j of others.
        above: The same where column j moves column i.
        own: Names of the tables of i, for `below` and `above`.
        other: Names of the tables of j, for `below` and `above`.
        movers: For each column those columns of other joints that move it.
        joints: For each column the number of its joint.
        diagonals: For each matrix what is added to its diagonal, or None.
        copies: The rows that are rows of the last tables of `other` for `below`, one table for each matrix.
        writes: Names of the matrices.
        is_half: Whether only entries `above` and those of one joint are computed, and others left as they are: what is
            read of a symmetric matrix that is to be factored.
    """

    below: Function
    above: Function
    own: tuple[tuple[str, ...], tuple[str, ...]]
    other: tuple[tuple[str, ...], tuple[str, ...]]
    movers: tuple[frozenset[int], ...]
    joints: tuple[int, ...]
    diagonals: tuple[tuple[float, ...] | None, ...]
    copies: Mapping[int, int]
    writes: tuple[str, ...]
    is_half: bool = False

    def masks(self, i: int) -> tuple[list[bool], list[bool]]:
        """In which columns row i has entries of `below`, and of `above`."""
        n = len(self.joints)
        moves = [not self.is_half and i in self.movers[j] for j in range(n)]
        below = [moves[j] or self.joints[i] == self.joints[j] for j in range(n)]
        return below, [j in self.movers[i] for j in range(n)]


@dataclass(frozen=True, eq=False)
class Products:
    """A matrix of any width, whose entries come from a column of some tables for its row, and one of others.

    Attributes:
        body: Entry (i, j) from column i of some tables and column j of others.
        own: Names of the tables of i.
        other: Names of the tables of j.
        pattern: Which entries there are, (rows, columns); the others are zero.
        write: The name of the matrix, an output.
    """

    body: Function
    own: tuple[str, ...]
    other: tuple[str, ...]
    pattern: Any
    write: str

    @property
    def writes(self) -> tuple[str, ...]:
        """The name of the matrix."""
        return (self.write,)


@dataclass(frozen=True, eq=False)
class Factors:
    """The factors L^T diag(d) L of a symmetric matrix; see `ulna.compiler.forms.columns`.

    Attributes:
        paths: For each row the columns before the diagonal.
        reads: The name of the rows; they are overwritten.
        writes: The name of the rows of L, followed by 1/d.
    """

    paths: tuple[tuple[int, ...], ...]
    reads: str
    writes: str


@dataclass(frozen=True, eq=False)
class Pass:
    """A walk along all columns, which hands numbers on from one column to the next.

    Attributes:
        body: From `state`, which is zero at first, a column of each table, and, where a matrix is written, the `entry`
            of row and column and how far the row is `ahead` of the column, to the next state, and what is written.
        own: The tables of which it takes a column.
        writes: The tables of which it computes a column; none where entries of a matrix are written.
        is_inward: Whether it begins with the last column.
        is_triangular: Whether it begins, for a register of a matrix's columns, with the first of them.
    """

    body: Function
    own: tuple[str, ...]
    writes: tuple[str, ...] = ()
    is_inward: bool = False
    is_triangular: bool = False


@dataclass(frozen=True, eq=False)
class Sweep:
    """Walks along all columns, one after the other, for a few numbers, or for all columns of a matrix.

    Attributes:
        passes: The walks; of a matrix, each gets the entries that the one before has computed.
        source: The matrix that the first one reads, or "".
        matrix: The matrix whose rows are written, or "".
        is_symmetric: Whether what is below the diagonal is then copied above it.
    """

    passes: tuple[Pass, ...]
    source: str = ""
    matrix: str = ""
    is_symmetric: bool = False

    @property
    def writes(self) -> tuple[str, ...]:
        """Names of what it computes."""
        tables = tuple(name for step in self.passes for name in step.writes)
        return (*tables, self.matrix) if self.matrix else tables


AnyStage = Stage | Pairs | Products | Factors | Sweep | Scan


class Part(NamedTuple):
    """Where an array lies that is a part of an output.

    Attributes:
        output: The output.
        start: The place in it where the array begins.
        shape: The shape of the array.
        row_length: How far its rows lie apart.
    """

    output: str
    start: int
    shape: tuple[int, ...]
    row_length: int


@dataclass(frozen=True)
class Beside:
    """Matrices that are one output, side by side.

    Attributes:
        names: Names of the matrices, which have equally many rows.
    """

    names: tuple[str, ...]


def names_of(stage: AnyStage) -> list[str]:
    """The names of all arrays that a stage reads or writes."""
    if isinstance(stage, Factors):
        return [stage.reads, stage.writes]
    if isinstance(stage, Stage):
        return [*stage.reads, *stage.writes]
    if isinstance(stage, Sweep):
        own = [name for step in stage.passes for name in step.own]
        return [*own, *([stage.source] if stage.source else ()), *stage.writes]
    if isinstance(stage, Products):
        return [*stage.own, *stage.other, stage.write]
    if isinstance(stage, Scan):
        return [*(name for name, _ in stage.vectors), *stage.writes]
    return [name for names in (*stage.own, *stage.other, stage.writes) for name in names]


@dataclass(frozen=True, eq=False)
class StagedForm:
    """A function in stages; made by `Stages`.

    Attributes:
        inputs: Its inputs.
        outputs: Its outputs.
        columns: How many columns most tables have.
        arrays: Names and shapes of the arrays that stages hand on.
        tables: Names of those that are read and written by registers of columns.
        constants: Tables that are known, (rows, columns).
        stages: The steps in order; inputs are called i0, i1, ..., outputs o0, o1, ...
        zeros: For each output which entries are zero whatever the inputs, or None.
        serves_batches: Whether samples of a batch are computed in this form, too, one in each SIMD lane; where outputs
            have parts, one after the other.
        parts: Those arrays that are parts of outputs.
        symmetric: The numbers of the outputs that are symmetric matrices.
    """

    inputs: tuple[Port, ...]
    outputs: tuple[Port, ...]
    columns: int
    arrays: Mapping[str, tuple[int, ...]]
    tables: frozenset[str]
    constants: Mapping[str, Any]
    stages: tuple[AnyStage, ...]
    zeros: tuple[Any, ...]
    serves_batches: bool = field(default=False)
    parts: Mapping[str, Part] = field(default_factory=dict)
    symmetric: frozenset[int] = frozenset()

    @property
    def operations(self) -> int:
        """How many operations are written out, each for one column or one register of columns."""
        bodies: list[Function] = []
        for stage in self.stages:
            if isinstance(stage, Stage | Products):
                bodies.append(stage.body)
            elif isinstance(stage, Pairs):
                bodies += [stage.below, stage.above]
            elif isinstance(stage, Sweep):
                bodies += [step.body for step in stage.passes]
            elif isinstance(stage, Scan):
                bodies += stage.bodies
        return sum(f.operations for f in bodies)

    @property
    def entries(self) -> tuple[Entries | None, ...]:
        """What is known of each output that is a matrix; None for the others."""
        known: list[Entries | None] = []
        for k, (port, zeros) in enumerate(zip(self.outputs, self.zeros, strict=True)):
            is_set = np.full(port.shape, True) if zeros is None else ~zeros
            known.append(Entries(is_set, k in self.symmetric) if len(port.shape) == 2 else None)
        return tuple(known)


PairFunction = tuple[Callable[..., Any], Sequence[str], Sequence[str]]
"""A function, the names of the tables of which it takes a row's own column, and of those of which it takes others."""


class Stages:
    """Makes a form, stage by stage, by tracing functions.

    Args:
        name: The name of the function.
        columns: How many columns the tables have, where nothing else is said.
        **inputs: The shape of each input of the function.
    """

    def __init__(self, name: str, columns: int, **inputs: Sequence[int]) -> None:
        self.name, self.columns = name, columns
        self._inputs = {key: tuple(shape) for key, shape in inputs.items()}
        self._arrays: dict[str, tuple[int, ...]] = {}
        self._tables: set[str] = set()
        self._constants: dict[str, Any] = {}
        self._stages: list[AnyStage] = []

    def constant(self, name: str, rows: Any) -> None:
        """A table of numbers.

        Args:
            name: Its name.
            rows: Shape (rows, columns).
        """
        self._constants[name] = np.asarray(rows, dtype=float)

    def straight(self, f: Callable[..., Any], reads: Sequence[str], writes: Sequence[str]) -> None:
        """A stage of straight-line code.

        Args:
            f: From whole arrays and inputs to as many arrays as are written; those of shape (rows, columns) are
                tables.
            reads: Names of arrays and inputs.
            writes: Names of the results. A table may be one that is read, of which an entry is then read only for what
                takes its place.
        """
        body = self._traced(f, {name: self._shape(name) for name in reads})
        for name, port in zip(writes, body.outputs, strict=True):
            self._declare(name, port.shape, is_table=len(port.shape) == 2)
        self._stages.append(Stage("straight", body, tuple(reads), tuple(writes), self.columns))

    def rows(self, f: Callable[..., Any], reads: Sequence[str], write: str) -> None:
        """A stage of straight-line code that computes all rows alike.

        Args:
            f: From one row of each table, (columns,), to a row of the result, with any number of columns.
            reads: Names of tables of equally many rows.
            write: The name of the result, a table. It may be one that is read, of which an entry is then read only for
                what takes its place.
        """
        body = self._traced(f, {name: self._shape(name)[1:] for name in reads})
        self._declare(write, (self._shape(reads[0])[0], *body.outputs[0].shape))
        self._stages.append(Stage("rows", body, tuple(reads), (write,), self.columns))

    def lanes(
        self,
        f: Callable[..., Any],
        reads: Sequence[str],
        writes: Sequence[str],
        columns: int | None = None,
        whole: Sequence[str] = (),
    ) -> None:
        """A stage that computes all columns alike.

        Args:
            f: From one column of each table, (rows,), to one column of as many tables as are written.
            reads: Names of tables, and of vectors, of which every column gets the whole.
            writes: Names of tables.
            columns: How many columns there are; None for as many as most tables have.
            whole: Names of those of the tables it reads of which every column gets the whole, (rows, columns).
        """
        count = self.columns if columns is None else columns
        shapes = {name: self._shape(name) for name in reads}
        body = self._traced(f, {name: x if name in whole else x[:1] for name, x in shapes.items()})
        for name, port in zip(writes, body.outputs, strict=True):
            self._declare(name, (port.size, count))
        self._stages.append(Stage("lanes", body, tuple(reads), tuple(writes), count, frozenset(whole)))

    def pairs(
        self,
        below: PairFunction,
        above: PairFunction,
        movers: Sequence[Sequence[int]],
        joints: Sequence[int],
        writes: Mapping[str, Sequence[float] | None],
        copies: Mapping[int, int] | None = None,
        is_half: bool = False,
    ) -> None:
        """The stage that computes square matrices; see `Pairs`.

        Args:
            below: As for `Pairs`, with the names of both kinds of tables.
            above: The same.
            movers: As for `Pairs`.
            joints: As for `Pairs`.
            writes: Names of the matrices, and what is added to their diagonals.
            copies: As for `Pairs`.
            is_half: As for `Pairs`.

        Raises:
            TraceError: The functions return other numbers of entries than there are matrices.
        """
        bodies = []
        for f, own, other in (below, above):
            shapes = {f"own_{name}": self._shape(name)[:1] for name in own}
            shapes |= {name: self._shape(name)[:1] for name in other}
            bodies.append(self._traced(f, shapes))
        if any(len(body.results) != len(writes) for body in bodies):
            raise TraceError(f"The pairs of {self.name!r} return other numbers than those of {list(writes)}.")
        self._arrays |= dict.fromkeys(writes, (self.columns, self.columns))
        diagonals = tuple(None if row is None else tuple(map(float, row)) for row in writes.values())
        self._stages.append(
            Pairs(
                below=bodies[0],
                above=bodies[1],
                own=(tuple(below[1]), tuple(above[1])),
                other=(tuple(below[2]), tuple(above[2])),
                movers=tuple(map(frozenset, movers)),
                joints=tuple(joints),
                diagonals=diagonals,
                copies=dict(copies or {}),
                writes=tuple(writes),
                is_half=is_half,
            )
        )

    def products(
        self, f: Callable[..., Any], own: Sequence[str], other: Sequence[str], pattern: Any, write: str
    ) -> None:
        """The stage that computes a matrix that need not be square; see `Products`.

        Args:
            f: From a column of each table, first those of the row, to a number.
            own: As for `Products`.
            other: As for `Products`.
            pattern: As for `Products`.
            write: The name of the matrix.
        """
        shapes = {f"own_{name}": self._shape(name)[:1] for name in own}
        body = self._traced(f, shapes | {name: self._shape(name)[:1] for name in other})
        is_set = np.array(pattern, dtype=bool)
        self._arrays[write] = is_set.shape
        self._stages.append(Products(body, tuple(own), tuple(other), is_set, write))

    def walk(
        self,
        f: Callable[..., Any],
        state: int,
        own: Sequence[str],
        writes: Sequence[str],
        is_inward: bool = False,
    ) -> None:
        """A stage that walks along the columns with a few numbers.

        Args:
            f: From the state, (state,), and a column of each table to the next state and a column of each result.
            state: How many numbers are handed on; they are zero at first.
            own: Names of the tables that are read.
            writes: Names of the tables that are computed.
            is_inward: Whether the last column comes first.
        """
        shapes = {"state": (state,), **{name: self._shape(name)[:1] for name in own}}
        body = self._traced(f, shapes)
        for name, port in zip(writes, body.outputs[1:], strict=True):
            self._declare(name, (port.size, self.columns))
        self._stages.append(Sweep((Pass(body, tuple(own), tuple(writes), is_inward),)))

    def sweep(
        self,
        passes: Sequence[tuple[Callable[..., Any], Sequence[str], bool]],
        state: int,
        matrix: str,
        source: str = "",
    ) -> None:
        """A stage that walks along the columns for all columns of a matrix, whose rows it computes.

        Without a source, the matrix is symmetric, and only what is below its diagonal is computed.

        Args:
            passes: For each walk its function, the names of the tables that are read, and whether the last column
                comes first. The function takes the state, a column of each table, and the entry of the source or of
                the walk before, without a source how far the row is ahead of the column. It returns the next state
                and the entry.
            state: How many numbers are handed on.
            matrix: The name of the matrix.
            source: The name of the matrix that is read.
        """
        made = []
        for f, own, is_inward in passes:
            shapes = {"state": (state,), **{name: self._shape(name)[:1] for name in own}}
            body = self._traced(f, {**shapes, "entry" if source else "ahead": (1,)})
            made.append(Pass(body, tuple(own), (), is_inward, not source))
        self._arrays[matrix] = (self.columns, self.columns)
        self._stages.append(Sweep(tuple(made), source, matrix, not source))

    def scan(
        self,
        walks: Sequence[Walk],
        known: Mapping[str, Any],
        padding: Mapping[str, Sequence[float]],
        vectors: Mapping[str, int],
        tables: Sequence[str] = (),
        flat: Sequence[str] = (),
    ) -> None:
        """A stage of walks along the segments of a chain; see `ulna.compiler.forms.scans`.

        Args:
            walks: The walks in order.
            known: What is known of columns: names of tables, (rows, columns).
            padding: As for `Scan`; zeros where a table is not listed.
            vectors: As for `Scan`.
            tables: Names of the tables that are handed on.
            flat: Names of vectors that are handed on, of one number of each column.
        """
        numbers = {name: np.asarray(rows, dtype=float) for name, rows in known.items()}
        columns = next(iter(numbers.values())).shape[1]
        sizes = {name: len(rows) for name, rows in numbers.items()} | dict.fromkeys(vectors, 1)
        passes = tuple(traced_pass(walk, sizes, self._traced) for walk in walks)
        for name in tables:
            self._declare(name, (sizes[name], columns))
        for name in flat:
            self._declare(name, (columns,), is_table=False)
        for step in passes:
            if step.end is not None:
                self._declare(step.whole, (sizes[step.whole],), is_table=False)
        rest = {name: tuple(map(float, padding.get(name, (0.0,) * len(x)))) for name, x in numbers.items()}
        handed_on = (*tables, *flat)
        self._stages.append(
            Scan(passes, columns, numbers, rest, tuple(vectors.items()), handed_on, frozenset(flat))
        )

    def factors(self, paths: Sequence[Sequence[int]], reads: str, writes: str) -> None:
        """The stage that factors a symmetric matrix; see `Factors`.

        Args:
            paths: As for `Factors`.
            reads: The name of a vector, the rows of the matrix.
            writes: The name of the vector of factors.
        """
        self._arrays[writes] = (self._arrays[reads][0] + len(paths),)
        self._stages.append(Factors(tuple(map(tuple, paths)), reads, writes))

    def form(
        self,
        *outputs: str | Sequence[str] | Beside,
        serves_batches: bool = False,
        zeros: Mapping[str, Any] | None = None,
        symmetric: Sequence[str] = (),
    ) -> StagedForm:
        """The form of all stages.

        Args:
            *outputs: Names of the arrays that the function returns; several names stand for these arrays, one below
                the other, or side by side (`Beside`).
            serves_batches: Whether samples of a batch are computed in this form, too.
            zeros: For matrices which entries are zero whatever the inputs; None for what pairs of columns say.
            symmetric: Names of the matrices that are symmetric.

        Returns:
            The form.

        Raises:
            TraceError: A stage reads an input after or while an output is written: arrays of results may be those of
                arguments.
        """
        groups = [_names_of_output(output) for output in outputs]
        written = [name for group in groups for name in group]
        self._check_order(written)
        ports, parts = [], {}
        names = {name: f"i{k}" for k, name in enumerate(self._inputs)}
        for k, (output, group) in enumerate(zip(outputs, groups, strict=True)):
            shapes = [self._arrays[name] for name in group]
            if len(group) == 1:
                shape, names[group[0]] = shapes[0], f"o{k}"
            else:
                shape, places = _joined(shapes, isinstance(output, Beside))
                arrays = zip(group, places, shapes, strict=True)
                parts |= {name: Part(f"o{k}", place, own, shape[-1]) for name, place, own in arrays}
            ports.append(Port("out" if len(groups) == 1 else f"out{k}", shape))
        inner = {name: shape for name, shape in self._arrays.items() if name not in written}
        return StagedForm(
            tuple(Port(name, shape) for name, shape in self._inputs.items()),
            tuple(ports),
            self.columns,
            inner,
            frozenset(self._tables & inner.keys()),
            dict(self._constants),
            tuple(_renamed(stage, names) for stage in self._stages),
            tuple(self._zeros(output, zeros or {}) for output in outputs),
            serves_batches,
            parts,
            frozenset(k for k, group in enumerate(groups) if set(group) & set(symmetric)),
        )

    def _declare(self, name: str, shape: tuple[int, ...], is_table: bool = True) -> None:
        if self._arrays.setdefault(name, shape) != shape:
            raise TraceError(
                f"{name!r} of {self.name!r} has the shape {shape} and, in an earlier stage, {self._arrays[name]}; "
                "expected one shape. Give one of the two another name."
            )
        if is_table:
            self._tables.add(name)

    def _check_order(self, outputs: Sequence[str]) -> None:
        is_written = False
        for stage in self._stages:
            reads: Sequence[str] = stage.reads if isinstance(stage, Stage) else ()
            if isinstance(stage, Scan):
                reads = [name for name, _ in stage.vectors]
            late = [name for name in reads if name in self._inputs and is_written]
            if late:
                raise TraceError(
                    f"A stage of {self.name!r} reads {late[0]!r} after results are written; expected all such stages "
                    "before the first one that writes results, since arrays of results may be those of arguments."
                )
            # Factors are handed on only by heads of forms of columns, whose results are local arrays.
            writes = () if isinstance(stage, Factors) else stage.writes
            is_written = is_written or bool(set(writes) & set(outputs))
            both = [name for name in reads if name in self._inputs and set(writes) & set(outputs)]
            if both and isinstance(stage, Stage) and stage.kind == "straight":
                raise TraceError(
                    f"A stage of {self.name!r} reads {both[0]!r} and writes results; expected one stage that copies "
                    "the input and another one that writes, since arrays of results may be those of arguments."
                )

    def _zeros(self, output: str | Sequence[str] | Beside, known: Mapping[str, Any]) -> Any:
        found = [known.get(name, self._zeros_of_pairs(name)) for name in _names_of_output(output)]
        if len(found) == 1 or any(zeros is None for zeros in found):
            return found[0] if len(found) == 1 else None
        return np.concatenate(found, axis=1 if isinstance(output, Beside) else 0)

    def _zeros_of_pairs(self, output: str) -> Any:
        for stage in self._stages:
            if isinstance(stage, Products) and output == stage.write:
                return ~stage.pattern
            if isinstance(stage, Pairs) and output in stage.writes:
                both = (stage.masks(i) for i in range(self.columns))
                return np.array([~np.logical_or(below, above) for below, above in both])
        return None

    def _shape(self, name: str) -> tuple[int, ...]:
        if name in self._constants:
            return self._constants[name].shape
        return self._arrays[name] if name in self._arrays else self._inputs[name]

    def _traced(self, f: Callable[..., Any], shapes: Mapping[str, tuple[int, ...]]) -> Function:
        name: Any = f"{self.name}_{len(self._stages)}"
        return trace(f, name=name, **dict[str, Any](shapes))


def _names_of_output(output: str | Sequence[str] | Beside) -> tuple[str, ...]:
    if isinstance(output, Beside):
        return output.names
    return (output,) if isinstance(output, str) else tuple(output)


def _joined(shapes: Sequence[tuple[int, ...]], side_by_side: bool) -> tuple[tuple[int, ...], list[int]]:
    """The shape of arrays one below the other, or side by side, and where in it each of them begins."""
    sizes = [shape[-1] if side_by_side else math.prod(shape) for shape in shapes]
    starts = [0, *accumulate(sizes[:-1])]
    if side_by_side:
        return (shapes[0][0], sum(sizes)), starts
    return (sum(shape[0] for shape in shapes), *shapes[0][1:]), starts


def _renamed(stage: AnyStage, names: Mapping[str, str]) -> AnyStage:
    """The stage with inputs and outputs called as in the code."""

    def all_of(of: Sequence[str]) -> tuple[str, ...]:
        return tuple(names.get(name, name) for name in of)

    if isinstance(stage, Factors):
        return replace(stage, reads=all_of([stage.reads])[0], writes=all_of([stage.writes])[0])
    if isinstance(stage, Stage):
        return replace(stage, reads=all_of(stage.reads), writes=all_of(stage.writes))
    if isinstance(stage, Sweep):
        source, matrix = all_of([stage.source, stage.matrix])
        return replace(stage, source=source, matrix=matrix)
    if isinstance(stage, Products):
        return replace(stage, write=all_of([stage.write])[0])
    if isinstance(stage, Scan):
        return stage.renamed(names)
    return replace(stage, writes=all_of(stage.writes))
