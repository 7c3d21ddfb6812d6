"""A model as a text table: what moves how, between which limits, and what it weighs."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, Protocol

from ulna.model.joints import Coordinate
from ulna.model.parts import Frame, Joint, Link
from ulna.typing import Floats


class _Model(Protocol):
    """What the table shows of a `ulna.model.Model`, whose module imports this one."""

    @property
    def name(self) -> str: ...
    @property
    def joints(self) -> tuple[Joint, ...]: ...
    @property
    def links(self) -> tuple[Link, ...]: ...
    @property
    def frames(self) -> tuple[Frame, ...]: ...
    @property
    def configurations(self) -> Mapping[str, Floats]: ...
    @property
    def tool(self) -> str: ...
    @property
    def joint_names(self) -> Any: ...
    @property
    def nq(self) -> Any: ...
    @property
    def nv(self) -> Any: ...
    @property
    def mass(self) -> Any: ...
    def joint_index(self, name: str) -> int: ...
    def frame_name(self, frame: Frame) -> str: ...


def table(model: _Model) -> str:
    """The table: one row for each link and each further frame; the tool is marked with ``@``."""
    lines = [_headline(model), _grid(_HEADER, _rows(model), right={0, 7})]
    if model.configurations and model.nq:
        rows = [
            [joint.name, *(_position(joint, joint.q_of(q).tolist()) for q in model.configurations.values())]
            for joint in model.joints
            if joint.mimic is None
        ]
        names = list(model.configurations)
        lines.append(_grid(["configuration", *names], rows, right=set(range(1, len(names) + 1))))
    return "\n".join(lines)


_HEADER = ["#", "joint", "motion", "parent", "link", "limits", "speed, effort", "mass kg"]


def _headline(model: _Model) -> str:
    letters = "".join(joint.kind.symbol for joint in model.joints)
    mimics = sum(joint.mimic is not None for joint in model.joints)
    parts = [
        f"{_count(len(model.joints), 'joint')}" + (f" ({letters})" if 0 < len(letters) <= 40 else ""),
        *([_count(mimics, "mimic joint")] if mimics else []),
        f"nq {model.nq}",
        f"nv {model.nv}",
        _count(len(model.links), "link"),
        f"{model.mass:.4g} kg",
        f"tool @{model.tool}",
    ]
    return f"{model.name}: " + ", ".join(parts)


def _count(n: int, what: str) -> str:
    return f"{n} {what}" + ("" if n == 1 else "s")


def _rows(model: _Model) -> list[list[str]]:
    rows = []
    for link in model.links:
        mass = f"{link.inertia.mass:.4g}" if link.inertia.mass else ""
        mark = "@" if model.tool == link.name else ""
        joint_mark = "@" if model.tool == link.parent_joint and not mark else ""
        head = [f"{joint_mark}{link.parent_joint or ''}"]
        tail = [link.parent or "(world)", mark + link.name]
        if link.parent_joint in model.joint_names:
            index = model.joint_index(str(link.parent_joint))
            joint = model.joints[index]
            rows.append(
                [str(index), *head, joint.kind.describe(), *tail, _limits(model, joint), _rates(joint), mass]
            )
        else:
            rows.append(["", *head, "fixed" if link.parent_joint else "", *tail, "", "", mass])
    for frame in model.frames:
        if frame.kind in ("user", "tool"):
            mark = "@" if model.frame_name(frame) == model.tool else ""
            rows.append(["", "", f"{frame.kind} frame", frame.link, mark + frame.name, "", "", ""])
    return rows


def _limits(model: _Model, joint: Joint) -> str:
    if joint.mimic is not None:
        m = joint.mimic
        factor = "" if m.multiplier == 1.0 else "-" if m.multiplier == -1.0 else f"{m.multiplier:g} "
        shift = f" {'+' if m.offset > 0 else '-'} {abs(m.offset):g}" if m.offset else ""
        return f"= {factor}{model.joints[m.source].name}{shift}"
    parts = []
    for c, low, high in zip(joint.kind.coordinates, joint.limits.lower, joint.limits.upper, strict=True):
        if math.isfinite(low) or math.isfinite(high):
            parts.append(f"{c.name} {_interval(c, low, high)}".strip())
    return "; ".join(parts) or "none"


def _interval(c: Coordinate, low: float, high: float) -> str:
    degrees = f" ({_span(_degrees(low), _degrees(high), '°')})" if c.unit == "rad" else ""
    return _span(f"{low:.4g}", f"{high:.4g}", f" {c.unit}" if c.unit else "") + degrees


def _span(low: str, high: str, unit: str) -> str:
    if low == f"-{high}":
        return f"±{high}{unit}"
    return f"{low} .. {high}{unit}"


def _degrees(x: float) -> str:
    """An angle [rad] in degrees, to a tenth, without a sign on zero."""
    return f"{round(math.degrees(x), 1) + 0.0:.6g}"


def _rates(joint: Joint) -> str:
    parts = []
    for c, speed, effort in zip(joint.kind.rates, joint.limits.velocity, joint.limits.effort, strict=True):
        if math.isfinite(speed):
            parts.append(f"{speed:.4g} {c.unit}/s")
        if math.isfinite(effort):
            parts.append(f"{effort:.4g} {'N m' if c.unit == 'rad' else 'N'}")
    return ", ".join(dict.fromkeys(parts))


def _position(joint: Joint, q: Sequence[float]) -> str:
    return " ".join(
        f"{_degrees(x)}°" if c.unit == "rad" else f"{x:.4g}" + (f" {c.unit}" if c.unit else "")
        for c, x in zip(joint.kind.coordinates, q, strict=True)
    )


def _grid(header: Sequence[str], rows: Sequence[Sequence[str]], right: set[int]) -> str:
    """Rows under a header in light box-drawing characters; columns in which nothing stands are left out."""
    columns = [i for i in range(len(header)) if any(row[i] for row in rows)]
    widths = {i: max(len(row[i]) for row in [header, *rows]) for i in columns}

    def line(left: str, middle: str, end: str) -> str:
        return left + middle.join("─" * (widths[i] + 2) for i in columns) + end

    def text(row: Sequence[str]) -> str:
        cells = (row[i].rjust(widths[i]) if i in right else row[i].ljust(widths[i]) for i in columns)
        return "│ " + " │ ".join(cells) + " │"

    return "\n".join(
        [
            line("┌", "┬", "┐"),
            text(header),
            line("├", "┼", "┤"),
            *(text(row) for row in rows),
            line("└", "┴", "┘"),
        ]
    )
