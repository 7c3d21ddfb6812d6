"""Smooth poses: cumulative cubic B-splines on SE(3), or on rotations and translations apart.

| symbol | meaning | shape | unit |
|---|---|---|---|
| X | control poses, X_0 ... X_k | SE3 | [m] |
| d_j | log(X_{j-1}^-1 X_j), the step to a control pose | Motion | [m], [rad] |
| B_j | cumulative basis on a span, cubic polynomials of u in [0, 1] | () | |
| T(u) | X_i exp(B_1 d_{i+1}) exp(B_2 d_{i+2}) exp(B_3 d_{i+3}) | SE3 | |
| V, A | twist and its rate in the moving frame | (6,) | [m/s, rad/s], [m/s^2, rad/s^2] |

With A_j = exp(B_j d_j): V_j = Ad(A_j^-1) V_{j-1} + B_j' d_j, and its rate is
Ad(A_j^-1) V_{j-1}' + B_j' V_j x d_j + B_j'' d_j.
Source: Sommer, Usenko, Schubert, Demmel & Cremers, Efficient derivative computation for cumulative B-splines on Lie
groups (2020), eq. (10) and theorems 5.1 and 5.2.
"""

from __future__ import annotations

from typing import Any, Literal, final

import numpy as np

from ulna.checks.arrays import finite_array
from ulna.checks.values import duration as checked_duration
from ulna.checks.values import flag
from ulna.data_classes import dataclass
from ulna.errors import InputError, UnknownName
from ulna.numeric import apply, cross
from ulna.spatial import SE3, Motion
from ulna.trajectory.space import Poses, Space
from ulna.trajectory.trajectory import Trajectory
from ulna.typing import ArrayLike, Floats

_CUMULATIVE = np.array([[5.0, 3.0, -3.0, 1.0], [1.0, 3.0, 3.0, -2.0], [0.0, 0.0, 0.0, 1.0]]) / 6.0
_ENDS = 2  # how often the ends are repeated, so that the spline starts and stops there, at rest
_ROUNDS, _NEAR = 200, 1e-13


@final
@dataclass(frozen=True, eq=False, repr=False)
class PoseSpline(Trajectory):
    """A cumulative cubic B-spline on poses: continuous acceleration.

    Attributes:
        control: Control poses, a batch (k,), ends repeated.
        duration: Time it takes [s].
        kind: "screw" on SE(3), "decoupled" on translations and rotations apart.
    """

    control: SE3
    duration: float
    kind: str
    space: Space = Poses()

    @property
    def knots(self) -> Floats:
        """Times where spans meet."""
        return np.linspace(0.0, self.duration, len(self.control) - 2)

    @property
    def order(self) -> int:
        """2: no jerk."""
        return 2

    def _at(self, t: Floats, order: int) -> tuple[Floats, ...]:
        spans = len(self.control) - 3
        rate = spans / self.duration
        i = np.minimum((t * rate).astype(int), spans - 1)
        u = t * rate - i
        B = [_polynomial(row, u, rate) for row in _CUMULATIVE]
        if self.kind == "screw":
            return _on_group(self.control, i, B, order)
        turning = SE3(self.control.rotation, np.zeros(3))
        rows = [x.copy() for x in _on_group(turning, i, B, order)]
        p = self.control.translation
        steps = [p[i + j] - p[i + j - 1] for j in (1, 2, 3)]
        rows[0][:, :3, 3] = p[i] + sum(b[0] * d for b, d in zip(B, steps, strict=True))
        for k in range(1, order + 1):
            rows[k][:, :3] = sum(b[k] * d for b, d in zip(B, steps, strict=True))
        return tuple(rows)


