"""The solvers of inverse kinematics as objects: their settings, a whole search, and a single step.

| symbol | meaning | shape, unit |
|---|---|---|
| e | error from one pose to another: positions, and the rotation vector | (6,) [m, rad] |
| W | the mask | (6,) |
| E | e^T W e / 2 | |

Source: Haviland & Corke, Manipulator Differential Kinematics part 2 (2023), section V.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from roboticstoolbox._common.documentation import describe_arguments
from roboticstoolbox._common.errors import WrongShape
from roboticstoolbox._ets.ik_solution import IKSolution
from roboticstoolbox._ets.inverse_kinematics import REACHED, Damping, Kind, damping_name, solve
from roboticstoolbox.tools.servo import angle_axis
from ulna.errors import InputError
from ulna.ik.classic import Method, move
from ulna.ik.problem import Errors
from ulna.typing import Floats

_METHODS: tuple[Damping, ...] = ("chan", "sugihara", "wampler")  # by the toolbox's numbers


@describe_arguments
class IKSolver:
    """A solver with its settings, which are its attributes; `solve(ets, Tep, q0)` runs it.

    Attributes:
        We: The mask as a matrix, (6, 6).
    """

    kind: Kind = "LM"
    kq: float = 0.0
    km: float = 0.0

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any: ...

    def __init__(
        self,
        name: str = "IK Solver",
        ilimit: int = 30,
        slimit: int = 100,
        tol: float = 1e-6,
        mask: Any = None,
        joint_limits: bool = True,
        seed: int | None = None,
        verbose: bool = False,
    ) -> None:
        """A solver with settings.

        Args:
            name: What it is called.
            verbose: Whether `solve` prints what the search found.
        """
        self.name = name
        self.ilimit, self.slimit, self.tol, self.seed = ilimit, slimit, tol, seed
        self.joint_limits, self.verbose = joint_limits, verbose
        weights = np.ones(6) if mask is None else np.asarray(mask, dtype=float)
        if weights.shape != (6,):
            raise WrongShape("mask", weights.shape, "(6,): weights of x, y, z and of rotations about them")
        self.We = np.diag(weights)

    def _set_null_motion(self, name: str, kq: float, km: float, ps: float, pi: Any) -> None:
        """Sets the gains of the null space, and the name, which contains them."""
        self.kq, self.km, self.ps, self.pi = kq, km, ps, pi
        self.name = name + (" Σ" if kq > 0.0 else "") + (" Jm" if km > 0.0 else "")

    def _options(self) -> dict[str, Any]:
        """The settings of the method, as `solve` of `_ets.inverse_kinematics` names them."""
        return {}

    def solve(self, ets: Any, Tep: Any, q0: Any = None) -> IKSolution:
        """The solution for a chain of transforms and a pose of its end.

        Args:
            ets: The chain.

        Returns:
            Joint coordinates (n,) or (m, n), success, and figures of the search.
        """
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
            verbose=self.verbose,
            reason=REACHED,
            **self._options(),
        )

    def error(self, Te: Any, Tep: Any) -> tuple[Floats, float]:
        """The error from one pose to another.

        Args:
            Te: Pose, an SE3 or (4, 4).
            Tep: Pose to reach, an SE3 or (4, 4).

        Returns:
            e (6,) [m and rad], and E.
        """
        e = angle_axis(Te, Tep)
        return e, float(0.5 * (self._weights * e) @ e)

    @property
    def _weights(self) -> Floats:
        return np.diagonal(self.We)

    def step(self, ets: Any, Tep: Any, q: Any) -> tuple[float, Floats]:
        """One step towards a pose of the chain's end.

        Args:
            ets: The chain.
            Tep: Pose to reach, an SE3 or (4, 4).
            q: Joint coordinates (n,) [rad or m].

        Returns:
            E after the step, and the joint coordinates (n,) [rad or m].

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
        """Ulna's name of the method, and its damping, where the error is `e`."""
        raise InputError(f"{type(self).__name__} has no method; take IK_LM, IK_NR, IK_GN or IK_QP.")


