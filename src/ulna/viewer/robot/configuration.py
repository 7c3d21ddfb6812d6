"""Configurations of robots as users pass them: arrays, or the names of configurations."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ulna.checks.arrays import finite_array
from ulna.checks.labels import in_order
from ulna.checks.values import one_of
from ulna.errors import ShapeError
from ulna.typing import ArrayLike, Floats

_FLOAT = np.dtype(float)


def configuration(robot: Any, q: ArrayLike | str | None) -> Floats:
    """A configuration from an array or a name.

    Args:
        robot: The robot.
        q: Configuration (nq,) [rad or m], a name in `robot.configurations`, or None for the first of "qr",
            "ready", "home" and all names that exists, else neutral.

    Returns:
        A copy, shape (nq,) [rad or m].

    Raises:
        UnknownName: The robot has no configuration of that name.
        ShapeError, NonFiniteError: The array does not fit.
    """
    named = dict(robot.configurations)
    if q is None:
        usual = next((named[n] for n in ("qr", "ready", "home", *named) if n in named), None)
        return np.array(robot.model.neutral if usual is None else usual, dtype=float)
    if isinstance(q, str):
        return np.array(named[one_of("configuration", q, named)], dtype=float)
    return checked_configuration(robot, q)


def checked_configuration(robot: Any, q: ArrayLike) -> Floats:
    """A checked copy of a configuration.

    Args:
        robot: The robot.
        q: Configuration (nq,) [rad or m].

    Returns:
        The copy, (nq,) [rad or m].

    Raises:
        ShapeError: Another shape.
        NonFiniteError: nan or inf.
        InputError: Its labels are not the joints' names.
    """
    count = robot.model.nq
    if type(q) is np.ndarray and q.dtype is _FLOAT and q.shape == (count,):  # as a loop hands it over
        out = q.copy()
        if math.isfinite(math.hypot(*out.tolist())):
            return out
    out = finite_array("q", in_order("q", q, robot.model.position_names), f"{count} numbers")
    if out.shape != (count,):
        names = ", ".join(robot.joint_names[:8])
        raise ShapeError("q", out.shape, f"({count},)", f"One number for each of: {names}.")
    return out
