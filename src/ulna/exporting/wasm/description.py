"""What the JavaScript module knows of the functions and the robot, as JSON."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ulna.compiler import Function
from ulna.exporting.record import Argument, Export, ExportedFunction, ExportedSearch
from ulna.exporting.wasm.code import LANES
from ulna.ik.goal import ANY_CHORD, ANY_LENGTH
from ulna.ik.search import ATTEMPT_STEPS, MEAN_STEPS
from ulna.model import Model


def description(
    export: Export, functions: Mapping[str, Function], places: Mapping[str, list[int]]
) -> dict[str, Any]:
    """The description, of values that JSON has; None stands for no limit.

    Args:
        export: What is exported.
        functions: All functions by name, from `code.traced`.
        places: Where their arguments and results lie, from `code.places` [byte].

    Returns:
        The description.
    """
    model = export.model
    return {
        "name": export.name,
        "dtype": export.dtype.name,
        "robot": None if model is None else _robot(model),
        "functions": {f.name: _function(f, model, places[f.name]) for f in export.functions},
        "searches": {s.name: _search(s, places[s.name]) for s in export.searches},
        "limits": {"length": ANY_LENGTH, "chord": ANY_CHORD},
    }


def _robot(model: Model) -> dict[str, Any]:
    moving = [joint for joint in model.joints if joint.nq and joint.mimic is None]
    return {
        "name": model.name,
        "nq": model.nq,
        "nv": model.nv,
        "joints": [
            {
                "name": j.name,
                "q": j.idx_q,
                "nq": j.nq,
                "v": j.idx_v,
                "nv": j.nv,
                "kind": type(j.kind).__name__,
            }
            for j in moving
        ],
        "lowerPosition": _limits(model.lower_position),
        "upperPosition": _limits(model.upper_position),
        "neutral": model.neutral.tolist(),
    }


def _limits(values: Any) -> list[float | None]:
    return [float(x) if np.isfinite(x) else None for x in values]


def _function(f: ExportedFunction, model: Model | None, at: list[int]) -> dict[str, Any]:
    return {
        "summary": f.summary,
        "choices": dict(f.choices),
        "inputs": [_argument(a, model) for a in f.inputs],
        "outputs": [_argument(a, None) for a in f.outputs],
        "at": at,
    }


def _argument(a: Argument, model: Model | None) -> dict[str, Any]:
    is_configuration = model is not None and a.shape == (model.nq,) and a.name in ("q", "q0", "q1")
    places: Sequence[Sequence[int]] = model.unit_vectors if model is not None and is_configuration else ()
    units = {"unitVectors": [list(p) for p in places]} if places else {}
    return {
        "name": a.name,
        "shape": list(a.shape),
        "size": a.size,
        "unit": a.unit,
        "text": a.text,
        **units,
    }


def _search(s: ExportedSearch, at: list[int]) -> dict[str, Any]:
    shapes, problem = s.problem.shapes, s.problem
    q0 = Argument("q0", shapes["q0"], "rad or m", "Where the search begins")
    return {
        "frames": [frame.name for frame in problem.frames],
        "choices": dict(s.choices),
        "goal": _argument(Argument("T", shapes["T"], "", "The goal: poses in the world [m]"), None),
        "q0": _argument(q0, problem.model),
        "start": s.start.tolist(),
        "shift": s.shift.tolist(),
        "lanes": LANES,
        "meanSteps": MEAN_STEPS,
        "attemptSteps": ATTEMPT_STEPS,
        "at": at,
    }
