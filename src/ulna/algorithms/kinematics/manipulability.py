"""How well a frame can move from a configuration, and how that changes with the configuration.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| J | the chosen rows of the Jacobian in local_world_aligned | (m, nv) | | see jacobian.py |
| m | Yoshikawa's measure | () | | m = sqrt(det(J J^T)), Siciliano section 3.9 |
| L, Q | J = L Q, rows of Q orthogonal | (m, m), (m, nv) | | Gram-Schmidt; m is the product of their lengths |
| P | transpose of the pseudoinverse | (m, nv) | | P = (J J^T)^-1 J = L^-T D^-1 Q, D = diag(Q Q^T) |
| g | gradient of m | (nv) | | g_k = m tr(P^T dJ/dq_k) = m (w_k . sum_(j >= k) n_j + l_k . sum_(j < k) f_j) |
| n_j, f_j | with a, b the linear and angular part of column j of P | (3) | | n = l x a + w x b, f = a x w |
| s | singular values of J | (m) | | inverse condition: s_min / s_max; minimum singular value: s_min |

The gradient contracts the Hessian of hessian.py without forming it, by w_k x l_j . a_j = w_k . (l_j x a_j),
so that it costs nv, not nv^2. The measure mixes metres and radians where both kinds of rows are chosen.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal, TypeAlias

import numpy as np

from ulna import linalg
from ulna.algorithms.kinematics.jacobian import aligned_columns, by_step, frame_jacobian
from ulna.algorithms.multibody.batch_shapes import batch_zeros
from ulna.algorithms.multibody.tree import chain
from ulna.errors import InputError, TraceError, UnknownName
from ulna.model import Frame, Model
from ulna.numeric import cross, dot, is_symbolic
from ulna.spatial.batched import column
from ulna.typing import Array, Floats

Axes: TypeAlias = Literal["all", "trans", "rot"] | Sequence[bool]
Measure: TypeAlias = Literal["yoshikawa", "inverse_condition", "minimum_singular_value"]

_ROWS = {"all": [0, 1, 2, 3, 4, 5], "trans": [0, 1, 2], "rot": [3, 4, 5]}
_MEASURES = ("yoshikawa", "inverse_condition", "minimum_singular_value")


def manipulability(
    model: Model, q: Array, frame: Frame, measure: Measure = "yoshikawa", axes: Axes = "all"
) -> Any:
    """How well a frame can move.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        frame: A frame of the model.
        measure: "yoshikawa", the volume of the ellipsoid of velocities; "inverse_condition", from 0 (singular) to 1
            (equally well in every direction); "minimum_singular_value", the velocity in the worst direction.
        axes: Rows of the Jacobian in local_world_aligned: "all", "trans", "rot", or six truth values for x, y, z, and
            rotation about x, y, z.

    Returns:
        The measure, shape (...); 0 where the frame is singular, or where `axes` are more than joints.

    Raises:
        TraceError: a measure other than Yoshikawa's is asked of traced or symbolic numbers; it needs singular values,
            which have no formula. Compute it from the compiled Jacobian.
        UnknownName, InputError: no such measure, no such axes.
    """
    return measure_of(frame_jacobian(model, q, frame), measure, axes)


def measure_of(J: Array, measure: Measure = "yoshikawa", axes: Axes = "all") -> Any:
    """The measure of manipulability of a Jacobian; see `manipulability`.

    Args:
        J: Jacobian in local_world_aligned, shape (..., 6, nv).
        measure: "yoshikawa", "inverse_condition" or "minimum_singular_value".
        axes: As for `manipulability`.

    Returns:
        The measure, shape (...).

    Raises:
        TraceError: the measure needs singular values of traced or symbolic numbers.
        UnknownName: no such measure or axes.
    """
    if measure not in _MEASURES:
        raise UnknownName("measure of manipulability", measure, _MEASURES)
    J = J[..., chosen_rows(axes), :]
    if not J.shape[-1]:  # a robot without joints
        return np.zeros(J.shape[:-2])[()]
    if measure == "yoshikawa":
        return linalg.volume(J)
    if is_symbolic(J):
        raise TraceError(
            f"The measure {measure!r} needs singular values, which cannot be traced. "
            "Compile the Jacobian and use np.linalg.svd on it, or take the measure 'yoshikawa'."
        )
    s = np.linalg.svd(J, compute_uv=False)
    smallest = s[..., -1] if J.shape[-2] <= J.shape[-1] else np.zeros(s.shape[:-1])
    if measure == "minimum_singular_value":
        return smallest
    largest = s[..., 0]
    return np.divide(smallest, largest, out=np.zeros_like(largest), where=largest > 0.0)


def asada(J: Floats, M: Floats, axes: Axes = "all") -> Any:
    """Asada's measure: how evenly a frame accelerates in all directions.

    The ratio of the smallest to the largest eigenvalue of the operational-space inertia, `pinv(J)^T M pinv(J)`, in
    the rows and columns of `axes`. Asada, A geometrical representation of manipulator dynamics (1983).

    Args:
        J: Jacobian in local_world_aligned, shape (..., 6, nv).
        M: Mass matrix, shape (..., nv, nv) [kg, kg m, kg m^2].
        axes: As for `manipulability`.

    Returns:
        The measure from 0 to 1, shape (...) [-].
    """
    rows = chosen_rows(axes)
    inverse = np.linalg.pinv(J)
    inertia = np.swapaxes(inverse, -1, -2) @ M @ inverse
    e = np.linalg.eigvalsh(inertia[..., rows, :][..., :, rows])
    return np.divide(e[..., 0], e[..., -1], out=np.zeros_like(e[..., 0]), where=e[..., -1] > 0.0).clip(
        0.0, 1.0
    )


def manipulability_gradient(model: Model, q: Array, frame: Frame, axes: Axes = "all") -> Array:
    """The derivative of Yoshikawa's measure with respect to q.

    At a singular configuration the measure has a kink and no derivative; there the result is as good as zero.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        frame: A frame of the model.
        axes: As for `manipulability`.

    Returns:
        Shape (..., nv).
    """
    rows = chosen_rows(axes)
    if not model.nv:
        return batch_zeros((0,), q)
    columns = aligned_columns(chain(model, frame), q, frame.placement)
    J = frame_jacobian(model, q, frame)[..., rows, :]
    P, m = _pseudoinverse_transposed(J)
    full = batch_zeros((6, model.nv), q)
    full[..., rows, :] = P

    gradient = batch_zeros((model.nv,), q)
    groups = by_step(columns)
    before: Any = np.zeros(3)  # the sum of f_j over the steps before k
    for group in groups:
        for c in group:
            gradient[..., c.index] += dot(c.motion.linear, before)
        for c in group:
            a = full[..., :3, c.index]
            before = before + cross(a, c.motion.angular)
    after: Any = np.zeros(3)  # the sum of n_j over the step k and those beyond
    for group in reversed(groups):
        for c in group:
            a, b = full[..., :3, c.index], full[..., 3:, c.index]
            after = after + cross(c.motion.linear, a) + cross(c.motion.angular, b)
        for c in group:
            gradient[..., c.index] += dot(c.motion.angular, after)
    return gradient * column(m)


def chosen_rows(axes: Axes) -> list[int]:
    """The rows of a Jacobian that `axes` names."""
    if isinstance(axes, str):
        if axes not in _ROWS:
            raise UnknownName("set of axes", axes, _ROWS, "A list of six truth values will do, too.")
        return _ROWS[axes]
    mask = list(axes) if isinstance(axes, (Sequence, np.ndarray)) and np.ndim(axes) == 1 else []
    if len(mask) != 6 or not any(mask):
        raise InputError(
            f"`axes` is {axes!r}; expected 'all', 'trans', 'rot', or six truth values, of which one is true."
        )
    return [i for i, keep in enumerate(mask) if keep]


def _pseudoinverse_transposed(J: Array) -> tuple[Array, Any]:
    """P = (J J^T)^-1 J, with zeros for rows that depend on others, and the measure m."""
    L, Q, squares, reciprocals = linalg.orthogonalise(J, noise=1e-14)
    count = J.shape[-2]
    rows = [Q[..., i, :] * column(reciprocals[..., i]) for i in range(count)]
    for i in reversed(range(count)):
        for k in range(i + 1, count):
            rows[i] = rows[i] - column(L[..., k, i]) * rows[k]
    return np.stack(rows, axis=-2), linalg.volume_of(squares)
