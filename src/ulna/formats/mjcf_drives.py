"""The actuators of a compiled MJCF file, seen from the joints: limits of force, inertia of rotors, damping.

| symbol | meaning | unit | equation |
|---|---|---|---|
| g | gear of an actuator, its first entry | [1] | |
| armature | inertia of the drive at the joint | [kg, kg m^2] | that of the joint, plus g^2 times each actuator's |
| damping | viscous friction at the joint | [N s/m, N m s/rad] | that of the joint, plus g^2 times each actuator's |
| effort | largest actuator force on the joint | [N, N m] | the least of the joint's own range and the actuators' sum |

Source: MuJoCo documentation, "XML reference", actuator/general and body/joint.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.formats.mjcf_parse import HINGE, SLIDE
from ulna.formats.mjcf_switches import Switches
from ulna.typing import Floats

JOINT_TRANSMISSIONS = (0, 1)
"""mjTRN_JOINT and mjTRN_JOINTINPARENT of mjtTrn."""

TENDON_TRANSMISSION = 3
"""mjTRN_TENDON."""

MEMORYLESS = (0, 2, 3)
"""mjDYN_NONE, mjDYN_FILTER and mjDYN_FILTEREXACT of mjtDyn: what comes out stays in the range of what goes in."""

Range = tuple[float, float]


class Drives:
    """The actuators of one file.

    Args:
        compiled: The compiled `mujoco.MjModel`.
        switches: What the file switches off.
    """

    def __init__(self, compiled: Any, switches: Switches) -> None:
        self._m, self._switches = compiled, switches

    @property
    def count(self) -> int:
        """Number of actuators; MuJoCo's nu counts controls, of which an actuator may have several."""
        return len(self._m.actuator_trntype)

    def joint_of(self, a: int) -> int:
        """Index of the joint on which an actuator acts; -1 where it acts on something else."""
        m = self._m
        return int(m.actuator_trnid[a, 0]) if m.actuator_trntype[a] in JOINT_TRANSMISSIONS else -1

    def exerts_force(self, a: int) -> bool:
        """Whether neither a flag nor its group switches an actuator off."""
        group = int(self._m.actuator_group[a])
        off = 0 <= group < 31 and self._switches.actuator_groups_off >> group & 1
        return self._switches.actuation and not off

    def armature(self, j: int) -> Floats:
        """Inertia of the drives of a joint, one number for each of its rates [kg, kg m^2]."""
        return self._m.dof_armature[self._rates(j)] + self._reflected(j, "actuator_armature")

    def damping(self, j: int) -> Floats:
        """Viscous friction of a joint, one number for each of its rates [N s/m, N m s/rad]."""
        if not self._switches.dampers:
            return np.zeros_like(self._m.dof_damping[self._rates(j)])
        return self._m.dof_damping[self._rates(j)] + self._reflected(j, "actuator_damping")

    def friction(self, j: int) -> Floats:
        """Coulomb friction of a joint, one number for each of its rates [N, N m]."""
        return self._m.dof_frictionloss[self._rates(j)] * float(self._switches.frictionloss)

    def force_range(self, j: int) -> Range:
        """Least and largest force that all actuators together exert on a hinge or slide [N, N m]."""
        m = self._m
        ranges = [
            _scaled(self.actuator_range(a), self._gear(a))
            for a in range(self.count)
            if self.joint_of(a) == j and self.exerts_force(a)
        ]
        low, high = (sum(ends) for ends in zip(*ranges, strict=True)) if ranges else (-np.inf, np.inf)
        if m.jnt_actfrclimited[j]:
            low, high = (float(np.clip(x, *m.jnt_actfrcrange[j])) for x in (low, high))
        return float(low), float(high)

    def actuator_range(self, a: int) -> Range:
        """Least and largest force of an actuator before its gear [N, N m]; infinite where nothing bounds it."""
        m = self._m
        low, high = self._from_controls(a)
        if m.actuator_forcelimited[a]:
            low, high = (float(np.clip(x, *m.actuator_forcerange[a])) for x in (low, high))
        return low, high

    def is_bounded(self, a: int) -> bool:
        """Whether something bounds the force of an actuator: its own ranges, or that of its tendon."""
        m = self._m
        on_tendon = m.actuator_trntype[a] == TENDON_TRANSMISSION
        limited = on_tendon and bool(m.tendon_actfrclimited[int(m.actuator_trnid[a, 0])])
        return limited or bool(np.isfinite(self.actuator_range(a)).any())

    def scalar_joint(self, j: int) -> bool:
        """Whether a joint is a hinge or slide."""
        return self._m.jnt_type[j] in (HINGE, SLIDE)

    def _from_controls(self, a: int) -> Range:
        """The range of a motor, whose force is its gain times its control; infinite for servos and muscles."""
        m = self._m
        motor = m.actuator_gaintype[a] == 0 and m.actuator_biastype[a] == 0
        control = int(m.actuator_ctrladr[a]) if hasattr(m, "actuator_ctrladr") else a
        if (
            not motor
            or m.actuator_dyntype[a] not in MEMORYLESS
            or not m.actuator_ctrllimited[control]
            or not self._switches.clamped_controls
            or m.actuator_plugin[a] >= 0
        ):
            return -np.inf, np.inf
        low, high = (float(x) for x in m.actuator_ctrlrange[control])
        return _scaled((low, high), float(m.actuator_gainprm[a, 0]))

    def _reflected(self, j: int, name: str) -> float:
        """A number of the actuators of a joint, seen through their gears; MuJoCo before version 4 has none."""
        numbers = getattr(self._m, name, None)
        if numbers is None:
            return 0.0
        return sum(float(numbers[a]) * self._gear(a) ** 2 for a in range(self.count) if self.joint_of(a) == j)

    def _gear(self, a: int) -> float:
        m = self._m
        first = int(m.actuator_outadr[a]) if hasattr(m, "actuator_outadr") else a
        return float(m.actuator_gear[first, 0])

    def _rates(self, j: int) -> slice:
        m = self._m
        start = int(m.jnt_dofadr[j])
        return slice(start, start + (6, 3, 1, 1)[int(m.jnt_type[j])])


def _scaled(bounds: Range, factor: float) -> Range:
    """The range times a number; zero times infinity is zero."""
    low, high = (0.0 if factor == 0.0 else x * factor for x in bounds)
    return min(low, high), max(low, high)
