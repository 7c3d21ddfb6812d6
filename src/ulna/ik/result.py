"""Results of inverse kinematics: configurations and their errors."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, final

import numpy as np

from ulna.idioms import Explained, explained
from ulna.lazy import Collection
from ulna.typing import Floats

if TYPE_CHECKING:
    from ulna.ik.problem import Problem

_AT_LIMIT = 1e-9
_MAX_PRINTED = 4
_ROUNDING = 1e-12


@final
@explained("solution")
class IKSolution(Collection, metaclass=Explained):
    """The answer of `robot.ik`, for one goal or a batch of them; it cannot be changed.

    It counts as true when the goal is met, so `if solution:` works; a batch has no single truth value. Of goals in a
    Dask array all parts are Dask arrays, and `solution.compute()` solves for all goals at once.
    """

    __slots__ = ("_problem", "_raw")

    def __init__(self, problem: Problem, raw: Floats) -> None:
        """The answer from what a search returned.

        Args:
            problem: What was solved.
            raw: q, status, steps, starting point and the errors of each frame, shape (..., n): see
                `search.multi_start`.
        """
        self._problem = problem
        self._raw = raw

    def _arrays(self) -> tuple[Any, ...]:
        return (self._raw,)

    def _with_arrays(self, arrays: Sequence[Any]) -> IKSolution:
        return IKSolution(self._problem, arrays[0])

    @property
    def q(self) -> Floats:
        """The configuration, (..., nq): the solution, or, where there is none, the nearest that was found."""
        nq = self._problem.model.nq
        return self._raw[:nq] if self._raw.ndim == 1 else self._raw[..., :nq]

    @property
    def success(self) -> Any:
        """Whether every goal is met, (...): errors within their tolerances, joints within their limits."""
        met = self._part(0) > 0.5
        return bool(met) if type(met) is np.bool_ else met

    @property
    def position_error(self) -> Any:
        """Distance from the goal, of what counts of it [m], (...); (..., k) for k frames."""
        return self._errors(0)

    @property
    def rotation_error(self) -> Any:
        """Angle from the goal, of what counts of it [rad], (...); (..., k) for k frames."""
        return self._errors(1)

    @property
    def iterations(self) -> Any:
        """How many steps the search took, (...); it takes each step from several starting points at once."""
        return self._whole(1)

    @property
    def restarts(self) -> Any:
        """Number of the starting point the answer came from, (...): 0 for `q0` or, without, the rest configuration."""
        return self._whole(2)

    @property
    def reason(self) -> Any:
        """Why there is no solution, as text; "" where there is one. An array of such, (...), for a batch."""
        self._require_numbers("reason")
        if self._raw.ndim == 1:
            return self._reason_of(self._raw)
        rows = self._raw.reshape(-1, self._raw.shape[-1])
        reasons = np.empty(len(rows), dtype=object)
        reasons[:] = [self._reason_of(row) for row in rows]
        return reasons.reshape(self._raw.shape[:-1])

    def __len__(self) -> int:
        if self._raw.ndim == 1:
            raise TypeError("A single solution has no length; a batch has.")
        return len(self._raw)

    def __getitem__(self, index: Any) -> IKSolution:
        """The solutions at `index` of a batch."""
        if self._raw.ndim == 1:
            raise TypeError("A single solution cannot be indexed; its configuration is `.q`.")
        width = self._raw.shape[-1]
        return IKSolution(self._problem, self._raw[index].reshape(*self._raw[..., 0][index].shape, width))

    def __bool__(self) -> bool:
        self._require_numbers("success")
        if self._raw.ndim > 1:
            raise TypeError(
                "A batch of solutions has no single truth; use `.success.all()` or `.success.any()`."
            )
        return self.success

    def __repr__(self) -> str:
        if self.is_lazy:
            return f"<lazy IK solutions {self._raw.shape[:-1]}; .compute() solves for them>"
        if self._raw.ndim > 1:
            return f"<{self._raw[..., 0].size} IK solutions, {int(self.success.sum())} of them successful>"
        status = "solution" if self.success else f"no solution: {self.reason}"
        with np.printoptions(precision=_MAX_PRINTED, suppress=True):
            return f"<IK {status}, q={self.q}, {self.iterations} iterations>"

    def figures(self) -> tuple[Any, ...]:
        """(q, success, iterations, restarts, position_error, rotation_error) at once, where a microsecond counts."""
        if self._raw.ndim > 1 or len(self._problem.frames) > 1 or type(self._raw) is not np.ndarray:
            errors = self.position_error, self.rotation_error
            return (self.q, self.success, self.iterations, self.restarts, *errors)
        nq = self._problem.model.nq
        status, steps, start, position, rotation = self._raw[nq:].tolist()
        return self._raw[:nq], status > 0.5, int(steps), int(start), position, rotation

    def _part(self, number: int) -> Any:
        at = self._problem.model.nq + number
        return self._raw[at] if self._raw.ndim == 1 else self._raw[..., at]

    def _whole(self, number: int) -> Any:
        part = self._part(number)
        return int(part) if type(part) is np.float64 else part.astype(int)

    def _errors(self, number: int) -> Any:
        out = self._raw[..., self._problem.model.nq + 3 + number :: 2]
        if len(self._problem.frames) > 1:
            return out
        return float(out[0]) if type(out) is np.ndarray and out.ndim == 1 else out[..., 0]

    def _reason_of(self, row: Floats) -> str:
        nq = self._problem.model.nq
        if row[nq] > 0.5:
            return ""
        parts = [
            f"{frame.name} stays {_shown(row[nq + 3 + 2 * k])} m and {_shown(row[nq + 4 + 2 * k])} rad from its goal"
            for k, frame in enumerate(self._problem.frames)
        ]
        lower, upper = self._problem.limits
        names = self._problem.model.position_names
        at_limit = [
            names[i]
            for i in self._problem.positions
            if row[i] <= lower[i] + _AT_LIMIT or row[i] >= upper[i] - _AT_LIMIT
        ]
        end = f", with {', '.join(at_limit)} at the limit" if at_limit else ""
        return f"the nearest found: {'; '.join(parts)}{end}"


def _shown(error: float) -> str:
    """An error with three digits; one below 1e-12 is rounding."""
    return f"{error:.3g}" if error > _ROUNDING else "0"
