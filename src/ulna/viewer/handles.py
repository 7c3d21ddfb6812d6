"""What `Viewer.add` and its kin give: things of the scene that are assigned to, and refuse what they do not have."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.checks.arrays import length_array, scale_factors
from ulna.checks.values import MAX_LENGTH, flag, fraction, length, number
from ulna.errors import ShapeError
from ulna.typing import ArrayLike, Floats
from ulna.viewer.assigned import Assigned
from ulna.viewer.colours import Colour
from ulna.viewer.content import Content, Copies, Lines, Points, Text, transforms
from ulna.viewer.node import checked_poses
from ulna.viewer.scene import Scene
from ulna.viewer.surface import colour, unit

_NONE = -1.0


class Handle(Assigned):
    """A thing of the scene. Its pose, colour, opacity, scale and visibility can be assigned to at any time.

    For a group they hold for all that is in it. What it does not have cannot be assigned to.
    """

    __slots__ = ("_name", "_scene")

    def __init__(self, scene: Scene, name: str) -> None:
        self._scene, self._name = scene, name

    @property
    def name(self) -> str:
        """Its name in the scene, with its groups."""
        return self._name

    @property
    def pose(self) -> Floats:
        """Where it is in its group: T_group_thing, shape (4, 4).

        An `SE3` can be assigned, too, and a place (3,), where it stands unturned.
        """
        return self._scene.pose(self._name)

    @pose.setter
    def pose(self, pose: Any) -> None:
        self._scene.set_pose(self._name, pose)

    @property
    def position(self) -> Floats:
        """Where it is in its group [m], shape (3,)."""
        return self.pose[:3, 3]

    @position.setter
    def position(self, position: ArrayLike) -> None:
        pose = self.pose
        pose[:3, 3] = length_array("position", position, 3)
        self._scene.set_pose(self._name, pose)

    @property
    def world_pose(self) -> Floats:
        """Where it is in the world: T_world_thing, shape (4, 4)."""
        seen = self._scene.snapshot()
        return seen.poses[self._scene.row(self._name)]

    @property
    def color(self) -> tuple[float, float, float] | None:
        """Red, green, blue from 0 to 1 that hide its own colours; None to show these."""
        tint = self._scene.look(self._name, "tint")
        return None if tint[0] == _NONE else (float(tint[0]), float(tint[1]), float(tint[2]))

    @color.setter
    def color(self, color: Colour | None) -> None:
        self._scene.set_look(self._name, "tint", np.full(3, _NONE) if color is None else colour(color)[:3])

    @property
    def opacity(self) -> float:
        """From 0, not to be seen, to 1."""
        return float(self._scene.look(self._name, "opacity"))

    @opacity.setter
    def opacity(self, opacity: float) -> None:
        self._scene.set_look(self._name, "opacity", fraction("opacity", opacity))

    @property
    def scale(self) -> Floats:
        """A factor along each axis, shape (3,); one number can be assigned for all three."""
        return self._scene.look(self._name, "scale")

    @scale.setter
    def scale(self, scale: ArrayLike) -> None:
        self._scene.set_look(self._name, "scale", scale_factors("scale", scale))

    @property
    def visible(self) -> bool:
        """Whether it can be seen."""
        return bool(self._scene.look(self._name, "visible"))

    @visible.setter
    def visible(self, visible: bool) -> None:
        self._scene.set_look(self._name, "visible", flag("visible", visible))

    def remove(self) -> None:
        """Take it out of the scene, with all that is in it."""
        self._scene.remove(self._name)

    def __repr__(self) -> str:
        return f"<{self._title()}>"

    def _title(self) -> str:
        return f"{type(self).__name__} {self._name!r}"

    def _content(self) -> Any:
        return self._scene.node(self._name).content


class Cloud(Handle):
    """Points; `points` and `colors` can be assigned to."""

    __slots__ = ()

    @property
    def points(self) -> Floats:
        """Where they are [m], shape (n, 3)."""
        return self._content().positions

    @points.setter
    def points(self, points: ArrayLike) -> None:
        old: Points = self._content()
        points, colours = length_array("points", points, None, 3), old.colours
        if len(colours) != len(points):
            if len(colours) and not (colours == colours[0]).all():
                raise ShapeError(
                    "points", points.shape, f"({len(colours)}, 3)", "Or set `set(points, colors)`."
                )
            colours = colours[0] if len(colours) else np.full(3, 0.5)
        self._scene.set_content(self._name, Points(points, colours, old.size))

    @property
    def colors(self) -> Floats:
        """Red, green, blue from 0 to 1 of each, shape (n, 3); one colour can be assigned for all."""
        return self._content().colours

    @colors.setter
    def colors(self, colors: ArrayLike) -> None:
        old: Points = self._content()
        self._scene.set_content(self._name, Points(old.positions, colors, old.size))

    def set(self, points: ArrayLike, colors: ArrayLike) -> None:
        """Other points and their colours at once."""
        self._scene.set_content(
            self._name, Points(length_array("points", points, None, 3), colors, self._content().size)
        )


class Path(Handle):
    """A line from point to point; `points` can be assigned to."""

    __slots__ = ()

    @property
    def points(self) -> Floats:
        """Its points [m], shape (n, 3)."""
        segments = self._content().segments
        return np.concatenate([segments[:1, 0], segments[:, 1]])

    @points.setter
    def points(self, points: ArrayLike) -> None:
        old: Lines = self._content()
        self._scene.set_content(self._name, Lines.through(points, old.rgba, old.thickness))


class Words(Handle):
    """Words that face whoever looks; `text` can be assigned to."""

    __slots__ = ()

    @property
    def text(self) -> str:
        """What they say."""
        return self._content().words

    @text.setter
    def text(self, text: str) -> None:
        self._scene.set_content(self._name, Text(text, self._content().height))


class Crowd(Handle):
    """One thing at many places; `poses`, `positions` and `colors` can be assigned to."""

    __slots__ = ()

    @property
    def poses(self) -> Floats:
        """T_group_copy of each, shape (n, 4, 4)."""
        return self._content().poses

    @poses.setter
    def poses(self, poses: ArrayLike) -> None:
        self._change(poses=checked_poses(poses, "poses", None, 4, 4))

    @property
    def positions(self) -> Floats:
        """Where they are [m], shape (n, 3)."""
        return self._content().poses[:, :3, 3]

    @positions.setter
    def positions(self, positions: ArrayLike) -> None:
        poses = transforms(positions)
        old = self._content().poses
        if len(old) == len(poses):
            poses[:, :3, :3] = old[:, :3, :3]
        self._change(poses=poses)

    @property
    def colors(self) -> Floats | None:
        """Red, green, blue from 0 to 1 of each, shape (n, 3); None for the thing's own."""
        return self._content().colours

    @colors.setter
    def colors(self, colors: ArrayLike | None) -> None:
        self._change(colours=colors)

    def _change(self, **news: Any) -> None:
        old: Copies = self._content()
        kept = {"poses": old.poses, "colours": old.colours, "scales": old.scales} | news
        if len(kept["poses"]) != len(old.poses):
            fits = old.scales is not None and len(old.scales) and (old.scales == old.scales[0]).all()
            kept["scales"] = old.scales[0] if fits and old.scales is not None else None
            if old.colours is not None:
                kept["colours"] = old.colours[0] if len(old.colours) else None
        content: Content = Copies(old.original, opacity=old.opacity, **kept)
        self._scene.set_content(self._name, content)


