"""Inverse kinematics of a chain of transforms, by the names and signatures of the toolbox.

The settings are those of `roboticstoolbox._ets.inverse_kinematics.solve`. Without `pinv` `ikine_NR` and `ikine_GN`
find nothing for chains whose Jacobian is not square; `ik_NR` and `ik_GN` take the pseudoinverse of such in any case.
"""

from __future__ import annotations

from typing import Any

from roboticstoolbox._ets.ik_solution import IKSolution
from roboticstoolbox._ets.inverse_kinematics import check_pinv_damping, one_row, solve


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
            Tep: Pose of the end, an SE3, (4, 4) or (m, 4, 4).
            q0: Where the search begins, (n,) [rad or m]; None for the neutral configuration.
            ilimit: Greatest number of steps of a search.
            slimit: Greatest number of searches.
            tol: Greatest E = e^T W e / 2 that counts as reached [-].
            mask: Weights of the errors along and about x, y, z, (6,); 1 by default.
            joint_limits: Whether a solution must be within the limits.
            k: Damping [-].
            method: How it is damped: "chan", "wampler" or "sugihara".

        Returns:
            Joint coordinates (n,) or (m, n), success, and figures of the search.
        """
        chain = self._compiled(None)
        return solve(
            chain, Tep, "LM", one_row(q0, chain.n), ilimit, slimit, tol, mask, joint_limits, k, method
        )

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
            Tep: Pose of the end, an SE3, (4, 4) or (m, 4, 4).
            q0: Where the search begins, (n,) [rad or m]; None for the neutral configuration.
            ilimit: Greatest number of steps of a search.
            slimit: Greatest number of searches.
            tol: Greatest E = e^T W e / 2 that counts as reached [-].
            mask: Weights of the errors along and about x, y, z, (6,); 1 by default.
            joint_limits: Whether a solution must be within the limits.
            pinv: Whether to take the pseudoinverse of the Jacobian.
            pinv_damping: Not offered [-]; must be 0.

        Returns:
            Joint coordinates (n,) or (m, n), success, and figures of the search.
        """
        check_pinv_damping(pinv_damping)
        chain = self._compiled(None)
        return solve(chain, Tep, "NR", one_row(q0, chain.n), ilimit, slimit, tol, mask, joint_limits)

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
            Tep: Pose of the end, an SE3, (4, 4) or (m, 4, 4).
            q0: Where the search begins, (n,) [rad or m]; None for the neutral configuration.
            ilimit: Greatest number of steps of a search.
            slimit: Greatest number of searches.
            tol: Greatest E = e^T W e / 2 that counts as reached [-].
            mask: Weights of the errors along and about x, y, z, (6,); 1 by default.
            joint_limits: Whether a solution must be within the limits.
            pinv: Whether to take the pseudoinverse of the Jacobian.
            pinv_damping: Not offered [-]; must be 0.

        Returns:
            Joint coordinates (n,) or (m, n), success, and figures of the search.
        """
        check_pinv_damping(pinv_damping)
        chain = self._compiled(None)
        return solve(chain, Tep, "GN", one_row(q0, chain.n), ilimit, slimit, tol, mask, joint_limits)

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
            Tep: Pose of the end, an SE3, (4, 4) or (m, 4, 4).
            q0: Where the searches begin, (n,) or (k, n) [rad or m]; None for the neutral configuration.
            ilimit: Greatest number of steps of a search.
            slimit: Greatest number of searches.
            tol: Greatest E = e^T W e / 2 that counts as reached [-].
            mask: Weights of the errors along and about x, y, z, (6,); 1 by default.
            joint_limits: Whether a solution must be within the limits.
            seed: Seed of the random starts.
            k: Damping [-].
            method: How it is damped: "chan", "wampler" or "sugihara".
            kq: Inverse of the gain that keeps joints from their limits in the null space [-]; 0 for none.
            km: Inverse of the gain of manipulability in the null space [-]; 0 for none.
            ps: Distance from a limit at which that gain holds [rad or m].
            pi: Distance from a limit at which avoiding it begins [rad or m].
            **more: Other settings of `solve`.

        Returns:
            Joint coordinates (n,) or (m, n), success, and figures of the search.
        """
        chain = self._compiled(None)
        return solve(
            chain,
            Tep,
            "LM",
            q0,
            ilimit,
            slimit,
            tol,
            mask,
            joint_limits,
            k,
            method,
            kq,
            km,
            ps,
            pi,
            seed=seed,
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
            Tep: Pose of the end, an SE3, (4, 4) or (m, 4, 4).
            q0: Where the searches begin, (n,) or (k, n) [rad or m]; None for the neutral configuration.
            ilimit: Greatest number of steps of a search.
            slimit: Greatest number of searches.
            tol: Greatest E = e^T W e / 2 that counts as reached [-].
            mask: Weights of the errors along and about x, y, z, (6,); 1 by default.
            joint_limits: Whether a solution must be within the limits.
            seed: Seed of the random starts.
            pinv: Whether to take the pseudoinverse of the Jacobian.
            kq: Inverse of the gain that keeps joints from their limits in the null space [-]; 0 for none.
            km: Inverse of the gain of manipulability in the null space [-]; 0 for none.
            ps: Distance from a limit at which that gain holds [rad or m].
            pi: Distance from a limit at which avoiding it begins [rad or m].
            **more: Other settings of `solve`.

        Returns:
            Joint coordinates (n,) or (m, n), success, and figures of the search.
        """
        chain = self._compiled(None)
        return solve(
            chain,
            Tep,
            "NR",
            q0,
            ilimit,
            slimit,
            tol,
            mask,
            joint_limits,
            kq=kq,
            km=km,
            ps=ps,
            pi=pi,
            seed=seed,
            **more,
            pinv=bool(pinv),
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
            Tep: Pose of the end, an SE3, (4, 4) or (m, 4, 4).
            q0: Where the searches begin, (n,) or (k, n) [rad or m]; None for the neutral configuration.
            ilimit: Greatest number of steps of a search.
            slimit: Greatest number of searches.
            tol: Greatest E = e^T W e / 2 that counts as reached [-].
            mask: Weights of the errors along and about x, y, z, (6,); 1 by default.
            joint_limits: Whether a solution must be within the limits.
            seed: Seed of the random starts.
            pinv: Whether to take the pseudoinverse of the Jacobian.
            kq: Inverse of the gain that keeps joints from their limits in the null space [-]; 0 for none.
            km: Inverse of the gain of manipulability in the null space [-]; 0 for none.
            ps: Distance from a limit at which that gain holds [rad or m].
            pi: Distance from a limit at which avoiding it begins [rad or m].
            **more: Other settings of `solve`.

        Returns:
            Joint coordinates (n,) or (m, n), success, and figures of the search.
        """
        chain = self._compiled(None)
        return solve(
            chain,
            Tep,
            "GN",
            q0,
            ilimit,
            slimit,
            tol,
            mask,
            joint_limits,
            kq=kq,
            km=km,
            ps=ps,
            pi=pi,
            seed=seed,
            **more,
            pinv=bool(pinv),
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
            Tep: Pose of the end, an SE3, (4, 4) or (m, 4, 4).
            q0: Where the searches begin, (n,) or (k, n) [rad or m]; None for the neutral configuration.
            ilimit: Greatest number of steps of a search.
            slimit: Greatest number of searches.
            tol: Greatest E = e^T W e / 2 that counts as reached [-].
            mask: Weights of the errors along and about x, y, z, (6,); 1 by default.
            joint_limits: Whether a solution must be within the limits.
            seed: Seed of the random starts.
            kj: Cost of joint speeds [-].
            ks: Cost of the remaining error [-].
            kq: Inverse of the gain that keeps joints from their limits in the null space [-]; 0 for none.
            km: Inverse of the gain of manipulability in the null space [-]; 0 for none.
            ps: Distance from a limit at which that gain holds [rad or m].
            pi: Distance from a limit at which avoiding it begins [rad or m].
            **more: Other settings of `solve`.

        Returns:
            Joint coordinates (n,) or (m, n), success, and figures of the search.
        """
        chain = self._compiled(None)
        return solve(
            chain,
            Tep,
            "QP",
            q0,
            ilimit,
            slimit,
            tol,
            mask,
            joint_limits,
            kq=kq,
            km=km,
            ps=ps,
            pi=pi,
            kj=kj,
            ks=ks,
            seed=seed,
            **more,
        )
