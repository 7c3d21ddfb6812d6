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
            then gets no force. In single precision, where it is above 0, it is 2e-6 at least.
        tolerance: The rounds end when max|b - G f| is at most this times max|b|, b being the right-hand side of
            G f = b.
        iterations: Rounds at most. 1 leaves the constraints compliant: b - G f = r f, r being `mu` times the mean
            diagonal entry of G.
        refine: Whether what is left of b is computed anew in each round, which single precision needs; then rounds end
            when that shrinks no more, and `tolerance` is not used. Kernels and exports of dtype="float32" do so by
            themselves; functions of your own that you compile with that type need it where `mu` is below 2e-6.
    """

    mu: float = 1e-8
    tolerance: float = 1e-12
    iterations: int = 50
    refine: bool = False

    def __post_init__(self) -> None:
        if not (_is_finite(self.mu) and self.mu >= 0.0):
            raise InputError(f"`mu` is {self.mu!r}; expected a number that is not below zero, such as 1e-8.")
        if not (_is_finite(self.tolerance) and self.tolerance > 0.0):
            raise InputError(
                f"`tolerance` is {self.tolerance!r}; expected a number above zero, such as 1e-12."
            )
        if not isinstance(self.iterations, (int, np.integer)) or self.iterations < 1:
            raise InputError(f"`iterations` is {self.iterations!r}; expected a whole number from 1.")
        if not isinstance(self.refine, (bool, np.bool_)):
            raise InputError(f"`refine` is {self.refine!r}; expected True or False.")


def _is_finite(value: Any) -> bool:
    return isinstance(value, (int, float, np.number)) and bool(np.isfinite(value))
