"""Overlays that move with a robot: frames, centre of mass, ellipsoids, paths, forces, velocities, ghosts."""

from __future__ import annotations

import abc
import itertools
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ulna.checks.values import MAX_LENGTH, count, number, short_repr
from ulna.checks.values import length as checked_length
from ulna.errors import InputError
from ulna.typing import ArrayLike, Floats
from ulna.viewer.colours import Colour, faded
from ulna.viewer.graph.arrow import Arrow, add_arrow
from ulna.viewer.graph.content import Lines
from ulna.viewer.graph.handles import Handle, Polyline
from ulna.viewer.mesh.primitives import axes, ball
from ulna.viewer.mesh.surface import RGBA
from ulna.viewer.robot import ellipsoids
from ulna.viewer.robot.frame_path import FramePath
from ulna.viewer.robot.robot_instances import RobotInstances, RobotInstancesHandle
from ulna.viewer.robot.robot_visual import RobotVisual

_COM_COLOUR: RGBA = (0.85, 0.20, 0.55, 1.0)
_INERTIA_COLOUR: RGBA = (0.55, 0.35, 0.80, 0.45)
_MANIPULABILITY_COLOUR: RGBA = (0.16, 0.62, 0.56, 0.35)
_PATH_COLOUR: RGBA = (0.95, 0.45, 0.10, 1.0)
_FORCE_COLOUR: RGBA = (0.86, 0.16, 0.16, 1.0)
_VELOCITY_COLOUR: RGBA = (0.10, 0.55, 0.30, 1.0)


