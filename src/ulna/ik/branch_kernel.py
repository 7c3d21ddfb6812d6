"""The compiled kernel behind `ik_all`, bare, for hot loops: a pose in, every branch with its errors out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, final

import numpy as np

from ulna.checks.values import names as checked_names
from ulna.errors import InputError
from ulna.ik.analytic.candidates import ClosedForm, between, source_of
from ulna.model import Model
from ulna.typing import Floats


@final
class BranchKernel:
    """Every branch of an arm with a closed form, as a call of some microseconds that checks nothing.

    `kernel(T)` returns candidates `q` (..., 8, nq), and for each an `evaluation` (..., 8, 3): the distance [m] and the
    angle [rad] from its pose, by forward kinematics, to the goal; and 1 within the joint limits, else 0. Those with
    errors that are not close to zero are no solutions. Where branches meet, a solution may be there twice.

    Attributes:
        gufunc: What it calls, (T, T_base, free_value, branch, base, centre) -> (q, evaluation); see
            `ulna.ik.analytic.closed`.
        method: How it works, as a sentence.
        free: Name of the joint that `free_value` is the value of; None where there is none.

    Args:
        model: The robot.
        frame: Name of the frame.
        joints: Names of the joints that move; None for all that carry the frame.
        free: Name of the joint of a redundant arm that values are passed for; None for a default.

    Raises:
        InputError: The arm has no closed form.
    """

    def __init__(self, model: Model, frame: str, joints: Sequence[str] | None, free: str | None) -> None:
        names = None if joints is None else checked_names("joints", joints)
        default_start = np.clip(model.neutral, model.lower_position, model.upper_position)
        fixed = tuple(default_start[list(between(model, frame, names))].tolist())
        source = source_of(model, frame, names, free, fixed)
        if not isinstance(source, ClosedForm):
            raise InputError(
                f"The arm that carries {frame!r} has no closed form: {source.method}. Use ik_all."
            )
        self._source, self._default_start = source, default_start
        self.gufunc = source.kernel.gufunc
        self.method = source.method
        self.free = None if source.free is None else source.arm.names[source.free]

    def __call__(
        self, T: Floats, q0: Floats | None = None, free_value: Any = 0.0, *, held: Any = None
    ) -> tuple[Floats, Floats]:
        """Every branch.

        Args:
            T: T_world_frame, shape (..., 4, 4) [m].
            q0: Configuration, shape (..., nq) [rad, m], that angles come next to; None for the limits' side of 0.
            free_value: Value of the free joint, shape (...) [rad, m].
            held: The former name of `free_value`.

        Returns:
            `q`, shape (..., 8, nq) [rad, m], and `evaluation`, shape (..., 8, 3); see `BranchKernel`.
        """
        source, free_value = self._source, free_value if held is None else held
        base = (self._default_start if q0 is None else q0)[..., None, :]
        centre = source.centre if q0 is None else base[..., source.index]
        at = source.base(base)
        return self.gufunc(
            T[..., None, :, :], at, np.asarray(free_value)[..., None, None], source.numbers, base, centre
        )
