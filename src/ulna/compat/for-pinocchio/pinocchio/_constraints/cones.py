"""The sets that forces of constraints belong to: friction cones, boxes, half-lines, all or nothing."""

from __future__ import annotations

from typing import Any, final

import numpy as np

from pinocchio._containers.arguments import ArgumentError, WrongShape
from pinocchio._containers.arrays import numbers, real, vector
from pinocchio._containers.keywords import by_name
from ulna.algorithms.constraints import friction_cone
from ulna.errors import InputError
from ulna.typing import Floats

__all__ = [
    "BoxSet",
    "CoulombFrictionCone",
    "DualCoulombFrictionCone",
    "FullSpaceCone",
    "NonNegativeOrthantCone",
    "ZeroCone",
]


class _Set:
    """A closed convex set."""

    __slots__ = ()

    def _key(self) -> tuple[Any, ...]:
        return ()

    def project(self, f: Any) -> Floats:
        """The nearest vector of the set."""
        raise NotImplementedError

    def isInside(self, f: Any) -> bool:
        """Whether a vector belongs to it."""
        force = _any(f)
        off = np.linalg.norm(force - self.project(force))
        return bool(off <= 1e-15 * np.linalg.norm(force))

    def copy(self) -> Any:
        """Itself; sets do not change."""
        return self

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        return all(np.array_equal(a, b) for a, b in zip(self._key(), other._key(), strict=True))

    __hash__ = object.__hash__

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(map(str, self._key()))})"


class _Friction(_Set):
    """A cone of a coefficient of friction."""

    __slots__ = ("_mu",)

    @by_name("mu", "other")
    def __init__(self, mu: Any) -> None:
        value = mu.mu if isinstance(mu, _Friction) else real(mu, "mu")
        if not (np.isfinite(value) and value >= 0.0):
            raise InputError(f"The friction coefficient is {mu!r}; expected a number that is not below zero.")
        self._mu = value

    def _key(self) -> tuple[Any, ...]:
        return (self._mu,)

    def __call__(self, constraint_data: Any) -> Any:
        """Itself, for contacts whose set is asked as `constraint.set(constraint_data)`."""
        if not getattr(constraint_data, "_of_constraint", False):
            raise ArgumentError(
                f"The data of the contact is {constraint_data!r}; expected what its createData() returns."
            )
        return self

    @property
    def mu(self) -> float:
        """The coefficient of friction."""
        return self._mu


@final
class CoulombFrictionCone(_Friction):
    """`CoulombFrictionCone(mu)`: forces (x, y, normal) whose tangential part is at most mu times the normal one."""

    __slots__ = ()

    def project(self, f: Any) -> Floats:
        """The nearest force of the cone."""
        return friction_cone.project(vector(f, 3, "f"), self._mu)

    def weightedProject(self, f: Any, R: Any) -> Floats:
        """The nearest force of the cone in the metric of a diagonal matrix.

        Args:
            f: Force (3,) [N].
            R: The diagonal (3,), above zero, its first two entries equal.

        Returns:
            Force (3,) [N].

        Raises:
            InputError: `R` is no such diagonal.
        """
        weights = vector(R, 3, "R")
        if not (weights.min() > 0.0 and weights[0] == weights[1]):
            raise InputError(f"`R` is {weights.tolist()}; expected numbers above zero, the first two equal.")
        return friction_cone.project_weighted(vector(f, 3, "f"), self._mu, weights)

    def computeRadialProjection(self, f: Any) -> Floats:
        """The force of the cone with the same normal part, if that is not below zero."""
        return friction_cone.project_radially(vector(f, 3, "f"), self._mu)

    def computeNormalCorrection(self, v: Any) -> Floats:
        """De Saxce's shift of a contact's velocity: (0, 0, mu times its tangential length)."""
        return friction_cone.sliding_shift(vector(v, 3, "v"), self._mu)

    def dual(self) -> DualCoulombFrictionCone:
        """The cone of what has no negative product with its forces."""
        return DualCoulombFrictionCone(self._mu)


@final
class DualCoulombFrictionCone(_Friction):
    """`DualCoulombFrictionCone(mu)`: velocities (x, y, normal), mu times the tangential part at most the normal one."""

    __slots__ = ()

    def project(self, f: Any) -> Floats:
        """The nearest velocity of the cone."""
        return friction_cone.project_dual(vector(f, 3, "f"), self._mu)

    def dual(self) -> CoulombFrictionCone:
        """The friction cone."""
        return CoulombFrictionCone(self._mu)


@final
class BoxSet(_Set):
    """`BoxSet(lb, ub)`: vectors between bounds."""

    __slots__ = ("_lb", "_ub")

    @by_name("lb ub", "other")
    def __init__(self, lb: Any, ub: Any = None) -> None:
        if isinstance(lb, BoxSet):
            if ub is not None:
                raise ArgumentError(
                    f"BoxSet was given a BoxSet and {ub!r}; expected (lb, ub) or another BoxSet."
                )
            lb, ub = lb._lb, lb._ub
        self._lb = numbers(lb, "lb").reshape(-1).copy()
        self._ub = vector(ub, len(self._lb), "ub").copy()
        if not (self._lb <= self._ub).all():
            raise InputError(f"Lower bounds {self._lb.tolist()} are above upper ones {self._ub.tolist()}.")

    def _key(self) -> tuple[Any, ...]:
        return self._lb, self._ub

    @property
    def lb(self) -> Floats:
        """The lower bounds, a copy."""
        return self._lb.copy()

    @property
    def ub(self) -> Floats:
        """The upper bounds, a copy."""
        return self._ub.copy()

    def project(self, f: Any) -> Floats:
        """The nearest vector between the bounds."""
        return np.clip(vector(f, len(self._lb), "f"), self._lb, self._ub)


@final
class FullSpaceCone(_Set):
    """All vectors."""

    __slots__ = ()

    def project(self, f: Any) -> Floats:
        """The same vector."""
        return _any(f).copy()

    def dual(self) -> ZeroCone:
        """The zero alone."""
        return ZeroCone()


@final
class ZeroCone(_Set):
    """The zero alone."""

    __slots__ = ()

    def project(self, f: Any) -> Floats:
        """Zero."""
        return 0.0 * _any(f)

    def dual(self) -> FullSpaceCone:
        """All vectors."""
        return FullSpaceCone()


@final
class NonNegativeOrthantCone(_Set):
    """Vectors without an entry below zero."""

    __slots__ = ()

    def project(self, f: Any) -> Floats:
        """The vector with its entries below zero set to zero."""
        return np.maximum(_any(f), 0.0)

    def dual(self) -> NonNegativeOrthantCone:
        """Itself."""
        return self


def _any(f: Any) -> Floats:
    force = numbers(f, "f")
    if force.ndim != 1:
        raise WrongShape("f", force.shape, "(n,)")
    return force
