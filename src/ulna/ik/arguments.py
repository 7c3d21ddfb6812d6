"""Arguments of inverse kinematics, checked: frames, masks, joints, goals, tolerances and seeds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NoReturn

import numpy as np

from ulna.checks.arrays import batched_array, batched_shape, real_array
from ulna.checks.rotations import checked_rotation
from ulna.checks.values import count, short_repr
from ulna.errors import InputError, ShapeError, UnknownName
from ulna.ik.deferred import goals_of_frames
from ulna.ik.goal import Mask, mask_of
from ulna.ik.problem import Problem
from ulna.lazy import is_deferred
from ulna.model import Model
from ulna.numeric import is_symbolic
from ulna.typing import Floats

DEFAULT_STARTS = ("rest", "home", "ready", "qr", "half_sitting", "standing")
"""Names of configurations that a search starts from, the first that the robot has."""


def named_goals(
    T: Any, frame: Any, mask: Any, tool: str
) -> tuple[Any, tuple[str, ...], tuple[Any, ...] | None]:
    """Goals, names of their frames and their masks, from the arguments `T`, `frame` and `mask` of `robot.ik`.

    Args:
        T: The argument `T`: poses, or a dictionary of them by frame.
        frame: The argument `frame`: a name, several, or None.
        mask: The argument `mask`.
        tool: Name of the frame that stands for None.

    Returns:
        Goals, names of the frames, and a mask for each; None for whole poses.

    Raises:
        InputError: If `T` or `frame` is empty, or `frame` is given beside a dictionary.
    """
    if isinstance(T, Mapping):
        if frame is not None:
            raise InputError(f"`T` names the frames {list(T)}, so `frame` must be None; it is {frame!r}.")
        if not T:
            raise InputError("`T` is an empty dictionary; expected a pose for at least one frame.")
        names = tuple(T)
        if any(is_deferred(goal) for goal in T.values()):
            T = goals_of_frames(T) if len(T) > 1 else T[names[0]]
            return T, names, _masks(mask, names)
        T = _side_by_side(T, _masks(mask, names)) if len(T) > 1 else matrix_of(T[names[0]])
    elif isinstance(frame, (list, tuple)) or (isinstance(frame, np.ndarray) and frame.ndim):
        names: tuple[Any, ...] = tuple(frame)
        if not names:
            raise InputError("`frame` is empty; expected the name of a frame, or several.")
        if len(names) == 1 and not is_deferred(T):
            T = matrix_of(T)
            T = T[..., 0, :, :] if T.ndim > 2 and T.shape[-3] == 1 else T
    else:
        names = (frame,)
    if not all(name is None or isinstance(name, str) for name in names):
        raise InputError(
            f"`frame` is {short_repr(frame)}; expected the name of a frame, a list of names, or None."
        )
    names = tuple(tool if name is None else name for name in names)
    return T, names, _masks(mask, names)


def _masks(mask: Any, names: Sequence[str]) -> tuple[Mask, ...] | None:
    """The mask of each frame; None where no mask is given."""
    if mask is None:
        return None
    if isinstance(mask, np.ndarray):
        mask = mask.tolist()
    if isinstance(mask, Mapping):
        for key in mask:
            if key not in names:
                raise UnknownName("frame of `mask`", key, names)
        return tuple(mask_of(mask.get(name, "pose")) for name in names)
    if not isinstance(mask, (list, tuple)) or all(isinstance(m, (int, float, np.generic)) for m in mask):
        return (mask_of(mask),) * len(names)
    if len(mask) != len(names):
        raise InputError(f"`mask` has {len(mask)} entries for {len(names)} frames; expected one for each.")
    return tuple(mask_of(m) for m in mask)


def _side_by_side(goals: Mapping[Any, Any], masks: tuple[Mask, ...] | None) -> Floats:
    """The goals of several frames as (..., k, 4, 4)."""
    poses = []
    for (name, goal), mask in zip(goals.items(), masks or [Mask()] * len(goals), strict=True):
        array = matrix_of(goal)
        pose = _pose_of_part(f"T[{name!r}]", array, mask)
        poses.append(
            batched_array(f"T[{name!r}]", array if pose is None else pose, (4, 4), _advice(array.shape))
        )
    try:
        return np.stack(np.broadcast_arrays(*poses), axis=-3)
    except ValueError:
        shapes = ", ".join(f"{name!r} {pose.shape}" for name, pose in zip(goals, poses, strict=True))
        raise InputError(f"`T` has poses whose leading axes do not broadcast: {shapes}.") from None


def default_start(problem: Problem) -> Floats:
    """The configuration a search without `q0` starts from: a named one, or neutral, or the middle of the limits.

    All of it is within the limits, for the joints that do not move stay there.
    """
    model = problem.model
    lower, upper = problem.limits
    for name in DEFAULT_STARTS:
        if name in model.configurations:
            return np.clip(model.configurations[name], lower, upper)
    q = model.neutral.copy()
    low, high = problem.range
    inside = (q[problem.drawn] >= low) & (q[problem.drawn] <= high)
    q[problem.drawn] = np.where(inside, q[problem.drawn], 0.5 * (low + high))
    return np.clip(q, lower, upper)


def problem_of(
    model: Model,
    frames: Sequence[str],
    masks: Sequence[Mask] | None,
    joints: Sequence[str] | None,
    **options: Any,
) -> Problem:
    """The problem of bringing `frames` to goals, of which `masks` count, by `joints`; see `robot.ik`.

    Args:
        model: The robot.
        frames: Names of the frames.
        masks: What counts of each pose; None for whole poses.
        joints: Names of the joints that may move; None for all that carry the frames.
        **options: Other fields of `Problem`.

    Returns:
        The problem.

    Raises:
        UnknownName, InputError: If there is no such frame or joint, or too few joints for what counts.
    """
    carried = tuple(model.frame(name) for name in frames)
    if len({model.frame_index(name) for name in frames}) < len(carried):
        raise InputError(f"`frame` names {list(frames)}; a frame can have one goal only.")
    movable = sorted({i for f in carried for i in model.support(f.joint)})
    movable = sorted({model.joint_index(_source(model, i)) for i in movable})
    if joints is not None:
        allowed = {model.joint_index(name) for name in joints}
        followers = [name for name in joints if model.joint(name).mimic is not None]
        if followers:
            raise InputError(f"`joints` names {followers[0]!r}, which follows another joint; name that one.")
        movable = [i for i in movable if i in allowed]
    if not movable:
        raise InputError(f"No movable joint moves {', '.join(f.name for f in carried)}.")
    problem = Problem(model, carried, tuple(masks or [Mask()] * len(carried)), tuple(movable), **options)
    n = len(problem.velocities)
    if masks is None and problem.rows > n:
        raise InputError(
            f"{', '.join(f.name for f in carried)} is moved by {n} joint coordinates, too few for all {problem.rows} "
            'directions of its goal. Say what counts: mask="position", mask="position+z" (and where the tool\'s z axis '
            'points), mask="z", or six weights (x, y, z, rx, ry, rz). mask="pose" requires all six anyway. '
            'For a plan: ulna.planning.Region(T, turns="z") keeps the z axis, Region(point, turns="any") the point.'
        )
    return problem


def _source(model: Model, index: int) -> str:
    """Name of the joint that moves joint `index`: itself, or the one it follows."""
    joint = model.joints[index]
    if joint.mimic is None:
        return joint.name
    return next(j.name for j in model.joints if j.mimic is None and j.idx_v == joint.idx_v)


def matrix_of(T: Any) -> Any:
    """Goals as an array, out of an array, a list, or whatever has a method `matrix`.

    Raises:
        InputError: If a list has rows of different lengths.
    """
    return real_array(
        "T", T.matrix() if hasattr(T, "matrix") else T, shape="(..., 4, 4)", is_symbol=is_symbolic
    )


def _pose_of_part(name: str, T: Any, mask: Mask) -> Floats | None:
    """Poses (..., 4, 4) of points (..., 3) where positions alone count, or of rotations (..., 3, 3) where these do.

    None where `T` is something else, or more of the pose counts.

    Raises:
        DtypeError, NonFiniteError, InputError: If the points or rotations are no finite numbers, or no rotations.
    """
    turns = mask.axis is not None or any(mask.rotation)
    if T.shape[-1:] == (3,) and not turns:
        point = batched_array(name, T, (3,))
        pose = np.broadcast_to(np.eye(4), (*point.shape[:-1], 4, 4)).copy()
        pose[..., :3, 3] = point
        return pose
    if T.shape[-2:] == (3, 3) and not any(mask.position):
        rotation = checked_rotation(name, T, "ulna.spatial.nearest_rotation(R)")
        pose = np.broadcast_to(np.eye(4), (*rotation.shape[:-2], 4, 4)).copy()
        pose[..., :3, :3] = rotation
        return pose
    return None


def poses_of_parts(T: Any, problem: Problem) -> Floats | None:
    """Poses of points or rotations that are goals of all frames of a problem, where nothing else counts.

    Args:
        T: Points (..., 3) or rotations (..., 3, 3), of one frame or (..., k, 3) and (..., k, 3, 3) of k.
        problem: The problem.

    Returns:
        Poses (..., 4, 4), or (..., k, 4, 4) for k frames; None where `T` is something else.
    """
    kinds = {(mask.axis is not None or any(mask.rotation), any(mask.position)) for mask in problem.masks}
    if len(kinds) > 1:  # of one frame a point counts, of another a rotation; a dictionary can express this
        return None
    poses = _pose_of_part("T", T, problem.masks[0])
    core = problem.shapes["T"]
    return poses if poses is not None and poses.shape[poses.ndim - len(core) :] == core else None


def check_goal_shape(T: Any, problem: Problem) -> None:
    """Raises if goals have the shape of a point, a rotation, or a position with angles, and says how to make a
    pose.

    Args:
        T: The goals.
        problem: The problem, which says what shape they should have.

    Raises:
        ShapeError: If they do not.
    """
    core = problem.shapes["T"]
    shape = np.shape(T)
    advice = _advice(shape)
    if advice and shape[len(shape) - len(core) :] != core:
        raise ShapeError("T", shape, batched_shape(core), advice)


def _advice(shape: tuple[int, ...]) -> str:
    """What makes a pose of an array of that shape."""
    if shape[-2:] == (3, 3):
        return (
            'A rotation alone is a goal of mask="rotation"; `SE3.from_rotation(R, translation)` makes a pose.'
        )
    if shape[-1:] == (3,):
        return 'A point alone is a goal of mask="position"; `SE3.from_translation(T)` makes a pose.'
    if shape[-1:] == (7,):
        return "`SE3.from_quat_xyzw(T[3:], T[:3])` makes a pose of a position and a quaternion x, y, z, w."
    if shape[-1:] == (6,):
        return "`SE3.from_rpy(T[3:], T[:3])` makes a pose of a position and roll, pitch, yaw."
    return ""


def raise_invalid_pose(T: Floats, name: str = "T") -> NoReturn:
    """Raises an error that explains what is wrong with goals that are no poses.

    Args:
        T: The goals, shape (..., 4, 4) [m].
        name: The name of the argument.

    Raises:
        InputError: Always.
    """
    checked_rotation(name, T[..., :3, :3], "ulna.spatial.nearest_rotation(R)")
    rows = T[..., 3, :].reshape(-1, 4)
    wrong = rows[(rows != (0.0, 0.0, 0.0, 1.0)).any(axis=1)][0]
    hint = "" if T[..., :3, 3].any() else " The matrix looks transposed."
    raise InputError(f"`{name}` has the last row {wrong.tolist()}; expected [0, 0, 0, 1].{hint}")


def check_batch_axes(T: Any, q0: Any, problem: Problem) -> None:
    """Checks that the leading axes of goals and `q0` broadcast.

    Args:
        T: The goals.
        q0: Configurations to start from, or None.
        problem: The problem.

    Raises:
        ShapeError: If they do not.
    """
    if q0 is None:
        return
    batch = np.shape(T)[: np.ndim(T) - len(problem.shapes["T"])]
    try:
        np.broadcast_shapes(batch, np.shape(q0)[:-1])
    except ValueError:
        hint = f"`T` has shape {np.shape(T)}."
        raise ShapeError("q0", np.shape(q0), f"leading axes that broadcast with {batch}", hint) from None


def check_tolerances(position: Any, rotation: Any) -> None:
    """Checks that tolerances are finite and above 0.

    Args:
        position: Tolerance of the position [m].
        rotation: Tolerance of the rotation [rad].

    Raises:
        InputError: If they are not.
    """
    tolerances = {
        "position_tolerance": (position, "length above 0 in metres"),
        "rotation_tolerance": (rotation, "angle above 0 in radians"),
    }
    for name, (value, expected) in tolerances.items():
        if not (isinstance(value, (int, float, np.number)) and 0.0 < value < float("inf")):
            raise InputError(f"`{name}` is {value!r}; expected a {expected}.")


def shift_of(seed: Any, problem: Problem) -> Floats:
    """Where the sequence of starting points begins, (len(drawn),) of [0, 1).

    Args:
        seed: A whole number, 0 or more.
        problem: The problem, whose coordinates are drawn.

    Returns:
        Numbers (d,) of [0, 1), one for each of `problem.drawn`.

    Raises:
        InputError: If `seed` is no whole number, 0 or more: what is drawn is drawn again.
    """
    count("seed", seed, least=0)
    return np.random.default_rng(seed).random(len(problem.drawn))
