"""Constraints that frames keep along a path, and the step that moves a configuration back to them.

| symbol | meaning | shape | unit |
|---|---|---|---|
| T_c | T_world_middle of the region | SE3 | [m] |
| e | how far the frame's origin is outside of the box, along its axes | (3,) | [m] |
| phi | rotation vector that brings the frame's axis (or all axes) back | (2,) or (3,) | [rad] |
| J | rows of the frame's Jacobian, in the axes of the region | (m, n) | |
| W | diagonal of the joint weights: 0 for joints that do not move | (n, n) | [-] |
| d | damping | () | |
| v | violation: the greater of the length of e and the angle, each by its tolerance; at most 1 is allowed | () | [-] |

phi is in the axes of the region. A step is dq = W (J W)^T (J W W J^T + d I)^-1 (-e, phi), the damped Gauss-Newton step
towards e = 0, phi = 0. Source: Berenson, Srinivasa and Kuffner, Task space regions, IJRR 30 (2011), sections 4 and 5;
Siciliano et al., section 3.5.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any, Literal, final

import numpy as np

from ulna.algorithms import frame_jacobian, frame_pose
from ulna.algorithms.multibody.tree import chain
from ulna.checks.values import number
from ulna.collision.lanes.motion_bounds import Group, motion_bounds
from ulna.compiler import compile, trace
from ulna.compiler.procedures import lanes_kernel
from ulna.data_classes import dataclass
from ulna.errors import InputError, UnknownName
from ulna.linalg import solve_damped
from ulna.model import Frame, Model
from ulna.numeric import apply, arctan2, clip, cross, less, maximum, sqrt, where
from ulna.planning.goals import Region, Turns
from ulna.spatial import SE3, so3_log
from ulna.typing import Array, ArrayLike, Floats

TOLERANCE_RESERVE = 0.2
"""What paths leave of the tolerances for motions that cut their corners [-]."""

_DAMPING = 1e-6
_UNBOUNDED = 1e6  # half the edge of a box that bounds nothing [m]
_SMALL_SINE = 1e-12
"""Where an axis is so near to the opposite one, or to its place, its cross product has no direction."""
_AXES = ("x", "y", "z")


@final
@dataclass(frozen=True, eq=False)
class PathConstraint:
    """What a frame keeps on the whole path: a region for its origin, and how it may turn.

    `PathConstraint("hand", Region(T, size=(np.inf,) * 3, turns="z"))` keeps the z axis of the frame along that of T
    and leaves its position free: an upright cup, for which `PathConstraint.pointing("hand")` is shorter.

    Args:
        frame: The frame's name.
        region: Where its origin may be, edges of inf bound nothing, and about which of its axes it may turn.
        position_tolerance: How far the origin may be outside of the box [m].
        rotation_tolerance: By which angle the frame may be turned otherwise [rad].

    Raises:
        InputError: If tolerances make no sense, or nothing is constrained.
    """

    frame: str
    region: Region
    position_tolerance: float = 0.005
    rotation_tolerance: float = 0.02

    def __post_init__(self) -> None:
        if not isinstance(self.region, Region):
            raise InputError(f"`region` is {self.region!r}; expected a Region.")
        number("position_tolerance", self.position_tolerance, "a length of at least 0.0001 [m]", least=1e-4)
        number("rotation_tolerance", self.rotation_tolerance, "an angle of at least 0.001 [rad]", least=1e-3)
        if self.region.turns == "any" and np.isinf(self.region.size).all():
            raise InputError(f"The constraint of {self.frame!r} leaves position and rotation free.")

    @classmethod
    def pointing(
        cls,
        frame: str,
        direction: ArrayLike = (0.0, 0.0, -1.0),
        axis: Literal["x", "y", "z"] = "z",
        rotation_tolerance: float = 0.02,
    ) -> PathConstraint:
        """An axis of a frame keeps pointing in one direction; the position is free, and so are turns about the axis.

        Args:
            frame: The frame's name.
            direction: Where the axis points in the world, shape (3,), of any length; down by default.
            axis: Which axis of the frame.
            rotation_tolerance: The largest angle between axis and direction [rad].

        Returns:
            The constraint.

        Raises:
            UnknownName: If `axis` is none of these.
            InputError: If the direction has no length, or the tolerance makes no sense.

        Example:
            >>> constraint = ulna.planning.PathConstraint.pointing("panda_hand")
            >>> constraint.region.pose.rotation[:, 2]
            array([ 0.,  0., -1.])
        """
        if axis not in _AXES:
            raise UnknownName("axis", axis, _AXES)
        along_z = SE3.pointing((0.0, 0.0, 0.0), direction).rotation
        rotation = np.roll(along_z, _AXES.index(axis) - 2, axis=1)  # a cyclic exchange keeps it right-handed
        region = Region(SE3(rotation, np.zeros(3)), size=(np.inf,) * 3, turns=axis)
        return cls(frame, region, rotation_tolerance=rotation_tolerance)

    @property
    def parameters(self) -> Floats:
        """What the step depends on: rotation, translation, half edges, tolerances; shape (17,)."""
        T = self.region.pose.matrix()
        half = np.minimum(0.5 * self.region.size, _UNBOUNDED)
        return np.concatenate(
            [T[:3, :3].ravel(), T[:3, 3], half, [self.position_tolerance, self.rotation_tolerance]]
        )


@final
@dataclass(frozen=True, eq=False)
class Constraints:
    """Constraints of one robot.

    Args:
        model: The robot.
        items: The constraints.

    Raises:
        UnknownName: If a frame is unknown.
        InputError: If a frame does not move.
    """

    model: Model
    items: tuple[PathConstraint, ...]

    def __post_init__(self) -> None:
        for item in self.items:
            if self.model.frame(item.frame).joint < 0:
                raise InputError(f"Frame {item.frame!r} does not move; expected a frame that a joint moves.")

    @property
    def _kinds(self) -> tuple[tuple[Frame, Turns, bool], ...]:
        return tuple(
            (self.model.frame(item.frame), item.region.turns, bool(np.isfinite(item.region.size).any()))
            for item in self.items
        )

    @property
    def parameters(self) -> Floats:
        """What the step depends on beside the configuration, shape (17 for each constraint,)."""
        return np.concatenate([item.parameters for item in self.items])

    @property
    def step_kernel(self) -> Any:
        """From a configuration, weights of joints and `parameters` to a step and the violation, one sample, float32."""
        return _step_kernel(self.model, self._kinds)

    def violations(self, q: Floats) -> Floats:
        """How much configurations violate the constraints, in tolerances.

        Args:
            q: Shape (..., nq) [rad, m].

        Returns:
            Shape (...,); at most 1 is allowed [-].
        """
        return _violation_kernel(self.model, self._kinds)(q, self.parameters)

    def lipschitz_bounds(self, change: Floats) -> Floats:
        """How fast the violation grows at most while the configuration changes.

        Args:
            change: By how much each coordinate changes, shape (n, nq) [rad, m].

        Returns:
            Shape (n,), for the whole change [-].
        """
        return (np.abs(change) @ self.lipschitz_rows.T).max(axis=1)

    @property
    def lipschitz_rows(self) -> Floats:
        """How fast each part of the violation grows at most when a coordinate changes, (m, nq) [1/rad, 1/m]."""
        rows = []
        for item in self.items:
            moving, turning = _frame_bounds(self.model, self.model.frame(item.frame))
            if np.isfinite(item.region.size).any():
                rows.append(moving / item.position_tolerance)
            if item.region.turns != "any":
                rows.append(turning / item.rotation_tolerance)
        return np.array(rows)

    def unproved_edges(self, points: Floats) -> list[int]:
        """The edges of a path of straight motions of which it is not proved that they keep the constraints.

        Intervals are halved until the violation in the middle, and how much it grows to the ends, leave
        `TOLERANCE_RESERVE`.

        Args:
            points: The path, shape (n, nq) [rad, m].

        Returns:
            Their indices.
        """
        bounds = self.lipschitz_bounds(np.diff(points, axis=0))
        edge, start, width = np.arange(len(bounds)), np.zeros(len(bounds)), np.ones(len(bounds))
        failed: set[int] = set()
        while len(edge):
            middle = (start + width / 2.0)[:, None]
            violation = self.violations(points[edge] * (1.0 - middle) + points[edge + 1] * middle)
            half = bounds[edge] * width / 2.0
            is_open = ~(violation + half <= 1.0 - TOLERANCE_RESERVE)
            ends = (violation > 0.98 - TOLERANCE_RESERVE) | (half < 0.01) | ~np.isfinite(half)
            failed |= set(edge[is_open & ends].tolist())
            again = is_open & ~np.isin(edge, list(failed))
            edge, width = np.repeat(edge[again], 2), np.repeat(width[again] / 2.0, 2)
            start = np.repeat(start[again], 2)
            start[1::2] += width[1::2]
        return sorted(failed)


def _rows(
    model: Model, kinds: Sequence[tuple[Frame, Turns, bool]], q: Array, parameters: Array
) -> tuple[list[Array], list[Any], Any]:
    """Rows of Jacobians, what they have to change, and the violation."""
    rows: list[Array] = []
    changes: list[Any] = []
    violation: Any = 0.0
    for k, (frame, turns, is_bounded) in enumerate(kinds):
        values = parameters[..., 17 * k : 17 * (k + 1)]
        R_c = np.stack([values[..., 3 * i : 3 * i + 3] for i in range(3)], axis=-2)
        T, J = frame_pose(model, q, frame), frame_jacobian(model, q, frame)
        to_region = np.swapaxes(R_c, -1, -2)
        if is_bounded:
            p = apply(to_region, T.translation - values[..., 9:12])
            half = values[..., 12:15]
            outside = [p[..., i] - clip(p[..., i], -half[..., i], half[..., i]) for i in range(3)]
            linear = to_region @ J[..., :3, :]
            for i, e in enumerate(outside):
                is_active = where(e * e > 0.0, 1.0, 0.0)
                rows.append(linear[..., i, :] * np.asarray(is_active)[..., None])
                changes.append(-e)
            distance = sqrt(sum(e * e for e in outside))
            violation = maximum(violation, distance / values[..., 15])
        if turns != "any":
            phi, angle = _rotation_error(to_region @ T.rotation, turns)
            angular = to_region @ J[..., 3:, :]
            kept = [i for i in range(3) if turns == "none" or i != _AXES.index(turns)]
            rows += [angular[..., i, :] for i in kept]
            changes += [phi[..., i] for i in kept]
            violation = maximum(violation, angle / values[..., 16])
    return rows, changes, violation


def _rotation_error(R: Array, turns: Turns) -> tuple[Array, Any]:
    """The rotation vector that brings a frame back, in the axes of the region, and its angle.

    At 180 degrees the axis of the rotation that brings one axis back is not unique: it is another axis of the region.
    """
    if turns == "none":
        phi = -so3_log(R)
        return phi, sqrt(sum(phi[..., i] * phi[..., i] for i in range(3)))
    k = _AXES.index(turns)
    sine_axis, cosine = cross(R[..., :, k], np.eye(3)[k]), R[..., k, k]
    sine = sqrt(sum(sine_axis[..., i] * sine_axis[..., i] for i in range(3)))
    angle = arctan2(sine, cosine)
    is_small = less(sine, _SMALL_SINE)
    factor = where(is_small, 1.0, angle / where(is_small, 1.0, sine))
    half_turn = where(is_small, where(less(cosine, 0.0), np.pi, 0.0), 0.0)
    return np.asarray(factor)[..., None] * sine_axis + np.asarray(half_turn)[..., None] * np.eye(3)[
        k - 1
    ], angle


@lru_cache(maxsize=32)
def _step_kernel(model: Model, kinds: tuple[tuple[Frame, Turns, bool], ...]) -> Any:
    def step(q: Array, weights: Array, parameters: Array) -> Array:
        rows, changes, violation = _rows(model, kinds, q, parameters)
        J = np.stack([row * weights for row in rows])
        dq = weights * solve_damped(J, np.stack(changes), _DAMPING)
        return np.append(dq, violation)

    return lanes_kernel(
        trace(
            step, name="constraint_step", q=(model.nq,), weights=(model.nq,), parameters=(17 * len(kinds),)
        ),
        1,
    )


@lru_cache(maxsize=32)
def _violation_kernel(model: Model, kinds: tuple[tuple[Frame, Turns, bool], ...]) -> Any:
    def violation(q: Array, parameters: Array) -> Any:
        return _rows(model, kinds, q, parameters)[2]

    return compile(violation, q=(model.nq,), parameters=(17 * len(kinds),))


@lru_cache(maxsize=64)
def _frame_bounds(model: Model, frame: Frame) -> tuple[Floats, Floats]:
    """How far a frame's origin moves at most, and how far it turns, when a coordinate changes by one, (nq,) each."""
    group = Group(frame.name, frame.joint, np.asarray(frame.placement.translation)[None], np.zeros(1))
    turning = np.zeros(model.nq)
    for step in chain(model, frame):
        for c, motion in enumerate(step.subspace()):
            turning[step.joint.idx_q + step.start_q + c] += abs(step.multiplier) * float(
                np.linalg.norm(motion.angular)
            )
    return motion_bounds(model, [group], [])[0][0], turning
