"""Tasks of frames: to stand at a pose, a point, an orientation, along an axis, or at a pose beside another frame.

| symbol | meaning | shape, unit | equation |
|---|---|---|---|
| T, T* | pose of the frame, and its target, in the world or in the other frame | SE3 | |
| E | the target seen from the frame | SE3 | E = T^-1 T* |
| e | error in the frame's axes | (6,), m and rad | e = log E, its end is reached by the constant twist e |
| J_b | Jacobian of the frame in "local" | (6, nv) | |
| J | how e shrinks | (6, nv) | J = J_l(e)^-1 J_b, J_l of Barfoot 2017, eq. (7.85) |
| e', J' | the same in the world's axes | | e' = (p* - p; log R* R^T), J' = diag(1, J_r(log)^-1) J_aligned |
| J_rel | Jacobian beside another frame r | (6, nv) | Ad(T_world_frame)^-1 (J_world - J_world,r) |
| a, d | an axis of the frame, the direction wanted, in the world | (3,) | e = d - a, J = -skew(a) J_angular |

With `axes="frame"` the six numbers are one logarithm on SE(3): the frame moves along a screw. With `axes="world"` point
and orientation go their own ways, the point along a straight line. Source: Siciliano 2009, section 3.7; Murray, Li,
Sastry 1994, section 2.3.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import field
from typing import Any, ClassVar, Literal, final, get_args

import numpy as np

from ulna.algorithms import frame_jacobian, frame_pose
from ulna.data_classes import dataclass
from ulna.errors import InputError, UnknownName
from ulna.ik.differential.task import Rows, Shapes, Task, cost_of
from ulna.model import Model
from ulna.numeric import apply, dot, skew, sqrt, where
from ulna.spatial import (
    SE3,
    se3_left_jacobian_inverse,
    se3_log,
    so3_left_jacobian_inverse,
    so3_log,
    so3_right_jacobian_inverse,
)
from ulna.spatial.batched import column
from ulna.typing import Array, ArrayLike, Floats

Axes = Literal["frame", "world"]
_OPPOSITE = -2.0 + 1e-9  # cosine less 1, from which on a direction counts as opposite


@dataclass(frozen=True, eq=False)
class _OfFrame(Task):
    """A task with one frame, whose target is one array."""

    frame: str
    damping: float = field(default=1.0, kw_only=True)
    _shape: ClassVar[tuple[int, ...]] = (3,)

    @property
    def _default_name(self) -> str:
        return self.frame

    @abstractmethod
    def _measured(self, model: Model, q: Array) -> Array:
        """What is to become equal to the target, at a configuration."""

    def _three_costs(self, model: Model, cost: ArrayLike) -> Floats:
        """The costs of three rows, of a frame that the model has."""
        model.frame(self.frame)
        return cost_of(cost, 3, f"{self.label}: `cost`")

    def inputs(self, model: Model) -> Shapes:
        """The target."""
        return {self.label: self._shape}

    def reached_by(self, model: Model, q: Array) -> Mapping[str, Array]:
        """The target that is reached at `q` (..., nq) [rad or m]."""
        return {self.label: self._measured(model, q)}


@final
@dataclass(frozen=True, eq=False)
class FrameTask(_OfFrame):
    """A frame shall stand at a pose, T_world_target (4, 4).

    Attributes:
        frame: Name of the frame.
        position_cost: Cost of a metre, one number or one for each axis [1/m].
        orientation_cost: Cost of a radian, one number or one for each axis [1/rad].
        axes: Whose axes those are, the "frame"'s (e is one screw) or the "world"'s (the point goes straight).
        target: A pose to use where none is passed.

    Example:
        >>> from ulna.ik import DifferentialIK, FrameTask
        >>> robot = ulna.load("panda")
        >>> q = robot.configurations["ready"]
        >>> ik = DifferentialIK(robot, [FrameTask("panda_hand", orientation_cost=0.0)])  # a point only
        >>> ik.velocity(q, 0.01, ulna.SE3(0.0, 0.0, 0.01) @ robot.fk(q, "panda_hand")).shape
        (7,)
    """

    position_cost: ArrayLike = 1.0
    orientation_cost: ArrayLike = 1.0
    axes: Axes = "frame"
    target: Any = None
    _shape: ClassVar[tuple[int, ...]] = (4, 4)

    def _measured(self, model: Model, q: Array) -> Array:
        """Where the frame stands."""
        return frame_pose(model, q, model.frame(self.frame)).matrix()

    def costs(self, model: Model) -> Floats:
        """Three for the position, three for the orientation."""
        model.frame(self.frame)
        return _six(self)

    def rows(self, model: Model, q: Array, *inputs: Array) -> Rows:
        """Six rows, the linear ones first."""
        frame, target = model.frame(self.frame), SE3.from_matrix(inputs[0], check=False)
        if _in_world(self):
            T, J = frame_pose(model, q, frame), frame_jacobian(model, q, frame)
            turn = so3_log(target.rotation @ _transposed(T.rotation))
            lower = so3_right_jacobian_inverse(turn) @ J[..., 3:, :]
            rows = np.concatenate([J[..., :3, :], lower], axis=-2)
            return Rows(rows, np.concatenate([target.translation - T.translation, turn], axis=-1))
        return _screw(frame_pose(model, q, frame), target, frame_jacobian(model, q, frame, "local"))


@final
@dataclass(frozen=True, eq=False)
class RelativeFrameTask(_OfFrame):
    """A frame shall stand at a pose beside another one, T_root_target (4, 4), wherever both are.

    Attributes:
        frame: Name of the frame.
        root: Name of the other frame.
        position_cost: Cost of a metre, in the axes of `frame` [1/m].
        orientation_cost: Cost of a radian, in the axes of `frame` [1/rad].
        target: A pose to use where none is passed.
    """

    root: str
    position_cost: ArrayLike = 1.0
    orientation_cost: ArrayLike = 1.0
    target: Any = None
    _shape: ClassVar[tuple[int, ...]] = (4, 4)

    @property
    def _default_name(self) -> str:
        return f"{self.frame}_in_{self.root}"

    def _measured(self, model: Model, q: Array) -> Array:
        """Where the frame stands beside the root."""
        root, frame = self._poses(model, q)
        return (root.inverse() @ frame).matrix()

    def costs(self, model: Model) -> Floats:
        """Three for the position, three for the orientation."""
        model.frame(self.frame)
        model.frame(self.root)
        return _six(self)

    def rows(self, model: Model, q: Array, *inputs: Array) -> Rows:
        """Six rows, the linear ones first."""
        root, frame = self._poses(model, q)
        ours, theirs = (
            frame_jacobian(model, q, model.frame(f), "world") for f in (self.frame, self.root)
        )  # columns of joints that carry both are equal, and vanish
        J = frame.inverse().adjoint() @ (ours - theirs)
        return _screw(root.inverse() @ frame, SE3.from_matrix(inputs[0], check=False), J)

    def _poses(self, model: Model, q: Array) -> tuple[SE3, SE3]:
        return frame_pose(model, q, model.frame(self.root)), frame_pose(model, q, model.frame(self.frame))


@final
@dataclass(frozen=True, eq=False)
class PositionTask(_OfFrame):
    """The origin of a frame shall be at a point of the world (3,) [m], whatever the orientation.

    Attributes:
        frame: Name of the frame.
        cost: Cost of a metre, one number or one for each axis [1/m].
        axes: Whose axes those are, the "world"'s or the "frame"'s.
        target: A point to use where none is passed.
    """

    cost: ArrayLike = 1.0
    axes: Axes = "world"
    target: Any = None

    def _measured(self, model: Model, q: Array) -> Array:
        """Where the origin is."""
        return frame_pose(model, q, model.frame(self.frame)).translation

    def costs(self, model: Model) -> Floats:
        """Three numbers."""
        return self._three_costs(model, self.cost)

    def rows(self, model: Model, q: Array, *inputs: Array) -> Rows:
        """Three rows."""
        frame = model.frame(self.frame)
        T = frame_pose(model, q, frame)
        missing = inputs[0] - T.translation
        if _in_world(self):
            return Rows(frame_jacobian(model, q, frame)[..., :3, :], missing)
        J = frame_jacobian(model, q, frame, "local")
        e = apply(_transposed(T.rotation), missing)
        return Rows(J[..., :3, :] - skew(e) @ J[..., 3:, :], e)


@final
@dataclass(frozen=True, eq=False)
class OrientationTask(_OfFrame):
    """A frame shall be turned as R_world_target (3, 3), wherever it is.

    Attributes:
        frame: Name of the frame.
        cost: Cost of a radian, one number or one for each axis [1/rad].
        axes: Whose axes those are, the "frame"'s or the "world"'s.
        target: A rotation to use where none is passed.
    """

    cost: ArrayLike = 1.0
    axes: Axes = "frame"
    target: Any = None
    _shape: ClassVar[tuple[int, ...]] = (3, 3)

    def _measured(self, model: Model, q: Array) -> Array:
        """How the frame is turned."""
        return frame_pose(model, q, model.frame(self.frame)).rotation

    def costs(self, model: Model) -> Floats:
        """Three numbers."""
        return self._three_costs(model, self.cost)

    def rows(self, model: Model, q: Array, *inputs: Array) -> Rows:
        """Three rows."""
        frame, target = model.frame(self.frame), inputs[0]
        R = frame_pose(model, q, frame).rotation
        if _in_world(self):
            e = so3_log(target @ _transposed(R))
            return Rows(so3_right_jacobian_inverse(e) @ frame_jacobian(model, q, frame)[..., 3:, :], e)
        e = so3_log(_transposed(R) @ target)
        return Rows(so3_left_jacobian_inverse(e) @ frame_jacobian(model, q, frame, "local")[..., 3:, :], e)


@final
@dataclass(frozen=True, eq=False)
class AxisTask(_OfFrame):
    """An axis of a frame shall point in a direction of the world (3,); the frame may turn about it.

    Attributes:
        frame: Name of the frame.
        axis: The axis in the frame, of any length; z by default.
        cost: Cost of a unit of the chord between axis and direction, near the target the same as a radian [1/rad].
        target: A direction, of any length but zero, to use where none is passed.
    """

    axis: ArrayLike = (0.0, 0.0, 1.0)
    cost: float = 1.0
    target: Any = None

    @property
    def _default_name(self) -> str:
        return f"{self.frame}_axis"

    def _measured(self, model: Model, q: Array) -> Array:
        """Where the axis points."""
        R = frame_pose(model, q, model.frame(self.frame)).rotation
        return apply(R, self._unit())

    def costs(self, model: Model) -> Floats:
        """The same for three rows."""
        model.frame(self.frame)
        self._unit()
        return np.full(3, cost_of(self.cost, 1, f"{self.label}: `cost`")[0])

    def rows(self, model: Model, q: Array, *inputs: Array) -> Rows:
        """Three rows of rank two, in world axes."""
        frame = model.frame(self.frame)
        a = apply(frame_pose(model, q, frame).rotation, self._unit())
        wanted = inputs[0] / column(sqrt(dot(inputs[0], inputs[0])))
        return Rows(-skew(a) @ frame_jacobian(model, q, frame)[..., 3:, :], wanted - a)

    def constraint_rows(self, model: Model, q: Array, *inputs: Array) -> Rows:
        """The same rows with the part of the chord across the axis, since no motion goes along it.

        Opposite to the target that part is 0 and shows no way: there the chord stays, which nothing meets.
        """
        J, e = self.rows(model, q, *inputs)
        a = self._measured(model, q)
        along = dot(a, e)  # cos - 1
        return Rows(J, e - a * column(where(along < _OPPOSITE, 0.0, along)))

    def _unit(self) -> Floats:
        axis = np.asarray(self.axis, dtype=float)
        length = float(np.linalg.norm(axis)) if axis.shape == (3,) else 0.0
        if not 0.0 < length < np.inf:
            raise InputError(f"{self.label}: `axis` is {self.axis}; expected three numbers, not all 0.")
        return axis / length


def _screw(T: SE3, target: SE3, local: Array) -> Rows:
    """e and J of a frame at T, with its Jacobian in "local"."""
    e = se3_log(T.inverse() @ target).vector()
    return Rows(se3_left_jacobian_inverse(e) @ local, e)


def _in_world(task: FrameTask | PositionTask | OrientationTask) -> bool:
    if task.axes not in get_args(Axes):
        raise UnknownName("axes", task.axes, get_args(Axes))
    return task.axes == "world"


def _six(task: FrameTask | RelativeFrameTask) -> Floats:
    names = ("position_cost", "orientation_cost")
    return np.concatenate([cost_of(getattr(task, n), 3, f"{task.label}: `{n}`") for n in names])


def _transposed(rotation: Array) -> Array:
    return np.swapaxes(rotation, -1, -2)
