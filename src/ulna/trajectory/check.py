"""Checks whether a trajectory keeps a robot's limits, and where it does not."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Any, final

import numpy as np

from ulna import kernels
from ulna.checks.arrays import known_limits
from ulna.checks.labels import in_order
from ulna.checks.values import count, flag, number
from ulna.data_classes import dataclass
from ulna.errors import InputError
from ulna.lazy import Slot, apply, is_deferred
from ulna.model import Model
from ulna.model.of_robot import model_of
from ulna.trajectory.inputs import positive
from ulna.trajectory.peaks import greatest
from ulna.trajectory.space import Poses, require_configurations
from ulna.trajectory.trajectory import Trajectory
from ulna.typing import Array, ArrayLike, Floats

_BOUND_TOLERANCE = 1e-8  # how close to the worst values their bounds come, in parts of the limits
Limits = dict[str, tuple[Floats, Floats]]

_RATES = {"position": "", "velocity": "/s", "acceleration": "/s^2", "jerk": "/s^3"}


@final
@dataclass(frozen=True)
class Breach:
    """One joint's worst excess over one of its limits.

    Attributes:
        joint: Name of the coordinate.
        quantity: "position", "velocity", "acceleration", "jerk" or "torque".
        time: When it is worst [s].
        value: What it is then.
        limit: What it may be.
        unit: Unit of both, such as "rad/s".
    """

    joint: str
    quantity: str
    time: float
    value: float
    limit: float
    unit: str

    @property
    def excess(self) -> float:
        """By how much the value is beyond the limit."""
        return abs(self.value - self.limit)

    def __str__(self) -> str:
        return (
            f"{self.joint}: {self.quantity} {self.value:.6g} exceeds {self.limit:.6g} by {self.excess:.3g} "
            f"{self.unit} at {self.time:.4g} s"
        )


@final
@dataclass(frozen=True)
class Report:
    """The result of a check: true where no limit is exceeded; `print` shows all of it.

    Attributes:
        breaches: The worst of each joint and quantity that is beyond its limit, worst first by parts of the limit.
        use: How much of each limit the trajectory uses at most, by quantity: 1 is at the limit, 0 is half way between
            two limits.
        robot: Name of the robot.
    """

    breaches: tuple[Breach, ...]
    use: dict[str, float]
    robot: str

    def __bool__(self) -> bool:
        return not self.breaches

    def __iter__(self) -> Iterator[Breach]:
        return iter(self.breaches)

    def __str__(self) -> str:
        used = ", ".join(f"{name} {100 * part:.1f} %" for name, part in self.use.items()) or "no limits"
        if self:
            return f"Within the limits of {self.robot!r}; used at most: {used}."
        n, of = len(self.breaches), f"of {self.robot!r}"
        lines = [f"{f'1 limit {of} is' if n == 1 else f'{n} limits {of} are'} exceeded (used: {used}):"]
        return "\n".join(lines + [f"  {breach}" for breach in self.breaches])

    def require(self) -> None:
        """Raises InputError with the whole report unless all limits are kept."""
        if not self:
            raise InputError(str(self))


def check(
    robot: Any,
    trajectory: Trajectory,
    *,
    acceleration: ArrayLike | None = None,
    jerk: ArrayLike | None = None,
    torque: bool = True,
    tolerance: float = 1e-6,
    samples: int = 1000,
) -> Report:
    """Whether a trajectory keeps a robot's limits of position, speed and torque, and of acceleration and jerk if given.

    The trajectory is evaluated at evenly spaced times, between any two knots, and on both sides of each knot. What
    lies between these times is bounded, and intervals whose bound is above the worst value are divided. Torques are
    those of inverse dynamics, with gravity and armature, without friction. Position limits of joints without any are
    not checked.

    Args:
        robot: A Robot or a Model.
        trajectory: A trajectory of its joints, or a Dask array (...) of such, for which the result is a lazy array of
            reports.
        acceleration: Limits of acceleration, one or (nv,) [rad/s^2 or m/s^2]; None for no check.
        jerk: Limits of jerk, one or (nv,) [rad/s^3 or m/s^3]; None for no check.
        torque: Whether to check torques.
        tolerance: By how much a value may exceed its limit, in parts of the limit (of half the range, where there are
            two): for rounding, or for a controller that permits as much [-].
        samples: At how many times it looks first, at least.

    Returns:
        A report: `if report`, `print(report)`, `report.require()`.

    Raises:
        InputError: The trajectory is none of that robot's joints, or an option has a value without a meaning.

    Example:
        >>> robot = ulna.load("panda")
        >>> q = robot.configurations["ready"]
        >>> move = ulna.trajectory.quintic(q, q + 0.1, duration=1.0)
        >>> bool(ulna.trajectory.check(robot, move, acceleration=10.0))
        True
    """
    model = model_of(robot)
    tolerance = number("tolerance", tolerance, "a part of the limits, such as 1e-6", least=0.0)
    samples, torque = count("samples", samples, least=2), flag("torque", torque)
    columns = _columns(model, _limits(model, acceleration, jerk, torque))
    if is_deferred(trajectory):
        run = partial(_reports, model, columns, tolerance, samples)
        return apply(run, [trajectory], [Slot("trajectory", (), object)], [Slot("report", (), object)])
    return _report(model, columns, tolerance, samples, trajectory)


def _report(
    model: Model, columns: list[_Column], tolerance: float, samples: int, trajectory: Trajectory
) -> Report:
    """The report on one trajectory."""
    if not isinstance(trajectory, Trajectory):
        raise InputError(f"`trajectory` is {trajectory!r}; expected one such as quintic(...) makes.")
    if isinstance(trajectory.space, Poses):
        raise InputError("The trajectory moves a pose; expected joints: follow(trajectory, ik) makes them.")
    require_configurations("trajectory", trajectory.space, model)
    if not columns:
        return Report((), {}, model.name)
    tolerances = np.full(len(columns), _BOUND_TOLERANCE)
    peaks = greatest(partial(_excesses, model, trajectory, columns), trajectory.knots, samples, tolerances)
    worst: dict[tuple[str, int], tuple[float, Breach]] = {}
    use: dict[str, float] = {}
    for column, over, time in zip(columns, peaks.value, peaks.time, strict=True):
        use[column.what] = max(use.get(column.what, 0.0), 1.0 + float(over))
        key = column.what, column.k
        if over > tolerance and (key not in worst or over > worst[key][0]):
            worst[key] = float(over), column.breach(model, float(over), float(time))
    ranked = sorted(worst.values(), key=lambda pair: -pair[0])
    return Report(tuple(breach for _, breach in ranked), use, model.name)


def _reports(
    model: Model, columns: list[_Column], tolerance: float, samples: int, trajectories: Any
) -> Array:
    """The reports on an array of trajectories."""
    reports = np.empty(trajectories.shape, dtype=object)
    for index in np.ndindex(trajectories.shape):
        reports[index] = _report(model, columns, tolerance, samples, trajectories[index])
    return reports


@dataclass(frozen=True)
class _Column:
    """One side of one limit: sign * (value - limit) / scale is its excess."""

    what: str
    k: int
    sign: float
    limit: float
    scale: float

    def breach(self, model: Model, over: float, time: float) -> Breach:
        """The breach whose excess is `over`, in parts of the scale."""
        names = model.position_names if self.what == "position" else model.velocity_names
        value = self.limit + self.sign * over * self.scale
        return Breach(names[self.k], self.what, time, value, self.limit, _unit(model, self.what, self.k))


def _columns(model: Model, limits: Limits) -> list[_Column]:
    """Both sides of all limits that are finite."""
    columns = []
    for what, (low, high) in limits.items():
        scale = np.where(np.isfinite(high - low), 0.5 * (high - low), np.maximum(np.abs(high), np.abs(low)))
        scale = np.where(np.isfinite(scale) & (scale > 0.0), scale, 1.0)
        for side, sign in ((high, 1.0), (low, -1.0)):
            columns += [
                _Column(what, int(k), sign, float(side[k]), float(scale[k]))
                for k in np.flatnonzero(np.isfinite(side))
            ]
    return columns


def _excesses(model: Model, trajectory: Trajectory, columns: list[_Column], t: Floats) -> Floats:
    """The excess over each side of each limit at times (m,), in parts of its scale, (m, columns)."""
    quantities = {column.what for column in columns}
    rows = trajectory._checked_at(t, 3 if "jerk" in quantities else 2)
    values: dict[str, Floats] = dict(
        zip(("position", "velocity", "acceleration", "jerk"), rows, strict=False)
    )
    if "torque" in quantities:
        values["torque"] = kernels.kernel(model, "inverse_dynamics")(*rows[:3])
    return np.stack([c.sign / c.scale * (values[c.what][:, c.k] - c.limit) for c in columns], axis=1)


def _limits(model: Model, acceleration: Any, jerk: Any, torque: bool) -> Limits:
    limits: Limits = {"position": (model.lower_position, model.upper_position)}
    speed = known_limits(model.velocity_limit)
    limits["velocity"] = -speed, speed
    for name, limit in (("acceleration", acceleration), ("jerk", jerk)):
        if limit is not None:
            bound = positive(name, in_order(name, limit, model.velocity_names), model.nv, infinite=True)
            limits[name] = -bound, bound
    if torque:
        effort = known_limits(model.effort_limit)
        limits["torque"] = -effort, effort
    return limits


def _unit(model: Model, what: str, k: Any) -> str:
    """The unit of coordinate k of a quantity."""
    kinds = [joint.kind for joint in model.joints if joint.mimic is None]
    parts = [kind.coordinates if what == "position" else kind.rates for kind in kinds]
    unit = [coordinate.unit for part in parts for coordinate in part][k]
    if what == "torque":
        return "N m" if unit == "rad" else "N"
    return unit + _RATES[what]
