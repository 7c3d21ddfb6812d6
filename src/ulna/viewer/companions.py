"""What moves along with a robot: frames, its centre of mass, ellipsoids, traces, forces, velocities; and its ghosts."""

from __future__ import annotations

import abc
import itertools
from collections.abc import Sequence
from typing import Any, final

import numpy as np

from ulna.errors import InputError
from ulna.typing import ArrayLike, Floats
from ulna.viewer import ellipsoids
from ulna.viewer.colours import Colour
from ulna.viewer.figure import Figure, Ghosts
from ulna.viewer.handles import Arrow, Handle, Path
from ulna.viewer.scene import Scene
from ulna.viewer.surface import RGBA, colour
from ulna.viewer.tessellate import arrow, axes, ball
from ulna.viewer.trail import Trail

_CENTRE: RGBA = (0.85, 0.20, 0.55, 1.0)
_HEAVY: RGBA = (0.55, 0.35, 0.80, 0.45)
_REACH: RGBA = (0.16, 0.62, 0.56, 0.35)
_TRACE: RGBA = (0.95, 0.45, 0.10, 1.0)
_FORCE: RGBA = (0.86, 0.16, 0.16, 1.0)
_SPEED: RGBA = (0.10, 0.55, 0.30, 1.0)


class Companions(Handle, abc.ABC):
    """A robot in a scene, with what moves along with it."""

    __slots__ = ("_count", "_figure", "_traces")

    def __init__(self, figure: Figure) -> None:
        super().__init__(figure.scene, figure.name)
        self._figure = figure
        self._traces: list[Trail] = []
        self._count = itertools.count(1)

    @property
    def robot(self) -> Any:
        """The robot."""
        return self._figure.robot

    @property
    @abc.abstractmethod
    def q(self) -> Floats:
        """The configuration, shape (nq,)."""

    @property
    @abc.abstractmethod
    def qd(self) -> Floats:
        """The velocity, shape (nv,) [rad/s or m/s]."""

    def frames(self, frames: str | Sequence[str] = "all", length: float = 0.08) -> Handle:
        """Show frames as three arrows each: one by name, several, or "all" links' frames.

        Raises:
            UnknownName: There is no such frame.
        """
        names = self.robot.link_names if frames == "all" else [frames] if isinstance(frames, str) else frames
        group, kernel = self._group("frames"), self.robot.kernel("fk", frame=list(names))
        nodes = [f"{group.name}/{k}" for k in range(len(names))]
        for node in nodes:
            self._scene.add(node, axes(length), shadow=False, through=True)

        def bring(q: Floats) -> None:
            if group.name in self._scene:
                self._scene.set_poses(kernel(q), self._scene.rows(nodes))

        return self._follow(group, bring)

    def center_of_mass(self, radius: float = 0.02) -> Handle:
        """Show the centre of mass as a ball."""
        group = self._group("centre of mass")
        self._scene.add(f"{group.name}/ball", [ball(radius, _CENTRE)], shadow=False, through=True)
        place = np.eye(4)

        def bring(q: Floats) -> None:
            place[:3, 3] = self.robot.center_of_mass(q)
            if group.name in self._scene:
                self._scene.set_pose(group.name, place)

        return self._follow(group, bring)

    def inertias(self) -> Handle:
        """Show each link as the ellipsoid of even density that has its mass, centre of mass and inertia.

        Links of no mass, and inertias that no body can have, are left out.
        """
        group = self._group("inertias")
        found = ellipsoids.of_inertias(self.robot.model.links)
        for k, (_, _, radii) in enumerate(found):
            self._scene.add(f"{group.name}/{k}", [ball(1.0, _HEAVY)], shadow=False)
            self._scene.set_look(f"{group.name}/{k}", "scale", radii)
        nodes = [f"{group.name}/{k}" for k in range(len(found))]
        links, places = [link for link, _, _ in found], np.array([T for _, T, _ in found]).reshape(-1, 4, 4)

        def bring(q: Floats) -> None:
            if group.name in self._scene:
                self._scene.set_poses(self.robot.link_poses(q)[links] @ places, self._scene.rows(nodes))

        return self._follow(group, bring)

    def manipulability(self, frame: str | None = None, size: float = 0.2, of: str = "velocity") -> Handle:
        """Show how fast a frame can move in each direction at joint speeds of length 1, or how hard it can push.

        Args:
            frame: The frame; the tool when not given.
            size: Metres per (m/s), or per N under joint torques of length 1.
            of: "velocity" or "force".

        Raises:
            UnknownName: There is no such frame, or no such ellipsoid.
        """
        ellipsoids.check_kind(of)
        group = self._group("manipulability")
        node = f"{group.name}/ellipsoid"
        self._scene.add(node, [ball(1.0, _REACH, 36)], shadow=False)

        def bring(q: Floats) -> None:
            T, J = self.robot.fk(q, frame), self.robot.jacobian(q, frame)
            pose, radii = ellipsoids.of_jacobian(J[:3], of)
            pose[:3, 3] = T[:3, 3]
            if node in self._scene:
                self._scene.set_pose(node, pose)
                self._scene.set_look(node, "scale", size * radii)

        return self._follow(group, bring)

    def trace(
        self,
        frame: str | None = None,
        color: Colour = _TRACE,
        most: int = 2000,
        thickness: float = 0.006,
    ) -> Path:
        """Draw the way of a frame's origin, from now on; of very long ways the newest `most` points.

        Raises:
            UnknownName: There is no such frame.
        """
        group = self._group("trace")
        trace = Trail(self._scene, f"{group.name}/path", self.robot, frame, colour(color), most, thickness)
        trace.add(self.q)
        self._traces.append(trace)
        return Path(self._scene, trace.name)

    def force(
        self, frame: str | None = None, vector: ArrayLike = (0.0, 0.0, 0.0), color: Any = _FORCE
    ) -> Arrow:
        """An arrow from a frame's origin along `vector` in the base's axes, a metre for a unit; assign `vector` anew.

        Raises:
            UnknownName: There is no such frame.
        """
        group = self._group("force")
        out = self._arrow(f"{group.name}/arrow", vector, color)
        place = np.eye(4)

        def bring(q: Floats) -> None:
            place[:3, 3] = self.robot.fk(q, frame)[:3, 3]
            if group.name in self._scene:
                self._scene.set_pose(group.name, place)

        self._follow(group, bring)
        return out

    def velocity(self, frame: str | None = None, size: float = 0.5, color: Any = _SPEED) -> Arrow:
        """An arrow for the velocity of a frame's origin, `size` metres for 1 m/s, as `qd` has it.

        Raises:
            UnknownName: There is no such frame.
        """
        group = self._group("velocity")
        out = self._arrow(f"{group.name}/arrow", (0.0, 0.0, 0.0), color)
        place = np.eye(4)

        def bring(q: Floats) -> None:
            place[:3, 3] = self.robot.fk(q, frame)[:3, 3]
            if group.name in self._scene:
                self._scene.set_pose(group.name, place)
                out.vector = size * (self.robot.jacobian(q, frame)[:3] @ self.qd)

        self._follow(group, bring)
        return out

    def ghosts(self, q: ArrayLike, color: Colour = (0.36, 0.47, 0.64), opacity: float = 0.25) -> GhostsHandle:
        """Show it in many more configurations `q`, shape (n, nq), faintly.

        Raises:
            ShapeError, NonFiniteError: `q` holds no configurations.
        """
        if not 0.0 < opacity <= 1.0:
            raise InputError(f"`opacity` is {opacity}; expected a number above 0, at most 1.")
        group = self._group("ghosts")
        rgba = (*colour(color)[:3], float(opacity))
        show = "visual" if self._figure.show == "both" else self._figure.show
        return GhostsHandle(Ghosts(self._scene, self.robot, q, group.name, rgba, show))

    def _group(self, kind: str) -> Handle:
        self._scene.row(self.name)  # what was removed is not begun anew
        name = f"{self.name}/({kind} {next(self._count)})"
        self._scene.add(name)
        return Handle(self._scene, name)

    def _arrow(self, name: str, vector: ArrayLike, color: Colour) -> Arrow:
        return add_arrow(self._scene, name, vector, color, 0.008)

    def _follow(self, group: Handle, bring: Any) -> Handle:
        try:
            bring(self.q)
        except BaseException:
            group.remove()
            raise
        self._figure.follow(bring)
        return group


@final
class GhostsHandle(Handle):
    """A robot many times over; `q`, shape (n, nq), can be assigned to."""

    __slots__ = ("_ghosts",)

    def __init__(self, ghosts: Ghosts) -> None:
        super().__init__(ghosts.scene, ghosts.name)
        self._ghosts = ghosts

    @property
    def q(self) -> Floats:
        """The configurations, shape (n, nq)."""
        return self._ghosts.q

    @q.setter
    def q(self, q: ArrayLike) -> None:
        self._ghosts.move(q)


def add_arrow(scene: Scene, name: str, vector: ArrayLike, color: Colour, radius: float) -> Arrow:
    """Add an arrow from the origin of its group along a vector [m]."""
    shaft, tip = arrow(colour(color))
    scene.add(f"{name}/shaft", [shaft])
    scene.add(f"{name}/tip", [tip])
    try:
        return Arrow(scene, name, vector, radius)
    except BaseException:
        scene.remove(name)
        raise
