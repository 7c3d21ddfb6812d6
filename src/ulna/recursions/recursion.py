"""A quantity as loops over a table: the procedure, its storage, and the evaluation of batches in blocks of lanes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from math import prod
from typing import Any, NamedTuple, final

import numpy as np

from ulna.compiler.procedures import Procedure
from ulna.compiler.runtime.jit import target
from ulna.typing import Floats

_NUMBERS_AT_ONCE = 1 << 17
"""Numbers of inputs and outputs that one call of machine code takes and returns; it cannot be interrupted meanwhile."""
_STEPS_AT_ONCE = 1 << 18
"""Steps times samples that one call of machine code visits, some 30 ms."""

_ENTRIES_AT_ONCE = 1 << 22
"""Entries of matrices that one call of machine code writes."""

_ENTRIES_COPIED = 1 << 16
"""Entries of matrices below which results are copied out of arrays that are bound once: to bind takes 0.3 ms."""

Shape = tuple[int, ...]


@final
@dataclass(frozen=True, eq=False)
class Recursion:
    """A procedure that takes storage, inputs, outputs and the number of blocks, in this order; W are its lanes.

    Attributes:
        procedure: The procedure; its inputs and outputs are of shape (blocks, size, W).
        storage: Makes the arrays that are passed before the inputs, for a number of lanes.
        inputs: Shapes of the inputs.
        outputs: Shapes of the outputs.
        rows: How many rows its table has.
        is_matrix: Whether the lanes are columns of its outputs: these are then of shape (blocks, ...), and inputs of
            shape (blocks, size, 1).
    """

    procedure: Procedure
    storage: Callable[[int], Sequence[Any]]
    inputs: tuple[Shape, ...]
    outputs: tuple[Shape, ...]
    rows: int
    is_matrix: bool = False

    def evaluator(self) -> Evaluator:
        """What evaluates it for batches."""
        return Evaluator(self)


@cache
def specialized(procedure: Procedure, lanes: int) -> Procedure:
    """The procedure for a number of lanes.

    Args:
        procedure: A procedure with the constant W.
        lanes: W.

    Returns:
        The procedure, the same one for the same arguments.
    """
    return procedure.specialized(W=lanes)


class _Workspace(NamedTuple):
    """Arrays and machine code for some blocks of samples; for one thread at a time."""

    inputs: tuple[Floats, ...]
    outputs: tuple[Floats, ...]
    run: Any

    def evaluate(self, inputs: Sequence[Floats], outputs: Sequence[Floats]) -> None:
        """Computes samples: rows of inputs (rows, size) to rows of outputs (rows, size)."""
        count, lanes = len(outputs[0]), self.inputs[0].shape[2]
        for array, rows in zip(self.inputs, inputs, strict=True):
            _into_lanes(rows, array)
        self.run.set("blocks", -(-count // lanes))
        self.run.unguarded()
        for array, rows in zip(self.outputs, outputs, strict=True):
            _from_lanes(array, rows)


class _MatrixWorkspace(NamedTuple):
    """Arrays and machine code for some matrices; for one thread at a time."""

    inputs: tuple[Floats, ...]
    outputs: tuple[Floats, ...]
    run: Any

    def evaluate(self, inputs: Sequence[Floats], outputs: Sequence[Floats]) -> None:
        """Computes samples: rows of inputs (rows, size) to rows of outputs (rows, size)."""
        count = len(outputs[0])
        for array, rows in zip(self.inputs, inputs, strict=True):
            array[:count, : rows.shape[1], 0] = rows
        self.run.set("blocks", count)
        self.run.unguarded()
        for array, rows in zip(self.outputs, outputs, strict=True):
            rows[...] = array[:count].reshape(rows.shape)


@final
class Evaluator:
    """Evaluates a recursion for batches; may be called from several threads.

    Args:
        recursion: The recursion.
    """

    def __init__(self, recursion: Recursion) -> None:
        self.recursion = recursion
        self.lanes = max(target().register_bytes // 8, 2)
        self._idle_workspaces: dict[bool, list[Any]] = {False: [], True: []}
        self._idle_storage: list[Sequence[Any]] = []

    @property
    def rows_at_once(self) -> int:
        """How many samples of a batch one call of machine code takes."""
        r = self.recursion
        numbers = sum(map(prod, (*r.inputs, *r.outputs)))
        rows = min(_NUMBERS_AT_ONCE // max(numbers, 1), _STEPS_AT_ONCE // r.rows)
        return max(rows // self.lanes, 1) * self.lanes

    def evaluate(self, inputs: Sequence[Floats], outputs: Sequence[Floats]) -> None:
        """Computes samples.

        Args:
            inputs: An array (samples, size) for each input.
            outputs: An array (samples, size) for each output, which is written.
        """
        if self.recursion.is_matrix:
            self._evaluate_matrices(inputs, outputs)
            return
        samples = len(outputs[0])
        is_batch = samples > 1
        step = self.rows_at_once if is_batch else 1
        idle = self._idle_workspaces[is_batch]
        try:
            workspace = idle.pop()
        except IndexError:
            workspace = self._workspace(self.lanes if is_batch else 1, step)
        for first in range(0, samples, step):
            part = slice(first, first + step)
            workspace.evaluate([x[part] for x in inputs], [x[part] for x in outputs])
        idle.append(workspace)

    def _evaluate_matrices(self, inputs: Sequence[Floats], outputs: Sequence[Floats]) -> None:
        """As `evaluate`; the procedure reads and writes large arrays where they are."""
        r = self.recursion
        entries = max(map(prod, r.outputs))
        if entries <= _ENTRIES_COPIED:
            self._evaluate_copies(inputs, outputs, max(_ENTRIES_COPIED // (4 * max(entries, 1)), 1))
            return
        try:
            storage = self._idle_storage.pop()
        except IndexError:
            storage = r.storage(1)
        step = max(_ENTRIES_AT_ONCE // entries, 1)
        for first in range(0, len(outputs[0]), step):
            rows = slice(first, first + step)
            read = [x[rows, :, None] for x in inputs]
            written = [x[rows].reshape(-1, *shape) for x, shape in zip(outputs, r.outputs, strict=True)]
            self.procedure(True).bind(*storage, *read, *written, len(written[0])).unguarded()
        self._idle_storage.append(storage)

    def _evaluate_copies(self, inputs: Sequence[Floats], outputs: Sequence[Floats], blocks: int) -> None:
        """As `evaluate`, so many matrices at a time, or one."""
        is_batch = len(outputs[0]) > 1
        step, idle = blocks if is_batch else 1, self._idle_workspaces[is_batch]
        try:
            workspace = idle.pop()
        except IndexError:
            r = self.recursion
            arrays = tuple(np.zeros((step, max(prod(shape), 1), 1)) for shape in r.inputs)
            results = tuple(np.zeros((step, *shape)) for shape in r.outputs)
            procedure = self.procedure(True)
            run = procedure.bind(*r.storage(1), *arrays, *results, step, are_arrays_private=True)
            workspace = _MatrixWorkspace(arrays, results, run)
        for first in range(0, len(outputs[0]), step):
            part = slice(first, first + step)
            workspace.evaluate([x[part] for x in inputs], [x[part] for x in outputs])
        idle.append(workspace)

    def procedure(self, is_batch: bool) -> Procedure:
        """The procedure for one sample, or for batches."""
        lanes = self.lanes if is_batch or self.recursion.is_matrix else 1
        return specialized(self.recursion.procedure, lanes)

    def _workspace(self, lanes: int, rows: int) -> _Workspace:
        blocks, r = rows // lanes, self.recursion
        inputs, outputs = (
            tuple(np.zeros((blocks, max(prod(shape), 1), lanes)) for shape in shapes)
            for shapes in (r.inputs, r.outputs)
        )
        procedure = specialized(r.procedure, lanes)
        storage = r.storage(lanes)
        run = procedure.bind(*storage, *inputs, *outputs, blocks, are_arrays_private=True)
        return _Workspace(inputs, outputs, run)


def _into_lanes(rows: Floats, array: Floats) -> None:
    """Copies rows (rows, size) to (blocks, size, lanes)."""
    lanes, size = array.shape[2], rows.shape[1]
    if lanes == 1:
        array[: len(rows), :size, 0] = rows
        return
    whole, rest = divmod(len(rows), lanes)
    if whole:
        array[:whole, :size] = rows[: whole * lanes].reshape(whole, lanes, size).swapaxes(1, 2)
    if rest:
        array[whole, :size, :rest] = rows[whole * lanes :].T


def _from_lanes(array: Floats, rows: Floats) -> None:
    """Copies (blocks, size, lanes) to rows (rows, size)."""
    lanes, size = array.shape[2], rows.shape[1]
    if lanes == 1:
        rows[...] = array[: len(rows), :size, 0]
        return
    whole, rest = divmod(len(rows), lanes)
    if whole:
        rows[: whole * lanes].reshape(whole, lanes, size)[...] = array[:whole, :size].swapaxes(1, 2)
    if rest:
        rows[whole * lanes :] = array[whole, :size, :rest].T
