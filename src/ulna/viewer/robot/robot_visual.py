"""The links of a robot as nodes of a scene, moved by one configuration."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, final

from ulna.checks.arrays import read_only
from ulna.typing import ArrayLike, Floats
from ulna.viewer.colours import Colour
from ulna.viewer.graph.node import node_name, pose_or_position
from ulna.viewer.graph.scene_graph import SceneGraph
from ulna.viewer.mesh.mesh_files import Detail
from ulna.viewer.mesh.surface import colour
from ulna.viewer.progress import Report, silent
from ulna.viewer.robot.configuration import checked_configuration
from ulna.viewer.robot.link_surfaces import RobotDisplay, link_names, surfaces_by_link


@final
class RobotVisual:
    """A robot's links in a scene, moved together.

    Args:
        scene: Where to.
        robot: An `ulna.Robot`.
        q: Its configuration, shape (nq,) [rad, m].
        name: The group of its nodes; the robot's own name when not given.
        rgba: One colour for everything; the materials' own when not given.
        show: "visual" for what it looks like, "collision" for what it collides with, "both", or "skeleton" for lines
            from joint to joint.
        pose: T_world_base, where its base stands, shape (4, 4).
        report: Called with how many of the links are loaded.
        detail: "full" for all triangles of mesh files, "seen" simplified within an error bound.

    Raises:
        ShapeError, NonFiniteError: `q` is no configuration.
        UnknownName: There is no such way to show it.
    """

    def __init__(
        self,
        scene: SceneGraph,
        robot: Any,
        q: ArrayLike,
        name: str | None = None,
        rgba: Colour | None = None,
        show: RobotDisplay = "visual",
        pose: ArrayLike | None = None,
        report: Report = silent,
        detail: Detail = "seen",
    ) -> None:
        self.scene, self.robot, self.name = scene, robot, name or node_name(robot.name)
        start = checked_configuration(robot, q)
        self._q: Floats | Callable[[], Floats] = start
        self._update_pending = False  # whether the scene will ask for what is newest anyway
        self.moves = 0
        """How often it was moved."""
        self._followers: list[Callable[[Floats], None]] = []
        tint = None if rgba is None else colour(rgba)
        # adding robots must not half-happen: everything that can fail comes first
        base_pose, poses = None if pose is None else pose_or_position(pose), robot.link_poses(start)
        surfaces_of_links = surfaces_by_link(robot, show, tint, report, detail)
        self.names = tuple(f"{self.name}/{n}" for n in link_names(robot))
        with scene.atomic():
            if self.name in scene:
                scene.remove(self.name)
            scene.add(self.name, pose=base_pose)
            for node, surfaces, link_pose in zip(self.names, surfaces_of_links, poses, strict=True):
                scene.add(node, surfaces, link_pose)
            self._structure, self._rows = scene.version[0], scene.rows(self.names)
        self._show: RobotDisplay = show
        self._tint = tint
        self._detail: Detail = detail

    @property
    def q(self) -> Floats:
        """The configuration it shows, shape (nq,), read-only."""
        return read_only(self._current_q().copy())

    @property
    def show(self) -> RobotDisplay:
        """What of it is shown."""
        return self._show

    def set_display(self, show: RobotDisplay) -> None:
        """Show something else of it: "visual", "collision", "both" or "skeleton"."""
        surfaces_of_links = surfaces_by_link(self.robot, show, self._tint, detail=self._detail)
        with self.scene.atomic():
            for node, surfaces in zip(self.names, surfaces_of_links, strict=True):
                self.scene.set_surfaces(node, surfaces)
        self._show = show

    def move(self, q: ArrayLike) -> None:
        """Set configuration `q` (nq,). The poses of the links are computed before the next snapshot."""
        self.set_checked_q(checked_configuration(self.robot, q))

    def set_checked_q(self, q: Floats | Callable[[], Floats]) -> None:
        """As `move`, for an array that is a valid configuration and that is not modified later.

        Or for a function that returns such an array; it is called before the next snapshot, on any thread.
        """
        self._q = q
        self.moves += 1
        if not self._update_pending:
            self.request_update()

    def follow(self, function: Callable[[Floats], None]) -> None:
        """Call `function` with the configuration when the links are moved."""
        self._followers.append(function)
        self.scene.defer(self, self._update)

    def request_update(self) -> None:
        """Update the links, and what follows them, before the next snapshot.

        Raises:
            UnknownName: The robot was removed from the scene.
        """
        self.scene.row(self.name)
        self._update_pending = True
        self.scene.defer(self, self._update)

    def _current_q(self) -> Floats:
        q = self._q
        return q() if callable(q) else q

    def _update(self) -> None:
        self._update_pending = (
            False  # before the newest is read, so that nothing that comes meanwhile is missed
        )
        if self.name not in self.scene:
            return
        structure = self.scene.version[0]
        if structure != self._structure:
            self._structure, self._rows = structure, self.scene.rows(self.names)
        q = self._current_q()
        self.scene.set_poses(self.robot.link_poses(q), self._rows)
        for function in self._followers:
            function(q)

    def remove(self) -> None:
        """Take the robot out of the scene, with all that follows it."""
        self._followers.clear()
        self._update_pending = False
        self.scene.remove(self.name)
