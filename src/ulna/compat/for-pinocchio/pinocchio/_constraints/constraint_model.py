"""What constraints of all kinds have in common, and the class that stands for any of them."""

from __future__ import annotations

import copy
from typing import Any, ClassVar, Self, final

import numpy as np

from pinocchio._constraints.frame_pair import ConstraintSelectionType
from pinocchio._containers.arguments import ArgumentError, WrongShape
from pinocchio._containers.arrays import StdVec, alike, index, rows_of, vector
from pinocchio._containers.attributes import CheckedAttributes
from pinocchio._containers.enums import ReferenceFrame, reference_of
from pinocchio._containers.files import Saved, register
from pinocchio._containers.keywords import by_name
from pinocchio._data.data import Data
from pinocchio._model.model import Model
from pinocchio._spatial.motion_force import Force
from ulna.errors import InputError, excerpt
from ulna.typing import Floats

__all__ = ["ConstraintData", "ConstraintModel"]


class _NamedAndCompared(CheckedAttributes, Saved):
    """The name and the comparison of constraints and their data, by what they hold; and their files."""

    __slots__ = ()

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        if not cls.__name__.startswith(("_", "Any")):
            register(cls)

    def shortname(self) -> str:
        """The name of its class."""
        return type(self).__name__

    @classmethod
    def classname(cls) -> str:
        """The name of its class."""
        return cls.__name__

    def extract(self) -> Any:
        """The object itself: it is of the class of its kind."""
        return self

    def __getstate__(self) -> dict[str, Any]:
        names = [name for cls in type(self).__mro__ for name in getattr(cls, "__slots__", ())]
        return {name: getattr(self, name) for name in names}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self._keep(**state)

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        own, its = self.__getstate__(), other.__getstate__()
        return all(alike(own[name], its[name]) for name in own)

    __hash__ = object.__hash__

    def __str__(self) -> str:
        return f"{self.shortname()}\n"

    __repr__ = __str__


