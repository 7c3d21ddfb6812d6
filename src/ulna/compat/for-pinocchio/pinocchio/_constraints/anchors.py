"""Constraints that measure the second frame in the first: anchors of points and frames, contacts."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, final

import numpy as np

from pinocchio._constraints.cones import CoulombFrictionCone, FullSpaceCone
from pinocchio._constraints.constraint_model import AnyConstraint, AnyConstraintData, wrong_model
from pinocchio._constraints.frame_pair import ConstraintSelectionType, FramePair
from pinocchio._constraints.kernels import core_constraints, has_columns_of
from pinocchio._containers.arguments import OMITTED, ArgumentError
from pinocchio._containers.arrays import fixed, vector
from pinocchio._containers.attributes import AttributeKind, computed, entries, one_of, whole
from pinocchio._containers.enums import ReferenceFrame, reference_of
from pinocchio._containers.keywords import by_name
from pinocchio._data.data import Data
from pinocchio._data.states import compiled_for
from pinocchio._model.model import Model
from pinocchio._spatial.motion_force import skew
from pinocchio._spatial.se3 import SE3
from ulna.algorithms.constraints.frame_errors import relative_motion
from ulna.errors import InputError
from ulna.model import Model as CoreModel
from ulna.typing import Array, Floats

__all__ = [
    "FrameAnchorConstraintData",
    "FrameAnchorConstraintModel",
    "PointAnchorConstraintData",
    "PointAnchorConstraintModel",
    "PointContactConstraintData",
    "PointContactConstraintModel",
]


ANCHOR_ORDERS = (
    "model",
    "model joint1_id",
    "model joint1_id joint1_placement",
    "model joint1_id joint2_id",
    "model joint1_id joint1_placement joint2_id joint2_placement",
)


class _ConstraintState(AnyConstraintData):
    """What is known of such a constraint at a state, after its `calc`."""

    __slots__ = (
        "_J",
        "_oMc",
        "_oMi",
        "_q",
        "c1Mc2",
        "constraint_acceleration_biais_term",
        "constraint_acceleration_error",
        "constraint_force",
        "constraint_position_error",
        "constraint_velocity_error",
        "oMc1",
        "oMc2",
    )
    _kinds: ClassVar[Mapping[str, AttributeKind]] = {
        **dict.fromkeys(("oMc1", "oMc2", "c1Mc2"), one_of(SE3)),
        **dict.fromkeys([f"A{k}_{axes}" for k in ("", 1, 2) for axes in ("local", "world")], computed),
        **dict.fromkeys(("constraint_acceleration_biais_term", "constraint_force"), entries),
        **dict.fromkeys(
            [f"constraint_{name}_error" for name in ("position", "velocity", "acceleration")], entries
        ),
    }

    _rows: ClassVar[int] = 3

    def __init__(self, constraint_model: Any = OMITTED) -> None:
        if constraint_model is not OMITTED and getattr(constraint_model, "_data", None) is not type(self):
            raise wrong_model(self, constraint_model)
        m = self._rows
        self._J: Floats | None = None
        self._q: Floats | None = None
        """The Jacobian, and the configuration, when `calc` was called."""
        self._oMi: Floats | None = None
        self._oMc: list[SE3] = []
        """Both frames of the constraint in the world when `calc` was called."""
        self.constraint_acceleration_biais_term = np.zeros(m)
        self.oMc1, self.oMc2, self.c1Mc2 = SE3(), SE3(), SE3()
        self.constraint_position_error = np.zeros(m)
        self.constraint_velocity_error = np.zeros(m)
        self.constraint_acceleration_error = np.zeros(m)
        self.constraint_force = np.zeros(m)

    def _of_world(self) -> Floats:
        """The matrix (m, 6) that makes the constraint's velocity of the second joint's, both in the world."""
        if len(self.constraint_position_error) == 6:
            return self._oMc[0].toActionMatrixInverse()
        to_point = np.hstack([np.eye(3), -skew(self._oMc[1].translation)])
        return self._oMc[0].rotation.T @ to_point

    def _projection(self, end: int, rf: ReferenceFrame) -> Floats:
        """The matrix (m, 6) that makes the constraint's velocity of that of its first or second joint (0, 1)."""
        if self._oMi is None:
            return np.zeros((len(self.constraint_position_error), 6))
        placement = SE3(self._oMi[end])
        if rf == ReferenceFrame.WORLD:
            placement = SE3()
        elif rf == ReferenceFrame.LOCAL_WORLD_ALIGNED:
            placement.rotation = np.eye(3)
        return (1.0 if end else -1.0) * self._of_world() @ placement.toActionMatrix()

    @property
    def A1_local(self) -> Floats:
        """The matrix (m, 6) that makes the constraint's velocity of the first joint's in its own axes."""
        return fixed(self._projection(0, ReferenceFrame.LOCAL))

    @property
    def A2_local(self) -> Floats:
        """The same of the second joint's."""
        return fixed(self._projection(1, ReferenceFrame.LOCAL))

    @property
    def A1_world(self) -> Floats:
        """The matrix (m, 6) that makes the constraint's velocity of the first joint's in the world."""
        return fixed(self._projection(0, ReferenceFrame.WORLD))

    @property
    def A2_world(self) -> Floats:
        """The same of the second joint's."""
        return fixed(self._projection(1, ReferenceFrame.WORLD))

    @property
    def A_local(self) -> Floats:
        """The sum of `A1_local` and `A2_local`."""
        return fixed(self.A1_local + self.A2_local)

    @property
    def A_world(self) -> Floats:
        """The sum of `A1_world` and `A2_world`: zero."""
        return fixed(self.A1_world + self.A2_world)


