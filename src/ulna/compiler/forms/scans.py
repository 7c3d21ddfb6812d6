"""Walks along the segments of a chain, one segment in each SIMD lane: parallel prefixes, and what follows from them.

The columns are divided into segments of neighbours, one for each lane. Each lane walks along its own segment with a
state that an associative operation joins: from the identity to the state at the segment's end. The ends are joined in
log2(lanes) rounds, so that later walks know the state before each segment. A walk may also have no state, and compute
all columns alike.

Source: Blelloch 1990, Prefix sums and their applications.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

from ulna.compiler.language.function import Function
from ulna.data_classes import dataclass


@dataclass(frozen=True, eq=False)
class States:
    """The states of a walk.

    Attributes:
        join: From the state at the end of a segment and that of the following one, which begins with the identity, to
            the state after both.
        identity: The state that changes none it is joined with.
        start: The state before the first column that is walked along.
    """

    join: Function
    identity: tuple[float, ...]
    start: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class ScanPass:
    """A walk along all segments at once.

    Attributes:
        body: From a state, where there are states, and a column of each array that is read, to the next state and a
            column of each array that is written.
        reads: Names of vectors, of what is known of columns, of what walks before have written, of their states before
            segments, and of what follows from their last states.
        writes: Names of what it computes of each column.
        states: The states; None for a walk without.
        before: The name of the states before segments, or "".
        end: From the state after all columns to `whole`; None for nothing.
        whole: The name of a vector, or "".
        is_inward: Whether it begins with the last column.
    """

    body: Function
    reads: tuple[str, ...]
    writes: tuple[str, ...]
    states: States | None
    before: str
    end: Function | None
    whole: str
    is_inward: bool

    @property
    def rows(self) -> dict[str, int]:
        """How many numbers of each column it computes, by their names."""
        ports = self.body.outputs[1:] if self.states else self.body.outputs
        return {name: port.size for name, port in zip(self.writes, ports, strict=True)}


@dataclass(frozen=True, eq=False)
class Scan:
    """Walks along the segments of a chain.

    Attributes:
        passes: The walks in order.
        columns: How many columns there are.
        known: What is known of columns: tables, (rows, columns).
        padding: For each table the column with which a walk leaves its state as it is, whatever the vectors hold.
        vectors: Names of the vectors, and which of their numbers is that of the first column.
        tables: Names of those tables that are handed on.
        flat: Which of these are vectors, of one number of each column.
    """

    passes: tuple[ScanPass, ...]
    columns: int
    known: Mapping[str, Any]
    padding: Mapping[str, tuple[float, ...]]
    vectors: tuple[tuple[str, int], ...]
    tables: tuple[str, ...]
    flat: frozenset[str] = frozenset()

    @property
    def rows(self) -> dict[str, int]:
        """How many numbers of each column there are of all that is computed, by their names."""
        return {name: size for step in self.passes for name, size in step.rows.items()}

    @property
    def wholes(self) -> tuple[str, ...]:
        """The names of the vectors that follow from last states."""
        return tuple(step.whole for step in self.passes if step.end is not None)

    @property
    def writes(self) -> tuple[str, ...]:
        """Names of what it computes."""
        return (*self.tables, *self.wholes)

    @property
    def bodies(self) -> list[Function]:
        """All functions that are written out."""
        found: list[Function] = []
        for step in self.passes:
            found.append(step.body)
            found += [step.states.join] if step.states else []
            found += [step.end] if step.end else []
        return found

    def renamed(self, names: Mapping[str, str]) -> Scan:
        """The same with other names of what it reads and writes.

        Args:
            names: New names by those of now; others stay.

        Returns:
            The scan.
        """

        def all_of(of: Sequence[str]) -> tuple[str, ...]:
            return tuple(names.get(name, name) for name in of)

        passes = tuple(
            replace(
                step,
                reads=all_of(step.reads),
                writes=all_of(step.writes),
                whole=names.get(step.whole, step.whole),
            )
            for step in self.passes
        )
        vectors = tuple((names.get(name, name), first) for name, first in self.vectors)
        return replace(
            self,
            passes=passes,
            vectors=vectors,
            tables=all_of(self.tables),
            flat=frozenset(all_of([*self.flat])),
        )


class Monoid(NamedTuple):
    """States as functions of arrays; see `States`.

    Attributes:
        join: As for `States`.
        identity: As for `States`.
        start: As for `States`; empty for the identity.
    """

    join: Callable[[Any, Any], Any]
    identity: Sequence[float]
    start: Sequence[float] = ()


def sums(count: int, start: Sequence[float] = ()) -> Monoid:
    """States that are added.

    Args:
        count: How many numbers a state has.
        start: The numbers before the first column; empty for zeros.

    Returns:
        The states.
    """
    return Monoid(lambda before, after: before + after, (0.0,) * count, start)


class Walk(NamedTuple):
    """A walk as functions of arrays; see `ScanPass`.

    Attributes:
        body: As for `ScanPass`.
        reads: As for `ScanPass`.
        writes: As for `ScanPass`.
        states: As for `ScanPass`.
        before: As for `ScanPass`.
        end: As for `ScanPass`.
        whole: As for `ScanPass`.
        is_inward: As for `ScanPass`.
    """

    body: Callable[..., Any]
    reads: Sequence[str]
    writes: Sequence[str] = ()
    states: Monoid | None = None
    before: str = ""
    end: Callable[[Any], Any] | None = None
    whole: str = ""
    is_inward: bool = False


def traced_pass(
    walk: Walk,
    sizes: dict[str, int],
    traced: Callable[[Callable[..., Any], Mapping[str, tuple[int, ...]]], Function],
) -> ScanPass:
    """Traces a walk.

    Args:
        walk: The walk.
        sizes: How many numbers there are of all that may be read, by name; completed by what the walk makes.
        traced: Traces a function of arrays of given shapes.

    Returns:
        The pass.
    """
    shapes = {name: (sizes[name],) for name in walk.reads}
    states, end = None, None
    if walk.states is not None:
        identity = tuple(map(float, walk.states.identity))
        state = (len(identity),)
        shapes = {"state": state, **shapes}
        join = traced(walk.states.join, {"before": state, "after": state})
        states = States(join, identity, tuple(map(float, walk.states.start)) or identity)
        sizes[walk.before] = len(identity)
        end = traced(walk.end, {"state": state}) if walk.end is not None else None
        if end is not None:
            sizes[walk.whole] = end.outputs[0].size
    body = traced(walk.body, shapes)
    made = ScanPass(
        body, tuple(walk.reads), tuple(walk.writes), states, walk.before, end, walk.whole, walk.is_inward
    )
    sizes |= made.rows
    return made
