"""A robot in a scene: what its links look like, and all of them moved by one configuration."""

from __future__ import annotations

import itertools
import warnings
from collections.abc import Callable, Iterable
from typing import Any, Literal, final

import numpy as np

from ulna.errors import MissingExtra, ModelWarning, NonFiniteError, ShapeError, UlnaError, UnknownName
from ulna.geometry import Geometry, Mesh
from ulna.typing import ArrayLike, Floats
from ulna.viewer.colours import Colour
from ulna.viewer.content import Copies
from ulna.viewer.progress import Report, silent
from ulna.viewer.scene import Scene
from ulna.viewer.surface import DEFAULT_COLOUR, RGBA, Surface, colour
from ulna.viewer.tessellate import ball, tessellate, tube

Showing = Literal["visual", "collision", "both", "skeleton"]
SHOWINGS: tuple[str, ...] = ("visual", "collision", "both", "skeleton")

_HULL: RGBA = (0.96, 0.55, 0.18, 1.0)
_BONE: RGBA = (0.20, 0.36, 0.62, 1.0)
_KNUCKLE: RGBA = (0.93, 0.52, 0.13, 1.0)


@final
class Figure:
    """A robot's links in a scene, moved together.

    Args:
        scene: Where to.
        robot: An `ulna.Robot`.
        q: Its configuration, shape (nq,).
        name: The group of its nodes; the robot's own name when not given.
        rgba: One colour for everything; the materials' own when not given.
        show: "visual" for what it looks like, "collision" for what it collides with, "both", or "skeleton" for lines
            from joint to joint.
        pose: T_world_base, where its base stands, shape (4, 4).
        report: Told how many of the links are loaded.

    Raises:
        ShapeError, NonFiniteError: `q` is no configuration.
        UnknownName: There is no such way to show it.
    """

    def __init__(
        self,
        scene: Scene,
        robot: Any,
        q: ArrayLike,
        name: str | None = None,
        rgba: Colour | None = None,
        show: Showing = "visual",
        pose: ArrayLike | None = None,
        report: Report = silent,
    ) -> None:
        self.scene, self.robot, self.name = scene, robot, name or robot.name
        self._q = checked_configuration(robot, q)
        self.moves = 0
        """How often it was moved."""
        self._followers: list[Callable[[Floats], None]] = []
        tint = None if rgba is None else colour(rgba)
        # adding robots must not half-happen: everything that can fail comes first
        poses = robot.link_poses(self._q)
        looks = link_looks(robot, show, tint, report)
        self.names = tuple(f"{self.name}/{n}" for n in link_names(robot))
        with scene.together():
            if self.name in scene:
                scene.remove(self.name)
            scene.add(self.name, pose=pose)
            for node, surfaces, link_pose in zip(self.names, looks, poses, strict=True):
                scene.add(node, surfaces, link_pose)
            self._structure, self._rows = scene.version[0], scene.rows(self.names)
        self._show: Showing = show
        self._tint = tint

    @property
    def q(self) -> Floats:
        """The configuration it shows, shape (nq,)."""
        return self._q.copy()

    @property
    def show(self) -> Showing:
        """What of it is shown."""
        return self._show

    def dress(self, show: Showing) -> None:
        """Show something else of it: "visual", "collision", "both" or "skeleton"."""
        looks = link_looks(self.robot, show, self._tint)
        with self.scene.together():
            for node, surfaces in zip(self.names, looks, strict=True):
                self.scene.set_surfaces(node, surfaces)
        self._show = show

    def move(self, q: ArrayLike) -> None:
        """Hand over configuration `q` (nq,). Where the links are is computed when somebody looks."""
        self.put(checked_configuration(self.robot, q))

    def put(self, q: Floats) -> None:
        """As `move`, for an array that is known to be a configuration and that nobody will change."""
        self._q = q
        self.moves += 1
        self.scene.later(self, self._bring)

    def follow(self, function: Callable[[Floats], None]) -> None:
        """Call `function` with the configuration when the links are moved."""
        self._followers.append(function)
        self.scene.later(self, self._bring)

    def _bring(self) -> None:
        if self.name not in self.scene:
            return
        structure = self.scene.version[0]
        if structure != self._structure:
            self._structure, self._rows = structure, self.scene.rows(self.names)
        q = self._q
        self.scene.set_poses(self.robot.link_poses(q), self._rows)
        for function in self._followers:
            function(q)

    def remove(self) -> None:
        """Take the robot out of the scene, with all that follows it."""
        self._followers.clear()
        self.scene.remove(self.name)


