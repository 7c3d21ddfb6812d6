"""What can be collided with: how near two solids are, through `ulna.collision`; and solids that move together."""

from __future__ import annotations

import abc
import functools
import warnings
from collections.abc import Iterable
from typing import Any

import numpy as np

from spatialgeometry._node import Members
from spatialgeometry._shape import Shape, box_corners
from ulna import geometry
from ulna.errors import InputError
from ulna.system import forks
from ulna.typing import Floats

__all__ = ["CollisionShape", "CollisionShapeGroup"]

_LOCK = forks.lock()  # coal's requests and results are not for two threads at once


class CollisionShape(Shape):
    """A solid.

    Args:
        collision: Whether it can be collided with.
        kwargs: As for `Shape`.
    """

    def __init__(self, collision: bool = True, **kwargs: Any) -> None:
        self._collision = bool(collision)
        super().__init__(**kwargs)

    @property
    def collision(self) -> bool:
        """Whether it can be collided with."""
        return self._collision

    def __getattr__(self, name: str) -> Any:
        if name == "co":
            raise AttributeError(
                "`co` is the compiled part of a solid; closest_point and iscollided answer for it."
            )
        raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")

    @property
    @abc.abstractmethod
    def solid(self) -> Any:
        """The shape of `ulna.geometry` that it is."""

    def _draw(self, viewer: Any, name: str) -> None:
        viewer.add(self.solid, name=name)

    def _box(self) -> Floats:
        centre, half = _solid(self.solid).bounds
        return box_corners(np.stack([centre - half, centre + half], axis=1))

    def _parts(self) -> list[CollisionShape]:
        if not self._collision:
            raise InputError(f"{self!r} was made with collision=False; it cannot be collided with.")
        return [self]

    def closest_point(
        self, shape: CollisionShape, inf_dist: float = 1.0
    ) -> tuple[float | None, Floats | None, Floats | None]:
        """How near another solid is.

        Args:
            shape: The other.
            inf_dist: What is farther than this is not looked at [m].

        Returns:
            The distance [m], negative where they overlap, and the nearest points on this and on the other in the
            world, (3,); three times None where it is farther.

        Raises:
            InputError: One of them cannot be collided with.
            MissingExtra: coal is not installed.
        """
        if not isinstance(shape, CollisionShape):
            raise InputError(
                f"Cannot measure how near {shape!r} is; expected a solid: Cuboid, Sphere, Mesh ..."
            )
        distances = [_distance(a, b) for a in self._parts() for b in shape._parts()]
        nearest = min(distances, key=lambda f: f.distance, default=None)
        if nearest is None or nearest.distance > inf_dist:
            return None, None, None
        return nearest.distance, nearest.points[0], nearest.points[1]

    def iscollided(self, shape: CollisionShape) -> bool:
        """Whether it touches another solid."""
        distance = self.closest_point(shape, np.inf)[0]
        return distance is not None and distance <= 0.0

    def collided(self, shape: CollisionShape) -> bool:
        """The former name of `iscollided`."""
        warnings.warn("collided is the former name of iscollided", FutureWarning, stacklevel=2)
        return self.iscollided(shape)


@functools.lru_cache(maxsize=1024)
def _solid(shape: geometry.Shape) -> Any:
    from ulna.collision.solids import obstacle_solids
    from ulna.collision.world import World

    return obstacle_solids(World().add("shape", shape))[0]


@functools.lru_cache(maxsize=1024)
def _narrow(first: geometry.Shape, second: geometry.Shape) -> Any:
    from ulna.collision.narrow import Narrow, geometry_of

    return Narrow([geometry_of(_solid(s), convex=False) for s in (first, second)], np.zeros((2, 2)))


def _distance(first: CollisionShape, second: CollisionShape) -> Any:
    from ulna.collision.narrow import Poses

    poses = np.stack([first._wT, second._wT])[None]
    nothing = np.zeros((1, 2, 3))
    with _LOCK:
        placed = Poses(poses[..., :3, :3], poses[..., :3, 3], nothing, nothing)
        return _narrow(first.solid, second.solid).distance(placed, 0, 0, 1)


class CollisionShapeGroup(CollisionShape, Members):
    """Solids that move together and are collided with as one: a list of them, with a common pose."""

    kind = "group"

    def __init__(self, initlist: Iterable[CollisionShape] | None = None, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.extend(initlist or ())

    def _fit(self, item: Any) -> CollisionShape:
        if not isinstance(item, CollisionShape):
            raise TypeError(f"A CollisionShapeGroup holds solids; got {item!r}.")
        return item

    @property
    def solid(self) -> Any:
        """A group is no single solid."""
        raise InputError("A CollisionShapeGroup is no single solid; take its members.")

    def _parts(self) -> list[CollisionShape]:
        return [part for member in self._children for part in member._parts()]

    def _box(self) -> Floats:
        if not self._children:
            raise InputError("An empty CollisionShapeGroup has no box around it.")
        return np.concatenate(
            [member.T[:3, :3] @ member._box() + member.T[:3, 3:] for member in self._children], 1
        )

    def _draw(self, viewer: Any, name: str) -> None:
        viewer.group(name)
        for k, member in enumerate(self._children):
            member.draw(viewer, f"{name}/{k}")
            viewer[f"{name}/{k}"].pose = member.T

    def _set_colour(self, handle: Any) -> None:
        """Members keep their colours."""

    def to_dict(self) -> dict[str, Any]:
        """What it is and where, and its members."""
        return {**super().to_dict(), "shapes": [member.to_dict() for member in self._children]}

    def __repr__(self) -> str:
        return Members.__repr__(self)
