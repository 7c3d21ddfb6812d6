"""What a task of differential inverse kinematics is: rows of a least-squares problem, a weight, a gain.

| symbol | meaning | shape, unit | source |
|---|---|---|---|
| e | error: what is missing to the target | (k,), m or rad | |
| J | how the error shrinks with the motion, -de/dq | (k, nv) | |
| w | cost of a unit of what is left of the error | (k,), 1/m, 1/rad | |
| alpha | gain: the part of the error to remove in one step | 1, in [0, 1] | |
| lambda | Levenberg's damping: grows with the error, vanishes at the target | 1 | Sugihara 2011, eq. 18 |

A task asks for J dq = alpha e. As a cost it adds |w (J dq - alpha e)|^2 + lambda |w alpha e|^2 |dq|^2 to the objective
(Nakamura 1991, section 4.2; Siciliano 2009, section 3.5); as a constraint it is met exactly.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from ulna.checks.values import flag
from ulna.data_classes import dataclass
from ulna.errors import InputError
from ulna.model import Model
from ulna.spatial import SE3, SO3
from ulna.typing import Array, Floats

Shapes = Mapping[str, tuple[int, ...]]


class Rows(NamedTuple):
    """J (..., k, nv) and e (..., k): `J @ dq` should be the gain times e."""

    J: Array
    e: Array


@dataclass(frozen=True, eq=False, kw_only=True)
class Task(ABC):
    """Something to be reached, step by step.

    Attributes:
        gain: The part of the error to be removed in one step, from 0 to 1.
        damping: Levenberg's damping, without unit: calm where the target is out of reach, without a trace where it
            is reached. It is 1 for tasks of frames and of the centre of mass, which with 0 let the joints of a
            stretched arm rush to and fro at their greatest speeds, and 0 for others.
        name: What its target is called; by default the frame's name, or what kind of task it is.
        adjustable: Whether a factor on its costs may be passed at every step, as `<name>_scale`, to fade it in and out.
    """

    gain: float = 1.0
    damping: float = 0.0
    name: str | None = None
    adjustable: bool = False

    def __post_init__(self) -> None:
        flag("adjustable", self.adjustable)
        if not 0.0 <= self.gain <= 1.0:
            raise InputError(f"{self.label}: `gain` is {self.gain}; expected a part of the error, 0 to 1.")
        if not 0.0 <= self.damping < np.inf:
            raise InputError(f"{self.label}: `damping` is {self.damping}; expected a number not below 0.")

    @property
    def label(self) -> str:
        """Its name, given or by default."""
        return self.name or self._default_name

    @property
    def scale(self) -> str:
        """What the factor on its costs is called."""
        return f"{self.label}_scale"

    @property
    @abstractmethod
    def _default_name(self) -> str:
        """What it is called when no name is given."""

    def inputs(self, model: Model) -> Shapes:
        """Names and shapes of its inputs at every step."""
        return {}

    def defaults(self, model: Model) -> Mapping[str, Any]:
        """Values of inputs that need not be passed: the target that the task was made with."""
        target = getattr(self, "target", None)
        return {} if target is None else {self.label: np.array(as_array(target))}

    def reached_by(self, model: Model, q: Array) -> Mapping[str, Array]:
        """The values of its inputs at which the task has no error at `q`.

        Args:
            model: The robot.
            q: Configuration (..., nq) [rad or m].

        Returns:
            Values (...) by name of the input; empty for a task without a target.
        """
        return {}

    @abstractmethod
    def costs(self, model: Model) -> Floats:
        """w, shape (k,); rows that cost nothing are left out.

        Raises:
            UnknownName, InputError: The task does not fit the model.
        """

    @abstractmethod
    def rows(self, model: Model, q: Array, *inputs: Array) -> Rows:
        """J and e.

        Args:
            model: The robot.
            q: Configuration (..., nq) [rad or m].
            *inputs: Values in the order of `inputs`, (...) before their shapes.

        Returns:
            J (..., k, nv) and e (..., k) [m or rad].
        """

    def constraint_rows(self, model: Model, q: Array, *inputs: Array) -> Rows:
        """J and e of the task as a constraint, J dq = gain e, which some dq must be able to meet.

        Args:
            model: The robot.
            q: Configuration (..., nq) [rad or m].
            *inputs: Values in the order of `inputs`, (...) before their shapes.

        Returns:
            J (..., k, nv) and e (..., k) [m or rad]; by default those of `rows`.
        """
        return self.rows(model, q, *inputs)


def cost_of(value: Any, count: int, what: str) -> Floats:
    """A cost for each of `count` rows, from one number or as many.

    Args:
        value: One number, or `count` of them.
        count: Number of rows.
        what: Name of the cost, for the message.

    Returns:
        Costs (count,).

    Raises:
        InputError: Another shape, or a negative number, nan or inf.
    """
    try:
        numbers = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"{what} is {value!r}; expected a number or {count} numbers.") from None
    if numbers.shape not in ((), (count,)):
        raise InputError(f"{what} has shape {numbers.shape}; expected a number or {count} numbers.")
    if not (np.isfinite(numbers) & (numbers >= 0.0)).all():
        raise InputError(f"{what} is {value}; expected finite numbers not below 0.")
    return np.broadcast_to(numbers, (count,)).astype(float)


def as_array(target: Any) -> Floats:
    """A target as an array; a pose or a rotation may come as SE3 or SO3."""
    if isinstance(target, SE3):
        return target.matrix()
    return np.asarray(target.matrix if isinstance(target, SO3) else target)
