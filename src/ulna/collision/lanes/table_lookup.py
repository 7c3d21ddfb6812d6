"""Proved clearances of pairs of links, looked up for many configurations in lanes.

The numbers are those of `PairTable.clearance`, bit by bit: nothing here may be contracted.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ulna.collision.pair_tables import MOST_JOINTS, PairTable
from ulna.compiler.procedures import Array1, Array2, broadcast, f32, procedure

INT = np.int64


class PairGrids(NamedTuple):
    """Tables of pairs of links, one after the other.

    Attributes:
        axes: How many joints a table has, and where its cells begin; then by joint its column and how many cells it
            has, (n, 8).
        numbers: By joint where cells begin, 1 / range, 1 where the range repeats, else 0, and from where to where the
            table holds, (n, 15) [rad, m].
        cells: Of all cells of all tables the clearance and the slopes, one after the other [m].
        of_pair: Which table the pairs of `Tables.pairs` have, -1 for none, (P,).
        pair_reach: How near these may come, (P,) [m].
        fixed: Tables of links with links that never move, (m,).
        fixed_reach: How near these may come, (m,) [m].
    """

    axes: Array2[INT]
    numbers: Array2[f32]
    cells: Array1[f32]
    of_pair: Array1[INT]
    pair_reach: Array1[f32]
    fixed: Array1[INT]
    fixed_reach: Array1[f32]


@procedure
def table_clearance(grids, g, q, W):
    """The proved clearances of a pair, in lanes.

    Args:
        grids: The tables [m].
        g: Which table [-].
        q: Configurations, (nq, W) [rad, m].
        W: Lanes, a constant [-].

    Returns:
        Clearances, not above 0 where nothing is proved [m].
    """
    cell = broadcast(0, W)
    is_outside = broadcast(f32(0.0), W) > 1
    for j in range(grids.axes[g, 0]):
        count = grids.axes[g, 3 + 2 * j]
        x = q[grids.axes[g, 2 + 2 * j], 0:W]
        cell = cell * count + _cell(_part(grids, g, j, x), count)
        is_outside = is_outside | (x < grids.numbers[g, 5 * j + 3]) | (x > grids.numbers[g, 5 * j + 4])
    place = grids.axes[g, 1] + cell * (grids.axes[g, 0] + 1)
    clearance = grids.cells[place]
    for j in range(grids.axes[g, 0]):
        part = _part(grids, g, j, q[grids.axes[g, 2 + 2 * j], 0:W])
        u = (part - f32(_cell(part, grids.axes[g, 3 + 2 * j]))) * f32(2.0) - f32(1.0)
        clearance = clearance + grids.cells[place + j + 1] * np.minimum(np.maximum(u, f32(-1.0)), f32(1.0))
    return np.where(is_outside | (clearance <= 0), f32(-1.0), clearance)


@procedure
def _part(grids, g, j, x):
    """How many cells a position is from the beginning of axis j of table g, in lanes."""
    part = (x - grids.numbers[g, 5 * j]) * grids.numbers[g, 5 * j + 1]
    part = part - np.floor(part) * grids.numbers[g, 5 * j + 2]
    return part * f32(grids.axes[g, 3 + 2 * j])


@procedure
def _cell(part, count):
    """The number of the cell along an axis, in lanes."""
    return int(np.minimum(np.maximum(part, 0), f32(count - 1)))


def packed(tables: Sequence[PairTable]) -> dict[str, Any]:
    """Tables as `PairGrids` takes them, by name; without pairs.

    Args:
        tables: The tables.

    Returns:
        `axes`, `numbers` and `cells`.
    """
    axes, numbers = (
        np.zeros((len(tables), 2 + 2 * MOST_JOINTS), np.int64),
        np.zeros((len(tables), 5 * MOST_JOINTS), np.float32),
    )
    cells: list[Any] = [np.zeros(0, np.float32)]
    begin = 0
    for g, table in enumerate(tables):
        axes[g, 0], axes[g, 1] = len(table.columns), begin
        axes[g, 2 : 2 + 2 * len(table.columns) : 2] = table.columns
        axes[g, 3 : 3 + 2 * len(table.columns) : 2] = table.codes.shape
        by_joint = np.stack(
            [table.low, 1.0 / table.span, table.is_periodic.astype(float), table.least, table.greatest],
            axis=1,
        )
        numbers[g, : by_joint.size] = by_joint.astype(np.float32).ravel()
        cells.append(table.values.ravel())
        begin += table.values.size
    return {"axes": axes, "numbers": numbers, "cells": np.concatenate(cells)}
