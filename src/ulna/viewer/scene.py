"""What there is to see, whoever draws it: named nodes with surfaces, and one array of world poses."""

from __future__ import annotations

import threading
import warnings
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ulna.errors import (
    InputError,
    MissingExtra,
    ModelWarning,
    NonFiniteError,
    ShapeError,
    UlnaError,
    UnknownName,
)
from ulna.typing import Array, ArrayLike, Floats
from ulna.viewer.surface import DEFAULT_COLOUR, RGBA, Surface, colour
from ulna.viewer.tessellate import axes, tessellate, tube


@dataclass(frozen=True, eq=False)
class Node:
    """A thing of the scene that moves as one piece.

    Args:
        name: Its name, unique in the scene; `/` groups nodes for display.
        surfaces: What it looks like, in its own frame.
        parent: The name of the node it belongs to (they are removed together), or None. Poses are always
            world poses.
        shadow: Whether it casts a shadow.
        through: Whether pictures show it faintly through what hides it, as is good for lines and axes.
    """

    name: str
    surfaces: tuple[Surface, ...]
    parent: str | None = None
    shadow: bool = True
    through: bool = False

    @property
    def translucent(self) -> bool:
        """Whether any of its surfaces lets light through."""
        return any(s.rgba[3] < 0.999 for s in self.surfaces)


class Scene:
    """Named nodes and one array of world poses.

    Everything may be called from any thread. A program's loop writes poses (`set_poses`, about a
    microsecond); whoever draws reads them when it is ready to (`snapshot`), so a slow screen never slows the
    loop.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._nodes: dict[str, Node] = {}
        self._row: dict[str, int] = {}
        self._poses: Floats = np.zeros((0, 4, 4))
        self._structure = 0
        self._motion = 0

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
        """A copy of the world poses T_world_node, shape (n, 4, 4)."""
        with self._lock:
            return self._poses.copy()

    @property
    def version(self) -> tuple[int, int]:
        """Two counters: changes of the set of nodes, changes of poses."""
        return self._structure, self._motion

    def snapshot(self) -> tuple[int, int, tuple[Node, ...], Floats]:
        """Both counters of `version`, the nodes and a copy of their poses, all of one instant."""
        with self._lock:
            return self._structure, self._motion, tuple(self._nodes.values()), self._poses.copy()

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
            return self._row[name]
        except KeyError:
            raise UnknownName("node", name, self._nodes) from None

    def rows(self, names: Iterable[str]) -> Array:
        """The rows of several nodes, for `set_poses`. They hold until a node is removed."""
        return np.array([self.row(n) for n in names], dtype=np.intp)

    def add(
        self,
        name: str,
        surfaces: Iterable[Surface] = (),
        pose: ArrayLike | None = None,
        parent: str | None = None,
        shadow: bool = True,
        through: bool = False,
    ) -> Node:
        """Add a node, or replace the one of that name.

        Args:
            name: Its name.
            surfaces: What it looks like.
            pose: T_world_node, shape (4, 4); the identity when not given.
            parent: The node it belongs to.
            shadow: Whether it casts a shadow.
            through: Whether pictures show it faintly through what hides it.
        """
        if not name or name != name.strip("/"):
            raise InputError(
                f"A node's name is not empty and neither begins nor ends with '/'; got {name!r}."
            )
        if parent is not None:
            self.row(parent)
        matrix = np.eye(4) if pose is None else _poses(pose, (4, 4))
        node = Node(name, tuple(surfaces), parent, shadow, through)
        with self._lock:
            if name in self._nodes:
                self._poses[self._row[name]] = matrix
            else:
                self._row[name] = len(self._nodes)
                self._poses = np.concatenate([self._poses, matrix[None]])
            self._nodes[name] = node
            self._structure += 1
        return node

    def remove(self, name: str) -> None:
        """Remove a node and everything that belongs to it.

        Raises:
            UnknownName: There is no node of that name.
        """
        self.row(name)
        with self._lock:
            gone = {name}
            while True:
                more = {n for n, node in self._nodes.items() if node.parent in gone} - gone
                if not more:
                    break
                gone |= more
            keep = [row for n, row in self._row.items() if n not in gone]
            self._nodes = {n: node for n, node in self._nodes.items() if n not in gone}
            self._row = {n: i for i, n in enumerate(self._nodes)}
            self._poses = self._poses[keep]
            self._structure += 1

    def set_poses(self, poses: ArrayLike, rows: Any = slice(None)) -> None:
        """Write world poses: shape (n, 4, 4) for `rows` (a slice, or what `rows()` gave)."""
        with self._lock:
            self._poses[rows] = poses
            self._motion += 1

    def set_pose(self, name: str, pose: ArrayLike) -> None:
        """Write the world pose (4, 4) of one node."""
        self.set_poses(_poses(pose, (4, 4)), self.row(name))

    def add_axes(self, name: str, pose: ArrayLike | None = None, length: float = 0.1) -> Node:
        """Add three arrows in red, green, blue along x, y, z; `length` in metres."""
        return self.add(name, axes(length), pose, shadow=False, through=True)

    def add_path(
        self, name: str, points: ArrayLike, rgba: Iterable[float] = (0.95, 0.45, 0.10), radius: float = 0.004
    ) -> Node:
        """Add a line through `points` (n, 3) [m], drawn as a tube."""
        return self.add(name, (tube(points, radius, colour(rgba)),), shadow=False, through=True)

    def add_robot(
        self, robot: Any, q: ArrayLike, name: str | None = None, rgba: Iterable[float] | None = None
    ) -> RobotInScene:
        """Add a robot's links.

        Args:
            robot: An `ulna.Robot`.
            q: Its configuration, shape (nq,).
            name: The name of the group of nodes; the robot's own when not given.
            rgba: One colour for the whole robot, for a ghost of it; its own materials when not given.
        """
        group = name or robot.name
        # adding robots must not half-happen: everything that can fail comes first
        poses = _poses(robot.link_poses(np.asarray(q, dtype=float)), (len(robot.model.links), 4, 4))
        looks = [link_surfaces(link, None if rgba is None else colour(rgba)) for link in robot.model.links]
        names = []
        for link, surfaces, pose in zip(robot.model.links, looks, poses, strict=True):
            names.append(f"{group}/{link.name}")
            self.add(names[-1], surfaces, pose)
        return RobotInScene(self, robot, group, tuple(names))

    def points(self, most: int = 40_000) -> Floats:
        """Vertices of everything in the world [m], shape (n, 3); evenly thinned out to about `most`."""
        _, _, nodes, poses = self.snapshot()
        total = sum(len(s.vertices) for node in nodes for s in node.surfaces)
        step = max(total // most, 1)
        parts = [np.zeros((0, 3))]
        for node, pose in zip(nodes, poses, strict=True):
            parts += [
                s.vertices[::step] @ pose[:3, :3].T + pose[:3, 3] for s in node.surfaces if s.rgba[3] > 0.0
            ]
        return np.concatenate(parts)

    def floor(self) -> float:
        """The height of the floor [m]: 0, or lower where something hangs below it (legs below a pelvis).

        Things that cast no shadow, such as axes and lines, may well reach into the floor.
        """
        _, _, nodes, poses = self.snapshot()
        lowest = 0.0
        for node, pose in zip(nodes, poses, strict=True):
            for surface in node.surfaces if node.shadow else ():
                if len(surface.vertices):
                    lowest = min(lowest, float((surface.vertices @ pose[2, :3]).min() + pose[2, 3]))
        return lowest


class RobotInScene:
    """A robot's links in a scene, moved together by `move`."""

    def __init__(self, scene: Scene, robot: Any, name: str, names: Sequence[str]) -> None:
        self.scene, self.robot, self.name, self.names = scene, robot, name, tuple(names)
        self._structure, self._rows = scene.version[0], scene.rows(self.names)

    def move(self, q: ArrayLike) -> None:
        """Show configuration `q` (nq,)."""
        structure = self.scene.version[0]
        if structure != self._structure:
            self._structure, self._rows = structure, self.scene.rows(self.names)
        self.scene.set_poses(self.robot.link_poses(q), self._rows)

    def remove(self) -> None:
        """Take the robot out of the scene."""
        for name in self.names:
            self.scene.remove(name)


