"""Goals of planning: configurations, or poses, points and regions that configurations are searched for."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any, Literal, NamedTuple, final

import numpy as np

from ulna.checks.arrays import finite_array, real_array
from ulna.checks.rotations import checked_rotation
from ulna.data_classes import dataclass
from ulna.errors import InputError, ShapeError, UnknownName
from ulna.ik.arguments import raise_invalid_pose
from ulna.ik.result import IKSolution
from ulna.model import Model
from ulna.planning.stop import STOP
from ulna.spatial import SE3
from ulna.spatial.se3 import read_only
from ulna.typing import ArrayLike, Floats

_ATTEMPTS = 12  # different starts from which a pose is solved
_SEARCHES = 64  # from each, before it is given up
_TURNS = ("none", "x", "y", "z", "any")
_POSITION = 'A position that a frame is to reach, however it is turned, is Region(position, turns="any").'

Turns = Literal["none", "x", "y", "z", "any"]


@final
@dataclass(frozen=True, eq=False)
class Region:
    """Poses that a goal allows: a box of positions, and turns about an axis of the frame or about all.

    Args:
        pose: T_world_middle, the middle and the axes of the box, and how the frame is turned: an SE3, (4, 4), or a
            position, shape (3,) [m].
        size: Full edges of the box along these axes, shape (3,) [m]; zeros for a point, inf where a `PathConstraint`
            leaves the position free.
        turns: About which of its own axes the frame may turn: "x", "y", "z", "any" for all, "none".

    Raises:
        ShapeError: If `pose` is none.
        InputError, DtypeError: If `size` is no box.
        UnknownName: If `turns` is none of these.

    Example:
        >>> from ulna.planning import Region
        >>> robot = ulna.load("panda")
        >>> q = robot.configurations["ready"]
        >>> anyhow = Region((0.4, 0.2, 0.4), turns="any")  # a point, turned in any way
        >>> bool(robot.plan(q, anyhow))
        True
    """

    pose: SE3
    size: Floats
    turns: Turns

    def __init__(
        self, pose: SE3 | ArrayLike, size: ArrayLike = (0.0, 0.0, 0.0), turns: Turns = "none"
    ) -> None:
        matrix = pose.matrix() if isinstance(pose, SE3) else finite_array("pose", pose)
        if matrix.shape not in ((3,), (4, 4)):
            raise ShapeError("pose", matrix.shape, "an SE3, (4, 4), or a position (3,)")
        edges = np.array(real_array("size", size), dtype=float)
        if edges.shape != (3,) or not (edges >= 0.0).all():
            raise InputError(f"`size` is {size!r}; expected three edges of a box, not below 0 [m].")
        if turns not in _TURNS:
            raise UnknownName("value of `turns`", turns, _TURNS)
        goal_pose = SE3.from_translation(matrix) if matrix.shape == (3,) else SE3.from_matrix(matrix)
        edges.setflags(write=False)
        for name, value in (("pose", read_only(goal_pose)), ("size", edges), ("turns", turns)):
            object.__setattr__(self, name, value)

    @property
    def mask(self) -> Any:
        """What inverse kinematics has to meet."""
        return {"none": None, "any": "position"}.get(self.turns, f"position+{self.turns}")

    def targets(self, count: int, seed: int) -> Floats:
        """Poses whose positions fill the box, its middle first.

        Args:
            count: How many.
            seed: Which.

        Returns:
            Poses, shape (count, 4, 4) [m].

        Raises:
            InputError: If the box has no ends.
        """
        if not np.isfinite(self.size).all():
            raise InputError(f"The goal's `size` is {self.size.tolist()}; a goal needs finite edges.")
        poses = np.repeat(self.pose.matrix()[None], count, axis=0)
        offsets = (np.random.default_rng([seed, 4]).random((count, 3)) - 0.5) * self.size
        offsets[0] = 0.0
        poses[:, :3, 3] += offsets @ self.pose.matrix()[:3, :3].T
        return poses


class Goals(NamedTuple):
    """The configurations that goals allow.

    Attributes:
        configurations: Shape (n, nq) [rad, m].
        numbers: The number of the goal that each reaches, (n,).
        reason: What inverse kinematics says of a pose that it could not reach, where there are no configurations.
        seconds: How long inverse kinematics took, but for first calls, which may compile it [s].
        is_late: Whether it was ended before all starts were tried, because time was up.
    """

    configurations: Floats
    numbers: tuple[int, ...]
    reason: str = ""
    seconds: float = 0.0
    is_late: bool = False


def goal_configurations(
    robot: Any,
    goal: Any,
    frame: str | None,
    q0: Floats,
    seed: int,
    joints: Sequence[str] | None = None,
    timeout: float = np.inf,
) -> Goals:
    """The configurations that a goal allows.

    Args:
        robot: The robot.
        goal: A configuration (nq,), several (n, nq); a pose (SE3 or (4, 4)), several (n, 4, 4), a `Region`; a
            dictionary from frames to poses and regions, all of which are to be met at once; or a list of poses and
            regions, of which one is to be reached [rad, m].
        frame: Which frame a pose is for; None for the robot's tip.
        q0: Where the motion begins, shape (nq,) [rad, m].
        seed: Seed of the starts from which poses are solved.
        joints: Names of the joints that may move; None for all.
        timeout: How long inverse kinematics may take [s].

    Returns:
        The configurations, those of poses nearest to `q0` first; none where nothing can be reached.

    Raises:
        ShapeError: If the goal is none of these.
        InputError: If it holds nan, `frame` is given for what names frames or needs none, or joints would have to move
            that may not.
    """
    if isinstance(goal, np.ndarray):
        return _of_array(robot, goal, frame, q0, seed, joints, timeout)
    if isinstance(goal, Mapping):
        if frame is not None:
            raise InputError("`frame` and a goal that names its frames are given; expected one of them.")
        return _solved(robot, [goal], None, q0, seed, joints, timeout)
    if isinstance(goal, (list, tuple)) and any(isinstance(item, SE3 | Region) for item in goal):
        return _solved(robot, [_single(item) for item in goal], frame, q0, seed, joints, timeout)
    if isinstance(goal, Region):
        return _solved(robot, [goal], frame, q0, seed, joints, timeout)
    return _of_array(robot, goal, frame, q0, seed, joints, timeout)


def moving_columns(model: Model, joints: Sequence[str] | None) -> Any:
    """Which numbers of a configuration may change.

    Args:
        model: The robot.
        joints: Names of the joints that may move; None for all.

    Returns:
        Truth values, shape (nq,).

    Raises:
        UnknownName: If there is no such joint.
        InputError: If `joints` is no list of names, or is empty.
    """
    if joints is None:
        return np.ones(model.nq, dtype=bool)
    if isinstance(joints, str) or not len(joints):
        raise InputError(f"`joints` is {joints!r}; expected a list of names of joints that may move.")
    moving = np.zeros(model.nq, dtype=bool)
    for name in joints:
        joint = model.joints[model.joint_index(name)]
        moving[joint.idx_q : joint.idx_q + joint.kind.nq] = True
    return moving


def _single(item: Any) -> Any:
    """One goal of a list: a region or a pose."""
    if isinstance(item, Region):
        return item
    matrix = item.matrix() if isinstance(item, SE3) else finite_array("goal", item)
    if matrix.shape != (4, 4):
        raise ShapeError(
            "goal",
            matrix.shape,
            "for each pose a Region, an SE3 or (4, 4)",
            _POSITION if matrix.shape == (3,) else "",
        )
    return _checked_poses(matrix)


def _checked_poses(matrices: Floats) -> Floats:
    """The matrices, shape (..., 4, 4) [m]; raises where one is no pose."""
    checked_rotation("goal", matrices[..., :3, :3], "ulna.spatial.nearest_rotation(R)")
    if (matrices[..., 3, :] != (0.0, 0.0, 0.0, 1.0)).any():
        raise_invalid_pose(matrices, "goal")
    return matrices


def _of_array(
    robot: Any,
    goal: Any,
    frame: str | None,
    q0: Floats,
    seed: int,
    joints: Sequence[str] | None,
    timeout: float,
) -> Goals:
    """The configurations of a goal that is numbers."""
    nq = robot.model.nq
    if isinstance(goal, IKSolution):
        if not np.all(goal.success):
            raise InputError(
                f"`goal` is no configuration: {goal!r}. Plan to the pose itself, or check `.success`."
            )
        goal = goal.q
    poses = goal.matrix() if isinstance(goal, SE3) else finite_array("goal", goal)
    is_pose = poses.ndim in (2, 3) and poses.shape[-2:] == (4, 4)
    if is_pose and nq == 4 and poses.ndim == 2 and not isinstance(goal, SE3):
        raise InputError(
            "`goal` of shape (4, 4) may be a pose or four configurations. Pass SE3.from_matrix(goal) or goal[None] "
            "for a pose; plan to the configurations one by one."
        )
    if is_pose:
        return _solved(robot, list(_checked_poses(poses).reshape(-1, 4, 4)), frame, q0, seed, joints, timeout)
    if poses.shape != (nq,) and not (poses.ndim == 2 and poses.shape[1] == nq and len(poses)):
        raise ShapeError(
            "goal",
            poses.shape,
            f"a configuration ({nq},), several (n, {nq}), a pose (4, 4), several (n, 4, 4), a Region, or a list of "
            "poses and regions",
            _POSITION if poses.shape == (3,) else "",
        )
    if frame is not None:
        raise InputError(
            "`frame` says whose pose the goal is; the goal here is a configuration. Leave it out."
        )
    configurations = _with_fixed_joints(robot.model, poses.reshape(-1, nq), q0, joints)
    return Goals(configurations, tuple(range(len(configurations))))


def _with_fixed_joints(
    model: Model, configurations: Floats, q0: Floats, joints: Sequence[str] | None
) -> Floats:
    """Goals (n, nq) whose joints that may not move are exactly as in q0; raises where one is elsewhere."""
    moving = moving_columns(model, joints)
    different = (np.abs(configurations - q0) > 1e-9) & ~moving
    if different.any():
        column = int(np.argwhere(different)[0][1])
        raise InputError(
            f"The goal has {configurations[different][0]:g} for joint {joint_of_column(model, column)!r}, which is at "
            f"{q0[column]:g} and not among `joints`; expected the same value. Name it there, or leave it where it is."
        )
    return np.where(moving, configurations, q0)


def joint_of_column(model: Model, column: int) -> str:
    """The name of the joint that a number of a configuration belongs to.

    Args:
        model: The robot.
        column: Index of the number.

    Returns:
        The name.
    """
    return next(j.name for j in model.joints if j.idx_q <= column < j.idx_q + j.kind.nq)


def _solved(
    robot: Any,
    goals: Sequence[Any],
    frame: str | None,
    q0: Floats,
    seed: int,
    joints: Sequence[str] | None,
    timeout: float,
) -> Goals:
    """Different configurations for poses, nearest to q0 first."""
    random = np.random.default_rng([seed, 2])
    model = robot.model
    moving = moving_columns(model, joints)
    lower, upper = np.maximum(model.lower_position, q0 - np.pi), np.minimum(model.upper_position, q0 + np.pi)
    found, solutions = np.empty((len(goals) * _ATTEMPTS, model.nq)), list[tuple[float, int, Floats]]()
    nearest: tuple[float, IKSolution] | None = None
    free = moving
    clock = _Clock(timeout)
    for number, k, target, mask in _asked(goals, seed, clock):
        if k == 0:
            free = moving & _carrying(model, goals[number], frame)
        start = q0 if k == 0 else np.where(free, random.uniform(lower, upper), q0)
        options = {"seed": seed + k, "attempts": _SEARCHES, "mask": mask, "joints": joints}
        with clock.running(mask):
            solution = robot.ik(target, start, frame, **options)
        q = np.asarray(solution.q)
        if not solution.success:
            error = float(np.max(solution.position_error) + np.max(solution.rotation_error))
            nearest = (error, solution) if nearest is None or error < nearest[0] else nearest
        elif (np.abs(found[: len(solutions)] - q).max(axis=1) > 1e-3).all():
            found[len(solutions)] = q
            solutions.append((float(np.linalg.norm(q - q0)), number, q))
    solutions.sort(key=lambda item: item[:2])
    configurations = np.array([q for _, _, q in solutions]).reshape(-1, model.nq)
    reason = nearest[1].reason if nearest is not None and not solutions else ""
    numbers = tuple(number for _, number, _ in solutions)
    return Goals(configurations, numbers, reason, clock.seconds, clock.has_ended)


class _Clock:
    """How long inverse kinematics takes, but for the first call for each mask, which may compile it.

    Args:
        timeout: The longest time [s].
    """

    def __init__(self, timeout: float) -> None:
        self._timeout, self._known, self.seconds, self.has_ended = timeout, set[str](), 0.0, False

    def is_up(self) -> bool:
        """Whether the time is over, or the search is to end for another reason."""
        return self.seconds > self._timeout or (STOP.event is not None and STOP.event.is_set())

    @contextmanager
    def running(self, mask: Any) -> Iterator[None]:
        """Within, the clock runs."""
        begin, kind = time.perf_counter(), repr(mask)
        yield
        if kind in self._known:
            self.seconds += time.perf_counter() - begin
        self._known.add(kind)


def _asked(goals: Sequence[Any], seed: int, clock: _Clock) -> Iterator[tuple[int, int, Any, Any]]:
    """Each goal's number, for each start its number, what is asked for, and what of it counts; while there is time."""
    for number, goal in enumerate(goals):
        for k, (target, mask) in enumerate(_targets(goal, seed)):
            if clock.is_up():
                clock.has_ended = True
                return
            yield number, k, target, mask


