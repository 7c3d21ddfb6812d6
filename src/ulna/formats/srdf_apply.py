"""Adds the content of an SRDF to a model: groups, named configurations, pairs without collision checks."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from ulna.formats.srdf import SrdfDocument, SrdfGroup, SrdfState
from ulna.model import Continuous, Joint, Model, Planar
from ulna.typing import Floats


def with_srdf(model: Model, document: SrdfDocument) -> Model:
    """The model with the groups, configurations and disabled pairs of an SRDF.

    Joints and links that the model does not have are ignored: one SRDF often serves several variants of a robot.
    Joints that a configuration does not name stay at their neutral position. A configuration that names no joint of
    the model is ignored.

    Args:
        model: The robot.
        document: The SRDF.

    Returns:
        A new model.
    """
    states = {state.name: q for state in document.states if (q := _position(model, state)) is not None}
    links = set(model.link_names)
    pairs = {(min(pair), max(pair)) for pair in document.disabled_pairs if links.issuperset(pair)}
    groups = {name: joints for name in document.groups if (joints := _joints(model, document, name))}
    return dataclasses.replace(
        model,
        configurations={**model.configurations, **states},
        disabled_pairs=tuple(sorted(pairs.union(model.disabled_pairs))),
        groups={**model.groups, **groups},
    )


def _position(model: Model, state: SrdfState) -> Floats | None:
    names = set(model.joint_names)
    q = np.array(model.neutral)
    known = False
    for written, values in state.values.items():
        name = written if written in names else written.rpartition("/")[2]  # some write "robot/joint"
        if name not in names:
            continue
        joint = model.joint(name)
        known = True
        if joint.mimic is not None:
            continue
        part = _coordinates(joint, values)
        if part is not None:
            q[joint.idx_q : joint.idx_q + joint.nq] = joint.kind.normalize(part)
    return q if known else None


def _coordinates(joint: Joint, values: tuple[float, ...]) -> Floats | None:
    """The values as coordinates of the joint; some write an angle without bounds as cosine and sine."""
    if isinstance(joint.kind, Continuous) and len(values) == 2:
        return np.array([math.atan2(values[1], values[0])])
    if isinstance(joint.kind, Planar) and len(values) == 4:
        return np.array([values[0], values[1], math.atan2(values[3], values[2])])
    return np.array(values) if len(values) == joint.nq else None


def _joints(model: Model, document: SrdfDocument, name: str) -> tuple[str, ...]:
    """The movable joints of a group, in the order of the model."""
    joints: set[str] = set()
    waiting, visited = [name], {name}
    while waiting:
        group = document.groups.get(waiting.pop())
        if group is None:
            continue
        joints.update(_joints_of_group(model, group))
        for inner in group.groups:
            if inner not in visited:
                visited.add(inner)
                waiting.append(inner)
    return tuple(name for name in model.joint_names if name in joints)


def _joints_of_group(model: Model, group: SrdfGroup) -> set[str]:
    joints = set(group.joints)
    links = {link.name: link for link in model.links}
    for name in group.links:
        if name in links and links[name].parent_joint is not None:
            joints.add(str(links[name].parent_joint))
    for base, tip in group.chains:
        chain: set[str] = set()
        link = links.get(tip)
        while link is not None and link.name != base:
            chain.add(str(link.parent_joint))
            link = links.get(link.parent) if link.parent is not None else None
        if link is not None:  # else the base is no ancestor of the tip
            joints |= chain
    return joints
