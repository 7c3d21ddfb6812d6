"""Inverse kinematics of a chain of transforms, by the names and signatures of the toolbox.

The settings are those of `roboticstoolbox._ets.inverse_kinematics.solve`. Without `pinv` `ikine_NR` and `ikine_GN`
find nothing for chains whose Jacobian is not square; `ik_NR` and `ik_GN` take the pseudoinverse of such in any case.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, final

from roboticstoolbox._common.documentation import describe_arguments
from roboticstoolbox._ets.compiled_chain import Chain
from roboticstoolbox._ets.ik_solution import IKSolution
from roboticstoolbox._ets.inverse_kinematics import REACHED, Kind, one_row, solve

Method = TypeVar("Method", bound=Callable[..., IKSolution])  # so that type checkers see its arguments
_METHODS: dict[Kind, str] = {"NR": "Newton and Raphson's method", "GN": "Gauss and Newton's method"}


def _ik_by_inversion(kind: Kind, doc: str | None):
    """The method that inverts the Jacobian, from one start; `doc` is that of `ik_LM`."""

    def ik(
        self: ChainSolvers,
        Tep: Any,
        q0: Any = None,
        ilimit: int = 30,
        slimit: int = 100,
        tol: float = 1e-6,
        mask: Any = None,
        joint_limits: bool = True,
        pinv: int = True,
        pinv_damping: float = 0.0,
    ) -> IKSolution:
        search: Any = (ilimit, slimit, tol, mask, joint_limits)
        return self._from_one_start(kind, Tep, q0, search, pinv_damping=pinv_damping)

    return _named(ik, f"ik_{kind}", kind, doc)


def _ikine_by_inversion(kind: Kind, doc: str | None):
    """The method that inverts the Jacobian, from several starts; `doc` is that of `ikine_LM`."""

    def ikine(
        self: ChainSolvers,
        Tep: Any,
        q0: Any = None,
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
        **more: Any,
    ) -> IKSolution:
        search: Any = (ilimit, slimit, tol, mask, joint_limits)
        null_motion = {"kq": kq, "km": km, "ps": ps, "pi": pi}
        return self._from_several_starts(kind, Tep, q0, search, seed, null_motion, pinv=bool(pinv), **more)

    return _named(ikine, f"ikine_{kind}", kind, doc)


def _named(method: Method, name: str, kind: Kind, doc: str | None) -> Method:
    """The method under its name, with the docstring of that of Levenberg and Marquardt, rewritten."""
    method.__name__, method.__qualname__ = name, f"ChainSolvers.{name}"
    method.__doc__ = (doc or "").replace("Levenberg and Marquardt's method", _METHODS[kind])
    return method


@describe_arguments
class ChainSolvers:
    """Inverse kinematics of a chain of transforms."""

    _compiled: Any

    def _from_one_start(self, kind: Kind, Tep: Any, q0: Any, search: Any, **settings: Any) -> IKSolution:
        chain = self._compiled(None)
        return solve(chain, Tep, kind, one_row(q0, chain.n), *search, **settings)

    def _from_several_starts(
        self, kind: Kind, Tep: Any, q0: Any, search: Any, seed: Any, null_motion: Any, **settings: Any
    ) -> IKSolution:
        chain = self._compiled(None)
        return solve(chain, Tep, kind, q0, *search, seed=seed, reason=REACHED, **null_motion, **settings)

    def ik_LM(
        self,
        Tep: Any,
        q0: Any = None,
        ilimit: int = 30,
        slimit: int = 100,
        tol: float = 1e-6,
        mask: Any = None,
        joint_limits: bool = True,
        k: float = 1.0,
        method: Any = "chan",
    ) -> IKSolution:
        """The joint coordinates for a pose of the end, by Levenberg and Marquardt's method.

        Args:
            q0: Where the search begins, (n,) [rad or m]; None for the neutral configuration.

        Returns:
            Joint coordinates (n,) or (m, n), success, and figures of the search.
        """
        search: Any = (ilimit, slimit, tol, mask, joint_limits)
        return self._from_one_start("LM", Tep, q0, search, k=k, method=method)

    ik_NR, ik_GN = _ik_by_inversion("NR", ik_LM.__doc__), _ik_by_inversion("GN", ik_LM.__doc__)

    def ikine_LM(
        self,
        Tep: Any,
        q0: Any = None,
        ilimit: int = 30,
        slimit: int = 100,
        tol: float = 1e-6,
        mask: Any = None,
        joint_limits: bool = True,
        seed: int | None = None,
        k: float = 1.0,
        method: Any = "chan",
        kq: float = 0.0,
        km: float = 0.0,
        ps: float = 0.0,
        pi: Any = 0.3,
        **more: Any,
    ) -> IKSolution:
        """The joint coordinates for a pose of the end, by Levenberg and Marquardt's method and null-space motion.

        Args:
            **more: Other settings of `solve`.

        Returns:
            Joint coordinates (n,) or (m, n), success, and figures of the search.
        """
        search: Any = (ilimit, slimit, tol, mask, joint_limits)
        null_motion = {"kq": kq, "km": km, "ps": ps, "pi": pi}
        return self._from_several_starts("LM", Tep, q0, search, seed, null_motion, k=k, method=method, **more)

    ikine_NR = _ikine_by_inversion("NR", ikine_LM.__doc__)
    ikine_GN = _ikine_by_inversion("GN", ikine_LM.__doc__)

    def ikine_QP(
        self,
        Tep: Any,
        q0: Any = None,
        ilimit: int = 30,
        slimit: int = 100,
        tol: float = 1e-6,
        mask: Any = None,
        joint_limits: bool = True,
        seed: int | None = None,
        kj: float = 1.0,
        ks: float = 1.0,
        kq: float = 0.0,
        km: float = 0.0,
        ps: float = 0.0,
        pi: Any = 0.3,
        **more: Any,
    ) -> IKSolution:
        """The joint coordinates for a pose of the end, by quadratic programs.

        Args:
            **more: Other settings of `solve`.

        Returns:
            Joint coordinates (n,) or (m, n), success, and figures of the search.
        """
        search: Any = (ilimit, slimit, tol, mask, joint_limits)
        null_motion = {"kq": kq, "km": km, "ps": ps, "pi": pi}
        return self._from_several_starts("QP", Tep, q0, search, seed, null_motion, kj=kj, ks=ks, **more)


@final
class SolversOfChain(ChainSolvers):
    """Inverse kinematics of a compiled chain."""

    def __init__(self, chain: Chain) -> None:
        self._chain = chain

    def _compiled(self, tool: None) -> Chain:
        return self._chain
