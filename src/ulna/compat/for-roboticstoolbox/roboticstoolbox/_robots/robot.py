"""Robots of the toolbox: links, a state, and the methods of the mixins."""

from __future__ import annotations

import warnings
from typing import Any, ClassVar, Self

import numpy as np

from roboticstoolbox._common.errors import WrongType
from roboticstoolbox._common.poses import constant_pose, pose
from roboticstoolbox._dynamics.dynamics import Dynamics, vector3
from roboticstoolbox._dynamics.mass_parameters import MassParameters
from roboticstoolbox._dynamics.operational_space import OperationalSpace
from roboticstoolbox._dynamics.simulation import ForwardSimulation
from roboticstoolbox._ets.sequence import BaseETS
from roboticstoolbox._kinematics.collision import Collision
from roboticstoolbox._kinematics.kinematics import Kinematics
from roboticstoolbox._links.gripper import Gripper
from roboticstoolbox._links.link import Link
from roboticstoolbox._links.link_tree import connect, ordered_joints
from roboticstoolbox._mixins.copying import Copying
from roboticstoolbox._mixins.link_access import LinkAccess
from roboticstoolbox._mixins.link_graph import LinkGraph
from roboticstoolbox._mixins.robot_frame import RobotNode
from roboticstoolbox._mixins.state import State
from roboticstoolbox._mixins.text import RobotText
from roboticstoolbox._plot.ellipsoids import Ellipsoids
from roboticstoolbox._plot.plotting import Plotting
from roboticstoolbox._plot.teaching import Teaching
from ulna.typing import Floats

_ELSEWHERE = {
    "ikine_LMS": "ikine_LM",
    "ikine_min": "ikine_QP or ulna's robot.ik",
    "pay": "payload",
    "paycap": "payload_capacity",
    "URDF_read": "ulna.load(path), or models.URDF.URDFRobot(path)",
    "ikine_a": "analytic_ik().solve(T), which returns all solutions",
    "ikine_6s": "robot.ulna.ik_all, which returns all solutions",
    "analytic_ik": "robot.ulna.ik_all, which returns all solutions",
    "ikine_analytic": "robot.ulna.ik_all, which returns all solutions",
    "twists": "PoERobot",
    "dhunique": "print(robot)",
}


