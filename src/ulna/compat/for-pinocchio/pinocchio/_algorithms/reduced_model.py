"""A model with some of its joints locked, made in one pass over the joints."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from pinocchio._containers.arrays import StdVec, vector
from pinocchio._containers.enums import FrameType
from pinocchio._containers.named_configurations import StdMap_String_VectorXd
from pinocchio._model.live_parameters import PER_Q
from pinocchio._model.model import Model
from pinocchio._spatial.inertia import Inertia
from pinocchio._spatial.se3 import SE3
from ulna.errors import InputError
from ulna.typing import Floats

Moved = list[tuple[int, SE3 | None]]
"""For each joint of a model, the joint of the reduced one that carries it, and its frame there; None for the same."""


def reduced_model(model: Model, locked: list[int], reference: Any) -> tuple[Model, Moved]:
    """The model with some joints locked, and where each of its joints is in it.

    Args:
        model: The model.
        locked: Indices of the joints that are locked.
        reference: The configuration (nq,) at which they are.

    Returns:
        The reduced model, and where the joints are.

    Raises:
        InputError: The universe is to be locked, or a joint without the one that follows it.
    """
    q, fixed = vector(reference, model.nq, "reference_configuration"), set(locked)
    _check(model, fixed)
    placements, inertias = model._rows_of("placements"), model._rows_of("inertias")
    remaining: list[int] = [0]
    moved: Moved = [(0, None)]
    joints, parents = StdVec([model.joints[0].copy()]), StdVec([0])
    nq = nv = extended = 0
    for i in range(1, model.njoints):
        joint, (carrier, M) = model.joints[i], moved[model.parents[i]]
        if M is not None:
            placements[i] = M._m @ placements[i]
        if i in fixed:
            placed = SE3._of(placements[i] @ _pose_at(joint, q))
            carried = Inertia._of(inertias[i]).se3Action(placed)
            inertias[remaining[carrier]] = (Inertia._of(inertias[remaining[carrier]]) + carried)._p
            moved.append((carrier, placed))
            continue
        copied = joint.copy()
        at = nq, nv
        if joint.mimic is not None:
            leader = moved[joint.mimic[0]][0]
            copied.mimic, at = (leader, *joint.mimic[1:]), (joints[leader].idx_q, joints[leader].idx_v)
        copied.setIndexes(len(remaining), *at, extended)
        nq, nv, extended = nq + joint.nq, nv + joint.nv, extended + joint.nvExtended
        moved.append((len(remaining), None))
        remaining.append(i)
        joints.append(copied)
        parents.append(carrier)
    out = object.__new__(Model)
    out.name, out.names = model.name, StdVec([model.names[i] for i in remaining])
    out.joints, out.parents = joints, parents
    out.nq, out.nv, out.nvExtended, out.nbodies = nq, nv, extended, len(remaining)
    _take_entries(out, model, remaining)
    blocks = {"placements": placements[remaining], "inertias": inertias[remaining]}
    facts, blocks["frames"] = _frames(model, fixed, moved)
    out._gravity = model.gravity.copy()
    out._adopt_rows(blocks, facts)
    return out, moved


def _check(model: Model, locked: set[int]) -> None:
    if 0 in locked:
        raise InputError(
            "Joint 0 is the universe, which does not move; take it off the list of joints to lock."
        )
    for i, joint in enumerate(model.joints):
        if joint.mimic and i not in locked and joint.mimic[0] in locked:
            raise InputError(f"Joint {model.names[i]!r} follows a joint that is to be locked. Lock it, too.")


def _pose_at(joint: Any, q: Floats) -> Floats:
    """What a joint does at a configuration of its model, (4, 4)."""
    if joint.mimic is None:
        at = q[joint.idx_q : joint.idx_q + joint.nq]
    else:
        _, scaling, offset = joint.mimic
        at = scaling * q[joint.idx_q : joint.idx_q + joint.kind.nq] + offset
    return np.asarray(joint.kind.transform(at).matrix(), dtype=float)


def _take_entries(out: Model, model: Model, remaining: Iterable[int]) -> None:
    """The entries of q and v, and the named configurations, of the joints that are kept."""
    joints = [model.joints[i] for i in remaining if i and model.joints[i].mimic is None]
    of_q = [k for joint in joints for k in range(joint.idx_q, joint.idx_q + joint.nq)]
    of_v = [k for joint in joints for k in range(joint.idx_v, joint.idx_v + joint.nv)]
    out._arrays = {key: values[of_q if key in PER_Q else of_v] for key, values in model._arrays.items()}
    references = {name: q[of_q] for name, q in model.referenceConfigurations.items()}
    out._configurations = StdMap_String_VectorXd(references)


def _frames(model: Model, locked: set[int], moved: Moved) -> tuple[list[Any], Floats]:
    """The facts and the placements (n, 4, 4) of all frames on the joints that carry them now."""
    out, all_facts = [], model._facts_of_frames()
    places = model._rows_of("frames")
    for k, (name, kind, joint, *rest) in enumerate(all_facts):
        carrier, M = moved[joint]
        if M is not None:
            places[k] = M._m @ places[k]
        if M is not None and kind == FrameType.JOINT:  # it carries the body now
            out.append((name, FrameType.FIXED_JOINT, carrier, k, model.inertias[joint].copy()))
        else:
            out.append((name, kind, carrier, *rest))
    return out, places