class AnyConstraint(_NamedAndCompared):
    """A constraint that has data made by `createData`."""

    __slots__ = ()
    _sides: ClassVar[int] = 0
    """For each row, how many half-lines its force belongs to a product of; 0 where it may be anything."""
    _data: ClassVar[Any] = None
    """The class of its data."""

    def _check_data(self, constraint_data: Any) -> None:
        """Raises ArgumentError where some data are not of a constraint of this kind."""
        if type(constraint_data) is not self._data:
            raise ArgumentError(
                f"The data of the constraint is {constraint_data!r}; expected what its createData() returns."
            )

    def residualSize(self, sel: Any = ConstraintSelectionType.CURRENT) -> int:
        """How many rows it has."""
        raise NotImplementedError

    def symmetricConeResidualSize(self, sel: Any = ConstraintSelectionType.CURRENT) -> int:
        """How many rows its forces have as members of symmetric cones: of boxes two a row, of all space none."""
        return self._sides * self.residualSize(sel)

    def _joints_of_row(self, row: int) -> tuple[int, ...]:
        """The joints whose motion a row is of."""
        raise NotImplementedError

    def getRowSparsityPattern(self, model: Model, data: Data, constraint_data: Any, row_id: int) -> Any:
        """Which velocities of the model may move a row.

        Args:
            row_id: Index of the row.

        Returns:
            True for those that may (nv,).
        """
        self._check_data(constraint_data)
        row = index(
            row_id, self.residualSize(), "row of the constraint", "residualSize() says how many there are."
        )
        pattern = np.zeros(model.nv, dtype=bool)
        for first in self._joints_of_row(row):
            joint = first
            while joint:
                start = model.joints[joint].idx_v
                pattern[start : start + model.joints[joint].nvExtended] = True
                joint = model.parents[joint]
        return pattern

    def getRowIndexes(self, model: Model, data: Data, constraint_data: Any, row_id: int) -> StdVec[int]:
        """The indices of the velocities that may move a row.

        Args:
            row_id: Index of the row.

        Returns:
            Indices.
        """
        pattern = self.getRowSparsityPattern(model, data, constraint_data, row_id)
        return StdVec(np.flatnonzero(pattern).tolist())

    def jacobian(self, model: Model, data: Data, constraint_data: Any) -> Floats:
        """The Jacobian of its velocity, after `calc`.

        Returns:
            Jacobian (residualSize, nv).
        """
        raise NotImplementedError

    def jacobianMatrixProduct(self, model: Model, data: Data, constraint_data: Any, matrix: Any) -> Floats:
        """The Jacobian times a matrix or a vector.

        Args:
            matrix: Array (nv, k) or (nv,).

        Returns:
            Array (residualSize, k) or (residualSize,).
        """
        return self.jacobian(model, data, constraint_data) @ rows_of(matrix, model.nv, "matrix")

    def jacobianTransposeMatrixProduct(
        self, model: Model, data: Data, constraint_data: Any, matrix: Any
    ) -> Floats:
        """The Jacobian's transpose times a matrix or a vector.

        Args:
            matrix: Array (residualSize, k) or (residualSize,).

        Returns:
            Array (nv, k) or (nv,).
        """
        return self.jacobian(model, data, constraint_data).T @ rows_of(matrix, self.residualSize(), "matrix")

    def _ends(self, data: Data, constraint_data: Any, rf: Any) -> list[tuple[int, Floats]]:
        """The joints whose spatial velocities make its velocity, each with the matrix (rows, 6) that does so."""
        return []

    def mapConstraintForceToJointSpace(
        self,
        model: Model,
        data: Data,
        constraint_data: Any,
        constraint_forces: Any,
        joint_forces: Any,
        reference_frame: ReferenceFrame = ReferenceFrame.LOCAL,
    ) -> Floats:
        """Adds the forces on the joints that forces of its rows are, and returns the torques of single velocities.

        Constraints between two frames act by forces on joints, and return zeros; limits and frictions of joints act by
        the torques that are returned.

        Args:
            constraint_forces: Forces of its rows (residualSize,) [N or N m].
            joint_forces: A Force for each joint, in the axes of `reference_frame`; those of the joints that it holds
                are added to.
            reference_frame: LOCAL, WORLD or LOCAL_WORLD_ALIGNED.

        Returns:
            Torques (nv,) [N m or N].
        """
        self._check_data(constraint_data)
        force = vector(constraint_forces, self.residualSize(), "constraint_forces")
        _check_count("joint_forces", joint_forces, model)
        ends = self._ends(data, constraint_data, reference_frame)
        for joint, projection in ends:
            joint_forces[joint] = joint_forces[joint] + Force(projection.T @ force)
        return np.zeros(model.nv) if ends else self.jacobian(model, data, constraint_data).T @ force

    def mapJointSpaceToConstraintMotion(
        self,
        model: Model,
        data: Data,
        constraint_data: Any,
        joint_motions: Any,
        joint_generalized_velocity: Any,
        reference_frame: ReferenceFrame = ReferenceFrame.LOCAL,
    ) -> Floats:
        """The velocity of its rows that velocities of the joints are: mapConstraintForceToJointSpace the other way.

        Args:
            joint_motions: A Motion for each joint, in the axes of `reference_frame`: of constraints between two frames.
            joint_generalized_velocity: Velocities (nv,) [rad/s or m/s]: of limits and frictions of joints.
            reference_frame: LOCAL, WORLD or LOCAL_WORLD_ALIGNED.

        Returns:
            Velocities of its rows (residualSize,) [m/s or rad/s].
        """
        self._check_data(constraint_data)
        velocity = vector(joint_generalized_velocity, model.nv, "joint_generalized_velocity")
        _check_count("joint_motions", joint_motions, model)
        ends = self._ends(data, constraint_data, reference_frame)
        if not ends:
            return self.jacobian(model, data, constraint_data) @ velocity
        out = np.zeros(self.residualSize())
        for joint, projection in ends:
            out += projection @ joint_motions[joint].vector
        return out

    def appendCouplingConstraintInertias(
        self,
        model: Model,
        data: Data,
        constraint_data: Any,
        diagonal_constraint_inertia: Any,
        reference_frame: ReferenceFrame = ReferenceFrame.LOCAL,
    ) -> None:
        """Adds the inertia that its rows are at the joint it holds to `data.oYaba_augmented`, after `calc`.

        Limits and frictions of joints add to no field. No algorithm here reads the field; it is for recursions of
        users.

        Args:
            diagonal_constraint_inertia: Inertias of its rows (residualSize,) [kg].
            reference_frame: LOCAL, WORLD or LOCAL_WORLD_ALIGNED.

        Raises:
            InputError: It holds two joints; what it couples them by is not kept.
        """
        self._check_data(constraint_data)
        weights = vector(diagonal_constraint_inertia, self.residualSize(), "diagonal_constraint_inertia")
        reference_of(reference_frame)
        ends = self._ends(data, constraint_data, reference_frame)
        if len(ends) > 1:
            raise InputError(
                "appendCouplingConstraintInertias: the constraint holds two joints, and the inertia between them is a "
                "workspace of Pinocchio's recursions that is not kept here. getA1 and getA2 return the matrices."
            )
        for joint, projection in ends:
            data.oYaba_augmented[joint] += (projection.T * weights) @ projection


