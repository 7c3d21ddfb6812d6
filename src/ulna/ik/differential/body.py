"""Tasks of the whole body: where the centre of mass is, and how far from singular a frame stays.

| symbol | meaning | shape, unit | equation |
|---|---|---|---|
| c, c* | centre of mass, its target, in the world | (3,), m | e = c* - c, J its Jacobian; Siciliano 2009, 7.2 |
| m | Yoshikawa's manipulability of a frame | () | e = its increase wanted, J = dm/dq; Siciliano 2009, 3.9 |
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import Any, final

import numpy as np

from ulna.algorithms import center_of_mass, center_of_mass_jacobian, manipulability_gradient
from ulna.algorithms.kinematics.manipulability import Axes, chosen_rows
from ulna.checks.values import number
from ulna.data_classes import dataclass
from ulna.ik.differential.task import Rows, Shapes, Task, cost_of
from ulna.model import Model
from ulna.typing import Array, ArrayLike, Floats


@final
@dataclass(frozen=True, eq=False)
class ComTask(Task):
    """The centre of mass of all that moves shall be at a point of the world (3,) [m].

    Attributes:
        cost: Cost of a metre, one number or one for each axis of the world [1/m].
        target: A point to use where none is passed.
    """

    cost: ArrayLike = 1.0
    target: Any = None
    damping: float = field(default=1.0, kw_only=True)

    @property
    def _default_name(self) -> str:
        return "com"

    def inputs(self, model: Model) -> Shapes:
        """The point."""
        return {self.label: (3,)}

    def reached_by(self, model: Model, q: Array) -> Mapping[str, Array]:
        """Where the centre of mass is."""
        return {self.label: center_of_mass(model, q)}

    def costs(self, model: Model) -> Floats:
        """Three numbers."""
        return cost_of(self.cost, 3, f"{self.label}: `cost`")

    def rows(self, model: Model, q: Array, *inputs: Array) -> Rows:
        """Three rows, in world axes."""
        return Rows(center_of_mass_jacobian(model, q), inputs[0] - center_of_mass(model, q))


@final
@dataclass(frozen=True, eq=False)
class ManipulabilityTask(Task):
    """Yoshikawa's manipulability of a frame shall grow by `rate` in a step: away from singular configurations.

    Attributes:
        frame: Name of the frame.
        rate: The increase wanted in one step.
        rows_of: Rows of the Jacobian that count: "all", "trans", "rot", or six truth values.
        cost: Cost of a unit of what is missing.
    """

    frame: str
    rate: float = 0.1
    rows_of: Axes = "all"
    cost: float = 1.0

    @property
    def _default_name(self) -> str:
        return f"{self.frame}_manipulability"

    def costs(self, model: Model) -> Floats:
        """One number."""
        model.frame(self.frame)
        chosen_rows(self.rows_of)
        number(f"{self.label}: rate", self.rate, "a finite number")
        return cost_of(self.cost, 1, f"{self.label}: `cost`")

    def rows(self, model: Model, q: Array, *inputs: Array) -> Rows:
        """One row."""
        gradient = manipulability_gradient(model, q, model.frame(self.frame), self.rows_of)
        return Rows(gradient[..., None, :], np.array([self.rate]))
