"""Identification from logs that do not fit in memory, in one pass."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar, Literal, final

import numpy as np

from ulna.errors import NonFiniteError
from ulna.identification.blocks import LogFit, Sought, Sums, add, fit_sums, no_rows, sums_of
from ulna.loading import load
from ulna.model.content import fingerprint
from ulna.robot import Robot
from ulna.scale import archive
from ulna.scale.engine import run_with
from ulna.scale.job import SampledJob, Samples, State, whole_number
from ulna.scale.logs import LogSource
from ulna.typing import ArrayLike


def identify(
    robot: Robot | str,
    log: Mapping[str, Any] | str | os.PathLike[str],
    *,
    armature: bool = False,
    damping: bool = False,
    friction: bool = False,
    physical: bool = False,
    prior: ArrayLike | None = None,
    ridge: float | None = None,
    noise: ArrayLike | Literal["auto"] | None = None,
    width: float = 1e-2,
    chunk: int = 50_000,
    to: Any = None,
    **options: Any,
) -> LogFit:
    """The dynamic parameters that explain a log best; as `ulna.identification.identify`, for logs of any length.

    The log is read once, some rows at a time.

    Args:
        robot: The robot, or its name.
        log: Arrays by name: "q" (rows, nq) [rad, m], "v", "a" and "tau" (rows, nv) [rad/s, rad/s^2, N m], of NumPy,
            Zarr or anything of which slices of rows can be read; or a path: of a Zarr group or of a folder with q.npy,
            v.npy, a.npy and tau.npy, on a disk that all workers share, or of an NPZ file, which is read into memory.
        armature: Whether to seek the inertia of the drives.
        damping: Whether to seek viscous friction.
        friction: Whether to seek Coulomb friction.
        physical: Whether the bodies must be physically consistent.
        prior: Dynamic parameters to stay near to, (10 nbodies,); None for the model's.
        ridge: As for `ulna.identification.identify` [(N m)^2].
        noise: As for `ulna.identification.identify`, (nv,) [N m or N]; "auto" needs no second pass.
        width: Velocity within which Coulomb friction passes smoothly through zero [rad/s, m/s].
        chunk: How many rows are one part.
        to: Where what the fit needs of the log is written, as a Zarr group of some megabytes at most; the job can be
            continued, and other fits (`physical`, `ridge`, `noise`, `prior`) need no further pass. None for nowhere.
        **options: Of `ulna.scale.run`: scheduler, workers, progress, retries, patience.

    Returns:
        The parameters with their residuals and report.

    Raises:
        ShapeError, NonFiniteError: If the log does not fit the robot.
        InputError: If an argument makes no sense, or `to` holds another job.
        JobStopped: If the job ended before all was done.
    """
    robot = load(robot) if isinstance(robot, str) else robot
    source = LogSource.of(log)
    rows = Samples(source.checked(robot.model), whole_number("chunk", chunk), 0)
    sought = Sought(armature, damping, friction, width)
    sums = run_with(options, Identifying(robot, source, rows, sought), archive.named(to))
    return fit_sums(robot.model, sums, sought, physical=physical, prior=prior, ridge=ridge, noise=noise)


@final
@dataclass(frozen=True, eq=False)
class Identifying(SampledJob):
    """The job of identification: the sums of a log.

    Attributes:
        robot: The robot.
        source: The log; without arrays on workers.
        samples: Its rows, in parts.
        sought: Which parameters are sought.
    """

    kind: ClassVar[str] = "identification"
    robot: Robot
    source: LogSource
    samples: Samples
    sought: Sought

    def description(self) -> dict[str, Any]:
        """All that the sums depend on."""
        return {
            **self.subject(),
            "rows": self.samples.count,
            "chunk": self.samples.chunk,
            "log": fingerprint(self.source.fingerprint(self.samples.count)),
            **self.sought.drives,
            "width": self.sought.width,
        }

    def for_workers(self) -> Identifying:
        """The job without the arrays of the log."""
        return replace(self, source=replace(self.source, arrays=None))

    def inputs(self, part: int) -> tuple[Any, ...]:
        """Rows of a part of q, v, a and tau; of a log that workers can read, nothing."""
        return () if self.source.path is not None else self._rows(part)

    def start(self) -> State:
        """No rows yet."""
        return no_rows(self.robot.model, self.sought)

    def work(self, part: int, *inputs: Any) -> State:
        """The sums of a part.

        Raises:
            NonFiniteError: If a sample is not finite.
        """
        q, v, a, tau = inputs or self._rows(part)
        try:
            return sums_of(self.robot, q, v, a, tau, self.sought)
        except NonFiniteError as error:  # the row of the whole log
            row, *rest = error.index
            index = (row + part * self.samples.chunk, *rest)
            raise NonFiniteError(
                error.name, index, error.value, "Leave such samples out of the log."
            ) from None

    def fold(self, state: State, part: int, result: State) -> None:
        """Adds the sums of a part."""
        add(state, result)

    def existing(self, to: Path) -> Sums:
        """The sums in `to`."""
        group = archive.check(to, self.description())
        return {name: np.asarray(group[name][...]) for name in self.start()}

    def finish(self, state: State, to: Path | None) -> Sums:
        """The sums, written to `to`."""
        if to is not None:
            archive.write(to, state, self.description())
        return state

    def _rows(self, part: int) -> tuple[Any, ...]:
        first = part * self.samples.chunk
        return self.source.read(first, first + self.samples.size(part))
