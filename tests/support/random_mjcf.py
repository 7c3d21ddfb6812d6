"""Random MJCF documents made from the parts of its schema that Ulna honours: trees, joints, shapes, drives, couplings, flags."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np

from ulna.typing import Floats

FLAGS = [
    "gravity",
    "constraint",
    "equality",
    "frictionloss",
    "limit",
    "contact",
    "spring",
    "damper",
    "clampctrl",
    "actuation",
    "warmstart",
]
COMPILER = (
    'fusestatic="true"',
    'eulerseq="zyx"',
    'inertiafromgeom="true"',
    'boundmass="1"',
    'boundinertia=".3"',
    'balanceinertia="true"',
    'discardvisual="true"',
    'alignfree="true"',
)
CLASS, INACTIVE = 'class="c"', 'active="false"'
DEFAULTS = '<default class="c"><joint armature=".4" damping=".1"/><geom group="1" condim="4"/></default>'


class RandomMjcf:
    """One random document; `text` is the whole of it."""

    def __init__(self, seed: int) -> None:
        self._rng = np.random.default_rng(seed)
        self._degrees = self._chance(0.5)
        self._count = 0
        self._scalars: list[str] = []
        world = "".join(self._body(0) for _ in range(self._rng.integers(1, 3)))
        world += self._maybe(0.5, '<geom type="plane" size="0 0 1"/>')
        angle = "degree" if self._degrees else "radian"
        compiler = " ".join(self._maybe(0.15, option) for option in COMPILER)
        flags = " ".join(self._maybe(0.06, f'{flag}="disable"') for flag in FLAGS)
        general = self._maybe(0.3, '<joint damping=".7"/>') + self._maybe(0.3, '<geom density="300"/>')
        self.text = (
            f'<mujoco><compiler angle="{angle}" {compiler}/><option gravity="{self._vector()}"><flag {flags}/></option>'
            f"<default>{general}{DEFAULTS}</default><worldbody>{world}</worldbody>"
            f"<equality>{self._couplings()}</equality><actuator>{self._actuators()}</actuator>"
            f"<contact>{self._exclusions()}</contact></mujoco>"
        )

    def _body(self, depth: int) -> str:
        number, self._count = self._count, self._count + 1
        inside = self._joints(number, depth) + "".join(self._geom() for _ in range(self._rng.integers(1, 3)))
        heavy = f'<inertial mass="{self._number(0.1, 3)}" pos="{self._vector()}" {self._turn()} diaginertia=".1 .12 .15"/>'
        inside += self._maybe(0.3, heavy)
        inside += self._maybe(0.5, f'<site name="s{number}" pos="{self._vector()}" {self._turn()}/>')
        below = int(self._pick((0, 1, 1, 2))) if depth < 4 and self._count < 9 else 0
        for _ in range(below):
            child = self._body(depth + 1)
            in_frame = f'<frame pos="{self._vector()}" {self._turn()} {self._childclass()}>{child}</frame>'
            inside += in_frame if self._chance(0.2) else child
        return f'<body name="b{number}" pos="{self._vector()}" {self._turn()} {self._childclass()}>{inside}</body>'

    def _joints(self, body: int, depth: int) -> str:
        if depth == 0 and self._chance(0.3):
            return self._pick(
                ("<freejoint/>", '<joint type="free" damping=".2"/>', '<freejoint align="true"/>')
            )
        found = ""
        for k in range(int(self._pick((0, 1, 1, 1, 2, 3)))):
            kind = self._pick(("hinge", "hinge", "slide", "slide", "ball"))
            found += self._joint(f"j{body}_{k}", kind)
            if kind == "ball":
                break
        return found

    def _joint(self, name: str, kind: str) -> str:
        numbers = [f'{x}="{self._number(0, 2)}"' for x in ("damping", "armature", "frictionloss")]
        parts = [self._maybe(0.4, part) for part in (*numbers, f'pos="{self._vector()}"')]
        if kind != "ball":
            self._scalars.append(name)
            turned = kind == "hinge"
            limits = f'range="{self._angle(-2, -0.2, turned)} {self._angle(0.2, 2, turned)}"'
            parts += [self._maybe(0.5, limits), self._maybe(0.5, f'axis="{self._vector()}"')]
            parts += [
                self._maybe(0.4, f'ref="{self._angle(-1, 1, turned)}"'),
                self._maybe(0.3, 'actuatorfrcrange="-3 3"'),
            ]
        return f'<joint name="{name}" type="{kind}" {" ".join(parts)} {self._maybe(0.2, CLASS)}/>'

    def _geom(self) -> str:
        kind = self._pick(("sphere", "capsule", "ellipsoid", "cylinder", "box"))
        size = " ".join(self._number(0.05, 0.4) for _ in range(3))
        at = f'pos="{self._vector()}"'
        placed = f'size="{size}" {self._turn()} {self._maybe(0.7, at)}'
        if kind in ("capsule", "cylinder") and self._chance(0.4):
            placed = f'size="{self._number(0.05, 0.4)}" fromto="{self._vector()} {self._vector()}"'
        weight = self._pick(("", f'mass="{self._number(0.1, 3)}"', f'density="{self._number(10, 3000)}"'))
        mask = f'contype="{self._rng.integers(0, 4)}" conaffinity="{self._rng.integers(0, 4)}"'
        rest = (self._maybe(0.2, 'shellinertia="true"'), self._maybe(0.15, mask), self._maybe(0.2, CLASS))
        group = self._maybe(0.3, f'group="{self._rng.integers(0, 5)}"')
        return f'<geom type="{kind}" {placed} {weight} {group} {" ".join(rest)}/>'

    def _couplings(self) -> str:
        order = [str(name) for name in self._rng.permutation(self._scalars)]
        return "".join(
            f'<joint joint1="{one}" joint2="{two}" polycoef="{self._number(-1, 1)} {self._number(0.3, 2)} 0 0 0" '
            f"{self._maybe(0.1, INACTIVE)}/>"
            for one, two in itertools.pairwise(order)
            if self._chance(0.25)
        )

    def _actuators(self) -> str:
        found = ""
        for joint in self._scalars:
            kind = self._pick(("motor", "general", "position", "velocity"))
            parts = [f'{x}="{self._number(0, 1)}"' for x in ("armature", "damping")] + ['forcerange="-3 3"']
            parts += ['ctrlrange="-2 2"'] if kind in ("motor", "general") else []
            some = " ".join(self._maybe(0.4, part) for part in parts)
            found += self._maybe(0.4, f'<{kind} joint="{joint}" gear="{self._number(0.5, 3)}" {some}/>')
        return found

    def _exclusions(self) -> str:
        times = int(self._rng.integers(0, 3)) if self._count > 1 else 0
        pairs = [self._rng.choice(self._count, 2, replace=False) for _ in range(times)]
        return "".join(f'<exclude body1="b{a}" body2="b{b}"/>' for a, b in pairs)

    def _turn(self) -> str:
        three = " ".join(self._angle(-3, 3) for _ in range(3))
        kinds = (
            "",
            f'quat="{self._vector()} {self._number(0.1, 1)}"',
            f'euler="{three}"',
            f'axisangle="{self._vector()} {self._angle(-3, 3)}"',
            f'zaxis="{self._vector()}"',
            f'xyaxes="{self._vector()} {self._vector()}"',
        )
        return self._pick(kinds)

    def _childclass(self) -> str:
        return self._maybe(0.15, 'childclass="c"')

    def _angle(self, low: float, high: float, turned: bool = True) -> str:
        factor = 57.0 if turned and self._degrees else 1.0
        return self._number(low * factor, high * factor)

    def _number(self, low: float, high: float) -> str:
        return f"{self._rng.uniform(low, high):.4f}"

    def _vector(self) -> str:
        values: Floats = self._rng.normal(size=3)
        return " ".join(f"{x:.4f}" for x in values)

    def _chance(self, p: float) -> bool:
        return bool(self._rng.random() < p)

    def _maybe(self, p: float, text: str) -> str:
        return text if self._chance(p) else ""

    def _pick(self, choices: Sequence[object]) -> str:
        return str(choices[int(self._rng.integers(len(choices)))])
