"""The ellipsoid joint: the moving frame's origin runs on an ellipsoid, its z axis being the outward direction there.

| symbol | meaning | shape | unit |
|---|---|---|---|
| r | half axes of the ellipsoid | (3) | [m] |
| (a, b, c) | angles: R = Rx(a) Ry(b) Rz(c) | (3) | [rad] |
| n | R e_z = (sin b, -sin a cos b, cos a cos b) | (3) | [1] |
| p | (r_x n_x, r_y n_y, r_z n_z) | (3) | [m] |

Source: Seth, Sherman, Eastman & Delp, Minimal formulation of joint motion for biomechanisms (2010), section 4, for a
shoulder blade on the chest. The angles are singular at b = pi/2.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from ulna.errors import InputError
from ulna.model.joints.base import Coordinate, VectorKind, angle
from ulna.numeric import apply, cross, matrix, sincos, vector
from ulna.spatial import SE3, Motion
from ulna.typing import Array


@dataclass(frozen=True)
class Ellipsoid(VectorKind):
    """Slides on an ellipsoid and turns about its outward direction; q is three angles [rad].

    At q = 0 the moving frame stands on the pole, at (0, 0, r_z), and is not turned.

    Args:
        radii: Half axes along x, y and z of the fixed frame [m].
    """

    radii: tuple[float, float, float] = (0.0, 0.0, 0.0)
    name: ClassVar[str] = "ellipsoid"
    symbol: ClassVar[str] = "L"
    coordinates: ClassVar[tuple[Coordinate, ...]] = (angle("x"), angle("y"), angle("z"))

    def __post_init__(self) -> None:
        x, y, z = (float(r) for r in self.radii)
        object.__setattr__(self, "radii", (x, y, z))
        if not all(math.isfinite(r) and r >= 0.0 for r in self.radii):
            raise InputError(f"Ellipsoid: `radii` are {self.radii}; expected lengths [m] from 0 up.")

    def describe(self) -> str:
        """A few words for tables."""
        return "ellipsoid " + " x ".join(f"{r:g}" for r in self.radii)

    def transform(self, q: Array) -> SE3:
        """T_fixed_moving: R and p of the table."""
        (sa, ca), (sb, cb), _ = angles = self._angles(q)
        x, y, z = self.radii
        return SE3(_rotation(angles), vector(x * sb, -y * sa * cb, z * ca * cb))

    def motion_subspace(self, q: Array) -> tuple[Motion, ...]:
        """The derivatives of p and the axes of the angles, as the moving frame sees them."""
        angles = self._angles(q)
        by_a, by_b = (_back(angles, slope) for slope in self._slopes(angles))
        first, second, third = _axes(angles)
        return Motion(by_a, first), Motion(by_b, second), Motion(vector(0.0, 0.0, 0.0), third)

    def bias(self, q: Array, v: Array) -> Motion:
        """(dS/dt) v: R^T p'' - w x R^T p', and the rate of w, both at constant v."""
        angles = (sa, ca), (sb, cb), (sc, cc) = self._angles(q)
        x, y, z = self.radii
        a, b, c = (v[..., i] for i in range(3))
        bend = vector(
            -x * sb * b * b,
            y * (sa * cb * (a * a + b * b) + 2.0 * ca * sb * a * b),
            z * (2.0 * sa * sb * a * b - ca * cb * (a * a + b * b)),
        )
        by_a, by_b = self._slopes(angles)
        speed = vector(*(by_a[..., i] * a + by_b[..., i] * b for i in range(3)))
        axes = _axes(angles)
        turn = vector(
            *(sum(axis[..., i] * rate for axis, rate in zip(axes, (a, b, c), strict=True)) for i in range(3))
        )
        swing = vector(
            (cc * b - sc * cb * a) * c - cc * sb * a * b,
            sc * sb * a * b - (cc * cb * a + sc * b) * c,
            cb * a * b,
        )
        return Motion(_back(angles, bend) - cross(turn, _back(angles, speed)), swing)

    def _angles(self, q: Array) -> tuple[tuple[Any, Any], ...]:
        return tuple(sincos(q[..., i]) for i in range(3))

    def _slopes(self, angles: tuple[tuple[Any, Any], ...]) -> tuple[Array, Array]:
        """The derivatives of p by a and by b; c leaves p where it is."""
        (sa, ca), (sb, cb), _ = angles
        x, y, z = self.radii
        return vector(0.0, -y * ca * cb, -z * sa * cb), vector(x * cb, y * sa * sb, -z * ca * sb)


def _rotation(angles: tuple[tuple[Any, Any], ...]) -> Array:
    (sa, ca), (sb, cb), (sc, cc) = angles
    return matrix(
        [
            [cb * cc, -cb * sc, sb],
            [ca * sc + sa * sb * cc, ca * cc - sa * sb * sc, -sa * cb],
            [sa * sc - ca * sb * cc, sa * cc + ca * sb * sc, ca * cb],
        ]
    )


def _back(angles: tuple[tuple[Any, Any], ...], x: Array) -> Array:
    """A vector of the fixed frame as the moving frame sees it: R^T x."""
    return apply(_rotation(angles).swapaxes(-1, -2), x)


def _axes(angles: tuple[tuple[Any, Any], ...]) -> tuple[Array, Array, Array]:
    """The axes of the three angles in the moving frame; w is their sum times the rates."""
    _, (sb, cb), (sc, cc) = angles
    return vector(cc * cb, -sc * cb, sb), vector(sc, cc, 0.0), vector(0.0, 0.0, 1.0)
