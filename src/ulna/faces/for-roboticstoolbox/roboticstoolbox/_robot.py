"""Robots as the toolbox has them: links, a state that scripts set, and methods for everything."""

from __future__ import annotations

import copy as copying
from pathlib import Path
from typing import Any, ClassVar, Self

import numpy as np

from roboticstoolbox._collision import Collision
from roboticstoolbox._dynamics import Dynamics, _three
from roboticstoolbox._ets import BaseETS
from roboticstoolbox._gripper import Gripper
from roboticstoolbox._kinematics import Kinematics
from roboticstoolbox._link import Link, Link2
from roboticstoolbox._plot import Plotting
from roboticstoolbox._poses import matrix, pose
from roboticstoolbox._table import grid
from roboticstoolbox._tree import connect, number
from ulna.errors import InputError, ShapeError
from ulna.typing import Floats

_ELSEWHERE = {
    "ikine_LMS": "ikine_LM",
    "ikine_min": "ikine_QP or ulna's robot.ik",
    "pay": "payload",
    "paycap": "payload_capacity",
    "URDF_read": "ulna.load(path), or models.URDF.URDFRobot(path)",
    "ikine_a": "robot.ik_all of an ulna.Robot, which gives all closed-form answers",
    "ikine_6s": "robot.ik_all of an ulna.Robot, which gives all closed-form answers",
    "analytic_ik": "robot.ik_all of an ulna.Robot",
    "ikine_analytic": "robot.ik_all of an ulna.Robot",
    "vision_collision_damper": "link_collision_damper",
    "partial_fkine0": "hessian0, or kernels of robot.ulna with .jacobian()",
    "showgraph": "print(robot.graph('mermaid'))",
    "cinertia": "inertia_x",
    "scene_children": "swift's env.add",
    "attach": "robot.ulna.attach",
    "attach_to": "robot.ulna.attach",
    "fkine_geometry": "fkine_all, and the placements of link.geometry",
    "twists": "PoERobot",
    "dhunique": "print(robot)",
}


