"""A world of named shapes that a robot must not touch; frozen, edited by making new ones."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, final

import numpy as np

from ulna import kernels
from ulna.checks.arrays import check_finite
from ulna.errors import InputError, ShapeError, UnknownName
from ulna.geometry import Mesh, Shape
from ulna.idioms import unknown_attribute
from ulna.model import Model
from ulna.model.content import fingerprint
from ulna.spatial import SE3
from ulna.system.cached import cached_property
from ulna.typing import ArrayLike, Floats


@final
@dataclass(frozen=True, eq=False)
class Obstacle:
    """A named shape in the world.

    Attributes:
        name: Its name, once in a world.
        shape: The shape in its own frame.
        pose: T_world_shape; of a moving obstacle, where it stands unless a call says otherwise.
        moving: Whether calls may give it another pose.
        touches: Names of links that may touch it: a base on a table, fingers around a part.
    """

    name: str
    shape: Shape
    pose: SE3
    moving: bool = False
    touches: tuple[str, ...] = ()


@final
@dataclass(frozen=True, eq=False)
class World:
    """Obstacles by name. Start from `World()` and add.

    A link that cannot move is not checked against an obstacle that cannot move: no motion changes what they do.
    """

    obstacles: tuple[Obstacle, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "obstacles", tuple(self.obstacles))
        taken: set[str] = set()
        for obstacle in self.obstacles:
            if obstacle.name in taken:
                raise InputError(
                    f"The world has an obstacle named {obstacle.name!r} already; expected a new name. "
                    "Take the old one out with `world.remove(name)`, or move it with `world.move(name, pose)`."
                )
            taken.add(obstacle.name)

    def add(
        self,
        name: str,
        shape: Shape,
        pose: SE3 | ArrayLike | None = None,
        *,
        moving: bool = False,
        touches: Iterable[str] = (),
    ) -> World:
        """The world with one more obstacle.

        Args:
            name: A new name.
            shape: A shape of `ulna.geometry`: Box, Sphere, Cylinder, Capsule, Cone, Ellipsoid, Plane, Mesh.
            pose: T_world_shape [m]: an SE3, an array of shape (4, 4), or a position of shape (3,); None for the
                world's origin.
            moving: Whether calls may give it another pose.
            touches: Names of links that may touch it.

        Returns:
            A new world.

        Raises:
            InputError: If the name is taken, or shape or pose cannot be one.
        """
        if not isinstance(name, str) or not name:
            raise InputError(f"`name` is {name!r}; expected a name for the obstacle.")
        if not isinstance(shape, Shape):
            raise InputError(
                f"Obstacle {name!r}: `shape` is {shape!r}; expected a shape of ulna.geometry, such as Box((1, 1, 0.1))."
            )
        if isinstance(touches, str):
            raise InputError(f"Obstacle {name!r}: `touches` is {touches!r}; expected a list of link names.")
        return World((*self.obstacles, Obstacle(name, shape, _pose(name, pose), moving, tuple(touches))))

    def remove(self, name: str) -> World:
        """The world without that obstacle. Raises UnknownName with the nearest one."""
        gone = self[name]
        return World(tuple(o for o in self.obstacles if o is not gone))

    def move(self, name: str, pose: SE3 | ArrayLike) -> World:
        """The world with an obstacle at another pose.

        Args:
            name: Its name.
            pose: T_world_shape [m]: an SE3, an array of shape (4, 4), or a position of shape (3,).

        Returns:
            A new world.

        Raises:
            UnknownName: no obstacle of that name; offers the nearest one.
        """
        old = self[name]
        new = replace(old, pose=_pose(name, pose))
        return World(tuple(new if o is old else o for o in self.obstacles))

    def add_robot(
        self,
        name: str,
        model: Model,
        q: ArrayLike | None = None,
        placement: SE3 | None = None,
        *,
        moving: bool = False,
    ) -> World:
        """The world with another robot in it, as obstacles named `name/link/number`.

        Args:
            name: What its obstacles' names begin with.
            model: The other robot's model (`robot.model`).
            q: Its configuration, shape (nq,) [rad, m]; None for neutral.
            placement: T_world_base, where its world stands in this one [m]; None for the origin.
            moving: Whether calls may move it, with `robot_poses` of its new configurations.

        Returns:
            A new world.

        Raises:
            InputError: If the name is taken.
        """
        world, poses = self, robot_poses(name, model, model.neutral if q is None else q, placement)
        for link in model.links:
            for k, geometry in enumerate(link.collisions):
                key = f"{name}/{link.name}/{k}"
                world = world.add(key, geometry.shape, poses[key], moving=moving)
        return world

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The names of the obstacles, in order."""
        return tuple(o.name for o in self.obstacles)

    @cached_property
    def fingerprint(self) -> str:
        """SHA-256 of the content; meshes count by their whole path here."""
        paths = [o.shape.path for o in self.obstacles if isinstance(o.shape, Mesh)]
        parts = [[o.name, o.shape, o.pose, o.moving, list(o.touches)] for o in self.obstacles]
        return fingerprint([parts, paths])

    def __getattr__(self, name: str) -> Any:
        raise unknown_attribute("world", name, dir(type(self)))

    def __len__(self) -> int:
        return len(self.obstacles)

    def __iter__(self) -> Iterator[Obstacle]:
        return iter(self.obstacles)

    def __contains__(self, name: object) -> bool:
        return name in self.names

    def __getitem__(self, name: str) -> Obstacle:
        for obstacle in self.obstacles:
            if obstacle.name == name:
                return obstacle
        raise UnknownName("obstacle", name, self.names)

    def moving(self, name: str) -> Obstacle:
        """The obstacle of that name, which calls may move.

        Raises:
            UnknownName: There is no such obstacle.
            InputError: It does not move.
        """
        obstacle = self[name]
        if not obstacle.moving:
            raise InputError(
                f"Obstacle {name!r} does not move, and a pose was given for it. "
                "Add it with moving=True, or make another world with `world.move(name, pose)`."
            )
        return obstacle

    def __repr__(self) -> str:
        return (
            f"<world of {len(self)} obstacles: {', '.join(self.names[:8])}{' ...' if len(self) > 8 else ''}>"
        )


