"""Inverse kinematics under the toolbox's names: the solver of Ulna that each of them calls.

| name | solver of Ulna |
|---|---|
| `ik_LM`, `ikine_LM` with the default damping, 8 searches or more, and no null motion | `robot.ik` |
| the same with other damping, `ilimit`, fewer searches, null motion | `ik_classic`, "chan", "wampler" or "sugihara" |
| `ik_NR`, `ikine_NR`; `ik_GN`, `ikine_GN`; `ikine_QP` | "newton_raphson"; "gauss_newton"; "qp" |

The toolbox's `tol` bounds E = e^T W e / 2; a solution within it counts as converged. `robot.ik` goes
on to 1e-6 m and rad.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from roboticstoolbox._common.errors import UnknownOption, WrongShape
from roboticstoolbox._common.numbers import number, numbers
from roboticstoolbox._common.poses import matrices
from roboticstoolbox._ets.compiled_chain import Chain
from roboticstoolbox._ets.ik_solution import IKSolution
from ulna.control import p_servo
from ulna.errors import InputError
from ulna.typing import Floats

Kind = Literal["LM", "NR", "GN", "QP"]
Damping = Literal["chan", "wampler", "sugihara"]
_DAMPINGS: tuple[Damping, ...] = ("chan", "wampler", "sugihara")
_STEPS = 30  # of a search, by default
_MANY_SEARCHES = 8  # from which `robot.ik`, which makes several at once, keeps to their number
_SQUARE = 6  # joints of a chain whose Jacobian is square
_REFINED_TOLERANCE = 1e-6  # [m], [rad]
REACHED = "Success"
"""What `reason` of the solvers in Python of the toolbox says where a pose is reached."""
_KINDS = {"NR": "newton_raphson", "GN": "gauss_newton", "QP": "qp"}


def solve(
    chain: Chain,
    Tep: Any,
    kind: Kind = "LM",
    q0: Any = None,
    ilimit: int = _STEPS,
    slimit: int = 100,
    tol: float = 1e-6,
    mask: Any = None,
    joint_limits: bool = True,
    k: float = 1.0,
    method: Damping = "chan",
    kq: float = 0.0,
    km: float = 0.0,
    ps: float = 0.0,
    pi: Any = 0.3,
    kj: float = 1.0,
    ks: float = 1.0,
    seed: int | None = None,
    verbose: bool = False,
    pinv: bool = True,
    pinv_damping: float | None = 0.0,
    reason: str = "",
) -> IKSolution:
    """The solution for poses `Tep`, (4, 4) or (m, 4, 4), of the chain's end in its start.

    Args:
        chain: The chain of transforms.
        Tep: The poses.
        kind: The solver.
        q0: Where the first search begins, (n,), or the first searches, (k, n).
        ilimit: Steps of a search.
        slimit: How many searches are made; about as many where `robot.ik` makes them.
        tol: Greatest E that counts as reached [-].
        mask: What each of the six errors counts, (6,).
        joint_limits: Whether a solution must be within the limits.
        k: Damping of "LM" [-].
        method: How "LM" is damped.
        kq: The inverse of the gain that keeps joints from their limits in the null space [-]; 0 for none.
        km: The inverse of the gain of manipulability in the null space [-]; 0 for none.
        ps: Distance from a limit at which that gain is meant [rad or m].
        pi: Distance from a limit at which avoiding it begins [rad or m].
        kj: What joint speeds cost, of "QP" [-].
        ks: What the rest of the error costs, of "QP" [-].
        seed: Seed of the random starts.
        verbose: Whether to print what the search found.
        pinv: Whether "NR" and "GN" may take the pseudoinverse; a Jacobian that is not square has no other.
        pinv_damping: Damping d of that pseudoinverse, J^T (J J^T + d^2 I)^-1 [-]; 0 for none.
        reason: What `reason` of the result is where one pose is reached.

    Returns:
        Joint coordinates (n,) or (m, n), success, and figures of the search.

    Raises:
        InputError: An argument has the wrong shape or value.
    """
    T = matrices(Tep)
    chain = chain if joint_limits else chain.unlimited
    starts = None if q0 is None else _starting_rows(q0, chain.n, slimit)
    settings = Settings(
        kind, ilimit, tol, _weights(mask, chain.n), k, damping_name(method), kq, km, ps, pi, kj, ks, seed,
        0.0 if pinv_damping is None else number("pinv_damping", pinv_damping),
    )  # fmt: skip
    if not pinv and chain.n != _SQUARE:
        result = _without_inverse(chain, T, starts, slimit, settings)
    else:
        result = _searched(chain, T, starts, slimit, settings)
    if result.success and T.ndim == 2:
        result.reason = reason
    if verbose:
        print(result.report())
    return result


def _searched(chain: Chain, T: Floats, starts: Floats | None, slimit: int, settings: Settings) -> IKSolution:
    """The solution from these starting rows (k, n); None for a default."""
    if starts is None or len(starts) == 1:
        return _search(chain, T, None if starts is None else starts[0], slimit, settings)
    return _searches_from_rows(chain, T, starts, slimit, settings)


@dataclass(frozen=True)
class Settings:
    """The settings of a search, as `solve` names them."""

    kind: Kind
    ilimit: int
    tol: float
    weights: tuple[float, ...] | None
    k: float
    method: Damping
    kq: float
    km: float
    ps: float
    pi: Any
    kj: float
    ks: float
    seed: int | None
    pinv_damping: float = 0.0

    @property
    def solver(self) -> Any:
        """The name of Ulna's solver; steps by a damped pseudoinverse are Wampler's."""
        return "wampler" if self.pinv_damping else _KINDS.get(self.kind, self.method)

    @property
    def is_default(self) -> bool:
        """Whether `robot.ik` may solve, which has none of the settings of the classic solvers."""
        is_chan = self.kind == "LM" and self.method == "chan" and self.k == 1.0
        return is_chan and self.ilimit == _STEPS and not self.kq and not self.km

    @property
    def damping(self) -> float | None:
        """The damping of Ulna's solver."""
        if self.pinv_damping:
            return self.pinv_damping**2
        return self.k if self.kind == "LM" else self.kj / self.ks if self.kind == "QP" else None

    def null_motion(self) -> dict[str, float]:
        """The gains of Ulna's solver; the toolbox's are inverses, 1/kq ((d - pi)/(pi - ps))^2 at a distance d."""
        near = np.ravel(np.asarray(self.pi, dtype=float))
        if (near != near[0]).any():
            raise InputError(
                f"`pi` is {self.pi}; expected one number: joints with different ones are not offered."
            )
        begin = float(near[0])
        if not begin > self.ps:
            raise InputError(f"`pi` is {begin} and `ps` {self.ps}; expected `pi` greater than `ps`.")
        return {
            "limit_gain": (begin / (begin - self.ps)) ** 2 / self.kq if self.kq else 0.0,
            "influence": begin,
            "manipulability_gain": 1.0 / self.km if self.km else 0.0,
        }


