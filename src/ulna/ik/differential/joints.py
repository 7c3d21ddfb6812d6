"""Tasks of joints: a posture, damping, ratios between joints, any linear relation.

| symbol | meaning | shape, unit | equation |
|---|---|---|---|
| q, q* | configuration, and its target | (nq,) | |
| J_0 | derivative of q* (-) q with respect to q, tangent; -1 for plain joints | (nv, nv) | Sola et al. 2018, IV |
| posture | | (nv,) | e = q* (-) q, J = -J_0 |
| calm | | (nv,) | e = 0, J = 1: what moves, costs |
| linear | A (q (-) q_0) = b | (k,) | e = b - A (q (-) q_0), J = A d(q (-) q_0)/dq |
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, final

import numpy as np

from ulna.algorithms import difference, difference_derivatives
from ulna.data_classes import dataclass
from ulna.errors import InputError, ShapeError
from ulna.ik.differential.task import Rows, Shapes, Task, cost_of
from ulna.model import FreeFlyer, Model
from ulna.model.positions import position
from ulna.numeric import apply, vector
from ulna.typing import Array, ArrayLike, Floats


@final
@dataclass(frozen=True, eq=False)
class PostureTask(Task):
    """The joints shall be at a configuration (nq,): what the other tasks leave free goes there.

    Attributes:
        cost: Cost of a radian or a metre: one number for all joints but a floating base, or (nv,) [1/rad, 1/m].
        target: A configuration to use where none is passed: numbers, a dictionary by joint, or a name such as "home".
    """

    cost: ArrayLike = 1e-3
    target: Any = None

    @property
    def _default_name(self) -> str:
        return "posture"

    def inputs(self, model: Model) -> Shapes:
        """The configuration."""
        return {self.label: (model.nq,)}

    def defaults(self, model: Model) -> Mapping[str, Any]:
        """The configuration that the task was made with."""
        return {} if self.target is None else {self.label: position(model, self.target, self.label)}

    def reached_by(self, model: Model, q: Array) -> Mapping[str, Array]:
        """The configuration itself."""
        return {self.label: q}

    def costs(self, model: Model) -> Floats:
        """One for each entry of v."""
        return _joint_costs(self.cost, model, self.label)

    def rows(self, model: Model, q: Array, *inputs: Array) -> Rows:
        """A row for each entry of v."""
        by_q, _ = difference_derivatives(model, q, inputs[0])
        return Rows(-by_q, difference(model, q, inputs[0]))


@final
@dataclass(frozen=True, eq=False)
class DampingTask(Task):
    """The joints shall move little; some less than others.

    Attributes:
        cost: Cost of a radian or a metre of motion: one number for all joints but a floating base, or (nv,).
    """

    cost: ArrayLike = 1e-2

    @property
    def _default_name(self) -> str:
        return "damping"

    def costs(self, model: Model) -> Floats:
        """One for each entry of v."""
        return _joint_costs(self.cost, model, self.label)

    def rows(self, model: Model, q: Array, *inputs: Array) -> Rows:
        """A row for each entry of v; no error."""
        return Rows(np.eye(model.nv), np.zeros(model.nv))


@final
@dataclass(frozen=True, eq=False)
class LinearTask(Task):
    """A linear relation between joints: A (q (-) q_0) = b.

    Attributes:
        A: The matrix, (k, nv).
        reference: q_0, as for `PostureTask`; None for the neutral configuration.
        cost: Cost of a unit of each row, one number or (k,).
        target: b, (k,), to use where none is passed.
    """

    A: ArrayLike
    reference: Any = None
    cost: ArrayLike = 1.0
    target: Any = None

    @property
    def _default_name(self) -> str:
        return "linear"

    def inputs(self, model: Model) -> Shapes:
        """b."""
        return {self.label: (len(self._matrix(model)),)}

    def reached_by(self, model: Model, q: Array) -> Mapping[str, Array]:
        """What the left side is."""
        return {self.label: self._value(model, q)}

    def costs(self, model: Model) -> Floats:
        """One for each row."""
        return cost_of(self.cost, len(self._matrix(model)), f"{self.label}: `cost`")

    def rows(self, model: Model, q: Array, *inputs: Array) -> Rows:
        """The rows of A."""
        _, by_q = difference_derivatives(model, self._start(model), q)
        return Rows(self._matrix(model) @ by_q, inputs[0] - self._value(model, q))

    def _value(self, model: Model, q: Array) -> Array:
        return apply(self._matrix(model), difference(model, self._start(model), q))

    def _start(self, model: Model) -> Floats:
        return model.neutral if self.reference is None else position(model, self.reference, self.label)

    def _matrix(self, model: Model) -> Floats:
        A = np.asarray(self.A, dtype=float)
        if A.ndim != 2 or A.shape[1] != model.nv:
            raise ShapeError(f"{self.label}: A", A.shape, f"(k, {model.nv})")
        if not np.isfinite(A).all():
            raise InputError(f"{self.label}: `A` holds nan or inf; expected finite numbers.")
        return A


@final
@dataclass(frozen=True, eq=False)
class JointCouplingTask(Task):
    """Joints shall keep a ratio: the sum of ratio times position is the offset.

    As a constraint it is a gear: `JointCouplingTask({"left": 1.0, "right": -1.0})` keeps both alike.

    Attributes:
        ratios: The ratio of each joint by its name; joints with one coordinate.
        offset: What the sum shall be [rad or m].
        cost: Cost of a unit of what is missing.
    """

    ratios: Mapping[str, float]
    offset: float = 0.0
    cost: float = 1.0

    @property
    def _default_name(self) -> str:
        return "coupling_of_" + "_".join(self.ratios)

    def costs(self, model: Model) -> Floats:
        """One number."""
        self._row(model)
        return cost_of(self.cost, 1, f"{self.label}: `cost`")

    def rows(self, model: Model, q: Array, *inputs: Array) -> Rows:
        """One row."""
        missing: Any = self.offset
        for name, ratio in self.ratios.items():
            missing = missing - ratio * model.joint(name).q_of(q)[..., 0]
        return Rows(self._row(model), vector(missing))

    def _row(self, model: Model) -> Floats:
        row = np.zeros((1, model.nv))
        if not self.ratios:
            raise InputError(f"{self.label}: `ratios` is empty; expected a ratio by the name of each joint.")
        if not np.isfinite([self.offset, *self.ratios.values()]).all():
            raise InputError(
                f"{self.label}: `offset` is {self.offset}, `ratios` are {dict(self.ratios)}; expected finite numbers."
            )
        for name, ratio in self.ratios.items():
            joint = model.joint(name)
            if joint.kind.nq != 1 or joint.kind.nv != 1:
                raise InputError(
                    f"{self.label}: joint {name!r} is {joint.kind.describe()}; expected one coordinate."
                )
            row[0, joint.idx_v] += ratio * (1.0 if joint.mimic is None else joint.mimic.multiplier)
        return row


def _joint_costs(cost: ArrayLike, model: Model, label: str) -> Floats:
    costs = np.array(cost_of(cost, model.nv, f"{label}: `cost`"))
    if np.ndim(cost) == 0:
        for joint in model.joints:
            if joint.parent < 0 and isinstance(joint.kind, FreeFlyer):
                costs[joint.idx_v : joint.idx_v + joint.nv] = 0.0
    return costs
