"""The solvers of inverse kinematics as objects: their settings, a whole search, and a single step.

| symbol | meaning | shape, unit |
|---|---|---|
| e | error from one pose to another: positions, and the rotation vector | (6,) [m, rad] |
| W | the mask | (6,) |
| E | e^T W e / 2 | |

Source: Haviland & Corke, Manipulator Differential Kinematics part 2 (2023), section V.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np

from roboticstoolbox._ets.inverse_kinematics import IKSolution, settings, solve
from roboticstoolbox.tools.servo import angle_axis
from ulna.errors import InputError
from ulna.ik.classic import Method, move
from ulna.ik.problem import Errors
from ulna.typing import Floats


class IKSolver:
    """A solver with its settings, which are its attributes; `solve(ets, Tep, q0)` runs it.

    Attributes:
        We: The mask as a matrix, (6, 6).
    """

    kind: Literal["LM", "NR", "GN", "QP"] = "LM"
    _settings: ClassVar[dict[str, Any]] = {}

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any: ...

    def __init__(
        self,
        name: str = "",
        ilimit: int = 30,
        slimit: int = 100,
        tol: float = 1e-6,
        mask: Any = None,
        joint_limits: bool = True,
        seed: int | None = None,
        verbose: bool = False,
        **rest: Any,
    ) -> None:
        """A solver with settings.

        Args:
            name: What it is called.
            ilimit: Steps of a search.
            slimit: How many searches are made.
            tol: Greatest E that counts as reached.
            mask: What each of the six errors counts, (6,).
            joint_limits: Whether a solution must be within the limits.
            seed: Seed of the random starts.
            verbose: Accepted and ignored.
            **rest: Settings of the method: k and method of LM; kq, km and pi of the null space; kj and ks of QP. What
                only tells how the toolbox computes, pinv and ps, is let pass.
        """
        settings(rest)
        self.name = name or type(self).__name__
        self.ilimit, self.slimit, self.tol, self.seed = ilimit, slimit, tol, seed
        self.joint_limits, self.verbose = joint_limits, verbose
        self.We = np.diag(np.ones(6) if mask is None else np.asarray(mask, dtype=float).ravel())
        for key, value in ({"kq": 0.0, "km": 0.0, "ps": 0.0, "pi": 0.3} | self._settings | rest).items():
            setattr(self, key, value)

    def solve(self, ets: Any, Tep: Any, q0: Any = None) -> IKSolution:
        """The solution for a chain of transforms and a pose of its end."""
        options = {
            name: getattr(self, name) for name in ("k", "method", "kq", "km", "pi") if hasattr(self, name)
        }
        return solve(
            ets._compiled(None),
            Tep,
            self.kind,
            q0,
            ilimit=self.ilimit,
            slimit=self.slimit,
            tol=self.tol,
            mask=None if (self._weights == 1.0).all() else self._weights,
            joint_limits=self.joint_limits,
            seed=self.seed,
            **options,
        )

    def error(self, Te: Any, Tep: Any) -> tuple[Floats, float]:
        """The error e from the pose `Te` to `Tep`, (6,), and E."""
        e = angle_axis(Te, Tep)
        return e, float(0.5 * (self._weights * e) @ e)

    @property
    def _weights(self) -> Floats:
        return np.diagonal(self.We)

    def step(self, ets: Any, Tep: Any, q: Any) -> tuple[float, Floats]:
        """One step from the joint coordinates `q` towards a pose of the chain's end: E there, and where that is.

        Raises:
            InputError: The solver moves joints in the null space, too, which only `solve` supports.
        """
        if self.kq or self.km:
            raise InputError("A step with `kq` or `km` is not offered; `solve` supports them.")
        chain = ets._compiled(None)
        at = chain.q(q)
        e, _ = self.error(chain.fk(at), Tep)
        method, damping = self._method(e)
        scale = np.sqrt(self._weights) if self.kind == "LM" else np.ones(6)
        e, J = scale * e, scale[:, None] * chain.jacob0(at)
        moved = at + move(Errors(e @ e, False, e, J), method, damping)
        return self.error(chain.fk(moved), Tep)[1], moved

    def _method(self, e: Floats) -> tuple[Method, float]:
        """Ulna's name of the method, and its damping."""
        return "newton_raphson", 0.0


class IK_LM(IKSolver):
    """Levenberg and Marquardt's method, damped as Chan, Sugihara or Wampler did."""

    _settings: ClassVar = {"k": 1.0, "method": "chan"}

    def _method(self, e: Floats) -> tuple[Method, float]:
        wanted = str(self.method).lower()[:4]
        method: Method = "sugihara" if wanted == "sugi" else "wampler" if wanted == "wamp" else "chan"
        return method, float(self.k)


class IK_NR(IKSolver):
    """Newton and Raphson's method."""

    kind = "NR"
    _settings: ClassVar = {"pinv": False}


class IK_GN(IKSolver):
    """Gauss and Newton's method."""

    kind = "GN"
    _settings: ClassVar = {"pinv": False}


class IK_QP(IKSolver):
    """Steps by quadratic programs: the least kj |dq|^2 + ks |slack|^2 / sum |e|, slack = e - J dq."""

    kind = "QP"
    _settings: ClassVar = {"kj": 1.0, "ks": 1.0}

    def _method(self, e: Floats) -> tuple[Method, float]:
        return "wampler", float(self.kj) / float(self.ks) * float(np.abs(e).sum())


__all__ = ["IK_GN", "IK_LM", "IK_NR", "IK_QP", "IKSolution", "IKSolver"]
