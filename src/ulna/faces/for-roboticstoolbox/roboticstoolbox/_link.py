"""Links: a chain of transforms from the link before, and what the body weighs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Self

import numpy as np

from roboticstoolbox._et import ET, ET2, BaseET
from roboticstoolbox._ets import ETS, ETS2, BaseETS
from roboticstoolbox._poses import pose
from ulna.errors import InputError, ShapeError
from ulna.model import Drive
from ulna.spatial import Inertia
from ulna.typing import Floats


def _matrix_of_inertia(I: Any) -> Floats:
    """Inertia as a matrix, from (3, 3), or Ixx, Iyy, Izz, or those and Ixy, Iyz, Ixz."""
    given = np.asarray(I, dtype=float)
    if given.shape == (3, 3):
        if np.abs(given - given.T).max() > 1e-8:
            raise InputError("`I` of a link is not symmetric; expected (3, 3), 3 or 6 numbers.")
        return given.copy()
    if given.size == 3:
        return np.diag(given.ravel())
    if given.size == 6:
        xx, yy, zz, xy, yz, xz = given.ravel()
        return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    raise ShapeError("I", given.shape, "(3, 3), (3,) or (6,): Ixx, Iyy, Izz, Ixy, Iyz, Ixz")


class _Weight:
    """An attribute of a link that its robot's dynamics depend on: setting it tells the robot."""

    def __init__(self, convert: Callable[[Any], Any]) -> None:
        self._convert = convert

    def __set_name__(self, _: type, name: str) -> None:
        self._name = f"_{name}"

    def __get__(self, link: Any, _: type | None = None) -> Any:
        return self if link is None else getattr(link, self._name)

    def __set__(self, link: Any, value: Any) -> None:
        setattr(link, self._name, self._convert(value))
        if link.robot is not None:
            link.robot.dynchanged()


def _coulomb(Tc: Any) -> Floats:
    """Coulomb friction in both directions: the second number is that of backward motion, not positive."""
    given = np.ravel(np.asarray(Tc, dtype=float))
    out = np.array([given[0], -given[0]]) if given.size == 1 else given
    if out.shape != (2,) or out[0] < 0.0 or out[1] > 0.0:
        raise InputError(f"`Tc` of a link is {Tc}; expected one number, or [Tc+, Tc-] with Tc+ >= 0 >= Tc-.")
    return out


def _vector3(r: Any) -> Floats:
    out = np.array(r, dtype=float).ravel()
    if out.shape != (3,):
        raise ShapeError("r", np.shape(r), "(3,)")
    return out


