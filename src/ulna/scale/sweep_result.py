"""What a sweep has found: statistics, sensitivities, worst cases."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, final

import numpy as np

from ulna.scale import archive
from ulna.typing import Floats

KIND = "sweep"


@final
@dataclass(frozen=True, eq=False, repr=False)
class Sweep:
    """What a sweep has found; S is the shape of the quantity, d the number of factors.

    Attributes:
        mean: The mean, S.
        deviation: The standard deviation, S.
        least: The least value, S.
        greatest: The greatest value, S.
        least_at: The factors at which it is least, (*S, d).
        greatest_at: The factors at which it is greatest, (*S, d).
        slope: Change with each factor, by linear regression, (*S, d).
        share: Which part of the variance each factor explains in that regression, (*S, d); of factors that vary
            independently they add up to `explained`.
        explained: Which part of the variance the regression explains, S; far below 1 the quantity is not linear in the
            factors within their ranges.
        job: What was asked: robot, quantity, names and ranges of factors, samples.
    """

    mean: Floats
    deviation: Floats
    least: Floats
    greatest: Floats
    least_at: Floats
    greatest_at: Floats
    slope: Floats
    share: Floats
    explained: Floats
    job: Mapping[str, Any]

    @property
    def factors(self) -> tuple[str, ...]:
        """The names of the factors, (d,)."""
        return tuple(self.job["factors"])

    def worst(self, entry: Any = (), *, greatest: bool = True) -> dict[str, float]:
        """The worst case of an entry of the quantity.

        Args:
            entry: Its place, such as 1 or (0, 3).
            greatest: Whether the greatest value is the worst; else the least.

        Returns:
            The values of the factors, by name.
        """
        values = (self.greatest_at if greatest else self.least_at)[entry]
        return dict(zip(self.factors, values.reshape(-1, len(self.factors))[0].tolist(), strict=True))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the result as a Zarr group.

        Args:
            path: The folder.
        """
        archive.write(Path(path), {name: getattr(self, name) for name in _ARRAYS}, self.job)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Sweep:
        """Reads a result.

        Args:
            path: The folder.

        Returns:
            The result.

        Raises:
            InputError: If there is none.
        """
        group = archive.opened(path, KIND)
        return cls(*(group[name][...] for name in _ARRAYS), job=group.attrs.asdict())

    def __repr__(self) -> str:
        job = self.job
        share = self.share.reshape(-1, len(self.factors)).mean(axis=0)
        first = np.argsort(-share)[:3]
        text = ", ".join(f"{self.factors[k]} {100 * share[k]:.0f} %" for k in first)
        return (
            f"<sweep of {job['quantity']!r} of {job['robot']!r}: {job['samples']:,} samples of {len(share)} factors; "
            f"most of the variance: {text}>"
        )


_ARRAYS = tuple(field.name for field in fields(Sweep) if field.name != "job")