def pose_spline(
    poses: Any,
    duration: float,
    interpolation: Literal["decoupled", "screw"] = "decoupled",
    through: bool = True,
) -> PoseSpline:
    """A smooth motion, from rest to rest, through poses or drawn by them, that takes as long to each next pose.

    Args:
        poses: Poses T_world_frame: (k, 4, 4), a list of them, or a batch of SE3; neighbours less than half a
            turn apart.
        duration: Time it takes [s].
        interpolation: "decoupled": translations by an ordinary B-spline, rotations on SO(3); "screw": both on
            SE(3).
        through: Whether to run through all the poses, whose neighbours then must be less than about 1.5 rad apart; else
            only the first and the last are met.

    Returns:
        A trajectory of poses.

    Raises:
        InputError: Fewer than two poses, or neighbours too far apart to be run through; `through` is no truth value.
        UnknownName: No such interpolation.
    """
    if interpolation not in ("decoupled", "screw"):
        raise UnknownName("interpolation", interpolation, ("decoupled", "screw"))
    path = poses if isinstance(poses, SE3) else SE3.from_matrix(_stacked(poses))
    if len(path.batch_shape) != 1 or len(path) < 2:
        raise InputError(
            f"`poses` is a batch of shape {path.batch_shape}; expected at least two poses in a row."
        )
    total, through = checked_duration("duration", duration), flag("through", through)
    spline = PoseSpline(_padded(path), total, interpolation)
    if not through or len(path) == 2:
        return spline
    control, times = path, _times_of(len(path), total)
    for _ in range(_ROUNDS):  # each control pose moves by what its way-point lacks
        at = SE3.from_matrix(spline._at(times, 0)[0], check=False)
        lacks = _inner_log(at, path, interpolation)
        if max(float(np.abs(lacks.linear).max()), float(np.abs(lacks.angular).max())) < _NEAR * max(
            1.0, float(np.abs(path.translation).max())
        ):
            break
        control = _moved(control, lacks, interpolation)
        spline = PoseSpline(_padded(control), total, interpolation)
    else:
        steps = np.linalg.norm((path[:-1].inverse() @ path[1:]).log().angular, axis=1)
        k = int(np.argmax(steps))
        raise InputError(
            f"The spline does not settle on `poses`: from pose {k} to pose {k + 1} it turns by {steps[k]:.3g} rad; "
            "expected less than about 1.5. Add a pose between them, or use through=False."
        )
    return spline


def _times_of(count: int, total: float) -> Floats:
    """When the spline is nearest to each control pose: at the knots, the ends at the ends."""
    spans = count + 2 * _ENDS - 3
    inner = np.arange(1, count - 1) + (_ENDS - 1)
    return np.concatenate([[0.0], inner * (total / spans), [total]])


def _stacked(poses: Any) -> ArrayLike:
    if isinstance(poses, (list, tuple)):
        return np.stack(
            [np.asarray(T.matrix()) if isinstance(T, SE3) else finite_array("poses", T) for T in poses]
        )
    return poses


def _padded(control: SE3) -> SE3:
    """The control poses with their ends repeated."""
    index = np.concatenate([[0] * _ENDS, np.arange(len(control)), [len(control) - 1] * _ENDS])
    return control[index]


def _inner_log(at: SE3, goal: SE3, interpolation: str) -> Motion:
    if interpolation == "screw":
        return (at.inverse() @ goal).log()
    return Motion(
        goal.translation - at.translation,
        SE3(at.rotation.swapaxes(-1, -2) @ goal.rotation, np.zeros(3)).log().angular,
    )


def _moved(control: SE3, step: Motion, interpolation: str) -> SE3:
    if interpolation == "screw":
        return control @ SE3.exp(step)
    turn = SE3.exp(Motion(np.zeros(3), step.angular))
    return SE3(control.rotation @ turn.rotation, control.translation + step.linear)


def _polynomial(c: Floats, u: Floats, rate: float) -> tuple[Floats, Floats, Floats]:
    """A cubic and its derivatives with respect to time, (m, 1)."""
    u = u[:, None]
    value = c[0] + u * (c[1] + u * (c[2] + u * c[3]))
    return (
        value,
        rate * (c[1] + u * (2.0 * c[2] + u * (3.0 * c[3]))),
        rate * rate * (2.0 * c[2] + 6.0 * c[3] * u),
    )


def _on_group(control: SE3, i: Any, B: Any, order: int) -> tuple[Floats, ...]:
    """Pose, velocity and acceleration in world axes."""
    steps = (control[:-1].inverse() @ control[1:]).log()
    T = control[i]
    V, A = Motion.zero(i.shape), Motion.zero(i.shape)
    for j, (b, db, ddb) in enumerate(B):
        d = steps[i + j]
        turn = SE3.exp(Motion(b * d.linear, b * d.angular))
        T = T @ turn
        if order:
            step = Motion(db * d.linear, db * d.angular)
            V = turn.act_inverse(V) + step
            A = turn.act_inverse(A) + V.cross(step) + Motion(ddb * d.linear, ddb * d.angular)
    rows: list[Floats] = [np.asarray(T.matrix())]
    if order:
        rows.append(np.concatenate([apply(T.rotation, V.linear), apply(T.rotation, V.angular)], axis=1))
    if order > 1:  # the origin also turns with the moving frame, in which V and A are written
        linear = A.linear + cross(V.angular, V.linear)
        rows.append(np.concatenate([apply(T.rotation, linear), apply(T.rotation, A.angular)], axis=1))
    return tuple(rows)
