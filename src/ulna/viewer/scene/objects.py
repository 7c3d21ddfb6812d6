"""Adding robots, shapes, meshes and copies of them to a scene, each under a name."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

import numpy as np

from ulna.checks.arrays import finite_array
from ulna.checks.values import checked_robot, short_repr
from ulna.collision import World
from ulna.errors import InputError
from ulna.geometry import Mesh, Shape
from ulna.idioms import check_keywords
from ulna.model import Model
from ulna.sim import Recording
from ulna.trajectory import Trajectory
from ulna.typing import ArrayLike
from ulna.viewer.colours import Colour, faded, faded_colours
from ulna.viewer.graph.content import Copies, transforms
from ulna.viewer.graph.handles import Handle, Instances
from ulna.viewer.graph.node import checked_poses, node_name, pose_or_position
from ulna.viewer.mesh.mesh_files import Detail, load_mesh
from ulna.viewer.mesh.primitives import tessellate
from ulna.viewer.mesh.surface import Surface
from ulna.viewer.progress import progress
from ulna.viewer.robot.configuration import configuration
from ulna.viewer.robot.link_surfaces import RobotDisplay
from ulna.viewer.robot.robot_handle import RobotHandle
from ulna.viewer.robot.robot_instances import RobotInstances, RobotInstancesHandle
from ulna.viewer.robot.robot_visual import RobotVisual
from ulna.viewer.scene.annotations import DEFAULT_SHAPE_COLOUR
from ulna.viewer.scene.plans import PlanMethods


class SceneMethods(PlanMethods):
    """Methods that add robots, shapes, meshes and copies of them to a scene.

    Every method that adds takes `name` (`table/leg` is added to the group `table`; an unused name when not given, and
    a node of the same name is replaced), `pose` (T_group_thing, an array (4, 4) or an `SE3`; or a position (3,)
    without rotation), `color` (see `ulna.viewer.colours.colour`) and `opacity` (from 0 to 1), and returns a handle
    whose properties can be assigned to. Invalid arguments raise before anything is added.
    """

    @check_keywords
    def add(
        self,
        thing: Any,
        q: ArrayLike | str | None = None,
        *,
        name: str | None = None,
        pose: Any = None,
        color: Colour | None = None,
        opacity: float = 1.0,
        show: RobotDisplay = "visual",
        detail: Detail = "seen",
    ) -> Any:
        """Add a robot, a shape of `ulna.geometry`, a world of obstacles, a surface, or a mesh file (dae, stl, glb ...).

        Args:
            thing: What to add.
            q: A robot's configuration: an array (nq,) [rad or m], the name of one of `robot.configurations`, or
                None.
            name: Its name.
            pose: T_group_thing, its pose in its group.
            color: One colour for all of it; that of its materials when not given.
            opacity: From 0 to 1 [-].
            show: What of a robot: "visual", "collision", "both" or "skeleton".
            detail: "full" for all triangles of mesh files, "seen" simplified within an error bound.

        Returns:
            A `RobotHandle` for a robot, for a world its handles by name (see `world`), a `Handle` for all else.

        Raises:
            InputError: It is nothing that can be shown, `q` is for no robot, or a mesh file cannot be read.
            ShapeError, NonFiniteError, UnknownName: An argument is not what it should be.

        Example:
            >>> viewer = ulna.Viewer(page=False)
            >>> left = viewer.add(ulna.load("panda"), name="left")
            >>> right = viewer.add(ulna.load("ur5"), pose=(0.0, 1.0, 0.0), color="orange")
            >>> [robot.name for robot in viewer.robots]
            ['left', 'ur5']
        """
        color, opacity = faded(color, opacity)
        common: dict[str, Any] = {"name": name, "pose": pose, "color": color, "opacity": opacity}
        if q is not None and not hasattr(thing, "link_poses"):
            raise InputError(f"`q` is {short_repr(q)}, a configuration, but {short_repr(thing)} is no robot.")
        if isinstance(thing, World):
            common["name"] = self._unused_name("world") if name is None else name
            return self.world(thing, **common)
        if isinstance(thing, Shape):
            if isinstance(thing, Mesh):
                return self.mesh(thing.path or "", thing.scale, detail=detail, **common)
            kind = type(thing).__name__.lower()
            surface = tessellate(thing, DEFAULT_SHAPE_COLOUR if color is None else (*color, 1.0))
            return self._add_node(name, kind, (surface,), pose=pose, opacity=opacity)
        if isinstance(thing, Surface):
            surface = thing if color is None else thing.coloured(color)
            return self._add_node(name, "surface", (surface,), pose=pose, opacity=opacity)
        if isinstance(thing, str | os.PathLike):
            _check_is_mesh(os.fspath(thing))
            return self.mesh(thing, detail=detail, **common)
        if not hasattr(thing, "link_poses"):
            raise InputError(f"Cannot show {short_repr(thing)}; {_advice(thing)}")
        return self._robot(checked_robot(thing), q, show=show, detail=detail, **common)

    def _robot(
        self,
        robot: Any,
        q: Any,
        name: str | None,
        pose: Any,
        color: Colour | None,
        opacity: float,
        show: RobotDisplay,
        detail: Detail,
    ) -> RobotHandle:
        start, group = configuration(robot, q), self._name(name, node_name(robot.name))
        with progress(f"Loading {robot.name}") as report:
            figure = RobotVisual(self.scene, robot, start, group, color, show, pose, report, detail)
        out = RobotHandle(figure)
        self._register(out, opacity)
        return out

    @check_keywords
    def mesh(
        self,
        path: str | os.PathLike[str],
        scale: float | Sequence[float] = 1.0,
        *,
        name: str | None = None,
        pose: Any = None,
        color: Colour | None = None,
        opacity: float = 1.0,
        detail: Detail = "seen",
    ) -> Handle:
        """A mesh file: dae (with textures), stl, obj, glb ...

        Args:
            path: The file.
            scale: A factor for its lengths, or one along each axis; negative ones mirror.
            name: Its name.
            pose: Where it stands.
            color: One colour for all of it; that of its materials when not given.
            opacity: From 0 to 1 [-].
            detail: "full" for all triangles, "seen" simplified within an error bound: see
                `ulna.viewer.mesh.mesh_files.load_mesh`.

        Returns:
            Its handle.

        Raises:
            InputError: The file cannot be read as a mesh.
            MissingExtra: trimesh is not installed.
        """
        file = _file(path)
        factors = finite_array("scale", scale, "a factor, or one along each axis")
        if factors.shape not in ((), (3,)) or not (factors != 0.0).all():
            raise InputError(
                f"`scale` is {short_repr(scale)}; expected a factor other than 0, or one along each axis."
            )
        color, opacity = faded(color, opacity)
        with progress(f"Loading {os.path.basename(file)}") as report:
            report(0, 1)
            surfaces: Sequence[Surface] = load_mesh(file, np.broadcast_to(factors, 3).tolist(), detail)
        if color is not None:
            surfaces = [s.coloured(color) for s in surfaces]
        kind = os.path.splitext(os.path.basename(file))[0].replace("/", ".") or "mesh"
        return self._add_node(name, kind, surfaces, pose=pose, opacity=opacity)

    @check_keywords
    def copies(
        self,
        thing: Shape | Surface | str | os.PathLike[str],
        poses: ArrayLike | None = None,
        *,
        positions: ArrayLike | None = None,
        colors: ArrayLike | str | None = None,
        scales: ArrayLike | None = None,
        name: str | None = None,
        pose: Any = None,
        opacity: float = 1.0,
    ) -> Instances:
        """One thing at many places, drawn at once: ten thousand boxes cost a screen little more than one.

        Args:
            thing: A shape, a surface or the path of a mesh file.
            poses: T_group_copy of each, (n, 4, 4); or
            positions: (n, 3) [m].
            colors: Red, green, blue of each, (n, 3); or one colour for all, (3,) or a name.
            scales: A factor along each axis, (n, 3).
            name: Its name.
            pose: Where the whole stands.
            opacity: From 0 to 1 [-].

        Returns:
            Their handle.

        Raises:
            InputError: Neither `poses` nor `positions` are given, or both.
        """
        if (poses is None) == (positions is None):
            raise InputError("Give either `poses` (n, 4, 4) or `positions` (n, 3) of the copies.")
        by_position = positions is not None
        transforms_of_copies = (
            transforms(positions) if by_position else checked_poses(poses, "poses", None, 4, 4)
        )
        colors, opacity = faded_colours(colors, opacity)
        content = Copies(_surfaces(thing), transforms_of_copies, colors, scales)
        return self._add_node(name, "copies", content=content, pose=pose, opacity=opacity, kind_of=Instances)

    @check_keywords
    def fleet(
        self,
        robot: Any,
        q: ArrayLike,
        bases: ArrayLike | None = None,
        *,
        name: str | None = None,
        pose: Any = None,
        color: Colour | None = None,
        opacity: float = 1.0,
        show: RobotDisplay = "visual",
    ) -> RobotInstancesHandle:
        """Many robots of one make, drawn at once; the handle's `q`, shape (n, nq), moves all of them.

        Args:
            robot: The robot.
            q: Their configurations, (n, nq) [rad or m].
            bases: T_group_base of each, shape (n, 4, 4).
            name: The name of their group.
            pose: Where the whole stands.
            color: One colour for all; their own when not given.
            opacity: From 0 to 1 [-].
            show: What of them, as for `add`.

        Returns:
            Their handle.

        Raises:
            ShapeError, NonFiniteError, UnknownName: An argument is not what it should be.
        """
        rgb, opacity = faded(color, opacity)
        group_pose = np.eye(4) if pose is None else pose_or_position(pose)
        base_poses = None if bases is None else checked_poses(bases, "bases", None, 4, 4)
        node = self._name(name, f"{checked_robot(robot).name} fleet")
        out = RobotInstancesHandle(
            RobotInstances(self.scene, robot, q, node, rgb and (*rgb, 1.0), show, base_poses)
        )
        out.pose = group_pose
        self._register(out, opacity)
        return out


def _surfaces(source: Any) -> tuple[Surface, ...]:
    if isinstance(source, Surface):
        return (source,)
    if isinstance(source, Mesh):
        return load_mesh(source.path or "", source.scale)
    if isinstance(source, Shape):
        return (tessellate(source, DEFAULT_SHAPE_COLOUR),)
    return load_mesh(_file(source))


def _check_is_mesh(path: str) -> None:
    """Raises InputError for what is a robot's name or file, not a mesh file."""
    suffix = os.path.splitext(path)[1]
    if suffix.lower() in (".urdf", ".xacro", ".xml") or (not suffix and not os.path.exists(path)):
        raise InputError(
            f"{path!r} is no mesh file (dae, stl, obj, glb ...). A robot is loaded first: "
            f"viewer.add(ulna.load({path!r}))."
        )


def _advice(value: Any) -> str:
    """What to do with something that cannot be added."""
    from ulna.planning import Plan

    if isinstance(value, Trajectory | Plan | Recording):
        return "add its robot, then viewer.play(motion) moves it; film and html take a motion, too."
    if isinstance(value, Model):
        return "expected a Robot, such as ulna.Robot(model)."
    return "expected a Robot, a shape, a World, a Surface, or the path of a mesh file."


def _file(path: Any) -> str:
    if not isinstance(path, str | os.PathLike):
        raise InputError(
            f"`path` is {short_repr(path)}; expected the path of a mesh file (dae, stl, obj, glb ...)."
        )
    return str(os.fspath(path))
