"""A simulated robot: its state, its commands, and its integration over a step."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, Literal, final

import numpy as np

from ulna.algorithms.dynamics.joint_friction import Friction
from ulna.checks.arrays import known_limits, read_only, shaped_array
from ulna.checks.attributes import FixedAttributes
from ulna.checks.quaternions import checked_configuration
from ulna.checks.values import checked_robot, flag, one_of, text
from ulna.errors import InputError
from ulna.idioms import unknown_attribute
from ulna.robot import Robot
from ulna.sim.kinematic import moved_within_limits
from ulna.sim.plant import Plant, check_friction, checked_torques
from ulna.sim.recording import Recording
from ulna.sim.stops import Stops
from ulna.typing import ArrayLike, Floats

ControlMode = Literal["position", "velocity", "acceleration", "torque"]
CONTROL_MODES: tuple[str, ...] = ("position", "velocity", "acceleration", "torque")
LimitKind = Literal["none", "position", "all"]
BODY_OPTIONS = ("control", "limits", "friction", "record")
"""Options that hold for all robots of a simulation."""

_LIMIT_KINDS: tuple[str, ...] = ("none", "position", "all")


class _State:
    """What each step of a body changes; assigning to it takes a tenth of the time of assigning to the body."""

    __slots__ = ("actual_qd", "applied", "previous_q", "q", "qd")

    def __init__(self, q: Floats, qd: Floats) -> None:
        self.q = self.previous_q = q
        self.qd = self.actual_qd = qd
        self.applied: Floats | None = None


@final
class Body(FixedAttributes):
    """A robot in a simulation. Commands are assigned to it, before or after it is added, with the same meaning.

    - control "position": it is at `q`, and its recorded velocity is the rate at which `q` changed. With a
      `target` it moves there at its velocity limits.
    - control "velocity": it moves at `qd` and stops at its position limits.
    - control "acceleration": `qdd` changes `qd`.
    - control "torque": `tau` moves it, with gravity, inertia and friction; an array, or a function of t, q, qd.

    Args:
        robot: The robot.
        q: Its configuration, shape (nq,) [rad, m]; neutral when not given.
        qd: Its velocity, shape (nv,) [rad/s or m/s]; rest when not given.
        control: What is commanded.
        limits: Which limits hold: "position" for position limits (a joint stops there), "all" for those of velocity
            (of effort, under torques) as well, or "none".
        friction: For "torque": "model", None, or a `Friction`.
        record: Whether each step is recorded.
        name: Its name.

    Raises:
        ShapeError, NonFiniteError: An array does not fit the robot.
        UnknownName: There is no such control, limit or friction.
    """

    __slots__ = (
        "__weakref__",
        "_control",
        "_friction",
        "_limits",
        "_name",
        "_plant",
        "_qdd",
        "_record",
        "_recording",
        "_start",
        "_state",
        "_stops",
        "_target",
        "_tau",
        "robot",
    )

    def __init__(
        self,
        robot: Robot,
        q: ArrayLike | None = None,
        qd: ArrayLike | None = None,
        control: ControlMode = "velocity",
        limits: LimitKind = "position",
        friction: Friction | Literal["model"] | None = "model",
        record: bool = True,
        name: str | None = None,
    ) -> None:
        check_body_options(control, limits, friction, record)
        self.robot, self.limits, self.record = checked_robot(robot), limits, record
        self._name = robot.name if name is None else text("name", name)
        self._recording = Recording()
        self._friction: Any = friction
        self._plant: Plant | None = None
        speed = np.zeros(robot.nv) if qd is None else qd
        self._state = _State(
            checked_configuration("q", robot.neutral if q is None else q, robot.model),
            shaped_array("qd", speed, robot.nv, labels=robot.model.velocity_names),
        )
        self._qdd, self._target = np.zeros(robot.nv), None
        self._tau: Any = np.zeros(robot.nv)
        self.control = control
        self._stops = Stops.of(robot.model)
        self._start = self._state.q.copy(), self._state.qd.copy()

    @property
    def name(self) -> str:
        """Its name."""
        return self._name

    @property
    def recording(self) -> Recording:
        """What was recorded: a new one after `reset`."""
        return self._recording

    @property
    def limits(self) -> LimitKind:
        """Which limits hold: "none", "position" or "all"."""
        return self._limits

    @limits.setter
    def limits(self, limits: LimitKind) -> None:
        self._limits: LimitKind = one_of("limit", limits, _LIMIT_KINDS)

    @property
    def record(self) -> bool:
        """Whether each step is recorded."""
        return self._record

    @record.setter
    def record(self, record: bool) -> None:
        self._record = flag("record", record)

    @property
    def control(self) -> ControlMode:
        """What is commanded: "position", "velocity", "acceleration" or "torque"."""
        return self._control

    @control.setter
    def control(self, control: ControlMode) -> None:
        one_of("control", control, CONTROL_MODES)
        if control == "torque" and self._plant is None:
            self._plant = Plant(self.robot, self._friction)
        self._control: ControlMode = control

    @property
    def q(self) -> Floats:
        """The configuration, shape (nq,), read-only: assign all of it, such as `body.q = body.q + 0.1`."""
        return read_only(self._state.q.copy())

    @q.setter
    def q(self, q: ArrayLike) -> None:
        self.set_checked_q(checked_configuration("q", q, self.robot.model))

    def set_checked_q(self, q: Floats) -> None:
        """As assigning to `q`, for an array that is a valid configuration and that is not modified later."""
        self._state.q = q

    put = set_checked_q
    """Old name."""

    @property
    def qd(self) -> Floats:
        """The velocity, shape (nv,) [rad/s or m/s], read-only, as `q`."""
        return read_only(self._state.qd.copy())

    @qd.setter
    def qd(self, qd: ArrayLike) -> None:
        self._state.qd = self._state.actual_qd = shaped_array(
            "qd", qd, self.robot.nv, labels=self.robot.model.velocity_names
        )

    @property
    def qdd(self) -> Floats:
        """The commanded acceleration, shape (nv,) [rad/s^2 or m/s^2], read-only, as `q`."""
        return read_only(self._qdd.copy())

    @qdd.setter
    def qdd(self, qdd: ArrayLike) -> None:
        self._qdd = shaped_array("qdd", qdd, self.robot.nv, labels=self.robot.model.velocity_names)

    @property
    def tau(self) -> Any:
        """The commanded torques, shape (nv,) [N m or N], read-only, or a function of t, q, qd that returns them."""
        return self._tau if callable(self._tau) else read_only(self._tau.copy())

    @tau.setter
    def tau(self, tau: Any) -> None:
        self._tau = tau if callable(tau) else checked_torques(tau, self.robot.model)

    @property
    def target(self) -> Floats | None:
        """The target of position control, shape (nq,), read-only, as `q`; None to stay at `q`."""
        return None if self._target is None else read_only(self._target.copy())

    @target.setter
    def target(self, target: ArrayLike | None) -> None:
        self._target = None if target is None else checked_configuration("target", target, self.robot.model)

    def reset(self) -> None:
        """Reset to the first configuration and velocity, with an empty recording."""
        self._state = _State(self._start[0].copy(), self._start[1].copy())
        self._recording = Recording()

    def record_row(self, t: float) -> None:
        """Record its configuration, its actual velocity (which differs from the command at limits) and its torques."""
        if self._record:
            torque = {} if self._state.applied is None else {"tau": self._state.applied}
            self._recording.add(t, self._state.q, v=self._state.actual_qd, **torque)

    def prepare(self) -> None:
        """Compile what the first contact with a position limit takes, so that it does not hold up real time."""
        limited = np.isfinite(self._stops.lower).any() or np.isfinite(self._stops.upper).any()
        if self._control == "torque" and self._limits != "none" and limited and self._plant is not None:
            self._plant.prepare_stops()

    def step(self, t: float, dt: float, substep: float) -> None:
        """Advance the robot in time.

        Args:
            t: The time [s].
            dt: How far [s].
            substep: The longest step under torques [s].

        Raises:
            InputError: The motion diverged.
        """
        state = self._state
        state.applied = None
        before, state.previous_q = state.previous_q, state.q
        if self._control == "position" and self._target is None:
            state.qd = state.actual_qd = np.zeros(self.robot.nv)
            if before is not state.q:
                state.actual_qd = np.asarray(self.robot.difference(before, state.q)) / dt
            return
        with np.errstate(over="ignore", invalid="ignore"):
            _STEPS[self._control](self, t, dt, substep)
            size = state.q.dot(state.q) + state.qd.dot(state.qd)
        state.previous_q = state.q
        if not math.isfinite(size):
            raise InputError(
                f"The motion of {self.name!r} diverged at t = {t + dt:g} s. Take a smaller step, or "
                "check its commands."
            )

    def _step_to_target(self, t: float, dt: float, _: float) -> None:
        assert self._target is not None
        state = self._state
        difference = np.asarray(self.robot.difference(state.q, self._target))
        longest = known_limits(self.robot.limits.velocity) * dt
        fraction = min(1.0, float(np.min(longest / np.maximum(np.abs(difference), 1e-300), initial=np.inf)))
        before = state.q
        state.q = (
            self._target.copy()
            if fraction >= 1.0
            else np.asarray(self.robot.integrate(before, fraction * difference))
        )
        self._apply_position_limits()
        state.qd = state.actual_qd = np.asarray(self.robot.difference(before, state.q)) / dt

    def _step_velocity(self, t: float, dt: float, _: float) -> None:
        state = self._state
        speed = self._speed_limited(state.qd)
        if self._limits == "none":
            state.q = np.asarray(self.robot.integrate(state.q, dt * speed))
        else:
            before, state.q = state.q, moved_within_limits(self.robot, state.q, speed, dt)
            speed = np.asarray(self.robot.difference(before, state.q)) / dt
        state.actual_qd = speed

    def _step_acceleration(self, t: float, dt: float, _: float) -> None:
        state = self._state
        faster = self._speed_limited(state.qd + dt * self._qdd)
        state.q = np.asarray(self.robot.integrate(state.q, dt / 2 * (state.qd + faster)))
        state.qd = faster
        self._apply_position_limits()
        state.actual_qd = state.qd

    def _step_dynamics(self, t: float, dt: float, substep: float) -> None:
        assert self._plant is not None
        state = self._state
        count = max(1, int(np.ceil(dt / substep - 1e-9)))
        effort = known_limits(self.robot.limits.effort)
        for k in range(count):
            tau: Any = self._tau
            if callable(tau):
                torques: Any = tau(t + k * dt / count, state.q.copy(), state.qd.copy())
                tau = checked_torques(torques, self.robot.model)
            if self._limits == "all":
                tau = np.clip(tau, -effort, effort)
            if self._limits == "none":
                state.q, state.qd = self._plant.euler(state.q, state.qd, tau, dt / count)
            else:
                state.q, state.qd = self._plant.euler_within(state.q, state.qd, tau, dt / count, self._stops)
            state.applied = tau
        state.actual_qd = state.qd

    def _speed_limited(self, speed: Floats) -> Floats:
        fastest = known_limits(self.robot.limits.velocity)
        return np.clip(speed, -fastest, fastest) if self._limits == "all" else speed

    def _apply_position_limits(self) -> None:
        """Set joints beyond a position limit to the limit, and their velocity to zero."""
        state = self._state
        if self._limits != "none" and not self._stops.contains(state.q):
            low, high = self._stops.beyond(state.q)
            state.q = self._stops.held(state.q, low, high)
            state.qd = np.where((low & (state.qd < 0.0)) | (high & (state.qd > 0.0)), 0.0, state.qd)

    def __getattr__(self, name: str) -> Any:
        raise unknown_attribute("body", name, dir(type(self)))

    def __repr__(self) -> str:
        return f"<{self.name!r} under {self.control} control>"


def check_body_options(
    control: ControlMode = "velocity",
    limits: LimitKind = "position",
    friction: Friction | Literal["model"] | None = "model",
    record: bool = True,
) -> None:
    """Check options of a simulated robot.

    Args:
        control: "position", "velocity", "acceleration" or "torque".
        limits: Which limits stop the robot: "none", "position" or "all".
        friction: The friction of the joints; "model" for that of the model, None for none.
        record: Whether rows are recorded.

    Raises:
        UnknownName: There is no such control, limit or friction.
        InputError: `record` is not True or False.
    """
    one_of("control", control, CONTROL_MODES)
    one_of("limit", limits, _LIMIT_KINDS)
    check_friction(friction)
    flag("record", record)


_STEPS: dict[str, Callable[[Body, float, float, float], None]] = {
    "position": Body._step_to_target,
    "velocity": Body._step_velocity,
    "acceleration": Body._step_acceleration,
    "torque": Body._step_dynamics,
}
