"""MJCF files -> ModelBuilder -> Model: MuJoCo's own compiler reads them, what it found is told to the builder.

    MuJoCo                                          | here
    ------------------------------------------------|---------------------------------------------------------
    a body with n joints                            | n joints in a row, the links between them without mass
    joint at `pos` about `axis`, angle `ref` at rest | T = trans(pos) rot(axis, q - ref) trans(-pos)
    free joint, quaternions wxyz                    | FreeFlyer, quaternions xyzw, velocity in the body's frame
    hinge without a range                           | Revolute without limits: an angle that counts turns
    equality of two joints, linear                  | mimic joint
    keyframes, sites, excluded pairs                | configurations, frames, disabled pairs
    rest position, where it is not neutral           | the configuration "qpos0"
    tendons, springs, closed loops, plugins ...     | not in a model; a warning names them

Source: MuJoCo documentation, "XML reference" and "Computation", kinematics of joints.
"""

from __future__ import annotations

import os
import re
import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np

from ulna.errors import FormatError, InputError, ModelError, ModelWarning, UnknownName
from ulna.formats.mjcf_parse import (
    BALL,
    FREE,
    HINGE,
    SLIDE,
    CompiledMjcf,
    fresh,
    names_of,
    pose_of,
    read_mjcf,
    text_or_file,
)
from ulna.formats.mjcf_shapes import Shapes
from ulna.formats.root import root_kind
from ulna.model import Fixed, FreeFlyer, JointKind, Model, ModelBuilder, Prismatic, Revolute, Spherical
from ulna.spatial import SE3, Inertia

SAME_JOINTS = 2
"""mjEQ_JOINT of mjtEq."""

NO_GRAVITY = 1 << 7
"""mjDSBL_GRAVITY of mjtDisableBit."""

JOINT_TRANSMISSIONS = (0, 1)
"""mjTRN_JOINT and mjTRN_JOINTINPARENT of mjtTrn."""

Root = str | JointKind | None


def model_from_mjcf(source: str | os.PathLike[str], *, root: Root = None, mimic: bool = True) -> Model:
    """The model that an MJCF file or text describes.

    The world of the file is the root link, "world"; its bodies hang from it. Units are the file's, which are
    metres, kilogrammes and radians after MuJoCo has compiled it.

    Args:
        source: a path, or text (from "<").
        root: how the world of the file hangs in the world: None fixed, "free_flyer", or any joint kind. Robots
            with a free joint of their own need none.
        mimic: whether joints coupled by a linear equality follow their leader; False lets each move on its own.

    Raises:
        MissingExtra: the package mujoco is not installed.
        FormatError: the file is missing or broken, or contradicts itself.
    """
    builder = mjcf_builder(source, root=root, mimic=mimic)
    try:
        return builder.build()
    except (ModelError, InputError) as error:
        if isinstance(error, (FormatError, UnknownName)):
            raise
        raise FormatError(str(error), file=builder._told.source) from error


def mjcf_builder(source: str | os.PathLike[str], *, root: Root = None, mimic: bool = True) -> ModelBuilder:
    """A builder filled with what an MJCF file or text describes, for adding to it before building.

    Warns (ModelWarning) once about all that has no place in a model.
    """
    return _Reading(read_mjcf(source), text_or_file(source)[1]).builder(root_kind(root), mimic)


