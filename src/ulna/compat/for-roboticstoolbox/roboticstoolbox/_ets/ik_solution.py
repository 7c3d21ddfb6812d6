"""The result of inverse kinematics."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from ulna.typing import Floats

_MAX_PRINTED_ROWS = 6  # rows beyond which text leaves some out


@dataclass
class IKSolution:
    """The result of inverse kinematics: a sequence of rows of `q`, true when it converged.

    Attributes:
        q: Configuration, (n,), or (m, n) for m goals [rad or m]; None where nothing was found.
        success: Whether every goal is reached.
        iterations: Steps of all searches.
        searches: Number of searches.
        residual: E of the solution.
        reason: Why there is no solution; "Success" where the solvers in Python of the toolbox say so.
    """

    q: Any
    success: bool
    iterations: int = 0
    searches: int = 0
    residual: float = 0.0
    reason: str = ""

    def _rows(self) -> Floats:
        return np.empty((0, 0)) if self.q is None else np.atleast_2d(self.q)

    def __len__(self) -> int:
        return len(self._rows())

    def __iter__(self) -> Iterator[Floats]:
        return iter(self._rows())

    def __getitem__(self, index: Any) -> Floats:
        return self._rows()[index]

    def __bool__(self) -> bool:
        return bool(self.success)

    def astuple(self) -> tuple[Any, ...]:
        """(q, success, iterations, searches, residual, reason)."""
        return (self.q, self.success, self.iterations, self.searches, self.residual, self.reason)

    def report(self) -> str:
        """What `verbose=True` prints."""
        outcome = "reached" if self.success else f"not reached: {self.reason}"
        poses = f"{len(self)} poses" if np.ndim(self.q) == 2 else "pose"
        return f"{poses} {outcome}; {self.searches} searches, {self.iterations} steps, E={self.residual:.3e}"

    def __str__(self) -> str:
        parts = [f"success={bool(self.success)}"]
        if not self.success:
            parts.append(f"reason={self.reason}")
        if self.iterations or self.searches:
            parts += [f"iterations={self.iterations}", f"searches={self.searches}"]
        if self.iterations or self.searches or self.residual:
            parts.append(f"residual={self.residual:.3g}")
        if len(self) > 1:
            return f"IKSolution: {len(self)} poses, {', '.join(parts)}\nq={self._configuration_text()}"
        return f"IKSolution: {', '.join([f'q={self._configuration_text()}', *parts])}"

    __repr__ = __str__

    def _configuration_text(self) -> str:
        if self.q is None or np.ndim(self.q) == 1 or len(self) <= _MAX_PRINTED_ROWS:
            return "None" if self.q is None else _text(np.asarray(self.q))
        rows = self._rows()
        lines = [*(_text(row) for row in rows[:3]), "...", *(_text(row) for row in rows[-2:])]
        return "[" + ",\n ".join(lines) + "]"


def _text(numbers: Floats) -> str:
    form: Any = {"float": lambda x: f"{0 if abs(x) < 1e-6 else x:.4g}"}
    return np.array2string(numbers, separator=", ", formatter=form)
