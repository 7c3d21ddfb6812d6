"""Docstrings of methods: descriptions of the arguments that have the same name in every method."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from typing import NamedTuple

Size = str | tuple[int | str, ...]


class Argument(NamedTuple):
    """An array that algorithms take.

    Attributes:
        size: Its shape without batch axes: "nq" or "nv" for one axis, else a tuple of these and of numbers.
        unit: The units of its entries.
        text: What it is.
    """

    size: Size
    unit: str
    text: str


ARRAYS: dict[str, Argument] = {
    "q": Argument("nq", "rad or m", "Configuration"),
    "v": Argument("nv", "rad/s or m/s", "Velocity"),
    "a": Argument("nv", "rad/s^2 or m/s^2", "Acceleration"),
    "tau": Argument("nv", "N m or N", "Joint torques"),
    "q0": Argument("nq", "rad or m", "Configuration at the start"),
    "q1": Argument("nq", "rad or m", "Configuration at the end"),
    "t": Argument((), "1", "Where between the two, from 0 to 1"),
    "wrench": Argument((6,), "N, N m", "Force, then moment"),
    "limit": Argument("nv", "N m or N", "Greatest torques in both directions"),
}
"""The arrays of kernels, by the names of arguments."""

OF_CALLS = {"out", "threads"}
"""Arguments of methods that are no options: they are passed on to the kernel."""

_OPTIONS = {
    "frame": "Name of a frame; None for the tool.",
    "reference": 'Of the twist: "local_world_aligned" (the frame\'s origin, axes of the world), "local" or "world".',
    "representation": 'Angles, instead of a twist: "rpy/xyz", "rpy/zyx", "eul" or "exp".',
    "damping": "d [kg^-1/2]: d^2 I is added to J M^-1 J^T, which bounds the inertia near singular configurations.",
    "subtree": "Name of a joint, for what it moves; None for all that moves.",
    "axes": 'Which rows of the Jacobian count: "all", "trans", "rot", or six truth values.',
    "forces": "External forces: frame name -> wrench (..., 6) [N, N m].",
    "friction": "True for the model's damping and Coulomb friction, or an `ulna.algorithms.Friction`.",
    "constraints": "Contacts and loops of `ulna.model`: a list, or one.",
    "solver": "The method that computes the forces.",
    "out": "Array to write into, of the result's shape (...).",
    "threads": "How many threads a large batch may use.",
}
"""What options mean, by the names of arguments."""

_REFUSED = "ShapeError, DtypeError, NonFiniteError: If an array has another shape or type, or is not finite."
_NAMED = {"forces": "frame", "frame": "frame", "subtree": "joint"} | {
    n: n for n in ("reference", "representation")
}
"""What the names given by options are names of, for the error if there is none."""
_NO_INERTIA = "ModelError: If joints can move without moving inertia; names them."


def documented(
    text: str | None,
    parameters: tuple[str, ...],
    result: str,
    returns: str,
    inverts_mass: bool,
    about: Mapping[str, str],
) -> str | None:
    """A docstring completed with arguments, result, errors and source, unless it has a section of arguments already.

    Args:
        text: The quantity's own docstring; its source is in brackets at the end.
        parameters: The names of the method's arguments.
        result: Shapes and units of the results: "(nv, nv) [kg m^2]".
        returns: What they are; empty where the text says it.
        inverts_mass: Whether the inverse of the mass matrix is needed.
        about: Texts of arguments, used instead of those of `ARRAYS` and of the options.

    Returns:
        The docstring; None where there is none.
    """
    if text is None:
        return None
    head, example, tail = inspect.cleandoc(text).partition("\n\nExample:\n")
    if "\nArgs:\n" in head:
        return text
    head, source = cited(head)
    lines = [head, "", "Args:", *(f"    {name}: {about.get(name) or _about(name)}" for name in parameters)]
    lines += ["", "Returns:", f"    {with_batch(result)}{f': {returns}' if returns else ''}."]
    lines += ["", "Raises:", f"    {_REFUSED}"]
    names = [_NAMED[name] for name in parameters if name in _NAMED]
    if names:
        lines.append(
            f"    UnknownName: If there is no such {' or '.join(dict.fromkeys(names))}; names the nearest."
        )
    if inverts_mass:
        lines.append(f"    {_NO_INERTIA}")
    if source:
        lines += ["", f"Reference: {source}."]
    return "\n".join(lines) + example + tail


def cited(text: str) -> tuple[str, str]:
    """The text without the source in brackets at its end, and that source."""
    head, bracket, source = text.rstrip(".").rpartition("[")
    return (f"{head.rstrip()}.", source.rstrip("]")) if bracket and source.endswith("]") else (text, "")


def with_batch(result: str) -> str:
    """Shapes with leading batch axes: "(..., nv, nv) [kg m^2]"; shapes that are equal appear once, with "each"."""
    shapes, unit, rest = result.partition(" [")
    each = shapes.replace("(,)", "()").replace(",)", ")").replace("(", "(..., ").replace("(..., )", "(...)")
    single = list(dict.fromkeys(each.split("), ")))
    if each.count("(") > 1 and each.split("), ")[0] + ")" == each.split("), ")[-1]:
        each = f"{single[0].rstrip(')')}) each"
    return each + unit + rest


def _about(name: str) -> str:
    if name in ARRAYS:
        size, unit, text = ARRAYS[name]
        shape = f"({size},)" if isinstance(size, str) else str(size)
        return f"{text}, {with_batch(shape)} [{unit}]."
    return _OPTIONS[name]
