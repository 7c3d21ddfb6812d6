"""The terms of the articulated-body algorithm for every joint, as a Data shows them when they are read."""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from pinocchio._model.building import KinematicTree
from pinocchio._model.joint_data import JointData
from pinocchio._spatial.se3 import SE3
from ulna.errors import InputError
from ulna.typing import Floats


class ArticulatedBody(NamedTuple):
    """What the algorithm knows of a joint and all it moves, in the joint's frame.

    Attributes:
        inertia: The articulated inertia (6, 6); for joints not on the universe that of the joint's other side, which
            their own motion does not feel.
        U: The inertia of the joint's own side times the motion subspace, (6, nv).
        Dinv: The inverse of S^T U and the armature, (nv, nv).
    """

    inertia: Floats
    U: Floats
    Dinv: Floats


def articulated_bodies(model: KinematicTree, joints: Sequence[JointData]) -> list[ArticulatedBody]:
    """The terms of all joints but the universe [Featherstone 2008, table 7.1].

    Args:
        model: The model.
        joints: The placements and subspaces of its joints, the universe first.

    Returns:
        The terms, in the order of the joints.

    Raises:
        InputError: A joint follows another one: the algorithm does not know it as a joint of its own.
    """
    if model.nv != model.nvExtended:
        raise InputError(
            "The terms of the articulated-body algorithm are not defined for models with mimic joints."
        )
    inertias = [inertia.matrix() for inertia in model.inertias]
    out: list[ArticulatedBody] = []
    for i in range(model.njoints - 1, 0, -1):
        S, own = joints[i]._subspace, inertias[i]
        rows = slice(model.joints[i].idx_v, model.joints[i].idx_v + model.joints[i].nv)
        U = own @ S
        Dinv = np.linalg.inv(S.T @ U + np.diag(model._arrays["armature"][rows])).astype(float)
        parent = model.parents[i]
        beyond = own - U @ Dinv @ U.T if parent else own
        if parent:
            to_child = (model.jointPlacements[i] * joints[i].M).toActionMatrixInverse()
            inertias[parent] = inertias[parent] + to_child.T @ beyond @ to_child
        out.insert(0, ArticulatedBody(beyond, U, Dinv))
    return out


def placed(model: KinematicTree, joints: Sequence[JointData]) -> list[SE3]:
    """The placements of joints in the world, the universe first.

    Args:
        model: The model.
        joints: The data of its joints, the universe first.

    Returns:
        The placements.
    """
    out = [SE3()]
    for i in range(1, model.njoints):
        out.append(out[model.parents[i]] * model.jointPlacements[i] * joints[i].M)
    return out


def with_articulated_terms(model: KinematicTree, joints: Sequence[JointData]) -> None:
    """Has U, Dinv and UDinv of joints' data computed when one of them is first read.

    Args:
        model: The model.
        joints: The data of its joints, the universe first.
    """
    bodies = functools.cache(lambda: articulated_bodies(model, joints))

    def of(k: int) -> Callable[[], tuple[Floats, Floats]]:
        return lambda: bodies()[k][1:]

    for k, joint in enumerate(joints[1:]):
        joint.set_terms(of(k))
