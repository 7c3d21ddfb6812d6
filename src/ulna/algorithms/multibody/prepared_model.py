"""A model as the algorithms with few operations need it: optimised link frames and the inertias in them.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| C | pose of an optimised moving frame in the moving frame that the model names | SE3 | [m] | see link_frames.py |
| m, c, I | moments of a body in its optimised frame | MassMoments | | those of the model's frame, seen through C^-1 |
"""

from __future__ import annotations

from functools import cached_property
from typing import final

from ulna.algorithms.multibody.external_forces import External
from ulna.algorithms.multibody.link_frames import choose_link_frames
from ulna.algorithms.multibody.mass_moments import MassMoments, body_moments
from ulna.algorithms.multibody.regrouped_moments import regrouped_moments
from ulna.algorithms.multibody.tree import Step
from ulna.data_classes import dataclass
from ulna.model import Model
from ulna.spatial import SE3, Force


@final
@dataclass(frozen=True)
class PreparedModel:
    """The steps of a model between optimised frames, and the inertias of its bodies in these frames."""

    model: Model
    tree: tuple[Step, ...]
    """The steps, parents first."""
    frames: tuple[SE3, ...]
    """C of every step."""

    @cached_property
    def body_moments(self) -> list[MassMoments]:
        """The inertia of the body of every step; zero for the inner parts of a joint, which carry no body."""
        return [
            body.to_outer_frame(frame.inverse()) if step.is_last else body
            for step, frame, body in zip(
                self.tree, self.frames, body_moments(self.model, self.tree), strict=True
            )
        ]

    @property
    def regrouped_moments(self) -> list[MassMoments]:
        """The same after regrouping; see regrouped_moments.py for which quantities it keeps."""
        return self._regrouping[0]

    @property
    def moments_at_rest(self) -> MassMoments:
        """What regrouping leaves to the world, in its frame [kg, kg m, kg m^2]."""
        return self._regrouping[1]

    @cached_property
    def _regrouping(self) -> tuple[list[MassMoments], MassMoments]:
        return regrouped_moments(self.tree, self.body_moments)

    def external_force(self, i: int, external: External) -> Force | None:
        """The force from the surroundings on the body of a step.

        Args:
            i: The step.
            external: Forces on the bodies [N, N m]; None for none.

        Returns:
            The force in the optimised frame of the step [N, N m]; None for no force.
        """
        if external is None or not self.tree[i].is_last:
            return None
        force = external[self.model.joint_index(self.tree[i].joint.name)]
        return None if force is None else self.frames[i].act_inverse(force)


def prepare(model: Model) -> PreparedModel:
    """The optimised frames of a model; the inertias in them are computed when they are asked for.

    Args:
        model: The robot.
    """
    links = choose_link_frames(model)
    return PreparedModel(model, links.tree, links.frames)
