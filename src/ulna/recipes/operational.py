"""Recipes of the operational space: inertia, Coriolis matrix, gravity and acceleration of a frame."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ulna import algorithms
from ulna.model import Model
from ulna.recipes.base import IN_FRAME, QV, QVTAU, Q, Recipe, frame_of
from ulna.recipes.mass import with_mass

_TASK = {**IN_FRAME, "representation": None, "damping": 0.0}


def _of_task(function: Callable[..., Any]) -> Callable[..., Callable[..., Any]]:
    def build(model: Model, frame: Any, **options: Any) -> Callable[..., Any]:
        task = algorithms.Task(frame_of(model, frame), **options)
        return lambda *arrays: function(model, *arrays, task)

    return build


RECIPES: dict[str, Recipe] = {
    "operational_inertia": Recipe(
        with_mass(_of_task(algorithms.operational_inertia)), Q, _TASK, "Inertia that a frame feels, (6, 6)."
    ),
    "operational_coriolis": Recipe(
        with_mass(_of_task(algorithms.operational_coriolis)), QV, _TASK, "Coriolis matrix of a frame, (6, 6)."
    ),
    "operational_gravity": Recipe(
        with_mass(_of_task(algorithms.operational_gravity)),
        Q,
        _TASK,
        "Gravity that a frame feels, (6,) [N, N m].",
    ),
    "operational_acceleration": Recipe(
        with_mass(_of_task(algorithms.operational_acceleration)),
        QVTAU,
        _TASK,
        "How a frame accelerates under joint torques, (6,).",
    ),
}
