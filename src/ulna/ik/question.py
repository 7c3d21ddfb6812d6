"""What users ask of inverse kinematics, understood: frames, masks, joints, goals and their errors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NoReturn

import numpy as np

from ulna.errors import InputError, UnknownName
from ulna.ik.goal import mask_of
from ulna.ik.problem import Problem
from ulna.model import Model
from ulna.spatial.check import checked_rotation
from ulna.typing import Floats

REST = ("rest", "home", "ready", "qr", "half_sitting", "standing")
"""Names of configurations that a search sets out from, the first that the robot has."""


def named_goals(T: Any, frame: Any, mask: Any) -> tuple[Any, tuple[str | None, ...], tuple[Any, ...] | None]:
    """Goals, names of their frames and their masks, out of what users may pass: see `robot.ik`."""
    if isinstance(T, Mapping):
        if frame is not None:
            raise InputError(f"`T` names the frames {list(T)}, so `frame` must be None; it is {frame!r}.")
        if not T:
            raise InputError("`T` is an empty dictionary; expected a pose for at least one frame.")
        names = tuple(T)
        T = (
            np.stack([matrix_of(pose) for pose in T.values()], axis=-3)
            if len(T) > 1
            else matrix_of(T[names[0]])
        )
    elif isinstance(frame, (list, tuple)):
        names = tuple(frame)
        if not names:
            raise InputError("`frame` is empty; expected the name of a frame, or several.")
        if len(names) == 1:
            T = matrix_of(T)
            T = T[..., 0, :, :] if T.ndim > 2 and T.shape[-3] == 1 else T
    else:
        names = (frame,)
    several = isinstance(mask, Mapping) or (
        isinstance(mask, (list, tuple)) and any(not isinstance(m, (int, float)) for m in mask)
    )
    if mask is None:
        return T, names, None
    if not several:
        return T, names, (_key(mask),) * len(names)
    if isinstance(mask, Mapping):
        for key in mask:
            if key not in names:
                raise UnknownName("frame of `mask`", key, [str(n) for n in names])
        return T, names, tuple(_key(mask.get(name, "pose")) for name in names)
    if len(mask) != len(names):
        raise InputError(f"`mask` has {len(mask)} entries for {len(names)} frames; expected one for each.")
    return T, names, tuple(_key(m) for m in mask)


def rest(problem: Problem) -> Floats:
    """The configuration a search without `q0` sets out from: a named one, or neutral, or the middle of the limits."""
    model = problem.model
    for name in REST:
        if name in model.configurations:
            return np.array(model.configurations[name])
    q = model.neutral.copy()
    low, high = problem.range
    inside = (q[problem.drawn] >= low) & (q[problem.drawn] <= high)
    q[problem.drawn] = np.where(inside, q[problem.drawn], 0.5 * (low + high))
    return q


def problem_of(
    model: Model,
    frames: Sequence[str],
    masks: Sequence[Any] | None,
    joints: Sequence[str] | None,
    **options: Any,
) -> Problem:
    """The problem of bringing `frames` to goals, of which `masks` count, by `joints`; see `robot.ik`.

    Raises:
        UnknownName, InputError: If there is no such frame or joint, or too few joints for what counts.
    """
    found = tuple(model.frame(name) for name in frames)
    if len({f.name for f in found}) < len(found):
        raise InputError(f"`frame` names {list(frames)}; a frame can have one goal only.")
    moved = sorted({i for f in found for i in model.support(f.joint)})
    moved = sorted({model.joint_index(_source(model, i)) for i in moved})
    if joints is not None:
        allowed = {model.joint_index(name) for name in joints}
        followers = [name for name in joints if model.joint(name).mimic is not None]
        if followers:
            raise InputError(f"`joints` names {followers[0]!r}, which follows another joint; name that one.")
        moved = [i for i in moved if i in allowed]
    if not moved:
        raise InputError(f"No joint that may move carries {', '.join(f.name for f in found)}.")
    chosen = tuple(mask_of(m) for m in masks or ["pose"] * len(found))
    problem = Problem(model, found, chosen, tuple(moved), **options)
    n = len(problem.velocities)
    if masks is None and problem.rows > n:
        raise InputError(
            f"{', '.join(f.name for f in found)} is moved by {n} joint coordinates, too few for all {problem.rows} "
            'directions of its goal. Say what counts: mask="position", mask="position+z" (and where the tool\'s z axis '
            'points), mask="z", or six weights (x, y, z, rx, ry, rz). mask="pose" asks for the whole pose all the same.'
        )
    return problem


def _source(model: Model, index: int) -> str:
    """Name of the joint that moves joint `index`: itself, or the one it follows."""
    joint = model.joints[index]
    if joint.mimic is None:
        return joint.name
    return next(j.name for j in model.joints if j.mimic is None and j.idx_v == joint.idx_v)


def matrix_of(T: Any) -> Any:
    """Goals as an array, out of an array, a list, or whatever has a method `matrix`."""
    return np.asarray(T.matrix() if hasattr(T, "matrix") else T)


def refuse(T: Floats) -> NoReturn:
    """Says what is wrong with goals that are no poses.

    Raises:
        InputError: Always.
    """
    checked_rotation("T", T[..., :3, :3], "ulna.spatial.nearest_rotation(R)")
    rows = T[..., 3, :].reshape(-1, 4)
    wrong = rows[(rows != (0.0, 0.0, 0.0, 1.0)).any(axis=1)][0]
    mend = "" if T[..., :3, 3].any() else " The matrix looks transposed."
    raise InputError(f"`T` has the last row {wrong.tolist()}; expected [0, 0, 0, 1].{mend}")


def _key(mask: Any) -> Any:
    return tuple(mask) if isinstance(mask, (list, np.ndarray)) else mask


def check_tolerances(position: Any, rotation: Any) -> None:
    """Refuses tolerances that are no lengths above 0."""
    tolerances = {
        "position_tolerance": (position, "length above 0 in metres"),
        "rotation_tolerance": (rotation, "angle above 0 in radians"),
    }
    for name, (value, expected) in tolerances.items():
        if not (isinstance(value, (int, float, np.number)) and 0.0 < value < float("inf")):
            raise InputError(f"`{name}` is {value!r}; expected a {expected}.")


def check_count(name: str, value: Any) -> None:
    """Refuses what is no whole number above 0."""
    if not isinstance(value, (int, np.integer)) or value < 1:
        raise InputError(f"`{name}` is {value!r}; expected a whole number, 1 or more.")