def _search(chain: Chain, T: Floats, start: Any, slimit: int, settings: Settings) -> IKSolution:
    first = 0 if settings.seed is None else settings.seed
    tol = settings.tol
    if settings.is_default and slimit >= _MANY_SEARCHES:
        fine = _REFINED_TOLERANCE if tol >= _REFINED_TOLERANCE * _REFINED_TOLERANCE else math.sqrt(tol)
        result = chain.arm.ik(
            T,
            start,
            mask=settings.weights,
            position_tolerance=fine,
            rotation_tolerance=fine,
            seed=first,
            attempts=int(slimit),
        )
    else:
        null_motion: dict[str, Any] = dict(settings.null_motion())
        result = chain.arm.ik_classic(
            T,
            settings.solver,
            start,
            mask=settings.weights,
            damping=settings.damping,
            iterations=settings.ilimit,
            searches=slimit,
            position_tolerance=math.sqrt(tol),
            rotation_tolerance=math.sqrt(tol),
            seed=first,
            **null_motion,
        )
    return _summary(result, T, tol)


def _summary(result: Any, T: Floats, tol: float) -> IKSolution:
    """Ulna's result as the toolbox's, for one pose or several."""
    q, success, iterations, restarts, position, rotation = result.figures()
    if T.ndim == 2:
        residual = 0.5 * (position * position + rotation * rotation)
        is_met = success or residual < tol
        reason = "" if is_met else result.reason
        searches = restarts + 1 if success else restarts
        return IKSolution(q, is_met, iterations, searches, residual, reason)
    residuals = 0.5 * (np.square(position) + np.square(rotation))
    met = success | (residuals < tol)
    reason = "" if met.all() else f"no solution for the poses {np.flatnonzero(~met).tolist()}"
    counts = int(iterations.sum()), int((restarts + success).sum())
    return IKSolution(q, bool(met.all()), *counts, float(residuals.max()), reason)


