"""A search of inverse kinematics as a function that one thread of a GPU evaluates: one goal, all settings constant."""

from __future__ import annotations

import inspect
from collections.abc import Mapping, Sequence
from functools import reduce
from typing import Any

import numpy as np

from ulna import numeric
from ulna.compiler import Function, element_of, trace
from ulna.compiler.runtime.cuda_kernel import CudaKernel
from ulna.errors import InputError, UnknownName
from ulna.ik.arguments import check_tolerances, default_start, named_goals, problem_of, shift_of
from ulna.ik.search import multi_start
from ulna.ik.solve import search_settings
from ulna.model import Model


def thread_search(
    model: Model,
    *,
    frame: Any = None,
    mask: Any = None,
    joints: Sequence[str] | None = None,
    near: bool = False,
    position_tolerance: float = 1e-6,
    rotation_tolerance: float = 1e-6,
    attempts: int = 400,
    seed: int = 0,
) -> Function:
    """The search of `robot.ik` for one goal in one lane, of the goals `T`, or of `T` and `q0`.

    Args:
        model: The robot.
        frame: Name of the frame that is to meet the goal, or several; None for the tool.
        mask: What counts of the goal, as for `robot.ik`.
        joints: Names of the joints that may move; None for all.
        near: Whether a second input `q0` (nq,) [rad or m] says where the search sets out, and the nearest solution met
            there counts; else it starts from the configuration that `robot.ik` does, and the first one counts.
        position_tolerance: Largest distance from the goal [m].
        rotation_tolerance: Largest angle from the goal [rad].
        attempts: About how many starting points are tried.
        seed: Which starting points, 0 or more.

    Returns:
        A function of T, (4, 4) or (k, 4, 4) for k frames. Its outputs: q (nq,), whether it meets the goals (1 or 0),
        steps, and the largest errors of position [m] and rotation [rad].

    Raises:
        UnknownName: For an unknown frame or joint.
        InputError: If an argument means nothing.
    """
    _, frames, masks = named_goals(np.eye(4), frame, mask, model.tool)
    problem = problem_of(model, frames, masks, None if joints is None else tuple(joints))
    search, nq, count = multi_start(problem, 1), model.nq, len(frames)
    home = default_start(problem)
    shift = shift_of(seed, problem)
    settings = search_settings(position_tolerance, rotation_tolerance, attempts, not near, 1)

    def ik(T: Any, q0: Any = home) -> Any:
        """Inverse kinematics: configuration, whether it meets the goals, steps, errors of position and rotation."""
        solution = search(T, q0, shift, settings)
        position, rotation = (reduce(numeric.maximum, solution[nq + 3 + k :: 2]) for k in (0, 1))
        return solution[:nq], solution[nq], solution[nq + 1], position, rotation

    shapes: dict[str, Any] = {"T": (4, 4) if count == 1 else (count, 4, 4)}
    if near:
        shapes["q0"] = (nq,)
    return trace(ik, name="ik", **shapes)


def search_kernel(model: Model, dtype: Any, options: Mapping[str, Any]) -> CudaKernel:
    """The search as a kernel for NVIDIA GPUs.

    Args:
        model: The robot.
        dtype: float64 or float32.
        options: Those of `thread_search`. Tolerances that are not among them are 1e-6, in float32 1e-4.

    Returns:
        The kernel.

    Raises:
        UnknownName: For an unknown option; names the nearest.
        InputError: If a tolerance is below what float32 can meet.
        DtypeError: If `dtype` is neither float64 nor float32.
    """
    known = list(inspect.signature(thread_search).parameters)[1:]
    for key in options:
        if key not in known:
            raise UnknownName("option of kernel 'ik'", key, known)
    if element_of(dtype) == np.float32:
        options = _single_precision(options)
    return CudaKernel(thread_search(model, **options), dtype)


_TOLERANCE_32, _LEAST_TOLERANCE_32 = 1e-4, 1e-5  # [m] and [rad]


def _single_precision(options: Mapping[str, Any]) -> dict[str, Any]:
    """Options with tolerances that float32 can meet."""
    chosen = dict.fromkeys(("position_tolerance", "rotation_tolerance"), _TOLERANCE_32) | dict(options)
    check_tolerances(chosen["position_tolerance"], chosen["rotation_tolerance"])
    for name in ("position_tolerance", "rotation_tolerance"):
        if chosen[name] < _LEAST_TOLERANCE_32:
            raise InputError(
                f"`{name}` is {chosen[name]!r}; expected at least {_LEAST_TOLERANCE_32:g} with dtype float32, whose "
                "rounding errors are that large. Choose dtype=numpy.float64."
            )
    return chosen
