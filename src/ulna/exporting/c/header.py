"""The public header: each function with its frame, reference, shapes, units and order in memory."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

from ulna.compiler.codegen.ir_text import DType
from ulna.exporting.c.expressions import argument_names
from ulna.exporting.c.source import parameters, prototype
from ulna.exporting.record import Argument, Export, ExportedFunction
from ulna.model import Model

_REFERENCES = {
    "local_world_aligned": "origin of the frame, axes of the world",
    "local": "origin and axes of the frame",
    "world": "origin and axes of the world",
}


def real_of(export: Export) -> DType:
    """The C type that numbers have."""
    return "float" if export.dtype.name == "float32" else "double"


def plain(text: str) -> str:
    """Text as it may stand in a comment: ASCII, without the beginning or end of one."""
    return text.replace("*/", "* /").replace("/*", "/ *").encode("ascii", "replace").decode()


def comment(paragraphs: Sequence[str]) -> str:
    """A comment; lines that begin with a blank stay as they are.

    Args:
        paragraphs: Its paragraphs.

    Returns:
        The text.
    """
    lines: list[str] = []
    for paragraph in paragraphs:
        text = plain(paragraph)
        lines += [text] if text.startswith(" ") else textwrap.wrap(text, 106) or [""]
    if len(lines) == 1:
        return f"/* {lines[0]} */"
    return "\n".join([f"/* {lines[0]}", *(f" * {line}".rstrip() for line in lines[1:]), " */"])


def declaration(export: Export, function: ExportedFunction) -> str:
    """The comment and the declaration of a function.

    Args:
        export: The export.
        function: The function.

    Returns:
        The text.
    """
    inputs, outputs = parameters(function.inputs, function.outputs, real_of(export))
    head = prototype(f"void {export.name}_{function.name}", [*inputs, *outputs])
    return f"{described(function)}\n{head};\n"


def described(function: ExportedFunction) -> str:
    """The comment in front of a function's declaration."""
    text = [function.summary or f"The function {function.name}."]
    choices = dict(function.choices)
    if "frame" in choices:
        frame = choices.pop("frame")
        text.append(f"Frames, in this order: {frame}." if ", " in frame else f"Frame: {frame}.")
    if "reference" in choices:
        reference = choices.pop("reference")
        text.append(f"Reference: {reference} ({_REFERENCES[reference]}).")
    source = choices.pop("source", "")
    text += [f"{key.capitalize()}: {value}." for key, value in choices.items()]
    text += [f"Source: {source}."] if source else []
    names = argument_names(p.name for p in (*function.inputs, *function.outputs))
    arguments = (*function.inputs, *function.outputs)
    width = max(map(len, names), default=0)
    for k, (name, argument) in enumerate(zip(names, arguments, strict=True)):
        text.append(f"  {name:<{width}}  {'in ' if k < len(function.inputs) else 'out'}  {_about(argument)}")
    return comment(text)


def _about(argument: Argument) -> str:
    shape = str(argument.shape).replace(",)", ")") if argument.shape else "a number"
    unit = f" [{argument.unit}]" if argument.unit else ""
    order = ", row after row" if len(argument.shape) > 1 else ""
    text = f": {argument.text[0].lower()}{argument.text[1:]}" if argument.text else ""
    return f"{shape}{unit}{order}{text}"


def coordinates(model: Model) -> list[str]:
    """Which joint each number of q and v belongs to, as lines of a table."""
    lines = ["Coordinates (joint: q, v):"]
    moving = [joint for joint in model.joints if joint.nq and joint.mimic is None]
    width = max((len(j.name) for j in moving), default=0)

    def places(letter: str, first: int, count: int) -> str:
        return f"{letter}[{first}]" if count == 1 else f"{letter}[{first}] to {letter}[{first + count - 1}]"

    for joint in moving:
        q, v = places("q", joint.idx_q, joint.nq), places("v", joint.idx_v, joint.nv)
        lines.append(f"  {joint.name:<{width}}  {q}, {v}")
    return lines


def header(export: Export, searches: Sequence[str], constants: str = "") -> str:
    """The text of the header.

    Args:
        export: The export.
        searches: Declarations of the searches, with their types.
        constants: Declarations of constants of the robot; empty for none.

    Returns:
        The text.
    """
    guard = f"{export.name.upper()}_H"
    subject = f"The robot {export.model.name}" if export.model is not None else f"The functions {export.name}"
    summary_lines = [
        f"{subject}, in C99. Written by Ulna; do not edit.",
        "",
        "No function allocates memory, has static data that changes, or calls anything but the C library's "
        "mathematics: all may be called from any thread, and from interrupts. Outputs may be the same arrays as "
        "inputs. A nan or an infinity in an input passes on to the outputs.",
        "Arrays are C-contiguous, matrices row after row (T[4 * row + column]). SI units: m, rad, s, kg, N. Twists, "
        "wrenches and Jacobians have the linear part first. A pose (4, 4) maps coordinates of the frame to those of "
        "the world. Quaternions are x, y, z, w.",
    ]
    if export.model is not None:
        summary_lines += ["", *coordinates(export.model)]
    declared = [declaration(export, f) for f in export.functions]
    return "\n".join(
        [
            comment(summary_lines),
            f"#ifndef {guard}",
            f"#define {guard}",
            "",
            "#ifdef __cplusplus",
            'extern "C" {',
            "#endif",
            "",
            *([constants] if constants else []),
            *declared,
            *searches,
            "#ifdef __cplusplus",
            "}",
            "#endif",
            "",
            "#endif",
            "",
        ]
    )
