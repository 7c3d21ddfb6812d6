"""From this package's Model to Ulna's model: one link for each joint, in the same order."""

from __future__ import annotations

from typing import Any

from pinocchio._model.joint_model import JointModel
from pinocchio._model.live_parameters import LiveParameters
from ulna import spatial
from ulna.errors import InputError
from ulna.model import Frame, Joint, Limits, Link, Mimic
from ulna.model import Model as CoreModel
from ulna.model.joints.axes import constant, snap_pose

WORLD_LINK = "universe"


def core_model(source: LiveParameters) -> CoreModel:
    """Ulna's model of the present parameters.

    Raises:
        InputError: A joint has no kind.
    """
    identity = snap_pose(spatial.SE3.identity())
    names = [WORLD_LINK, *(f"body of {name}" for name in source.names[1:])]
    links = [_link(WORLD_LINK, -1, source.inertias[0], None, None, identity)]
    joints: list[Joint] = []
    for i in range(1, source.njoints):
        joints.append(_joint(source, i, names))
        parent, placement = names[source.parents[i]], joints[-1].placement
        links.append(_link(names[i], i - 1, source.inertias[i], parent, source.names[i], placement))
    frames = [Frame(link.name, link.joint, identity, "link", link.name, identity) for link in links]
    return CoreModel(
        name=source.name or "model",
        joints=tuple(joints),
        links=tuple(links),
        frames=tuple(frames),
        inertias=tuple(link.inertia for link in links[1:]),
        base_inertia=links[0].inertia,
        gravity=source._parameter_blocks("gravity")[0].copy(),
        configurations={},
        tool=links[-1].name,
    )


def _joint(source: LiveParameters, i: int, links: list[str]) -> Joint:
    joint, parent = source.joints[i], source.parents[i]
    if joint.kind is None:
        raise InputError(f"Joint {i}, {source.names[i]!r}, has no kind.")
    zeros = (0.0,) * joint.kind.nv
    return Joint(
        name=source.names[i],
        kind=joint.kind,
        parent=parent - 1,
        placement=snap_pose(source.jointPlacements[i]._pose()),
        idx_q=joint.idx_q,
        idx_v=joint.idx_v,
        limits=_limits(source._arrays, joint),
        damping=zeros,
        friction=zeros,
        armature=_entries(source._arrays["armature"], joint.idx_v, joint.nv) if joint.nv else zeros,
        mimic=None if joint.mimic is None else Mimic(joint.mimic[0] - 1, *joint.mimic[1:]),
        parent_link=links[parent],
        child_link=links[i],
    )


def _limits(arrays: dict[str, Any], joint: JointModel) -> Limits:
    positions = (
        _entries(arrays[key], joint.idx_q, joint.nq) for key in ("lowerPositionLimit", "upperPositionLimit")
    )
    rates = (
        _entries(arrays[key], joint.idx_v, joint.nv) for key in ("upperVelocityLimit", "upperEffortLimit")
    )
    return Limits(*positions, *rates)


def _entries(values: Any, start: int, count: int) -> tuple[float, ...]:
    return tuple(float(x) for x in values[start : start + count])


def _link(name: str, joint: int, inertia: Any, parent: str | None, above: str | None, origin: Any) -> Link:
    identity = snap_pose(spatial.SE3.identity())
    value = inertia._value()
    rounded = spatial.Inertia(float(value.mass), constant(value.com + 0.0), constant(value.inertia + 0.0))
    return Link(name, joint, identity, rounded, (), (), parent, above, origin, identity)
