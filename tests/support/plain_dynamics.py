"""Momenta as sums over bodies, from the poses and twists of frames."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from ulna import algorithms as alg
from ulna.model import Model
from ulna.spatial import SE3, Force
from ulna.typing import Floats


def body_frame(index: int) -> Any:
    """The moving frame of a joint."""
    return SimpleNamespace(joint=index, placement=SE3.identity())


def momentum(model: Model, q: Floats, v: Floats, a: Floats) -> tuple[Floats, Floats]:
    """About the centre of mass of the moving bodies, along the axes of the world, and its rate, each (..., 6)."""
    mass, first = 0.0, np.zeros(3)
    h, F = Force.zero(), Force.zero()
    for i, body in enumerate(model.inertias):
        frame = body_frame(i)
        T = alg.frame_pose(model, q, frame)
        V = alg.frame_velocity(model, q, v, frame, "local")
        A = alg.frame_acceleration(model, q, v, a, frame, "local")
        mass, first = mass + body.mass, first + body.mass * (T @ body.com)
        h, F = h + T.act(body.apply(V)), F + T.act(body.apply(A) + V.cross(body.apply(V)))
    centre = SE3(np.eye(3), first / mass)
    return centre.act_inverse(h).vector(), centre.act_inverse(F).vector()
