"""Sweeps over models: how a quantity changes with masses, placements, payloads and states."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ulna import kernels
from ulna.errors import InputError, UnknownName
from ulna.loading import load
from ulna.robot import Robot
from ulna.scale import archive
from ulna.scale.engine import run_with
from ulna.scale.factors import STATES, Factors
from ulna.scale.job import Samples, whole_number
from ulna.scale.sweep_job import Sweeping
from ulna.scale.sweep_result import Sweep

_MAX_GRID_POINTS = 1e12  # points of a grid


def sweep(
    robot: Robot | str,
    quantity: str,
    vary: Mapping[str, Any],
    samples: float | None = None,
    *,
    levels: int | None = None,
    at: Mapping[str, Any] | None = None,
    settings: Mapping[str, Any] | None = None,
    seed: int = 0,
    chunk: int = 100_000,
    to: Any = None,
    **options: Any,
) -> Sweep:
    """A quantity over models and states drawn within ranges, or on a grid: statistics, sensitivities, worst cases.

    The numbers that vary are inputs of one kernel (see docs/parameters.md); nothing is compiled for each model.

    Args:
        robot: The robot, or its name.
        quantity: The name of its kernel, such as "inverse_dynamics" or "fk".
        vary: What varies, by name. The model: "mass" (each body's mass and inertia, times a factor, of 1 in the
            model), "payload" (a point mass at the tool: kg, then its place in the tool's frame [m]; a range of numbers
            is that of the mass), and the parameters of kernels, such as "placement", "shift", "offset", "gravity" or
            "damping". The state: "q", "v", "a", "tau". A range is a pair (low, high) of numbers or arrays, or a number
            or array: by how much the values may be off to either side.
        samples: How many models and states are drawn, uniformly [-]; None for a million, or for a grid.
        levels: Instead of random ones, all combinations of so many values for each factor, low and high ends included.
        at: The state where it does not vary: "q" (nq,), "v", "a", "tau" (nv,); zero velocities, accelerations and
            torques, and the neutral configuration, where they are not passed.
        settings: Options of the kernel, such as {"frame": "panda_hand"}.
        seed: Of what is drawn: the same seed, the same result, whatever the number of workers.
        chunk: How many samples are one part.
        to: Where the result is written, as a Zarr group; the job can be continued. None for nowhere.
        **options: Of `ulna.scale.run`: scheduler, workers, progress, retries, patience.

    Returns:
        The result.

    Raises:
        InputError: If an argument makes no sense, or `to` holds another job.
        UnknownName: If there is no such quantity, parameter or state.
        ShapeError: If a range or a state has a wrong shape.
        JobStopped: If the job ended before all was done.
    """
    robot = load(robot) if isinstance(robot, str) else robot
    factors = Factors.of(robot.model, vary, _states(robot, quantity, vary, dict(at or {})))
    count = (
        _grid(len(factors.low), levels, samples)
        if levels is not None
        else 10**6
        if samples is None
        else samples
    )
    plan = Samples(
        whole_number("samples", count), whole_number("chunk", chunk), whole_number("seed", seed, 0)
    )
    job = Sweeping(robot, quantity, dict(settings or {}), factors, plan, levels or 0)
    return run_with(options, job, archive.named(to))


def _states(robot: Robot, quantity: str, vary: Mapping[str, Any], at: dict[str, Any]) -> dict[str, Any]:
    """The arrays that a quantity takes, by name."""
    if quantity not in kernels.QUANTITIES:
        raise UnknownName("kernel", quantity, sorted(kernels.QUANTITIES))
    needed = kernels.QUANTITIES[quantity].arrays
    if not set(needed) <= set(STATES):
        raise InputError(f"{quantity!r} takes {', '.join(needed)}; a sweep has {', '.join(STATES)} only.")
    for name in (*at, *(name for name in vary if name in STATES)):
        if name not in needed:
            raise UnknownName(f"argument of {quantity!r}", name, needed)
    zeros = np.zeros(robot.model.nv)
    return {name: at.get(name, robot.neutral if name == "q" else zeros) for name in needed}


def _grid(factors: int, levels: int, samples: float | None) -> int:
    """How many points a grid has."""
    if samples is not None:
        raise InputError("`samples` is given beside `levels`; a grid has all combinations. Leave one out.")
    whole = whole_number("levels", levels, 2)
    if float(whole) ** factors > _MAX_GRID_POINTS:
        raise InputError(
            f"A grid of {whole} levels of {factors} factors has {float(whole) ** factors:.1g} points; expected at most "
            f"{_MAX_GRID_POINTS:.0g}. Vary less, or draw `samples`."
        )
    return whole**factors
