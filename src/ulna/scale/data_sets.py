"""Data sets: random states of a robot with what is computed of them, in a Zarr group or in Parquet files."""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, final

import numpy as np

from ulna import kernels
from ulna.collision import World
from ulna.errors import DtypeError, InputError, UnknownName
from ulna.loading import load
from ulna.robot import Robot
from ulna.scale import archive, parquet
from ulna.scale.engine import run_with
from ulna.scale.job import SampledJob, Samples, State, whole_number
from ulna.typing import Array

_DRAWN = ("q", "v", "a", "tau")
_COLLIDES = "collides"
_ACCELERATION = 10.0  # bound of the accelerations that are drawn [rad/s^2 or m/s^2]
_MAX_CHUNK_BYTES = 2**31 - 1  # bytes: the largest chunk that compressors of Zarr take


def data_set(
    robot: Robot | str,
    samples: float,
    columns: Sequence[str] = ("q", "fk"),
    *,
    to: Any,
    world: World | None = None,
    dtype: Any = np.float64,
    seed: int = 0,
    chunk: int = 100_000,
    **options: Any,
) -> Any:
    """A data set of random states and of quantities at them, as a Zarr group or as Parquet files.

    Args:
        robot: The robot, or its name.
        samples: How many rows [-].
        columns: Names of columns: "q", "v", "a" and "tau" are drawn uniformly within the limits (where there are none,
            within 1; accelerations within 10); any quantity of these by the name of its kernel, such as "fk",
            "jacobian" or "inverse_dynamics"; "collides" by covering spheres. What a quantity needs is drawn whether it
            is a column or not.
        to: The folder, on a disk that all workers share. A Zarr group, in which a part is one chunk of each array; or,
            where the name ends in ".parquet", a folder of Parquet files, one for each part, where vectors and matrices
            are lists of fixed length.
        world: Obstacles for "collides"; None for the robot alone.
        dtype: The type of the numbers in the arrays: float64 or float32.
        seed: Of the states: the same seed, the same rows.
        chunk: How many rows are one task, and one chunk of the arrays.
        **options: Of `ulna.scale.run`: scheduler, workers, progress, retries, patience.

    Returns:
        The Zarr group, to read: `dask.array.from_zarr(group["fk"])`; or a `pyarrow.dataset.Dataset`, whose `to_table()`
        has the rows in order.

    Raises:
        MissingExtra: If zarr, or pyarrow for Parquet files, is not installed.
        UnknownName: If there is no such column.
        InputError: If an argument makes no sense, or `to` holds something else.
        DtypeError: If `dtype` is neither float64 nor float32.
        JobStopped: If the job ended before all was done.

    Example:
        >>> data = ulna.scale.data_set("panda", 1000, ["q", "fk"], to="poses.zarr", workers=0, progress=False)
        >>> data["fk"].shape
        (1000, 4, 4)
    """
    robot = load(robot) if isinstance(robot, str) else robot
    numbers = _dtype(dtype)
    names = tuple(dict.fromkeys([columns] if isinstance(columns, str) else columns))
    if not names:
        raise InputError("`columns` is empty; expected names such as ('q', 'fk').")
    known = [name for name, quantity in kernels.QUANTITIES.items() if set(quantity.arrays) <= {*_DRAWN}]
    for name in names:
        if name not in (*_DRAWN, _COLLIDES, *known):
            raise UnknownName("column of a data set", name, (*_DRAWN, _COLLIDES, *known))
    if world is not None and _COLLIDES not in names:
        raise InputError(
            "`world` is given, but 'collides' is not among `columns`; add it, or leave `world` out."
        )
    plan = Samples(
        whole_number("samples", samples), whole_number("chunk", chunk), whole_number("seed", seed, 0)
    )
    if to is None:
        raise InputError("`to` is None; expected the folder to write, such as 'data.zarr'.")
    archive.named(to, ".parquet")
    return run_with(options, DataSet(robot, plan, names, world, numbers, str(Path(to).absolute())), to)


def _dtype(dtype: Any) -> str:
    try:
        name = np.dtype(dtype).name
    except TypeError:
        name = str(dtype)
    if name not in ("float64", "float32"):
        raise DtypeError("dtype", name, "float64 or float32")
    return name


