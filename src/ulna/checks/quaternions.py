"""Checks of the unit quaternions, and of the cosines and sines of angles, in arrays."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from ulna.checks.arrays import batched_array, shaped_array
from ulna.checks.labels import in_order
from ulna.errors import InputError
from ulna.typing import Array, Floats

UNIT_TOLERANCE = 1e-5
"""How far the squared length of a unit quaternion may be from one."""

_EXPECTED = {4: "a unit quaternion (xyzw)", 2: "cosine and sine of an angle, a unit vector"}

# A tenth below that of the fast call of kernels, so that what the fast call sends here is refused and never sent back.
_TOLERANCE = 0.9 * UNIT_TOLERANCE


def check_unit(name: str, array: Array, parts: Iterable[Sequence[int]]) -> None:
    """Check that parts of arrays are unit quaternions, or cosine and sine of an angle.

    Args:
        name: The name of the argument, for the message.
        array: Numbers, shape (..., n).
        parts: Which entries of the last axis form quaternions, four each, or cosine and sine, two each.

    Raises:
        InputError: One is not of unit length.
    """
    for entries in parts:
        part = array[..., list(entries)]
        squares = (part * part).sum(axis=-1)
        wrong = abs(squares - 1.0) > _TOLERANCE
        if np.any(wrong):
            length = float(np.sqrt(squares[wrong].reshape(-1)[0]))
            raise InputError(
                f"`{name}[..., {entries[0]}:{entries[-1] + 1}]` has length {length:.6g}; expected "
                f"{_EXPECTED[len(entries)]}. robot.configuration_space.normalize(q) makes it one."
            )


def checked_configuration(name: str, q: Any, model: Any) -> Floats:
    """A copy of a configuration of a model.

    Args:
        name: The name of the argument, for the message.
        q: Configuration, shape (nq,) [rad, m].
        model: The model.

    Returns:
        A new array, shape (nq,) [rad, m].

    Raises:
        ShapeError, NonFiniteError, DtypeError: It does not fit the model.
        InputError: A quaternion, or cosine and sine, are not of unit length.
    """
    out = shaped_array(name, q, model.nq, labels=model.position_names)
    check_unit(name, out, model.unit_vectors)
    return out


def checked_configurations(name: str, q: Any, model: Any) -> Array:
    """Configurations of a model as an array, with any leading batch axes.

    Args:
        name: The name of the argument, for the message.
        q: Configurations, shape (..., nq) [rad, m].
        model: The model.

    Returns:
        The array, shape (..., nq) [rad, m].

    Raises:
        ShapeError, NonFiniteError, DtypeError: They do not fit the model.
        InputError: A quaternion, or cosine and sine, are not of unit length.
    """
    out = batched_array(name, in_order(name, q, model.position_names), (model.nq,))
    if out.dtype != object:
        check_unit(name, out, model.unit_vectors)
    return out
