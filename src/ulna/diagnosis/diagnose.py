"""Everything that looks wrong with a robot, from its model or its file."""

from __future__ import annotations

import dataclasses
import os
import re
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ulna.diagnosis.bodies import body_findings
from ulna.diagnosis.finding import Finding, grouped
from ulna.diagnosis.joints import joint_findings
from ulna.diagnosis.shapes import Shapes
from ulna.errors import FormatError, ModelError
from ulna.formats.markup import read_file
from ulna.formats.urdf_document import UrdfDocument
from ulna.formats.urdf_parse import parse_urdf
from ulna.loading import load_model
from ulna.model import Model

_MAX_LISTED = 4
"""How many findings of one kind a report shows in full."""

_PLACE = re.compile(r"^(?P<file>.*?):(?P<line>\d+): ")


def diagnose(robot: Any, **options: Any) -> tuple[Finding, ...]:
    """What looks wrong with a robot: errors first, then warnings, then notes.

    Args:
        robot: A `Robot`, a `Model`, or what `ulna.load` takes: a name, or the path of a file.
        options: As for `ulna.load`, where `robot` is a name or a path.

    Returns:
        The findings. A file that cannot be loaded is one finding of severity "error"; files have lines.

    Raises:
        UnknownName: There is no robot of that name.
        MissingExtra: The robot needs a package that is not installed.

    Example:
        >>> [finding.kind for finding in ulna.diagnosis.diagnose("panda")]
        ['inertia-large', 'neutral-outside']
    """
    model = getattr(robot, "model", robot)
    findings: list[Finding] = []
    if not isinstance(model, Model):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            try:
                model = load_model(robot, **options)
            except ModelError as error:
                return (_not_loadable(error),)
        findings += [_warned(str(w.message)) for w in caught]
    shapes = Shapes(model)
    bodies = list(body_findings(model, shapes.points))
    impossible = {f.subject.removeprefix("link ") for f in bodies if f.severity == "error"}
    findings = [
        f for f in findings if not any(name in f.message and "kg m^2" in f.message for name in impossible)
    ]
    if any(
        "file of its" in f.message for f in shapes.findings
    ):  # these say which link needs it, and how to fix it
        findings = [
            f for f in findings if not (f.message.startswith("the mesh ") and "not found" in f.message)
        ]
    findings += [*shapes.findings, *joint_findings(model), *bodies]
    lines = _lines(model.source)
    placed = [f if f.line else dataclasses.replace(f, line=lines.get(f.subject)) for f in findings]
    return tuple(f for group in grouped(dict.fromkeys(placed)) for f in group)


def report(findings: Sequence[Finding]) -> str:
    """Findings as text, those of a kind together.

    Example:
        >>> from ulna.diagnosis import diagnose, report
        >>> print(report(diagnose("<robot name='a'><link name='only'/></robot>")))
        Nothing looks wrong.
    """
    if not findings:
        return "Nothing looks wrong."
    parts = []
    for group in grouped(findings):
        first = group[0]
        for finding in group[:_MAX_LISTED]:
            place = f"line {finding.line}: " if finding.line else ""
            subject = f"{finding.subject}: " if finding.subject else ""
            parts.append(f"{finding.severity}: {place}{subject}{finding.message}.")
        if len(group) > _MAX_LISTED:
            names = ", ".join(f.subject for f in group[_MAX_LISTED : _MAX_LISTED + 8])
            more = len(group) - _MAX_LISTED
            dots = ", ..." if more > 8 else ""
            parts.append(f"{first.severity}: likewise {more} more: {names}{dots}.")
        if first.advice:
            parts.append(f"    {first.advice}")
    counts = [(sum(f.severity == s for f in findings), s) for s in ("error", "warning", "note")]
    parts.append(", ".join(f"{n} {s}{'' if n == 1 else 's'}" for n, s in counts if n) + ".")
    return "\n".join(parts)


def _not_loadable(error: ModelError) -> Finding:
    line = error.line if isinstance(error, FormatError) else None
    return Finding("error", "refused", "", f"it cannot be loaded: {str(error).rstrip('.')}", "", line)


def _warned(text: str) -> Finding:
    place = _PLACE.match(text)
    message = text[place.end() :] if place else text
    return Finding("warning", "reader", "", message.rstrip("."), "", int(place["line"]) if place else None)


def _lines(source: str | None) -> dict[str, int | None]:
    """Lines of the links and joints of a URDF file; none of other files."""
    if source is None or not os.path.isfile(source) or Path(source).suffix.lower() != ".urdf":
        return {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            document: UrdfDocument = parse_urdf(read_file(source), source)
        except ModelError:
            return {}
    links: dict[str, int | None] = {f"link {link.name!r}": link.line for link in document.links}
    return links | {f"joint {joint.name!r}": joint.line for joint in document.joints}