@final
class PointAnchorConstraintData(_ConstraintState):
    """Of a PointAnchorConstraintModel."""

    __slots__ = ()


@final
class FrameAnchorConstraintData(_ConstraintState):
    """Of a FrameAnchorConstraintModel."""

    __slots__ = ()
    _rows = 6


@final
class PointContactConstraintData(_ConstraintState):
    """Of a PointContactConstraintModel."""

    __slots__ = ()


class _Anchor(FramePair, AnyConstraint):
    """`(model, joint1[, placement1[, joint2[, placement2]]])`: two frames, of which the second may be the world's."""

    __slots__ = (
        "_compliance",
        "depth_joint1",
        "depth_joint2",
        "desired_constraint_acceleration",
        "desired_constraint_offset",
        "desired_constraint_velocity",
        "nv",
    )
    _kinds: ClassVar[Mapping[str, AttributeKind]] = {
        **dict.fromkeys(("nv", "depth_joint1", "depth_joint2"), whole),
        **dict.fromkeys(
            [f"desired_constraint_{name}" for name in ("offset", "velocity", "acceleration")], entries
        ),
    }
    _binds_always = False
    _rows: ClassVar[int] = 3
    _data = PointAnchorConstraintData

    @by_name(*ANCHOR_ORDERS)
    def __init__(self, model: Model, *places: Any) -> None:
        if not isinstance(model, Model):
            raise ArgumentError(f"The model is {model!r}; expected a pinocchio.Model.")
        kinds = "".join("M" if isinstance(place, SE3) else "j" for place in places)
        if kinds not in ("", "j", "jM", "jj", "jMjM"):
            raise ArgumentError(
                f"{type(self).__name__} was given {len(places)} places; expected a joint, a joint and its placement, "
                "two joints, or both with their placements."
            )
        self._attach(model, places or (0,), {})
        self.nv = model.nv
        self.depth_joint1, self.depth_joint2 = (
            len(model.supports[joint]) for joint in (self.joint1_id, self.joint2_id)
        )
        self._compliance = np.zeros(self._rows)
        self.desired_constraint_offset = np.zeros(self._rows)
        self.desired_constraint_velocity = np.zeros(self._rows)
        self.desired_constraint_acceleration = np.zeros(self._rows)

    def residualSize(self, sel: Any = ConstraintSelectionType.CURRENT) -> int:
        """How many rows it has."""
        return self._rows

    def _joints_of_row(self, row: int) -> tuple[int, ...]:
        return self.joint1_id, self.joint2_id

    def createData(self) -> Any:
        """What is known of it at a state; filled by `calc`."""
        return self._data(self)

    def retrieveCompliance(self, sel: Any = ConstraintSelectionType.CURRENT) -> Floats:
        """The compliance of its rows."""
        return self._compliance.copy()

    def setCompliance(self, vec: Any, sel: Any = ConstraintSelectionType.CURRENT) -> None:
        """Sets the compliance of its rows."""
        self._compliance = vector(vec, self._rows, "vec").copy()

    def set(self, constraint_data: Any) -> Any:
        """The set that its forces belong to: any."""
        self._check_data(constraint_data)
        return FullSpaceCone()

    def calc(self, model: Model, data: Data, constraint_data: Any) -> None:
        """Where the second frame is, seen from the first, its velocity and acceleration, at the last forwardKinematics.

        What was not given there, velocity or acceleration, counts as zero.
        """
        self._fits(model, constraint_data)
        state = _state(model, data)
        shapes = ((self._rows, True, self.joint1_id, self.joint2_id),)

        def build(core: CoreModel) -> Any:
            def run(q: Array, v: Array, a: Array, places: Array) -> tuple[Array, ...]:
                return tuple(relative_motion(core, q, v, a, core_constraints(shapes, places)[0]))

            return run

        inputs = (*state, self._places[None])
        sizes: dict[str, Any] = dict(zip(("q", "v", "a", "places"), (x.shape for x in inputs), strict=True))
        result = compiled_for(model, data).compile(("constraint motion", shapes), build, **sizes)(*inputs)
        place, constraint_data._J, velocity, acceleration = result
        constraint_data._q = state[0].copy()
        wanted = (
            self.desired_constraint_offset,
            self.desired_constraint_velocity,
            self.desired_constraint_acceleration,
        )
        if self._rows == 6:  # as there, frames are measured without the desired motion
            wanted = (0.0, 0.0, 0.0)
        constraint_data.constraint_position_error[:] = place - wanted[0]
        constraint_data.constraint_velocity_error[:] = velocity - wanted[1]
        constraint_data.constraint_acceleration_error[:] = acceleration - wanted[2]
        oMi = data._arrays["oMi"]
        np.matmul(oMi[self.joint1_id], self._places[0], out=constraint_data.oMc1._m)
        np.matmul(oMi[self.joint2_id], self._places[1], out=constraint_data.oMc2._m)
        constraint_data.c1Mc2 = constraint_data.oMc1.actInv(constraint_data.oMc2)
        constraint_data._oMi = oMi[[self.joint1_id, self.joint2_id]]
        constraint_data._oMc = [constraint_data.oMc1.copy(), constraint_data.oMc2.copy()]

    def _ends(self, data: Data, constraint_data: Any, rf: Any) -> list[tuple[int, Floats]]:
        joints = ((self.joint1_id, self.getA1), (self.joint2_id, self.getA2))
        return [(joint, of_joint(constraint_data, rf)) for joint, of_joint in joints if joint]

    def getA1(self, constraint_data: Any, reference_frame: ReferenceFrame) -> Floats:
        """The matrix (residualSize, 6) that makes its velocity of the first joint's spatial velocity, after `calc`.

        Args:
            reference_frame: The axes of the joint's velocity: LOCAL, WORLD or LOCAL_WORLD_ALIGNED.

        Returns:
            The matrix.
        """
        return self._of_joint(0, constraint_data, reference_frame)

    def getA2(self, constraint_data: Any, reference_frame: ReferenceFrame) -> Floats:
        """The same of the second joint. See `getA1`."""
        return self._of_joint(1, constraint_data, reference_frame)

    def _of_joint(self, end: int, constraint_data: Any, rf: ReferenceFrame) -> Floats:
        reference_of(rf)
        self._check_data(constraint_data)
        return constraint_data._projection(end, rf)

    def _fits(self, model: Model, constraint_data: Any) -> None:
        self._check_data(constraint_data)
        if not max(self.joint1_id, self.joint2_id) < model.njoints or self.nv != model.nv:
            raise InputError(
                f"{self.shortname()} was made for a model of {self.nv} velocities, not {model.nv}."
            )

    def jacobian(self, model: Model, data: Data, constraint_data: Any) -> Floats:
        """The Jacobian (residualSize, nv) of its velocity, after `calc`; of `data.J` where it is of that q."""
        self._fits(model, constraint_data)
        if constraint_data._J is None:
            raise ArgumentError(
                "The data of the constraint is empty. Call constraint.calc(model, data, its data) first."
            )
        if has_columns_of(model, data, constraint_data._q):
            moved = data._arrays["J"] * self._moved(model)
            return constraint_data._of_world() @ moved
        return constraint_data._J.copy()

    def _moved(self, model: Model) -> Floats:
        """For each column 1 where it moves the second joint, -1 where it moves the first one, and 0 for both (nv,)."""
        out = np.zeros(model.nv)
        for sign, joint in ((-1.0, self.joint1_id), (1.0, self.joint2_id)):
            for moving in list(model.supports[joint])[1:]:
                first = model.joints[moving].idx_v
                out[first : first + model.joints[moving].nv] += sign
        return out

    def __setstate__(self, state: dict[str, Any]) -> None:
        super().__setstate__(state)
        self._place(self._places)

    def copy(self) -> Any:
        """A copy."""
        cls: Any = type(self)
        other = cls.__new__(cls)
        other._place(self._places.copy())
        for kind in cls.__mro__:
            for name in getattr(kind, "__slots__", ()):
                value = getattr(self, name)
                if not hasattr(other, name):
                    setattr(other, name, value.copy() if isinstance(value, np.ndarray) else value)
        other._gains = type(self._gains)(self._gains.Kp, self._gains.Kd)
        return other

    __copy__ = copy

    def __deepcopy__(self, memo: Any) -> Any:
        return self.copy()