class BaseRobot(
    LinkAccess,
    State,
    Kinematics,
    Dynamics,
    OperationalSpace,
    ForwardSimulation,
    MassParameters,
    Collision,
    RobotNode,
    Plotting,
    Teaching,
    Ellipsoids,
    RobotText,
    LinkGraph,
    Copying,
):
    """Base class of all robots."""

    _link_class: ClassVar[type[Link]] = Link

    def __init__(
        self,
        arg: Any,
        gripper_links: Any = None,
        name: str = "",
        manufacturer: str = "",
        comment: str = "",
        base: Any = None,
        tool: Any = None,
        gravity: Any = (0.0, 0.0, -9.81),
        keywords: Any = (),
        symbolic: bool = False,
        configs: dict[str, Any] | None = None,
        check_jindex: bool = True,
        urdf_string: str = "",
        urdf_filepath: str = "",
    ) -> None:
        """A robot of links, of a chain of transforms, or like another robot.

        Args:
            arg: Links, a chain, or a robot.
            gripper_links: First links of grippers.
            name: Its name.
            manufacturer: Who makes it.
            comment: A remark.
            base: Where it stands in the world.
            tool: A tool at the end.
            gravity: Acceleration of free fall [m/s^2].
            keywords: Keywords for the catalogue.
            symbolic: Whether parameters of its links are symbols; kept as an attribute.
            configs: Named configurations.
            check_jindex: Whether the numbers of joints must be 0 to n - 1.
            urdf_string: What it was read from.
            urdf_filepath: Where it was read from.
        """
        links = self._links_from(arg)
        if isinstance(arg, BaseRobot):
            name, manufacturer = name or arg.name, manufacturer or arg.manufacturer
        self.name, self.manufacturer, self.comment = name, manufacturer, comment
        self.keywords, self.symbolic = list(keywords), bool(symbolic)
        self.urdf_string, self.urdf_filepath = urdf_string, urdf_filepath
        self._parent, self._children = None, []
        self._setup(links, gripper_links, check_jindex)
        self._base = self._unless_identity(base)
        self._tool = self._unless_identity(tool)
        self._gravity = vector3(gravity)
        self.q, self.qd, self.qdd = np.zeros(self.n), np.zeros(self.n), np.zeros(self.n)
        self.control_mode = "v"
        self._configs: dict[str, Floats] = {}
        for key, q in (configs or {}).items():
            self.addconfiguration_attr(key, q)

    _size = 4

    def _links_from(self, arg: Any) -> list[Link]:
        """The links of what a robot is made of: links, a chain of transforms or a robot, whose links are copied."""
        if isinstance(arg, BaseRobot):
            return [link.copy() for link in arg._links]
        if isinstance(arg, BaseETS):
            return self._links_of(arg)
        if isinstance(arg, list | tuple):
            return list(arg)
        raise WrongType(
            f"A robot is made of links, a chain of transforms or a robot; {arg!r} is none of them."
        )

    @classmethod
    def _from_links(cls, links: list[Link], gripper: list[Link] | None, **more: Any) -> Self:
        return cls(links, gripper_links=gripper, **more)

    @classmethod
    def _links_of(cls, chain: BaseETS) -> list[Link]:
        """A link for each joint, and one for what comes after the last."""
        out: list[Link] = []
        for part in chain.split():
            if part.data:
                parent = out[-1] if out else None
                out.append(cls._link_class(part, parent=parent, name=f"link{len(out)}"))
        return out

    def _setup(self, links: list[Link], gripper_links: Any, check_jindex: bool = True) -> None:
        gripper_roots = [] if gripper_links is None else gripper_links
        gripper_roots = [gripper_roots] if isinstance(gripper_roots, Link) else list(gripper_roots)
        connect(links, self)
        self._grippers = []
        for first in gripper_roots:
            members = [first]
            for link in members:
                members.extend(link.children)
            self._grippers.append(Gripper(members, name=first.name))
            links = [link for link in links if all(link is not other for other in members)]
        self._links = links = ordered_joints(links, check_jindex)
        self.n = sum(link.isjoint for link in links)
        self._kernels, self._dynamic_arrays = {}, None
        self._chains, self._cached_robot = {}, None

    def _discard_compiled(self) -> None:
        """Discards what was compiled with former transforms and limits."""
        self._chains, self._cached_robot, self._dynamic_arrays, self._kernels = {}, None, None, {}

    @classmethod
    def URDF(cls, file: str, gripper: int | str | None = None, manufacturer: str = "") -> Self:
        """The robot in a URDF or xacro file.

        Args:
            file: Path of the file.
            gripper: First link of the gripper, or its number; None for no gripper.
            manufacturer: Name of the maker.

        Returns:
            The robot.
        """
        from roboticstoolbox._robots.from_model import from_model, read_model

        warnings.warn(
            "Robot.URDF(file) is the former way to read a description; take models.URDF.URDFRobot(file)",
            DeprecationWarning,
            stacklevel=2,
        )
        model, path = read_model(file)
        first = model.links[gripper].name if isinstance(gripper, int) else gripper
        return from_model(cls, model, gripper_link=first, manufacturer=manufacturer, urdf_filepath=path)

    @property
    def ulna(self) -> Any:
        """Arm and grippers as an `ulna.Robot`, whose configurations have the grippers' joints, too."""
        return self._complete_robot()

    @property
    def base(self) -> Any:
        """Where the robot stands in the world."""
        return pose(np.eye(self._size) if self._base is None else self._base)

    @base.setter
    def base(self, T: Any) -> None:
        self._base = self._unless_identity(T)
        self._on_base_or_tool_change()

    @property
    def tool(self) -> Any:
        """The tool at the end."""
        return pose(np.eye(self._size) if self._tool is None else self._tool)

    @tool.setter
    def tool(self, T: Any) -> None:
        self._tool = self._unless_identity(T)
        self._on_base_or_tool_change()

    def _on_base_or_tool_change(self) -> None:
        """Discards what was compiled with the former base and tool."""
        self._cached_robot, self._dynamic_arrays, self._kernels = None, None, {}

    def _unless_identity(self, T: Any) -> Floats | None:
        if T is None:
            return None
        M = constant_pose(T, self._size)
        return None if np.array_equal(M, np.eye(self._size)) else M

    @property
    def gravity(self) -> Floats:
        """Acceleration of free fall in the world, (3,) [m/s^2]."""
        return self._gravity

    @gravity.setter
    def gravity(self, g: Any) -> None:
        self._gravity = vector3(g)

    def __getattr__(self, name: str) -> Any:
        if name in _ELSEWHERE:
            raise AttributeError(f"`{name}` of a robot is not offered; use {_ELSEWHERE[name]}.")
        raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")


class Robot(BaseRobot):
    """A robot in space."""


class ERobot(Robot):
    """The former name of `Robot`."""
