"""The Toolbox's compiled functions on chains, by their names: a chain is its own handle here."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from roboticstoolbox._common.documentation import describe_arguments
from roboticstoolbox._common.poses import array
from roboticstoolbox._ets.ets import ETS
from ulna.control import p_servo
from ulna.spatial.quaternion import matrix_to_quat_xyzw
from ulna.typing import Floats


@describe_arguments
def ETS_init(transforms: Any, n: int | None = None, m: int | None = None) -> ETS:
    """The handle of a chain of transforms.

    Args:
        transforms: The transforms.
        n: Accepted and ignored: joints are counted here.
        m: Accepted and ignored: transforms are counted here.

    Returns:
        The handle.
    """
    return ETS(list(transforms))


@describe_arguments
def ET_T(handle: Any, q: Any) -> Floats:
    """The matrix of a transform.

    Args:
        handle: The transform.
        q: Joint coordinate [rad or m].

    Returns:
        Matrix (4, 4).
    """
    return handle.A(q)


@describe_arguments
def ETS_fkine(handle: Any, q: Any, base: Any, tool: Any, include_base: bool, _data: Any = None) -> Floats:
    """The pose of the end.

    Args:
        base: Pose of the start in the world, (4, 4); None for the identity.
        tool: Pose of a tool beyond the end, (4, 4); None for none.

    Returns:
        Pose (4, 4) or (m, 4, 4).
    """
    return _chain(handle, _data).eval(q, base, tool, include_base)


@describe_arguments
def ETS_jacob0(handle: Any, q: Any, tool: Any, _data: Any = None, _n: Any = None) -> Floats:
    """The Jacobian in the axes of the start.

    Args:
        tool: Pose of a tool beyond the end, (4, 4); None for none.

    Returns:
        Jacobian (6, n).
    """
    return _chain(handle, _data).jacob0(q, tool)


@describe_arguments
def ETS_jacobe(handle: Any, q: Any, tool: Any, _data: Any = None, _n: Any = None) -> Floats:
    """The Jacobian in the axes of the end.

    Args:
        tool: Pose of a tool beyond the end, (4, 4); None for none.

    Returns:
        Jacobian (6, n).
    """
    return _chain(handle, _data).jacobe(q, tool)


@describe_arguments
def ETS_hessian0(handle: Any, q: Any, J0: Any, tool: Any, _data: Any = None, _n: Any = None) -> Floats:
    """The Hessian in the axes of the start.

    Args:
        J0: Jacobian in the axes of the start, (6, n), in place of `q`.
        tool: Pose of a tool beyond the end, (4, 4); None for none.

    Returns:
        Hessian (n, 6, n).
    """
    return _chain(handle, _data).hessian0(q, J0, tool)


@describe_arguments
def ETS_hessiane(handle: Any, q: Any, Je: Any, tool: Any, _data: Any = None, _n: Any = None) -> Floats:
    """The Hessian in the axes of the end.

    Args:
        Je: Jacobian in the axes of the end, (6, n), in place of `q`.
        tool: Pose of a tool beyond the end, (4, 4); None for none.

    Returns:
        Hessian (n, 6, n).
    """
    return _chain(handle, _data).hessiane(q, Je, tool)


@describe_arguments
def IK_LM_c(
    handle: Any, Tep: Any, q0: Any, ilimit: int, slimit: int, tol: float, joint_limits: bool, mask: Any,
    k: float, method: str,
) -> tuple[Any, ...]:  # fmt: skip
    """Inverse kinematics by Levenberg and Marquardt's method.

    Args:
        Tep: Pose of the end, (4, 4).
        q0: Where the search begins, (n,) [rad or m].
        method: "chan", "wampler" or "sugihara".

    Returns:
        Configuration (n,), success, iterations, searches and residual.
    """
    return _five(handle.ik_LM(Tep, q0, ilimit, slimit, tol, mask, joint_limits, k, method))


def _ik_by_inversion(kind: str, method: str) -> Callable[..., tuple[Any, ...]]:
    """The function of a method that inverts the Jacobian."""

    def ik(
        handle: Any, Tep: Any, q0: Any, ilimit: int, slimit: int, tol: float, joint_limits: bool, mask: Any,
        pinv: bool, pinv_damping: float,
    ) -> tuple[Any, ...]:  # fmt: skip
        search = (ilimit, slimit, tol, mask, joint_limits, pinv, pinv_damping)
        return _five(getattr(handle, f"ik_{kind}")(Tep, q0, *search))

    ik.__name__ = ik.__qualname__ = f"IK_{kind}_c"
    ik.__doc__ = (IK_LM_c.__doc__ or "").replace("Levenberg and Marquardt's", method)
    return describe_arguments(ik)


IK_NR_c = _ik_by_inversion("NR", "Newton and Raphson's")
IK_GN_c = _ik_by_inversion("GN", "Gauss and Newton's")


def Angle_Axis(T: Any, Td: Any) -> Floats:
    """The difference of positions and the rotation vector from one pose to another, (6,).

    Args:
        T: Pose, (4, 4).
        Td: Pose to reach, (4, 4).

    Returns:
        Vector (6,) [m and rad].
    """
    return p_servo(array(T), array(Td), 1.0, 0.0, "angle-axis")[0]


def r2q(R: Any) -> Floats:
    """The quaternion of a rotation matrix (3, 3), scalar first, (4,)."""
    return np.roll(matrix_to_quat_xyzw(np.asarray(R, dtype=float)[:3, :3]), 1)


def _chain(handle: Any, data: Any) -> Any:
    return ETS(list(data)) if handle is None else handle


def _five(solution: Any) -> tuple[Any, ...]:
    s = solution
    return s.q, int(s.success), s.iterations, s.searches, s.residual
