"""Rows that a job collects one part after the other, as arrays of its state."""

from __future__ import annotations

import numpy as np

from ulna.scale.job import State
from ulna.typing import Array

_FIRST = 1024  # rows that there is room for at first


def start(name: str, empty: Array) -> State:
    """The arrays of a collection without rows.

    Args:
        name: The name of the collection.
        empty: An array without rows, (0, ...), of the shape and type of those to come.

    Returns:
        Arrays by name, for the state of a job.
    """
    return {name: np.zeros((_FIRST, *empty.shape[1:]), empty.dtype), f"{name}_rows": np.zeros(1, np.int64)}


def add(state: State, name: str, rows: Array) -> None:
    """Adds rows; where the array is full, it is copied into one of twice the size.

    Args:
        state: The state of a job, which is changed.
        name: The name of the collection.
        rows: The rows, (n, ...).
    """
    first = int(state[f"{name}_rows"][0])
    last, array = first + len(rows), state[name]
    if last > len(array):
        larger = np.zeros((max(last, 2 * len(array)), *array.shape[1:]), array.dtype)
        larger[:first] = array[:first]
        state[name] = array = larger
    array[first:last] = rows
    state[f"{name}_rows"][0] = last


def rows(state: State, name: str) -> Array:
    """All rows of a collection.

    Args:
        state: The state of a job.
        name: The name of the collection.

    Returns:
        The rows, (n, ...).
    """
    return state[name][: int(state[f"{name}_rows"][0])]