class AnyConstraintData(_NamedAndCompared):
    """The data of a constraint."""

    __slots__ = ()
    _of_constraint = True

    def __copy__(self) -> Self:
        return copy.deepcopy(self)


class _Variant(type):
    """A class that every constraint, or its data, is an instance of."""

    def __instancecheck__(cls, instance: Any) -> bool:
        return isinstance(instance, cls._kinds)  # type: ignore[attr-defined]

    def __call__(cls, *positional: Any, **named: Any) -> Any:
        values = (*positional, *(named[name] for name in named if name in cls._names))  # type: ignore[attr-defined]
        if len(values) != len(positional) + len(named) or len(values) != 1 or not isinstance(values[0], cls):
            shown = ", ".join(excerpt(repr(value)) for value in values) or "nothing"
            raise ArgumentError(f"{cls.__name__} was given {shown}; expected one object: {cls.__doc__}")
        one = values[0]
        return one.copy() if hasattr(one, "copy") else one


@final
class ConstraintModel(metaclass=_Variant):
    """A constraint of any kind: ConstraintModel(PointAnchorConstraintModel(...)) is a copy of what it is given."""

    _kinds, _names = AnyConstraint, ("other",)

    @by_name("other")
    def __init__(self, other: Any) -> None:
        """Not called: what is made is a copy of `other`."""


@final
class ConstraintData(metaclass=_Variant):
    """The data of a constraint of any kind, as `constraint.createData()` returns it."""

    _kinds, _names = AnyConstraintData, ("constraint_data",)

    @by_name("constraint_data")
    def __init__(self, constraint_data: Any) -> None:
        """Not called: what is made is `constraint_data`."""


def wrong_model(data: AnyConstraintData, given: Any) -> ArgumentError:
    """The error for data that are made for something else than a constraint of their kind.

    Args:
        data: The data.
        given: What was passed.

    Returns:
        The error.
    """
    kind = data.shortname().replace("Data", "Model")
    return ArgumentError(f"The constraint is {excerpt(repr(given))}; expected a {kind}.")


def _check_count(name: str, entries: Any, model: Model) -> None:
    """Raises WrongShape where there is not an entry for each joint."""
    if not hasattr(entries, "__len__"):
        raise ArgumentError(
            f"`{name}` is {excerpt(repr(entries))}; expected a list with an entry for each joint."
        )
    if len(entries) != model.njoints:
        raise WrongShape(name, (len(entries),), f"({model.njoints},), one for each joint")
