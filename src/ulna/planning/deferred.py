"""Many plans at once: problems in arrays of Dask or xarray, planned block by block when asked for."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np

from ulna.errors import InputError
from ulna.lazy import Slot, apply, is_deferred


def plans(planner: Any, q0: Any, goal: Any, options: Mapping[str, Any]) -> Any:
    """A plan for each start and goal of lazy or labelled arrays.

    Args:
        planner: The planner; it can be pickled.
        q0: Starts, (..., nq) [rad or m].
        goal: Goals, (..., nq) or (..., 4, 4) in a lazy array, which broadcast with the starts; anything else is the
            goal of every plan, as `plan` takes it.
        options: Of `Planner.plan`.

    Returns:
        `Plan`s, an array of objects (...).

    Raises:
        InputError: If lazy goals are neither configurations nor poses.
    """
    model = planner.model
    values, inputs = [q0], [Slot("q0", (model.nq,), labels=model.position_names)]
    shared = goal
    if is_deferred(goal):
        shape = np.shape(goal)
        is_pose = shape[-2:] == (4, 4)
        if not is_pose and shape[-1:] != (model.nq,):
            raise InputError(
                f"`goal` is lazy, with shape {shape}; expected configurations (..., {model.nq}) or poses (..., 4, 4)."
            )
        labels = None if is_pose else model.position_names
        values.append(goal)
        inputs.append(Slot("goal", (4, 4) if is_pose else (model.nq,), labels=labels))
        shared = None
    run = partial(_planned, planner, shared, dict(options))
    return apply(run, values, inputs, [Slot("plan", (), object)])


def _planned(planner: Any, shared: Any, options: Mapping[str, Any], q0: Any, *goals: Any) -> Any:
    """The plans of a block of problems."""
    nq = planner.model.nq
    if not goals:
        batch = q0.shape[:-1]
        problems = [(start, shared) for start in q0.reshape(-1, nq)]
    else:
        core = goals[0].shape[-2:] if goals[0].shape[-2:] == (4, 4) else (nq,)
        batch = np.broadcast_shapes(q0.shape[:-1], goals[0].shape[: goals[0].ndim - len(core)])
        starts = np.broadcast_to(q0, (*batch, nq)).reshape(-1, nq)
        ends = np.broadcast_to(goals[0], (*batch, *core)).reshape(-1, *core)
        problems = list(zip(starts, ends, strict=True))
    out = np.empty(len(problems), dtype=object)
    for number, (start, goal) in enumerate(problems):
        out[number] = planner.plan(start, goal, **options)
    return out.reshape(batch)
