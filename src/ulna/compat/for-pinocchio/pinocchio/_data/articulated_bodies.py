"""The terms of the articulated-body algorithm for every joint, as a Data shows them when they are read."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from pinocchio._containers.arrays import views
from pinocchio._data.algorithm import Deferred
from pinocchio._data.evaluated_model import EvaluatedModel, Numbers, numbers_of
from pinocchio._data.states import FieldStates
from pinocchio._model.building import KinematicTree
from pinocchio._model.joint_data import JointData, states
from pinocchio._spatial.inertia import Inertia
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


def is_articulated(model: KinematicTree) -> bool:
    """Whether the algorithm knows every joint as one of its own: none follows another one."""
    return model.nv == model.nvExtended


def check_articulated(model: KinematicTree) -> None:
    """Checks that the algorithm knows every joint as one of its own.

    Raises:
        InputError: A joint follows another one.
    """
    if not is_articulated(model):
        raise InputError(
            "The terms of the articulated-body algorithm are not defined for models with mimic joints."
        )


def articulated_bodies(
    model: KinematicTree, numbers: Numbers, joints: Sequence[JointData], added: Floats | None = None
) -> list[ArticulatedBody]:
    """The terms of all joints but the universe [Featherstone 2008, table 7.1].

    Args:
        numbers: The numbers of the model at the time that counts.
        joints: The placements and subspaces of its joints, the universe first.
        added: Further inertias in the frames of the joints, the universe first, (n, 6, 6).

    Returns:
        The terms, in the order of the joints.

    Raises:
        InputError: A joint follows another one: the algorithm does not know it as a joint of its own.
    """
    check_articulated(model)
    inertias = [inertia.matrix() for inertia in views(Inertia, numbers.inertias)]
    placements = views(SE3, numbers.placements)
    if added is not None:
        inertias = [own + more for own, more in zip(inertias, added, strict=True)]
    out: list[ArticulatedBody] = []
    for i in range(model.njoints - 1, 0, -1):
        S, own = joints[i].subspace, inertias[i]
        rows = slice(model.joints[i].idx_v, model.joints[i].idx_v + model.joints[i].nv)
        U = own @ S
        Dinv = _inverse(S.T @ U + np.diag(numbers.armature[rows]))
        parent = model.parents[i]
        with np.errstate(invalid="ignore"):  # of a joint that moves no mass
            beyond = own - U @ Dinv @ U.T if parent else own
        if parent:
            to_child = (placements[i] * joints[i].M).toActionMatrixInverse()
            inertias[parent] = inertias[parent] + to_child.T @ beyond @ to_child
        out.insert(0, ArticulatedBody(beyond, U, Dinv))
    return out


def _inverse(D: Floats) -> Floats:
    """The inverse (n, n) of what joints feel of inertia; infinite where they move no mass."""
    try:
        return np.linalg.inv(D).astype(float)
    except np.linalg.LinAlgError:
        return np.full(D.shape, np.inf)


def placed(model: KinematicTree, numbers: Numbers, joints: Sequence[JointData]) -> list[SE3]:
    """The placements of joints in the world, the universe first.

    Args:
        numbers: The numbers of the model at the time that counts.
        joints: The data of its joints, the universe first.

    Returns:
        The placements.
    """
    out, placements = [SE3()], views(SE3, numbers.placements)
    for i in range(1, model.njoints):
        out.append(out[model.parents[i]] * placements[i] * joints[i].M)
    return out


def _fill(data: FieldStates, compiled: Any, _: tuple[str, ...], q: Floats) -> None:
    """Nothing for models with mimic joints, where reading the terms is refused."""
    model, numbers = data._model, numbers_of(compiled)
    if not is_articulated(model):
        return
    joints, arrays = states(model.joints, q, None), data._arrays
    places = placed(model, numbers, joints)
    for i, body in enumerate(articulated_bodies(model, numbers, joints), start=1):
        rows = slice(model.joints[i].idx_v, model.joints[i].idx_v + model.joints[i].nv)
        X = places[i].toActionMatrixInverse()
        arrays["Yaba"][i], arrays["oYaba"][i] = body.inertia, X.T @ body.inertia @ X
        arrays["U of bodies"][:, rows], arrays["Dinv of bodies"][rows, rows] = body.U, body.Dinv


def _fill_as_read(data: FieldStates, _: Any, fields: tuple[str, ...], q: Floats) -> None:
    _fill(data, EvaluatedModel(data._model), fields, q)


ARTICULATED = {"Yaba": Deferred("q", _fill)}
"""Of the numbers that an algorithm was called with; `oYaba` and the terms of joints are computed with it."""
ARTICULATED_AS_READ = {"Yaba": Deferred("q", _fill_as_read)}
"""After kinematics, which know nothing of inertias: of the numbers that the model has when it is read."""