@describe_arguments
class IK_LM(IKSolver):
    """Levenberg and Marquardt's method, damped as Chan, Sugihara or Wampler did."""

    def __init__(
        self,
        name: str = "IK Solver",
        ilimit: int = 30,
        slimit: int = 100,
        tol: float = 1e-6,
        mask: Any = None,
        joint_limits: bool = True,
        seed: int | None = None,
        k: float = 1.0,
        method: str = "chan",
        kq: float = 0.0,
        km: float = 0.0,
        ps: float = 0.0,
        pi: Any = 0.3,
        **kwargs: Any,
    ) -> None:
        """The settings of `IKSolver`, damping and method, and those of the null space; `name` is derived from them."""
        super().__init__(name, ilimit, slimit, tol, mask, joint_limits, seed, **kwargs)
        damping = damping_name(method)
        self.method, self.k = _METHODS.index(damping), k
        self._set_null_motion(f"LM ({damping.capitalize()} λ={k})", kq, km, ps, pi)

    @property
    def _damping(self) -> Damping:
        return damping_name(self.method) if isinstance(self.method, str) else _METHODS[self.method]

    def _options(self) -> dict[str, Any]:
        null = {"kq": self.kq, "km": self.km, "ps": self.ps, "pi": self.pi}
        return {"k": self.k, "method": self._damping, **null}

    def _method(self, e: Floats) -> tuple[Method, float]:
        return self._damping, float(self.k)


@describe_arguments
class _Inverting(IKSolver):
    """A solver that inverts the Jacobian."""

    def __init__(
        self,
        name: str = "IK Solver",
        ilimit: int = 30,
        slimit: int = 100,
        tol: float = 1e-6,
        mask: Any = None,
        joint_limits: bool = True,
        seed: int | None = None,
        pinv: bool = False,
        kq: float = 0.0,
        km: float = 0.0,
        ps: float = 0.0,
        pi: Any = 0.3,
        **kwargs: Any,
    ) -> None:
        """The settings of `IKSolver`, and those of the null space; without `pinv` J must be square."""
        super().__init__(name, ilimit, slimit, tol, mask, joint_limits, seed, **kwargs)
        self.pinv = pinv
        self._set_null_motion(f"{self.kind} (pinv={pinv})", kq, km, ps, pi)

    def _options(self) -> dict[str, Any]:
        return {"kq": self.kq, "km": self.km, "ps": self.ps, "pi": self.pi, "pinv": bool(self.pinv)}

    def step(self, ets: Any, Tep: Any, q: Any) -> tuple[float, Floats]:
        """One step from `q` towards a pose of the chain's end: E there, and where that is.

        Raises:
            LinAlgError: J is not square, and `pinv` is not set.
        """
        if not self.pinv and ets.n != 6:
            raise np.linalg.LinAlgError(f"The Jacobian is 6 x {ets.n}, so it has no inverse; set pinv=True.")
        return super().step(ets, Tep, q)

    def _method(self, e: Floats) -> tuple[Method, float]:
        return "newton_raphson", 0.0


class IK_NR(_Inverting):
    """Newton and Raphson's method."""

    kind = "NR"


class IK_GN(_Inverting):
    """Gauss and Newton's method."""

    kind = "GN"


@describe_arguments
class IK_QP(IKSolver):
    """Steps by quadratic programs: the least kj |dq|^2 + ks |slack|^2 / sum |e|, slack = e - J dq."""

    kind = "QP"

    def __init__(
        self,
        name: str = "IK Solver",
        ilimit: int = 30,
        slimit: int = 100,
        tol: float = 1e-6,
        mask: Any = None,
        joint_limits: bool = True,
        seed: int | None = None,
        kj: float = 0.01,
        ks: float = 1.0,
        kq: float = 0.0,
        km: float = 0.0,
        ps: float = 0.0,
        pi: Any = 0.3,
        **kwargs: Any,
    ) -> None:
        """The settings of `IKSolver`, what joint speeds (kj) and slack (ks) cost, and those of the null space."""
        super().__init__(name, ilimit, slimit, tol, mask, joint_limits, seed, **kwargs)
        self.kj, self.ks = kj, ks
        self._set_null_motion("QP)", kq, km, ps, pi)

    def _options(self) -> dict[str, Any]:
        null = {"kq": self.kq, "km": self.km, "ps": self.ps, "pi": self.pi}
        return {"kj": self.kj, "ks": self.ks, **null}

    def _method(self, e: Floats) -> tuple[Method, float]:
        return "wampler", float(self.kj) / float(self.ks) * float(np.abs(e).sum())


__all__ = ["IK_GN", "IK_LM", "IK_NR", "IK_QP", "IKSolution", "IKSolver"]
