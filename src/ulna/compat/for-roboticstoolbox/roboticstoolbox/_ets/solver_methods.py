"""Inverse kinematics of a chain of transforms, by the names and signatures of the toolbox.

The settings are those of `roboticstoolbox._ets.inverse_kinematics.solve`. Without `pinv` `ikine_NR` and `ikine_GN`
find nothing for chains whose Jacobian is not square; `ik_NR` and `ik_GN` take the pseudoinverse of such in any case.
"""

from __future__ import annotations

from typing import Any, final

from roboticstoolbox._common.documentation import describe_arguments
from roboticstoolbox._ets.compiled_chain import Chain
from roboticstoolbox._ets.ik_solution import IKSolution
from roboticstoolbox._ets.inverse_kinematics import REACHED, one_row, solve


@describe_arguments
class ChainSolvers:
    """Inverse kinematics of a chain of transforms."""

    _compiled: Any

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
        chain = self._compiled(None)
        search: Any = (ilimit, slimit, tol, mask, joint_limits)
        return solve(chain, Tep, "LM", one_row(q0, chain.n), *search, k=k, method=method)

    def ik_NR(
        self,
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
        """The joint coordinates for a pose of the end, by Newton and Raphson's method.

        Args:
            q0: Where the search begins, (n,) [rad or m]; None for the neutral configuration.

        Returns:
            Joint coordinates (n,) or (m, n), success, and figures of the search.
        """
        chain = self._compiled(None)
        search: Any = (ilimit, slimit, tol, mask, joint_limits)
        return solve(chain, Tep, "NR", one_row(q0, chain.n), *search, pinv_damping=pinv_damping)

    def ik_GN(
        self,
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
        """The joint coordinates for a pose of the end, by Gauss and Newton's method.

        Args:
            q0: Where the search begins, (n,) [rad or m]; None for the neutral configuration.

        Returns:
            Joint coordinates (n,) or (m, n), success, and figures of the search.
        """
        chain = self._compiled(None)
        search: Any = (ilimit, slimit, tol, mask, joint_limits)
        return solve(chain, Tep, "GN", one_row(q0, chain.n), *search, pinv_damping=pinv_damping)

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
        null_motion: dict[str, Any] = {"kq": kq, "km": km, "ps": ps, "pi": pi}
        chain = self._compiled(None)
        return solve(
            chain,
            Tep,
            "LM",
            q0,
            *search,
            k=k,
            method=method,
            seed=seed,
            reason=REACHED,
            **null_motion,
            **more,
        )

    def ikine_NR(
        self,
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
        """The joint coordinates for a pose of the end, by Newton and Raphson's method and null-space motion.

        Args:
            **more: Other settings of `solve`.

        Returns:
            Joint coordinates (n,) or (m, n), success, and figures of the search.
        """
        search: Any = (ilimit, slimit, tol, mask, joint_limits)
        null_motion: dict[str, Any] = {"kq": kq, "km": km, "ps": ps, "pi": pi}
        chain = self._compiled(None)
        return solve(
            chain, Tep, "NR", q0, *search, pinv=bool(pinv), seed=seed, reason=REACHED, **null_motion, **more
        )

    def ikine_GN(
        self,
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
        """The joint coordinates for a pose of the end, by Gauss and Newton's method and null-space motion.

        Args:
            **more: Other settings of `solve`.

        Returns:
            Joint coordinates (n,) or (m, n), success, and figures of the search.
        """
        search: Any = (ilimit, slimit, tol, mask, joint_limits)
        null_motion: dict[str, Any] = {"kq": kq, "km": km, "ps": ps, "pi": pi}
        chain = self._compiled(None)
        return solve(
            chain, Tep, "GN", q0, *search, pinv=bool(pinv), seed=seed, reason=REACHED, **null_motion, **more
        )

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
        null_motion: dict[str, Any] = {"kq": kq, "km": km, "ps": ps, "pi": pi}
        chain = self._compiled(None)
        return solve(
            chain, Tep, "QP", q0, *search, kj=kj, ks=ks, seed=seed, reason=REACHED, **null_motion, **more
        )


@final
class SolversOfChain(ChainSolvers):
    """Inverse kinematics of a compiled chain."""

    def __init__(self, chain: Chain) -> None:
        self._chain = chain

    def _compiled(self, tool: None) -> Chain:
        return self._chain