class RobotOverlays(Handle, abc.ABC):
    """A robot in a scene, with overlays that move with it."""

    __slots__ = ("_count", "_paths", "_visual")

    def __init__(self, figure: RobotVisual) -> None:
        super().__init__(figure.scene, figure.name)
        self._visual = figure
        self._paths: list[FramePath] = []
        self._count = itertools.count(1)

    @property
    def robot(self) -> Any:
        """The robot."""
        return self._visual.robot

    @property
    @abc.abstractmethod
    def q(self) -> Floats:
        """The configuration, shape (nq,)."""

    @property
    @abc.abstractmethod
    def qd(self) -> Floats:
        """The velocity, shape (nv,) [rad/s or m/s]."""

    def frames(self, frames: str | Sequence[str] = "all", length: float = 0.08) -> Handle:
        """Show frames as three arrows each.

        Args:
            frames: The name of a frame, several names, or "all" for the frames of all links.
            length: Length of an arrow [m].

        Returns:
            The handle of their group.

        Raises:
            UnknownName: There is no such frame.
            InputError: `frames` is neither a name nor names.
        """
        names = [frames] if isinstance(frames, str) else frames
        if isinstance(frames, str) and frames == "all":
            names = self.robot.link_names
        if not (isinstance(names, list | tuple) and all(isinstance(n, str) for n in names)):
            raise InputError(
                f"`frames` is {short_repr(frames)}; expected 'all', a frame's name, or a list of names."
            )
        arrows, kernel = axes(checked_length("length", length)), self.robot.kernel("fk", frame=list(names))
        group = self._group("frames")
        nodes = [f"{group.name}/{k}" for k in range(len(names))]
        for node in nodes:
            self._scene.add(node, arrows, shadow=False, through=True)

        def update(q: Floats) -> None:
            if group.name in self._scene:
                self._scene.set_poses(kernel(q), self._scene.rows(nodes))

        return self._attach(group, update)

    def center_of_mass(self, radius: float = 0.02) -> Handle:
        """Show the centre of mass as a ball."""
        dot = ball(checked_length("radius", radius), _COM_COLOUR)
        group = self._group("centre of mass")
        self._scene.add(f"{group.name}/ball", [dot], shadow=False, through=True)
        pose = np.eye(4)

        def update(q: Floats) -> None:
            pose[:3, 3] = self.robot.center_of_mass(q)
            if group.name in self._scene:
                self._scene.set_pose(group.name, pose)

        return self._attach(group, update)

    def inertias(self) -> Handle:
        """Show each link as the ellipsoid of even density that has its mass, centre of mass and inertia.

        Links of no mass, and inertias that no body can have, are left out.
        """
        group = self._group("inertias")
        ellipsoids_of_links = ellipsoids.inertia_ellipsoids(self.robot.model.links)
        for k, (_, _, radii) in enumerate(ellipsoids_of_links):
            self._scene.add(f"{group.name}/{k}", [ball(1.0, _INERTIA_COLOUR)], shadow=False)
            self._scene.set_appearance(f"{group.name}/{k}", "scale", radii)
        nodes = [f"{group.name}/{k}" for k in range(len(ellipsoids_of_links))]
        links, ellipsoid_poses = (
            [link for link, _, _ in ellipsoids_of_links],
            np.array([T for _, T, _ in ellipsoids_of_links]).reshape(-1, 4, 4),
        )

        def update(q: Floats) -> None:
            if group.name in self._scene:
                self._scene.set_poses(
                    self.robot.link_poses(q)[links] @ ellipsoid_poses, self._scene.rows(nodes)
                )

        return self._attach(group, update)

    def manipulability(self, frame: str | None = None, size: float = 0.2, of: str = "velocity") -> Handle:
        """Show how fast a frame can move in each direction at joint speeds of length 1, or how hard it can push.

        Args:
            frame: The frame; the tool when not given.
            size: Metres per (m/s), or per N under joint torques of length 1 [m per m/s or N].
            of: "velocity" or "force".

        Returns:
            The handle of the ellipsoid.

        Raises:
            UnknownName: There is no such frame, or no such ellipsoid.
        """
        ellipsoids.check_kind(of)
        self._check_frame(frame)
        factor = number("size", size, "metres for each unit, above zero", above=0.0, most=MAX_LENGTH)
        group = self._group("manipulability")
        node = f"{group.name}/ellipsoid"
        self._scene.add(node, [ball(1.0, _MANIPULABILITY_COLOUR, 36)], shadow=False)

        def update(q: Floats) -> None:
            T, J = self.robot.fk(q, frame), self.robot.jacobian(q, frame)
            pose, radii = ellipsoids.manipulability_ellipsoid(J[:3], of)
            pose[:3, 3] = T[:3, 3]
            if node in self._scene:
                self._scene.set_pose(node, pose)
                self._scene.set_appearance(node, "scale", factor * radii)

        return self._attach(group, update)

    def trace(
        self,
        frame: str | None = None,
        color: Colour = _PATH_COLOUR,
        most: int = 2000,
        thickness: float = 0.006,
    ) -> Polyline:
        """Draw the path of the origin of a frame from now on. Played, filmed and exported motions draw their own.

        Args:
            frame: The frame; the tool when not given.
            color: The colour of the line.
            most: Largest number of points; of longer paths the newest are shown.
            thickness: Thickness of the line [m].

        Returns:
            The handle of the line.

        Raises:
            UnknownName: There is no such frame.

        Example:
            >>> viewer = ulna.Viewer(page=False)
            >>> arm = viewer.add(ulna.load("panda", visuals="simple"), "ready")
            >>> path = arm.trace()
            >>> for _ in range(20):
            ...     arm.q = arm.q + [0.1, 0, 0, 0, 0, 0, 0]
            >>> path.points.shape
            (21, 3)
        """
        self._check_frame(frame)
        max_points, line = count("most", most, 2, 10**6), Lines.through(np.zeros((0, 3)), color, thickness)
        group = self._group("trace")
        trace = FramePath(self._scene, f"{group.name}/path", self.robot, frame, line, max_points)
        trace.add(self.q)
        self._paths.append(trace)
        return Polyline(self._scene, trace.name)

    def force(
        self,
        frame: str | None = None,
        vector: ArrayLike = (0.0, 0.0, 0.0),
        color: Colour = _FORCE_COLOUR,
        size: float = 0.01,
    ) -> Arrow:
        """An arrow from the origin of a frame along a force; assign `vector` when it changes.

        Args:
            frame: The frame; the tool when not given.
            vector: The force in the base's axes [N], shape (3,).
            color: Its colour.
            size: How long it is drawn [m/N]: 50 N half a metre long when not given.

        Returns:
            The arrow.

        Raises:
            UnknownName: There is no such frame.
        """
        return self._arrow("force", frame, color, size, lambda q, arrow: None, vector)

    def velocity(
        self, frame: str | None = None, size: float = 0.5, color: Colour = _VELOCITY_COLOUR
    ) -> Arrow:
        """An arrow for the velocity of a frame's origin, as `qd` has it.

        Args:
            frame: The frame; the tool when not given.
            size: How long it is drawn [m per m/s].
            color: Its colour.

        Returns:
            The arrow.

        Raises:
            UnknownName: There is no such frame.
        """

        def set_vector(q: Floats, arrow: Arrow) -> None:
            arrow.vector = self.robot.jacobian(q, frame)[:3] @ self.qd

        return self._arrow("velocity", frame, color, size, set_vector)

    def ghosts(
        self, q: ArrayLike, color: Colour = (0.36, 0.47, 0.64), opacity: float = 0.25
    ) -> RobotInstancesHandle:
        """Show the robot, translucent, in more configurations.

        Args:
            q: The configurations, shape (n, nq) [rad or m].
            color: Their colour.
            opacity: Above 0, at most 1 [-].

        Returns:
            The handle; `q` can be assigned to.

        Raises:
            ShapeError, NonFiniteError: `q` is not of shape (n, nq) or not finite.

        Example:
            >>> viewer = ulna.Viewer(page=False)
            >>> arm = viewer.add(ulna.load("panda", visuals="simple"), "ready")
            >>> others = arm.ghosts(np.linspace(arm.q, arm.q + 0.5, 4)[1:], color="tomato")
            >>> others.q.shape
            (3, 7)
        """
        number("opacity", opacity, "a number above 0, at most 1", above=0.0, most=1.0)
        rgb, faint = faded(color, opacity)
        show = "visual" if self._visual.show == "both" else self._visual.show
        rgba = rgb and (*rgb, faint)
        return RobotInstancesHandle(
            RobotInstances(self._scene, self.robot, q, self._new_name("ghosts"), rgba, show)
        )

    def _check_frame(self, frame: str | None) -> None:
        """Refuse what is no frame."""
        if not (frame is None or isinstance(frame, str)):
            raise InputError(
                f"`frame` is {short_repr(frame)}; expected a frame's name, or None for the tool."
            )
        self.robot.fk(self.q, frame)

    def _new_name(self, kind: str) -> str:
        self._scene.row(self.name)  # raises where the robot was removed
        return f"{self.name}/({kind} {next(self._count)})"

    def _group(self, kind: str) -> Handle:
        return Handle(self._scene, self._scene.add(self._new_name(kind)).name)

    def _arrow(
        self,
        kind: str,
        frame: str | None,
        color: Colour,
        size: float,
        set_vector: Callable[[Floats, Arrow], None],
        vector: ArrayLike = (0.0, 0.0, 0.0),
    ) -> Arrow:
        """An arrow at a frame's origin, whose vector `set_vector` sets when the robot moves."""
        self._check_frame(frame)
        group, pose = self._group(kind), np.eye(4)
        try:
            out = add_arrow(self._scene, f"{group.name}/arrow", vector, color, 0.008, size)
        except BaseException:
            group.remove()
            raise

        def update(q: Floats) -> None:
            pose[:3, 3] = self.robot.fk(q, frame)[:3, 3]
            if group.name in self._scene:
                self._scene.set_pose(group.name, pose)
                set_vector(q, out)

        self._attach(group, update)
        return out

    def _attach(self, group: Handle, update: Any) -> Handle:
        try:
            update(self.q)
        except BaseException:
            group.remove()
            raise
        self._visual.follow(update)
        return group
