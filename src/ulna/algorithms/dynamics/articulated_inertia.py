"""The articulated-body inertia: force by acceleration of a body, the joints beyond it free of torque.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| M, H, I | blocks of the symmetric matrix | (3, 3) | [kg], [kg m], [kg m^2] | f = M b + H e, n = H^T b + I e |
| s | a column of a joint's motion subspace, in its moving frame | Motion | | |
| u, D | u = I^A s, D = s.u + armature | Force, () | | |
| I^a | inertia across the joint, which is free of torque | Articulated | | I^A - u u^T / D |
| R, p | pose of the frame in the outer one | SE3 | | M' = R M R^T, H' = R H R^T - M' [p] |
| | | | | I' = R I R^T + [p] H' - (R H R^T)^T [p] |

Source: Featherstone 2008, section 7.2, equations 7.23 to 7.25 and section 2.9 for the change of frame.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ulna.algorithms.multibody.mass_moments import MassMoments, rotate_symmetric
from ulna.data_classes import dataclass
from ulna.numeric import apply, is_symbolic, matrix, skew
from ulna.spatial import SE3, Force, Motion
from ulna.spatial.batched import column
from ulna.typing import Array


@dataclass(frozen=True, slots=True)
class Articulated:
    """M, H and I about the origin of a frame; those in one frame are added."""

    M: Array
    H: Array
    I: Array

    @classmethod
    def of(cls, body: MassMoments) -> Articulated:
        """That of a rigid body."""
        return cls(column(body.mass, 2) * np.eye(3), -skew(body.first), body.second)

    def __add__(self, other: Articulated) -> Articulated:
        return Articulated(self.M + other.M, self.H + other.H, self.I + other.I)

    def apply(self, motion: Motion) -> Force:
        """The force that produces the acceleration `motion`, all joints beyond free of torque."""
        b, e = motion.linear, motion.angular
        across = np.swapaxes(self.H, -1, -2)
        return Force(apply(self.M, b) + apply(self.H, e), apply(across, b) + apply(self.I, e))

    def less(self, u: Force, reciprocal: Any, s: Motion, free: bool) -> Articulated:
        """The inertia I^a across a joint that is free of torque.

        Args:
            u: I^A s.
            reciprocal: 1 / D.
            s: The column.
            free: Whether there is no armature; I^a s is then zero, and is made so exactly along a coordinate axis.

        Returns:
            I^A - u u^T / D.
        """
        f, n = u.linear, u.angular
        F, N = column(reciprocal) * f, column(reciprocal) * n
        M = _symmetric(lambda i, j: self.M[..., i, j] - F[..., i] * f[..., j])
        H = self.H - F[..., :, None] * n[..., None, :]
        I = _symmetric(lambda i, j: self.I[..., i, j] - N[..., i] * n[..., j])
        along = np.flatnonzero(np.concatenate([s.linear, s.angular]))
        if free and len(along) == 1:
            k = int(along[0])
            if k < 3:
                M[..., k, :] = M[..., :, k] = H[..., k, :] = 0.0
            else:
                I[..., k - 3, :] = I[..., :, k - 3] = H[..., :, k - 3] = 0.0
        return Articulated(M, H, I)

    def to_outer_frame(self, T: SE3, axis: int | None = None) -> Articulated:
        """The same inertia in another frame.

        Args:
            T: The pose of the present frame in the outer one [m].
            axis: The coordinate axis, 0, 1 or 2, about which T turns, which saves operations; None for any rotation.

        Returns:
            The inertia about the origin of the outer frame, in its axes.
        """
        R, cross = T.rotation, skew(T.translation)
        M, H, I = (
            rotate_symmetric(R, self.M, axis),
            _rotate(R, self.H, axis),
            rotate_symmetric(R, self.I, axis),
        )
        shifted = H - M @ cross
        more, less = cross @ shifted, np.swapaxes(H, -1, -2) @ cross
        return Articulated(
            M, shifted, _symmetric(lambda i, j: I[..., i, j] + more[..., i, j] - less[..., i, j])
        )


def _rotate(R: Array, H: Array, axis: int | None) -> Array:
    """R H R^T; about a coordinate axis the antisymmetric part across it stays, and the symmetric part turns twice."""
    if axis is None:
        return R @ H @ np.swapaxes(R, -1, -2)
    a, b, k = (axis + 1) % 3, (axis + 2) % 3, axis
    cos, sin = R[..., a, a], R[..., b, a]
    total, half = H[..., a, b] + H[..., b, a], 0.5 * (H[..., a, b] - H[..., b, a])
    x = sin * (H[..., a, a] - H[..., b, b]) + cos * total
    y, z = sin * x, cos * x - 0.5 * total
    out: list[list[Any]] = [[None] * 3 for _ in range(3)]
    out[a][a], out[b][b], out[k][k] = H[..., a, a] - y, H[..., b, b] + y, H[..., k, k]
    out[a][b], out[b][a] = z + half, z - half
    out[a][k], out[b][k] = cos * H[..., a, k] - sin * H[..., b, k], sin * H[..., a, k] + cos * H[..., b, k]
    out[k][a], out[k][b] = cos * H[..., k, a] - sin * H[..., k, b], sin * H[..., k, a] + cos * H[..., k, b]
    return matrix(out)


def _symmetric(entry: Callable[[int, int], Any]) -> Array:
    e = {(i, j): entry(i, j) for i in range(3) for j in range(i, 3)}
    out = matrix([[e[min(i, j), max(i, j)] for j in range(3)] for i in range(3)])
    return out if is_symbolic(out) else np.array(out)