def _searches_from_rows(
    chain: Chain, T: Floats, starts: Floats, slimit: int, settings: Settings
) -> IKSolution:
    """A search from each row of `starts` in turn, then from random configurations, until one reaches the pose."""
    solutions = []
    for goal in T.reshape(-1, 4, 4):
        iterations = searches = 0
        for i, start in enumerate(starts):
            following = slimit - i if i == len(starts) - 1 else 1
            one = _search(chain, goal, start, following, settings)
            iterations, searches = iterations + one.iterations, searches + one.searches
            if one.success:
                break
        one.iterations, one.searches = iterations, searches
        solutions.append(one)
    return solutions[0] if T.ndim == 2 else _joined(solutions)


def _without_inverse(
    chain: Chain, T: Floats, starts: Floats | None, slimit: int, settings: Settings
) -> IKSolution:
    """What a solver returns that inverts a Jacobian which is not square: a start that meets the pose, if one does."""
    reason = f"the Jacobian is 6 x {chain.n}, so that it has no inverse; pass pinv=True"
    rows = np.zeros((1, chain.n)) if starts is None else starts
    solutions = []
    for goal in T.reshape(-1, 4, 4):
        residuals = [_residual(chain.fk(row), goal, settings.weights) for row in rows]
        met = [i for i, residual in enumerate(residuals) if residual < settings.tol]
        at = met[0] if met else 0
        solutions.append(
            IKSolution(
                rows[at], bool(met), 0, at + 1 if met else slimit, residuals[at], "" if met else reason
            )
        )
    return solutions[0] if T.ndim == 2 else _joined(solutions)


def _residual(T: Floats, goal: Floats, weights: tuple[float, ...] | None) -> float:
    """E = e^T W e / 2 from one pose to another."""
    e = p_servo(T, goal, 1.0, 0.0, "angle-axis")[0]
    return float(0.5 * (e if weights is None else np.array(weights) * e) @ e)


def _joined(solutions: list[IKSolution]) -> IKSolution:
    """The solutions for several poses as one."""
    missed = [i for i, one in enumerate(solutions) if not one.success]
    return IKSolution(
        np.array([one.q for one in solutions]),
        not missed,
        sum(one.iterations for one in solutions),
        sum(one.searches for one in solutions),
        max(one.residual for one in solutions),
        f"no solution for the poses {missed}" if missed else "",
    )


def one_row(q0: Any, n: int) -> Any:
    """`q0` of the solvers that take one start only, (n,).

    Args:
        q0: What was passed, or None.
        n: Number of joints.

    Returns:
        `q0`, (n,), or None.

    Raises:
        WrongShape: It is no vector of `n` numbers.
    """
    if q0 is not None and np.shape(q0) != (n,):
        raise WrongShape("q0", np.shape(q0), f"({n},), a number for each joint of the chain")
    return q0


def damping_name(method: Any) -> Damping:
    """The method of "LM" by its first four letters, as the toolbox reads them.

    Raises:
        UnknownOption: It is none of them.
    """
    letters = str(method).lower()[:4]
    for name in _DAMPINGS:
        if name[:4] == letters:
            return name
    raise UnknownOption("method", method, _DAMPINGS)


def _starting_rows(q0: Any, n: int, slimit: int) -> Floats:
    rows = numbers("q0", q0)
    if rows.ndim not in (1, 2) or rows.shape[-1] != n or (rows.ndim == 2 and not 0 < len(rows) <= slimit):
        raise WrongShape("q0", rows.shape, f"({n},), or at most slimit = {slimit} rows (m, {n})")
    return rows if rows.ndim == 2 else rows[None]


def _weights(mask: Any, n: int) -> tuple[float, ...] | None:
    if mask is None:
        return (1.0,) * 6 if n < 6 else None
    weights = np.asarray(mask, dtype=float)
    if weights.shape != (6,):
        raise WrongShape("mask", weights.shape, "(6,): weights of x, y, z and of rotations about them")
    return tuple(weights.tolist())
