"""Limits that are rows over several joints: a plane not to be crossed, and any rows that are passed.

| symbol | meaning | shape, unit | equation |
|---|---|---|---|
| p, J | origin of a frame in the world, and its Jacobian | (3,), (3, nv) | |
| n, h | normal of a plane, to the allowed side, and its height | (3,), m | n . p >= h |
| g | gain: the part of the way to the plane that one step may go | 1 | n . J v >= (h - n . p) g / dt |
| A, b | rows that are passed | (k, nv), (k,) | A v <= b |

Source: Faverjon & Tournassoud, A local based approach for path planning of manipulators with a high number of degrees
of freedom (1987). The rows are linear: a step may miss a bent bound by the square of its length.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, final

import numpy as np

from ulna.algorithms import frame_jacobian, frame_pose
from ulna.checks.values import number
from ulna.data_classes import dataclass
from ulna.errors import InputError
from ulna.ik.differential.limits import Limit, Strip, check_gain
from ulna.ik.differential.task import Shapes
from ulna.model import Model
from ulna.numeric import dot, vector
from ulna.typing import Array, ArrayLike


@final
@dataclass(frozen=True, eq=False)
class PlaneLimit(Limit):
    """The origin of a frame stays on one side of a plane of the world: n . p >= h.

    It takes a plane (4,): the normal n, which points to the allowed side, and h [m].

    Attributes:
        frame: Name of the frame.
        normal: n, (3,), of length 1.
        height: h [m].
        gain: The part of the way to the plane that one step may go, above 0 to 1.
    """

    frame: str
    normal: ArrayLike = (0.0, 0.0, 1.0)
    height: float = 0.0
    gain: float = 1.0

    def __post_init__(self) -> None:
        check_gain(self.gain, self.label)
        number(f"height of {self.label}", self.height)
        normal = np.asarray(self.normal, dtype=float)
        if normal.shape != (3,) or not np.isclose(np.linalg.norm(normal), 1.0, atol=1e-6):
            raise InputError(f"{self.label}: `normal` is {self.normal}; expected a vector of length 1.")

    @property
    def label(self) -> str:
        """Its name, given or by default."""
        return self.name or f"{self.frame}_plane"

    def inputs(self, model: Model) -> Shapes:
        """The plane."""
        return {self.label: (4,)}

    def defaults(self, model: Model) -> Mapping[str, Any]:
        """The plane that the limit was made with."""
        return {self.label: np.append(np.asarray(self.normal, dtype=float), float(self.height))}

    def bounds(self, model: Model, q: Array, dt: Any, *inputs: Array) -> Strip:
        """One row: how fast the point may near the plane."""
        frame, normal = model.frame(self.frame), inputs[0][..., :3]
        J = frame_jacobian(model, q, frame)[..., :3, :]
        missing = inputs[0][..., 3] - dot(normal, frame_pose(model, q, frame).translation)
        return Strip(normal[..., None, :] @ J, vector(missing * (self.gain / dt)), np.full(1, np.inf))


@final
@dataclass(frozen=True, eq=False)
class LinearLimit(Limit):
    """Any rows that are passed at every step: A v <= b; for instance distances between bodies.

    For a distance d between two points with its gradient g over the joints, the row is `-g` and b is `gain * d / dt`
    (Faverjon & Tournassoud 1987). It takes the matrix A (count, nv) as `<name>_matrix` and b (count,) as
    `<name>_bound`; rows that are not needed are zeros.

    Attributes:
        count: How many rows.
    """

    count: int

    @property
    def label(self) -> str:
        """Its name, given or by default."""
        return self.name or "linear_limit"

    def inputs(self, model: Model) -> Shapes:
        """The matrix and the bound."""
        return {f"{self.label}_matrix": (self.count, model.nv), f"{self.label}_bound": (self.count,)}

    def bounds(self, model: Model, q: Array, dt: Any, *inputs: Array) -> Strip:
        """The rows as they are."""
        return Strip(inputs[0], np.full(self.count, -np.inf), inputs[1])
