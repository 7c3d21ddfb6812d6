"""Inverse kinematics of a robot, by the names and signatures of the toolbox.

The settings are those of `roboticstoolbox._ets.inverse_kinematics.solve`. Without `pinv` `ikine_NR` and `ikine_GN`
find nothing for chains whose Jacobian is not square; `ik_NR` and `ik_GN` take the pseudoinverse of such in any case.
"""

from __future__ import annotations

from typing import Any

from roboticstoolbox._common.documentation import describe_arguments
from roboticstoolbox._ets.ik_solution import IKSolution
from roboticstoolbox._ets.solver_methods import SolversOfChain


@describe_arguments
class RobotSolvers:
    """Inverse kinematics of a robot."""

    _chain: Any

    def _solvers(self, end: Any, start: Any, tool: Any) -> SolversOfChain:
        return SolversOfChain(self._chain(end, start, tool))

    def ik_LM(
        self,
        Tep: Any,
        end: Any = None,
        start: Any = None,
        q0: Any = None,
        ilimit: int = 30,
        slimit: int = 100,
        tol: float = 1e-6,
        mask: Any = None,
        joint_limits: bool = True,
        k: float = 1.0,
        method: Any = "chan",
        tool: Any = None,
    ) -> IKSolution:
        """The configuration for a pose of the end in the base, by Levenberg and Marquardt's method.

        Args:
            q0: Where the search begins, (n,) [rad or m]; None for the neutral configuration.

        Returns:
            Joint coordinates (n,) or (m, n), success, and figures of the search.
        """
        chain = self._solvers(end, start, tool)
        return chain.ik_LM(Tep, q0, ilimit, slimit, tol, mask, joint_limits, k, method)

    def ik_NR(
        self,
        Tep: Any,
        end: Any = None,
        start: Any = None,
        q0: Any = None,
        ilimit: int = 30,
        slimit: int = 100,
        tol: float = 1e-6,
        mask: Any = None,
        joint_limits: bool = True,
        pinv: int = True,
        pinv_damping: float = 0.0,
        tool: Any = None,
    ) -> IKSolution:
        """The configuration for a pose of the end in the base, by Newton and Raphson's method.

        Args:
            q0: Where the search begins, (n,) [rad or m]; None for the neutral configuration.

        Returns:
            Joint coordinates (n,) or (m, n), success, and figures of the search.
        """
        chain = self._solvers(end, start, tool)
        return chain.ik_NR(Tep, q0, ilimit, slimit, tol, mask, joint_limits, pinv, pinv_damping)

    def ik_GN(
        self,
        Tep: Any,
        end: Any = None,
        start: Any = None,
        q0: Any = None,
        ilimit: int = 30,
        slimit: int = 100,
        tol: float = 1e-6,
        mask: Any = None,
        joint_limits: bool = True,
        pinv: int = True,
        pinv_damping: float = 0.0,
        tool: Any = None,
    ) -> IKSolution:
        """The configuration for a pose of the end in the base, by Gauss and Newton's method.

        Args:
            q0: Where the search begins, (n,) [rad or m]; None for the neutral configuration.

        Returns:
            Joint coordinates (n,) or (m, n), success, and figures of the search.
        """
        chain = self._solvers(end, start, tool)
        return chain.ik_GN(Tep, q0, ilimit, slimit, tol, mask, joint_limits, pinv, pinv_damping)

    def ikine_LM(
        self,
        Tep: Any,
        end: Any = None,
        start: Any = None,
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
        tool: Any = None,
        **more: Any,
    ) -> IKSolution:
        """The configuration for a pose of the end in the base, by Levenberg and Marquardt's method and null-space
        motion.

        Args:
            **more: Other settings of `solve`.

        Returns:
            Joint coordinates (n,) or (m, n), success, and figures of the search.
        """
        chain = self._solvers(end, start, tool)
        search = (ilimit, slimit, tol, mask, joint_limits, seed)
        return chain.ikine_LM(Tep, q0, *search, k, method, kq, km, ps, pi, **more)

    def ikine_NR(
        self,
        Tep: Any,
        end: Any = None,
        start: Any = None,
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
        tool: Any = None,
        **more: Any,
    ) -> IKSolution:
        """The configuration for a pose of the end in the base, by Newton and Raphson's method and null-space
        motion.

        Args:
            **more: Other settings of `solve`.

        Returns:
            Joint coordinates (n,) or (m, n), success, and figures of the search.
        """
        chain = self._solvers(end, start, tool)
        search = (ilimit, slimit, tol, mask, joint_limits, seed)
        return chain.ikine_NR(Tep, q0, *search, pinv, kq, km, ps, pi, **more)

    def ikine_GN(
        self,
        Tep: Any,
        end: Any = None,
        start: Any = None,
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
        tool: Any = None,
        **more: Any,
    ) -> IKSolution:
        """The configuration for a pose of the end in the base, by Gauss and Newton's method and null-space motion.

        Args:
            **more: Other settings of `solve`.

        Returns:
            Joint coordinates (n,) or (m, n), success, and figures of the search.
        """
        chain = self._solvers(end, start, tool)
        search = (ilimit, slimit, tol, mask, joint_limits, seed)
        return chain.ikine_GN(Tep, q0, *search, pinv, kq, km, ps, pi, **more)

    def ikine_QP(
        self,
        Tep: Any,
        end: Any = None,
        start: Any = None,
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
        tool: Any = None,
        **more: Any,
    ) -> IKSolution:
        """The configuration for a pose of the end in the base, by quadratic programs.

        Args:
            **more: Other settings of `solve`.

        Returns:
            Joint coordinates (n,) or (m, n), success, and figures of the search.
        """
        chain = self._solvers(end, start, tool)
        search = (ilimit, slimit, tol, mask, joint_limits, seed)
        return chain.ikine_QP(Tep, q0, *search, kj, ks, kq, km, ps, pi, **more)