class BaseRobot(Kinematics, Dynamics, Collision, Plotting):
    """What all robots share."""

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
        urdf_string: str | None = None,
        urdf_filepath: str | None = None,
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
            keywords: Words about it.
            symbolic: Refused.
            configs: Named configurations.
            check_jindex: Let pass.
            urdf_string: What it was read from.
            urdf_filepath: Where it was read from.
        """
        if symbolic:
            raise InputError("Symbolic robots are not offered; trace functions of an ulna.Robot instead.")
        if isinstance(arg, BaseRobot):
            links = [link.copy() for link in arg._links]
            name, manufacturer = name or arg.name, manufacturer or arg.manufacturer
        elif isinstance(arg, BaseETS):
            links = self._links_of(arg)
        else:
            links = list(arg)
        self.name, self.manufacturer, self.comment = name, manufacturer, comment
        self.keywords, self.symbolic = list(keywords), False
        self.urdf_string, self.urdf_filepath = urdf_string, urdf_filepath
        self._setup(links, gripper_links)
        self._base = self._unless_identity(base)
        self._tool = self._unless_identity(tool)
        self._gravity = _three(gravity)
        self.q, self.qd, self.qdd = np.zeros(self.n), np.zeros(self.n), np.zeros(self.n)
        self.control_mode = "v"
        self._configs: dict[str, Floats] = {}
        for key, q in (configs or {}).items():
            self.addconfiguration_attr(key, q)

    _size = 4

    @classmethod
    def _from_links(cls, links: list[Link], gripper: Link | None, **more: Any) -> Self:
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

    def _setup(self, links: list[Link], gripper_links: Any) -> None:
        firsts = [] if gripper_links is None else gripper_links
        firsts = [firsts] if isinstance(firsts, Link) else list(firsts)
        connect(links, self)
        self._grippers = []
        for first in firsts:
            hand = [first]
            for link in hand:
                hand.extend(link.children)
            self._grippers.append(Gripper(hand, name=first.name))
            links = [link for link in links if all(link is not other for other in hand)]
        number(links)
        for i, link in enumerate(links):
            link.number = i + 1
        self._links = links
        self.n = sum(link.isjoint for link in links)
        self._kernels, self._weights = {}, None
        self._chains, self._whole = {}, None

    def _forget(self) -> None:
        """Drops what was compiled for transforms and limits that have changed."""
        self._chains, self._whole, self._weights, self._kernels = {}, None, None, {}

    @classmethod
    def URDF(cls, file_path: str, gripper: Any = None) -> Self:
        """The robot in a URDF or xacro file."""
        from roboticstoolbox._load import from_model, read

        model, path = read(file_path)
        return from_model(cls, model, gripper_link=gripper, urdf_filepath=path)

    @property
    def links(self) -> list[Link]:
        """The links of the arm, those of grippers left out."""
        return self._links

    @property
    def ulna(self) -> Any:
        """Arm and grippers as an `ulna.Robot`, whose configurations have the grippers' joints, too."""
        return self._everything()

    @property
    def grippers(self) -> list[Gripper]:
        """What the arm carries."""
        return self._grippers

    @property
    def base_link(self) -> Link:
        """The first link."""
        return next(link for link in self._links if link.parent is None)

    @property
    def nlinks(self) -> int:
        """How many links there are, those of grippers included."""
        return len(self.link_dict)

    @property
    def nbranches(self) -> int:
        """How many ends the arm has."""
        return len(self.ee_links)

    def _joints(self) -> list[Link]:
        return sorted((link for link in self._links if link.isjoint), key=lambda link: link.jindex or 0)

    @property
    def structure(self) -> str:
        """A letter for each joint: R turns, P slides."""
        return "".join("R" if link.isrevolute else "P" for link in self._joints())

    @property
    def revolutejoints(self) -> list[bool]:
        """Which joints turn."""
        return [link.isrevolute for link in self._joints()]

    @property
    def prismaticjoints(self) -> list[bool]:
        """Which joints slide."""
        return [link.isprismatic for link in self._joints()]

    def isrevolute(self, j: int) -> bool:
        """Whether joint `j` turns."""
        return self._joints()[j].isrevolute

    def isprismatic(self, j: int) -> bool:
        """Whether joint `j` slides."""
        return self._joints()[j].isprismatic

    def islimit(self, q: Any = None) -> list[bool]:
        """Which joint coordinates are beyond their limits."""
        at = self.q if q is None else np.asarray(q, dtype=float)
        return [link.islimit(x) for link, x in zip(self._joints(), at, strict=True)]

    @property
    def q(self) -> Floats:  # type: ignore[override]
        """The configuration, (n,)."""
        return self._q

    @q.setter
    def q(self, q: Any) -> None:
        self._q = self._state("q", q)

    @property
    def qd(self) -> Floats:
        """The velocity, (n,)."""
        return self._qd

    @qd.setter
    def qd(self, qd: Any) -> None:
        self._qd = self._state("qd", qd)

    @property
    def qdd(self) -> Floats:
        """The acceleration, (n,)."""
        return self._qdd

    @qdd.setter
    def qdd(self, qdd: Any) -> None:
        self._qdd = self._state("qdd", qdd)

    def _state(self, name: str, value: Any) -> Floats:
        out = np.array(value, dtype=float).ravel()
        if out.shape != (self.n,):
            raise ShapeError(name, np.shape(value), f"({self.n},)")
        return out

    @property
    def control_mode(self) -> str:
        """What simulators integrate: "p", "v" or "a"."""
        return self._control_mode

    @control_mode.setter
    def control_mode(self, mode: str) -> None:
        if mode not in ("p", "v", "a"):
            raise InputError(f"`control_mode` is {mode!r}; expected 'p', 'v' or 'a'.")
        self._control_mode = mode

    @property
    def qdlim(self) -> Floats | None:
        """Greatest speeds, (n,); None where a joint has none."""
        speeds = [link.qdlim for link in self._joints()]
        return None if None in speeds else np.array(speeds, dtype=float)

    @property
    def base(self) -> Any:
        """Where the robot stands in the world."""
        return pose(np.eye(self._size) if self._base is None else self._base)

    @base.setter
    def base(self, T: Any) -> None:
        self._base = self._unless_identity(T)
        self._placed_anew()

    @property
    def tool(self) -> Any:
        """The tool at the end."""
        return pose(np.eye(self._size) if self._tool is None else self._tool)

    @tool.setter
    def tool(self, T: Any) -> None:
        self._tool = self._unless_identity(T)
        self._placed_anew()

    def _placed_anew(self) -> None:
        """Drops what base and tool are compiled into."""
        self._whole, self._weights, self._kernels = None, None, {}

    def _unless_identity(self, T: Any) -> Floats | None:
        if T is None:
            return None
        M = matrix(T, self._size)
        return None if np.array_equal(M, np.eye(self._size)) else M.copy()

    @property
    def gravity(self) -> Floats:
        """Acceleration of free fall in the world, (3,) [m/s^2]."""
        return self._gravity

    @gravity.setter
    def gravity(self, g: Any) -> None:
        self._gravity = _three(g)

    @property
    def reach(self) -> float:
        """The greatest distance its links could span [m]."""
        total = 0.0
        for link in self._links:
            for et in link.ets.data:
                if et.istranslation:
                    step = (
                        et.eta
                        if et.eta is not None
                        else 0.0
                        if et.qlim is None
                        else float(np.abs(et.qlim).max())
                    )
                    total += abs(step)
                elif et._T is not None:
                    total += float(np.linalg.norm(et._T[:-1, -1]))
        return total

    @property
    def hasgeometry(self) -> bool:
        """Whether any link has shapes to draw."""
        return any(link.geometry for link in self._links)

    @property
    def hascollision(self) -> bool:
        """Whether any link has shapes to check."""
        return any(link.collision for link in self._links)

    @property
    def configs(self) -> dict[str, Floats]:
        """Named configurations."""
        return self._configs

    def addconfiguration(self, name: str, q: Any) -> None:
        """Names a configuration, in `configs` alone."""
        self._configs[name] = self._state(name, q)

    def addconfiguration_attr(self, name: str, q: Any, unit: str = "rad") -> None:
        """Names a configuration, as an attribute too; `unit` "deg" converts angles."""
        values = self._state(name, q)
        self._configs[name] = self.toradians(values) if unit == "deg" else values
        setattr(self, name, self._configs[name])

    def todegrees(self, q: Any) -> Floats:
        """Angles in degrees, lengths as they are."""
        return np.where(self.revolutejoints, np.degrees(np.asarray(q, dtype=float)), q)

    def toradians(self, q: Any) -> Floats:
        """Angles in radians, lengths as they are."""
        return np.where(self.revolutejoints, np.radians(np.asarray(q, dtype=float)), q)

    def jtraj(self, T1: Any, T2: Any, t: Any, **options: Any) -> Any:
        """A joint trajectory between the configurations of two poses; `options` go to inverse kinematics."""
        from roboticstoolbox.tools.trajectory import jtraj

        ends = [self.ikine_LM(T, **options).q for T in (T1, T2)]
        return jtraj(ends[0], ends[1], t)

    def dfs_links(self, start: Link, func: Any = None) -> list[Link]:
        """The links from `start` on, children before siblings; `func` is called with each."""
        out = [start]
        if func is not None:
            func(start)
        for child in start.children:
            out += self.dfs_links(child, func)
        return out

    def get_path(self, end: Any = None, start: Any = None) -> tuple[list[Link], int, Any]:
        """The links from `start` to `end`, how many joints they have, and the tool's pose."""
        from roboticstoolbox._tree import between

        last, tool = self._end() if end is None else (self._link(end), None)
        rise, down = between(None if start is None else self._link(start), last)
        path = [*rise, *down]
        return path, sum(link.isjoint for link in path), pose(np.eye(4) if tool is None else tool)

    def segments(self) -> list[list[Link | None]]:
        """The branches of the tree, each from the link before it to its end."""
        out: list[list[Link | None]] = []
        waiting: list[tuple[Link | None, Link]] = [(None, self.base_link)]
        while waiting:
            before, at = waiting.pop(0)
            branch: list[Link | None] = [before, at]
            while len(at.children) == 1:
                at = at.children[0]
                branch.append(at)
            out.append(branch)
            waiting += [(at, child) for child in at.children]
        return out

    def graph(self, format: str = "dot") -> str:
        """The tree of links as text for Graphviz ("dot") or Mermaid ("mermaid")."""
        pairs = [(link.parent_name or "BASE", link.name) for link in self.link_dict.values()]
        if format == "mermaid":
            return "\n".join(["graph TD", *(f"    {a} --> {b}" for a, b in pairs)])
        if format != "dot":
            raise InputError(f"`format` is {format!r}; expected 'dot' or 'mermaid'.")
        return "\n".join(["digraph G {", *(f'    "{a}" -> "{b}";' for a, b in pairs), "}"])

    def dotfile(self, filename: Any, **_: Any) -> None:
        """Writes the tree of links for Graphviz, to a path or a file."""
        if hasattr(filename, "write"):
            filename.write(self.graph() + "\n")
        else:
            Path(filename).write_text(self.graph() + "\n", encoding="utf-8")

    def jointdynamics(self, q: Any, qd: Any = None) -> list[tuple[tuple[float], tuple[float, float]]]:
        """The transfer function of each motor, 1 / (J s + B): numerator and denominator, as seen by the motor."""
        M = np.diagonal(self.inertia(q))
        return [((1,), (float(m / link.G**2), link.B)) for m, link in zip(M, self._joints(), strict=True)]

    def hierarchy(self) -> None:
        """Prints the tree of links."""

        def show(link: Link, depth: int) -> None:
            print("  " * depth + link.name)
            for child in link.children:
                show(child, depth + 1)

        show(self.base_link, 0)

    def copy(self) -> Self:
        """A copy with links of its own."""
        return copying.deepcopy(self)

    def __deepcopy__(self, memo: Any) -> Self:
        out = object.__new__(type(self))
        memo[id(self)] = out
        shared = {"_kernels", "_chains", "_whole", "_weights"}
        new = {}
        everyone = list(self.link_dict.values())
        for link in everyone:
            new[id(link)] = link.copy()
            new[id(link)].robot = out
        for link in everyone:
            twin = new[id(link)]
            twin._parent = new.get(id(link._parent))
            twin.children = [new[id(child)] for child in link.children]
        for key, value in self.__dict__.items():
            if key in shared or key in ("_links", "_grippers"):
                continue
            out.__dict__[key] = copying.deepcopy(value, memo)
        out._kernels, out._chains, out._whole, out._weights = self._kernels, self._chains, self._whole, None
        out._links = [new[id(link)] for link in self._links]
        out._grippers = []
        for gripper in self._grippers:
            twin = Gripper([new[id(link)] for link in gripper.links], gripper.name, gripper._tool)
            twin.q = gripper.q.copy()
            out._grippers.append(twin)
        return out

    def __reduce__(self) -> Any:
        state = {
            k: v for k, v in self.__dict__.items() if k not in ("_kernels", "_chains", "_whole", "_weights")
        }
        return _rebuilt, (type(self), state)

    def __len__(self) -> int:
        return len(self._links)

    def __getitem__(self, i: Any) -> Any:
        return self._links[self._names().index(i)] if isinstance(i, str) else self._links[i]

    def __iter__(self) -> Any:
        return iter(self._links)

    def _names(self) -> list[str]:
        return [link.name for link in self._links]

    def __getattr__(self, name: str) -> Any:
        if name in _ELSEWHERE:
            raise AttributeError(f"`{name}` of a robot is not offered; use {_ELSEWHERE[name]}.")
        raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")

    def _kind_name(self) -> str:
        own = type(self)
        is_model = own.__module__.startswith("roboticstoolbox.models") and own.__name__ != "URDFRobot"
        return f"{own.__mro__[1].__name__}.{own.__name__}" if is_model else own.__name__

    def _headline(self) -> str:
        maker = f" (by {self.manufacturer})" if self.manufacturer else ""
        parts = [f"{self._kind_name()}: {self.name}{maker}", f"{self.n} joints ({self.structure})"]
        if self._grippers:
            count = len(self._grippers)
            parts.append(f"{count} gripper{'s' if count > 1 else ''}")
        if self.nbranches > 1:
            parts.append(f"{self.nbranches} branches")
        parts += [
            word
            for word, there in (
                ("dynamics", self.hasdynamics),
                ("geometry", self.hasgeometry),
                ("collision", self.hascollision),
            )
            if there
        ]
        return ", ".join(parts)

    def __str__(self) -> str:
        ends = {id(link) for link in self.ee_links}
        rows = []
        for i, link in enumerate(self._links):
            mark = "@" if id(link) in ends else ""
            joint = "" if link.jindex is None else str(link.jindex)
            rows.append([str(i), mark + link.name, joint, link.parent_name or "BASE", link.ets.words("q{0}")])
        header = ["link", "link", "joint", "parent", "ETS: parent to link"]
        right = [True, False, True, False, False]
        return f"{self._headline()}\n{grid(header, rows, right)}{self.configurations_str()}"

    def __repr__(self) -> str:
        return str(self)

    def configurations_str(self, border: str = "thin") -> str:
        """The named configurations as a table."""
        if not self._configs:
            return ""
        turns = self.revolutejoints
        rows = [
            [
                name,
                *(
                    f"{np.degrees(x): .3g}°" if turn else f"{x: .3g}"
                    for x, turn in zip(q, turns, strict=True)
                ),
            ]
            for name, q in self._configs.items()
        ]
        header = ["name", *(f"q{j}" for j in range(self.n))]
        columns = [True] + [False] * self.n
        return "\n" + grid(header, rows, columns, ragged=True)


