"""From the state of a builder to a model: checks the fit, merges what is fixed, numbers what moves."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from ulna.errors import ModelWarning, UnknownName
from ulna.model.check import checked_gravity
from ulna.model.joints import Composite, Continuous, JointKind, Revolute
from ulna.model.joints.axes import constant, snap_pose
from ulna.model.model import Model
from ulna.model.parts import Frame, Joint, Link, Mimic
from ulna.model.positions import position
from ulna.model.records import BuilderState, FrameRecord, JointRecord, LinkRecord, model_error, with_location
from ulna.model.tree import depth_first, joints_above, root_link
from ulna.spatial import SE3, Inertia
from ulna.system.callers import level_of_caller


def assemble(state: BuilderState) -> Model:
    """The model of a builder; see `ModelBuilder.build`."""
    name, links, root_joint = state.name, state.links, state.root_joint
    above = joints_above(name, links, state.joints)
    root = root_link(name, links, above)
    if root_joint is not None and root_joint.name in state.joints:
        what = f"The root joint and another joint are both named {root_joint.name!r}"
        raise model_error(root_joint.where, f"{what}. Rename one of them.")
    order = depth_first(name, root, links, above)
    connecting = above if root_joint is None else {**above, root: root_joint}
    joints, placed = _place(order, links, connecting)
    inertias, base_inertia = aggregate(joints, placed)
    _warn_of_inertias(state)
    model = Model(
        name=name,
        joints=joints,
        links=placed,
        frames=_frames(placed, connecting, state.frames),
        inertias=inertias,
        base_inertia=base_inertia,
        gravity=checked_gravity(state.gravity),
        configurations={},
        tool=_default_tool(joints, placed) if state.tool is None else state.tool,
        disabled_pairs=_checked_pairs(state.disabled_pairs, links),
        groups=_checked_groups(state.groups, {joint.name: joint for joint in connecting.values()}),
        source=state.source,
    )
    if model.tool not in model.frame_names:
        raise UnknownName("frame", model.tool, model.frame_names, "It is to be the tool.")
    positions = {n: position(model, q, f"configuration {n!r}") for n, q in state.configurations.items()}
    return replace(model, configurations=positions) if positions else model


def _place(
    order: Iterable[str], links: Mapping[str, LinkRecord], above: Mapping[str, JointRecord]
) -> tuple[tuple[Joint, ...], tuple[Link, ...]]:
    """Joints and links in order, each placed in the moving frame of the last movable joint before it."""
    moving: list[tuple[JointRecord, int, SE3]] = []  # record, parent joint, placement in its moving frame
    placed: dict[str, Link] = {}
    identity = snap_pose(SE3.identity())
    for name in order:
        record, joint = links[name], above.get(name)
        before = placed[joint.parent] if joint is not None and joint.parent is not None else None
        carrier, pose = (before.joint, before.placement) if before else (-1, identity)
        if joint is not None:
            pose = snap_pose(pose @ joint.placement)
            if joint.movable:
                moving.append((joint, carrier, pose))
                carrier, pose = len(moving) - 1, joint.offset
            else:
                pose = snap_pose(pose @ joint.offset)
        placed[name] = Link(
            name=name,
            joint=carrier,
            placement=pose,
            inertia=record.inertia,
            visuals=record.visuals,
            collisions=record.collisions,
            parent=before.name if before else None,
            parent_joint=joint.name if joint else None,
            origin=joint.placement if joint else identity,
            offset=joint.offset if joint else identity,
        )
    children = {joint.name: name for name, joint in above.items()}
    return _number(moving, children), tuple(placed.values())


def _number(moving: list[tuple[JointRecord, int, SE3]], children: Mapping[str, str]) -> tuple[Joint, ...]:
    """The joints with their parts of q and v; mimic joints point to those of their source."""
    records = {record.name: record for record, _, _ in moving}
    index = {name: i for i, name in enumerate(records)}
    followed = _followed((record for record, _, _ in moving if record.mimic is not None), records)
    starts: dict[str, tuple[int, int]] = {}
    nq = nv = 0
    for record in records.values():
        if record.mimic is None:
            starts[record.name] = (nq, nv)
            nq, nv = nq + record.kind.nq, nv + record.kind.nv
    geared = _geared(followed, records)
    joints = []
    for record, parent, placement in moving:
        mimic = None
        source = record.name
        if record.mimic is not None:
            source, multiplier, offset = followed[record.name]
            name, ratio, shift = record.mimic
            leader = None if name == source else (index[name], ratio, shift)
            mimic = Mimic(index[source], multiplier, offset, leader)
        idx_q, idx_v = starts[source]
        joints.append(
            Joint(
                name=record.name,
                kind=geared.get(record.name, record.kind),
                parent=parent,
                placement=placement,
                idx_q=idx_q,
                idx_v=idx_v,
                limits=record.limits,
                damping=record.damping,
                friction=record.friction,
                armature=record.armature,
                mimic=mimic,
                parent_link=record.parent,
                child_link=children[record.name],
            )
        )
    return tuple(joints)


def _followed(
    followers: Iterable[JointRecord], records: Mapping[str, JointRecord]
) -> dict[str, tuple[str, float, float]]:
    """For each mimic joint the joint that it follows in the end, and the ratio and offset of the whole chain."""
    resolved: dict[str, tuple[str, float, float]] = {}
    for record in followers:
        chain = _chain(record, records, resolved)
        for link in reversed(chain):  # each follows the next one, whose own leader is known by then
            assert link.mimic is not None
            leader, ratio, shift = link.mimic
            source, multiplier, offset = resolved.get(leader, (leader, 1.0, 0.0))
            resolved[link.name] = (source, ratio * multiplier, ratio * offset + shift)
    return resolved


def _chain(
    record: JointRecord, records: Mapping[str, JointRecord], known: Mapping[str, object]
) -> list[JointRecord]:
    """The mimic joints from `record` on, each following the next, up to one that is known or follows a free joint."""
    walked: dict[str, JointRecord] = {}
    current = record
    while current.mimic is not None and current.name not in known:
        if current.name in walked:
            names = list(walked)
            circle = " -> ".join(repr(n) for n in [*names[names.index(current.name) :], current.name])
            raise model_error(record.where, f"Mimic joints follow one another in a circle: {circle}.")
        walked[current.name] = current
        name = current.mimic[0]
        if name not in records:
            raise UnknownName(
                "movable joint",
                name,
                records,
                with_location(current.where, f"Joint {current.name!r} is to mimic it."),
            )
        current = records[name]
    if current.mimic is None and (current.kind.nq, current.kind.nv) != (1, 1):
        what = f"Joint {record.name!r} mimics {current.name!r} ({current.kind.describe()})"
        raise model_error(record.where, f"{what}; only joints with one coordinate can be followed.")
    return list(walked.values())


def _geared(
    followed: Mapping[str, tuple[str, float, float]], records: Mapping[str, JointRecord]
) -> dict[str, JointKind]:
    """The continuous joints to which a turn more or less is another place, because of what follows them."""
    geared: dict[str, JointKind] = {}
    for name, (source, multiplier, _) in followed.items():
        turns_whole = isinstance(records[name].kind, Revolute) and multiplier == round(multiplier)
        if not turns_whole:
            geared[source] = _counting_turns(records[source].kind)
    return geared


def _counting_turns(kind: JointKind) -> JointKind:
    """The same motion, with an angle that counts turns."""
    if isinstance(kind, Composite):
        return Composite(tuple(map(_counting_turns, kind.kinds)), kind.placements)
    return Revolute(kind.axis) if isinstance(kind, Continuous) else kind


def _frames(
    links: tuple[Link, ...], above: Mapping[str, JointRecord], added: Mapping[str, FrameRecord]
) -> tuple[Frame, ...]:
    """The frames of links and joints in the order of the links, then those that were added."""
    identity = snap_pose(SE3.identity())
    frames: list[Frame] = []
    for link in links:
        joint = above.get(link.name)
        if joint is not None:
            back = snap_pose(link.offset.inverse())
            pose = snap_pose(link.placement @ back) if not joint.movable else identity
            kind = "joint" if joint.movable else "fixed_joint"
            frames.append(Frame(joint.name, link.joint, pose, kind, link.name, back))
        frames.append(Frame(link.name, link.joint, link.placement, "link", link.name, identity))
    taken = {frame.name: frame.kind for frame in frames}
    by_name = {link.name: link for link in links}
    for record in added.values():
        if record.link not in by_name:
            raise UnknownName(
                "link",
                record.link,
                by_name,
                with_location(record.where, f"Frame {record.name!r} is to be on it."),
            )
        if record.name in taken:
            other = taken[record.name].replace("_", " ")
            raise model_error(record.where, f"Frame {record.name!r} has the name of a {other}. Rename it.")
        link = by_name[record.link]
        pose = snap_pose(link.placement @ record.placement)
        frames.append(Frame(record.name, link.joint, pose, record.kind, link.name, record.placement))
    return tuple(frames)


def aggregate(joints: tuple[Joint, ...], links: tuple[Link, ...]) -> tuple[tuple[Inertia, ...], Inertia]:
    """The inertia of the bodies: of the links that each joint, and the world, carries.

    Args:
        joints: The joints of the model.
        links: The links of the model.

    Returns:
        For each joint the inertia of its body, in its moving frame, and that of the links fixed to the world [kg, m,
        kg m^2].
    """
    sums: list[Inertia | None] = [None] * (len(joints) + 1)  # the last one is the world, index -1
    for link in links:
        if link.inertia.mass == 0.0 and not link.inertia.inertia.any():
            continue
        in_joint_frame = link.placement.act(link.inertia)
        so_far = sums[link.joint]
        sums[link.joint] = in_joint_frame if so_far is None else so_far + in_joint_frame
    done = [
        Inertia(float(i.mass), constant(i.com + 0.0), constant(i.inertia + 0.0))
        for i in (Inertia.zero() if i is None else i for i in sums)
    ]
    return tuple(done[:-1]), done[-1]


_MEASURED = 0.1
"""How far, of the largest moment, the others may fall short of it: rounded plates do, and the measured Puma (0.09)."""
_SLIGHT = 1e-4
"""What share of the largest moment of all links counts as zero: placeholders on links without a body."""


def _impossible_inertias(state: BuilderState) -> tuple[list[str], list[tuple[float, str]]]:
    """Links with a negative principal moment, and those with one larger than the other two together by some share."""
    moments = {name: np.linalg.eigvalsh(link.inertia.inertia) for name, link in state.links.items()}
    slight = _SLIGHT * max((float(np.abs(m).max()) for m in moments.values()), default=0.0)
    negative: list[str] = []
    lopsided: list[tuple[float, str]] = []
    for name, (least, middle, largest) in moments.items():
        link = state.links[name]
        if name in state.from_models:
            continue
        # Noise in the file: beside the other moments, or beside those of the mass within a micrometre.
        noise = max(1e-9 * max(abs(least), abs(largest)), 1e-12 * float(link.inertia.mass), 1e-21)
        excess = largest - middle - least
        one_moment = (
            abs(middle) <= noise
        )  # published models often hold only the moment about the joint's axis
        if least < -noise:
            negative.append(with_location(link.where, f"{name!r} ({least:.3g} kg m^2)"))
        elif excess > max(_MEASURED * largest, slight) and not one_moment:
            sides = f"{name!r}: {largest:.3g} > {middle:.3g} + {least:.3g} kg m^2"
            lopsided.append((excess / largest, with_location(link.where, sides)))
    return negative, lopsided


def _warn_of_inertias(state: BuilderState) -> None:
    """One warning about all inertias that no distribution of mass has."""
    negative, lopsided = _impossible_inertias(state)
    groups = []
    if negative:
        groups.append(f"with a negative principal moment: {', '.join(negative)}")
    if lopsided:
        links = "1 link" if len(lopsided) == 1 else f"{len(lopsided)} links"
        groups.append(
            f"with a principal moment larger than the other two together, at {links}, the worst "
            f"{max(lopsided)[1]} (are its six numbers in order, and about the centre of mass?)"
        )
    if groups:
        trust = (
            "do not trust the dynamics"
            if negative
            else "the dynamics are those of the numbers, not of a body"
        )
        warnings.warn(
            f"Model {state.name!r} has inertias that no body has, {'; and '.join(groups)}. "
            f"Kinematics are right; {trust}.",
            ModelWarning,
            stacklevel=level_of_caller(),
        )


def _default_tool(joints: tuple[Joint, ...], links: tuple[Link, ...]) -> str:
    """The leaf link with the most independent joints before it; the first of those."""
    depth = [0] * (len(joints) + 1)
    for i, joint in enumerate(joints):
        depth[i] = depth[joint.parent] + (joint.mimic is None)
    inner = {link.parent for link in links}
    leaves = [link for link in links if link.name not in inner]
    return max(leaves, key=lambda link: depth[link.joint]).name


def _checked_pairs(
    pairs: Iterable[tuple[str, str]], links: Mapping[str, LinkRecord]
) -> tuple[tuple[str, str], ...]:
    for pair in sorted(pairs):
        for link in pair:
            if link not in links:
                raise UnknownName("link", link, links, "Its collision check is to be disabled.")
    return tuple(sorted(pairs))


def _checked_groups(
    groups: Mapping[str, tuple[str, ...]], joints: Mapping[str, JointRecord]
) -> dict[str, tuple[str, ...]]:
    for group, names in groups.items():
        for name in names:
            if name not in joints:
                raise UnknownName("joint", name, joints, f"It is to be in group {group!r}.")
    return {group: tuple(n for n in names if joints[n].movable) for group, names in groups.items()}
