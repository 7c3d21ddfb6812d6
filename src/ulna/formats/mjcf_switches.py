"""Which computations of MuJoCo an MJCF file switches off, by `<option><flag .../></option>`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

CONSTRAINT, EQUALITY, FRICTIONLOSS, LIMIT, CONTACT, SPRING, DAMPER, GRAVITY, CLAMPCTRL = range(9)
FILTERPARENT, ACTUATION = 10, 11
"""Bits of mjtDisableBit."""


@dataclass(frozen=True)
class Switches:
    """What takes part in MuJoCo's computations; all of it unless a file says otherwise.

    Attributes:
        gravity: gravity.
        equalities: equality constraints.
        frictionloss: dry friction of joints and tendons.
        limits: limits of joints and tendons.
        contacts: contacts between geoms.
        springs: springs of joints, tendons and flexes.
        dampers: dampers of joints, tendons, flexes and actuators.
        other_passive: all other passive forces: gravity compensation, fluids, plugins.
        clamped_controls: whether controls are held in their ranges.
        filtered_parents: whether a body does not touch its parent.
        actuation: forces of actuators.
        actuator_groups_off: bits of the groups of actuators that exert no forces.
    """

    gravity: bool = True
    equalities: bool = True
    frictionloss: bool = True
    limits: bool = True
    contacts: bool = True
    springs: bool = True
    dampers: bool = True
    other_passive: bool = True
    clamped_controls: bool = True
    filtered_parents: bool = True
    actuation: bool = True
    actuator_groups_off: int = 0

    @classmethod
    def of(cls, m: Any) -> Switches:
        """The switches of a compiled model."""
        bits = int(m.opt.disableflags)

        def on(bit: int) -> bool:
            return not bits >> bit & 1

        constraints = on(CONSTRAINT)
        return cls(
            gravity=on(GRAVITY),
            equalities=constraints and on(EQUALITY),
            frictionloss=constraints and on(FRICTIONLOSS),
            limits=constraints and on(LIMIT),
            contacts=constraints and on(CONTACT),
            springs=on(SPRING),
            dampers=on(DAMPER),
            other_passive=on(SPRING) or on(DAMPER),
            clamped_controls=on(CLAMPCTRL),
            filtered_parents=on(FILTERPARENT),
            actuation=on(ACTUATION),
            actuator_groups_off=int(m.opt.disableactuator),
        )
