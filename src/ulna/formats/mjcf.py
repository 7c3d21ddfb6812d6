"""MJCF files -> ModelBuilder -> Model: MuJoCo's own compiler reads them, the result is passed to the builder.

    MuJoCo                                          | here
    ------------------------------------------------|---------------------------------------------------------
    a body with n joints                            | n joints in a row, the links between them without mass
    joint at `pos` about `axis`, angle `ref` at rest | T = trans(pos) rot(axis, q - ref) trans(-pos)
    free joint, quaternions wxyz                    | FreeFlyer, quaternions xyzw, velocity in the body's frame
    hinge without a range                           | Revolute without limits: an angle that counts turns
    equality of two joints, linear                  | mimic joint
    keyframes, sites                                | configurations, frames
    exclusions, masks and pairs of contacts          | collision shapes and disabled pairs (`mjcf_contacts`)
    flags of <option>                                | what they disable is left out (`mjcf_switches`)
    actuators                                       | effort limits, armature, damping (`mjcf_drives`)
    rest position, where it is not neutral           | the configuration "qpos0"
    tendons, springs, closed loops, plugins ...     | not in a model; a warning names them (`mjcf_omitted`)

Source: MuJoCo documentation, "XML reference" and "Computation", kinematics of joints.
"""

from __future__ import annotations

import os
import re
from typing import Any

import numpy as np

from ulna.errors import FormatError, InputError, ModelError, UnknownName
from ulna.formats.mjcf_contacts import contacts
from ulna.formats.mjcf_couplings import couplings
from ulna.formats.mjcf_drives import Drives
from ulna.formats.mjcf_omitted import OmissionSearch
from ulna.formats.mjcf_parse import (
    BALL,
    FREE,
    HINGE,
    SLIDE,
    CompiledMjcf,
    UnnamedParts,
    names_of,
    pose_of,
    read_mjcf,
    text_or_file,
    unused_name,
)
from ulna.formats.mjcf_shapes import Shapes
from ulna.formats.mjcf_switches import Switches
from ulna.formats.omitted import warn_of_omissions
from ulna.formats.root import root_kind
from ulna.model import Fixed, FreeFlyer, JointKind, Model, ModelBuilder, Prismatic, Revolute, Spherical
from ulna.spatial import SE3, Inertia

Root = str | JointKind | None


def model_from_mjcf(
    source: str | os.PathLike[str], *, root: Root = None, mimic: bool = True, trusted: bool = False
) -> Model:
    """The model that an MJCF file or text describes.

    The world of the file is the root link, "world"; its bodies hang from it. Units are the file's, which are
    metres, kilogrammes and radians after MuJoCo has compiled it.

    Args:
        source: a path, or text (from "<").
        root: how the world of the file hangs in the world: None fixed, "free_flyer", or any joint kind. Robots with a
            free joint need none.
        mimic: whether joints coupled by a linear equality follow their leader; False lets each move on its own.
        trusted: whether MuJoCo compiles it in this process and without limits of time and memory.

    Returns:
        The model.

    Raises:
        MissingExtra: the package mujoco is not installed.
        FormatError: the file is missing or broken, or contradicts itself.
    """
    return _built(_mjcf_builder(source, root=root, mimic=mimic, trusted=trusted))


def model_with_names(source: str | os.PathLike[str], unnamed: UnnamedParts) -> Model:
    """The model that an MJCF file or text describes, without joints that follow others; see `model_from_mjcf`.

    Args:
        source: A path, or text (from "<").
        unnamed: How joints and sites without a name are called.

    Returns:
        The model.
    """
    return _built(_mjcf_builder(source, mimic=False, unnamed=unnamed))


def _built(builder: ModelBuilder) -> Model:
    try:
        return builder.build()
    except (ModelError, InputError) as error:
        if isinstance(error, (FormatError, UnknownName)):
            raise
        raise FormatError(str(error), file=builder._state.source) from error


