"""Inverse kinematics under the toolbox's names: the solver of Ulna that each of them calls.

| name | solver of Ulna |
|---|---|
| `ik_LM`, `ikine_LM` with the default damping and nothing to do for the null space | `robot.ik` |
| `ik_LM`, `ikine_LM` with another damping or a null motion | `robot.ik_classic`, "chan", "wampler" or "sugihara" |
| `ik_NR`, `ikine_NR`; `ik_GN`, `ikine_GN`; `ikine_QP` | "newton_raphson"; "gauss_newton"; "qp" |

The toolbox's `tol` bounds E = e^T W e / 2; a solution within it counts as converged. `robot.ik` goes
on to 1e-6 m and rad.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from roboticstoolbox._common.poses import matrices
from roboticstoolbox._ets.compiled_chain import Chain
from ulna.typing import Floats

Damping = Literal["chan", "wampler", "sugihara"]
_FINE = 1e-6  # [m], [rad]
_KINDS = {"NR": "newton_raphson", "GN": "gauss_newton", "QP": "qp"}


@dataclass
class IKSolution:
    """The result of inverse kinematics: a sequence of rows of `q`, true when it converged.

    Attributes:
        q: Configuration, (n,), or (m, n) for m goals [rad or m].
        success: Whether every goal is reached.
        iterations: Steps of all searches.
        searches: Number of searches.
        residual: E of the solution.
        reason: Why there is no solution.
    """

    q: Floats
    success: bool
    iterations: int = 0
    searches: int = 0
    residual: float = 0.0
    reason: str = ""

    def _rows(self) -> Floats:
        return np.atleast_2d(self.q)

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

    def __str__(self) -> str:
        rows = ["[" + ", ".join(f"{x:.4g}" for x in row) + "]" for row in self._rows()]
        many = np.ndim(self.q) == 2
        parts = [f"{len(rows)} poses" if many else f"q={rows[0]}", f"success={self.success}"]
        if not self.success:
            parts.append(f"reason={self.reason}")
        if self.iterations or self.searches:
            parts += [f"iterations={self.iterations}", f"searches={self.searches}"]
        text = f"IKSolution: {', '.join([*parts, f'residual={self.residual:.3g}'])}"
        return text + ("\nq=[" + ",\n ".join(rows) + "]" if many else "")

    __repr__ = __str__


def solve(
    chain: Chain,
    Tep: Any,
    kind: Literal["LM", "NR", "GN", "QP"] = "LM",
    q0: Any = None,
    ilimit: int = 30,
    slimit: int = 100,
    tol: float = 1e-6,
    mask: Any = None,
    joint_limits: bool = True,
    k: float = 1.0,
    method: Damping = "chan",
    kq: float = 0.0,
    km: float = 0.0,
    pi: Any = 0.3,
    seed: int | None = None,
) -> IKSolution:
    """The solution for poses `Tep`, (4, 4) or (m, 4, 4), of the chain's end in its start."""
    T = matrices(Tep)
    chain = chain if joint_limits else chain.unlimited
    start = None if q0 is None else chain.q(q0)
    if start is not None and start.ndim == 2:
        start = start[0]
    weights = None if mask is None else tuple(float(w) for w in mask)
    if weights is None and chain.n < 6:
        weights = (1.0,) * 6
    first = 0 if seed is None else seed
    if kind == "LM" and method == "chan" and k == 1.0 and not kq and not km:
        fine = _FINE if tol >= _FINE * _FINE else math.sqrt(tol)
        result = chain.arm.ik(
            T,
            start,
            mask=weights,
            position_tolerance=fine,
            rotation_tolerance=fine,
            seed=first,
            attempts=int(slimit) if slimit >= 1 else 1,
        )
    else:
        result = chain.arm.ik_classic(
            T,
            _KINDS.get(kind, method),  # type: ignore[arg-type]
            start,
            mask=weights,
            damping=k if kind in ("LM", "QP") else None,
            limit_gain=kq,
            influence=float(np.max(pi)),
            manipulability_gain=km,
            iterations=ilimit,
            searches=slimit,
            position_tolerance=math.sqrt(tol),
            rotation_tolerance=math.sqrt(tol),
            seed=first,
        )
    q, success, iterations, restarts, position, rotation = result.figures()
    if T.ndim == 2:
        residual = 0.5 * (position * position + rotation * rotation)
        is_met = success or residual < tol
        reason = "" if is_met else result.reason
        return IKSolution(q, is_met, iterations, restarts + 1, residual, reason)
    residuals = 0.5 * (np.square(position) + np.square(rotation))
    met = success | (residuals < tol)
    reason = "" if met.all() else f"no solution for the poses {np.flatnonzero(~met).tolist()}"
    counts = int(iterations.sum()), int((restarts + 1).sum())
    return IKSolution(q, bool(met.all()), *counts, float(residuals.max()), reason)


_KNOWN = {"k", "method", "kq", "km", "pi", "seed"}
_IGNORED = {"pinv", "pinv_damping", "ps", "kj", "ks", "verbose", "progress"}


def settings(options: dict[str, Any]) -> dict[str, Any]:
    """The settings that `solve` takes among those of the toolbox.

    Raises:
        TypeError: The toolbox has no such setting.
    """
    if not options:
        return options
    unknown = set(options) - _KNOWN - _IGNORED
    if unknown:
        known = ", ".join(sorted(_KNOWN | _IGNORED))
        raise TypeError(f"unexpected settings {', '.join(sorted(unknown))}; expected some of {known}.")
    return {name: value for name, value in options.items() if name in _KNOWN}
