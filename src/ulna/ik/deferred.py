"""Inverse kinematics of goals in arrays of Dask or xarray: blocks of goals are solved when they are asked for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from ulna.errors import InputError
from ulna.ik.problem import Problem
from ulna.lazy import Slot, apply, is_deferred
from ulna.typing import Floats


def goals_of_frames(T: Mapping[Any, Any]) -> Any:
    """The goals of several frames as one lazy array.

    Args:
        T: Poses (..., 4, 4) by frame, of Dask or NumPy.

    Returns:
        Poses (..., k, 4, 4).

    Raises:
        InputError: If one of them is an array of xarray, or no pose.
    """
    import dask.array as da  # pyright: ignore[reportMissingImports]

    for name, pose in T.items():
        if np.shape(pose)[-2:] != (4, 4) or (is_deferred(pose) and not isinstance(pose, da.Array)):
            raise InputError(
                f"`T[{name!r}]` is a {type(pose).__name__} of shape {np.shape(pose)}; expected poses (..., 4, 4) of "
                "Dask or NumPy where one of the goals is lazy."
            )
    return da.stack(da.broadcast_arrays(*map(da.asarray, T.values())), axis=-3)


def solve(solver: Any, problem: Problem, T: Any, q0: Any, options: Sequence[Any]) -> Any:
    """What an `IKSolution` is made of, for goals that are lazy or labelled.

    Args:
        solver: Called as `solver(T, q0, *options)`; it can be pickled.
        problem: Its problem.
        T: Goals, (..., 4, 4), or what the problem's masks allow.
        q0: Where to start, (..., nq); None for the default.
        options: Further arguments of the solver.

    Returns:
        q, status, steps, starting point and errors, (..., n).
    """
    model = problem.model
    inputs = [Slot("T", _goal_shape(np.shape(T), problem))]
    values = [T]
    if q0 is not None:
        inputs.append(Slot("q0", (model.nq,), labels=model.position_names))
        values.append(q0)
    run = partial(_raw, solver, tuple(options))
    return apply(run, values, inputs, [Slot("solution", (model.nq + 3 + 2 * len(problem.frames),))])


def _raw(solver: Any, options: tuple[Any, ...], T: Any, q0: Any = None) -> Any:
    return solver(T, q0, *options)._raw


def _goal_shape(shape: tuple[int, ...], problem: Problem) -> tuple[int, ...]:
    """The last axes of goals: of poses, or of points or rotations where nothing else counts."""
    core = problem.shapes["T"]
    turns = {mask.axis is not None or any(mask.rotation) for mask in problem.masks}
    moves = {any(mask.position) for mask in problem.masks}
    allowed = [core]
    if turns == {False}:
        allowed.append((*core[:-2], 3))
    if moves == {False}:
        allowed.append((*core[:-2], 3, 3))
    fitting = [s for s in allowed if len(shape) >= len(s) and shape[len(shape) - len(s) :] == s]
    return fitting[0] if fitting else core


def branches(
    ask: Any, T: Any, q0: Any, nq: int, labels: Sequence[str], most: int
) -> tuple[Any, Any, Any, Any, Any, Any]:
    """All solutions for poses that are lazy or labelled, each with as many rows as there can be solutions.

    Args:
        ask: `ask(T, q0)` returns the `Branches` of a block of poses; it can be pickled.
        T: The poses, (..., 4, 4).
        q0: Configurations, (..., nq); None for none.
        nq: How many numbers a configuration has.
        labels: Their names.
        most: The largest number of solutions of a pose.

    Returns:
        q (..., most, nq), both errors (..., most), total (...), miss (..., 2), and whether these are all (...).
    """
    values, inputs = [T], [Slot("T", (4, 4))]
    if q0 is not None:
        values.append(q0)
        inputs.append(Slot("q0", (nq,), labels=labels))
    errors = [Slot(name, (most,)) for name in ("position_error", "rotation_error")]
    outputs = [Slot("q", (most, nq)), *errors, Slot("total", (), np.int64), Slot("miss", (2,))]
    outputs.append(Slot("complete", (), np.bool_))
    return apply(partial(_padded, ask, most), values, inputs, outputs, is_single=False)


def _padded(ask: Any, most: int, T: Floats, q0: Any = None) -> tuple[Any, ...]:
    branches_found = ask(T, q0)
    short = most - branches_found.q.shape[-2]
    rows = [(0, 0)] * (branches_found.q.ndim - 2)
    q = np.pad(branches_found.q, [*rows, (0, short), (0, 0)], constant_values=np.nan)
    errors = [
        np.pad(e, [*rows, (0, short)], constant_values=np.nan)
        for e in (branches_found.position_error, branches_found.rotation_error)
    ]
    total = np.asarray(branches_found.total, dtype=np.int64)
    return q, *errors, total, np.asarray(branches_found.miss), np.full(total.shape, branches_found.complete)