def link_surfaces(link: Any, rgba: RGBA | None = None) -> tuple[Surface, ...]:
    """What a link looks like, in the link's frame: its visuals as surfaces, those of one colour joined.

    A mesh that is missing or broken is left out with a `ModelWarning`: a robot without a shell is still a
    robot.

    Args:
        link: A link of a model; its `visuals` are drawn.
        rgba: One colour for everything; the materials' own when None.
    """
    pieces: list[Surface] = []
    for visual in link.visuals:
        pose = visual.placement.matrix()
        material = getattr(visual, "material", None)
        stated = getattr(material, "rgba", None)
        shape = visual.shape
        if hasattr(shape, "path"):
            if shape.path is None or shape.missing:
                continue
            from ulna.viewer.meshes import load_mesh

            try:
                parts = [s.moved(pose, shape.scale) for s in load_mesh(shape.path)]
            except MissingExtra as error:  # the same words for each link, so that they are said once
                warnings.warn(f"Meshes are left out. {error}", ModelWarning, stacklevel=2)
                continue
            except UlnaError as error:
                warnings.warn(
                    f"Link {link.name!r} is drawn without a mesh. {error}", ModelWarning, stacklevel=2
                )
                continue
            if stated is not None:  # a model's material speaks for meshes that bring no colour of their own
                parts = [s.coloured(stated) if s.rgba == DEFAULT_COLOUR else s for s in parts]
        else:
            parts = [tessellate(shape, DEFAULT_COLOUR if stated is None else colour(stated)).moved(pose)]
        pieces += parts if rgba is None else [p.coloured(rgba) for p in parts]
    return _join(pieces)


def _join(pieces: list[Surface]) -> tuple[Surface, ...]:
    by_colour: dict[RGBA, list[Surface]] = {}
    for piece in pieces:
        by_colour.setdefault(piece.rgba, []).append(piece)
    out = []
    for rgba, group in by_colour.items():
        offsets = np.cumsum([0, *(len(s.vertices) for s in group)])
        out.append(
            Surface(
                np.concatenate([s.vertices for s in group]),
                np.concatenate([s.triangles + o for s, o in zip(group, offsets, strict=False)]),
                np.concatenate([s.normals for s in group]),
                rgba,
            )
        )
    return tuple(out)


def _poses(value: ArrayLike, shape: tuple[int, ...]) -> Floats:
    out = np.asarray(value, dtype=float)
    if out.shape != shape:
        raise ShapeError("pose", out.shape, str(shape))
    if not np.isfinite(out).all():
        where = tuple(int(i) for i in np.argwhere(~np.isfinite(out))[0])
        raise NonFiniteError("pose", where, float(out[where]))
    return out
