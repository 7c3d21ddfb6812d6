"""Links: the transforms from the parent link, dynamic parameters and shapes."""

from __future__ import annotations

import warnings
from functools import reduce
from operator import matmul
from typing import Any, Self

import numpy as np

from roboticstoolbox._common.errors import WrongType
from roboticstoolbox._common.numbers import greatest
from roboticstoolbox._common.poses import pose
from roboticstoolbox._ets.elementary_transform import ET, ET2, BaseET
from roboticstoolbox._ets.ets import ETS, ETS2
from roboticstoolbox._ets.sequence import BaseETS
from roboticstoolbox._links.dynamic_parameters import DynamicParameters
from roboticstoolbox._links.scene_frames import LinkNode
from roboticstoolbox._links.shapes import as_shapes, carried, copied
from ulna.errors import InputError
from ulna.typing import Floats


class Link(LinkNode, DynamicParameters):
    """A link: its transforms from the parent link (the joint last), mass, motor, limits and shapes."""

    _ets_class: type[BaseETS] = ETS

    def __init__(
        self,
        ets: Any = None,
        jindex: int | None = None,
        *,
        name: str = "",
        parent: Any = None,
        joint_name: str | None = None,
        m: float = 0.0,
        r: Any = (0.0, 0.0, 0.0),
        I: Any = (0.0, 0.0, 0.0),
        Jm: float = 0.0,
        B: float = 0.0,
        Tc: Any = (0.0, 0.0),
        G: float = 1.0,
        qlim: Any = None,
        qdlim: float | None = None,
        tlim: float | None = None,
        geometry: Any = (),
        collision: Any = (),
    ) -> None:
        """A link.

        Args:
            ets: Transforms from the parent's frame; at most one joint, the last.
            jindex: Which joint coordinate it takes.
            name: Its name.
            parent: The link before it, or its name.
            joint_name: Name of its joint.
            m: Mass [kg].
            r: Centre of mass in the link's frame [m].
            I: Inertia about the centre of mass: (3, 3), or Ixx, Iyy, Izz, Ixy, Iyz, Ixz [kg m^2].
            Jm: Inertia of the motor [kg m^2].
            B: Viscous friction at the motor [N m s/rad].
            Tc: Coulomb friction at the motor, [Tc+, Tc-] [N m].
            G: Gear ratio.
            qlim: Least and greatest joint coordinate [rad or m].
            qdlim: Greatest speed [rad/s or m/s].
            tlim: Greatest torque [N m or N].
            geometry: Shapes to draw.
            collision: Shapes to check.
        """
        self.robot: Any = None
        self.number: int | None = 0
        self.name = name
        self._parent, self._parent_name = _link_and_name(parent)
        self._joint_name = joint_name
        self.children: list[Link] = []
        self._children: list[Any] = []
        self._ets = self._checked_transforms(ets)
        if self.v is not None:
            if jindex is not None:
                self.jindex = jindex
            if qlim is not None:
                self.v.qlim = qlim
        self.qdlim, self.tlim = qdlim, tlim
        self.m, self.r, self.I, self.Jm, self.B, self.Tc, self.G = m, r, I, Jm, B, Tc, G
        self._drawn, self._solids = list(geometry), list(collision)
        carried(self._drawn + self._solids, self)

    @property
    def qdlim(self) -> float | None:
        """The greatest speed of its joint [rad/s or m/s]; None for no limit."""
        return self._qdlim

    @qdlim.setter
    def qdlim(self, speed: float | None) -> None:
        self._qdlim = greatest("qdlim", speed)

    @property
    def tlim(self) -> float | None:
        """The greatest torque of its joint [N m or N]; None for no limit."""
        return self._tlim

    @tlim.setter
    def tlim(self, torque: float | None) -> None:
        self._tlim = greatest("tlim", torque)

    @property
    def geometry(self) -> list[Any]:
        """Its shapes to draw, as those of spatialgeometry; they are attached to it."""
        return as_shapes(self._drawn, self)

    @geometry.setter
    def geometry(self, shapes: Any) -> None:
        self._drawn = carried(list(shapes), self)
        self._limits_or_shapes_changed()

    @property
    def collision(self) -> list[Any]:
        """Its shapes to check, as those of spatialgeometry; they are attached to it."""
        return as_shapes(self._solids, self)

    @collision.setter
    def collision(self, shapes: Any) -> None:
        self._solids = carried(list(shapes), self)
        self._limits_or_shapes_changed()

    def _limits_or_shapes_changed(self) -> None:
        if self.robot is not None:
            self.robot._discard_compiled()

    def _checked_transforms(self, ets: Any) -> Any:
        """A chain that a link can have: its joint, if it has one, is at its end."""
        transforms = self._ets_class(ets)
        transforms._auto_jindex = getattr(ets, "_auto_jindex", transforms._auto_jindex)
        joints = [i for i, et in enumerate(transforms.data) if et.isjoint]
        if len(joints) > 1 or (
            joints and joints[0] != len(transforms.data) - 1 and type(self) in (Link, Link2)
        ):
            raise InputError(
                f"Link {self.name!r} has the transforms {transforms}; expected one joint at most, at the end."
            )
        return transforms

    @property
    def ets(self) -> Any:
        """Its transforms."""
        return self._ets

    @ets.setter
    def ets(self, ets: Any) -> None:
        transforms = self._checked_transforms(ets)
        number, was_joint = self.jindex, self.isjoint
        if self.robot is not None and was_joint != any(et.isjoint for et in transforms.data):
            raise InputError(
                f"Link {self.name!r} belongs to a robot of {self.robot.n} joints; expected transforms "
                f"{'with' if was_joint else 'without'} a joint. Make a new Robot of the links."
            )
        keeps_number = was_joint and not self._ets._auto_jindex and transforms._auto_jindex
        self._ets = transforms
        if keeps_number and number is not None:
            self.jindex = number
        self._limits_or_shapes_changed()

    @property
    def v(self) -> BaseET | None:
        """Its joint, None for a fixed link."""
        return next((et for et in self._ets.data if et.isjoint), None)

    @property
    def Ts(self) -> Floats | None:
        """The constant part of its transforms, as a matrix; None where there is none."""
        fixed = [et.A() for et in self._ets.data if not et.isjoint]
        return reduce(matmul, fixed) if fixed else None

    @property
    def jindex(self) -> int | None:
        """Which joint coordinate it takes."""
        return None if self.v is None else self.v.jindex

    @jindex.setter
    def jindex(self, j: int) -> None:
        if self.v is not None:
            self.v.jindex, self._ets._auto_jindex = j, False

    @property
    def parent(self) -> Any:
        """The link before it; None for the first."""
        return self._parent

    @parent.setter
    def parent(self, parent: Any) -> None:
        if not isinstance(parent, Link | str | None):
            raise WrongType(f"`parent` of a link is {parent!r}; expected a link, or its name.")
        self._parent = parent if isinstance(parent, Link) else None
        self._parent_name = parent if isinstance(parent, str) else None
        self._limits_or_shapes_changed()

    @property
    def parent_name(self) -> str | None:
        """Name of the link before it."""
        return self._parent.name if self._parent is not None else self._parent_name

    @property
    def nchildren(self) -> int:
        """How many links come after it."""
        return len(self.children)

    @property
    def isjoint(self) -> bool:
        """Whether it moves."""
        return self.v is not None

    @property
    def isrevolute(self) -> bool:
        """Whether its joint turns."""
        return self.v is not None and self.v.isrotation

    @property
    def isprismatic(self) -> bool:
        """Whether its joint slides."""
        return self.v is not None and self.v.istranslation

    @property
    def isflip(self) -> bool:
        """Whether its joint counts backwards."""
        return self.v is not None and self.v.isflip

    @property
    def qlim(self) -> Floats | None:
        """Least and greatest joint coordinate, (2,)."""
        return None if self.v is None else self.v.qlim

    @qlim.setter
    def qlim(self, limits: Any) -> None:
        if self.v is None:
            raise InputError(f"Link {self.name!r} has no joint, so no limits.")
        self.v.qlim = limits
        self._limits_or_shapes_changed()

    def islimit(self, q: float) -> bool:
        """Whether `q` is beyond its limits."""
        return self.qlim is not None and bool(q < self.qlim[0] or q > self.qlim[1])

    def A(self, q: float = 0.0) -> Any:
        """The pose in the link before, as an SE3."""
        factors = [et.A(q if et.isjoint else None) for et in self._ets.data]
        return pose(reduce(matmul, factors) if factors else np.eye(self._ets_class._et._size))

    def copy(self, parent: Any = None) -> Self:
        """A copy, of no robot yet."""
        out = object.__new__(type(self))
        out.__dict__.update(self.__dict__)
        out.robot, out.children, out._children, out._parent = None, [], [], parent
        if parent is None:
            out._parent_name = self.parent_name
        out._ets = type(self._ets)._from_transforms(self._ets.data)
        out._ets._auto_jindex = self._ets._auto_jindex
        out._drawn, out._solids = (
            carried([copied(x) for x in shapes], out) for shapes in (self._drawn, self._solids)
        )
        return out

    def _details(self) -> list[str]:
        parts = [f'parent="{self.parent_name}"'] if self.parent_name else []
        if self.isflip:
            parts.append("isflip=1")
        if self.qlim is not None:
            parts.append(f"qlim=[{self.qlim[0]:.3g}, {self.qlim[1]:.3g}]")
        if self.hasdynamics:
            I = self.I
            six = [I[0, 0], I[1, 1], I[2, 2], I[0, 1], I[0, 2], I[1, 2]]
            parts += [f"m={self.m:.3g}", f"r={_listed(self.r)}", f"I={_listed(six)}", f"Jm={self.Jm:.3g}"]
            parts += [f"B={self.B:.3g}", f"Tc={_listed(self.Tc)}", f"G={self.G:.3g}"]
        return parts

    def __str__(self) -> str:
        first = [f'"{self.name}"', *([str(self._ets)] if self._ets.data else [])]
        return f"{type(self).__name__}({', '.join([*first, *self._details()])})"

    def __repr__(self) -> str:
        first = [*([repr(self._ets)] if self._ets.data else []), f'name = "{self.name}"']
        return f"{type(self).__name__}({', '.join([*first, *self._details()])})"


def _link_and_name(parent: Any) -> tuple[Link | None, str | None]:
    """The link before a link, where it is known already, and its name."""
    if not isinstance(parent, Link | str | None):
        raise WrongType(f"`parent` of a link is {parent!r}; expected a link, or its name.")
    return (parent, parent.name) if isinstance(parent, Link) else (None, parent)


def _listed(numbers: Any) -> str:
    return "[" + ", ".join(f"{x:.3g}" for x in numbers) + "]"


class Link2(Link):
    """A link of a robot in the plane."""

    _ets_class = ETS2


class ELink(Link):
    """The former name of `Link`."""

    def __init__(self, *arguments: Any, **more: Any) -> None:
        """A `Link`; see there."""
        warnings.warn("ELink is the former name of Link", FutureWarning, stacklevel=2)
        super().__init__(*arguments, **more)


class ELink2(Link2):
    """The former name of `Link2`."""

    def __init__(self, *arguments: Any, **more: Any) -> None:
        """A `Link2`; see there."""
        warnings.warn("ELink2 is the former name of Link2", FutureWarning, stacklevel=2)
        super().__init__(*arguments, **more)


__all__ = ["ET", "ET2", "ELink", "ELink2", "Link", "Link2"]