class Link:
    """A link: its transforms from the link before (the joint last), mass, motor, limits and shapes."""

    _ets_class: type[BaseETS] = ETS

    m = _Weight(float)
    r = _Weight(_vector3)
    I = _Weight(_matrix_of_inertia)
    Jm = _Weight(float)
    B = _Weight(float)
    Tc = _Weight(_coulomb)
    G = _Weight(float)

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
        """A link; what it is called after is that of the toolbox.

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
        self.number: int | None = None
        self.name = name
        self._parent = parent if isinstance(parent, Link) else None
        self._parent_name = parent.name if isinstance(parent, Link) else parent
        self._joint_name = joint_name
        self.children: list[Link] = []
        given = self._ets_class(ets)
        joints = [i for i, et in enumerate(given.data) if et.isjoint]
        if len(joints) > 1 or (joints and joints[0] != len(given.data) - 1 and type(self) in (Link, Link2)):
            raise InputError(
                f"Link {name!r} has the transforms {given}; expected one joint at most, at the end."
            )
        self._ets = given
        if joints:
            joint = given.data[joints[0]]
            if jindex is not None:
                joint.jindex = jindex
            if qlim is not None:
                joint.qlim = qlim
        self.qdlim, self.tlim = qdlim, tlim
        self.m, self.r, self.I, self.Jm, self.B, self.Tc, self.G = m, r, I, Jm, B, Tc, G
        self.geometry, self.collision = list(geometry), list(collision)

    @property
    def ets(self) -> Any:
        """Its transforms."""
        return self._ets

    @property
    def v(self) -> BaseET | None:
        """Its joint, None for a fixed link."""
        return next((et for et in self._ets.data if et.isjoint), None)

    @property
    def Ts(self) -> Floats | None:
        """The constant part of its transforms, as a matrix; None where there is none."""
        fixed = [et.A() for et in self._ets.data if not et.isjoint]
        if not fixed:
            return None
        T = fixed[0]
        for other in fixed[1:]:
            T = T @ other
        return T

    @property
    def jindex(self) -> int | None:
        """Which joint coordinate it takes."""
        return None if self.v is None else self.v.jindex

    @jindex.setter
    def jindex(self, j: int) -> None:
        if self.v is None:
            raise InputError(f"Link {self.name!r} has no joint, so no `jindex`.")
        self.v.jindex = j

    @property
    def parent(self) -> Any:
        """The link before it; None for the first."""
        return self._parent

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
        if self.robot is not None:
            self.robot._forget()

    def islimit(self, q: float) -> bool:
        """Whether `q` is beyond its limits."""
        return self.qlim is not None and bool(q < self.qlim[0] or q > self.qlim[1])

    def A(self, q: float = 0.0) -> Any:
        """The pose in the link before, as an SE3."""
        T = np.eye(self._ets_class._et._size)
        for et in self._ets.data:
            T = T @ et.A(q if et.isjoint else None)
        return pose(T)

    @property
    def hasdynamics(self) -> bool:
        """Whether it has mass, inertia, motor or friction."""
        numbers = (self.m, self.Jm, self.B, *self.r, *self.I.ravel(), *self.Tc)
        return any(bool(x) for x in numbers)

    def friction(self, qd: float, coulomb: bool = True) -> float:
        """The torque of friction at the joint's speed `qd`; against it."""
        gear = abs(self.G)
        tau = self.B * gear * gear * qd
        if coulomb and qd:
            tau += gear * (self.Tc[0] if qd > 0 else self.Tc[1])
        return -tau

    def nofriction(self, coulomb: bool = True, viscous: bool = False) -> Self:
        """A copy without Coulomb friction, without viscous friction."""
        out = self.copy()
        if coulomb:
            out.Tc = [0.0, 0.0]
        if viscous:
            out.B = 0.0
        return out

    def copy(self, parent: Any = None) -> Self:
        """A copy, of no robot yet."""
        out = object.__new__(type(self))
        out.__dict__.update(self.__dict__)
        out.robot, out.children, out._parent = None, [], parent
        if parent is None:
            out._parent_name = self.parent_name
        out._ets = type(self._ets)._of(self._ets.data)
        return out

    def _inertia(self) -> Inertia | None:
        """The body in Ulna's terms."""
        if not self.m and not self.I.any():
            return None
        return Inertia.from_com(self.m, self.r, self.I)

    def _drive(self) -> Drive:
        gear = self.G if self.G else 1.0
        return Drive(self.Jm, abs(self.B), self.Tc[0], -self.Tc[1], gear=gear)

    def dyn(self, indent: int = 0) -> str:
        """Prints what it weighs; gives the text, too."""
        I, edge = self.I, " " * indent
        rows = [f"{'':10}| " + "".join(f"{x:9.2g}" for x in row) + " |" for row in I]
        rows[1] = "  I     = " + rows[1].lstrip()
        lines = [
            f"  m     = {self.m:9.2g}",
            "  r     = " + "".join(f"{x:9.2g}" for x in self.r),
            *rows,
            f"  Jm    = {self.Jm:9.2g}",
            f"  B     = {self.B:9.2g}",
            f"  Tc    = {self.Tc[0]:9.2g}(+) {self.Tc[1]:9.2g}(-)",
            f"  G     = {self.G:9.2g}",
        ]
        if self.qlim is not None:
            lines.append(f"  qlim  = {self.qlim[0]:9.2g} to {self.qlim[1]:9.2g}")
        return "\n".join(edge + line for line in lines)

    def _details(self) -> list[str]:
        parts = [f'parent="{self.parent_name}"'] if self.parent_name else []
        if self.isflip:
            parts.append("isflip=1")
        if self.qlim is not None:
            parts.append(f"qlim=[{self.qlim[0]:.3g}, {self.qlim[1]:.3g}]")
        if self.hasdynamics:
            I = self.I
            six = [I[0, 0], I[1, 1], I[2, 2], I[0, 1], I[1, 2], I[0, 2]]
            parts += [f"m={self.m:.3g}", f"r={_listed(self.r)}", f"I={_listed(six)}", f"Jm={self.Jm:.3g}"]
            parts += [f"B={self.B:.3g}", f"Tc={_listed(self.Tc)}", f"G={self.G:.3g}"]
        return parts

    def __str__(self) -> str:
        first = [f'"{self.name}"', *([str(self._ets)] if self._ets.data else [])]
        return f"{type(self).__name__}({', '.join([*first, *self._details()])})"

    def __repr__(self) -> str:
        first = [*([repr(self._ets)] if self._ets.data else []), f'name = "{self.name}"']
        return f"{type(self).__name__}({', '.join([*first, *self._details()])})"


def _listed(numbers: Any) -> str:
    return "[" + ", ".join(f"{x:.3g}" for x in numbers) + "]"


class Link2(Link):
    """A link of a robot in the plane."""

    _ets_class = ETS2


ELink, ELink2 = Link, Link2

__all__ = ["ET", "ET2", "ELink", "ELink2", "Link", "Link2"]