class Arrow(Handle):
    """An arrow from its origin along a vector; `vector` and `size` can be assigned to."""

    __slots__ = ("_radius", "_size", "_vector")

    def __init__(self, scene: Scene, name: str, vector: ArrayLike, radius: float, size: float = 1.0) -> None:
        super().__init__(scene, name)
        self._radius, self._vector = length("radius", radius), np.zeros(3)
        self.size = size
        self.vector = vector

    @property
    def vector(self) -> Floats:
        """What it tells of, in its group's axes, shape (3,): a way [m], or a force [N], a velocity [m/s] ..."""
        return self._vector.copy()

    @vector.setter
    def vector(self, vector: ArrayLike) -> None:
        self._vector = length_array("vector", vector, 3)
        self._draw()

    @property
    def size(self) -> float:
        """How long it is drawn for each unit of `vector` [m]."""
        return self._size

    @size.setter
    def size(self, size: float) -> None:
        self._size = number("size", size, "metres for each unit, above zero", above=0.0, most=MAX_LENGTH)
        self._draw()

    def _draw(self) -> None:
        way = self._size * float(np.linalg.norm(self._vector))
        tip = min(5.0 * self._radius, 0.5 * way)
        pose, top = self.pose, np.eye(4)
        pose[:3, :3] = rotation_to(self._vector)
        top[2, 3] = way - tip
        least = 1e-9  # nothing has no direction
        with self._scene.together():
            self._scene.set_pose(self._name, pose)
            self._scene.set_pose(f"{self._name}/tip", top)
            thin = self._radius if way > least else least
            self._scene.set_look(f"{self._name}/shaft", "scale", (thin, thin, max(way - tip, least)))
            self._scene.set_look(f"{self._name}/tip", "scale", (2.4 * thin, 2.4 * thin, max(tip, least)))


def rotation_to(vector: Floats) -> Floats:
    """A rotation (3, 3) that takes z to the direction of a vector."""
    z = unit(vector)
    helper = np.array([1.0, 0.0, 0.0]) if abs(z[0]) < 0.9 else np.array([0.0, 1.0, 0.0])
    x = unit(np.cross(helper, z))
    return np.stack([x, np.cross(z, x), z], axis=1)
