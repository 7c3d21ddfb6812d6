"""Adds the content of an SRDF to a model: groups, named configurations, disabled collision pairs."""

from __future__ import annotations

import dataclasses
import math
import warnings
from collections.abc import Iterator

import numpy as np

from ulna.errors import ModelWarning
from ulna.formats.srdf import SrdfDocument, SrdfGroup, SrdfState
from ulna.model import Continuous, Joint, Model, Planar
from ulna.system.callers import level_of_caller
from ulna.typing import Floats


def with_srdf(model: Model, document: SrdfDocument) -> Model:
    """The model with the groups, configurations and disabled pairs of an SRDF.

    Joints and links that the model does not have are ignored: one SRDF often serves several variants of a robot.
    States of the same name of several groups are one configuration. Joints that a configuration does not name stay at
    their neutral position. A configuration that names no joint of the model is ignored.

    A joint with another number of values than it has coordinates, and a second position of a joint in states of the
    same name, are ignored with a ModelWarning.

    Args:
        model: The robot.
        document: The SRDF.

    Returns:
        A new model.
    """
    configurations = _configurations(model, document)
    links = set(model.link_names)
    pairs = {(min(pair), max(pair)) for pair in document.disabled_pairs if links.issuperset(pair)}
    groups = {name: joints for name in document.groups if (joints := _joints(model, document, name))}
    return dataclasses.replace(
        model,
        configurations={**model.configurations, **configurations},
        disabled_pairs=tuple(sorted(pairs.union(model.disabled_pairs))),
        groups={**model.groups, **groups},
    )


def _configurations(model: Model, document: SrdfDocument) -> dict[str, Floats]:
    """The named configurations, each of all states of its name."""
    out: dict[str, Floats] = {}
    positions: dict[tuple[str, str], Floats] = {}
    for state in document.states:
        for joint, part in _positions(model, state, document.file):
            q = out.setdefault(state.name, np.array(model.neutral))
            if joint.mimic is not None or part is None:
                continue
            first = positions.setdefault((state.name, joint.name), part)
            if not np.array_equal(first, part):
                _warn(
                    document.file, f"group_state {state.name!r} has a second position of joint {joint.name!r}"
                )
            q[joint.idx_q : joint.idx_q + joint.nq] = joint.kind.normalize(first)
    return out


def _positions(model: Model, state: SrdfState, file: str | None) -> Iterator[tuple[Joint, Floats | None]]:
    """The joints of the model that a state names, with their coordinates; None where they do not fit the joint."""
    names = set(model.joint_names)
    for written, values in state.values.items():
        name = written if written in names else written.rpartition("/")[2]  # some write "robot/joint"
        if name in names:
            joint = model.joint(name)
            part = _coordinates(joint, values)
            if part is None and joint.mimic is None:
                _warn(
                    file,
                    f"group_state {state.name!r} has {len(values)} values for joint {name!r}, which has {joint.nq}",
                )
            yield joint, part


def _warn(file: str | None, message: str) -> None:
    text = f"{file or '<string>'}: {message}; it is ignored."
    warnings.warn(text, ModelWarning, stacklevel=level_of_caller())


def _coordinates(joint: Joint, values: tuple[float, ...]) -> Floats | None:
    """The values as coordinates of the joint; a continuous angle may be given as cosine and sine."""
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
