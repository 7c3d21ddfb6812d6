"""Content of model files that a model cannot represent: collected by the readers, one warning for each file."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass

from ulna.errors import ModelWarning
from ulna.formats.node import short
from ulna.system.callers import level_of_caller

SHOWN = 3
"""So many places of one kind are named; the others are counted."""


@dataclass(frozen=True)
class Omission:
    """One kind of element of a file that has an effect elsewhere and none here.

    Attributes:
        element: the element, with the attribute that matters, as the file writes it: `<joint stiffness>`.
        effect: what Ulna's results lack.
        advice: what to do about it.
        places: where it stands: "joint 'hinge' (line 5)".
    """

    element: str
    effect: str
    advice: str
    places: tuple[str, ...] = ()

    def __str__(self) -> str:
        shown = ", ".join(self.places[:SHOWN])
        more = len(self.places) - SHOWN
        where = f" of {shown}" if shown else ""
        others = f" and {more} more" if more > 0 else ""
        return f"{self.element}{where}{others}: {self.effect} {self.advice}"


def place(kind: str, name: str, line: int | None) -> str:
    """Where an omission stands, for its `places`.

    Args:
        kind: The kind of the element.
        name: Its name; empty for none.
        line: Its line in the file; None or 0 where that is unknown.

    Returns:
        The text.
    """
    named = f"{kind} {short(name)!r}" if name else kind
    return f"{named} (line {line})" if line else named


def warn_of_omissions(omissions: Sequence[Omission], file: str | None) -> None:
    """Warn (ModelWarning) once about everything in a file that a model cannot hold.

    Args:
        omissions: What is left out.
        file: The file, for the message; None for text.
    """
    if omissions:
        rows = "".join(f"\n- {omission}" for omission in omissions)
        warnings.warn(
            f"{file or '<string>'}: parts of this file are left out of the model, or are in it only in part:{rows}",
            ModelWarning,
            stacklevel=level_of_caller(),
        )