class _Points(_Anchor):
    """Of the kinds that hold points."""

    __slots__ = ()

    def computeConstraintSpatialInertia(self, placement: SE3, diagonal_constraint_inertia: Any) -> Floats:
        """The spatial inertia that a diagonal one of its three rows is at a frame with this placement.

        Args:
            placement: Of the constraint's frame, seen from where the inertia is asked.
            diagonal_constraint_inertia: Inertias of the rows (3,) [kg].

        Returns:
            Matrix (6, 6).
        """
        weights = vector(diagonal_constraint_inertia, 3, "diagonal_constraint_inertia")
        rows = placement.toActionMatrixInverse()[:3]
        return (rows.T * weights) @ rows


@final
class PointAnchorConstraintModel(_Points):
    """A point of one body goes with a point of another: `(model, joint1[, placement1[, joint2[, placement2]]])`."""

    __slots__ = ()


@final
class FrameAnchorConstraintModel(_Anchor):
    """A frame of one body goes with a frame of another: `(model, joint1[, placement1[, joint2[, placement2]]])`."""

    __slots__ = ()
    _rows = 6
    _data = FrameAnchorConstraintData


@final
class PointContactConstraintModel(_Points):
    """Two bodies touch at a point, with friction; the third axis of the first frame is the normal of the contact.

    Attributes:
        geom1_id, geom2_id: Indices of the geometries that touch; for users, no algorithm reads them.
    """

    __slots__ = ("_friction", "geom1_id", "geom2_id")
    _kinds: ClassVar[Mapping[str, AttributeKind]] = dict.fromkeys(("geom1_id", "geom2_id"), whole)
    _data = PointContactConstraintData
    _sides = 1

    @by_name(*ANCHOR_ORDERS)
    def __init__(self, model: Model, *places: Any) -> None:
        super().__init__(model, *places)
        self._friction = 0.5
        self.geom1_id = self.geom2_id = 0

    def getFriction(self) -> float:
        """The coefficient of friction."""
        return self._friction

    def setFriction(self, friction: float) -> None:
        """Sets the coefficient of friction."""
        self._friction = CoulombFrictionCone(friction).mu

    @property
    def set(self) -> CoulombFrictionCone:  # type: ignore[override]
        """The cone that its forces belong to, also as `set(constraint_data)`; assigning one sets the friction."""
        return CoulombFrictionCone(self._friction)

    @set.setter
    def set(self, cone: CoulombFrictionCone) -> None:
        if not isinstance(cone, CoulombFrictionCone):
            raise ArgumentError(
                f"The set of a contact is {cone!r}; expected a CoulombFrictionCone, or setFriction(coefficient)."
            )
        self._friction = cone.mu


def _state(model: Model, data: Data) -> tuple[Floats, Floats, Floats]:
    """The state of the last kinematics; what was not given is zero."""
    q = data._require(data._q, "forwardKinematics(model, data, q)")
    v = a = np.zeros(model.nv)
    if data._qv is not None and np.array_equal(data._qv[0], q):
        v = data._qv[1]
        if data._qva is not None and all(map(np.array_equal, data._qva, (q, v))):
            a = data._qva[2]
    return q, v, a
