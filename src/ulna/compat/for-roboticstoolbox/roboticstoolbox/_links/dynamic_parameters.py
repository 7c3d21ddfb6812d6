"""Dynamic parameters of a link: mass, inertia, motor and friction."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from roboticstoolbox._common.symbols import exact_entries, has_symbols, is_symbol, with_symbols
from ulna.errors import InputError, ShapeError
from ulna.model import Drive
from ulna.spatial import Inertia
from ulna.typing import Floats


def _read_only(numbers: Any) -> Floats:
    """A read-only copy: single entries that a script sets would not reach the robot's dynamics."""
    out = np.array(numbers)
    out = out if has_symbols(out) else out.astype(float)
    out.setflags(write=False)
    return out


def _inertia_matrix(I: Any) -> Floats:
    """Inertia as a matrix, from (3, 3), or Ixx, Iyy, Izz, or those and Ixy, Iyz, Ixz."""
    values = np.zeros(3) if I is None else np.asarray(I)
    if not has_symbols(values):
        values = values.astype(float)
    if values.shape == (9,):
        values = values.reshape(3, 3)
    if values.shape == (3, 3):
        gap = values - values.T
        if (gap != 0).any() if has_symbols(gap) else np.abs(gap).max() > 1e-8:
            raise InputError("`I` of a link is not symmetric; expected (3, 3), 3 or 6 numbers.")
        return _read_only(values)
    if values.size == 3:
        return _read_only([[x if i == j else 0.0 for j in range(3)] for i, x in enumerate(values.ravel())])
    if values.size == 6:
        xx, yy, zz, xy, yz, xz = values.ravel()
        return _read_only([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    raise ShapeError("I", values.shape, "(3, 3), (3,) or (6,): Ixx, Iyy, Izz, Ixy, Iyz, Ixz")


class _DynamicParameter:
    """An attribute of a link that its robot's dynamics depend on: setting it discards the robot's arrays."""

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
    values = np.ravel(np.asarray(Tc, dtype=float))
    out = np.array([values[0], -values[0]]) if values.size == 1 else values
    if out.shape != (2,) or out[0] < 0.0 or out[1] > 0.0:
        raise InputError(f"`Tc` of a link is {Tc}; expected one number, or [Tc+, Tc-] with Tc+ >= 0 >= Tc-.")
    return _read_only(out)


def _vector3(r: Any) -> Floats:
    out = np.ravel(np.zeros(3) if r is None else r)
    if out.shape != (3,):
        raise ShapeError("r", np.asarray(r).shape, "(3,)")
    return _read_only(out)


def _number(value: Any) -> Any:
    """A number, or a symbol; zero for None."""
    return value if is_symbol(value) else float(0.0 if value is None else value)


class DynamicParameters:
    """Mass, inertia, motor and friction of a link."""

    m = _DynamicParameter(_number)
    r = _DynamicParameter(_vector3)
    I = _DynamicParameter(_inertia_matrix)
    Jm = _DynamicParameter(_number)
    B = _DynamicParameter(_number)
    Tc = _DynamicParameter(_coulomb)
    G = _DynamicParameter(_number)

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any: ...

    @property
    def hasdynamics(self) -> bool:
        """Whether it has mass, or a motor with inertia."""
        return bool(self.m) or bool(self.Jm)

    @property
    def has_symbolic_mass(self) -> bool:
        """Whether its mass, inertia, motor or friction hold symbols."""
        return any(map(is_symbol, (self.m, self.Jm, self.B, self.G, *self.r, *self.I.ravel())))

    def friction(self, qd: float, coulomb: bool = True) -> float:
        """The torque of friction, against the motion.

        Args:
            qd: Speed of the joint [rad/s or m/s].
            coulomb: Whether Coulomb friction counts.

        Returns:
            Torque [N m or N].
        """
        gear = abs(self.G)
        tau = self.B * gear * gear * qd
        if coulomb and qd:
            tau += gear * (self.Tc[0] if qd > 0 else self.Tc[1])
        return -tau

    def nofriction(self, coulomb: bool = True, viscous: bool = False) -> Self:
        """A copy of the link without friction.

        Args:
            coulomb: Whether to leave out Coulomb friction.
            viscous: Whether to leave out viscous friction.

        Returns:
            The copy.
        """
        out = self.copy()
        out._remove_friction(coulomb, viscous)
        return out

    def _remove_friction(self, coulomb: bool, viscous: bool) -> None:
        if coulomb:
            self.Tc = [0.0, 0.0]
        if viscous:
            self.B = 0.0

    def _inertia(self) -> Inertia | None:
        """The body in Ulna's terms."""
        if not self.m and not self.I.any():
            return None
        return Inertia.from_com(self.m, self.r, self.I)

    def _drive(self) -> Drive:
        gear = self.G if self.G else 1.0
        return Drive(self.Jm, abs(self.B), self.Tc[0], -self.Tc[1], gear=gear)

    def dyn(self, indent: int = 0) -> str:
        """The dynamic parameters as text, a line for each; lines begin with `indent` blanks."""
        low, high = (0.0, 0.0) if self.qlim is None else self.qlim

        def listed(numbers: Any) -> str:
            return " ".join(f"{with_symbols('8.2g', x)}" for x in numbers)

        rows = [f"{listed(row)} | " for row in self.I]
        lines = [
            f"m     =  {with_symbols('8.2g', self.m)} ",
            f"r     =  {listed(self.r)} ",
            f"        | {rows[0]}",
            f"I     = | {rows[1]}",
            f"        | {rows[2]}",
            f"Jm    =  {with_symbols('8.2g', self.Jm)} ",
            f"B     =  {with_symbols('8.2g', self.B)} ",
            f"Tc    =  {self.Tc[0]:8.2g}(+) {self.Tc[1]:8.2g}(-) ",
            f"G     =  {with_symbols('8.2g', self.G)} ",
            f"qlim  =  {low:8.2g} to {high:8.2g}",
        ]
        return "\n".join(" " * indent + line for line in lines)

    def _table_cells(self) -> list[str]:
        """The dynamic parameters as cells of a table: m, r, I, Jm, B, Tc, G."""
        I = self.I
        six = (I[0, 0], I[1, 1], I[2, 2], I[0, 1], I[1, 2], I[0, 2])
        cells = ([self.m], self.r, six, [self.Jm], [self.B], self.Tc, [self.G])
        return [_table_cell(cell) for cell in cells]


def _table_cell(values: Any) -> str:
    if has_symbols(values):
        return ", ".join(map(str, exact_entries(values)))
    return ", ".join(f"{x: .3g}" for x in values)
