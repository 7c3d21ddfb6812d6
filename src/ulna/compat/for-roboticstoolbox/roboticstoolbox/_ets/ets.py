"""Sequences of elementary transforms and their kinematics, in space and in the plane."""

from __future__ import annotations

from typing import Any

import numpy as np

from roboticstoolbox._common.documentation import describe_arguments
from roboticstoolbox._common.errors import UnknownOption, WrongShape
from roboticstoolbox._common.poses import matrices, matrix, pose, to_planar, to_spatial
from roboticstoolbox._common.symbols import shortened
from roboticstoolbox._ets.dh_split import STEPS, split_by_convention
from roboticstoolbox._ets.elementary_transform import ET, ET2
from roboticstoolbox._ets.ik_solution import IKSolution
from roboticstoolbox._ets.inverse_kinematics import solve
from roboticstoolbox._ets.measures import MEASURES_OF_CHAINS
from roboticstoolbox._ets.sequence import BaseETS
from roboticstoolbox._ets.solver_methods import ChainSolvers
from ulna.typing import Floats

_FLOAT64 = np.dtype(float)


@describe_arguments
class ETS(ChainSolvers, BaseETS):
    """A chain of transforms in space."""

    def eval(self, q: Any = None, base: Any = None, tool: Any = None, include_base: bool = True) -> Floats:
        """The pose of the end as a matrix.

        Args:
            base: Pose of the start in the world, an SE3 or (4, 4); None for the identity.

        Returns:
            Pose (4, 4) or (m, 4, 4).
        """
        T = self._compiled(tool).fk(_joint_coordinates(self, q))
        return matrix(base) @ T if base is not None and include_base else T

    def fkine(self, q: Any = None, base: Any = None, tool: Any = None, include_base: bool = True) -> Any:
        """The pose of the end as an SE3; expressions of symbols are simplified.

        Args:
            base: Pose of the start in the world, an SE3 or (4, 4); None for the identity.

        Returns:
            One SE3, with m elements for (m, n).
        """
        T = self.eval(q, base, tool, include_base)
        return pose(T if T.dtype is _FLOAT64 else shortened(T))

    def jacob0(self, q: Any, tool: Any = None) -> Floats:
        """The Jacobian in the axes of the start, linear rows first.

        Returns:
            Jacobian (6, n) or (m, 6, n).
        """
        return self._compiled(tool).jacob0(q)

    def jacobe(self, q: Any, tool: Any = None) -> Floats:
        """The Jacobian in the axes of the end, linear rows first.

        Returns:
            Jacobian (6, n) or (m, 6, n).
        """
        return self._compiled(tool).jacobe(q)

    def hessian0(self, q: Any = None, J0: Any = None, tool: Any = None) -> Floats:
        """The Hessian in the axes of the start: at `q`, or where the Jacobian is `J0`.

        Args:
            q: Joint coordinates (n,) [rad or m].

        Returns:
            Hessian (n, 6, n).
        """
        return self._compiled(tool).hessian0(q, J0)

    def hessiane(self, q: Any = None, Je: Any = None, tool: Any = None) -> Floats:
        """The Hessian in the axes of the end: at `q`, or where the Jacobian is `Je`.

        Args:
            q: Joint coordinates (n,) [rad or m].

        Returns:
            Hessian (n, 6, n).
        """
        return self._compiled(tool).hessiane(q, Je)

    def partial_fkine0(self, q: Any, n: int) -> Floats:
        """A derivative of the pose in the axes of the start: 1 the Jacobian, 2 the Hessian, and so on.

        Args:
            q: Joint coordinates (n,) [rad or m].
            n: Order of the derivative.

        Returns:
            Array (n, ..., n, 6, n).
        """
        return self._compiled(None).partial(q, n)

    def jacob0_analytical(self, q: Any, representation: str = "rpy/xyz", tool: Any = None) -> Floats:
        """The Jacobian of position and angles.

        Args:
            representation: "rpy/xyz", "rpy/zyx", "eul" or "exp".

        Returns:
            Jacobian (6, n) or (m, 6, n).
        """
        return self._compiled(tool).analytical(q, representation)

    def manipulability(self, q: Any, method: str = "yoshikawa", axes: Any = "all") -> Any:
        """A measure of the distance from singularities.

        Args:
            method: "yoshikawa", "minsingular" or "invcondition".
            axes: "all", "trans", "rot", "both" for a pair of measures, or six truth values.

        Returns:
            The measure, () or (m,); a pair of them for "both".

        Raises:
            UnknownOption: There is no such measure of a chain, which has no masses.
        """
        if str(method) not in MEASURES_OF_CHAINS:
            raise UnknownOption("measure of manipulability of a chain", method, MEASURES_OF_CHAINS)
        return self._compiled(None).manipulability(q, method, axes)

    def jacobm(self, q: Any, axes: Any = "all") -> Floats:
        """The gradient of manipulability.

        Args:
            q: Joint coordinates (n,) [rad or m].

        Returns:
            Gradient (n, 1).
        """
        return self._compiled(None).jacobm(q, axes)

    @property
    def _fknm(self) -> ETS:
        """The handle of the Toolbox's compiled functions: the chain itself."""
        return self

    def replace(self, i: int, axis: str) -> None:
        """Writes the transform at `i` as turns and one about or along another axis.

        Args:
            i: Which transform.
            axis: "x", "y" or "z".

        Raises:
            InputError: There is no such axis, or the transform is a whole pose.
            WrongIndex: There is no transform at `i`.
        """
        self._replace(i, axis)

    def replaced(self, i: int, axis: str) -> ETS:
        """A copy on which `replace` was called.

        Args:
            i: Which transform.
            axis: "x", "y" or "z".

        Returns:
            The copy.
        """
        return self._modified_copy("replace", i, axis)

    def split(self, method: str = "last") -> list[Any]:
        """The chain in parts; "dh" and "mdh" are those of Denavit and Hartenberg's links, see `BaseETS.split`."""
        if method.lower() not in STEPS:
            return super().split(method)
        return [type(self)(list(part)) for part in split_by_convention(self.data, method.lower())]