@final
@dataclass(frozen=True, eq=False)
class DataSet(SampledJob):
    """The job of a data set.

    Attributes:
        robot: The robot.
        samples: The rows.
        columns: The names of the columns.
        world: Obstacles; None for none.
        dtype: The type of the numbers.
        to: The folder of the result.
    """

    kind: ClassVar[str] = "data set"
    robot: Robot
    samples: Samples
    columns: tuple[str, ...]
    world: World | None
    dtype: str
    to: str

    def description(self) -> dict[str, Any]:
        """All that the rows depend on."""
        return {
            **self.subject(),
            "columns": list(self.columns),
            "world": None if self.world is None else self.world.fingerprint,
            "dtype": self.dtype,
            "samples": self.samples.count,
            "chunk": self.samples.chunk,
            "seed": self.samples.seed,
        }

    def prepare(self, to: Path | None) -> None:
        """Makes the arrays.

        Raises:
            InputError: If a chunk would be too large.
        """
        rows = {name: value[:1] for name, value in self._rows(1, np.random.default_rng(0)).items()}
        if self._is_parquet:
            parquet.create(Path(self.to), {**self.description(), "complete": False})
            return
        group = archive.zarr().create_group(
            self.to, overwrite=True, attributes={**self.description(), "complete": False}
        )
        count, chunk = self.samples.count, min(self.samples.chunk, self.samples.count)
        for name, row in rows.items():
            if chunk * row.nbytes > _MAX_CHUNK_BYTES:
                raise InputError(
                    f"A chunk of {name!r} would have {chunk * row.nbytes:,} bytes; make `chunk` smaller."
                )
            shape = row.shape[1:]
            group.create_array(name, shape=(count, *shape), chunks=(chunk, *shape), dtype=row.dtype)

    def start(self) -> State:
        """The checksums of the parts, none yet."""
        return {"checksums": np.zeros(self.parts, dtype=np.uint32)}

    def work(self, part: int) -> State:
        """Computes and writes the rows of a part; returns their checksum."""
        rows = self._rows(self.samples.size(part), self.samples.generator(part))
        values = {name: np.ascontiguousarray(rows[name]) for name in self.columns}
        if self._is_parquet:
            parquet.write(Path(self.to), part, values)
        else:
            group, first = archive.zarr().open_group(self.to, mode="r+"), part * self.samples.chunk
            for name, array in values.items():
                group[name][first : first + len(array)] = array
        checksum = 0
        for array in values.values():
            checksum = zlib.crc32(array.tobytes(), checksum)
        return {"checksum": np.array(checksum, dtype=np.uint32)}

    def fold(self, state: State, part: int, result: State) -> None:
        """Stores the checksum of a part."""
        state["checksums"][part] = result["checksum"]

    def existing(self, to: Path) -> Any:
        """The data set in `to`: the Zarr group, or the files of Parquet."""
        return (parquet if self._is_parquet else archive).check(to, self.description())

    def finish(self, state: State, to: Path | None) -> Any:
        """Marks the data set as complete."""
        more = {"checksums": state["checksums"].tolist(), "complete": True}
        if self._is_parquet:
            parquet.describe(Path(self.to), {**self.description(), **more})
            return parquet.check(Path(self.to), self.description())
        group = archive.zarr().open_group(self.to, mode="r+")
        group.attrs.update(more)
        return archive.opened(self.to, self.kind)

    @property
    def _is_parquet(self) -> bool:
        return self.to.endswith(".parquet")

    def _rows(self, count: int, rng: np.random.Generator) -> dict[str, Array]:
        """The columns of so many rows."""
        drawn = self._drawn(count, rng)
        out: dict[str, Array] = {}
        for name in self.columns:
            if name in drawn:
                value = drawn[name]
            elif name == _COLLIDES:
                out[name] = self.robot.collides(drawn["q"], self.world, method="spheres")
                continue
            else:
                arrays = kernels.QUANTITIES[name].arrays
                value = kernels.kernel(self.robot.model, name)(*(drawn[array] for array in arrays))
                if isinstance(value, tuple):
                    raise InputError(
                        f"{name!r} returns {len(value)} arrays; a column is one. Choose another quantity."
                    )
            out[name] = value.astype(self.dtype)
        return out

    def _drawn(self, count: int, rng: np.random.Generator) -> dict[str, Array]:
        """q, v, a and tau; always all of them, so that further columns do not change the others."""
        model = self.robot.model
        bounds = {"v": model.velocity_limit, "a": np.full(model.nv, _ACCELERATION), "tau": model.effort_limit}
        drawn = {"q": self.robot.random_configuration(count, rng)}
        for name, bound in bounds.items():
            width = np.where(np.isfinite(bound) & (bound > 0.0), bound, 1.0)
            drawn[name] = rng.uniform(-width, width, (count, model.nv))
        return drawn
