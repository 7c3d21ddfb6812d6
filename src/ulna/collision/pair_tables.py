"""Tables of proved clearance of two links over the joints between them.

| symbol | meaning | unit |
|---|---|---|
| c, h | middle and half widths of a cell of configurations of the joints between the links | [rad, m] |
| d(c) | distance of the real shapes at c | [m] |
| v, s | clearance at c and slopes to the ends of the cell; see `cell_bounds` | [m] |
| u | where a configuration is in its cell, -1 to 1 along each axis | [1] |
| v + s u | what the table proves: the links are at least as far apart at the configuration | [m] |

Cells are divided until v is nearly d, or they are as small as the table's: far from contact one distance serves
thousands of them. Where v + s u is not positive, nothing is proved. A cell is as wide as float32 may place a
configuration beside it, so that looking it up in float32 is proof. Source: adaptive distance fields, Frisken, Perry,
Rockwood and Jones (SIGGRAPH 2000), over configurations instead of space, with bounds instead of interpolation.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any, final

import numpy as np

from ulna.collision.cell_bounds import ENOUGH, SLOPE_STEP, CellBounds, Proved
from ulna.collision.joint_chains import JointChain
from ulna.collision.pairs import LinkPair
from ulna.collision.solids import Solid
from ulna.model import Model
from ulna.typing import Array, Floats

UNPROVED = -1.0
"""What a table holds where nothing is proved [m]."""

MOST_JOINTS = 3
"""Between links of which a table is made."""

_CELLS = {1: 2**11, 2: 2**15, 3: 2**18}  # of a table, about, by the number of joints
_LEVELS = {1: 5, 2: 5, 3: 4}  # so often the first cells are divided
_NEAR = 0.02  # what is proved to be farther apart need not be known so well [m]
_EXACT = 5e-4  # clearances that are so near the distance are not improved [m]
_BLOCK = 2048  # cells that are computed together
_FINEST = 1e-3  # points move by at least this in a cell [m]
_TURNS = 8.0 * np.pi  # up to here either way tables serve joints without limits [rad]
_ROUNDING = 2.0**-21  # of float32, four times

_STEP = 2.5e-4  # [m] of small values on disk
_RATIO = 1.04  # of large ones
_LEAST = -48  # steps that the first number stands for, but for that of what is not proved
_LINEAR = 104  # steps up to which numbers are multiples of the step


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
        codes: The clearances at the middles, as `decoded` takes them, shape (cells, ...), one axis for each column.
        slopes: How much more is proved at the ends of a cell, in numbers of `SLOPE_STEP`, shape (cells, ..., n).
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
    slopes: Array
    _values: dict[str, Any] = field(default_factory=dict, repr=False)

    def __repr__(self) -> str:
        cells = "x".join(map(str, self.codes.shape))
        return f"<clearance of {self.first!r} and {self.second!r}, {cells} cells>"

    @property
    def values(self) -> Array:
        """Of each cell the clearance at its middle and the slopes, in float32, shape (cells, ..., 1 + n) [m]."""
        if "values" not in self._values:
            slopes = self.slopes.astype(np.float32) * np.float32(SLOPE_STEP)
            self._values["values"] = np.concatenate([decoded(self.codes)[..., None], slopes], axis=-1)
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
        part = part * counts
        cells = np.clip(part, np.float32(0.0), counts - np.float32(1.0)).astype(np.int64)
        u = np.clip(
            (part - cells.astype(np.float32)) * np.float32(2.0) - np.float32(1.0),
            np.float32(-1.0),
            np.float32(1.0),
        )
        known = self.values[tuple(np.moveaxis(cells, -1, 0))]
        value = known[..., 0]
        for j in range(len(self.columns)):
            value = value + known[..., 1 + j] * u[..., j]
        is_proved = is_known.all(axis=-1) & (value > 0.0)
        return np.where(is_proved, value, np.float32(UNPROVED)).astype(float)


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
    """Clearances as bytes, rounded downwards; 0 for what is less than any other number stands for.

    Args:
        clearance: Lengths [m].

    Returns:
        Numbers from 0 to 255, of the same shape.
    """
    return np.searchsorted(_levels(), clearance, side="right").astype(np.uint8)


def decoded(codes: Array) -> Any:
    """The lengths that bytes stand for.

    Args:
        codes: Numbers from 0 to 255.

    Returns:
        Lengths in float32, rounded downwards [m]; `UNPROVED` for 0.
    """
    levels = np.nextafter(_levels().astype(np.float32), np.float32(-np.inf))
    return np.concatenate([np.full(1, UNPROVED, np.float32), levels])[codes]


def _levels() -> Any:
    linear = np.arange(_LEAST, _LINEAR + 1) * _STEP
    return np.concatenate([linear, linear[-1] * _RATIO ** np.arange(1, 256 - len(linear))])


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
    position_ranges = ranges(model, chain)
    if position_ranges is None:
        return None
    start, span, _, least, greatest = position_ranges
    size = 1.0 + np.maximum(np.abs(least), np.abs(greatest)) + span
    builder = _TableBuilder(model, chain, solids, start, span, (2e-6 + _ROUNDING) * size, queries)
    clearance, slopes = builder.clearances_and_slopes(progress)
    codes = encoded(clearance)
    slopes[codes == 0] = 0
    return PairTable(*pair, chain.columns, *position_ranges, codes, slopes)


@final
class _TableBuilder:
    """Computes the cells of a table, coarse ones first.

    Args:
        model: The robot.
        chain: The joints between two links.
        solids: The solids of both.
        start: Where cells begin, shape (n,) [rad, m].
        span: Their range, shape (n,) [rad, m].
        margin: By how much a cell is enlarged on either side, shape (n,) [rad, m].
        queries: How many distances are asked for, about.
    """

    def __init__(
        self, model: Model, chain: JointChain, solids: tuple[Sequence[Solid], Sequence[Solid]], start: Floats,
        span: Floats, margin: Floats, queries: int,
    ) -> None:  # fmt: skip
        self._nq, self._columns = model.nq, list(chain.columns)
        self._start, self._span, self._margin = start, span, margin
        self._bounds = CellBounds(chain, solids)
        self._levels = _LEVELS[len(span)]
        self._coarse_counts = self._first_counts()
        self._queries_left = queries

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

    def clearances_and_slopes(self, progress: Callable[[], object]) -> tuple[Floats, Array]:
        """The clearances of all cells [m], and their slopes, in numbers of `SLOPE_STEP`."""
        counts, axes = self._coarse_counts, len(self._coarse_counts)
        known, slopes = np.full(counts, -np.inf), np.zeros((*counts, axes), np.int8)
        cells = np.argwhere(np.ones(counts, dtype=bool))
        for level in range(self._levels + 1):
            proved = self._prove_cells(cells, counts, progress)
            at = tuple(cells.T)
            is_better = proved.clearance > known[at]
            better = tuple(axis[is_better] for axis in at)
            known[better] = proved.clearance[is_better]
            slopes[better] = np.rint(proved.slopes[is_better] / SLOPE_STEP).astype(np.int8)
            if level == self._levels:
                break
            parents = cells[self._to_divide(proved)]
            known, slopes, counts = *_subdivided(known, slopes), 2 * counts
            corners = np.argwhere(np.ones((2,) * axes, dtype=bool))
            cells = (2 * parents[:, None] + corners).reshape(-1, axes)
        return known, slopes

    def _to_divide(self, proved: Proved) -> Array:
        """The numbers of cells to divide, those nearest to contact first."""
        distance, clearance = proved.distance, proved.clearance
        gap = distance - clearance
        near = (gap > ENOUGH * distance) & (clearance < _NEAR) | (gap > 2.0 * ENOUGH * distance)
        near &= distance > 0.0
        just_touching = (distance <= 0.0) & (clearance + np.abs(proved.slopes).sum(axis=1) > -gap)
        numbers = np.flatnonzero((near | just_touching) & (gap > _EXACT))
        most = max(self._queries_left, 0) // 2 ** len(self._coarse_counts)
        if len(numbers) > most:
            numbers = numbers[np.argsort(np.abs(distance[numbers]), kind="stable")[:most]]
        return numbers

    def _prove_cells(self, cells: Array, counts: Array, progress: Callable[[], object]) -> Proved:
        """The clearances that are proved for cells."""
        parts = []
        width = self._span / counts / 2.0
        for block_start in range(0, len(cells), _BLOCK):
            progress()
            q = self._configurations((cells[block_start : block_start + _BLOCK] + 0.5) / counts)
            proved = self._bounds.proved(q, width + self._margin)
            slopes = (
                proved.slopes
            )  # where float32 may look a configuration up, they may be off by their part of that
            error = np.abs(slopes) @ (self._margin / width)
            parts.append(proved._replace(clearance=proved.clearance - error))
            self._queries_left -= proved.queries
        if not parts:
            axes = len(counts)
            return Proved(np.zeros(0), np.zeros(0), np.zeros((0, axes)), 0)
        return Proved(
            np.concatenate([part.distance for part in parts]),
            np.concatenate([part.clearance for part in parts]),
            np.concatenate([part.slopes for part in parts]),
            sum(part.queries for part in parts),
        )


def _subdivided(known: Floats, slopes: Array) -> tuple[Floats, Array]:
    """The clearances at the middles of the halves of cells [m], and their slopes, as the cells prove them."""
    steps = slopes.astype(float) * SLOPE_STEP
    for axis in range(known.ndim):
        known, slopes, steps = (np.repeat(x, 2, axis=axis) for x in (known, slopes, steps))
        side = np.where(np.arange(known.shape[axis]) % 2, 0.5, -0.5)
        known += steps[..., axis] * side.reshape([-1 if k == axis else 1 for k in range(known.ndim)])
    rounded = np.rint(slopes / 2.0)
    return known - np.abs(slopes / 2.0 - rounded).sum(axis=-1) * SLOPE_STEP, rounded.astype(np.int8)
