"""The scene graph: a tree of named nodes with poses and appearances, independent of the renderer."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from contextlib import AbstractContextManager
from dataclasses import replace
from typing import Any

import numpy as np

from ulna.checks.arrays import read_only
from ulna.checks.attributes import FixedAttributes
from ulna.errors import UnknownName
from ulna.idioms import unknown_attribute
from ulna.system import forks
from ulna.typing import Array, ArrayLike, Floats
from ulna.viewer.colours import Colour
from ulna.viewer.graph.content import Content, Lines
from ulna.viewer.graph.node import Node, Snapshot, check_name, check_uniform_scale, pose_or_position
from ulna.viewer.mesh.primitives import axes
from ulna.viewer.mesh.surface import Surface, colour

_NO_TINT = -1.0

_COLUMNS: dict[str, tuple[Any, type]] = {
    "pose": (np.eye(4), float),
    "scale": (np.ones(3), float),
    "visible": (True, bool),
    "opacity": (1.0, float),
    "tint": (np.full(3, _NO_TINT), float),
}


class _Changes:
    """How often the set of nodes, poses, and looks changed; counted in less time than by the scene itself."""

    __slots__ = ("appearance", "motion", "structure")

    def __init__(self) -> None:
        self.structure = self.motion = self.appearance = 0


class SceneGraph(FixedAttributes):
    """A tree of named nodes: `arm/hand/finger` belongs to `arm/hand`, which belongs to `arm`.

    Groups appear by themselves. A node's pose is in its group's frame; a
    group's colour, opacity, scale and visibility hold for all in it.

    All methods may be called from any thread. Writing a pose takes about a microsecond; a renderer takes a `snapshot`
    when it is ready, so that a slow renderer does not slow down the program.
    """

    __slots__ = (
        "__weakref__",
        "_changes",
        "_data",
        "_deferred",
        "_lock",
        "_nodes",
        "_parent_row",
        "_rows",
        "_rows_by_depth",
    )

    def __init__(self) -> None:
        self._lock = forks.lock()
        self._nodes: dict[str, Node] = {}
        self._rows: dict[str, int] = {}
        self._parent_row = np.zeros(0, dtype=np.intp)
        self._data = {name: np.zeros((0, *np.shape(value)), kind) for name, (value, kind) in _COLUMNS.items()}
        self._rows_by_depth: list[tuple[Array, Array]] | None = []
        self._deferred: dict[int, Callable[[], None]] = {}
        self._changes = _Changes()

    @property
    def names(self) -> tuple[str, ...]:
        """The nodes' names, in the order of `poses`."""
        with self._lock:
            return tuple(self._nodes)

    @property
    def nodes(self) -> tuple[Node, ...]:
        """The nodes, in the order of `poses`."""
        with self._lock:
            return tuple(self._nodes.values())

    @property
    def poses(self) -> Floats:
        """The world poses T_world_node, shape (n, 4, 4), read-only."""
        return read_only(self.snapshot().poses)

    @property
    def version(self) -> tuple[int, int, int]:
        """Three counters: changes of the set of nodes, of poses, of looks."""
        return self._changes.structure, self._changes.motion, self._changes.appearance

    def __contains__(self, name: object) -> bool:
        return name in self._nodes

    def __getattr__(self, name: str) -> Any:
        raise unknown_attribute("scene", name, dir(type(self)))

    def snapshot(self) -> Snapshot:
        """The whole scene at one instant."""
        with self._lock:
            self.update_deferred()
            n = len(self._nodes)
            pose, scale, visible, opacity, tint = (self._data[name][:n].copy() for name in _COLUMNS)
            for rows, above in self._depth_levels():
                factor = scale[above, 0]
                pose[rows, :3, 3] *= factor[:, None]
                pose[rows] = pose[above] @ pose[rows]
                scale[rows] *= factor[:, None]
                visible[rows] &= visible[above]
                opacity[rows] *= opacity[above]
                has_tint = tint[rows, :1] != _NO_TINT
                tint[rows] = np.where(has_tint, tint[rows], tint[above])
            nodes = tuple(self._nodes.values())
            return Snapshot(*self.version, nodes, pose, scale, visible, opacity, tint)

    def _depth_levels(self) -> list[tuple[Array, Array]]:
        """Rows of nodes in groups and the rows of these groups, outermost first."""
        if self._rows_by_depth is None:
            depth = np.zeros(len(self._nodes), dtype=np.intp)
            for row, above in enumerate(self._parent_row[: len(depth)]):
                depth[row] = 0 if above < 0 else depth[above] + 1
            chosen = [np.flatnonzero(depth == d) for d in range(1, int(depth.max(initial=0)) + 1)]
            self._rows_by_depth = [(rows, self._parent_row[rows]) for rows in chosen]
        return self._rows_by_depth

    def atomic(self) -> AbstractContextManager[Any]:
        """A context within which all changes become visible together. Keep it short: renderers wait meanwhile."""
        return self._lock

    def defer(self, key: object, function: Callable[[], None]) -> None:
        """Call `function`, which updates the scene, before the next snapshot; for each key only the newest function.

        Args:
            key: An object that stands for what is updated.
            function: The update.
        """
        with self._lock:
            self._deferred[id(key)] = function
            self._changes.motion += 1

    def update_deferred(self) -> None:
        """Make the updates now that wait for the next snapshot."""
        with self._lock:
            while self._deferred:
                self._deferred.pop(next(iter(self._deferred)))()

    def node(self, name: str) -> Node:
        """The node of that name.

        Raises:
            UnknownName: There is none.
        """
        self.row(name)
        return self._nodes[name]

    def row(self, name: str) -> int:
        """The row of a node in `poses`.

        Raises:
            UnknownName: There is no node of that name.
        """
        try:
            return self._rows[name]
        except KeyError:
            raise UnknownName("object in the scene", name, self._nodes) from None

    def rows(self, names: Iterable[str]) -> Any:
        """The rows of several nodes, for `set_poses`. They hold until a node is removed."""
        rows = np.array([self.row(n) for n in names], dtype=np.intp)
        if len(rows) and np.array_equal(rows, np.arange(rows[0], rows[0] + len(rows))):
            return slice(int(rows[0]), int(rows[0]) + len(rows))  # writes faster than an array of rows
        return rows

    def add(
        self,
        name: str,
        surfaces: Iterable[Surface] = (),
        pose: ArrayLike | None = None,
        shadow: bool = True,
        through: bool = False,
        content: Content | None = None,
    ) -> Node:
        """Add a node and the groups in its name; or replace the node of that name.

        Args:
            name: Its name.
            surfaces: What it looks like.
            pose: T_group_node, shape (4, 4); the identity when not given.
            shadow: Whether it casts a shadow.
            through: Whether pictures show it, translucent, in front of what occludes it.
            content: What else is there to see.

        Returns:
            The node.

        Raises:
            InputError: It is no name, or the group is stretched.
            ShapeError, NonFiniteError: `pose` is no pose.
        """
        check_name(name)
        matrix = np.eye(4) if pose is None else pose_or_position(pose)
        node = Node(name, tuple(surfaces), content, shadow, through)
        with self._lock:
            if node.group and node.group not in self._nodes:
                self.add(node.group)
            above = self._rows[node.group] if node.group else -1
            if above >= 0:
                check_uniform_scale(node.group, self._data["scale"][above])
            if name not in self._nodes:
                self._append(name, above)
            for key, (value, _) in _COLUMNS.items():
                self._data[key][self._rows[name]] = matrix if key == "pose" else value
            self._nodes[name] = node
            self._changes.structure += 1
        return node

    def _append(self, name: str, parent: int) -> None:
        row = self._rows[name] = len(self._nodes)
        if row == len(self._parent_row):  # twice as many rows, so that adding many stays cheap
            more = max(row, 16)
            self._parent_row = np.concatenate([self._parent_row, np.full(more, -1, dtype=np.intp)])
            for key, (value, kind) in _COLUMNS.items():
                defaults = np.broadcast_to(np.asarray(value, kind), (more, *np.shape(value)))
                self._data[key] = np.concatenate([self._data[key], defaults])
        self._parent_row[row] = parent
        self._rows_by_depth = None

    def remove(self, name: str) -> None:
        """Remove a node and everything in it.

        Raises:
            UnknownName: There is no node of that name.
        """
        with self._lock:
            self.row(name)
            keep = [row for n, row in self._rows.items() if n != name and not n.startswith(f"{name}/")]
            new_row = np.full(len(self._nodes) + 1, -1, dtype=np.intp)
            new_row[keep] = np.arange(len(keep))
            names = [n for n in self._nodes if n != name and not n.startswith(f"{name}/")]
            self._nodes = {n: self._nodes[n] for n in names}
            self._rows = {n: i for i, n in enumerate(names)}
            self._parent_row = new_row[self._parent_row[keep]]
            self._data = {key: value[keep] for key, value in self._data.items()}
            self._rows_by_depth = None
            self._changes.structure += 1

    def set_poses(self, poses: ArrayLike, rows: Any = slice(None)) -> None:
        """Write poses T_group_node.

        Args:
            poses: Poses, (n, 4, 4).
            rows: Which nodes: a slice, or what `rows()` returned.
        """
        with self._lock:
            self._data["pose"][: len(self._nodes)][rows] = poses
            self._changes.motion += 1

    def set_pose(self, name: str, pose: ArrayLike) -> None:
        """Write the pose T_group_node of one node.

        Args:
            name: Name of the node.
            pose: An array (4, 4), an `SE3`, or a position (3,) [m].
        """
        self.set_poses(pose_or_position(pose), self.row(name))

    def pose(self, name: str) -> Floats:
        """The pose (4, 4) of a node in its group."""
        with self._lock:
            return self._data["pose"][self.row(name)].copy()

    def set_surfaces(self, name: str, surfaces: Iterable[Surface]) -> None:
        """Replace the surfaces of a node; pose, colour, opacity and scale remain.

        Args:
            name: Name of the node.
            surfaces: The new surfaces.
        """
        with self._lock:
            self._nodes[name] = replace(self.node(name), surfaces=tuple(surfaces))
            self._changes.structure += 1

    def set_content(self, name: str, content: Content) -> None:
        """Replace the content of a node; its surfaces remain.

        Args:
            name: Name of the node.
            content: The new content.
        """
        with self._lock:
            self._nodes[name] = replace(self.node(name), content=content)
            self._changes.structure += 1

    def appearance(self, name: str, key: str) -> Any:
        """An appearance value of a node itself, without those of its groups.

        Args:
            name: Name of the node.
            key: "scale", "visible", "opacity" or "tint".

        Returns:
            A number or a truth value; for "scale" and "tint" an array (3,).
        """
        with self._lock:
            value = self._data[key][self.row(name)]
            return value.copy() if np.ndim(value) else value.item()

    def set_appearance(self, name: str, key: str, value: Any) -> None:
        """Write an appearance value of a node; for a group it holds for all nodes in it.

        Args:
            name: Name of the node.
            key: "scale", "visible", "opacity" or "tint".
            value: The new value, of the kind that `appearance` returns.
        """
        with self._lock:
            row = self.row(name)
            if key == "scale" and (self._parent_row[: len(self._nodes)] == row).any():
                check_uniform_scale(name, np.broadcast_to(value, 3))
            self._data[key][row] = value
            self._changes.appearance += 1

    look, set_look, together, later = appearance, set_appearance, atomic, defer
    """Old names."""

    def add_axes(self, name: str, pose: ArrayLike | None = None, length: float = 0.1) -> Node:
        """Add three arrows in red, green, blue along x, y, z.

        Args:
            name: Name of the node.
            pose: T_group_node, (4, 4); the identity by default.
            length: Length of an arrow [m].

        Returns:
            The node.
        """
        return self.add(name, axes(length), pose, shadow=False, through=True)

    def add_path(
        self, name: str, points: ArrayLike, rgba: Colour = (0.95, 0.45, 0.10), radius: float = 0.004
    ) -> Node:
        """Add a line through points.

        Args:
            name: Name of the node.
            points: The points, (n, 3) [m].
            rgba: Its colour.
            radius: Half its thickness [m].

        Returns:
            The node.
        """
        polyline = np.asarray(points, dtype=float).reshape(-1, 3)
        return self.add(
            name, shadow=False, through=True, content=Lines.through(polyline, colour(rgba), 2 * radius)
        )

    def points(self, max_points: int = 40_000) -> Floats:
        """Places of everything visible in the world [m], shape (n, 3); evenly thinned out to about `most`."""
        snapshot = self.snapshot()
        visible = [
            i for i, node in enumerate(snapshot.nodes) if snapshot.visible[i] and snapshot.opacity[i] > 0.0
        ]
        parts = [(i, s.vertices) for i in visible for s in snapshot.nodes[i].surfaces if s.rgba[3] > 0.0]
        parts += [(i, c.bounding_points) for i in visible if (c := snapshot.nodes[i].content) is not None]
        step = max(sum(len(positions) for _, positions in parts) // max_points, 1)
        out = [np.zeros((0, 3))]
        for i, positions in parts:
            out.append(
                (positions[::step] * snapshot.scales[i]) @ snapshot.poses[i, :3, :3].T
                + snapshot.poses[i, :3, 3]
            )
        return np.concatenate(out)

    def floor(self) -> float:
        """The height of the floor [m]: 0, or lower where something hangs below it (legs below a pelvis).

        Things that cast no shadow, such as axes and lines, may well reach into the floor.
        """
        snapshot = self.snapshot()
        lowest = 0.0
        for i, node in enumerate(snapshot.nodes):
            for surface in node.surfaces if node.shadow else ():
                if len(surface.vertices):
                    heights = (surface.vertices * snapshot.scales[i]) @ snapshot.poses[i, 2, :3]
                    lowest = min(lowest, float(heights.min() + snapshot.poses[i, 2, 3]))
        return lowest
