"""Parameters of a model that can be replaced: their names and values, and the model with other values.

| name | what it holds | shape | unit |
|---|---|---|---|
| "inertia" | the ten dynamic parameters of each joint's body, see inertial.py | (10 nbodies) | [kg, kg m, kg m^2] |
| "placement" | for each joint, displacement of its fixed frame: shift d, rotation vector w | (njoints, 6) | [m, rad] |
| "shift" | d of each joint alone, w = 0: other lengths of links, at less cost | (njoints, 3) | [m] |
| "base" | displacement of the whole robot in the world | (6) | [m, rad] |
| "tool", "frame:NAME" | displacement of a frame that was added to the model | (6) | [m, rad] |
| "offset" | what is added to the entries of q that are plain angles and lengths | (noffsets) | [rad], [m] |
| "gravity" | acceleration of free fall in the world frame | (3) | [m/s^2] |
| "armature", "damping", "friction" | of the drives, those of mimic joints included | (nv) | see `Joint` |

The pose of a displaced frame is T' = T Trans(d) Exp(w), where T is its pose in the model: d and w are written in its
own axes as the model has them. The displaced base is at Trans(d) Exp(w) T, in the axes of the world. Six numbers reach
every error; that poses cannot distinguish all of them (a shift along the axis of a revolute joint, or a turn about it,
is also one of the next joint) is left to the estimator. Source: Mooring, Roth & Driels, Fundamentals of Manipulator
Calibration (1991), chapter 2.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any, final

import numpy as np

from ulna.checks.arrays import batched_array
from ulna.checks.values import flag, short_repr
from ulna.data_classes import dataclass
from ulna.errors import InputError, ShapeError, UnknownName
from ulna.model.change import with_gravity, with_root_joint
from ulna.model.inertial import (
    dynamic_parameters,
    with_drive_values,
    with_dynamic_parameters,
    with_joint_dynamics,
)
from ulna.model.joints import Composite, Fixed, JointKind
from ulna.model.joints.axes import snap_pose
from ulna.model.model import Model
from ulna.model.parts import Frame, Joint
from ulna.numeric import is_symbolic, matrix
from ulna.spatial import SE3, so3_exp
from ulna.typing import Array, Floats

_OF_FRAME = "frame:"
_OF_DRIVES = ("armature", "damping", "friction")
_NAMES = ("base", "placement", "shift", "offset", "tool", "inertia", "gravity", *_OF_DRIVES)
"""In the order in which they take effect: T = base T Trans(d) Exp(w) Trans(shift) J(offset)."""


def parameter_names(model: Model) -> tuple[str, ...]:
    """Names of the parameters that `with_parameters` and kernels take."""
    return (*_NAMES, *(_OF_FRAME + frame.name for frame in model.frames if _is_added(frame)))


def parameters(model: Model, name: str) -> Floats:
    """The value that a parameter has in a model: replacing it by this changes nothing.

    Args:
        model: The model.
        name: "inertia", "placement", "shift", "offset", "base", "tool", "frame:NAME" of a frame that was added to the
            model, "gravity", "armature", "damping" or "friction".

    Returns:
        A new array (...) of the parameter's shape.

    Raises:
        UnknownName: no parameter of that name; offers the nearest one.
        InputError: the tool, or the frame, is that of a link or a joint.
    """
    if name == "inertia":
        return dynamic_parameters(model)
    if name == "placement":
        return np.zeros((len(model.joints), 6))
    if name == "shift":
        return np.zeros((len(model.joints), 3))
    if name == "offset":
        return np.zeros(len(offset_entries(model)))
    if name in ("gravity", *_OF_DRIVES):
        return np.array(getattr(model, name))
    if name != "base":
        _added_frame(model, name)
    return np.zeros(6)


def offset_entries(model: Model) -> tuple[int, ...]:
    """Which entries of q have an offset: those that are no quaternion, and no place on a plane or in space."""
    starts = ((joint.idx_q, joint.kind) for joint in model.joints if joint.mimic is None)
    return tuple(start + k for start, kind in starts for k in _additive_coordinates(kind))


def with_parameters(model: Model, values: Mapping[str, Any], *, check: bool = True) -> Model:
    """The model with other parameters, or, inside a function that is traced, with parameters that are not known yet.

    `q` keeps its meaning: limits and named configurations stay as they are, also under an "offset". A body keeps its
    inertia in its own axes when a placement changes. A traced model is good for one trace: algorithms accept it, it
    cannot be hashed, compared or saved.

    Args:
        model: The model.
        values: Parameters by name, of the shapes that `parameters` returns.
        check: Whether to refuse bodies that cannot exist; see `with_dynamic_parameters`.

    Returns:
        A new model.

    Raises:
        UnknownName: no parameter of that name.
        ShapeError, NonFiniteError, InputError, ModelError: a value cannot be what it stands for.
    """
    if not isinstance(values, Mapping):
        raise InputError(
            f"`values` is {short_repr(values)}; expected a dictionary from names of parameters to arrays."
        )
    flag("check", check)
    checked_values = {name: _checked(model, name, value) for name, value in values.items()}
    for name in sorted(checked_values, key=parameter_names(model).index):
        value = checked_values[name]
        if is_symbolic(value) or (value != parameters(model, name)).any():
            model = _with_parameter(model, name, value, check)
    return model


def _with_parameter(model: Model, name: str, value: Array, check: bool) -> Model:
    traced = is_symbolic(value)
    if name == "inertia":
        if not traced:
            return with_dynamic_parameters(model, value, check=check)
        bodies: Any = tuple(_Body(value[k : k + 10]) for k in range(0, len(value), 10))
        return replace(model, inertias=bodies)
    if name == "placement":
        return _moved_joints(model, [_displacement(x) for x in value])
    if name == "shift":
        return _moved_joints(model, [SE3(np.eye(3), x) for x in value])
    if name == "base":
        return _moved_base(model, _displacement(value))
    if name == "offset":
        return _with_offsets(model, value)
    if name == "gravity":
        return replace(model, gravity=value) if traced else with_gravity(model, value)
    if name in _OF_DRIVES:
        return (
            with_drive_values(model, name, value) if traced else with_joint_dynamics(model, **{name: value})
        )
    chosen = _added_frame(model, name)
    D = _displacement(value)
    moved = replace(chosen, placement=_snapped(chosen.placement @ D), origin=_snapped(chosen.origin @ D))
    return replace(model, frames=tuple(moved if frame is chosen else frame for frame in model.frames))


def _checked(model: Model, name: str, value: Any) -> Array:
    shape = parameters(model, name).shape
    array = batched_array(name, value, shape)
    if array.shape != shape:
        fix = "One model has one value; for a batch of models ask a kernel: robot.kernel(..., parameters=(...,))."
        raise ShapeError(name, array.shape, str(shape), fix)
    return array


# frames and placements -----------------------------------------------------------------------------------------


def _displacement(x: Array) -> SE3:
    """Trans(d) Exp(w)."""
    return SE3(so3_exp(x[3:]), x[:3])


def _snapped(pose: SE3) -> SE3:
    return pose if is_symbolic(pose.rotation, pose.translation) else snap_pose(pose)


def _is_added(frame: Frame) -> bool:
    return frame.kind in ("user", "tool")


def _added_frame(model: Model, name: str) -> Frame:
    """The frame that "tool" or "frame:NAME" moves."""
    if name != "tool" and not name.startswith(_OF_FRAME):
        raise UnknownName("parameter of a model", name, parameter_names(model))
    frame = model.frame(model.tool if name == "tool" else name.removeprefix(_OF_FRAME))
    if not _is_added(frame):
        raise InputError(
            f"Parameter {name!r} is to move {frame.name!r}, the frame of a {frame.kind.replace('_', ' ')}; only frames "
            f"that were added can be moved. Put one there: robot.with_tool({frame.name!r}, SE3.identity(), 'my_tool')."
        )
    return frame


def _moved_joints(model: Model, displacements: list[SE3]) -> Model:
    joints = tuple(
        replace(joint, placement=_snapped(joint.placement @ D))
        for joint, D in zip(model.joints, displacements, strict=True)
    )
    of_joint = dict(zip(model.joint_names, displacements, strict=True))
    links = tuple(
        replace(link, origin=_snapped(link.origin @ of_joint[link.parent_joint]))
        if link.parent_joint in of_joint
        else link
        for link in model.links
    )
    return replace(model, joints=joints, links=links)


def _moved_base(model: Model, D: SE3) -> Model:
    root = model.links[0]
    if root.joint < 0 and not is_symbolic(D.translation):
        name = root.parent_joint or "root_joint"
        return with_root_joint(model, Fixed(), name, D @ root.origin, offset=root.offset)

    def moved(item: Any) -> Any:
        on_world = item.parent < 0 if isinstance(item, Joint) else item.joint < 0
        return replace(item, placement=_snapped(D @ item.placement)) if on_world else item

    joints, links, frames = (tuple(moved(x) for x in xs) for xs in (model.joints, model.links, model.frames))
    links = (replace(links[0], origin=_snapped(D @ root.origin)), *links[1:])
    return replace(model, joints=joints, links=links, frames=frames)


# offsets of the coordinates ------------------------------------------------------------------------------------


def _additive_coordinates(kind: JointKind) -> Iterator[int]:
    """Which coordinates of a kind simply add up."""
    if kind.is_vector:
        yield from range(kind.nq)
    elif isinstance(kind, Composite):
        start = 0
        for part in kind.kinds:
            yield from (start + k for k in _additive_coordinates(part))
            start += part.nq


def _with_offsets(model: Model, value: Array) -> Model:
    expanded = np.zeros(model.nq, dtype=value.dtype)
    expanded[list(offset_entries(model))] = value
    parts = [expanded[joint.idx_q : joint.idx_q + joint.kind.nq] for joint in model.joints]
    if is_symbolic(value):
        joints = (_Shifted(**vars(joint), zero=zero) for joint, zero in zip(model.joints, parts, strict=True))
        return replace(model, joints=tuple(joints))
    displacements = []
    for joint, zero in zip(model.joints, parts, strict=True):
        if len(joint.kind.elementary_joints(joint.placement)) > 1 and zero.any():
            raise InputError(
                f"An offset of joint {joint.name!r} ({joint.kind.describe()}) cannot be made part of a model; add it "
                'to q, or ask a kernel with parameters=("offset",).'
            )
        ratio = 1.0 if joint.mimic is None else joint.mimic.multiplier
        displacements.append(_offset_pose(joint.kind, ratio * zero) if zero.any() else SE3.identity())
    return _moved_joints(model, displacements)


def _offset_pose(kind: JointKind, zero: Array) -> SE3:
    """J(zero) as a pose before the joint; the only kind of a composite has a placement, which stays before it."""
    return kind.transform(zero) @ kind.transform(0.0 * zero).inverse()


@final
@dataclass(frozen=True)
class _Shifted(Joint):
    """A joint whose position is not quite q; for one trace."""

    zero: Array

    def q_of(self, q: Array) -> Array:
        shifted = q[..., self.idx_q : self.idx_q + self.kind.nq] + self.zero
        return shifted if self.mimic is None else self.mimic.multiplier * shifted + self.mimic.offset


# inertias ------------------------------------------------------------------------------------------------------


@final
@dataclass(frozen=True, eq=False)
class _Body:
    """A body described by its ten parameters, as an `Inertia` answers; for one trace. It never divides by its mass."""

    numbers: Array

    @property
    def mass(self) -> Any:
        return self.numbers[0]

    def first_moment(self) -> Array:
        return self.numbers[1:4]

    def about_origin(self) -> Array:
        xx, xy, yy, xz, yz, zz = self.numbers[4:]
        return matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
