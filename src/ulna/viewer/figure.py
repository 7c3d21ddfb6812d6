"""A robot in a scene: what its links look like, and all of them moved by one configuration."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, final

import numpy as np

from ulna.checks.arrays import finite_array, shaped_array
from ulna.errors import ShapeError
from ulna.typing import ArrayLike, Floats
from ulna.viewer.colours import Colour
from ulna.viewer.content import Copies
from ulna.viewer.links import Showing, link_looks, link_names
from ulna.viewer.meshes import Detail
from ulna.viewer.node import standing
from ulna.viewer.progress import Report, silent
from ulna.viewer.scene import Scene
from ulna.viewer.surface import RGBA, colour

_FLOAT = np.dtype(float)


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
        detail: "full" for all triangles of mesh files, "seen" without those that nobody would miss.

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
        detail: Detail = "seen",
    ) -> None:
        self.scene, self.robot, self.name = scene, robot, name or robot.name
        start = checked_configuration(robot, q)
        self._q: Floats | Callable[[], Floats] = start
        self._late = False  # whether the scene will ask for what is newest anyway
        self.moves = 0
        """How often it was moved."""
        self._followers: list[Callable[[Floats], None]] = []
        tint = None if rgba is None else colour(rgba)
        # adding robots must not half-happen: everything that can fail comes first
        place, poses = None if pose is None else standing(pose), robot.link_poses(start)
        looks = link_looks(robot, show, tint, report, detail)
        self.names = tuple(f"{self.name}/{n}" for n in link_names(robot))
        with scene.together():
            if self.name in scene:
                scene.remove(self.name)
            scene.add(self.name, pose=place)
            for node, surfaces, link_pose in zip(self.names, looks, poses, strict=True):
                scene.add(node, surfaces, link_pose)
            self._structure, self._rows = scene.version[0], scene.rows(self.names)
        self._show: Showing = show
        self._tint = tint
        self._detail: Detail = detail

    @property
    def q(self) -> Floats:
        """The configuration it shows, shape (nq,)."""
        return self._now().copy()

    @property
    def show(self) -> Showing:
        """What of it is shown."""
        return self._show

    def dress(self, show: Showing) -> None:
        """Show something else of it: "visual", "collision", "both" or "skeleton"."""
        looks = link_looks(self.robot, show, self._tint, detail=self._detail)
        with self.scene.together():
            for node, surfaces in zip(self.names, looks, strict=True):
                self.scene.set_surfaces(node, surfaces)
        self._show = show

    def move(self, q: ArrayLike) -> None:
        """Hand over configuration `q` (nq,). Where the links are is computed when somebody looks."""
        self.put(checked_configuration(self.robot, q))

    def put(self, q: Floats | Callable[[], Floats]) -> None:
        """As `move`, for an array that is known to be a configuration and that nobody will change.

        A function that gives such an array serves, too: it is called when somebody looks, on any thread.
        """
        self._q = q
        self.moves += 1
        if not self._late:
            self.again()

    def follow(self, function: Callable[[Floats], None]) -> None:
        """Call `function` with the configuration when the links are moved."""
        self._followers.append(function)
        self.scene.later(self, self._bring)

    def again(self) -> None:
        """Have links, and what follows them, brought up to date before somebody looks.

        Raises:
            UnknownName: The robot was removed from the scene.
        """
        self.scene.row(self.name)
        self._late = True
        self.scene.later(self, self._bring)

    def _now(self) -> Floats:
        q = self._q
        return q() if callable(q) else q

    def _bring(self) -> None:
        self._late = False  # before the newest is read, so that nothing that comes meanwhile is missed
        if self.name not in self.scene:
            return
        structure = self.scene.version[0]
        if structure != self._structure:
            self._structure, self._rows = structure, self.scene.rows(self.names)
        q = self._now()
        self.scene.set_poses(self.robot.link_poses(q), self._rows)
        for function in self._followers:
            function(q)

    def remove(self) -> None:
        """Take the robot out of the scene, with all that follows it."""
        self._followers.clear()
        self._late = False
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
        rows = len(self._q) if getattr(self, "_bases", None) is not None else None
        mend = "One configuration in each row" + ("." if rows is None else ", as many as there are bases.")
        return shaped_array("q", q, rows, self.robot.nq, fix=mend)

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
    count = robot.model.nq
    if type(q) is np.ndarray and q.dtype is _FLOAT and q.shape == (count,):  # as a loop hands it over
        out = q.copy()
        if math.isfinite(math.hypot(*out.tolist())):
            return out
    out = finite_array("q", q, f"{count} numbers")
    if out.shape != (count,):
        names = ", ".join(robot.joint_names[:8])
        raise ShapeError("q", out.shape, f"({count},)", f"One number for each of: {names}.")
    return out
