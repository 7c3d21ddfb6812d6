"""Collision questions about configurations in arrays of Dask or xarray, answered block by block when asked for."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np

from ulna.checks.values import short_repr
from ulna.collision.result import Distance
from ulna.errors import InputError
from ulna.lazy import Slot, apply, is_deferred


def is_lazy_question(q: Any, moving: Mapping[str, Any] | None) -> bool:
    """Whether configurations, or poses of moving obstacles, are in arrays of Dask or xarray.

    Args:
        q: Configurations, (..., nq).
        moving: Poses by name, (..., 4, 4).

    Returns:
        True where `ask` is to be called.

    Raises:
        InputError: `moving` is no dictionary.
    """
    if moving is not None and not isinstance(moving, Mapping):
        raise InputError(
            f"`moving` is {short_repr(moving)}; expected a dictionary from names of obstacles to poses (..., 4, 4)."
        )
    return is_deferred(q) or (moving is not None and any(is_deferred(pose) for pose in moving.values()))


def ask(
    checker: Any,
    question: str,
    dtype: Any,
    q: Any,
    moving: Mapping[str, Any] | None,
    options: Mapping[str, Any],
) -> Any:
    """The answers of a checker that are one number for each configuration.

    Args:
        checker: A checker; it can be pickled.
        question: The name of its method.
        dtype: The type of the answers.
        q: Configurations, (..., nq) [rad or m].
        moving: Poses of moving obstacles by name, (..., 4, 4) [m].
        options: Of the method.

    Returns:
        The answers, (...), lazy or labelled.
    """
    values, inputs = _operands(checker, q, moving)
    run = partial(_answer, checker, question, tuple(moving or ()), dict(options))
    return apply(run, values, inputs, [Slot("answer", (), dtype)])


def distances(checker: Any, q: Any, moving: Mapping[str, Any] | None, options: Mapping[str, Any]) -> Distance:
    """The least distances, of which each array is lazy or labelled.

    Args:
        checker: As for `ask`, like all arguments.
        q: Configurations, (..., nq) [rad or m].
        moving: Poses of moving obstacles by name, (..., 4, 4) [m].
        options: Of `checker.distance`.

    Returns:
        The distances.
    """
    values, inputs = _operands(checker, q, moving)
    run = partial(_nearest, checker, tuple(moving or ()), dict(options))
    outputs = [Slot("distance"), Slot("points", (2, 3)), Slot("normal", (3,)), Slot("names", (2,), object)]
    return Distance(*apply(run, values, inputs, outputs, is_single=False))


def _operands(checker: Any, q: Any, moving: Mapping[str, Any] | None) -> tuple[list[Any], list[Slot]]:
    poses = moving or {}
    for name in poses:
        checker.world.moving(name)
    model = checker.model
    inputs = [Slot("q", (model.nq,), labels=model.position_names)]
    inputs += [Slot(f"moving[{name!r}]", (4, 4)) for name in poses]
    return [q, *(T.matrix() if hasattr(T, "matrix") else T for T in poses.values())], inputs


def _answer(checker: Any, question: str, names: tuple[str, ...], options: Any, q: Any, *poses: Any) -> Any:
    return np.asarray(getattr(checker, question)(q, dict(zip(names, poses, strict=True)) or None, **options))


def _nearest(checker: Any, names: tuple[str, ...], options: Any, q: Any, *poses: Any) -> tuple[Any, ...]:
    nearest = checker.distance(q, dict(zip(names, poses, strict=True)) or None, **options)
    return nearest.distance, nearest.points, nearest.normal, nearest.names
