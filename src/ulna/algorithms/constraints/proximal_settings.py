"""The settings of the solver of constraint forces, which declarations need without the solver."""

from __future__ import annotations

from typing import Any, final

import numpy as np

from ulna.data_classes import dataclass
from ulna.errors import InputError


@final
@dataclass(frozen=True)
class Proximal:
    """How the forces of constraints are found.

    Attributes:
        mu: Proximal parameter as a part of the mean diagonal entry of the Delassus matrix. 0 factors that matrix as it
            is: the fewest operations, for constraints known to be independent; a row that depends on rows after it
            then gets no force.
        tolerance: The rounds end when max|b - G f| is at most this times max|b|, b being the right-hand side of
            G f = b.
        iterations: Rounds at most. 1 leaves the constraints compliant: b - G f = r f, r being `mu` times the mean
            diagonal entry of G.
    """

    mu: float = 1e-8
    tolerance: float = 1e-12
    iterations: int = 50

    def __post_init__(self) -> None:
        if not (_is_finite(self.mu) and self.mu >= 0.0):
            raise InputError(f"`mu` is {self.mu!r}; expected a number that is not below zero, such as 1e-8.")
        if not (_is_finite(self.tolerance) and self.tolerance > 0.0):
            raise InputError(
                f"`tolerance` is {self.tolerance!r}; expected a number above zero, such as 1e-12."
            )
        if not isinstance(self.iterations, (int, np.integer)) or self.iterations < 1:
            raise InputError(f"`iterations` is {self.iterations!r}; expected a whole number from 1.")


def _is_finite(value: Any) -> bool:
    return isinstance(value, (int, float, np.number)) and bool(np.isfinite(value))
