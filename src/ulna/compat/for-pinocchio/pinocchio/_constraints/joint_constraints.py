"""Constraints of single joints: dry friction, and limits of position."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from typing import Any, ClassVar, final

import numpy as np

from pinocchio._constraints.cones import BoxSet, NonNegativeOrthantCone
from pinocchio._constraints.constraint_model import AnyConstraint, AnyConstraintData, wrong_model
from pinocchio._constraints.frame_pair import BaumgarteCorrectorParameters, ConstraintSelectionType
from pinocchio._containers.arguments import OMITTED, ArgumentError, check_model_and_data
from pinocchio._containers.arrays import StdVec, index, vector
from pinocchio._containers.attributes import AttributeKind, entries, read_only, text, whole
from pinocchio._containers.keywords import by_name
from pinocchio._data.data import Data
from pinocchio._model.live_parameters import FREE
from pinocchio._model.model import Model
from ulna.errors import InputError
from ulna.typing import Floats

__all__ = [
    "JointFrictionConstraintData",
    "JointFrictionConstraintModel",
    "JointLimitConstraintData",
    "JointLimitConstraintModel",
]


@final
class NoGains(InputError, RuntimeError):
    """A constraint has no gains against drift; Pinocchio raises a RuntimeError."""


class _OfJoints(AnyConstraint):
    """Rows that are single velocities of joints, or their opposites."""

    __slots__ = ("_compliance", "_gains", "_joints", "name", "nv")
    _kinds: ClassVar[Mapping[str, AttributeKind]] = {"name": text, "nv": whole}

    def _choose(self, model: Any, joints: Any) -> None:
        if not isinstance(model, Model):
            raise ArgumentError(f"The model is {model!r}; expected a pinocchio.Model.")
        fix = "model.getJointId(name) returns one; the universe has no velocity."
        chosen = range(1, model.njoints) if joints is None else joints
        self._joints = [index(joint, model.njoints, "joint", fix) for joint in chosen]
        if 0 in self._joints or len(set(self._joints)) < len(self._joints):
            raise InputError(f"The joints are {self._joints}; expected indices from 1, each once.")
        self.name, self.nv, self._gains = "", model.nv, BaumgarteCorrectorParameters(0.0, 0.0)

    def _fits(self, function: str, model: Any, data: Any, constraint_data: Any) -> None:
        """Raises where a model, its data, or the data of the constraint are of others."""
        check_model_and_data(function, model, data)
        self._check_data(constraint_data)
        if model.nv != self.nv:
            raise InputError(
                f"{self.shortname()} was made for a model of {self.nv} velocities, not {model.nv}."
            )

    def copy(self) -> Any:
        """A copy."""
        other = object.__new__(type(self))
        for name in (name for cls in type(self).__mro__ for name in getattr(cls, "__slots__", ())):
            setattr(other, name, copy.deepcopy(getattr(self, name)))
        return other

    def _rows(self) -> list[tuple[int, float]]:
        """The index of the velocity of each active row, and its sign."""
        raise NotImplementedError

    def residualSize(self, sel: Any = ConstraintSelectionType.CURRENT) -> int:
        """How many rows it has."""
        return len(self._rows())

    def _selected(self, sel: Any) -> list[int]:
        """The indices of the active rows among all, or of all (MAXIMAL)."""
        return list(range(len(self._compliance)))

    def retrieveCompliance(self, sel: Any = ConstraintSelectionType.CURRENT) -> Floats:
        """The compliance of its active rows, or of all (MAXIMAL)."""
        return self._compliance[self._selected(sel)]

    def setCompliance(self, vec: Any, sel: Any = ConstraintSelectionType.CURRENT) -> None:
        """Sets the compliance of its active rows, or of all (MAXIMAL)."""
        self._compliance[self._selected(sel)] = vector(vec, self.residualSize(sel), "vec")

    def jacobian(self, model: Model, data: Any, constraint_data: Any) -> Floats:
        """The Jacobian (residualSize, nv): one entry of one, or minus one, in each row."""
        self._fits("jacobian", model, data, constraint_data)
        rows = self._rows()
        J = np.zeros((len(rows), self.nv))
        for row, (k, sign) in enumerate(rows):
            J[row, k] = sign
        return J


@final
class JointFrictionConstraintData(AnyConstraintData):
    """Of a JointFrictionConstraintModel."""

    __slots__ = ("friction_impulse_lower_limit", "friction_impulse_upper_limit")
    _kinds: ClassVar[Mapping[str, AttributeKind]] = dict.fromkeys(
        ("friction_impulse_lower_limit", "friction_impulse_upper_limit"), entries
    )

    def __init__(self, constraint_model: JointFrictionConstraintModel = OMITTED) -> None:
        limits = np.zeros(0), np.zeros(0)
        if constraint_model is not OMITTED:
            if not isinstance(constraint_model, JointFrictionConstraintModel):
                raise wrong_model(self, constraint_model)
            limits = constraint_model.getFrictionLowerLimit(), constraint_model.getFrictionUpperLimit()
        self.friction_impulse_lower_limit, self.friction_impulse_upper_limit = limits


@final
class JointFrictionConstraintModel(_OfJoints):
    """`JointFrictionConstraintModel(model[, joints[, lb, ub]])`: dry friction, between bounds (nv,), holds joints.

    Without bounds they are those of the model, `lowerDryFrictionLimit` and `upperDryFrictionLimit`.
    """

    __slots__ = ("_dofs", "_joint_of_row", "_lb", "_step", "_ub")
    _data = JointFrictionConstraintData
    _sides = 2

    @by_name("model m_active_joints lb ub", "model joints lb ub")
    def __init__(self, model: Any, joints: Any = None, lb: Any = None, ub: Any = None) -> None:
        self._choose(model, joints)
        self._dofs = [
            k
            for j in self._joints
            for k in range(model.joints[j].idx_v, model.joints[j].idx_v + model.joints[j].nv)
        ]
        self._joint_of_row = [j for j in self._joints for _ in range(model.joints[j].nv)]
        lower, upper = (
            model.lowerDryFrictionLimit if lb is None else lb,
            model.upperDryFrictionLimit if ub is None else ub,
        )
        self._lb, self._ub = (vector(x, model.nv, n)[self._dofs] for x, n in ((lower, "lb"), (upper, "ub")))
        self._step, self._compliance = 1.0, np.zeros(len(self._dofs))

    def _rows(self) -> list[tuple[int, float]]:
        return [(k, 1.0) for k in self._dofs]

    def _joints_of_row(self, row: int) -> tuple[int, ...]:
        return (self._joint_of_row[row],)

    def setBaumgarteCorrectorParameters(
        self, bp: BaumgarteCorrectorParameters, sel: Any = ConstraintSelectionType.CURRENT
    ) -> None:
        """Not offered, as in Pinocchio: friction has no drift.

        Args:
            sel: Accepted and ignored.

        Raises:
            NoGains: Always.
        """
        raise NoGains("Dry friction has no drift, and no gains against it; constraints between frames have.")

    def createData(self) -> JointFrictionConstraintData:
        """What is known of it at a state."""
        return JointFrictionConstraintData(self)

    def calc(self, model: Model, data: Data, constraint_data: JointFrictionConstraintData) -> None:
        """Fills the bounds of the impulses of a time step."""
        self._fits("calc", model, data, constraint_data)
        constraint_data.friction_impulse_lower_limit = self._step * self._lb
        constraint_data.friction_impulse_upper_limit = self._step * self._ub

    def set(self, constraint_data: JointFrictionConstraintData) -> BoxSet:
        """The box that its impulses belong to, after `calc`."""
        self._check_data(constraint_data)
        return BoxSet(
            constraint_data.friction_impulse_lower_limit, constraint_data.friction_impulse_upper_limit
        )

    def getActiveDofs(self) -> StdVec[int]:
        """The velocities it holds."""
        return StdVec(self._dofs)

    def getActiveJoints(self) -> StdVec[int]:
        """The joints it holds."""
        return StdVec(self._joints)

    def getFrictionLowerLimit(self) -> Floats:
        """The lower bounds of the friction [N m or N]."""
        return self._lb.copy()

    def getFrictionUpperLimit(self) -> Floats:
        """The upper bounds of the friction [N m or N]."""
        return self._ub.copy()

    def setFrictionLowerLimit(self, lb: Any) -> None:
        """Sets the lower bounds of the friction [N m or N]."""
        self._lb = vector(lb, len(self._dofs), "lb").copy()

    def setFrictionUpperLimit(self, ub: Any) -> None:
        """Sets the upper bounds of the friction [N m or N]."""
        self._ub = vector(ub, len(self._dofs), "ub").copy()

    def getTimeStep(self) -> float:
        """The time step that makes impulses of friction [s]."""
        return self._step

    def setTimeStep(self, dt: float) -> None:
        """Sets the time step that makes impulses of friction [s]."""
        if not float(dt) > 0.0:
            raise InputError(f"The time step is {dt!r}; expected seconds above zero.")
        self._step = float(dt)


@final
class JointLimitConstraintData(AnyConstraintData):
    """Of a JointLimitConstraintModel."""

    __slots__ = ("_J", "constraint_residual")
    _kinds: ClassVar[Mapping[str, AttributeKind]] = {"constraint_residual": read_only}

    def __init__(self, constraint_model: JointLimitConstraintModel = OMITTED) -> None:
        self._J: Floats | None = None
        size = 0
        if constraint_model is not OMITTED:
            if not isinstance(constraint_model, JointLimitConstraintModel):
                raise wrong_model(self, constraint_model)
            size = constraint_model.residualSize()
        self._keep(constraint_residual=np.zeros(size))


@final
class JointLimitConstraintModel(_OfJoints):
    """`JointLimitConstraintModel(model[, joints[, lb, ub[, margin]]])`: joints stay within their limits.

    Each limit of an angle or a length is a row, the lower ones first; active are all, or, after
    makeSelectionFilteredByLimitProximity, those nearer than their margin. They are the model's by default.
    """

    __slots__ = ("_active", "_limits", "_margins", "_nq", "_places", "_sizes")
    _data = JointLimitConstraintData
    _sides = 1

    @by_name("model activable_joints lb ub margin", "model joints lb ub margin")
    def __init__(
        self, model: Any, joints: Any = None, lb: Any = None, ub: Any = None, margin: Any = None
    ) -> None:
        self._choose(model, joints)
        self._nq = model.nq
        self._sizes = {joint: (model.joints[joint].nq, model.joints[joint].nv) for joint in self._joints}
        self._places = [
            (model.joints[joint].idx_q + k, joint)
            for joint in self._joints
            for k, means_something in enumerate(model.joints[joint].hasConfigurationLimit)
            if means_something and not model.joints[joint].mimic
        ]
        self.setPositionLimitAndMargin(
            model.lowerPositionLimit if lb is None else lb,
            model.upperPositionLimit if ub is None else ub,
            model.positionLimitMargin if margin is None else margin,
        )

    def setPositionLimitAndMargin(self, lb: Any, ub: Any, margin: Any) -> None:
        """Sets limits and margins; all finite limits become active.

        Args:
            lb: Least values (nq,) [rad or m].
            ub: Greatest values (nq,) [rad or m].
            margin: Margins (nq,) [rad or m].
        """
        low, high, near = (vector(x, self._nq, n) for x, n in ((lb, "lb"), (ub, "ub"), (margin, "margin")))
        rows = [(q, joint, 1.0, low[q]) for q, joint in self._places if low[q] > -FREE]
        rows += [(q, joint, -1.0, high[q]) for q, joint in self._places if high[q] < FREE]
        self._limits = rows
        self._margins = [float(near[q]) for q, *_ in rows]
        self._compliance = np.zeros(len(rows))
        self.makeSelectionMaximal()

    def _selected(self, sel: Any) -> list[int]:
        return super()._selected(sel) if sel == ConstraintSelectionType.MAXIMAL else self._active

    def makeSelectionMaximal(self) -> None:
        """Makes all rows active."""
        self._active = list(range(len(self._limits)))

    def makeSelectionFilteredByLimitProximity(self, q: Any) -> None:
        """Makes those rows active whose limit is nearer to q (nq,) than its margin, or passed."""
        q = vector(q, self._nq, "q")
        self._active = [i for i, left in enumerate(self._left(q)) if left <= self._margins[i]]

    def _left(self, q: Floats) -> list[float]:
        """How far each limit is."""
        return [sign * float(q[place] - limit) for place, _, sign, limit in self._limits]

    def _joints_of_row(self, row: int) -> tuple[int, ...]:
        return (self._limits[self._active[row]][1],)

    def jacobian(self, model: Model, data: Any, constraint_data: Any) -> Floats:
        """The rates of the limited entries of q, after `calc` at a configuration.

        Returns:
            Jacobian (residualSize, nv).

        Raises:
            InputError: The model is another one, or `calc` was not called for a floating joint.
        """
        self._fits("jacobian", model, data, constraint_data)
        if constraint_data._J is not None and len(constraint_data._J) == len(self._active):
            return constraint_data._J.copy()
        joints = (model.joints[self._limits[i][1]] for i in self._active)
        if any(joint.nq != joint.nv for joint in joints):
            raise InputError(
                "The rates of a floating joint's entries of q depend on q. Call constraint.calc(model, data, its data) "
                "first."
            )
        return self._rates(model, np.zeros(self._nq))

    def _rates(self, model: Model, q: Floats) -> Floats:
        """The rates of the limited entries at a configuration, by entries of v, their signs those of the limits."""
        J = np.zeros((len(self._active), self.nv))
        for row, (place, number, sign, _) in zip(J, (self._limits[i] for i in self._active), strict=True):
            joint = model.joints[number]
            at, k = q[joint.idx_q : joint.idx_q + joint.nq], place - joint.idx_q
            for n in range(joint.nv) if joint.nq != joint.nv else (k,):
                unit = np.eye(joint.nv)[n]
                row[joint.idx_v + n] = sign * float(joint.kind.coordinate_rates(at, unit)[k])  # pyright: ignore[reportOptionalMemberAccess]
        return J

    def residualSize(self, sel: Any = ConstraintSelectionType.CURRENT) -> int:
        """How many rows are active, or (MAXIMAL) could be."""
        return len(self._limits if sel == ConstraintSelectionType.MAXIMAL else self._active)

    def lowerResidualSize(self, sel: Any = ConstraintSelectionType.CURRENT) -> int:
        """How many of them are lower limits."""
        chosen = range(len(self._limits)) if sel == ConstraintSelectionType.MAXIMAL else self._active
        return sum(self._limits[i][2] > 0.0 for i in chosen)

    def upperResidualSize(self, sel: Any = ConstraintSelectionType.CURRENT) -> int:
        """How many of them are upper limits."""
        return self.residualSize(sel) - self.lowerResidualSize(sel)

    def active_idx_in_activable(self) -> StdVec[int]:
        """Which of all rows are active."""
        return StdVec(self._active)

    def getActivablePositionLimit(self) -> Floats:
        """The limits of all rows [rad or m]."""
        return np.array([limit for *_, limit in self._limits])

    def getSelectedJoints(self) -> StdVec[int]:
        """The joints that have limits."""
        return StdVec(sorted({joint for _, joint, *_ in self._limits}))

    def getNqReduce(self) -> int:
        """How many entries of q these joints have."""
        return sum(self._sizes[joint][0] for joint in self.getSelectedJoints())

    def getMaxOfNvs(self) -> int:
        """The most velocities that one of these joints has."""
        return max((self._sizes[joint][1] for joint in self.getSelectedJoints()), default=0)

    @property
    def baumgarte_corrector_parameters(self) -> BaumgarteCorrectorParameters:
        """Gains against passing the limits, live."""
        return self._gains

    @baumgarte_corrector_parameters.setter
    def baumgarte_corrector_parameters(self, gains: BaumgarteCorrectorParameters) -> None:
        self._gains._assign(gains)

    def setBaumgarteCorrectorParameters(
        self, bp: BaumgarteCorrectorParameters, sel: Any = ConstraintSelectionType.CURRENT
    ) -> None:
        """Sets the gains against drift.

        Args:
            sel: Accepted and ignored.
        """
        self._gains._assign(bp)

    def createData(self) -> JointLimitConstraintData:
        """What is known of it at a state."""
        return JointLimitConstraintData(self)

    def calc(self, model: Model, data: Data, constraint_data: JointLimitConstraintData) -> None:
        """Computes the distances of the active limits at the configuration of the last forwardKinematics.

        Args:
            data: Its data, after forwardKinematics.
        """
        self._fits("calc", model, data, constraint_data)
        q = data._require(data._q, "forwardKinematics(model, data, q)")
        left, constraint_data._J = self._left(q), self._rates(model, q)
        constraint_data._keep(constraint_residual=np.array([left[i] for i in self._active]))

    def set(self, constraint_data: Any) -> NonNegativeOrthantCone:
        """The set that its forces belong to: they push, and do not pull."""
        self._check_data(constraint_data)
        return NonNegativeOrthantCone()
