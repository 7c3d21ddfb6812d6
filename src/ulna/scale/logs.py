"""Logs of a robot that may not fit in memory: arrays q, v, a and tau, read some rows at a time."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, final

import numpy as np

from ulna.errors import InputError, ShapeError
from ulna.model import Model
from ulna.model.content import fingerprint
from ulna.scale import archive, npz
from ulna.system.cached import cached_property
from ulna.typing import Array

NAMES = ("q", "v", "a", "tau")
_FILES = ", ".join(f"{name}.npy" for name in NAMES)
_FINGERPRINT_ROWS = 1000  # rows at both ends by which a log is known again


@final
@dataclass(frozen=True, eq=False)
class LogSource:
    """Where a log is.

    Attributes:
        arrays: Its arrays by name, as slices of rows can be read of; None for a path.
        path: A Zarr group, or a folder with q.npy, v.npy, a.npy and tau.npy, which all workers can read; None for
            arrays.
    """

    arrays: Mapping[str, Any] | None
    path: str | None

    @classmethod
    def of(cls, log: Any) -> LogSource:
        """A log of a mapping or a path.

        Args:
            log: Arrays by name, the path of a folder, or of an NPZ file, which is read into memory.

        Returns:
            The log.

        Raises:
            InputError: If it is neither.
        """
        if isinstance(log, str | os.PathLike):
            path = Path(log).absolute()
            if path.suffix == ".npz":
                return cls(npz.read(path, NAMES), None)
            return cls(None, str(path))
        if hasattr(log, "keys"):
            return cls({name: log[name] for name in NAMES if name in log}, None)
        raise InputError(
            f"`log` is a {type(log).__name__}; expected arrays by name (q, v, a, tau), or the path of a Zarr group, of "
            "a folder with q.npy, v.npy, a.npy and tau.npy, or of an NPZ file."
        )

    @cached_property
    def _opened(self) -> Mapping[str, Any]:
        """The arrays by name."""
        if self.arrays is not None or self.path is None:
            return self.arrays or {}
        folder = Path(self.path)
        if not folder.is_dir():
            raise InputError(
                f"There is no log in {self.path!r}; expected a Zarr group, a folder with {_FILES}, "
                "or an NPZ file, whose name ends in .npz."
            )
        files = {name: folder / f"{name}.npy" for name in NAMES}
        if any(file.exists() for file in files.values()):
            return {name: np.load(file, mmap_mode="r") for name, file in files.items() if file.exists()}
        try:
            group = archive.zarr().open_group(self.path, mode="r")
        except (FileNotFoundError, ValueError) as error:
            raise InputError(f"{self.path!r} holds neither {_FILES} nor a Zarr group: {error}.") from None
        return {name: group[name] for name in NAMES if name in group}

    def checked(self, model: Model) -> int:
        """How many rows the log has.

        Args:
            model: The robot.

        Returns:
            The number of rows.

        Raises:
            InputError: If arrays are missing, or it has no rows.
            ShapeError: If the log does not fit the robot.
        """
        missing = [name for name in NAMES if name not in self._opened]
        if missing:
            raise InputError(f"The log has no {', '.join(missing)}; expected the arrays {', '.join(NAMES)}.")
        rows = self._opened["q"].shape[0] if len(self._opened["q"].shape) else 0
        for name in NAMES:
            expected = (rows, model.nq if name == "q" else model.nv)
            if tuple(self._opened[name].shape) != expected:
                raise ShapeError(name, tuple(self._opened[name].shape), f"{expected}, one row per sample")
        if not rows:
            raise InputError("The log has no samples; expected one at least.")
        return rows

    def read(self, first: int, last: int) -> tuple[Array, ...]:
        """Rows of q, v, a and tau.

        Args:
            first: The first row.
            last: The row after the last.

        Returns:
            The arrays, (rows, nq) and (rows, nv).
        """
        return tuple(np.asarray(self._opened[name][first:last]) for name in NAMES)

    def fingerprint(self, rows: int) -> str:
        """By what a log is known again: its first and last rows.

        Args:
            rows: How many rows it has.

        Returns:
            The fingerprint.
        """
        return fingerprint(
            rows, *self.read(0, _FINGERPRINT_ROWS), *self.read(max(0, rows - _FINGERPRINT_ROWS), rows)
        )
