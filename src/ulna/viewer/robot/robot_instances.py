"""A robot in many configurations at once, each link drawn once for all of them."""

from __future__ import annotations

from typing import Any, final

import numpy as np

from ulna.checks.arrays import read_only, shaped_array
from ulna.errors import ShapeError
from ulna.typing import ArrayLike, Floats
from ulna.viewer.graph.content import Copies
from ulna.viewer.graph.handles import Handle
from ulna.viewer.graph.scene_graph import SceneGraph
from ulna.viewer.mesh.surface import RGBA
from ulna.viewer.robot.link_surfaces import RobotDisplay, link_names, surfaces_by_link


@final
class RobotInstances:
    """A robot in many configurations at once; a screen draws each link once for all of them.

    Args:
        scene: Where to.
        robot: An `ulna.Robot`.
        q: Configurations, shape (n, nq) [rad, m].
        name: The group of its nodes.
        rgba: One colour for everything; the materials' own when None.
        show: As for `Figure`.
        bases: T_group_base of each, shape (n, 4, 4); all at the group's origin when not given.

    Raises:
        ShapeError: `q` or `bases` has another shape.
    """

    def __init__(
        self,
        scene: SceneGraph,
        robot: Any,
        q: ArrayLike,
        name: str,
        rgba: RGBA | None = None,
        show: RobotDisplay = "visual",
        bases: Floats | None = None,
    ) -> None:
        self.scene, self.robot, self.name = scene, robot, name
        self._q = self._checked(q)
        if bases is not None and np.shape(bases) != (len(self._q), 4, 4):
            raise ShapeError("bases", np.shape(bases), f"({len(self._q)}, 4, 4), one for each configuration")
        self._bases = None if bases is None else np.array(bases, dtype=float)
        self._looks = surfaces_by_link(robot, show, None if rgba is None else (*rgba[:3], 1.0))
        self._opacity = 1.0 if rgba is None else rgba[3]
        scene.add(name)
        self._update()

    @property
    def q(self) -> Floats:
        """The configurations, shape (n, nq), read-only."""
        return read_only(self._q.copy())

    def move(self, q: ArrayLike) -> None:
        """Set configurations `q`, shape (n, nq). The poses of the links are computed before the next snapshot."""
        self._q = self._checked(q)
        self.scene.defer(self, self._update)

    def _checked(self, q: ArrayLike) -> Floats:
        rows = len(self._q) if getattr(self, "_bases", None) is not None else None
        fix = "One configuration in each row" + ("." if rows is None else ", as many as there are bases.")
        return shaped_array("q", q, rows, self.robot.nq, fix=fix, labels=self.robot.model.position_names)

    def _update(self) -> None:
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


@final
class RobotInstancesHandle(Handle):
    """A robot many times over; `q`, shape (n, nq), can be assigned to."""

    __slots__ = ("_ghosts",)

    def __init__(self, ghosts: RobotInstances) -> None:
        super().__init__(ghosts.scene, ghosts.name)
        self._ghosts = ghosts

    @property
    def q(self) -> Floats:
        """The configurations, shape (n, nq), read-only: assign all of them."""
        return self._ghosts.q

    @q.setter
    def q(self, q: ArrayLike) -> None:
        self._ghosts.move(q)
