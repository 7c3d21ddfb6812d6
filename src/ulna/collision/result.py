"""What a distance is: how far, between which points, along which direction, of what."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, final

import numpy as np

from ulna.data_classes import dataclass
from ulna.lazy import Collection
from ulna.typing import Array, Floats


@final
@dataclass(frozen=True, eq=False)
class Proximity:
    """How near two things are at one configuration.

    Attributes:
        distance: Signed distance [m]; negative is how deep they overlap.
        points: The nearest points in the world, on the first and on the second, (2, 3) [m].
        normal: Unit vector from the first to the second, (3,): `points[1] - points[0]` is `distance * normal`.
        names: The link, and the other link or the obstacle.
        gradient: Derivative of the distance by the configuration's tangent, (nv,) [m/rad or 1].
    """

    distance: float
    points: Floats
    normal: Floats
    names: tuple[str, str]
    gradient: Floats

    def with_gradient(self, gradient: Floats) -> Proximity:
        """The same with that gradient."""
        return replace(self, gradient=gradient)


@final
@dataclass(frozen=True, eq=False)
class Distance(Collection):
    """The least distances of a batch of configurations; `float(d)` where there is one.

    Of configurations in a Dask array all of it is lazy, and `d.compute()` finds it.

    Attributes:
        distance: Signed distances [m], (...); negative is how deep two shapes overlap, inf where there is no pair.
        points: The nearest points in the world, on the first and on the second shape, (..., 2, 3) [m].
        normal: Unit vectors from the first to the second, (..., 3).
        names: The link, and the other link or the obstacle, (..., 2), strings.
    """

    distance: Floats
    points: Floats
    normal: Floats
    names: Array

    @classmethod
    def of(cls, items: Sequence[Proximity], batch: tuple[int, ...]) -> Distance:
        """The distances of a batch from those of its rows.

        Args:
            items: One proximity a row.
            batch: The shape of the batch.

        Returns:
            The distances.
        """
        return cls(
            np.array([i.distance for i in items], dtype=float).reshape(batch),
            np.array([i.points for i in items], dtype=float).reshape(*batch, 2, 3),
            np.array([i.normal for i in items], dtype=float).reshape(*batch, 3),
            np.array([i.names for i in items], dtype=object).reshape(*batch, 2),
        )

    def _arrays(self) -> tuple[Any, ...]:
        return self.distance, self.points, self.normal, self.names

    def _with_arrays(self, arrays: Sequence[Any]) -> Distance:
        return Distance(*arrays)

    def flat(self) -> list[Proximity]:
        """One after the other, without gradients."""
        rows = zip(
            self.distance.reshape(-1).tolist(),
            self.points.reshape(-1, 2, 3),
            self.normal.reshape(-1, 3),
            self.names.reshape(-1, 2).tolist(),
            strict=True,
        )
        return [Proximity(d, p, n, (a, b), np.zeros(0)) for d, p, n, (a, b) in rows]

    def __float__(self) -> float:
        return float(self.distance)

    def __repr__(self) -> str:
        if self.is_lazy:
            return f"<lazy distances {self.distance.shape}; .compute() finds them>"
        if self.distance.ndim:
            least = np.min(np.asarray(self.distance), initial=np.inf)  # an array of xarray has no `initial`
            return f"<distances {self.distance.shape}, least {least:.6g} m>"
        a, b = self.names
        return f"<distance {float(self.distance):.6g} m between {a!r} and {b!r}>"
