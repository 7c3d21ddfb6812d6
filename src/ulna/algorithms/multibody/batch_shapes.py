"""The batch shape of results: arrays and spatial vectors with the leading axes of all inputs.

The algorithms compute with arrays of any leading axes. A result that happens not to depend on some input would lack
that input's batch axes; the functions here give them to it. Traced scalars and symbols travel in object arrays, which
have no batch axes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from ulna.numeric import is_symbolic
from ulna.spatial import SE3, Force, Motion
from ulna.typing import Array

Input = Array | Sequence[Force | None] | None
"""An array (..., n); the forces on the bodies, some of them None; or None, which has no batch axes."""


def batch_zeros(shape: tuple[int, ...], *inputs: Input) -> Array:
    """Zeros with the batch axes of `inputs`, then `shape`.

    Args:
        shape: The axes of the result after those of the batch.
        *inputs: Arrays (..., n), forces on the bodies, or None.

    Returns:
        Zeros of shape (*batch, *shape); an object array (*shape,) where an input holds symbols.
    """
    arrays = list(_arrays(inputs))
    if is_symbolic(*arrays):
        return np.full(shape, 0.0, dtype=object)
    return np.zeros(_batch(arrays) + shape)


def broadcast_pose(pose: SE3, *inputs: Input) -> SE3:
    """`pose` with the batch axes of `inputs`, also where it does not depend on them.

    Args:
        pose: A pose, whose batch axes are among those of `inputs`.
        *inputs: Arrays (..., n), forces on the bodies, or None.

    Returns:
        The pose with all batch axes; `pose` itself where an input holds symbols.
    """
    arrays = list(_arrays(inputs))
    if is_symbolic(*arrays):
        return pose
    batch = _batch(arrays)
    return SE3(np.broadcast_to(pose.rotation, (*batch, 3, 3)), np.broadcast_to(pose.translation, (*batch, 3)))


def broadcast_motion(motion: Motion, *inputs: Input) -> Motion:
    """`motion` with the batch axes of `inputs`, also where it does not depend on them.

    Args:
        motion: A twist or acceleration, whose batch axes are among those of `inputs`.
        *inputs: Arrays (..., n), forces on the bodies, or None.

    Returns:
        The motion with all batch axes; `motion` itself where an input holds symbols.
    """
    arrays = list(_arrays(inputs))
    if is_symbolic(*arrays):
        return motion
    batch = _batch(arrays)
    return Motion(np.broadcast_to(motion.linear, (*batch, 3)), np.broadcast_to(motion.angular, (*batch, 3)))


def add_column(matrix: Array, k: int, vector: Motion | Force) -> None:
    """Adds a spatial vector to a column of a matrix, in place.

    Args:
        matrix: What is added to, shape (..., 6, n).
        k: The column.
        vector: A twist or wrench; its linear part is added to the upper three rows.
    """
    matrix[..., :3, k] += vector.linear
    matrix[..., 3:, k] += vector.angular


def _arrays(inputs: Sequence[Any]) -> Iterator[Array]:
    for value in inputs:
        if isinstance(value, (list, tuple)) and all(
            part is None or isinstance(part, Force) for part in value
        ):
            for force in value:
                if force is not None:
                    yield from (force.linear, force.angular)
        elif value is not None:
            yield np.asarray(value)


def _batch(arrays: Sequence[Array]) -> tuple[int, ...]:
    return np.broadcast_shapes(*(np.shape(x)[:-1] for x in arrays))