def _carrying(model: Model, goal: Any, frame: str | None) -> Any:
    """Which numbers of a configuration move the frames of a goal, shape (nq,)."""
    names = list(goal) if isinstance(goal, Mapping) else [model.tool if frame is None else frame]
    carrying = np.zeros(model.nq, dtype=bool)
    for name in names:
        for k in model.support(model.frame(name).joint):
            joint = model.joints[k]
            carrying[joint.idx_q : joint.idx_q + joint.kind.nq] = True
    return carrying


def _targets(goal: Any, seed: int) -> Iterator[tuple[Any, Any]]:
    """What is asked of inverse kinematics, and what of it counts, once for each start."""
    if isinstance(goal, Region):
        for target in goal.targets(_ATTEMPTS, seed):
            yield target, goal.mask
        return
    if not isinstance(goal, Mapping):
        for _ in range(_ATTEMPTS):
            yield goal, None
        return
    regions = {name: T if isinstance(T, Region) else None for name, T in goal.items()}
    poses = {
        name: T.targets(_ATTEMPTS, seed) if isinstance(T, Region) else [_single(T)] * _ATTEMPTS
        for name, T in goal.items()
    }
    masks = {name: (region and region.mask) or "pose" for name, region in regions.items()}
    for k in range(_ATTEMPTS):
        yield {name: targets[k] for name, targets in poses.items()}, masks
