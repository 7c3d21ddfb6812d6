"""Elementary transforms in space and in the plane: a turn about, or a shift along, one axis."""

from __future__ import annotations

from typing import Any

from roboticstoolbox._common.poses import constant_pose, to_planar, to_spatial
from roboticstoolbox._ets.base_transform import BaseET
from roboticstoolbox._ets.joint_descriptor import current_name
from ulna.formats.ets import ET as Transform
from ulna.spatial import SE3
from ulna.typing import Floats


def _maker(axis: str, with_unit: bool) -> Any:
    def turn(cls: Any, param: Any = None, unit: str = "rad", *, eta: Any = None, **joint: Any) -> Any:
        return cls(axis, current_name(param, eta), unit=unit, **joint)

    def shift(cls: Any, param: Any = None, *, eta: Any = None, **joint: Any) -> Any:
        return cls(axis, current_name(param, eta), **joint)

    make = turn if with_unit else shift
    motion = f"A turn about {axis[1:] or 'z'}" if axis[0] == "R" else f"A shift along {axis[1]}"
    make.__doc__ = (
        f"{motion} by a constant `param`, by a joint of that name, or by a joint (jindex, flip, qlim)."
    )
    make.__name__ = axis
    return classmethod(make)


class ET(BaseET):
    """An elementary transform in space: ET.Rx to ET.Rz, ET.tx to ET.tz, or a constant pose ET.SE3."""

    Rx, Ry, Rz = _maker("Rx", True), _maker("Ry", True), _maker("Rz", True)
    tx, ty, tz = _maker("tx", False), _maker("ty", False), _maker("tz", False)

    @classmethod
    def SE3(cls, T: Any, **joint: Any) -> ET:
        """A constant pose.

        Args:
            T: An SE3, or a matrix (4, 4).
            **joint: Other arguments of `ET`.

        Returns:
            The transform.
        """
        return cls("SE3", T=constant_pose(T, 4), **joint)


class ET2(BaseET):
    """An elementary transform in the plane: ET2.R, ET2.tx, ET2.ty, or a constant pose ET2.SE2."""

    _size = 3

    R, tx, ty = _maker("R", True), _maker("tx", True), _maker("ty", True)

    @classmethod
    def SE2(cls, T: Any, **joint: Any) -> ET2:
        """A constant pose.

        Args:
            T: An SE2, or a matrix (3, 3).
            **joint: Other arguments of `ET2`.

        Returns:
            The transform.
        """
        return cls("SE2", T=constant_pose(T, 3), **joint)

    def A(self, q: Any = 0.0) -> Floats:
        """The matrix (3, 3), for the joint coordinate `q` where it has one."""
        return self._T.copy() if self._T is not None else to_planar(super().A(q))

    def _to_ulna(self, joint: int | None = None) -> Transform:
        if self._T is None:
            return super()._to_ulna(joint)
        return Transform.se3(SE3.from_matrix(to_spatial(self._T)))


__all__ = ["ET", "ET2", "BaseET"]
