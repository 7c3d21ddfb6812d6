"""Content of a compiled MJCF file that a model has no place for, as omissions with names and lines."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from ulna.formats.mjcf_contacts import Contacts
from ulna.formats.mjcf_couplings import Couplings, reason_omitted
from ulna.formats.mjcf_drives import Drives
from ulna.formats.mjcf_parse import BALL, FREE, CompiledMjcf, names_of
from ulna.formats.mjcf_switches import Switches
from ulna.formats.omitted import Omission, place

ADD_TO_TAU = "Add their torques to `tau`."
_FAR_FROM_EQUALITY = 1e-3  # [rad, m]; keyframes are written with few digits


class OmissionSearch:
    """Looks through one compiled file for what a model cannot hold.

    Args:
        compiled: The compiled file.
        switches: What the file switches off.
        drives: Its actuators.
        joined: How its joints follow one another.
        touching: What may touch in it.
    """

    def __init__(
        self,
        compiled: CompiledMjcf,
        switches: Switches,
        drives: Drives,
        joined: Couplings,
        touching: Contacts,
    ) -> None:
        self._m, self._lines = compiled.model, compiled.lines
        self._switches, self._drives = switches, drives
        self._joined, self._touching = joined, touching
        self._links, self._joints = names_of(compiled.model)

    def omissions(self, shapes: Mapping[str, int]) -> list[Omission]:
        """All of them; `shapes` counts the geoms without a shape here."""
        omitted = [
            *self._joint_forces(),
            *self._tendons(),
            *self._equalities(),
            *self._keyframes(),
            *self._actuators(),
            *self._bodies(),
            *self._surroundings(),
            *self._contacts(),
        ]
        omitted += [
            Omission(
                "<geom>", f"{count} {what} are neither drawn nor checked for collision.", "Use other shapes."
            )
            for what, count in shapes.items()
        ]
        return omitted

    def _joint_forces(self) -> Iterator[Omission]:
        m, on = self._m, self._switches
        springs = self._nonzero(m.jnt_stiffness, getattr(m, "jnt_stiffnesspoly", None))
        if on.springs:
            yield from self._at_joints(
                "<joint stiffness>", springs, "forces and torques are without these springs.", ADD_TO_TAU
            )
        curved = self._nonzero(getattr(m, "dof_dampingpoly", None))
        if on.dampers:
            yield from self._at_joints(
                "<joint damping>",
                dict.fromkeys(int(m.dof_jntid[k]) for k in curved),
                "only the first, linear coefficient is in `model.damping`.",
                "Add the torques of the others to `tau`.",
            )
        free = np.flatnonzero(m.jnt_type == FREE).tolist()
        yield from self._at_joints(
            "<joint armature>",
            [j for j in free if self._drives.armature(j).any()],
            "at a free joint MuJoCo counts it along the world's axes: bias forces of a turning body differ by it.",
            "Give the body the inertia instead.",
        )
        if on.frictionloss:
            rough = self._nonzero(m.dof_frictionloss)
            yield from self._at_joints(
                "<joint frictionloss>",
                dict.fromkeys(int(m.dof_jntid[k]) for k in rough if m.jnt_type[m.dof_jntid[k]] == FREE),
                "MuJoCo's dry friction of a free joint acts along the world's axes, Ulna's along the body's.",
                "Use frictionloss=0, or damping.",
            )
        if on.limits:
            yield from self._at_joints(
                "<joint range>",
                [j for j in range(m.njnt) if m.jnt_type[j] == BALL and m.jnt_limited[j]],
                "a ball joint has no limits here.",
                "Check its angle of rotation yourself.",
            )

    def _tendons(self) -> Iterator[Omission]:
        m, on = self._m, self._switches
        kinds = {
            "stiffness": (
                on.springs,
                self._nonzero(m.tendon_stiffness, getattr(m, "tendon_stiffnesspoly", None)),
            ),
            "damping": (on.dampers, self._nonzero(m.tendon_damping, getattr(m, "tendon_dampingpoly", None))),
            "frictionloss": (on.frictionloss, self._nonzero(m.tendon_frictionloss)),
            "range": (on.limits, self._nonzero(m.tendon_limited)),
            "armature": (True, self._nonzero(getattr(m, "tendon_armature", None))),
        }
        effects = {
            "stiffness": ("forces and torques are without the springs of tendons.", ADD_TO_TAU),
            "damping": ("forces and torques are without the damping of tendons.", ADD_TO_TAU),
            "frictionloss": ("forces and torques are without the friction of tendons.", ADD_TO_TAU),
            "range": ("limits of tendons do not limit the joints.", "Limit the joints themselves."),
            "armature": ("the mass matrix is without the inertia of tendons.", "Use armature of joints."),
        }
        for attribute, (matters, tendons) in kinds.items():
            if matters and tendons:
                places = tuple(self._location("tendon", m.tendon(t).name, t) for t in tendons)
                yield Omission(f"<tendon {attribute}>", *effects[attribute], places)

    def _keyframes(self) -> Iterator[Omission]:
        """Keyframes in which a joint is not where it follows another one to."""
        m, places = self._m, []
        for k in range(m.nkey):
            q = m.key_qpos[k][m.jnt_qposadr]
            for j, (leader, multiplier, offset) in self._joined.followed.items():
                there = multiplier * q[leader] + offset
                if abs(q[j] - there) > _FAR_FROM_EQUALITY * max(1.0, abs(there)):
                    joint, led = (
                        f"{self._joints[j]!r} is at {q[j]:.4g}",
                        f"{self._joints[leader]!r} to {there:.4g}",
                    )
                    key = self._location("key", m.key(k).name, k)
                    places.append(f"{key} where {joint}, and follows {led}")
        if places:
            effect = "joints that follow others are where these lead them."
            yield Omission("<key qpos>", effect, "Correct the keyframe, or the equality.", tuple(places))

    def _equalities(self) -> Iterator[Omission]:
        m = self._m
        not_expressed: dict[tuple[str, str, str], list[str]] = {}
        for e in range(m.neq):
            if self._switches.equalities and m.eq_active0[e] and e not in self._joined.expressed:
                not_expressed.setdefault(reason_omitted(m, e), []).append(
                    self._location("equality", m.equality(e).name, e)
                )
        for (element, effect, advice), places in not_expressed.items():
            yield Omission(element, effect, advice, tuple(places))

    def _actuators(self) -> Iterator[Omission]:
        m, drives = self._m, self._drives
        uneven = [j for j in range(m.njnt) if drives.scalar_joint(j) and _is_uneven(*drives.force_range(j))]
        yield from self._at_joints(
            "<joint actuatorfrcrange>, or <actuator forcerange> or <motor ctrlrange>",
            uneven,
            "the range of force is not symmetric; the larger magnitude is the effort limit in both directions.",
            "Set a smaller limit, if that matters.",
        )
        elsewhere = [
            a
            for a in range(drives.count)
            if not (drives.joint_of(a) >= 0 and drives.scalar_joint(drives.joint_of(a)))
            and drives.exerts_force(a)
            and drives.is_bounded(a)
        ]
        yield from self._at_actuators(
            "<actuator> that does not act on a hinge or slide",
            elsewhere,
            "its limit of force is not among the effort limits of the joints.",
            "Limit the torques of the joints, if that matters.",
        )
        yield from self._actuator_dynamics()

    def _actuator_dynamics(self) -> Iterator[Omission]:
        m, drives = self._m, self._drives
        curved = [
            a for a in self._nonzero(getattr(m, "actuator_dampingpoly", None)) if drives.joint_of(a) >= 0
        ]
        off_joint = {
            name: [a for a in self._nonzero(getattr(m, f"actuator_{name}", None)) if drives.joint_of(a) < 0]
            for name in ("armature", "damping")
        }
        if self._switches.dampers:
            yield from self._at_actuators(
                "<actuator damping>",
                [*curved, *off_joint["damping"]],
                "only linear damping of actuators on joints is in `model.damping`.",
                ADD_TO_TAU,
            )
        yield from self._at_actuators(
            "<actuator armature>",
            off_joint["armature"],
            "the mass matrix is without the inertia of actuators on tendons.",
            "Use armature of joints.",
        )
        yield from self._at_actuators(
            "<actuator><plugin>",
            np.flatnonzero(m.actuator_plugin >= 0),
            "its forces are not computed.",
            ADD_TO_TAU,
        )

    def _bodies(self) -> Iterator[Omission]:
        m, on = self._m, self._switches
        if on.gravity and on.other_passive and np.any(m.opt.gravity):
            yield from self._at_bodies(
                "<body gravcomp>",
                np.flatnonzero(m.body_gravcomp),
                "gravity acts on these bodies in full.",
                "Add the compensation to `tau`.",
            )
        yield from self._at_bodies(
            "<body mocap>",
            np.flatnonzero(m.body_mocapid >= 0),
            "it is fixed where the file puts it.",
            'Give it a free joint, or load it as a separate robot with root="free_flyer".',
        )
        if on.other_passive:
            yield from self._at_bodies(
                "<body><plugin>",
                np.flatnonzero(m.body_plugin >= 0),
                "its forces are not computed.",
                ADD_TO_TAU,
            )

    def _surroundings(self) -> Iterator[Omission]:
        m, on = self._m, self._switches
        if on.other_passive:
            medium = [name for name in ("density", "viscosity") if getattr(m.opt, name) > 0.0]
            medium += ["wind"] if medium and np.any(m.opt.wind) else []
            if medium:
                yield Omission(
                    f"<option {' '.join(medium)}>",
                    "forces of the surrounding fluid are not computed.",
                    ADD_TO_TAU,
                )
        if m.nflex:
            yield Omission(
                "<flex> and <flexcomp>",
                "the model has their bodies and joints, without elasticity, edges, shapes and contacts.",
                "Leave soft bodies out, or compute their forces yourself.",
                tuple(place("flex", _name_at(m, m.name_flexadr[f]), None) for f in range(m.nflex)),
            )

    def _contacts(self) -> Iterator[Omission]:
        m = self._m
        mixed, neighbours = (
            tuple(f"{self._links[a]!r} and {self._links[b]!r}" for a, b in pairs)
            for pairs in (self._touching.mixed, self._touching.neighbours)
        )
        if neighbours:
            yield Omission(
                "<contact><pair>",
                "links that are joined rigidly or by one joint are not checked against each other.",
                "Name joined links in `pairs` of the checker; rigid ones never move apart.",
                neighbours,
            )
        if mixed:
            yield Omission(
                "<geom contype conaffinity>, <contact><pair>",
                "of these bodies only some geoms may touch each other; checks of collision look at all of them.",
                "Put the geoms on separate bodies, if that matters.",
                mixed,
            )
        if not self._switches.filtered_parents and np.any(m.body_jntnum):
            yield Omission(
                '<flag filterparent="disable">',
                "links joined by one joint are still left out of the checks of collision.",
                "Pass pairs=link_pairs(model, adjacent=True) to the checker.",
            )

    def _at_joints(self, element: str, joints: Iterable[int], effect: str, advice: str) -> Iterator[Omission]:
        places = tuple(self._location("joint", self._joints[j], j) for j in joints)
        if places:
            yield Omission(element, effect, advice, places)

    def _at_bodies(self, element: str, bodies: Iterable[Any], effect: str, advice: str) -> Iterator[Omission]:
        places = tuple(self._location("body", self._links[b], b) for b in bodies)
        if places:
            yield Omission(element, effect, advice, places)

    def _at_actuators(
        self, element: str, actuators: Iterable[Any], effect: str, advice: str
    ) -> Iterator[Omission]:
        places = tuple(self._location("actuator", self._m.actuator(int(a)).name, a) for a in actuators)
        if places:
            yield Omission(element, effect, advice, places)

    def _location(self, kind: str, name: str, index: Any) -> str:
        return place(kind, name, self._lines.get(kind, {}).get(int(index)))

    @staticmethod
    def _nonzero(*tables: Any) -> list[int]:
        """The rows in which any of the tables, one row for each element, is not zero."""
        rows = [np.asarray(t).reshape(len(t), -1).any(axis=1) for t in tables if t is not None and len(t)]
        return [int(k) for k in np.flatnonzero(np.any(rows, axis=0))] if rows else []


def _is_uneven(low: float, high: float) -> bool:
    return (
        abs(low + high) > 1e-9 * max(abs(low), abs(high)) if np.isfinite((low, high)).all() else low != -high
    )


def _name_at(m: Any, start: Any) -> str:
    return bytes(m.names[int(start) :]).split(b"\0")[0].decode()
