"""Many planning problems of one robot, in one world or in many, each with its own seed."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from ulna.checks.arrays import finite_array
from ulna.checks.values import short_repr
from ulna.collision import World
from ulna.errors import InputError, ShapeError
from ulna.loading import load
from ulna.robot import Robot
from ulna.scale import archive
from ulna.scale.engine import run_with
from ulna.scale.job import Samples, whole_number
from ulna.scale.plan_job import Plans
from ulna.scale.plan_set import PlanSet
from ulna.typing import ArrayLike, Floats


def plans(
    robot: Robot | str,
    problems: float | None = None,
    world: World | Sequence[World] | None = None,
    *,
    starts: ArrayLike | None = None,
    goals: ArrayLike | None = None,
    frame: str | None = None,
    margin: float = 0.0,
    step: float = 0.01,
    longest: float = 1.0,
    shorten: int = 5,
    improve: int = 0,
    iterations: int = 100_000,
    timeout: float = np.inf,
    seed: int = 0,
    chunk: int = 100,
    to: Any = None,
    **options: Any,
) -> PlanSet:
    """A path for each of many problems: between random configurations that touch nothing, or between your own.

    Args:
        robot: The robot, or its name.
        problems: How many random problems; None where `starts` and `goals` say what to plan [-].
        world: Obstacles; None for none. Of several worlds, each has equally many problems: problem i of n lies in
            world i k // n of k.
        starts: Where the robot is, (n, nq), or (nq,) for all problems [rad, m].
        goals: A configuration (n, nq) or a pose (n, 4, 4) for each start, or one for all [rad, m].
        frame: Whose pose the goals are; None for the tool.
        margin: As for `ulna.planning.plan` [m].
        step: Likewise [m].
        longest: Likewise [rad, m].
        shorten: Likewise.
        improve: Likewise.
        iterations: The most samples for the first path of a problem.
        timeout: The longest time for a problem [s]; with a limit of time, the plans depend on the machine.
        seed: Of the problems and of their searches: the same seed, the same plans, whatever the number of workers.
        chunk: How many problems are one part.
        to: Where the plans are written, as a Zarr group; the job can be continued. None for nowhere.
        **options: Of `ulna.scale.run`: scheduler, workers, progress, retries, patience.

    Returns:
        The plans.

    Raises:
        InputError: If an argument makes no sense, or `to` holds another job.
        ShapeError: If `starts` or `goals` has a wrong shape.
        ModelError: If the robot has no collision geometry.
        JobStopped: If the job ended before all was done.
    """
    robot = load(robot) if isinstance(robot, str) else robot
    count, q0, ends = _problems(robot, problems, starts, goals)
    worlds = _worlds(world, count)
    samples = Samples(count, whole_number("chunk", chunk), whole_number("seed", seed, 0))
    lengths = {"margin": margin, "step": step, "longest": longest}
    searching = {"shorten": shorten, "improve": whole_number("improve", improve, 0)}
    searching |= {"iterations": iterations, "timeout": timeout}
    job = Plans(robot, samples, q0, ends, worlds, len(worlds), frame, lengths, searching)
    return run_with(options, job, archive.named(to))


def _problems(
    robot: Robot, problems: float | None, starts: Any, goals: Any
) -> tuple[int, Floats | None, Floats | None]:
    """How many problems there are, with a start and a goal for each; None where they are drawn."""
    if problems is not None:
        if starts is not None or goals is not None:
            raise InputError("`problems` is given beside `starts` or `goals`; leave it out, or both of them.")
        return whole_number("problems", problems), None, None
    if starts is None or goals is None:
        raise InputError("Expected `problems`, how many random ones, or `starts` and `goals`.")
    nq = robot.model.nq
    q0, ends = finite_array("starts", starts), finite_array("goals", goals)
    if q0.ndim not in (1, 2) or q0.shape[-1] != nq:
        raise ShapeError("starts", q0.shape, f"(n, {nq}) or ({nq},)")
    is_pose = ends.shape[-2:] == (4, 4) and not (nq == 4 and ends.ndim == 2)
    core = (4, 4) if is_pose else (nq,)
    if ends.shape[-len(core) :] != core or ends.ndim - len(core) not in (0, 1):
        raise ShapeError("goals", ends.shape, f"configurations (n, {nq}) or poses (n, 4, 4), or one of them")
    lengths = {*q0.shape[:-1], *ends.shape[: ends.ndim - len(core)]}
    if len(lengths) > 1 or lengths == {0}:
        raise ShapeError("goals", ends.shape, f"as many as `starts` {q0.shape}")
    n = max(lengths, default=1)
    return n, np.array(np.broadcast_to(q0, (n, nq))), np.array(np.broadcast_to(ends, (n, *core)))


def _worlds(world: Any, problems: int) -> tuple[World | None, ...]:
    is_one = isinstance(world, World | str) or not isinstance(world, Iterable)
    worlds: tuple[Any, ...] = (world,) if is_one else tuple(world)
    for item in worlds:
        if item is not None and not isinstance(item, World):
            raise InputError(f"`world` is {short_repr(item)}; expected a World, several, or None.")
    if not worlds or len(worlds) > problems:
        raise InputError(
            f"There are {len(worlds)} worlds for {problems} problems; expected from 1 to {problems}."
        )
    return worlds
