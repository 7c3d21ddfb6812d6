"""Tables of proved clearance of two links over the joints between them.

| symbol | meaning | unit |
|---|---|---|
| c, h | middle and half widths of a cell of configurations of the joints between the links | [rad, m] |
| d(c) | distance of the real shapes at c | [m] |
| b | bound of how much nearer the links come in the cell; see `cell_bounds` | [m] |
| d(c) - b | what the table holds, or more where planes prove it: nothing in the cell brings the links nearer | [m] |

Cells are divided until b is a small part of d, or they are as small as the table's: far from contact one distance
serves thousands of them. Where d(c) - b is not positive, nothing is proved. A cell is as wide as float32 may place a
configuration beside it, so that looking it up in float32 is proof. Source: adaptive distance fields, Frisken, Perry,
Rockwood and Jones (SIGGRAPH 2000), over configurations instead of space, with bounds instead of interpolation.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any, final

import numpy as np

from ulna.collision.cell_bounds import ENOUGH, CellBounds
from ulna.collision.joint_chains import JointChain
from ulna.collision.pairs import LinkPair
from ulna.collision.solids import Solid
from ulna.model import Model
from ulna.typing import Array, Floats

UNPROVED = -1.0
"""What a table holds where nothing is proved [m]."""

MOST_JOINTS = 3
"""Between links of which a table is made."""

_CELLS = {1: 2**12, 2: 2**17, 3: 2**19}  # of a table, about, by the number of joints
_LEVELS = {1: 5, 2: 5, 3: 4}  # so often the first cells are divided
_NEAR = 0.02  # what is proved to be farther apart need not be known so well [m]
_FINEST = 1e-3  # points move by at least this in a cell [m]
_TURNS = 8.0 * np.pi  # up to here either way tables serve joints without limits [rad]
_ROUNDING = 2.0**-21  # of float32, four times

_STEP = 2.5e-4  # [m] of small values on disk
_RATIO = 1.03  # of large ones
_LINEAR = 128  # numbers up to here are multiples of the step


@final
@dataclass(frozen=True, eq=False)
class PairTable:
    """Proved clearances of two links.

    Attributes:
        first: Name of a link; it may be one that does not move.
        second: Name of another.
        columns: The numbers of a configuration that decide how they stand to each other.
        low: Where the cells begin, by column, shape (n,) [rad, m].
        span: The range of all cells, shape (n,) [rad, m].
        is_periodic: Whether the range repeats, shape (n,).
        least: From which configurations on the table holds, shape (n,) [rad, m].
        greatest: Up to which, shape (n,) [rad, m].
        codes: The clearances as `decoded` takes them, shape (cells, ...), one axis for each column.
    """

    first: str
    second: str
    columns: tuple[int, ...]
    low: Floats
    span: Floats
    is_periodic: Array
    least: Floats
    greatest: Floats
    codes: Array
    _values: dict[str, Any] = field(default_factory=dict, repr=False)

    def __repr__(self) -> str:
        cells = "x".join(map(str, self.codes.shape))
        return f"<clearance of {self.first!r} and {self.second!r}, {cells} cells>"

    @property
    def values(self) -> Floats:
        """The clearances, in float32 [m]."""
        if "values" not in self._values:
            self._values["values"] = decoded(self.codes)
        return self._values["values"]

    def clearance(self, q: Floats) -> Floats:
        """Proved clearances; configurations are rounded to float32, as in machine code.

        Args:
            q: Configurations, shape (..., nq) [rad, m].

        Returns:
            No more than the distance of the real shapes, shape (...) [m]; `UNPROVED` where nothing is proved.
        """
        with np.errstate(over="ignore"):  # what float32 cannot hold is out of range
            x = q[..., list(self.columns)].astype(np.float32)
        low, inverse = self.low.astype(np.float32), (1.0 / self.span).astype(np.float32)
        is_known = (x >= self.least.astype(np.float32)) & (x <= self.greatest.astype(np.float32))
        part = (np.where(is_known, x, low) - low) * inverse
        part = part - np.floor(part) * self.is_periodic.astype(np.float32)
        counts = np.array(self.codes.shape, np.float32)
        cells = np.clip(part * counts, np.float32(0.0), counts - np.float32(1.0)).astype(np.int64)
        found = self.values[tuple(np.moveaxis(cells, -1, 0))]
        return np.where(is_known.all(axis=-1), found, np.float32(UNPROVED)).astype(float)


def without_tables(pairs: Iterable[LinkPair], tables: Iterable[PairTable]) -> tuple[LinkPair, ...]:
    """The pairs that have no table.

    Args:
        pairs: Pairs of links.
        tables: The tables.

    Returns:
        The others of the pairs.
    """
    known = {frozenset((table.first, table.second)) for table in tables}
    return tuple(pair for pair in pairs if frozenset(pair) not in known)


def encoded(clearance: Floats) -> Array:
    """Clearances as bytes, rounded downwards; 0 where nothing is proved.

    Args:
        clearance: Lengths [m].

    Returns:
        Numbers from 0 to 255, of the same shape.
    """
    levels = _levels()
    return (np.searchsorted(levels, np.maximum(clearance, 0.0), side="right") - 1).astype(np.uint8)


def decoded(codes: Array) -> Floats:
    """The lengths that bytes stand for.

    Args:
        codes: Numbers from 0 to 255.

    Returns:
        Lengths in float32, rounded downwards [m]; `UNPROVED` for 0.
    """
    levels: Any = np.nextafter(_levels().astype(np.float32), np.float32(0.0))
    levels[0] = UNPROVED
    return levels[codes]


def _levels() -> Any:
    linear = np.arange(_LINEAR) * _STEP
    return np.concatenate([linear, linear[-1] * _RATIO ** np.arange(1, 257 - _LINEAR)])


def ranges(model: Model, chain: JointChain) -> tuple[Floats, Floats, Array, Floats, Floats] | None:
    """The configurations of the joints between two links, as `PairTable` takes them.

    Args:
        model: The robot.
        chain: The joints.

    Returns:
        `low`, `span`, `is_periodic`, `least`, `greatest`, shape (joints,) each; None where a joint has no limits and
        does not repeat.
    """
    columns = list(chain.columns)
    low, high = model.lower_position[columns], model.upper_position[columns]
    turn = 2.0 * np.pi
    is_periodic = np.array([chain.is_periodic(c) for c in columns]) & ~(high - low < turn)
    if not (is_periodic | np.isfinite(high - low)).all():
        return None
    least, greatest = np.where(np.isfinite(low), low, -_TURNS), np.where(np.isfinite(high), high, _TURNS)
    slack = 1e-6 * (1.0 + np.maximum(np.abs(least), np.abs(greatest)))
    start = np.where(is_periodic, -np.pi, low)
    span = np.where(is_periodic, turn, np.maximum(high - low, 1e-6))
    return start, span, is_periodic, least - slack, greatest + slack


def pair_table(
    model: Model,
    pair: LinkPair,
    chain: JointChain,
    solids: tuple[Sequence[Solid], Sequence[Solid]],
    queries: int,
    progress: Callable[[], object],
) -> PairTable | None:
    """Makes the table of two links.

    Args:
        model: The robot.
        pair: The names of the links.
        chain: The joints between them, `MOST_JOINTS` at most.
        solids: The solids of both.
        queries: How many distances are asked for, about.
        progress: Called now and then; its exceptions end the work.

    Returns:
        The table; None where a joint has no limits and does not repeat.
    """
    found = ranges(model, chain)
    if found is None:
        return None
    start, span, _, least, greatest = found
    size = 1.0 + np.maximum(np.abs(least), np.abs(greatest)) + span
    filling = _Filling(model, chain, solids, start, span, (2e-6 + _ROUNDING) * size, queries)
    return PairTable(*pair, chain.columns, *found, encoded(filling.filled(progress)))


@final
class _Filling:
    """The cells of a table, coarse ones first.

    Args:
        model: The robot.
        chain: The joints between two links.
        solids: The solids of both.
        start: Where cells begin, shape (n,) [rad, m].
        span: Their range, shape (n,) [rad, m].
        beyond: By how much wider cells are than they are apart, on either side, shape (n,) [rad, m].
        queries: How many distances are asked for, about.
    """

    def __init__(
        self, model: Model, chain: JointChain, solids: tuple[Sequence[Solid], Sequence[Solid]], start: Floats,
        span: Floats, beyond: Floats, queries: int,
    ) -> None:  # fmt: skip
        self._nq, self._columns = model.nq, list(chain.columns)
        self._start, self._span, self._beyond = start, span, beyond
        self._bounds = CellBounds(chain, solids)
        self._levels = _LEVELS[len(span)]
        self._first = self._first_counts()
        self._left = queries

    def _first_counts(self) -> Array:
        """How many of the largest cells there are along each axis: points move about as far in all of them."""
        count = len(self._span)
        q = self._configurations(np.random.default_rng(0).uniform(size=(64, count)))
        moved = [float(self._bounds.approach(q, row * self._span).mean()) for row in np.eye(count)]
        moved = np.maximum(moved, 1e-4)
        width = max(float(np.prod(moved) / _CELLS[count]) ** (1.0 / count), _FINEST)
        return np.maximum(np.ceil(moved / width / 2**self._levels), 1).astype(int)

    def _configurations(self, part: Floats) -> Floats:
        """Configurations at parts of the ranges, shape (m, nq)."""
        q = np.zeros((len(part), self._nq))
        q[:, self._columns] = self._start + part * self._span
        return q

    def filled(self, progress: Callable[[], object]) -> Floats:
        """The clearances of all cells [m]; not above 0 where nothing is proved."""
        counts, axes = self._first, len(self._first)
        known = np.full(counts, -np.inf)
        cells = np.argwhere(np.ones(counts, dtype=bool))
        for _ in range(self._levels):
            distance, clearance = self._looked_at(cells, counts, progress)
            known[tuple(cells.T)] = clearance
            parents = cells[self._to_divide(distance, clearance)]
            counts = 2 * counts
            for axis in range(axes):
                known = np.repeat(known, 2, axis=axis)
            corners = np.argwhere(np.ones((2,) * axes, dtype=bool))
            cells = (2 * parents[:, None] + corners).reshape(-1, axes)
        _, clearance = self._looked_at(cells, counts, progress)
        known[tuple(cells.T)] = np.maximum(known[tuple(cells.T)], clearance)
        return known

    def _to_divide(self, distance: Floats, clearance: Floats) -> Array:
        """The numbers of cells to divide: first those in which contact begins, then those of little clearance."""
        near = (clearance < (1.0 - ENOUGH) * distance) & (clearance < _NEAR)
        near |= clearance < (1.0 - 2.0 * ENOUGH) * distance
        bound = distance - clearance
        begins = (distance <= 0.0) & (distance + bound > 0.0)  # else the links touch in all of the cell
        numbers = np.flatnonzero(near | begins)
        order = np.where(clearance > 0.0, 1.0 + clearance, np.abs(distance))[numbers]
        room = max(self._left, 0) // 2 ** len(self._first)
        return numbers[np.argsort(order, kind="stable")[:room]] if len(numbers) > room else numbers

    def _looked_at(
        self, cells: Array, counts: Array, progress: Callable[[], object]
    ) -> tuple[Floats, Floats]:
        """Distances at the middles of cells, and what is proved for the cells."""
        distances, clearances = [np.zeros(0)], [np.zeros(0)]
        half = self._span / counts / 2.0 + self._beyond
        for begin in range(0, len(cells), 256):
            progress()
            q = self._configurations((cells[begin : begin + 256] + 0.5) / counts)
            d, clearance, asked = self._bounds.proved(q, half)
            self._left -= asked
            distances.append(d)
            clearances.append(clearance)
        return np.concatenate(distances), np.concatenate(clearances)
