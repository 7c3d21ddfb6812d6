"""The result of planning: a path and what is known of it, or why there is none."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import TYPE_CHECKING, Any, Literal, final

from ulna.checks.arrays import read_only
from ulna.checks.values import flag
from ulna.data_classes import dataclass
from ulna.errors import InputError
from ulna.planning.certificate import Certificate
from ulna.planning.path_length import length
from ulna.planning.search_tree import SearchTree
from ulna.typing import ArrayLike, Floats

if TYPE_CHECKING:
    from ulna.trajectory import Retimed

Outcome = Literal["solved", "start", "goal", "unreachable", "iterations", "time"]


@final
@dataclass(frozen=True, eq=False)
class Plan:
    """A path of straight motions from configuration to configuration, or why none was found; true if there is one.

    Attributes:
        outcome: "solved"; or what stood in the way: the "start" or "goal" touches something or is out of limits, the
            goal's pose is "unreachable", or the limit of "iterations" or of "time" was reached.
        reason: The same as a sentence, with links, obstacles, joints and by how much.
        points: Configurations, shape (n, nq) [rad, m], read-only; none where there is no path.
        certificate: Which edges are proved free between their points; None where there is no path.
        goal: Which of the goals was reached; -1 for none.
        iterations: Samples that the search took.
        nodes: Configurations in its two trees.
        step: The longest way that any point of the robot moves between states that the search checked [m].
        seconds: How long each part took: "prepare", "search" (with the look at start, goals and straight motions, where
            trees grow right after it), "shorten", "improve", "certify" [s].
        model: The robot's model.
        improvements: Where `improve` asks for shorter paths: for the first path and each better one the time since the
            call [s], and its length [rad, m], before it is certified.
        deviation_bounds: Rows (m, nq) [1/rad, 1/m]: a motion that deviates from the path by d is certified, too, where
            all of `deviation_bounds @ abs(d)` are at most 1; None where no deviation is, because `margin` was 0.
        tree: The configurations that the search reached, where `keep_tree` asks for them and there was a search; for
            `viewer.plan`.
        touching: The names of the two things that touch at the start or goal, or come too near to each other, where
            that is the outcome; else None.
        method: What counted: "spheres" that cover the links, or "exact" shapes.
    """

    outcome: Outcome
    reason: str
    points: Floats
    certificate: Certificate | None
    goal: int
    iterations: int
    nodes: int
    step: float
    seconds: Mapping[str, float]
    model: Any = field(repr=False)
    improvements: tuple[tuple[float, float], ...] = ()
    deviation_bounds: Any = field(default=None, repr=False)
    tree: SearchTree | None = field(default=None, repr=False)
    touching: tuple[str, str] | None = None
    method: Literal["spheres", "exact"] = "spheres"

    def __post_init__(self) -> None:
        read_only(self.points)  # what is certified holds for them
        if self.deviation_bounds is not None:
            read_only(self.deviation_bounds)

    def __bool__(self) -> bool:
        return self.success

    @property
    def success(self) -> bool:
        """Whether there is a path: the outcome is "solved"; so is `bool(plan)`."""
        return self.outcome == "solved"

    @property
    def is_certified(self) -> bool:
        """Whether it is proved that nothing touches anywhere on the path."""
        return self.certificate is not None and bool(self.certificate)

    @property
    def cost(self) -> float:
        """The length of the path in joint space [rad, m]."""
        return length(self.points)

    def trajectory(
        self,
        *,
        velocity: ArrayLike | None = None,
        acceleration: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        jerk: ArrayLike | None = None,
        blend: bool = False,
    ) -> Retimed:
        """The fastest motion along the path under limits; it follows the path exactly and rests at its corners.

        With `blend` it cuts the corners without resting there, and uses the margin that the plan kept. With `jerk` it
        is an S-curve on each straight part, and torques are not looked at.

        Args:
            velocity: Limits of speed, (), (nq,) or (2, nq) [rad/s, m/s]; None for the model's.
            acceleration: Limits of acceleration, (), (nq,) or (2, nq) [rad/s^2, m/s^2].
            torque: Limits of torque, (), (nq,) or (2, nq) [N m, N]; None for the model's.
            jerk: Limits of jerk, () or (nq,) [rad/s^3, m/s^3]; those of speed and acceleration are then of these
                shapes, too. None for no limit.
            blend: Whether corners are cut, by as much as is certified.

        Returns:
            The trajectory. What is certified of the path holds for it; of one that cuts corners, that it touches
            nothing and keeps the constraints, but not the margin.

        Raises:
            InputError: If there is no path, it has one point only, no motion keeps the limits, corners are to be cut
                and the plan kept no margin, or `jerk` comes without `acceleration`, or with `torque` or `blend`.

        Example:
            >>> robot = ulna.load("panda")
            >>> q = robot.configurations["ready"]
            >>> plan = robot.plan(q, q + [1, 0, 0, 0, 0, 0, 0])
            >>> motion = plan.trajectory(acceleration=4.0)
            >>> np.allclose(motion(motion.duration), plan.points[-1])
            True
        """
        from ulna.planning.jerk_motion import jerk_limited_motion
        from ulna.planning.motion_path import motion_path
        from ulna.trajectory import time_optimal

        flag("blend", blend)
        if not self:
            raise InputError(f"There is no path to move along: {self.reason}")
        if jerk is not None:
            if acceleration is None or torque is not None or blend:
                raise InputError(
                    "`jerk` needs `acceleration`, and takes neither `torque` nor `blend`; ask ulna.trajectory.check "
                    "whether the motion keeps limits of torque."
                )
            return jerk_limited_motion(self.model, self.points, velocity, acceleration, jerk)
        if blend and self.deviation_bounds is None:
            raise InputError(
                "`blend` is True, but the plan kept no margin that corners can be cut by; plan with margin=0.005 [m]."
            )
        path = motion_path(self.model, self.points, self.deviation_bounds if blend else None)
        return time_optimal(path, self.model, velocity=velocity, acceleration=acceleration, torque=torque)

    def __repr__(self) -> str:
        if not self:
            return f"<no plan: {self.reason}>"
        proved = "certified" if self.is_certified else "not certified"
        milliseconds = 1e3 * sum(self.seconds.values())
        return f"<plan of {len(self.points)} points, length {self.cost:.3g}, {proved}, {milliseconds:.3g} ms>"
