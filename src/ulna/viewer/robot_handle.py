"""A robot in the viewer: its configuration, how it looks, and what moves along with it: frames, ellipsoids, traces."""

from __future__ import annotations

import itertools
import threading
from collections.abc import Callable, Sequence
from typing import Any, final

import numpy as np

from ulna.errors import InputError, UnknownName
from ulna.sim import Body
from ulna.typing import ArrayLike, Floats
from ulna.viewer import ellipsoids
from ulna.viewer.colours import Colour
from ulna.viewer.figure import Figure, Ghosts, checked_configuration
from ulna.viewer.handles import Arrow, Handle, Path, numbers
from ulna.viewer.links import Showing
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


@final
class RobotHandle(Handle):
    """A robot in the viewer. `q` and `qd` are its state; `pose` is where its base stands.

    While a simulation moves it they are the simulation's, before and after alike.
    """

    __slots__ = ("_body", "_count", "_figure", "_lock", "_qd", "_traces")

    def __init__(self, figure: Figure) -> None:
        super().__init__(figure.scene, figure.name)
        self._figure, self._lock = figure, threading.RLock()
        self._body: Body | None = None
        self._qd = np.zeros(figure.robot.nv)
        self._traces: list[Trail] = []
        self._count = itertools.count(1)

    @property
    def robot(self) -> Any:
        """The robot."""
        return self._figure.robot

    @property
    def scene(self) -> Scene:
        """The scene it stands in."""
        return self._scene

    @property
    def lock(self) -> threading.RLock:
        """Held while its configuration changes."""
        return self._lock

    @property
    def moves(self) -> int:
        """How often it was moved."""
        return self._figure.moves

    @property
    def body(self) -> Body | None:
        """What a simulation moves of it; None without one."""
        return self._body

    @property
    def q(self) -> Floats:
        """The configuration, shape (nq,); the name of one of the robot's own can be assigned, too."""
        return self._figure.q if self._body is None else self._body.q

    @q.setter
    def q(self, q: ArrayLike | str) -> None:
        robot = self._figure.robot
        self.put(_named(robot, q) if isinstance(q, str) else checked_configuration(robot, q))

    def put(self, q: Floats | Callable[[], Floats]) -> None:
        """As assigning to `q`, for an array that is known to be a configuration and that nobody will change.

        A function that gives such an array serves, too: it is called when somebody looks, on any thread.
        """
        with self._lock:
            if self._body is None and not self._traces:
                self._figure.put(q)
                return
            now = q() if callable(q) else q
            if self._body is not None:
                self._body.put(now)
            self._move(now)

    @property
    def qd(self) -> Floats:
        """The velocity, shape (nv,) [rad/s or m/s]."""
        return self._qd.copy() if self._body is None else self._body.qd

    @qd.setter
    def qd(self, qd: ArrayLike) -> None:
        with self._lock:
            if self._body is None:
                self._qd = numbers("qd", qd, self.robot.nv)
            else:
                self._body.qd = qd

    @property
    def show(self) -> Showing:
        """What of it is shown: "visual", "collision", "both" or "skeleton"."""
        return self._figure.show

    @show.setter
    def show(self, show: Showing) -> None:
        self._figure.dress(show)

    @property
    def tool(self) -> Floats:
        """Where its tool is, T_world_tool, shape (4, 4)."""
        return self.world_pose @ np.asarray(self.robot.fk(self.q))

    def simulated_by(self, body: Body | None) -> None:
        """Have its state be that of a simulated body, or its own again."""
        with self._lock:
            if body is None and self._body is not None:
                self._qd = self._body.qd
            self._body = body

    def show_at(self, q: Floats) -> None:
        """Show a configuration of the past; where a simulation has it stays as it is."""
        self._figure.move(q)

    def follow_body(self) -> None:
        """Show where the simulation has it now."""
        if self._body is not None:
            self._move(self._body.q)

    def _move(self, q: Floats) -> None:
        self._figure.put(q)
        for trace in self._traces:
            trace.add(q)

    # what moves along -----------------------------------------------------------------------------------------

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
        show = "visual" if self.show == "both" else self.show
        return GhostsHandle(Ghosts(self._scene, self.robot, q, group.name, rgba, show))

    def _group(self, kind: str) -> Handle:
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

    def remove(self) -> None:
        """Take it out of the scene, with all that follows it."""
        self._traces.clear()
        self._figure.remove()


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


def _named(robot: Any, name: str) -> Floats:
    if name not in robot.configurations:
        raise UnknownName("configuration", name, robot.configurations)
    return np.array(robot.configurations[name], dtype=float)
