"""Sampled trajectories."""

from __future__ import annotations

from typing import Any

import numpy as np

from roboticstoolbox._plot.curves import plot_trajectory, xplot
from ulna.typing import Floats


class Trajectory:
    """Positions, velocities and accelerations by rows, (m, n), or (m,) of one coordinate.

    Attributes:
        name: What made it.
        t: Times, (m,).
        q: Positions; also `s`.
        qd: Velocities; also `sd`.
        qdd: Accelerations; also `sdd`.
        istime: Whether `t` is in seconds rather than steps.
        tblend: Duration of a blend, of `trapezoidal` [s].
        arrive: When each via point is passed, of `mstraj` (m,) [s].
        info: What was chosen for each segment, of `mstraj`.
        via: The via points after the first, of `mstraj`, (m, n).
    """

    tblend: float
    arrive: Floats
    info: list[Any]
    via: Floats

    def __init__(
        self, name: str, t: Any, s: Any, sd: Any = None, sdd: Any = None, istime: bool = False
    ) -> None:
        """A trajectory from its rows.

        Args:
            name: What made it.
            t: Times, shape (m,).
            s: Positions, shape (m, n) or (m,).
            sd: Velocities, in the same shape.
            sdd: Accelerations, in the same shape.
            istime: Whether `t` is in seconds rather than steps.
        """
        self.name, self.t, self.istime = name, np.asarray(t), istime
        self.s, self.sd, self.sdd = s, sd, sdd

    @property
    def q(self) -> Floats:
        """Positions."""
        return self.s

    @property
    def qd(self) -> Floats:
        """Velocities."""
        return self.sd

    @property
    def qdd(self) -> Floats:
        """Accelerations."""
        return self.sdd

    @property
    def naxes(self) -> int:
        """How many coordinates there are."""
        return 1 if self.s.ndim == 1 else self.s.shape[1]

    def __len__(self) -> int:
        return len(self.s)

    def __str__(self) -> str:
        return f"Trajectory created by {self.name}: {len(self)} time steps x {self.naxes} axes"

    __repr__ = __str__

    def plot(self, block: bool = False, plotargs: Any = None, textargs: Any = None) -> Any:
        """Draws positions, velocities and accelerations over time.

        Args:
            block: Whether to wait until the window is closed.
            plotargs: Options of matplotlib's `plot`, a dict.
            textargs: Options of the labels, a dict.

        Returns:
            The Matplotlib figure.
        """
        return plot_trajectory(self, block, plotargs, textargs)

    def qplot(self, **options: Any) -> Any:
        """Draws positions over time; see `xplot`."""
        return xplot(self.t, self.s, **options)