@describe_arguments
class ETS2(BaseETS):
    """A chain of transforms in the plane."""

    _et = ET2

    def eval(self, q: Any = None, base: Any = None, tool: Any = None, include_base: bool = True) -> Floats:
        """The pose of the end as a matrix.

        Args:
            base: Pose of the start in the world, an SE2 or (3, 3); None for the identity.
            tool: Pose of a tool beyond the end, an SE2 or (3, 3).

        Returns:
            Pose (3, 3) or (m, 3, 3).
        """
        T = to_planar(self._compiled(None).fk(_joint_coordinates(self, q)))
        T = T if tool is None else T @ matrix(tool, 3)
        return matrix(base, 3) @ T if base is not None and include_base else T

    def fkine(self, q: Any = None, base: Any = None, tool: Any = None, include_base: bool = True) -> Any:
        """The pose of the end as an SE2; expressions of symbols are simplified.

        Args:
            base: Pose of the start in the world, an SE2 or (3, 3); None for the identity.
            tool: Pose of a tool beyond the end, an SE2 or (3, 3).

        Returns:
            One SE2, with m elements for (m, n).
        """
        T = self.eval(q, base, tool, include_base)
        return pose(T if T.dtype is _FLOAT64 else shortened(T))

    def insert(self, i: int, arg: Any) -> None:  # pyright: ignore[reportIncompatibleMethodOverride]
        """Inserts a transform, or a chain, before the one at `i`; the toolbox names the arguments so in the plane.

        Args:
            i: Place of the transform that comes after it.
            arg: The transform or chain.
        """
        super().insert(i, arg)

    def jacob0(self, q: Any) -> Floats:
        """The Jacobian in the axes of the start, (3, n): x, y, angle."""
        return self._compiled(None).jacob0(q)[..., [0, 1, 5], :]

    def jacobe(self, q: Any) -> Floats:
        """The Jacobian in the axes of the end, (3, n)."""
        return self._compiled(None).jacobe(q)[..., [0, 1, 5], :]

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
    ) -> IKSolution:
        """The joint coordinates for a pose in the plane.

        Args:
            Tep: Pose of the end, an SE2, (3, 3) or (m, 3, 3).
            mask: Weights of the errors of x, y and the angle, (3,); 1 by default.

        Returns:
            Joint coordinates (n,), success, and figures of the search.

        Raises:
            ShapeError: `mask` has another shape.
            WrongShape: `mask` has another shape.
        """
        weights = np.ones(3) if mask is None else np.asarray(mask, dtype=float)
        if weights.shape != (3,):
            raise WrongShape("mask", weights.shape, "(3,): weights of x, y and the angle")
        x, y, turn = weights.tolist()
        six = (x, y, 0.0, 0.0, 0.0, turn)
        T = to_spatial(matrices(Tep, 3))
        return solve(self._compiled(None), T, "LM", q0, ilimit, slimit, tol, six, joint_limits, k, seed=seed)


def _joint_coordinates(chain: BaseETS, q: Any) -> Any:
    """The joint coordinates that were passed; a chain without joints needs none.

    Raises:
        WrongShape: There are none, but joints.
    """
    if q is None and chain.n:
        raise WrongShape("q", (0,), f"({chain.n},) or (m, {chain.n}), a number for each joint of the chain")
    return np.zeros(0) if q is None else q


ET.sequence_class, ET2.sequence_class = ETS, ETS2