@final
class Ghosts:
    """A robot in many configurations at once; a screen draws each link once for all of them.

    Args:
        scene: Where to.
        robot: An `ulna.Robot`.
        q: Configurations, shape (n, nq).
        name: The group of its nodes.
        rgba: One colour for everything; the materials' own when None.
        show: As for `Figure`.
        bases: T_group_base of each, shape (n, 4, 4); all at the group's origin when not given.
    """

    def __init__(
        self,
        scene: Scene,
        robot: Any,
        q: ArrayLike,
        name: str,
        rgba: RGBA | None = None,
        show: Showing = "visual",
        bases: Floats | None = None,
    ) -> None:
        self.scene, self.robot, self.name = scene, robot, name
        self._q = self._checked(q)
        if bases is not None and np.shape(bases) != (len(self._q), 4, 4):
            raise ShapeError("bases", np.shape(bases), f"({len(self._q)}, 4, 4), one for each configuration")
        self._bases = None if bases is None else np.array(bases, dtype=float)
        self._looks = link_looks(robot, show, None if rgba is None else (*rgba[:3], 1.0))
        self._opacity = 1.0 if rgba is None else rgba[3]
        scene.add(name)
        self._bring()

    @property
    def q(self) -> Floats:
        """The configurations, shape (n, nq)."""
        return self._q.copy()

    def move(self, q: ArrayLike) -> None:
        """Hand over configurations `q`, shape (n, nq). Where the links are is computed when somebody looks."""
        self._q = self._checked(q)
        self.scene.later(self, self._bring)

    def _checked(self, q: ArrayLike) -> Floats:
        out = np.array(q, dtype=float)
        if out.ndim != 2 or out.shape[1] != self.robot.nq:
            raise ShapeError("q", out.shape, f"(n, {self.robot.nq}), one configuration in each row")
        if getattr(self, "_bases", None) is not None and len(out) != len(self._q):
            raise ShapeError("q", out.shape, f"({len(self._q)}, {self.robot.nq}), as many as there are bases")
        if not np.isfinite(out).all():
            where = tuple(int(i) for i in np.argwhere(~np.isfinite(out))[0])
            raise NonFiniteError("q", where, float(out[where]))
        return out

    def _bring(self) -> None:
        if self.name not in self.scene:
            return
        poses = self.robot.link_poses(self._q)
        if self._bases is not None:
            poses = self._bases[:, None] @ poses
        for k, (link, surfaces) in enumerate(zip(link_names(self.robot), self._looks, strict=True)):
            if surfaces:
                copies = Copies(surfaces, poses[:, k], opacity=self._opacity)
                node = f"{self.name}/{link}"
                if node in self.scene:
                    self.scene.set_content(node, copies)
                else:
                    self.scene.add(node, shadow=self._opacity >= 0.999, content=copies)


def checked_configuration(robot: Any, q: ArrayLike) -> Floats:
    """A copy of configuration `q` (nq,).

    Raises:
        ShapeError, NonFiniteError: It is none.
    """
    out = np.array(q, dtype=float)
    if out.shape != (robot.model.nq,):
        names = ", ".join(robot.joint_names[:8])
        raise ShapeError("q", out.shape, f"({robot.model.nq},)", f"One number for each of: {names}.")
    square = out.dot(out)
    if square - square != 0.0 and not np.isfinite(out).all():  # a quick look first
        where = int(np.argwhere(~np.isfinite(out))[0][0])
        raise NonFiniteError("q", (where,), float(out[where]))
    return out


def link_names(robot: Any) -> tuple[str, ...]:
    """Names of the links as nodes: `/`, which would make groups, becomes `.`."""
    out: list[str] = []
    for link in robot.model.links:
        plain = link.name.replace("/", ".").strip() or "link"
        names = itertools.chain([plain], (f"{plain}'{k}" for k in itertools.count(2)))
        out.append(next(n for n in names if n not in out))
    return tuple(out)


