"""External forces on the bodies: from wrenches at frames to wrenches at joints.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| F | what the surroundings exert on the body of a frame: force, moment | Force | [N, N m] | |
| B | constant pose of the frame in the moving frame of its joint | SE3 | [m] | frame.placement |
| T | pose of that moving frame in the world | SE3 | [m] | |
| "local" | F about the frame's origin in its axes | | | B F |
| "local_world_aligned" | about the frame's origin in the world's axes | | | (T.R^T f, T.R^T n + B.p x T.R^T f) |
| "world" | about the world's origin in its axes | | | T^-1 F |

The torques of inverse dynamics are less by J^T F. Source: Featherstone 2008, section 5.3 (f^x). What acts on a frame
that is fixed to the world moves nothing.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ulna.algorithms.multibody.references import Reference, check_reference
from ulna.algorithms.multibody.tree import Step, chain, poses
from ulna.model import Frame, Model
from ulna.numeric import apply, cross
from ulna.spatial import Force
from ulna.typing import Array

External = Sequence[Force | None] | None
"""For every joint of the model the force on its body, in its moving frame and about its origin [N, N m], or None."""


def at_joints(
    model: Model,
    q: Array,
    wrenches: Array,
    frames: Sequence[Frame],
    reference: Reference = "local_world_aligned",
) -> list[Force | None]:
    """The forces at frames, gathered at the joints that carry them.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        wrenches: What the surroundings exert at each frame, shape (..., k, 6) [N, N m], force first.
        frames: k frames of the model; one may come several times.
        reference: In whose axes, and about which point, the wrenches are written.

    Returns:
        For each joint the force on its body, in its moving frame [N, N m]; None where there is none.

    Raises:
        UnknownName: no such reference.
    """
    check_reference(reference)
    external: list[Force | None] = [None] * len(model.joints)
    for k, frame in enumerate(frames):
        if frame.joint >= 0:
            wrench = Force(wrenches[..., k, :3], wrenches[..., k, 3:])
            force = _at_joint(model, q, wrench, frame, reference)
            sum_ = external[frame.joint]
            external[frame.joint] = force if sum_ is None else sum_ + force
    return external


def at_steps(model: Model, tree: Sequence[Step], external: External) -> list[Force]:
    """The force on the body of every step, in the moving frame of its joint; zero where there is none.

    Args:
        model: The robot.
        tree: Its steps, of which the last one of every joint carries the body.
        external: Forces on the bodies [N, N m]; None for none.

    Returns:
        For each step the force on its body, in its moving frame [N, N m].
    """
    forces: list[Force] = []
    for step in tree:
        force = external[model.joint_index(step.joint.name)] if external and step.is_last else None
        forces.append(Force.zero() if force is None else force)
    return forces


def _at_joint(model: Model, q: Array, wrench: Force, frame: Frame, reference: Reference) -> Force:
    if reference == "local":
        return frame.placement.act(wrench)
    T = poses(chain(model, frame), q)[-1]
    if reference == "world":
        return T.act_inverse(wrench)
    back = np.swapaxes(T.rotation, -1, -2)
    force = apply(back, wrench.linear)
    return Force(force, apply(back, wrench.angular) + cross(frame.placement.translation, force))
