"""What a sweep has found: statistics, sensitivities, worst cases."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, final

import numpy as np

from ulna.scale.archive import StoredResult
from ulna.typing import Floats


@final
@dataclass(frozen=True, eq=False, repr=False)
class Sweep(StoredResult):
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

    KIND: ClassVar[str] = "sweep"
    mean: Floats
    deviation: Floats
    least: Floats
    greatest: Floats
    least_at: Floats
    greatest_at: Floats
    slope: Floats
    share: Floats
    explained: Floats

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

    def __repr__(self) -> str:
        job = self.job
        share = self.share.reshape(-1, len(self.factors)).mean(axis=0)
        first = np.argsort(-share)[:3]
        text = ", ".join(f"{self.factors[k]} {100 * share[k]:.0f} %" for k in first)
        return (
            f"<sweep of {job['quantity']!r} of {job['robot']!r}: {job['samples']:,} samples of {len(share)} factors; "
            f"most of the variance: {text}>"
        )
