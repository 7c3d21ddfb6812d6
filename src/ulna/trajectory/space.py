"""Where trajectories run: joint vectors, configurations of a model, poses."""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import lru_cache
from typing import final

import numpy as np

from ulna import algorithms
from ulna.data_classes import dataclass
from ulna.errors import InputError, ShapeError
from ulna.model import Model
from ulna.spatial import so3_log
from ulna.typing import Floats


@dataclass(frozen=True)
class Space(ABC):
    """A space of points, with the names of the directions one can move in."""

    names: tuple[str, ...]

    @property
    @abstractmethod
    def shape(self) -> tuple[int, ...]:
        """The shape of a point."""

    @property
    @abstractmethod
    def columns(self) -> tuple[str, ...]:
        """A name for each number of a point."""

    @abstractmethod
    def difference(self, a: Floats, b: Floats) -> Floats:
        """What leads from the points `a` to the points `b`, (..., n).

        Args:
            a: Points (..., *shape).
            b: Points (..., *shape).

        Returns:
            Steps (..., n).
        """

    @property
    def n(self) -> int:
        """How many directions there are."""
        return len(self.names)


@final
@dataclass(frozen=True)
class Vectors(Space):
    """Vectors (n,): joints whose positions are plain numbers."""

    @classmethod
    def of(cls, n: int) -> Vectors:
        """The space of n numbers, named q0, q1, ..."""
        return _numbered(n)

    @property
    def shape(self) -> tuple[int, ...]:
        """(n,)."""
        return (self.n,)

    @property
    def columns(self) -> tuple[str, ...]:
        """The names of the directions."""
        return self.names

    def difference(self, a: Floats, b: Floats) -> Floats:
        """Difference of the vectors."""
        return b - a


@final
@dataclass(frozen=True)
class Configurations(Space):
    """Configurations (nq,) of a model, a manifold: quaternions stay unit, free angles go the short way."""

    model: Model

    @classmethod
    def of(cls, model: Model) -> Configurations:
        """The configurations of a model."""
        return cls(model.velocity_names, model)

    @property
    def shape(self) -> tuple[int, ...]:
        """(nq,)."""
        return (self.model.nq,)

    @property
    def columns(self) -> tuple[str, ...]:
        """The model's names of the entries of q."""
        return self.model.position_names

    def difference(self, a: Floats, b: Floats) -> Floats:
        """Difference on the manifold."""
        return algorithms.difference(self.model, a, b)


@final
@dataclass(frozen=True)
class Poses(Space):
    """Poses (4, 4); the directions are those of a twist along world axes, linear part first."""

    names: tuple[str, ...] = ("x", "y", "z", "rx", "ry", "rz")

    @property
    def shape(self) -> tuple[int, ...]:
        """(4, 4)."""
        return (4, 4)

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the entries, row by row."""
        return tuple(f"T{i}{j}" for i in range(4) for j in range(4))

    def difference(self, a: Floats, b: Floats) -> Floats:
        """The way of the origin [m], and the rotation vector of R_b R_a^T [rad], in world axes."""
        turn = so3_log(b[..., :3, :3] @ np.swapaxes(a[..., :3, :3], -1, -2))
        return np.concatenate([b[..., :3, 3] - a[..., :3, 3], turn], axis=-1)


@lru_cache(maxsize=64)
def _numbered(n: int) -> Vectors:
    return Vectors(tuple(f"q{k}" for k in range(n)))


def require_configurations(name: str, space: Space, model: Model) -> None:
    """Checks that a trajectory moves configurations of a model.

    Args:
        name: Name of the argument, for messages.
        space: What the trajectory moves.
        model: The robot.

    Raises:
        ShapeError: If the points are no configurations.
        InputError: If they are, but quaternions in them move as plain numbers, off the manifold.
    """
    if space.shape != (model.nq,):
        raise ShapeError(name, space.shape, f"({model.nq},), configurations of {model.name!r}")
    if space.n != model.nv:
        raise InputError(
            f"`{name}` moves the {model.nq} entries of q as plain numbers, but {model.name!r} has quaternions, which "
            "would not stay of unit length. Use straight(robot, ...) or straight_through(robot, ...)."
        )
