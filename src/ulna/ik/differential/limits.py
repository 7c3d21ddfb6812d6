"""Limits of joints: what a velocity must stay within at this configuration.

| symbol | meaning | shape, unit | source |
|---|---|---|---|
| v, v_0 | velocity to be chosen, and the one chosen before | (nv,), 1/s | |
| d | distance of a joint to its limit | rad or m | |
| position | (lower - q) g / dt <= v <= (upper - q) g / dt | g: gain | Kanoun, Lamiraux, Wieber 2011 |
| velocity | -v_max <= v <= v_max | | |
| acceleration | v_0 - a dt <= v <= v_0 + a dt | rad/s^2, m/s^2 | |
| K | whole steps of deceleration a before it stands: floor(-1/2 + sqrt(1/4 + 2 d / (a dt^2))) | | |
| braking | v <= (d / dt + a dt K (K + 1) / 2) / (K + 1) | | v dt + (v - a dt) dt + ... <= d |

The bound of braking is the largest speed to go on with for a step, and then to stop before the limit in steps that are
slower by a dt each. A step later it is smaller by just a dt, so it never contradicts the bound of acceleration (Decre
et al. 2009, Del Prete 2018). Joints of several coordinates can have limits of position if these are a plain vector.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple, final

import numpy as np

from ulna.algorithms.multibody.batch_shapes import batch_zeros
from ulna.checks.arrays import known_limits, number_or_array
from ulna.checks.labels import in_order
from ulna.checks.values import flag
from ulna.data_classes import dataclass
from ulna.errors import InputError
from ulna.ik.differential.task import Shapes
from ulna.model import Model
from ulna.numeric import ceil, clip, maximum, sqrt
from ulna.typing import Array, Floats


class Interval(NamedTuple):
    """Least and greatest values, (..., n) each; infinite where there is no bound."""

    lower: Array
    upper: Array


class Strip(NamedTuple):
    """Rows A (..., k, nv) with `lower <= A @ v <= upper`."""

    A: Array
    lower: Array
    upper: Array


@dataclass(frozen=True, eq=False, kw_only=True)
class Limit(ABC):
    """Something that a velocity must not go beyond.

    Attributes:
        name: What it is called in messages, and the prefix of the names of its inputs.
    """

    name: str | None = None

    @property
    def label(self) -> str:
        """Its name, given or by default."""
        return self.name or type(self).__name__

    def inputs(self, model: Model) -> Shapes:
        """Names and shapes of its inputs at every step."""
        return {}

    def defaults(self, model: Model) -> Mapping[str, Any]:
        """Values of inputs that need not be passed."""
        return {}

    @abstractmethod
    def bounds(self, model: Model, q: Array, dt: Any, *inputs: Array) -> Interval | Strip:
        """What it allows: an interval for each joint velocity (nv), or rows.

        Args:
            model: The robot.
            q: Configuration (..., nq) [rad or m].
            dt: Duration of the step, shape (...) [s].
            *inputs: Values in the order of `inputs`, (...) before their shapes.

        Returns:
            Least and greatest velocities, or rows with bounds [rad/s or m/s].

        Raises:
            UnknownName, InputError: The limit does not fit the model.
        """


@final
@dataclass(frozen=True, eq=False)
class PositionLimit(Limit):
    """Joints stay within their limits of position.

    A joint that stands beyond a limit is led back; where another limit does not let it come back in one step, there is
    a conflict (see `DifferentialIK`).

    Attributes:
        gain: The part of the way to a limit that one step may go, above 0 to 1. With 1, a step may end at the limit.
        margin: How far from the limits to stay [rad or m].
    """

    gain: float = 1.0
    margin: float = 0.0

    def __post_init__(self) -> None:
        check_gain(self.gain, self.label)
        _check_margin(self.margin, self.label)

    def bounds(self, model: Model, q: Array, dt: Any, *inputs: Array) -> Interval:
        """The interval that leads to the limits."""
        lower, upper = _unbounded(model, q)
        for at, i, low, high in _limited(model, self.margin, self.label):
            if np.isfinite(low):
                lower[..., i] = (low - q[..., at]) * (self.gain / dt)
            if np.isfinite(high):
                upper[..., i] = (high - q[..., at]) * (self.gain / dt)
        return Interval(lower, upper)


@final
@dataclass(frozen=True, eq=False)
class VelocityLimit(Limit):
    """Joints are no faster than allowed.

    Attributes:
        fastest: Greatest speeds [rad/s or m/s]: one number, (nv,), or by joint; None for the model's, where 0,
            as in many files, says nothing.
    """

    fastest: Any = None

    def bounds(self, model: Model, q: Array, dt: Any, *inputs: Array) -> Interval:
        """The same interval everywhere."""
        if self.fastest is None:
            fastest = known_limits(model.velocity_limit)
        else:
            fastest = _of_joints(model, self.fastest, self.label)
        return Interval(-fastest, fastest)


@final
@dataclass(frozen=True, eq=False)
class AccelerationLimit(Limit):
    """Joints change their velocity no faster than allowed, and can stop before the limits of position.

    It takes the velocity that was chosen at the step before, as `v`.

    Attributes:
        largest: Greatest accelerations [rad/s^2 or m/s^2]: one number, (nv,), or by joint.
        braking: Whether to keep the way that is needed to stop before the limits of position.
        margin: How far from those to stop [rad or m].
    """

    largest: Any
    braking: bool = True
    margin: float = 0.0

    def __post_init__(self) -> None:
        flag("braking", self.braking)
        _check_margin(self.margin, self.label)

    def inputs(self, model: Model) -> Shapes:
        """The velocity before."""
        return {self.name or "v": (model.nv,)}

    def bounds(self, model: Model, q: Array, dt: Any, *inputs: Array) -> Interval:
        """The velocities that can be had from the one before, and from which one can stop."""
        a = _of_joints(model, self.largest, self.label)
        lower, upper = _unbounded(model, q)
        for i in np.flatnonzero(np.isfinite(a)):
            lower[..., i] = inputs[0][..., i] - a[i] * dt
            upper[..., i] = inputs[0][..., i] + a[i] * dt
        for at, i, low, high in _limited(model, self.margin, self.label) if self.braking else ():
            least, most = lower[..., i], upper[..., i]
            if np.isfinite(a[i]) and np.isfinite(low):
                lower[..., i] = clip(-_speed_to_stop(q[..., at] - low, a[i], dt), least, most)
            if np.isfinite(a[i]) and np.isfinite(high):
                upper[..., i] = clip(_speed_to_stop(high - q[..., at], a[i], dt), least, most)
        return Interval(lower, upper)


def check_gain(gain: float, label: str) -> None:
    """Checks that `gain` is above 0 and at most 1.

    Args:
        gain: The part of a distance that may be covered in one step [-].
        label: Name of the limit, for the message.

    Raises:
        InputError: If it is not.
    """
    if not 0.0 < gain <= 1.0:
        raise InputError(f"{label}: `gain` is {gain}; expected above 0, at most 1.")


def _check_margin(margin: float, label: str) -> None:
    """Refuses a distance from limits that is none."""
    if not 0.0 <= margin < np.inf:
        raise InputError(f"{label}: `margin` is {margin}; expected a number not below 0.")


def _speed_to_stop(distance: Any, a: float, dt: Any) -> Any:
    """The greatest speed with which a joint may go on for a step and then stop within `way`."""
    remaining = maximum(distance, 0.0)
    steps = -ceil(0.5 - sqrt(0.25 + (2.0 / a) * remaining / (dt * dt)))
    return (remaining / dt + (0.5 * a) * dt * steps * (steps + 1.0)) / (steps + 1.0)


def _unbounded(model: Model, q: Array) -> tuple[Array, Array]:
    free = batch_zeros((model.nv,), q)
    return free - np.inf, free + np.inf


def _limited(model: Model, margin: float, label: str) -> Iterator[tuple[int, int, float, float]]:
    """The coordinates with a limit of position: where they stand in q and in v, and between what they may be."""
    for joint in model.joints:
        if joint.mimic is not None:
            continue
        for k, (lower, upper) in enumerate(zip(joint.limits.lower, joint.limits.upper, strict=True)):
            if np.isinf(lower) and np.isinf(upper):
                continue
            if not joint.kind.is_vector:
                raise InputError(
                    f"{label}: joint {joint.name!r} is {joint.kind.describe()} and has limits of position, which are "
                    "no bounds on its velocities. Take the limits away, or leave this limit out."
                )
            if lower + margin > upper - margin:
                raise InputError(f"{label}: a `margin` of {margin} leaves joint {joint.name!r} no range.")
            yield joint.idx_q + k, joint.idx_v + k, lower + margin, upper - margin


def _of_joints(model: Model, bound: Any, label: str) -> Floats:
    """Positive numbers (nv,), from one, as many, or by joint; infinite for joints that are left out."""
    if isinstance(bound, Mapping):
        out = np.full(model.nv, np.inf)
        for name, value in bound.items():
            joint = model.joint(name)
            out[joint.idx_v : joint.idx_v + joint.nv] = value
    else:
        out = number_or_array(label, in_order(label, bound, model.velocity_names), model.nv)
    if not (out > 0.0).all():
        raise InputError(f"{label}: {bound} holds a number that is not above 0.")
    return out
