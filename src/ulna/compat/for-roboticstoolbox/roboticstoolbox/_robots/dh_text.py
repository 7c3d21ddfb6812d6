"""DH robots as text and as twists: the toolbox's tables of parameters, and the axes of the joints."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from roboticstoolbox._common.poses import _spatialmath, pose
from roboticstoolbox._common.symbols import has_symbols, is_symbol, with_symbols
from roboticstoolbox._common.text_table import grid
from roboticstoolbox._ets.joint_descriptor import shown_offset
from roboticstoolbox._mixins.robot_mixin import RobotMixin
from ulna.spatial import matrix_to_euler


class DHText(RobotMixin):
    """The text of a DH robot."""

    def __str__(self) -> str:
        kind = "modified" if self.mdh else "standard"
        head = f"{self._headline()}, {kind} DH parameters"
        return f"{head}\n{self._parameters()}{self._base_and_tool_text()}{self.configurations_str()}"

    def dhunique(self) -> None:
        """Prints the parameters that are not zero, as a table."""
        rows = []
        for j, link in enumerate(self._links):
            dh: Any = link
            length = ("θ", dh.theta) if link.isprismatic else ("d", dh.d)
            for letter, value in (length, ("a", dh.a), ("⍺", dh.alpha)):
                if value:
                    rows.append([f"{letter}{j}", with_symbols(".4g", value)])
        print(grid(["param", "value"], rows, [True, False]))

    def twists(self, q: Any = None) -> tuple[Any, Any]:
        """The axes of the joints in the world as twists (spatialmath's Twist3), and the pose of the end."""
        sm = _spatialmath()
        poses = self.fkine_all(np.zeros(self.n) if q is None else q).A
        base = np.eye(4) if self._base is None else self._base
        axes = poses[1:] if self.mdh else [base, *poses[1:-1]]
        out = sm.Twist3.Empty()
        for T, turns in zip(axes, self.revolutejoints, strict=True):
            z = T[:3, 2]
            out.append(sm.Twist3.UnitRevolute(z, T[:3, 3]) if turns else sm.Twist3.UnitPrismatic(z))
        return out, pose(poses[-1])

    def _parameters(self) -> str:
        limited = any(link.qlim is not None for link in self._links)
        limits = self.qlim if limited else None
        rows = []
        for j, link in enumerate(self._links):
            dh: Any = link
            number = str if self.mdh else _short
            q, slides = f"{'-' if dh.isflip else ' '}q{j + 1}", dh.sigma
            if is_symbol(dh.offset):
                q += shown_offset(dh.offset, not slides)
            elif dh.offset:
                shift = abs(dh.offset)
                q += f" {'-' if dh.offset < 0 else '+'} {shift if slides else f'{math.degrees(shift):.3g}°'}"
            moving = [_angle(dh.theta), q] if slides else [q, number(dh.d)]
            beside = [number(dh.a), _angle(dh.alpha)]
            row = [*beside, *moving] if self.mdh else [*moving, *beside]
            if limits is not None:
                row += [_short(float(x)) if slides else f"{math.degrees(x):.1f}°" for x in limits[:, j]]
            rows.append(row)
        header = ["aⱼ₋₁", "⍺ⱼ₋₁", "θⱼ", "dⱼ"] if self.mdh else ["θⱼ", "dⱼ", "aⱼ", "⍺ⱼ"]
        header += ["q⁻", "q⁺"] if limited else []
        return grid(header, rows, [bool(self.mdh)] + [True] * (len(header) - 1))

    def _base_and_tool_text(self) -> str:
        rows = []
        for name, T in (("base", self._base), ("tool", self._tool)):
            if T is not None:
                xyz = ", ".join(with_symbols(".2g", x) for x in T[:3, 3])
                rows.append([name, f"t = {xyz}; {_rotation_text(T[:3, :3])}"])
        return "\n" + grid([], rows, [True, False]) if rows else ""


def _rotation_text(R: Any) -> str:
    if has_symbols(R):
        return f"R = {R.tolist()}"
    angles = matrix_to_euler(R.astype(float), "xyz")[::-1]
    return f"rpy/xyz = {', '.join(f'{math.degrees(x) + 0.0:.2g}°' for x in angles)}"


def _short(x: float) -> str:
    return f"{x:.4g}" if isinstance(x, float) else str(x)


def _angle(x: Any) -> str:
    return str(x) if is_symbol(x) else f"{x * (180.0 / math.pi)}°"