def link_looks(
    robot: Any, show: Showing, rgba: RGBA | None = None, report: Report = silent
) -> list[tuple[Surface, ...]]:
    """What each link looks like, in the link's frame.

    Raises:
        UnknownName: There is no such way to show it.
    """
    if show not in SHOWINGS:
        raise UnknownName("way to show a robot", show, SHOWINGS)
    links = robot.model.links
    if show == "skeleton":
        return _skeleton(robot, rgba)
    out = []
    for k, link in enumerate(links):
        report(k, len(links))
        pieces: tuple[Surface, ...] = ()
        if show in ("visual", "both"):
            pieces += link_surfaces(link.visuals, link.name, rgba)
        if show in ("collision", "both"):
            paint = rgba or _HULL
            hull = (*paint[:3], paint[3] * (0.35 if show == "both" else 1.0))
            pieces += link_surfaces(link.collisions, link.name, hull)
        out.append(pieces)
    report(len(links), len(links))
    return out


def link_surfaces(
    geometries: Iterable[Geometry], link: str = "", rgba: RGBA | None = None
) -> tuple[Surface, ...]:
    """What geometries of a link look like, in the link's frame: surfaces, those of one colour joined.

    A mesh that is missing or broken is left out with a `ModelWarning`: a robot without a shell is still a robot.

    Args:
        geometries: The link's visuals or collisions.
        link: The link's name, for messages.
        rgba: One colour for everything; the materials' own when None.
    """
    pieces: list[Surface] = []
    for geometry in geometries:
        pose = geometry.placement.matrix()
        material = getattr(geometry, "material", None)
        stated = getattr(material, "rgba", None)
        shape = geometry.shape
        if isinstance(shape, Mesh):
            if shape.path is None or shape.missing:
                continue
            from ulna.viewer.meshes import load_mesh

            try:
                parts = [s.moved(pose, shape.scale) for s in load_mesh(shape.path)]
            except MissingExtra as error:  # the same words for each link, so that they are said once
                warnings.warn(f"Meshes are left out. {error}", ModelWarning, stacklevel=2)
                continue
            except UlnaError as error:
                warnings.warn(f"Link {link!r} is drawn without a mesh. {error}", ModelWarning, stacklevel=2)
                continue
            if stated is not None:  # a model's material speaks for meshes that bring no colour of their own
                parts = [s.coloured(stated) if s.rgba == DEFAULT_COLOUR else s for s in parts]
        else:
            parts = [tessellate(shape, DEFAULT_COLOUR if stated is None else colour(stated)).moved(pose)]
        pieces += parts if rgba is None else [p.coloured(rgba) for p in parts]
    return joined(pieces)


def joined(pieces: Iterable[Surface]) -> tuple[Surface, ...]:
    """Surfaces with those of one colour and without texture joined into one."""
    by_colour: dict[Any, list[Surface]] = {}
    for piece in pieces:
        by_colour.setdefault(piece.rgba if piece.texture is None else id(piece), []).append(piece)
    out = []
    for group in by_colour.values():
        if len(group) == 1:
            out.append(group[0])
            continue
        offsets = np.cumsum([0, *(len(s.vertices) for s in group)])
        out.append(
            Surface(
                np.concatenate([s.vertices for s in group]),
                np.concatenate([s.triangles + o for s, o in zip(group, offsets, strict=False)]),
                np.concatenate([s.normals for s in group]),
                group[0].rgba,
            )
        )
    return tuple(out)


def _skeleton(robot: Any, rgba: RGBA | None) -> list[tuple[Surface, ...]]:
    """A ball at each link's origin and a rod to each link after it, as thick as suits the robot."""
    links, model = robot.model.links, robot.model
    poses = robot.link_poses(model.neutral)
    reach = float(np.ptp(poses[:, :3, 3], axis=0).max()) or 1.0
    number = {link.name: k for k, link in enumerate(links)}
    pieces: list[list[Surface]] = [[ball(0.02 * reach, rgba or _KNUCKLE)] for _ in links]
    for link in links:
        if link.parent is not None:
            end = link.origin.matrix()[:3, 3]
            if np.linalg.norm(end) > 1e-9:
                rod = tube(np.linspace((0.0, 0.0, 0.0), end, 2), 0.010 * reach, rgba or _BONE, 12)
                pieces[number[link.parent]].append(rod)
    return [joined(p) for p in pieces]
