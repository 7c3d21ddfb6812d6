"""Handles of nodes: `Viewer.add` returns them, and their properties can be assigned to."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.checks.arrays import length_array, read_only, scale_factors
from ulna.checks.attributes import FixedAttributes
from ulna.checks.values import flag, fraction
from ulna.errors import ShapeError
from ulna.idioms import Explained, explained
from ulna.typing import ArrayLike, Floats
from ulna.viewer.colours import Colour, colour_parts, colours_parts
from ulna.viewer.graph.content import Content, Copies, Lines, Points, Text, transforms
from ulna.viewer.graph.node import checked_poses
from ulna.viewer.graph.scene_graph import SceneGraph

_NONE = -1.0


@explained("handle")
class Handle(FixedAttributes, metaclass=Explained):
    """A thing of the scene. Its pose, colour, opacity, scale and visibility can be assigned to at any time.

    For a group they hold for all that is in it. What it does not have cannot be assigned to.

    Args:
        scene: The scene.
        name: The name of the thing.
    """

    __slots__ = ("_name", "_scene")

    def __init__(self, scene: SceneGraph, name: str) -> None:
        self._scene, self._name = scene, name

    @property
    def scene(self) -> SceneGraph:
        """The scene that contains it."""
        return self._scene

    @property
    def name(self) -> str:
        """Its name in the scene, with its groups."""
        return self._name

    @property
    def pose(self) -> Floats:
        """Where it is in its group: T_group_thing, shape (4, 4), read-only: assign all of it.

        An `SE3` can be assigned, too, and a place (3,), where it stands unturned.
        """
        return read_only(self._scene.pose(self._name))

    @pose.setter
    def pose(self, pose: Any) -> None:
        self._scene.set_pose(self._name, pose)

    @property
    def position(self) -> Floats:
        """Where it is in its group [m], shape (3,), read-only: assign all of it."""
        return self.pose[:3, 3]

    @position.setter
    def position(self, position: ArrayLike) -> None:
        pose = self._scene.pose(self._name)
        pose[:3, 3] = length_array("position", position, 3)
        self._scene.set_pose(self._name, pose)

    @property
    def world_pose(self) -> Floats:
        """Where it is in the world: T_world_thing, shape (4, 4), read-only."""
        snapshot = self._scene.snapshot()
        return read_only(snapshot.poses[self._scene.row(self._name)])

    @property
    def color(self) -> tuple[float, float, float] | None:
        """Red, green, blue from 0 to 1 that hide its own colours; None to show these.

        A colour with an opacity, such as (1, 0, 0, 0.5) or "#ff000080", sets `opacity`, too.
        """
        tint = self._scene.appearance(self._name, "tint")
        return None if tint[0] == _NONE else (float(tint[0]), float(tint[1]), float(tint[2]))

    @color.setter
    def color(self, color: Colour | None) -> None:
        rgb, opacity = (np.full(3, _NONE), None) if color is None else colour_parts(color)
        with self._scene.atomic():
            self._scene.set_appearance(self._name, "tint", rgb)
            self._set_opacity(opacity)

    @property
    def opacity(self) -> float:
        """From 0, not to be seen, to 1."""
        return float(self._scene.appearance(self._name, "opacity"))

    @opacity.setter
    def opacity(self, opacity: float) -> None:
        self._scene.set_appearance(self._name, "opacity", fraction("opacity", opacity))

    @property
    def scale(self) -> Floats:
        """A factor along each axis, shape (3,), read-only; one number can be assigned for all three."""
        return read_only(self._scene.appearance(self._name, "scale"))

    @scale.setter
    def scale(self, scale: ArrayLike) -> None:
        self._scene.set_appearance(self._name, "scale", scale_factors("scale", scale))

    @property
    def visible(self) -> bool:
        """Whether it can be seen."""
        return bool(self._scene.appearance(self._name, "visible"))

    @visible.setter
    def visible(self, visible: bool) -> None:
        self._scene.set_appearance(self._name, "visible", flag("visible", visible))

    def _set_opacity(self, opacity: float | None) -> None:
        """Take over the opacity that a colour states, if any."""
        if opacity is not None:
            self._scene.set_appearance(self._name, "opacity", opacity)

    def remove(self) -> None:
        """Take it out of the scene, with all that is in it."""
        self._scene.remove(self._name)

    def __repr__(self) -> str:
        return f"<{self._title()}>"

    def _title(self) -> str:
        return f"{type(self).__name__} {self._name!r}"

    def _content(self) -> Any:
        return self._scene.node(self._name).content


class PointCloud(Handle):
    """Points; `points` and `colors` can be assigned to."""

    __slots__ = ()

    @property
    def points(self) -> Floats:
        """Where they are [m], shape (n, 3), read-only: assign all of them."""
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
        """Red, green, blue from 0 to 1 of each, shape (n, 3), read-only.

        One colour can be assigned for all, as `color`.
        """
        return self._content().colours

    @colors.setter
    def colors(self, colors: ArrayLike | str) -> None:
        self.set(self._content().positions, colors)

    def set(self, points: ArrayLike, colors: ArrayLike | str) -> None:
        """Replace points and their colours at once.

        Args:
            points: Positions, (n, 3) [m].
            colors: Red, green, blue from 0 to 1, or to 255 as integers, (n, 3) or (3,); or a name. One colour may have
                an opacity, which is assigned to `opacity`.
        """
        rgb, opacity = colours_parts(colors)
        content = Points(length_array("points", points, None, 3), rgb, self._content().size)
        with self._scene.atomic():
            self._scene.set_content(self._name, content)
            self._set_opacity(opacity)


class Polyline(Handle):
    """A line from point to point; `points` can be assigned to."""

    __slots__ = ()

    @property
    def points(self) -> Floats:
        """Its points [m], shape (n, 3), read-only: assign all of them."""
        self._scene.update_deferred()  # the path of a robot is drawn later than the robot moves
        segments = self._content().segments
        return read_only(np.concatenate([segments[:1, 0], segments[:, 1]]))

    @points.setter
    def points(self, points: ArrayLike) -> None:
        old: Lines = self._content()
        self._scene.set_content(self._name, Lines.through(points, old.rgba, old.thickness))


class Label(Handle):
    """Text that faces the camera; `text` can be assigned to."""

    __slots__ = ()

    @property
    def text(self) -> str:
        """What they say."""
        return self._content().text

    @text.setter
    def text(self, text: str) -> None:
        self._scene.set_content(self._name, Text(text, self._content().height))


class Instances(Handle):
    """One thing at many places; `poses`, `positions` and `colors` can be assigned to."""

    __slots__ = ()

    @property
    def poses(self) -> Floats:
        """T_group_copy of each, shape (n, 4, 4), read-only: assign all of them."""
        return self._content().poses

    @poses.setter
    def poses(self, poses: ArrayLike) -> None:
        self._change(poses=checked_poses(poses, "poses", None, 4, 4))

    @property
    def positions(self) -> Floats:
        """Where they are [m], shape (n, 3), read-only: assign all of them."""
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
        """Red, green, blue from 0 to 1 of each, shape (n, 3), read-only; None for the thing's own.

        One colour can be assigned for all, as `color`.
        """
        return self._content().colours

    @colors.setter
    def colors(self, colors: ArrayLike | str | None) -> None:
        rgb, opacity = colours_parts(colors)
        with self._scene.atomic():
            self._change(colours=rgb)
            self._set_opacity(opacity)

    def _change(self, **changes: Any) -> None:
        old: Copies = self._content()
        fields = {"poses": old.poses, "colours": old.colours, "scales": old.scales} | changes
        if len(fields["poses"]) != len(old.poses):
            fits = old.scales is not None and len(old.scales) and (old.scales == old.scales[0]).all()
            fields["scales"] = old.scales[0] if fits and old.scales is not None else None
            if old.colours is not None:
                fields["colours"] = old.colours[0] if len(old.colours) else None
        content: Content = Copies(old.original, opacity=old.opacity, **fields)
        self._scene.set_content(self._name, content)
