"""All configurations of a robot that reach a pose."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ulna.methods.traced import only_numbers
from ulna.quantities.part import Part
from ulna.typing import ArrayLike

if TYPE_CHECKING:
    from ulna.ik.branch_kernel import BranchKernel
    from ulna.ik.branches import Branches


class Branching(Part):
    """All solutions of inverse kinematics."""

    __slots__ = ()

    def ik_all(
        self,
        T: ArrayLike,
        q0: ArrayLike | None = None,
        frame: str | None = None,
        *,
        joints: Sequence[str] | None = None,
        free: str | None = None,
        samples: int | ArrayLike | None = None,
        limits: bool = True,
        turns: bool = False,
        position_tolerance: float = 1e-9,
        rotation_tolerance: float = 1e-9,
        seed: int = 0,
    ) -> Branches:
        """All configurations that put a frame at a pose: every branch of a six-joint arm, samples of a redundant one.

        Six turning joints of which three neighbours meet in a point or are parallel are solved in closed form, any
        others by elimination; of seven, one is given values and the others are solved likewise. Arms with slides, with
        fewer joints, or with joints that follow others are solved from many random starts. Every solution is certified
        by forward kinematics.

        Args:
            T: T_world_frame, (..., 4, 4).
            q0: Configuration, (nq,) or (..., nq): solutions come nearest to it first, angles within half a turn of its
                own; joints that do not belong to the arm stay there. None for neutral, clipped to the limits.
            frame: Name; None for the tool.
            joints: Names of the joints that may move; None for the last ones that move the frame
                by seven coordinates.
            free: The joint of a seven-joint arm that is given values; None for the one that suits best.
            samples: How many values, evenly spaced between its limits, and that in `q0`; or the values, (n,). None
                for 32; arms of other numbers of joints take none.
            limits: Whether to leave out what is outside the joint limits.
            turns: Whether to list a solution again for every whole turn that the limits of a joint allow.
            position_tolerance: Largest distance from the goal [m].
            rotation_tolerance: Largest angle from the goal [rad].
            seed: Of the random starts.

        Returns:
            The solutions with their errors, whether they are all there are, the method, and, where there are none, the
            reason. Where the pose leaves a joint free (a wrist or elbow that is straight), one of the continuum is
            given: the one with that joint as in `q0`.

        Raises:
            InputError: If `T` is no pose, or an option does not fit the arm.
            UnknownName: If there is no such frame or joint.

        Reference: Pieper 1968; Elias & Wen 2025; Raghavan & Roth 1993; Manocha & Canny 1994.

        Example:
            >>> robot = ulna.load("ur5")
            >>> q = [0.1, -1.0, 1.2, -0.4, 0.7, 0.2]
            >>> robot.ik_all(robot.fk(q), limits=False).q.shape
            (8, 6)
        """
        from ulna.ik.branches import ik_all

        only_numbers("robot.ik_all", "Call it outside, and pass what it finds as an argument.", T, q0)
        return ik_all(
            self.model,
            T,
            self.model.tool if frame is None else frame,
            q0,
            joints=joints,
            free=free,
            samples=samples,
            limits=limits,
            turns=turns,
            position_tolerance=position_tolerance,
            rotation_tolerance=rotation_tolerance,
            seed=seed,
        )

    def branch_kernel(
        self, frame: str | None = None, *, joints: Sequence[str] | None = None, free: str | None = None
    ) -> BranchKernel:
        """The compiled kernel behind `ik_all`, for hot loops: all branches of a pose in some microseconds.

        Args:
            frame: Name; None for the tool.
            joints: As for `ik_all`; others are held at neutral.
            free: As for `ik_all`.

        Returns:
            The kernel, called with T_world_frame (4, 4).

        Raises:
            InputError: If the arm has no closed form.
            UnknownName: If there is no such frame or joint.
        """
        from ulna.ik.branch_kernel import BranchKernel

        return BranchKernel(self.model, self.model.tool if frame is None else frame, joints, free)
