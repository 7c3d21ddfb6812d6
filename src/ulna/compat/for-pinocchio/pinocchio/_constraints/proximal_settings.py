"""How forces of constraints are computed, and the residuals of that."""

from __future__ import annotations

import math
from typing import Any, final

import numpy as np

from pinocchio._containers.arguments import ArgumentError
from pinocchio._containers.arrays import index
from pinocchio._containers.keywords import overloads
from ulna.errors import InputError

__all__ = ["ProximalSettings"]


@final
class ProximalSettings:
    """`ProximalSettings([absolute_accuracy, [relative_accuracy,]] mu, max_iter)`.

    Each round solves with `mu` added to the Delassus matrix, and takes off what that changes. The rounds end when
    the constraints are kept to the absolute accuracy, or no force changes by more than the relative one.
    """

    __slots__ = ("_accuracies", "_limit", "_mu", "_numbers", "_residuals", "_rounds")

    @overloads(
        "accuracy mu max_iter:int",
        "absolute_accuracy relative_accuracy mu max_iter:int",
        "",
    )
    def __init__(
        self,
        accuracy: float = 1e-12,
        mu: float = 0.0,
        max_iter: int = 1,
        absolute_accuracy: float | None = None,
        relative_accuracy: float | None = None,
    ) -> None:
        both = (accuracy if x is None else x for x in (absolute_accuracy, relative_accuracy))
        self._accuracies: Any = tuple(float(x) for x in both)
        self._mu = float(mu)
        if not (np.isfinite(self._mu) and self._mu >= 0.0):
            raise InputError(f"`mu` is {mu!r}; expected a number that is not below zero, such as 1e-8.")
        if not min(self._accuracies) >= 0.0:
            raise InputError(
                f"The accuracies are {self._accuracies}; expected numbers that are not below zero."
            )
        self._limit = index(max_iter, 10**9, "max_iter", "Give a whole number from 1.")
        if self._limit < 1:
            raise InputError("`max_iter` is 0; expected a whole number from 1.")
        self._numbers = np.array([self._mu, self._accuracies[1], self._accuracies[0]])
        self._rounds: Any = 0
        self._residuals: Any = (-1.0, -1.0)

    @property
    def absolute_accuracy(self) -> float:
        """The largest residual of the constraints that is small enough [m/s^2, rad/s^2]."""
        return self._accuracies[0]

    @property
    def relative_accuracy(self) -> float:
        """The largest change of a force in a round that is small enough [N, N m]."""
        return self._accuracies[1]

    @property
    def mu(self) -> float:
        """What is added to the diagonal of the Delassus matrix [1/kg]."""
        return self._mu

    @property
    def max_iter(self) -> int:
        """How many rounds at most."""
        return self._limit

    @property
    def iter(self) -> int:
        """How many rounds the last solution took."""
        return int(self._rounds)

    @property
    def absolute_residual(self) -> float:
        """What was left of the constraints then [m/s^2, rad/s^2]."""
        return float(self._residuals[0])

    @property
    def relative_residual(self) -> float:
        """By how much a force changed in the last round [N, N m]."""
        return float(self._residuals[1])

    def _report(self, rounds: Any, change: Any, residual: Any) -> None:
        self._rounds, self._residuals = rounds, (residual, change)

    def __repr__(self) -> str:
        values = (*self._accuracies, self._mu)
        return f"ProximalSettings({', '.join(f'{x:g}' for x in values)}, {self._limit})"


def settings_of(settings: Any) -> ProximalSettings:
    """The settings, checked.

    Raises:
        ArgumentError: They are something else.
    """
    if not isinstance(settings, ProximalSettings):
        raise ArgumentError(
            f"The settings are {settings!r}; expected ProximalSettings(accuracy, mu, max_iter)."
        )
    return settings


def damping_of(value: Any) -> float:
    """A damping, checked.

    Raises:
        InputError: it is below zero, or not finite.
    """
    damping = float(value)
    if not 0.0 <= damping < math.inf:
        raise InputError(f"The damping is {value!r}; expected a number that is not below zero.")
    return damping
