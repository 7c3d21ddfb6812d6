"""Transcripts: what each call returns or raises and what it changes in a scene, as text that a file holds."""

from __future__ import annotations

import os
import re
import warnings
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from ulna.errors import MissingExtra


def numbers(values: Any) -> str:
    """Numbers with six digits, and no -0."""
    array = np.ravel(np.asarray(values, dtype=float))
    return " ".join(f"{x:.6g}" for x in np.round(array, 9) + 0.0)


def words(value: Any) -> str:
    """A value in words: numbers shortened, objects by their type."""
    if isinstance(value, bool | str | None):
        return repr(value)
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key!r}: {words(entry)}" for key, entry in value.items()) + "}"
    if isinstance(value, tuple | list):
        return "[" + ", ".join(map(words, value)) + "]"
    try:
        return numbers(value)
    except (TypeError, ValueError):
        return type(value).__name__


def scene_state(scene: Any) -> dict[str, str]:
    """What a scene holds, a line for each node."""
    snapshot = scene.snapshot()
    out = {}
    for i, node in enumerate(snapshot.nodes):
        parts = [f"at {numbers(snapshot.poses[i][:3])}"]
        looks = [
            (snapshot.scales[i], 1.0, "scale"),
            (snapshot.opacity[i], 1.0, "opacity"),
            (snapshot.tint[i], -1.0, "tint"),
        ]
        parts += [f"{name} {numbers(value)}" for value, usual, name in looks if not np.all(value == usual)]
        parts += [] if snapshot.visible[i] else ["hidden"]
        parts += [] if node.shadow else ["no shadow"]
        parts += ["through"] if node.through else []
        parts += [_surface(surface) for surface in node.surfaces]
        if node.content is not None:
            parts.append(_content(node.content))
        out[node.name] = "; ".join(parts)
    return out


def _surface(surface: Any) -> str:
    if not len(surface.vertices):
        return f"no triangles {numbers(surface.rgba)}"
    box = [surface.vertices.min(axis=0), surface.vertices.max(axis=0)]
    return f"{len(surface.triangles)} triangles within {numbers(box)} colour {numbers(surface.rgba)}"


def _content(content: Any) -> str:
    fields = {name: value for name, value in vars(content).items() if name[0] != "_" and name != "surfaces"}
    return (
        type(content).__name__
        + " "
        + ", ".join(
            f"{name} {[_surface(s) for s in value] if name == 'original' else words(value)}"
            for name, value in fields.items()
        )
    )


def transcript(calls: Iterable[str], names: dict[str, Any], scene: Any) -> str:
    """The text of some calls.

    Args:
        calls: Expressions, each evaluated after the other.
        names: What they speak of.
        scene: The scene that they change.

    Returns:
        For each call a line with its result or its error, its warnings, then the nodes that are new, changed or gone.
    """
    lines, before = [], scene_state(scene)
    for call in calls:
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            result = _result(call, names)
        lines.append(f"{call}\n    = {result}")
        lines += [
            f"    ! {warning.category.__name__}: {_without_folders(str(warning.message))}" for warning in said
        ]
        after = scene_state(scene)
        lines += [f"    {name}: {state}" for name, state in after.items() if before.get(name) != state]
        lines += [f"    {name}: gone" for name in before if name not in after]
        before = after
    return "\n".join(lines) + "\n"


def _result(call: str, names: dict[str, Any]) -> str:
    try:
        return words(eval(call, {"np": np}, names))
    except MissingExtra:  # a package that the tests of this place do without
        raise
    except Exception as error:
        return f"{type(error).__name__}: {_without_folders(str(error))}"


def _without_folders(text: str) -> str:
    """A message without where this package lies."""
    return re.sub(r"(?<=['\" ])/(?:[\w.-]+/)+", "", text)


def compare(file: Path, text: str) -> None:
    """Compares a transcript with its file; with UPDATE_TRANSCRIPTS=1 in the environment it is written instead."""
    if os.environ.get("UPDATE_TRANSCRIPTS"):
        file.write_text(text, encoding="utf-8", newline="\n")
    assert file.exists(), f"{file.name} does not exist; make it with UPDATE_TRANSCRIPTS=1"
    assert text == file.read_text(encoding="utf-8"), (
        f"{file.name} differs; if that is meant: UPDATE_TRANSCRIPTS=1"
    )
