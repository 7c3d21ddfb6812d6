"""The Toolbox's compiled functions on chains, by their names: a chain is its own handle here."""

from __future__ import annotations

from typing import Any

import numpy as np

from roboticstoolbox._common.poses import array
from roboticstoolbox._ets.ets import ETS
from ulna.control import p_servo
from ulna.spatial.quaternion import matrix_to_quat_xyzw
from ulna.typing import Floats


def ETS_init(transforms: Any, n: int | None = None, m: int | None = None) -> ETS:
    """The handle of a chain of transforms; `n` joints and `m` transforms are counted here."""
    return ETS(list(transforms))


def ET_T(handle: Any, q: Any) -> Floats:
    """The matrix of a transform, (4, 4)."""
    return handle.A(q)


def ETS_fkine(handle: Any, q: Any, base: Any, tool: Any, include_base: bool, _data: Any = None) -> Floats:
    """The pose of the end, (4, 4) or (m, 4, 4)."""
    return _chain(handle, _data).eval(q, base, tool, include_base)


def ETS_jacob0(handle: Any, q: Any, tool: Any, _data: Any = None, _n: Any = None) -> Floats:
    """The Jacobian in the axes of the start, (6, n)."""
    return _chain(handle, _data).jacob0(q, tool)


def ETS_jacobe(handle: Any, q: Any, tool: Any, _data: Any = None, _n: Any = None) -> Floats:
    """The Jacobian in the axes of the end, (6, n)."""
    return _chain(handle, _data).jacobe(q, tool)


def ETS_hessian0(handle: Any, q: Any, J0: Any, tool: Any, _data: Any = None, _n: Any = None) -> Floats:
    """The Hessian in the axes of the start, (n, 6, n)."""
    return _chain(handle, _data).hessian0(q, J0, tool)


def ETS_hessiane(handle: Any, q: Any, Je: Any, tool: Any, _data: Any = None, _n: Any = None) -> Floats:
    """The Hessian in the axes of the end, (n, 6, n)."""
    return _chain(handle, _data).hessiane(q, Je, tool)


def IK_LM_c(
    handle: Any, Tep: Any, q0: Any, ilimit: int, slimit: int, tol: float, joint_limits: bool, mask: Any,
    k: float, method: str,
) -> tuple[Any, ...]:  # fmt: skip
    """Configuration, success, iterations, searches and residual by Levenberg and Marquardt's method."""
    return _five(handle.ik_LM(Tep, q0, ilimit, slimit, tol, mask, joint_limits, k, method))


def IK_NR_c(
    handle: Any, Tep: Any, q0: Any, ilimit: int, slimit: int, tol: float, joint_limits: bool, mask: Any,
    pinv: bool, pinv_damping: float,
) -> tuple[Any, ...]:  # fmt: skip
    """The same by Newton and Raphson's method."""
    return _five(handle.ik_NR(Tep, q0, ilimit, slimit, tol, mask, joint_limits, pinv, pinv_damping))


def IK_GN_c(
    handle: Any, Tep: Any, q0: Any, ilimit: int, slimit: int, tol: float, joint_limits: bool, mask: Any,
    pinv: bool, pinv_damping: float,
) -> tuple[Any, ...]:  # fmt: skip
    """The same by Gauss and Newton's method."""
    return _five(handle.ik_GN(Tep, q0, ilimit, slimit, tol, mask, joint_limits, pinv, pinv_damping))


def Angle_Axis(T: Any, Td: Any) -> Floats:
    """The difference of positions and the rotation vector from one pose to another, (6,)."""
    return p_servo(array(T), array(Td), 1.0, 0.0, "angle-axis")[0]


def r2q(R: Any) -> Floats:
    """The quaternion of a rotation matrix (3, 3), scalar first, (4,)."""
    return np.roll(matrix_to_quat_xyzw(np.asarray(R, dtype=float)[:3, :3]), 1)


def _chain(handle: Any, data: Any) -> Any:
    return ETS(list(data)) if handle is None else handle


def _five(solution: Any) -> tuple[Any, ...]:
    s = solution
    return s.q, int(s.success), s.iterations, s.searches, s.residual
