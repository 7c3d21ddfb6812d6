"""One thing that looks wrong with a robot description."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Literal

Severity = Literal["error", "warning", "note"]

SEVERITIES: tuple[Severity, ...] = ("error", "warning", "note")
"""From what cannot be right, over what is probably wrong, to what is worth knowing."""


@dataclass(frozen=True)
class Finding:
    """One thing that looks wrong.

    Attributes:
        severity: "error": no robot can be so, or part of it is missing; "warning": probably a mistake; "note": it is
            allowed, and has consequences that are easily overlooked.
        kind: Short name of the check, the same for all findings of a kind, such as "triangle-inequality".
        subject: What it is about, such as "link 'hand'".
        message: What was found, with numbers and units.
        advice: What to do about it.
        line: Line of the file, where known.
    """

    severity: Severity
    kind: str
    subject: str
    message: str
    advice: str
    line: int | None = None


def grouped(findings: Iterable[Finding]) -> Iterator[tuple[Finding, ...]]:
    """Findings of one kind, severity and advice together; errors first, else in order."""
    groups: dict[tuple[str, str, str], list[Finding]] = {}
    for finding in findings:
        groups.setdefault((finding.severity, finding.kind, finding.advice), []).append(finding)
    for severity in SEVERITIES:
        for key, group in groups.items():
            if key[0] == severity:
                yield tuple(group)
