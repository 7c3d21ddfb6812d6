"""Matrices without the entries that are known: the lower triangle where they are symmetric, the nonzeros elsewhere.

Entries are in order column by column. So the lower triangle of a dense symmetric matrix is LAPACK's packed storage
(`uplo="L"`), and nonzeros are in the order of a compressed sparse column matrix, such as `scipy.sparse.csc_array`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ulna.checks.masked import check_not_masked
from ulna.compiler.language.ops import Op
from ulna.compiler.language.ports import Entries, Port
from ulna.data_classes import dataclass
from ulna.errors import InputError, ShapeError
from ulna.typing import Array, ArrayLike

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from ulna.compiler.language.graph import Graph
    from ulna.compiler.language.ports import SecondForm


@dataclass(frozen=True, eq=False)
class Pattern:
    """Which entries of a matrix are stored, column by column.

    Attributes:
        shape: That of the matrix, (n, m).
        rows: The row of each stored entry, (count,).
        columns: The column of each stored entry, (count,).
        is_symmetric: Whether the matrix is symmetric, and only its lower triangle stored.
    """

    shape: tuple[int, int]
    rows: Array
    columns: Array
    is_symmetric: bool

    @property
    def count(self) -> int:
        """How many entries are stored."""
        return len(self.rows)

    @property
    def places(self) -> Array:
        """The places of the stored entries in the whole matrix, row by row, (count,)."""
        return self.rows * self.shape[1] + self.columns

    @property
    def starts(self) -> Array:
        """Where each column begins among the stored entries, then their number, (m + 1,): `indptr` of SciPy."""
        return np.searchsorted(self.columns, np.arange(self.shape[1] + 1))

    def unpack(self, values: ArrayLike) -> Array:
        """The whole matrices.

        Args:
            values: The stored entries, (..., count).

        Returns:
            The matrices, (..., n, m), of the same type.

        Raises:
            ShapeError: If the last axis has another size.
            InputError: If entries are masked.
        """
        check_not_masked("values", values)
        stored = np.asarray(values)
        if stored.ndim == 0 or stored.shape[-1] != self.count:
            raise ShapeError(
                "values", stored.shape, f"(..., {self.count})", "Pass what the packed kernel returned."
            )
        full = np.zeros((*stored.shape[:-1], *self.shape), stored.dtype)
        full[..., self.rows, self.columns] = stored
        if self.is_symmetric:
            full[..., self.columns, self.rows] = stored
        return full

    def __repr__(self) -> str:
        kind = "symmetric " if self.is_symmetric else ""
        return f"<pattern of a {kind}{self.shape[0]} x {self.shape[1]} matrix, {self.count} entries stored>"


class Packable:
    """Mixin of `Function`: the same function with its matrices packed."""

    name: str
    graph: Graph
    outputs: tuple[Port, ...]
    results: tuple[int, ...]
    single: bool
    columns: SecondForm | None
    _derived: Callable[..., Any]

    def pattern(self, zeros: bool = False) -> Any:
        """Which entries of its matrices `packed` stores.

        Args:
            zeros: Whether entries that are always zero are stored, too.

        Returns:
            The `Pattern`; of several outputs a tuple, with None for those that are no matrices.

        Raises:
            InputError: If no output is a matrix.
        """
        patterns = self._patterns(zeros)
        return patterns[0] if self.single else patterns

    def packed(self, zeros: bool = False) -> Any:
        """The function whose matrices are vectors of their stored entries, (count,), in the order of `pattern`.

        Args:
            zeros: Whether entries that are always zero are stored, too.

        Returns:
            The function; outputs that are no matrices are what they were.

        Raises:
            InputError: If no output is a matrix.
        """
        return self._packed_as(self._patterns(zeros))

    def _packed_as(self, patterns: Sequence[Pattern | None]) -> Any:
        outputs: list[Port] = []
        results: list[int] = []
        start = 0
        for port, pattern in zip(self.outputs, patterns, strict=True):
            places = range(port.size) if pattern is None else pattern.places
            outputs.append(port if pattern is None else Port(port.name, (pattern.count,)))
            results += [self.results[start + k] for k in places]
            start += port.size
        return self._derived("packed", (self.graph, results), tuple(outputs), self.single)

    def _patterns(self, zeros: bool) -> tuple[Pattern | None, ...]:
        if all(len(port.shape) != 2 for port in self.outputs):
            shapes = ", ".join(f"{port.name} {port.shape}" for port in self.outputs)
            raise InputError(
                f"{self.name} returns {shapes}; expected a matrix among its outputs, since only matrices are packed."
            )
        entries = self._entries_of_graph() if self.columns is None else self.columns.entries
        return tuple(known and _pattern(known, zeros) for known in entries)

    def _entries_of_graph(self) -> list[Entries | None]:
        """A matrix is symmetric where opposite entries are the same node."""
        entries, start, g = [], 0, self.graph
        for port in self.outputs:
            nodes = self.results[start : start + port.size]
            start += port.size
            if len(port.shape) != 2:
                entries.append(None)
                continue
            matrix = np.array(nodes, dtype=np.intp).reshape(port.shape)
            is_symmetric = port.shape[0] == port.shape[1] and np.array_equal(matrix, matrix.T)
            is_zero = [g.op[node] == Op.CONST and g.data[node] == 0.0 for node in nodes]
            entries.append(Entries(~np.array(is_zero, dtype=bool).reshape(port.shape), is_symmetric))
        return entries


def _pattern(known: Entries, zeros: bool) -> Pattern:
    """The stored entries of a matrix."""
    is_stored = np.full_like(known.is_set, True) if zeros else known.is_set
    columns, rows = np.nonzero((np.tril(is_stored) if known.is_symmetric else is_stored).T)
    for indices in (rows, columns):
        indices.setflags(write=False)
    return Pattern(is_stored.shape, rows, columns, known.is_symmetric)
