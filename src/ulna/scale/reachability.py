"""Reachability maps: by voxel, directions of approach, manipulability, and numbers of solutions of a frame.

Source: Zacharias, Borst & Hirzinger, Capturing robot workspace structure: representing robot capabilities (2007), for
the part of directions; Yoshikawa, Manipulability of robotic mechanisms (1985). The samples are configurations, uniform
within the joint limits, whose poses follow by forward kinematics.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, final

import numpy as np

from ulna.checks.values import number
from ulna.errors import InputError
from ulna.loading import load
from ulna.robot import Robot, compile
from ulna.scale import archive
from ulna.scale.engine import run_with
from ulna.scale.grid import DIRECTIONS, Grid, bits, direction_numbers
from ulna.scale.job import SampledJob, Samples, State, whole_number
from ulna.scale.reach_map import ReachMap
from ulna.system.cached import cached_property
from ulna.typing import ArrayLike

_ROWS = 16_384  # configurations at a time: their poses fit the second cache
_BOUNDS_SAMPLES = 100_000  # that determine the bounds of the grid
_MARGIN = 0.1  # that is added to them on each side, as a part of the largest edge
_MAX_VOXELS = 4_000_000  # voxels: a worker has DIRECTIONS bytes for each
_SOLUTION_ROWS = 2_000


def reach(
    robot: Robot | str,
    samples: float = 1e7,
    *,
    voxel: float = 0.05,
    frame: str | None = None,
    solutions: float = 0,
    bounds: ArrayLike | None = None,
    seed: int = 0,
    chunk: int = 1_000_000,
    to: Any = None,
    **options: Any,
) -> ReachMap:
    """A reachability map, from random configurations of the robot.

    Args:
        robot: The robot, or its name.
        samples: How many configurations; 1e8 is fine [-].
        voxel: The edge of a voxel [m].
        frame: Name of the frame; None for the tool.
        solutions: For how many of the samples all solutions of inverse kinematics are counted, by `robot.ik_all` [-].
        bounds: Lowest and highest corner of the map, (2, 3) [m]; None for what the robot reaches.
        seed: Of the random configurations: the same seed, the same map, whatever the number of workers.
        chunk: How many samples are one task.
        to: Where the map is written, as a Zarr group; the job can be continued. None for nowhere.
        **options: Of `ulna.scale.run`: scheduler, workers, progress, retries, patience.

    Returns:
        The map.

    Raises:
        InputError: If an argument makes no sense, or `to` holds another job.
        JobStopped: If the job ended before all was done.

    Example:
        >>> reached = ulna.scale.reach("panda", 20_000, voxel=0.1, workers=0, progress=False)
        >>> int(reached.count.sum())
        20000
    """
    robot = load(robot) if isinstance(robot, str) else robot
    size = number("voxel", voxel, "a length above zero [m]", above=0.0)
    chosen = robot.tool if frame is None else frame
    robot.model.frame(chosen)
    plan = Samples(
        whole_number("samples", samples), whole_number("chunk", chunk), whole_number("seed", seed, 0)
    )
    branches = whole_number("solutions", solutions, 0)
    grid = _grid(robot, chosen, size, bounds)
    if branches > plan.count:
        raise InputError(f"`solutions` is {branches}, more than the {plan.count} samples.")
    return run_with(options, Reach(robot, chosen, plan, grid, branches), archive.named(to))


def _grid(robot: Robot, frame: str, voxel: float, bounds: ArrayLike | None) -> Grid:
    if bounds is None:
        q = robot.random_configuration(_BOUNDS_SAMPLES, seed=0)
        points = robot.fk(q, frame)[:, :3, 3]
        low, high = points.min(axis=0), points.max(axis=0)
        margin = _MARGIN * (high - low).max()
        low, high = low - margin, high + margin
    else:
        low, high = corners = np.asarray(bounds, dtype=float)
        if corners.shape != (2, 3) or not (np.isfinite(corners).all() and (low < high).all()):
            raise InputError(f"`bounds` is {bounds!r}; expected the lowest and highest corner, (2, 3) [m].")
    grid = Grid.around(low, high, voxel)
    if grid.size > _MAX_VOXELS:
        raise InputError(
            f"Voxels of {voxel} m would be {grid.size:,}; expected at most {_MAX_VOXELS:,}. Make them larger, or give "
            "`bounds` and map one region after the other."
        )
    return grid


@final
@dataclass(frozen=True, eq=False)
class Reach(SampledJob):
    """The job of a reachability map.

    Attributes:
        robot: The robot.
        frame: The frame.
        samples: The samples.
        grid: The voxels.
        solutions: For how many samples solutions are counted.
    """

    kind: ClassVar[str] = "reach"
    robot: Robot
    frame: str
    samples: Samples
    grid: Grid
    solutions: int

    def description(self) -> dict[str, Any]:
        """All that the results depend on."""
        return {
            **self.subject(),
            "frame": self.frame,
            "samples": self.samples.count,
            "chunk": self.samples.chunk,
            "seed": self.samples.seed,
            "origin": self.grid.origin.tolist(),
            "voxel": self.grid.voxel,
            "shape": list(self.grid.shape),
            "solutions": self.solutions,
        }

    def start(self) -> State:
        """The empty map."""
        n = self.grid.size
        counts = ("count", "branches", "solved")
        return {
            **{name: np.zeros(n, np.int64) for name in counts},
            "directions": np.zeros(n, np.uint64),
            "best": np.zeros(n),
            "sum": np.zeros(n),
            "outside": np.zeros(1, np.int64),
        }

    @cached_property
    def _kernel(self) -> Any:
        robot, frame = self.robot, self.frame

        def sample(q: Any) -> Any:
            T = robot.fk(q, frame)
            return T[:3, 3], T[:3, 2], robot.manipulability(q, frame=frame)

        return compile(sample, robot)

    def work(self, part: int) -> State:
        """The numbers of the voxels that the samples of a part reach, and what the poses there say."""
        rng, n, rows = self.samples.generator(part), self.grid.size, self.samples.size(part)
        voxels, directions = np.empty(rows, np.int64), np.empty(rows, np.int64)
        measures, inside = np.empty(rows), np.empty(rows, dtype=bool)
        for start in range(0, rows, _ROWS):
            here = slice(start, min(start + _ROWS, rows))
            q = self.robot.random_configuration(here.stop - start, rng)
            points, axes, measures[here] = self._kernel(q)
            voxels[here], inside[here] = self.grid.numbers(points)
            directions[here] = direction_numbers(axes)
        if not inside.all():
            voxels, directions, measures = voxels[inside], directions[inside], measures[inside]
        count = np.bincount(voxels, minlength=n)
        at = np.flatnonzero(count)
        result = {"at": at, "count": count[at], "outside": np.array([rows - len(voxels)])}
        result["sum"] = np.bincount(voxels, weights=measures, minlength=n)[at]
        best = np.zeros(n)
        np.maximum.at(best, voxels, measures)
        result["best"] = best[at]
        hit = np.zeros((n, DIRECTIONS), dtype=bool)
        hit.reshape(-1)[voxels * DIRECTIONS + directions] = True
        result["directions"] = bits(hit[at])
        return result | self._branches(part, rng)

    def _branches(self, part: int, rng: np.random.Generator) -> State:
        """How many solutions further samples of a part have, by voxel."""
        first = part * self.solutions // self.parts
        remaining = (part + 1) * self.solutions // self.parts - first
        voxels, counts = [np.zeros(0, np.int64)], [np.zeros(0, np.int64)]
        while remaining:
            rows = min(remaining, _SOLUTION_ROWS)
            T = self.robot.fk(self.robot.random_configuration(rows, rng), self.frame)
            here, inside = self.grid.numbers(T[:, :3, 3])
            voxels.append(here[inside])
            counts.append(self.robot.ik_all(T[inside], frame=self.frame).count)
            remaining -= rows
        return {"solved_at": np.concatenate(voxels), "solutions": np.concatenate(counts)}

    def fold(self, state: State, part: int, result: State) -> None:
        """Adds the voxels of a part."""
        at = result["at"]
        state["count"][at] += result["count"]
        state["sum"][at] += result["sum"]
        state["best"][at] = np.maximum(state["best"][at], result["best"])
        state["directions"][at] |= result["directions"]
        state["outside"] += result["outside"]
        np.add.at(state["branches"], result["solved_at"], result["solutions"])
        np.add.at(state["solved"], result["solved_at"], 1)

    def existing(self, to: Path) -> ReachMap:
        """The map in `to`."""
        archive.check(to, self.description())
        return ReachMap.load(to, self.robot)

    def finish(self, state: State, to: Path | None) -> ReachMap:
        """The map, written to `to`."""
        reach_map = ReachMap.of(self.grid, state, self.description(), self.robot)
        if to is not None:
            reach_map.save(to)
        return reach_map
