"""Simulation of several robots with one clock, as fast as possible or in real time, with recording."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import Any, Self, final

from ulna.checks.attributes import FixedAttributes
from ulna.checks.values import duration as checked_duration
from ulna.checks.values import flag, number, one_of, short_repr, step_count
from ulna.checks.values import function as checked_function
from ulna.errors import InputError, UnknownName
from ulna.idioms import unknown_attribute
from ulna.robot import Robot
from ulna.sim.body import Body

_SPEED = "simulated seconds per second, above zero"
_MAX_STEPS = 10**12  # more never end


def _nobody() -> bool:
    """Nobody can end a pause."""
    return False


@final
class Simulation(FixedAttributes):
    """Robots with a common clock.

    Args:
        realtime: Whether steps run in real time.
        speed: Simulated seconds per second in real time [-].
        substep: The longest step of dynamics [s]; longer steps are made of several.

    Example:
        >>> robot, sim = ulna.load("panda"), ulna.Simulation()
        >>> arm = sim.add(robot, q=robot.configurations["ready"], control="velocity")
        >>> arm.qd = [0.2, 0, 0, 0, 0, 0, 0]
        >>> sim.run(1.0)
        >>> (arm.q - robot.configurations["ready"]).round(3)
        array([0.2, 0. , 0. , 0. , 0. , 0. , 0. ])
    """

    __slots__ = (
        "__weakref__",
        "_bodies",
        "_can_resume",
        "_listeners",
        "_origin",
        "_paused",
        "_realtime",
        "_speed",
        "_steps",
        "_substep",
        "_t",
        "_waiting",
    )

    def __init__(self, realtime: bool = False, speed: float = 1.0, substep: float = 1e-3) -> None:
        self._realtime, self._substep = flag("realtime", realtime), checked_duration("substep", substep)
        self._speed, self._paused = number("speed", speed, _SPEED, above=0.0), False
        self._can_resume: Callable[[], bool] = _nobody
        self._waiting = False
        self._bodies: list[Body] = []
        self._listeners: list[Callable[[Simulation], object]] = []
        self._t, self._steps = 0.0, 0
        self._origin: tuple[float, float] | None = None

    @property
    def can_resume(self) -> Callable[[], bool]:
        """Whether a user can end a pause; called during a pause, which ends when it returns False."""
        return self._can_resume

    @can_resume.setter
    def can_resume(self, can_resume: Callable[[], bool]) -> None:
        self._can_resume = checked_function("can_resume", can_resume)

    @property
    def waiting(self) -> bool:
        """Whether a step waits for the end of a pause."""
        return self._waiting

    @property
    def patience(self) -> Callable[[], bool]:
        """Old name of `can_resume`."""
        return self.can_resume

    @patience.setter
    def patience(self, can_resume: Callable[[], bool]) -> None:
        self.can_resume = can_resume

    @property
    def t(self) -> float:
        """The simulated time [s]."""
        return self._t

    @property
    def steps(self) -> int:
        """How many steps were made."""
        return self._steps

    @property
    def realtime(self) -> bool:
        """Whether steps run in real time."""
        return self._realtime

    @realtime.setter
    def realtime(self, realtime: bool) -> None:
        self._realtime, self._origin = flag("realtime", realtime), None

    @property
    def substep(self) -> float:
        """The longest step of dynamics [s]."""
        return self._substep

    @substep.setter
    def substep(self, substep: float) -> None:
        self._substep = checked_duration("substep", substep)

    @property
    def paused(self) -> bool:
        """Whether a step in real time waits, as long as `can_resume` allows."""
        return self._paused

    @paused.setter
    def paused(self, paused: bool) -> None:
        self._paused = flag("paused", paused)

    @property
    def speed(self) -> float:
        """Simulated seconds per second in real time."""
        return self._speed

    @speed.setter
    def speed(self, speed: float) -> None:
        self._speed, self._origin = number("speed", speed, _SPEED, above=0.0), None

    @property
    def bodies(self) -> tuple[Body, ...]:
        """The robots."""
        return tuple(self._bodies)

    def __getitem__(self, name: str) -> Body:
        bodies = {b.name: b for b in self._bodies}
        return bodies[one_of("robot in the simulation", name, bodies)]

    def add(self, robot: Robot | Body, **body_options: Any) -> Body:
        """Add a robot. Its row at the present time is recorded.

        Args:
            robot: A robot, or a body made before.
            **body_options: As for `Body`, for a robot.

        Returns:
            The simulated robot.

        Raises:
            InputError: There is a robot of that name already, or options are given for a body, which has its own.
        """
        if isinstance(robot, Body) and body_options:
            raise InputError(
                f"`{next(iter(body_options))}` is given for {robot!r}, which has its options already. "
                "Assign to the body, or add the robot."
            )
        body = robot if isinstance(robot, Body) else Body(robot, **body_options)
        if any(b.name == body.name for b in self._bodies):
            raise InputError(
                f"There is a robot {body.name!r} in the simulation already; pass another `name`."
            )
        self._bodies.append(body)
        body.record_row(self._t)
        return body

    def remove(self, body: Body) -> None:
        """Take a robot out.

        Raises:
            UnknownName: It is not there.
        """
        if not any(b is body for b in self._bodies):
            name = body.name if isinstance(body, Body) else short_repr(body)
            raise UnknownName(
                "robot in the simulation", name, (b.name for b in self._bodies), "Give a Body of it."
            )
        self._bodies = [b for b in self._bodies if b is not body]

    def each_step(self, function: Callable[[Simulation], object]) -> Self:
        """Have `function` called with the simulation after each step."""
        self._listeners.append(checked_function("function", function))
        return self

    def step(self, dt: float) -> None:
        """Advance all robots by `dt` [s].

        Raises:
            InputError: `dt` is not above zero, or a motion diverged.

        Example:
            >>> robot, sim = ulna.load("panda"), ulna.Simulation()
            >>> arm = sim.add(robot, q=robot.configurations["ready"], control="velocity")
            >>> goal = ulna.SE3.pointing_down((0.4, 0.2, 0.3))
            >>> for _ in range(500):
            ...     v, arrived = ulna.p_servo(robot.fk(arm.q), goal, method="angle-axis")
            ...     arm.qd = np.linalg.pinv(robot.jacobian(arm.q)) @ v
            ...     sim.step(0.01)
            >>> arrived, robot.fk(arm.q)[:3, 3].round(2)
            (True, array([0.4, 0.2, 0.3]))
        """
        if dt.__class__ is not float or not 0.0 < dt < math.inf:
            dt = checked_duration("dt", dt)
        if self._realtime and self._origin is None:
            for body in self._bodies:
                body.prepare()
        for body in self._bodies:
            body.step(self._t, dt, self._substep)
        self._t += dt
        self._steps += 1
        if self._bodies or self._listeners:
            for body in self._bodies:
                body.record_row(self._t)
            for function in self._listeners:
                function(self)
        if self._realtime:
            self._wait()

    def run(
        self, duration: float, dt: float = 0.01, until: Callable[[Simulation], object] | None = None
    ) -> None:
        """Step for some time, or until a condition holds.

        Args:
            duration: How long [s].
            dt: About how long a step is [s]; the duration is divided into equal steps.
            until: Called after each step with the simulation; true ends the run.

        Raises:
            InputError: A time is not above zero.

        Example:
            >>> sim = ulna.Simulation()
            >>> arm = sim.add(ulna.load("panda"), control="velocity")
            >>> arm.qd = [0.5, 0, 0, 0, 0, 0, 0]
            >>> sim.run(5.0, until=lambda sim: arm.q[0] > 0.998)
            >>> round(sim.t, 2)
            2.0
        """
        length, count = step_count(duration, dt, _MAX_STEPS)
        if until is not None:
            checked_function("until", until)
        for _ in range(count):
            self.step(length / count)
            if until is not None and until(self):
                return

    def reset(self) -> None:
        """Reset to time zero, the first state of each robot, and empty recordings."""
        self._t, self._steps, self._origin = 0.0, 0, None
        for body in self._bodies:
            body.reset()
            body.record_row(0.0)

    def _wait(self) -> None:
        while self._paused and self.can_resume():
            self._origin, self._waiting = None, True
            time.sleep(0.02)
        self._waiting = False
        now = time.perf_counter()
        if self._origin is None:
            self._origin = now, self._t
        began, t = self._origin
        ahead = (self._t - t) / self._speed - (now - began)
        if ahead < -0.5:  # too slow to catch up: the clock restarts here
            self._origin = now, self._t
        elif ahead > 0.0:
            time.sleep(ahead)

    def __getattr__(self, name: str) -> Any:
        raise unknown_attribute("simulation", name, dir(type(self)))

    def __repr__(self) -> str:
        names = ", ".join(repr(b.name) for b in self._bodies) or "nothing"
        return f"<simulation of {names} at {self._t:.3f} s>"