class _Reading:
    """One compiled file on its way into a builder."""

    def __init__(self, compiled: CompiledMjcf, file: str | None) -> None:
        self._m, self._file = compiled.model, file
        self._shapes = Shapes(compiled.model, compiled.mesh_folder, file)
        self._links, self._joints = names_of(compiled.model)

    def builder(self, root: JointKind | None, mimic: bool) -> ModelBuilder:
        m = self._m
        builder = ModelBuilder(re.sub(r"\0.*", "", m.names.decode(), flags=re.S) or "mjcf", source=self._file)
        builder.gravity = np.zeros(3) if m.opt.disableflags & NO_GRAVITY else np.array(m.opt.gravity)
        if root is not None:
            builder.root_joint(root)
        followed = self._followed() if mimic else {}
        for body in range(m.nbody):
            visuals, collisions = self._shapes.of_body(body)
            inertia = self._inertia(body) if body and m.body_mass[body] > 0.0 else None
            builder.add_link(self._links[body], inertia, visuals, collisions)
        for body in range(1, m.nbody):
            self._hang(builder, body, followed)
        self._add_frames(builder)
        self._add_configurations(builder)
        self._disable_pairs(builder)
        self._report()
        return builder

    def _inertia(self, body: int) -> Inertia:
        m = self._m
        frame = pose_of(m.body_ipos[body], m.body_iquat[body])
        R = frame.rotation
        matrix = R @ np.diag(m.body_inertia[body]) @ R.T
        return Inertia(float(m.body_mass[body]), frame.translation, (matrix + matrix.T) / 2.0)

    def _hang(self, builder: ModelBuilder, body: int, followed: dict[int, tuple[str, float, float]]) -> None:
        """Joins a body with its parent: by a fixed joint, or by its joints in a row."""
        m = self._m
        parent, child = self._links[m.body_parentid[body]], self._links[body]
        place = pose_of(m.body_pos[body], m.body_quat[body])
        first, count = int(m.body_jntadr[body]), int(m.body_jntnum[body])
        if count == 0:
            builder.add_joint(f"{child}_fixed", Fixed(), parent, child, place)
            return
        for j in range(first, first + count):
            last = j == first + count - 1
            below = child if last else f"{child}_before_{self._joints[j + 1]}"
            if not last:
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
                **self._bounds(j),
                mimic=followed.get(j),
            )
            parent, place = below, SE3.identity()

    def _motion(self, j: int) -> tuple[JointKind, SE3, SE3]:
        """The kind of a joint, where it is on the body before it moves, and the body in the moving frame."""
        m = self._m
        kind, anchor = int(m.jnt_type[j]), m.jnt_pos[j]
        rest = float(m.qpos0[m.jnt_qposadr[j]])
        x, y, z = (float(c) for c in m.jnt_axis[j])
        if kind == FREE:
            return FreeFlyer(), SE3.identity(), SE3.identity()
        if kind == BALL:
            return Spherical(), SE3.trans(*anchor), SE3.trans(*-anchor)
        if kind == SLIDE:
            return Prismatic((x, y, z)), SE3.trans(*(-rest * m.jnt_axis[j])), SE3.identity()
        half = np.r_[m.jnt_axis[j] * np.sin(-rest / 2.0), np.cos(-rest / 2.0)]
        return Revolute((x, y, z)), SE3.from_quat_xyzw(half, anchor), SE3.trans(*-anchor)

    def _bounds(self, j: int) -> dict[str, Any]:
        """Limits and losses of a joint, as `add_joint` takes them."""
        m = self._m
        dof = slice(
            int(m.jnt_dofadr[j]), int(m.jnt_dofadr[j]) + {FREE: 6, BALL: 3}.get(int(m.jnt_type[j]), 1)
        )
        found: dict[str, Any] = {
            "damping": m.dof_damping[dof],
            "friction": m.dof_frictionloss[dof],
            "armature": m.dof_armature[dof],
        }
        if m.jnt_type[j] in (SLIDE, HINGE):
            if m.jnt_limited[j]:
                found["lower"], found["upper"] = (float(x) for x in m.jnt_range[j])
            effort = self._effort(j)
            if effort < np.inf:
                found["effort"] = effort
        return found

    def _effort(self, j: int) -> float:
        """The largest force or torque of a joint [N, N m]: of the joint itself, and of its actuators."""
        m = self._m
        own = float(np.abs(m.jnt_actfrcrange[j]).max()) if m.jnt_actfrclimited[j] else np.inf
        driven = [
            float(np.abs(m.actuator_forcerange[a]).max() * abs(m.actuator_gear[a, 0]))
            if m.actuator_forcelimited[a]
            else np.inf
            for a in range(m.nu)
            if m.actuator_trntype[a] in JOINT_TRANSMISSIONS and m.actuator_trnid[a, 0] == j
        ]
        return min(own, sum(driven) if driven else np.inf)

    def _followed(self) -> dict[int, tuple[str, float, float]]:
        """Who follows whom: q1 - r1 = c0 + c1 (q2 - r2), with the rest positions r."""
        m, out = self._m, {}
        for e in self._couplings():
            one, two, (c0, c1) = int(m.eq_obj1id[e]), int(m.eq_obj2id[e]), m.eq_data[e, :2]
            r1, r2 = (float(m.qpos0[m.jnt_qposadr[j]]) for j in (one, two))
            out[one] = (self._joints[two], float(c1), float(c0 + r1 - c1 * r2))
        return out

    def _couplings(self) -> Iterator[int]:
        """Equalities that make a mimic joint: of two joints, linear, active."""
        m = self._m
        for e in range(m.neq):
            linear = m.eq_type[e] == SAME_JOINTS and not np.any(m.eq_data[e, 2:5]) and m.eq_data[e, 1]
            if linear and m.eq_obj2id[e] >= 0 and m.eq_active0[e]:
                yield e

    def _add_frames(self, builder: ModelBuilder) -> None:
        m = self._m
        taken = {*builder.link_names, *builder.joint_names}
        for s in range(m.nsite):
            name = m.site(s).name
            if name:
                place = pose_of(m.site_pos[s], m.site_quat[s])
                called = fresh(name if name not in taken else f"{name}_site", taken)
                builder.add_frame(called, self._links[m.site_bodyid[s]], place)

    def _add_configurations(self, builder: ModelBuilder) -> None:
        m = self._m
        if FREE in m.jnt_type or np.any(m.qpos0[m.jnt_qposadr[np.isin(m.jnt_type, (SLIDE, HINGE))]]):
            builder.add_configuration("qpos0", self._positions(m.qpos0))
        for k in range(m.nkey):
            builder.add_configuration(m.key(k).name or f"key_{k}", self._positions(m.key_qpos[k]))

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
        for signature in self._m.exclude_signature:
            one, two = int(signature) >> 16, int(signature) & 0xFFFF
            if one != two:
                builder.disable_pair(self._links[one], self._links[two])

    def _report(self) -> None:
        """Warns of what the file has and a model has not."""
        m = self._m
        others = m.neq - sum(1 for _ in self._couplings())
        left = {
            "springs of joints": int(np.count_nonzero(m.jnt_stiffness)),
            "tendons": int(m.ntendon),
            "equalities (closed loops: ulna.formats.mjcf_loops.loops_from_mjcf)": int(others),
            "bodies with compensated gravity": int(np.count_nonzero(m.body_gravcomp)),
            "plugins": int(m.nplugin),
            **self._shapes.left,
        }
        words = [f"{count} {what}" for what, count in left.items() if count]
        if words:
            text = f"{self._file or '<string>'}: left out, because a model has no place for them: "
            warnings.warn(text + ", ".join(words) + ".", ModelWarning, stacklevel=2)
