"""Sequences of elementary transforms and their kinematics, in space and in the plane."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from roboticstoolbox._common.poses import matrix, pose, to_planar, to_spatial
from roboticstoolbox._ets import inverse_kinematics as _ik
from roboticstoolbox._ets.elementary_transform import ET, ET2
from roboticstoolbox._ets.sequence import BaseETS
from ulna.typing import Floats


class ETS(BaseETS):
    """A chain of transforms in space."""

    def eval(self, q: Any = None, base: Any = None, tool: Any = None, include_base: bool = True) -> Floats:
        """The pose of the end, (4, 4) or (m, 4, 4)."""
        T = self._compiled(tool).fk(np.zeros(self.n) if q is None else q)
        return matrix(base) @ T if base is not None and include_base else T

    def fkine(self, q: Any = None, base: Any = None, tool: Any = None, include_base: bool = True) -> Any:
        """The pose of the end as an SE3."""
        return pose(self.eval(q, base, tool, include_base))

    def jacob0(self, q: Any, tool: Any = None) -> Floats:
        """The Jacobian in the axes of the start, (6, n)."""
        return self._compiled(tool).jacob0(q)

    def jacobe(self, q: Any, tool: Any = None) -> Floats:
        """The Jacobian in the axes of the end, (6, n)."""
        return self._compiled(tool).jacobe(q)

    def hessian0(self, q: Any = None, J0: Any = None, tool: Any = None) -> Floats:
        """The Hessian in the axes of the start, (n, 6, n); `J0` is not needed."""
        return self._compiled(tool).hessian0(q)

    def hessiane(self, q: Any = None, Je: Any = None, tool: Any = None) -> Floats:
        """The Hessian in the axes of the end, (n, 6, n); `Je` is not needed."""
        return self._compiled(tool).hessiane(q)

    def partial_fkine0(self, q: Any, n: int) -> Floats:
        """The derivatives of the pose of order `n`, (n, ..., n, 6, n): 1 the Jacobian, 2 the Hessian, and on."""
        return self._compiled(None).partial(q, n)

    def jacob0_analytical(self, q: Any, representation: str = "rpy/xyz", tool: Any = None) -> Floats:
        """The Jacobian of position and angles, (6, n)."""
        return self._compiled(tool).analytical(q, representation)

    def manipulability(self, q: Any, method: str = "yoshikawa", axes: Any = "all") -> Any:
        """A measure of the distance from singularities."""
        return self._compiled(None).manipulability(q, method, axes)

    def jacobm(self, q: Any, axes: Any = "all") -> Floats:
        """The gradient of manipulability, (n, 1)."""
        return self._compiled(None).jacobm(q, axes)

    def replace(self, i: int, axis: str) -> None:
        """Writes the transform at `i` as turns and one about or along another axis.

        Raises:
            ValueError: There is no such axis.
        """
        et = self.data[i]
        if axis not in ("x", "y", "z"):
            raise ValueError(f"`axis` is {axis!r}; expected 'x', 'y' or 'z'.")
        if et.ax == axis:
            return
        if et.ax is None:
            raise ValueError(f"{et} is a whole pose, which has no axis.")
        order = "xyz"
        step = (order.index(axis) - order.index(et.ax)) % 3
        about = order[3 - order.index(et.ax) - order.index(axis)]
        turn = math.pi / 2 if step == 1 else -math.pi / 2
        other = et._copy()
        other.axis = et.axis[0] + axis
        self.data[i : i + 1] = [ET(f"R{about}", -turn), other, ET(f"R{about}", turn)]

    def replaced(self, i: int, axis: str) -> ETS:
        """A copy on which `replace` was called."""
        return self._modified_copy("replace", i, axis)

    def _ik(self, kind: Any, Tep: Any, q0: Any, tool: Any, rest: dict[str, Any]) -> _ik.IKSolution:
        shared = {n: rest.pop(n) for n in ("ilimit", "slimit", "tol", "mask", "joint_limits") if n in rest}
        return _ik.solve(self._compiled(tool), Tep, kind, q0, **shared, **_ik.settings(rest))

    def ik_LM(self, Tep: Any, q0: Any = None, tool: Any = None, **rest: Any) -> _ik.IKSolution:
        """The joint coordinates for a pose of the end.

        Settings and solvers are those of `roboticstoolbox._ets.inverse_kinematics`.
        """
        return self._ik("LM", Tep, q0, tool, rest)

    def ik_NR(self, Tep: Any, q0: Any = None, tool: Any = None, **rest: Any) -> _ik.IKSolution:
        """The same by Newton and Raphson's method."""
        return self._ik("NR", Tep, q0, tool, rest)

    def ik_GN(self, Tep: Any, q0: Any = None, tool: Any = None, **rest: Any) -> _ik.IKSolution:
        """The same by Gauss and Newton's method."""
        return self._ik("GN", Tep, q0, tool, rest)

    def ikine_QP(self, Tep: Any, q0: Any = None, tool: Any = None, **rest: Any) -> _ik.IKSolution:
        """The same by quadratic programs."""
        return self._ik("QP", Tep, q0, tool, rest)

    ikine_LM, ikine_NR, ikine_GN = ik_LM, ik_NR, ik_GN


class ETS2(BaseETS):
    """A chain of transforms in the plane."""

    _et = ET2

    def eval(self, q: Any = None, base: Any = None, tool: Any = None, include_base: bool = True) -> Floats:
        """The pose of the end, (3, 3) or (m, 3, 3)."""
        T = to_planar(self._compiled(None).fk(np.zeros(self.n) if q is None else q))
        T = T if tool is None else T @ matrix(tool, 3)
        return matrix(base, 3) @ T if base is not None and include_base else T

    def fkine(self, q: Any = None, base: Any = None, tool: Any = None, include_base: bool = True) -> Any:
        """The pose of the end as an SE2."""
        return pose(self.eval(q, base, tool, include_base))

    def jacob0(self, q: Any) -> Floats:
        """The Jacobian in the axes of the start, (3, n): x, y, angle."""
        return self._compiled(None).jacob0(q)[..., [0, 1, 5], :]

    def jacobe(self, q: Any) -> Floats:
        """The Jacobian in the axes of the end, (3, n)."""
        return self._compiled(None).jacobe(q)[..., [0, 1, 5], :]

    def ikine_LM(self, Tep: Any, q0: Any = None, mask: Any = None, **rest: Any) -> _ik.IKSolution:
        """The joint coordinates for a pose in the plane, an SE2 or (3, 3)."""
        T = to_spatial(matrix(Tep, 3))
        x, y, turn = (1.0, 1.0, 1.0) if mask is None else mask
        shared = {n: rest.pop(n) for n in ("ilimit", "slimit", "tol", "joint_limits") if n in rest}
        return _ik.solve(
            self._compiled(None), T, "LM", q0, mask=(x, y, 0, 0, 0, turn), **shared, **_ik.settings(rest)
        )


ET.sequence_class, ET2.sequence_class = ETS, ETS2
