"""Collision checks of collision-free inverse kinematics: by the exact shapes, or by covering spheres."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TypeAlias

import numpy as np

from ulna.collision import Checker, SphereChecker
from ulna.collision.touches import deepest_touch
from ulna.data_classes import dataclass
from ulna.model import Model
from ulna.typing import Array, ArrayLike, Floats

_SCREENED = 64
"""Configurations from which on spheres are asked before coal."""

Moving: TypeAlias = Mapping[str, ArrayLike] | None
"""Poses of the world's moving obstacles by name, T_world_shape (4, 4) [m]."""


@dataclass(frozen=True, eq=False)
class Distances:
    """How far everything is apart in several configurations.

    Attributes:
        lengths: The least distance in each, negative where things overlap, shape (n,) [m].
        names: From the number of a configuration to the names of the two that are nearest.
    """

    lengths: Floats
    names: Callable[[int], tuple[str, str]]


@dataclass(frozen=True, eq=False)
class Contacts:
    """A check of one robot in one world.

    Attributes:
        model: The robot's model.
        touching: From configurations (n, nq), a margin [m] and `Moving` to which of them touch anything, or come nearer
            than the margin, (n,).
        distances: From configurations (n, nq) and `Moving` to how far everything is apart.
    """

    model: Model
    touching: Callable[[Floats, float, Moving], Array]
    distances: Callable[[Floats, Moving], Distances]


def exact_contacts(checker: Checker, screen: Callable[[], SphereChecker | None]) -> Contacts:
    """The check by the exact shapes.

    Args:
        checker: The exact check.
        screen: Makes the check by spheres, for large batches; it may return None.

    Returns:
        The check.
    """

    def touching(q: Floats, margin: float, moving: Moving) -> Array:
        is_touching = np.ones(len(q), dtype=bool)
        spheres = screen() if len(q) >= _SCREENED and not moving else None
        if spheres is not None:  # what its spheres do not touch it does not touch
            is_touching = spheres.collides(q, margin=margin)
        is_touching[is_touching] = checker.collides(q[is_touching], moving, margin=margin)
        return is_touching

    def distances(q: Floats, moving: Moving) -> Distances:
        nearest = checker.distance(q, moving)
        return Distances(nearest.distance, lambda number: tuple(nearest.names[number]))

    return Contacts(checker.model, touching, distances)


def sphere_contacts(checker: SphereChecker) -> Contacts:
    """The check by covering spheres, which contain the shapes: what it calls free is free.

    Args:
        checker: The check by spheres.

    Returns:
        The check.
    """

    def distances(q: Floats, moving: Moving) -> Distances:
        lengths = checker.clearance(q, moving)
        return Distances(lengths, lambda number: deepest_touch(checker, q[number], moving)[1:])

    return Contacts(
        checker.model, lambda q, margin, moving: checker.collides(q, moving, margin=margin), distances
    )