def _rebuilt(kind: type, state: dict[str, Any]) -> Any:
    out = object.__new__(kind)
    out.__dict__.update(state)
    out._kernels, out._chains, out._whole, out._weights = {}, {}, None, None
    return out


class Robot(BaseRobot):
    """A robot in space."""


class ERobot(Robot):
    """The former name of `Robot`."""


class Robot2(BaseRobot):
    """A robot in the plane."""

    _link_class = Link2
    _size = 3

    def fkine(self, q: Any, end: Any = None, start: Any = None, **_: Any) -> Any:
        """The pose of `end` as an SE2."""
        from roboticstoolbox._et import flat

        T = flat(self._chain(end, start).fk(q))
        T = T if self._base is None else self._base @ T
        return pose(T if self._tool is None else T @ self._tool)

    def _chain(self, end: Any, start: Any, tool: Any = None) -> Any:
        key = self._named(end), self._named(start)
        if key not in self._chains:
            from roboticstoolbox._chain import Chain

            self._chains[key] = Chain(self.ets(start, end).data)
        return self._chains[key]

    def ets(self, start: Any = None, end: Any = None) -> Any:
        """The transforms from `start` to `end`."""
        from roboticstoolbox._ets import ETS2

        return ETS2._of(super().ets(start, end).data)

    def jacob0(self, q: Any, end: Any = None, start: Any = None, **_: Any) -> Floats:
        """The Jacobian in the axes of the start, (3, n)."""
        return self._chain(end, start).jacob0(q)[..., [0, 1, 5], :]

    def jacobe(self, q: Any, end: Any = None, start: Any = None, **_: Any) -> Floats:
        """The Jacobian in the axes of the end, (3, n)."""
        return self._chain(end, start).jacobe(q)[..., [0, 1, 5], :]


class ERobot2(Robot2):
    """The former name of `Robot2`."""
