"""Straight lines of joints on the manifold of configurations: quaternions stay unit, free angles go the short way."""

from __future__ import annotations

from typing import Any, final

import numpy as np

from ulna import algorithms, kernels
from ulna.checks.labels import in_order
from ulna.data_classes import dataclass
from ulna.errors import InputError
from ulna.model import Model
from ulna.model.of_robot import model_of
from ulna.trajectory.compose import Chain, Retimed
from ulna.trajectory.inputs import not_repeating, rows, vector
from ulna.trajectory.paths import UnitPath, law
from ulna.trajectory.space import Configurations, Space
from ulna.trajectory.trajectory import Trajectory
from ulna.typing import ArrayLike, Floats

_SAME = 1e-9  # what is this near a way-point has the same turns and the same sign


@final
@dataclass(frozen=True, eq=False, repr=False)
class Geodesic(UnitPath):
    """The straight line from a configuration along a tangent vector, at constant velocity, in one second.

    Attributes:
        space: The configurations of a model.
        origin: Where it starts, (nq,).
        step: The velocity, (nv,) [rad/s or m/s].
        kind: What made it.
    """

    space: Space
    origin: Floats
    step: Floats
    kind: str = "straight"

    @property
    def order(self) -> int:
        """3: velocity is constant, and all beyond is zero."""
        return 3

    def _at(self, t: Floats, order: int) -> tuple[Floats, ...]:
        assert isinstance(self.space, Configurations)
        q = kernels.kernel(self.space.model, "integrate")(self.origin, t[:, None] * self.step)
        v = np.broadcast_to(self.step, (t.size, self.step.size))
        return (q, v, np.zeros_like(v), np.zeros_like(v))[: order + 1]


def straight(
    robot: Any,
    q0: ArrayLike,
    q1: ArrayLike,
    duration: float | None = None,
    velocity: ArrayLike | None = None,
    acceleration: ArrayLike | None = None,
    jerk: ArrayLike | None = None,
) -> Trajectory:
    """From rest to rest on the straight line between two configurations of a robot.

    Rotations turn about one axis, a free flyer moves along a screw, continuous joints go the short way; everything else
    moves as numbers do.

    Args:
        robot: A Robot or a Model.
        q0: Start, (nq,) [rad or m].
        q1: End, (nq,).
        duration: Time it takes [s], for a quintic law.
        velocity: Limits of speed, one or (nv,) [rad/s or m/s], for a law as fast as limits allow: trapezoidal, or an
            S-curve with `jerk`.
        acceleration: Limits of acceleration, one or (nv,) [rad/s^2 or m/s^2].
        jerk: Limits of jerk, one or (nv,) [rad/s^3 or m/s^3]; None for no limit.

    Returns:
        The trajectory.

    Raises:
        InputError: Shapes do not fit, quaternions that are not unit, neither duration nor limits, or equal points with
            limits.
    """
    model = model_of(robot)
    line = _line(model, _configuration(model, "q0", q0), _configuration(model, "q1", q1))
    given = {"velocity": velocity, "acceleration": acceleration, "jerk": jerk}
    limits = (in_order(name, limit, model.velocity_names) for name, limit in given.items())
    return Retimed(line, law(np.abs(line.step), duration, *limits), "straight")


def straight_through(robot: Any, points: ArrayLike, durations: ArrayLike) -> Trajectory:
    """Straight from configuration to configuration of a robot, at rest in each.

    The numbers do not jump: where a continuous joint arrives a whole turn from the number of a way-point, or a
    quaternion with the other sign, it goes on from there.

    Args:
        robot: A Robot or a Model.
        points: Configurations in rows, (k + 1, nq) [rad or m].
        durations: Time of each line, one or (k,) [s].

    Returns:
        The trajectory.

    Raises:
        InputError: Way-points repeat, or `durations` do not fit.
    """
    model = model_of(robot)
    q = rows("points", in_order("points", points, model.position_names))
    q = np.stack([_configuration(model, f"points[{k}]", x) for k, x in enumerate(q)])
    steps = algorithms.difference(model, q[:-1], q[1:])
    not_repeating("points", q, np.abs(steps).max(axis=1))
    try:
        times = np.broadcast_to(np.asarray(durations, dtype=float), (len(steps),))
    except ValueError:
        raise InputError(
            f"`durations` has shape {np.shape(durations)}; expected one time or ({len(steps)},)."
        ) from None
    start, lines = q[0], []
    for point, time in zip(q[1:], times, strict=True):
        lines.append(straight(model, start, point, time))
        end = lines[-1].end
        start = np.where(np.abs(end - point) < _SAME, point, end)
    return Chain.of(lines, "straight")


def _configuration(model: Model, name: str, value: ArrayLike) -> Floats:
    if not model.nq:
        raise InputError(f"Model {model.name!r} has no joints that move, and so no trajectories.")
    q = vector(name, in_order(name, value, model.position_names), model.nq)
    off = np.abs(algorithms.normalize(model, q) - q)
    for places in model.unit_vectors:
        k = max(places, key=lambda place: off[place])
        if off[k] > 1e-6:
            kind = "a quaternion" if len(places) == 4 else "cosine and sine of an angle"
            raise InputError(
                f"`{name}[{k}]`, {model.position_names[k]!r}, belongs to {kind} whose length is not 1; "
                "robot.configuration_space.normalize(q) makes it so."
            )
    return q


def _line(model: Model, q0: Floats, q1: Floats) -> Geodesic:
    return Geodesic(Configurations.of(model), q0, algorithms.difference(model, q0, q1))
