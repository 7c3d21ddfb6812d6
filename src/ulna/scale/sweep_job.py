"""The job of a sweep: moments, extremes and regressions over parts of the samples.

| symbol | meaning | shape |
|---|---|---|
| u | factors, from -1 to 1 | (n, d) |
| y | the quantity, less its value in the middle of all ranges | (n, m) |
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, final

import numpy as np

from ulna import kernels
from ulna.errors import InputError
from ulna.model.content import fingerprint
from ulna.robot import Robot
from ulna.scale import archive
from ulna.scale.factors import Factors
from ulna.scale.job import SampledJob, Samples, State
from ulna.scale.sweep_result import Sweep
from ulna.system.cached import cached_property
from ulna.typing import Floats

_ROWS = 8192  # samples at a time
_ONE_THREAD = (
    2**17
)  # products of a matrix product that BLAS does in one thread, with the same bits everywhere


@final
@dataclass(frozen=True, eq=False)
class Sweeping(SampledJob):
    """The job of a sweep.

    Attributes:
        robot: The robot.
        quantity: The name of the kernel.
        settings: Its options.
        factors: What varies.
        samples: The samples.
        levels: How many values each factor has on a grid; 0 for random samples.
    """

    kind: ClassVar[str] = Sweep.KIND
    robot: Robot
    quantity: str
    settings: Mapping[str, Any]
    factors: Factors
    samples: Samples
    levels: int

    def description(self) -> dict[str, Any]:
        """All that the result depends on."""
        return {
            **self.subject(),
            "quantity": self.quantity,
            "settings": {name: repr(value) for name, value in self.settings.items()},
            "values": fingerprint(dict(self.factors.values)),
            "factors": list(self.factors.names),
            "low": self.factors.low.tolist(),
            "high": self.factors.high.tolist(),
            "samples": self.samples.count,
            "levels": self.levels,
            "chunk": self.samples.chunk,
            "seed": self.samples.seed,
        }

    def prepare(self, to: Path | None) -> None:
        """Refuses what cannot be computed, before anything is written.

        Raises:
            InputError: If the quantity is none in the middle of the ranges.
        """
        if not np.isfinite(self._middle).all():
            raise InputError(
                f"{self.quantity!r} is not finite in the middle of the ranges; expected numbers."
            )

    def start(self) -> State:
        """No samples yet."""
        return self._empty()

    def work(self, part: int, *inputs: Any) -> State:
        """The sums and extremes of a part."""
        rng, left, state = self.samples.generator(part), self.samples.size(part), self._empty()
        first = part * self.samples.chunk
        while left:
            rows = min(left, _ROWS)
            u = self._units(first, rows, rng)
            y = self._values(self.factors.scaled(u)).reshape(rows, -1) - self._middle.reshape(-1)
            _add(state, u, y)
            first, left = first + rows, left - rows
        return state

    def fold(self, state: State, part: int, result: State) -> None:
        """Adds the sums of a part."""
        _merge(state, result)

    def existing(self, to: Path) -> Sweep:
        """The result in `to`."""
        archive.check(to, self.description())
        return Sweep.load(to)

    def finish(self, state: State, to: Path | None) -> Sweep:
        """The result, written to `to`."""
        shape, d = self._middle.shape, len(self.factors.low)
        n, half = int(state["count"][0]), 0.5 * (self.factors.high - self.factors.low)
        u, y = state["u"] / n, state["y"] / n
        variance = np.maximum(state["yy"] / n - y * y, 0.0)
        covariance = state["uu"] / n - np.outer(u, u)
        slopes = np.linalg.lstsq(covariance, state["uy"] / n - np.outer(u, y), rcond=1e-10)[
            0
        ]  # (d, m), for u
        noise = (1e-13 * (1.0 + np.abs(self._middle).reshape(-1))) ** 2  # variances of rounding errors
        known = np.where(variance > noise, variance, np.inf)
        shares = slopes**2 * np.diag(covariance)[:, None] / known
        explained = np.einsum("im,ij,jm->m", slopes, covariance, slopes) / known
        each = (*shape, d)
        result = Sweep(
            mean=self._middle + y.reshape(shape),
            deviation=np.sqrt(variance).reshape(shape),
            least=state["least"].reshape(shape) + self._middle,
            greatest=state["greatest"].reshape(shape) + self._middle,
            least_at=self.factors.scaled(state["least_at"]).reshape(each),
            greatest_at=self.factors.scaled(state["greatest_at"]).reshape(each),
            slope=(slopes / half[:, None]).T.reshape(each),
            share=shares.T.reshape(each),
            explained=explained.reshape(shape),
            job=self.description(),
        )
        if to is not None:
            result.save(to)
        return result

    @cached_property
    def _kernel(self) -> Any:
        names = self.factors.parameters
        return kernels.kernel(self.robot.model, self.quantity, parameters=names, **self.settings)

    @cached_property
    def _middle(self) -> Floats:
        """The quantity in the middle of all ranges."""
        return self._values(self.factors.scaled(np.zeros((1, len(self.factors.low)))))[0]

    def _values(self, x: Floats) -> Floats:
        """The quantity at values of the factors, (n, *S)."""
        arguments = self.factors.arguments(x)
        names = (*kernels.QUANTITIES[self.quantity].arrays, *self.factors.parameters)
        values = self._kernel(*(arguments[name] for name in names))
        if isinstance(values, tuple):
            raise InputError(
                f"{self.quantity!r} returns {len(values)} arrays; a sweep is of one. Choose another."
            )
        return values

    def _units(self, first: int, rows: int, rng: np.random.Generator) -> Floats:
        """u: random, or on the grid, whose first factor varies fastest."""
        d = len(self.factors.low)
        if not self.levels:
            return rng.uniform(-1.0, 1.0, (rows, d))
        left, out = np.arange(first, first + rows), np.empty((rows, d))
        for k in range(d):
            left, digit = np.divmod(left, self.levels)
            out[:, k] = 2.0 * digit / (self.levels - 1) - 1.0
        return out

    def _empty(self) -> State:
        m, d = self._middle.size, len(self.factors.low)
        return {
            "count": np.zeros(1, np.int64),
            "u": np.zeros(d),
            "uu": np.zeros((d, d)),
            "y": np.zeros(m),
            "yy": np.zeros(m),
            "uy": np.zeros((d, m)),
            "least": np.full(m, np.inf),
            "greatest": np.full(m, -np.inf),
            "least_at": np.zeros((m, d)),
            "greatest_at": np.zeros((m, d)),
        }


def _add(state: State, u: Floats, y: Floats) -> None:
    """Adds samples to sums and extremes.

    Args:
        state: The sums, which are changed.
        u: The factors, (n, d).
        y: The quantity, (n, m).
    """
    low, high, columns = y.argmin(axis=0), y.argmax(axis=0), np.arange(y.shape[1])
    here = {
        "count": np.array([len(u)]),
        "u": u.sum(axis=0),
        "uu": _product(u, u),
        "y": y.sum(axis=0),
        "yy": (y * y).sum(axis=0),
        "uy": _product(u, y),
        "least": y[low, columns],
        "greatest": y[high, columns],
        "least_at": u[low],
        "greatest_at": u[high],
    }
    _merge(state, here)


def _merge(state: State, other: State) -> None:
    """Adds sums to sums; of equal extremes the first counts."""
    for name in ("count", "u", "uu", "y", "yy", "uy"):
        state[name] += other[name]
    for name, is_farther in (
        ("least", other["least"] < state["least"]),
        ("greatest", other["greatest"] > state["greatest"]),
    ):
        state[name][is_farther] = other[name][is_farther]
        state[f"{name}_at"][is_farther] = other[f"{name}_at"][is_farther]


def _product(a: Floats, b: Floats) -> Floats:
    """a^T b, block by block, so that BLAS uses one thread and the bits do not depend on how many there are."""
    rows = max(1, _ONE_THREAD // (a.shape[1] * b.shape[1]))
    out = np.zeros((a.shape[1], b.shape[1]))
    for first in range(0, len(a), rows):
        out += a[first : first + rows].T @ b[first : first + rows]
    return out
