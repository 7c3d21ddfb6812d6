"""Recordings: times, configurations and further columns, row by row."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Self, final

import numpy as np

from ulna.checks.attributes import FixedAttributes
from ulna.checks.values import checked_robot, number, one_of, short_repr
from ulna.errors import InputError, ShapeError
from ulna.sim.recording_file import read_csv, write_csv
from ulna.typing import ArrayLike, Floats


@final
class Recording(FixedAttributes):
    """Columns of numbers over time: "t" [s], "q", and further named columns.

    Times do not decrease. Where a row lacks a column it holds nan.
    """

    def __init__(self) -> None:
        self._count = self._capacity = 0
        self._columns: dict[str, Floats] = {}

    def add(self, t: float, q: ArrayLike, **columns: Any) -> None:
        """Append a row. One that is refused changes nothing.

        Args:
            t: The time, not before that of the last row [s].
            q: Configuration, shape (nq,) [rad, m].
            **columns: Values of further columns by name.

        Raises:
            ShapeError: A shape differs from that of the rows before.
            InputError: A column holds no numbers, or the time is before that of the last row.
        """
        number("t", t, "a time [s]")
        if self._count and t < (last := self._columns["t"][self._count - 1]):
            raise InputError(
                f"`t` is {t:g} s, and the last row is of {last:g} s; expected times that do not decrease. "
                "Begin a new Recording for another motion."
            )
        cells = {name: self._cell(name, value) for name, value in {"t": t, "q": q, **columns}.items()}
        if self._count == self._capacity:
            self._grow()
        for name, cell in cells.items():
            if name not in self._columns:
                self._columns[name] = np.full((self._capacity, *cell.shape), np.nan)
            self._columns[name][self._count] = cell
        self._count += 1

    def _cell(self, name: str, value: Any) -> Floats:
        """A value of a column as an array that fits the column."""
        try:
            cell, column = np.asarray(value, dtype=float), self._columns.get(name)
        except (TypeError, ValueError):
            raise InputError(f"`{name}` is {short_repr(value)}; expected numbers.") from None
        if column is not None and column.shape[1:] != cell.shape:
            raise ShapeError(name, cell.shape, f"{column.shape[1:]}, as in the rows before")
        return cell

    def _grow(self) -> None:
        self._capacity = 2 * self._capacity or 64
        for name, column in self._columns.items():
            larger = np.full((self._capacity, *column.shape[1:]), np.nan)
            larger[: self._count] = column[: self._count]
            self._columns[name] = larger

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the columns."""
        return tuple(self._columns)

    @property
    def t(self) -> Floats:
        """The times [s], shape (n,), read-only."""
        return self._view("t")

    @property
    def q(self) -> Floats:
        """The configurations, shape (n, nq), read-only."""
        return self._view("q")

    @property
    def duration(self) -> float:
        """The time from the first row to the last [s]."""
        return float(self.t[-1] - self.t[0]) if self._count else 0.0

    def __len__(self) -> int:
        return self._count

    def __copy__(self) -> Self:
        """A recording with the same rows, to which rows are added without changing this one."""
        made = type(self)()
        made._columns = {name: column.copy() for name, column in self._columns.items()}
        made._count, made._capacity = self._count, self._capacity
        return made

    def __getitem__(self, name: str) -> Floats:
        """A copy of a column: "t", "q", or the name of a further column."""
        one_of("column", name, self._columns)
        return self._columns[name][: self._count].copy()

    def __repr__(self) -> str:
        if not self._count:
            return "<recording without rows>"
        columns = ", ".join(f"{name} {self._columns[name][: self._count].shape}" for name in self._columns)
        return f"<recording from {self.t[0]:.6g} to {self.t[-1]:.6g} s: {columns}>"

    def _view(self, name: str) -> Floats:
        if not self._columns:
            return np.zeros((0,) if name == "t" else (0, 0))
        out = self._columns[name][: self._count]
        out.setflags(write=False)
        return out

    def save(self, path: str | Path) -> None:
        """Write all rows to a .csv file, in full precision, below a header row "t,q_0,q_1,...".

        Args:
            path: The file, .csv.

        Raises:
            InputError: The path does not end in .csv, there are no rows, or two columns of the file have one name.

        Example:
            >>> robot = ulna.load("panda")
            >>> run = ulna.sim.simulate(robot, robot.configurations["ready"], duration=0.1)
            >>> run.save("log.csv")
            >>> ulna.sim.Recording.load("log.csv")["tau"].shape == run["tau"].shape
            True
        """
        write_csv({name: column[: self._count] for name, column in self._columns.items()}, path)

    @classmethod
    def load(cls, path: str | Path) -> Self:
        """Read a .csv file that `save` wrote, or the log of another program with such a header row.

        The header row names the columns: "t" for the time [s], "q_0", "q_1", ... for the configuration, and others,
        such as "tau_0", "tau_1", ... Other tables are read with NumPy or pandas.

        Args:
            path: The file, .csv.

        Returns:
            The recording.

        Raises:
            InputError: There is no such file, it is no such table, or times decrease; the message says where.
        """
        columns = read_csv(path)
        made = cls()
        made._columns = {name: columns.pop(name) for name in ("t", "q")} | columns
        made._count = made._capacity = len(made._columns["t"])
        return made

    def at(self, t: float, robot: Any = None) -> Floats:
        """The configuration at a time, held at both ends.

        Args:
            t: The time [s].
            robot: Interpolates on its configuration manifold; without one the last row at or before `t` is returned, or
                the first one.

        Returns:
            Configuration, shape (nq,) [rad, m].

        Raises:
            InputError: Nothing was recorded.
        """
        if not self._count:
            raise InputError("Nothing was recorded yet.")
        number("t", t, "a time [s]")
        if robot is not None:
            checked_robot(robot)
        times, q = self.t, self.q
        k = int(np.searchsorted(times, t, side="right")) - 1
        if robot is None or k < 0 or k + 1 >= self._count or times[k] == t:
            return q[min(max(k, 0), self._count - 1)].copy()
        share = (t - times[k]) / (times[k + 1] - times[k])
        return np.asarray(robot.interpolate(q[k], q[k + 1], share))
