"""Goals of a frame: which parts of its pose count, and how far the frame is from there.

| symbol | meaning | shape, unit | equation |
|---|---|---|---|
| p, R | position and rotation of the frame, world axes | (3,), (3, 3) | forward kinematics |
| p*, R* | those of the goal | | |
| e_p | position error | (3,) [m] | p* - p |
| s, c | sine times axis, and cosine, of the angle theta to R* | | s = 1/2 sum r_i x r*_i, c = (tr(R^T R*) - 1)/2 |
| e_r | rotation error: the axis times the chord 2 sin(theta/2) | (3,) [rad] | s / cos(theta/2) |
| e_a | error of one axis of the tool, in tool axes: likewise with s = a x a*, c = a . a* | (3,) [rad] | |
| e_w | rotation vector, of which weights may leave parts free | (3,) [rad] | e_r theta / chord |

Sources: Luh, Walker & Paul 1980 (s as an orientation error); Siciliano et al. 2009, section 3.7.3. The chord grows up
to half a turn, where s alone has no slope left, and equals the angle to third order at the goal.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple, final

import numpy as np

from ulna import algorithms, numeric
from ulna.data_classes import dataclass
from ulna.errors import InputError, UnknownName
from ulna.model import Frame, Model
from ulna.typing import Array

_AXES = {"x": 0, "y": 1, "z": 2}
_ONES, _ZEROS = (1.0, 1.0, 1.0), (0.0, 0.0, 0.0)
_HALF_TURN = 1e-9  # how close (1 + c)/2 may come to 0, where the direction of e_r is lost
ANY_CHORD, ANY_LENGTH = 3.0, 1e100  # above all there are, with finite squares
_NEARLY_HALF_TURN = -0.999  # c where the direction of e_w begins to be lost


@final
@dataclass(frozen=True)
class Mask:
    """Which parts of a pose count, and how much.

    Attributes:
        position: Weights of x, y and z, world axes; 0 where it is free.
        rotation: Weights of the rotations about x, y and z, world axes; 0 where it is free.
        axis: Number of the tool's axis whose direction alone counts, in place of `rotation`.
    """

    position: tuple[float, ...] = _ONES
    rotation: tuple[float, ...] = _ONES
    axis: int | None = None

    @property
    def rows(self) -> int:
        """How many directions it holds."""
        turning = 2 if self.axis is not None else int(np.count_nonzero(self.rotation))
        return int(np.count_nonzero(self.position)) + turning


MASKS: dict[str, Mask] = {
    "pose": Mask(),
    "position": Mask(rotation=_ZEROS),
    "rotation": Mask(position=_ZEROS),
    **{f"position+{name}": Mask(_ONES, _ZEROS, axis) for name, axis in _AXES.items()},
    **{name: Mask(_ZEROS, _ZEROS, axis) for name, axis in _AXES.items()},
}


def mask_of(value: Any) -> Mask:
    """The mask that a user means by a name or by six weights, of which the ratios count.

    Raises:
        UnknownName: For an unknown name.
        InputError: For weights that are not six numbers, 0 or above, one of them above.
    """
    if isinstance(value, Mask):
        return value
    if isinstance(value, str):
        if value not in MASKS:
            raise UnknownName("mask", value, MASKS, "Or six weights: (x, y, z, rx, ry, rz).")
        return MASKS[value]
    try:
        weights = tuple(float(w) for w in value)
    except (TypeError, ValueError):
        weights = ()
    if len(weights) != 6 or not all(0.0 <= w < float("inf") for w in weights) or not any(weights):
        raise InputError(
            f"`mask` is {value!r}; expected one of {', '.join(map(repr, MASKS))}, or six weights "
            "(x, y, z, rx, ry, rz), 0 where the pose is free, in world axes."
        )
    chord_length = tuple(w / max(weights) for w in weights)
    return Mask(chord_length[:3], chord_length[3:])


class Distance(NamedTuple):
    """How far a frame is from its goal."""

    position: Any
    """Squared length of what counts of e_p [m^2]."""
    rotation: Any
    """Squared length of e_r or e_a, or of what counts of e_w [rad^2]."""
    is_near: Any
    """Whether e_w can be computed: not half a turn from the goal, where its direction is lost."""
    weighted: Sequence[Any]
    """The errors, weighted; radians count as `length` metres."""
    rows: Sequence[Array]
    """Their derivatives with respect to v, negated, (nv,) each; empty if not asked for."""
    angle: Any
    """The angle that counts: theta, or the length of what counts of e_w [rad]."""


def distance(
    model: Model,
    q: Array,
    frame: Frame,
    goal: Array,
    mask: Mask,
    length: float,
    with_rows: bool = True,
    by_angle: bool = False,
) -> Distance:
    """How far `frame` is from its goal, all traced; see `Distance`.

    With `by_angle` the weighted rotation error is as long as the angle, as most papers have it, not as its chord.

    Args:
        model: The robot.
        q: Configuration (nq,) [rad or m].
        frame: The frame.
        goal: Its goal T_world_frame, (4, 4).
        mask: What counts of the pose.
        length: How many metres a radian counts [m].
        with_rows: Whether to compute derivatives.
        by_angle: Whether rotation errors are angles instead of chords.

    Returns:
        Distances, weighted errors and their derivatives.
    """
    pose = algorithms.frame_pose(model, q, frame)
    R, R_goal = pose.rotation, goal[:3, :3]
    e_p = goal[:3, 3] - pose.translation
    J = algorithms.frame_jacobian(model, q, frame, "local_world_aligned") if with_rows else None
    weighted, rows, position = [], [], 0.0
    for k, weight in enumerate(mask.position):
        if weight:
            position = position + e_p[k] * e_p[k]
            weighted.append(e_p[k] * weight)
            if J is not None:
                rows.append(J[k] * weight)
    s, c, weights = _sine_and_cosine(R, R_goal, mask)
    turning = None if J is None else J[3:] if mask.axis is None else R.T @ J[3:]
    turned = [k for k, weight in enumerate(weights) if weight]
    if not turned:
        return Distance(position, 0.0, True, weighted, rows, 0.0)
    is_whole = mask.axis is not None or all(weights)
    turn = _turn(s, c, turned, is_whole, by_angle)
    weighted += [turn.chord[k] * (weights[k] * length) * turn.stretch for k in turned]
    if turning is not None:
        rows += [turning[k] * (weights[k] * length) for k in turned]
    return Distance(position, turn.squared, turn.is_near, weighted, rows, turn.angle)


class _Turn(NamedTuple):
    """The turn to the goal, of which entries of the axis count."""

    chord: Array
    stretch: Any
    """What the chord is multiplied by to be as long as the angle; 1 where errors are chords."""
    squared: Any
    """`Distance.rotation`."""
    is_near: Any
    angle: Any


def _turn(s: Array, c: Any, turned: Sequence[int], is_whole: bool, by_angle: bool) -> _Turn:
    """The turn whose axis times sine is `s` and whose cosine is `c`; `turned` are the entries that count.

    `is_whole` says that all that can change counts: the whole rotation, or the direction of an axis.
    """
    half = 0.5 * (1.0 + c)
    chord = s / numeric.sqrt(numeric.maximum(half, _HALF_TURN))
    if is_whole:  # at half a turn s vanishes; without this the worst rotation would count as the best one
        chord[turned[0]] = numeric.where(half < _HALF_TURN, 2.0, chord[turned[0]])
    arc = _arc(s, c, chord) if by_angle or not is_whole else 1.0
    squared = sum((chord[k] * chord[k] for k in turned), 0.0)
    stretch = arc if by_angle else 1.0
    if is_whole:
        squared = numeric.where(c > 0.0, squared, 2.0 - 2.0 * c)  # beyond, s shrinks again
        angle = numeric.arctan2(numeric.sqrt(sum((s[k] * s[k] for k in turned), 0.0)), c)
        return _Turn(chord, stretch, squared, True, angle)
    is_near = c > _NEARLY_HALF_TURN
    squared = squared * (arc * arc)
    return _Turn(chord, stretch, squared, is_near, numeric.sqrt(squared))


def _sine_and_cosine(R: Array, R_goal: Array, mask: Mask) -> tuple[Array, Any, Sequence[float]]:
    """The axis of the turn to the goal times its sine, the cosine, and the weights of the axis' entries."""
    if mask.axis is not None:
        a, a_goal = R[:, mask.axis], R_goal[:, mask.axis]
        weights = tuple(float(k != mask.axis) for k in range(3))
        return R.T @ numeric.cross(a, a_goal), numeric.dot(a, a_goal), weights
    s = 0.5 * sum((numeric.cross(R[:, i], R_goal[:, i]) for i in range(3)), np.zeros(3))
    return s, 0.5 * ((R * R_goal).sum() - 1.0), mask.rotation


def _arc(s: Array, c: Any, chord: Array) -> Any:
    """How much longer than its chord the angle is, 1 to pi/2."""
    chord_length = numeric.sqrt(numeric.dot(chord, chord))
    theta = numeric.arctan2(numeric.sqrt(numeric.dot(s, s)), c)
    return numeric.where(chord_length > 1e-6, theta / numeric.maximum(chord_length, 1e-6), 1.0)


def squared_tolerances(position: float, rotation: float) -> tuple[float, float]:
    """The greatest `Distance.position` and `Distance.rotation` within tolerances [m] and [rad].

    An angle is within its tolerance where its chord is; half a turn and more is any turn.

    Args:
        position: Largest distance [m].
        rotation: Largest angle [rad].

    Returns:
        Bounds [m^2] and [rad^2].
    """
    chord = 2.0 * math.sin(0.5 * rotation) if rotation < math.pi else ANY_CHORD
    return min(position, ANY_LENGTH) ** 2, chord**2
