"""A reachability map: what a robot does in each voxel, with pictures."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, final

import numpy as np

from ulna.checks.arrays import batched_array
from ulna.errors import UnknownName
from ulna.robot import Robot
from ulna.scale import archive
from ulna.scale.grid import DIRECTIONS, Grid, count_bits
from ulna.scale.job import State
from ulna.typing import Array, ArrayLike, Floats
from ulna.viewer.viewer import Viewer

Measure = Literal["directions", "manipulability", "mean_manipulability", "solutions", "density"]
_MEASURES = ("directions", "manipulability", "mean_manipulability", "solutions", "density")
_COLOURS = np.array(
    [[0.27, 0.0, 0.33], [0.23, 0.32, 0.55], [0.13, 0.57, 0.55], [0.37, 0.79, 0.38], [0.99, 0.91, 0.14]]
)  # from little to much; dark to light, so that it can be read without colours, too


@final
@dataclass(frozen=True, eq=False)
class ReachMap:
    """What a frame reaches, voxel by voxel; voxels without samples have zeros.

    Attributes:
        grid: The voxels: origin, edge and shape (x, y, z).
        count: How many samples lie in each, (x, y, z).
        directions: The part of all directions that the frame's z axis takes there, from 0 to 1, (x, y, z) [-].
        manipulability: The largest manipulability there [Yoshikawa 1985], (x, y, z).
        mean_manipulability: Its mean, (x, y, z).
        solutions: The mean number of solutions of inverse kinematics, (x, y, z); nan where none was asked for.
        outside: How many samples were outside the grid.
        job: What the map was made of: robot, frame, samples, seed.
        robot: The robot, for pictures; None where it was not kept.
    """

    grid: Grid
    count: Array
    directions: Floats
    manipulability: Floats
    mean_manipulability: Floats
    solutions: Floats
    outside: int
    job: Mapping[str, Any]
    robot: Robot | None = None

    @classmethod
    def of(cls, grid: Grid, state: State, job: Mapping[str, Any], robot: Robot | None) -> ReachMap:
        """The map of the final state of a job.

        Args:
            grid: The voxels.
            state: The final state of the job.
            job: Its description.
            robot: The robot.

        Returns:
            The map.
        """
        count = state["count"]
        some = np.maximum(count, 1)
        solutions = np.full(len(count), np.nan)
        asked = state["solved"] > 0
        solutions[asked] = state["branches"][asked] / state["solved"][asked]
        parts = (
            count,
            count_bits(state["directions"]) / DIRECTIONS,
            state["best"],
            state["sum"] / some,
            solutions,
        )
        counted, directions, best, mean, many = (x.reshape(grid.shape) for x in parts)
        outside = int(state["outside"][0])
        return cls(grid, counted, directions, best, mean, many, outside, dict(job), robot)

    @property
    def volume(self) -> float:
        """The volume of the voxels that are reached [m^3]."""
        return float((self.count > 0).sum()) * self.grid.voxel**3

    def at(self, points: ArrayLike, measure: Measure = "directions") -> Floats:
        """What the map says of points.

        Args:
            points: Points in the world, (..., 3) [m].
            measure: "directions", "manipulability", "mean_manipulability", "solutions", or "density": samples per
                voxel.

        Returns:
            The values of their voxels, (...); 0 outside the grid.

        Raises:
            ShapeError, DtypeError, NonFiniteError: If the points cannot be points.
            UnknownName: If there is no such measure.
        """
        values = self._values(measure).reshape(-1)
        p = batched_array("points", points, (3,))
        numbers, inside = self.grid.numbers(p.reshape(-1, 3))
        out = np.where(inside, values[np.where(inside, numbers, 0)], 0.0)
        return out.reshape(p.shape[:-1])

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the map as a Zarr group.

        Args:
            path: The folder.
        """
        arrays = {name: getattr(self, name) for name in ("count", *_MEASURES[:-1])}
        archive.write(Path(path), arrays, {**self.job, "outside": self.outside})

    @classmethod
    def load(cls, path: str | os.PathLike[str], robot: Robot | None = None) -> ReachMap:
        """Reads a map.

        Args:
            path: The folder.
            robot: The robot, for pictures; None for none.

        Returns:
            The map.

        Raises:
            InputError: If there is none.
        """
        group = archive.opened(path, "reach")
        job = group.attrs.asdict()
        outside = job.pop("outside")
        grid = Grid(np.array(job["origin"]), job["voxel"], tuple(job["shape"]))
        count, directions, best, mean, solutions = (group[name][...] for name in ("count", *_MEASURES[:-1]))
        return cls(grid, count, directions, best, mean, solutions, outside, job, robot)

    def viewer(self, measure: Measure = "directions", section: bool = True, page: bool = False) -> Viewer:
        """A scene with the robot and the voxels that it reaches, light where there is much of a measure.

        Args:
            measure: As for `at`.
            section: Whether the half in front of the robot's x-z plane (y < 0) is left out, so that one looks inside.
            page: Whether it is served as a page.

        Returns:
            The viewer.

        Raises:
            UnknownName: If there is no such measure.
        """
        values = self._values(measure).reshape(-1)
        chosen = np.flatnonzero(self.count.reshape(-1))
        centres = self.grid.centres(chosen)
        if section:
            behind = centres[:, 1] >= 0.0
            chosen, centres = chosen[behind], centres[behind]
        shown = np.nan_to_num(values[chosen])
        top = np.quantile(shown, 0.99) if len(shown) else 1.0
        viewer = Viewer(page=page, title=f"Reach of {self.job['robot']}: {measure.replace('_', ' ')}")
        if self.robot is not None:
            viewer.add(self.robot)
        viewer.points(centres, _coloured(shown / (top or 1.0)), 0.7 * self.grid.voxel, name="reach")
        return viewer

    def picture(
        self, path: str | os.PathLike[str], measure: Measure = "directions", *, section: bool = True
    ) -> Array:
        """Writes a picture of the map.

        Args:
            path: A PNG file.
            measure: As for `at`.
            section: As for `viewer`.

        Returns:
            The picture, (height, width, 3) uint8.

        Raises:
            UnknownName: If there is no such measure.
        """
        return self.viewer(measure, section).picture(path)

    def page(
        self, path: str | os.PathLike[str], measure: Measure = "directions", *, section: bool = True
    ) -> Path:
        """Writes a page of the map that can be turned, and needs no network.

        Args:
            path: An HTML file.
            measure: As for `at`.
            section: As for `viewer`.

        Returns:
            The path of the file.

        Raises:
            UnknownName: If there is no such measure.
            MissingExtra: If viser is not installed.
        """
        return Path(self.viewer(measure, section).html(path))

    def _values(self, measure: str) -> Floats:
        if measure not in _MEASURES:
            raise UnknownName("measure", measure, _MEASURES)
        return self.count.astype(float) if measure == "density" else getattr(self, measure)

    def __repr__(self) -> str:
        job = self.job
        return (
            f"<reach of {job['robot']!r}, {job['frame']!r}: {int((self.count > 0).sum()):,} of {self.grid.size:,} "
            f"voxels of {self.grid.voxel:g} m, {self.volume:.3f} m^3, {job['samples']:,} samples>"
        )


def _coloured(values: Floats) -> Floats:
    """Colours (n, 3) of values from 0 to 1."""
    x = np.clip(values, 0.0, 1.0) * (len(_COLOURS) - 1)
    low = np.minimum(x.astype(int), len(_COLOURS) - 2)
    part = (x - low)[:, None]
    return (1.0 - part) * _COLOURS[low] + part * _COLOURS[low + 1]
