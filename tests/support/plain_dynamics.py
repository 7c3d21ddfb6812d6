"""Torques and momenta as sums over bodies, straight from Jacobians and twists: slow, and plainly right."""

from __future__ import annotations

from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np

from ulna import algorithms as alg
from ulna.model import Model
from ulna.numeric import apply
from ulna.spatial import SE3, Force, Motion
from ulna.typing import Floats


def body_frame(index: int) -> Any:
    """The moving frame of a joint."""
    return SimpleNamespace(joint=index, placement=SE3.identity())


def torques(
    model: Model, q: Floats, v: Floats, a: Floats, external: Sequence[Force | None] | None = None
) -> Floats:
    """Sum of J^T (I (A - g) + V x* I V - external), with armature."""
    tau = a * model.armature + 0.0 * v
    for i, body in enumerate(model.inertias):
        frame = body_frame(i)
        V = alg.frame_velocity(model, q, v, frame, "local")
        A = alg.frame_acceleration(model, q, v, a, frame, "local")
        R = alg.frame_pose(model, q, frame).rotation
        g = Motion(apply(np.swapaxes(R, -1, -2), model.gravity), np.zeros(3))
        F = body.apply(A - g) + V.cross(body.apply(V))
        if external is not None and external[i] is not None:
            F = F - external[i]
        tau = tau + apply(np.swapaxes(alg.frame_jacobian(model, q, frame, "local"), -1, -2), F.vector())
    return tau


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
