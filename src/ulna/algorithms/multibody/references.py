"""The three references in which the motion of a frame is written.

| reference | origin at which the linear part is taken | axes |
|---|---|---|
| "world" | the world's origin | the world's |
| "local" | the frame's origin | the frame's |
| "local_world_aligned" | the frame's origin | the world's |
"""

from __future__ import annotations

from typing import Literal, TypeAlias, get_args

import numpy as np

from ulna.errors import UnknownName
from ulna.numeric import apply
from ulna.spatial import SE3, Motion

Reference: TypeAlias = Literal["world", "local", "local_world_aligned"]
_REFERENCES = get_args(Reference)


def check_reference(reference: str) -> None:
    """Raises UnknownName unless `reference` is one of the three."""
    if not isinstance(reference, str) or reference not in _REFERENCES:
        raise UnknownName("reference", reference, _REFERENCES)


def relevant_placement(placement: SE3, reference: Reference) -> SE3:
    """The part of a frame's placement on its body that its twist depends on.

    Args:
        placement: Pose of the frame in the moving frame of its joint [m].
        reference: "world", "local" or "local_world_aligned".

    Returns:
        The placement, its translation alone, or the identity.
    """
    if reference == "world":
        return SE3.identity()
    return placement if reference == "local" else SE3(np.eye(3), placement.translation)


def in_reference(local: Motion, T_world_frame: SE3, reference: Reference) -> Motion:
    """A twist written in the frame itself, rewritten in a reference.

    Args:
        local: The twist in the axes of the frame, about its origin [m/s, rad/s].
        T_world_frame: Pose of the frame in the world [m]; only what `reference` needs of it is read.
        reference: "world", "local" or "local_world_aligned".

    Returns:
        The same twist in `reference` [m/s, rad/s].
    """
    if reference == "local":
        return local
    if reference == "world":
        return T_world_frame.act(local)
    R = T_world_frame.rotation
    return Motion(apply(R, local.linear), apply(R, local.angular))