def _mjcf_builder(
    source: str | os.PathLike[str],
    *,
    root: Root = None,
    mimic: bool = True,
    trusted: bool = False,
    unnamed: UnnamedParts = UnnamedParts(),  # noqa: B008
) -> ModelBuilder:
    """A builder filled with what an MJCF file or text describes, for adding to it before building.

    Warns (ModelWarning) once about all that has no place in a model.
    """
    reading = _Reading(read_mjcf(source, trusted), text_or_file(source)[1], unnamed)
    return reading.builder(root_kind(root), mimic)


class _Reading:
    """One compiled file on its way into a builder."""

    def __init__(self, compiled: CompiledMjcf, file: str | None, unnamed: UnnamedParts) -> None:
        self._m, self._compiled, self._file = compiled.model, compiled, file
        self._unnamed = unnamed
        self._switches = Switches.of(compiled.model)
        self._drives = Drives(compiled.model, self._switches)
        self._joined = couplings(compiled.model, self._switches.equalities)
        self._followers = self._joined.by_leader()
        self._touching = contacts(compiled.model, self._switches)
        self._links, self._joints = names_of(compiled.model, unnamed)
        self._taken_links, self._taken_joints = {*self._links}, {*self._joints}
        self._shapes = Shapes(compiled, file, self._touching.geoms, self._links)

    def builder(self, root: JointKind | None, mimic: bool) -> ModelBuilder:
        m = self._m
        builder = ModelBuilder(re.sub(r"\0.*", "", m.names.decode(), flags=re.S) or "mjcf", source=self._file)
        builder.gravity = np.array(m.opt.gravity) if self._switches.gravity else np.zeros(3)
        if root is not None:
            builder.root_joint(root)
        for body in range(m.nbody):
            visuals, collisions = self._shapes.of_body(body)
            heavy = body and (m.body_mass[body] > 0.0 or np.any(m.body_inertia[body]))
            inertia = self._inertia(body) if heavy else None
            builder.add_link(self._links[body], inertia, visuals, collisions)
        for body in range(1, m.nbody):
            self._hang(builder, body, mimic)
        self._add_frames(builder)
        self._add_configurations(builder)
        self._disable_pairs(builder)
        search = OmissionSearch(self._compiled, self._switches, self._drives, self._joined, self._touching)
        warn_of_omissions(search.omissions(self._shapes.omitted), self._file)
        return builder

    def _inertia(self, body: int) -> Inertia:
        m = self._m
        frame = pose_of(m.body_ipos[body], m.body_iquat[body])
        R = frame.rotation
        matrix = R @ np.diag(m.body_inertia[body]) @ R.T
        return Inertia(float(m.body_mass[body]), frame.translation, (matrix + matrix.T) / 2.0)

    def _hang(self, builder: ModelBuilder, body: int, mimic: bool) -> None:
        """Joins a body with its parent: by a fixed joint, or by its joints in a row."""
        m = self._m
        parent, child = self._links[m.body_parentid[body]], self._links[body]
        place = pose_of(m.body_pos[body], m.body_quat[body])
        first, count = int(m.body_jntadr[body]), int(m.body_jntnum[body])
        if count == 0:
            name = unused_name(f"{child}_fixed", self._taken_joints)
            builder.add_joint(name, Fixed(), parent, child, place)
            return
        for j in range(first, first + count):
            last = j == first + count - 1
            below = child
            if not last:
                below = unused_name(f"{child}_before_{self._joints[j + 1]}", self._taken_links)
                builder.add_link(below)
            kind, at, offset = self._motion(j)
            # A free joint's position is the body's own; where the file puts the body is only where it starts.
            where = SE3.identity() if m.jnt_type[j] == FREE else place @ at
            builder.add_joint(
                self._joints[j],
                kind,
                parent,
                below,
                where,
                offset=offset,
                **self._bounds(j, mimic),
                mimic=self._followed(j) if mimic else None,
            )
            parent, place = below, SE3.identity()

    def _motion(self, j: int) -> tuple[JointKind, SE3, SE3]:
        """The kind of a joint, where it is on the body before it moves, and the body in the moving frame."""
        m = self._m
        kind, anchor = int(m.jnt_type[j]), m.jnt_pos[j]
        reference = float(m.qpos0[m.jnt_qposadr[j]])
        x, y, z = (float(c) for c in m.jnt_axis[j])
        if kind == FREE:
            return FreeFlyer(), SE3.identity(), SE3.identity()
        if kind == BALL:
            return Spherical(), SE3.trans(*anchor), SE3.trans(*-anchor)
        if kind == SLIDE:
            return Prismatic((x, y, z)), SE3.trans(*(-reference * m.jnt_axis[j])), SE3.identity()
        half = np.r_[m.jnt_axis[j] * np.sin(-reference / 2.0), np.cos(-reference / 2.0)]
        return Revolute((x, y, z)), SE3.from_quat_xyzw(half, anchor), SE3.trans(*-anchor)

    def _bounds(self, j: int, mimic: bool) -> dict[str, Any]:
        """Limits and losses of a joint, as `add_joint` takes them; a leader stays in the ranges of its followers."""
        drives = self._drives
        options: dict[str, Any] = {
            "damping": drives.damping(j),
            "friction": drives.friction(j),
            "armature": drives.armature(j),
        }
        if drives.scalar_joint(j):
            lower, upper = self._range(j)
            for follower, multiplier, offset in self._followers.get(j, ()) if mimic else ():
                ends = sorted((end - offset) / multiplier for end in self._range(follower))
                lower, upper = max(lower, ends[0]), min(upper, ends[1])
            if lower > upper:  # they contradict each other
                lower, upper = self._range(j)
            options["lower"], options["upper"] = lower, upper
            effort = max(abs(x) for x in drives.force_range(j))
            if effort < np.inf:
                options["effort"] = effort
        return options

    def _range(self, j: int) -> tuple[float, float]:
        """The range of a hinge or slide; infinite where nothing limits it."""
        if not (self._m.jnt_limited[j] and self._switches.limits):
            return -np.inf, np.inf
        lower, upper = (float(x) for x in self._m.jnt_range[j])
        return lower, upper

    def _followed(self, j: int) -> tuple[str, float, float] | None:
        """Whom a joint follows, as `add_joint` takes it."""
        if j not in self._joined.followed:
            return None
        leader, multiplier, offset = self._joined.followed[j]
        return self._joints[leader], multiplier, offset

    def _add_frames(self, builder: ModelBuilder) -> None:
        m = self._m
        taken = {*builder.link_names, *builder.joint_names}
        for s in range(m.nsite):
            body = int(m.site_bodyid[s])
            number = int(np.count_nonzero(m.site_bodyid[:s] == body))
            name = m.site(s).name or self._unnamed.site.format(body=self._links[body], number=number)
            if name:
                place = pose_of(m.site_pos[s], m.site_quat[s])
                called = unused_name(name if name not in taken else f"{name}_site", taken)
                builder.add_frame(called, self._links[body], place)

    def _add_configurations(self, builder: ModelBuilder) -> None:
        m = self._m
        names = [m.key(k).name for k in range(m.nkey)]
        taken = {*names}
        if FREE in m.jnt_type or np.any(m.qpos0[m.jnt_qposadr[np.isin(m.jnt_type, (SLIDE, HINGE))]]):
            builder.add_configuration(unused_name("qpos0", taken), self._positions(m.qpos0))
        for k, name in enumerate(names):
            called = name or unused_name(f"key_{k}", taken)
            builder.add_configuration(called, self._positions(m.key_qpos[k]))

    def _positions(self, qpos: Any) -> dict[str, Any]:
        """MuJoCo's positions by joint, quaternions as xyzw."""
        m, q = self._m, {}
        for j in range(m.njnt):
            at, kind = int(m.jnt_qposadr[j]), int(m.jnt_type[j])
            values = np.array(qpos[at : at + {FREE: 7, BALL: 4}.get(kind, 1)])
            if kind in (FREE, BALL):
                values[-4:] = np.roll(values[-4:], -1)
            q[self._joints[j]] = values if len(values) > 1 else float(values[0])
        return q

    def _disable_pairs(self, builder: ModelBuilder) -> None:
        for one, two in self._touching.disabled:
            builder.disable_pair(self._links[one], self._links[two])