def robot_poses(name: str, model: Model, q: ArrayLike, placement: SE3 | None = None) -> Mapping[str, Floats]:
    """Where the obstacles of a robot stand that was added to a world.

    Args:
        name: The name it was added as.
        model: Its model.
        q: Its configurations, shape (..., nq) [rad, m].
        placement: T_world_base, where its world stands in this one [m]; None for the origin.

    Returns:
        Poses by name of the obstacle, shape (..., 4, 4) [m].
    """
    links = [link for link in model.links if link.collisions]
    fk = kernels.kernel(model, "fk", checked=True, frame=tuple(link.name for link in links))
    poses = fk(np.asarray(q, dtype=float))
    if placement is not None:
        poses = placement.matrix() @ poses
    return {
        f"{name}/{link.name}/{k}": poses[..., i, :, :] @ geometry.placement.matrix()
        for i, link in enumerate(links)
        for k, geometry in enumerate(link.collisions)
    }


def _pose_of(name: str, array: Floats) -> SE3:
    if array.shape == (3,):
        return SE3.from_translation(array)
    if array.shape[-2:] == (4, 4):
        return SE3.from_matrix(array)
    advice = {
        (7,): "Of a position and a quaternion x, y, z, w: SE3.from_quat_xyzw(pose[3:], pose[:3]).",
        (6,): "Of a position and roll, pitch, yaw: SE3.from_rpy(pose[3:], pose[:3]).",
        (3, 3): "Of a rotation: SE3.from_rotation(R, position).",
    }
    raise ShapeError(
        f"pose of obstacle {name!r}",
        array.shape,
        "an SE3, (4, 4), or a position (3,)",
        advice.get(array.shape, ""),
    )


def _pose(name: str, pose: SE3 | ArrayLike | None) -> SE3:
    if pose is None:
        return SE3.identity()
    if isinstance(pose, SE3):
        checked = pose
    else:
        checked = _pose_of(name, np.asarray(pose, dtype=float))
    matrix: Any = checked.matrix()
    if matrix.shape != (4, 4):
        raise InputError(
            f"Obstacle {name!r}: `pose` is a batch of shape {matrix.shape[:-2]}; expected one pose."
        )
    check_finite(f"pose of obstacle {name!r}", matrix)
    return checked
