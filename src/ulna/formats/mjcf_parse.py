"""MJCF text or files -> the model of MuJoCo's own compiler, with our messages for its errors."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ulna.errors import FormatError, InputError
from ulna.formats.mjcf_child import compiled
from ulna.formats.mjcf_sources import check_sources
from ulna.spatial import SE3

FREE, BALL, SLIDE, HINGE = range(4)
"""mjtJoint."""


@dataclass(frozen=True)
class CompiledMjcf:
    """What MuJoCo's compiler makes of a file.

    Attributes:
        model: the `mujoco.MjModel`.
        mesh_folder: the folder of the meshes, as the file writes it, seen from the file.
        lines: for the kinds "body", "joint", "tendon", "equality" and "actuator" the lines of the file on which the
            elements start, by their index in the model; empty for files that include others.
        mesh_references: `refpos` and `refquat` (w, x, y, z) of the meshes that have them, by index.
    """

    model: Any
    mesh_folder: str
    lines: Mapping[str, Mapping[int, int]]
    mesh_references: Mapping[int, tuple[tuple[float, ...], tuple[float, ...]]]


def read_mjcf(source: str | os.PathLike[str], trusted: bool = False) -> CompiledMjcf:
    """What MuJoCo's compiler makes of a file or of text (from "<").

    MuJoCo reads the files that it includes, and its meshes, from disk.

    Args:
        source: a path, or text.
        trusted: whether MuJoCo compiles in this process and without limits. Otherwise another process does, which
            takes about half a second more, and is ended after a minute or when it needs more than 4 GiB.

    Returns:
        The compiled model, with its text and file.

    Raises:
        MissingExtra: the package mujoco is not installed.
        FormatError: the file is missing or broken, or passes a limit; says where and how to fix it.
    """
    text, file = text_or_file(source)
    written = check_sources(text, file)
    try:
        model, facts = compiled(text, file, trusted)
    except (FormatError, InputError):  # which are ValueErrors, too
        raise
    except ValueError as error:
        raise _refusal(error, file) from error
    has_parts = "<include" in written or "<attach" in written
    lines = {} if has_parts else facts.lines
    return CompiledMjcf(model, facts.mesh_folder, lines, facts.mesh_references)


def text_or_file(source: str | os.PathLike[str]) -> tuple[str, str | None]:
    """The text and no file, or no text and the file's name."""
    text = source.lstrip("\ufeff \t\r\n") if isinstance(source, str) else ""
    return (text, None) if text.startswith("<") else ("", os.fspath(source))


def _refusal(error: Exception, file: str | None) -> FormatError:
    """MuJoCo's message, in one line, with its line number where it has one."""
    words = " ".join(str(error).split())
    line = re.search(r"line (\d{1,9})", words)
    words = re.sub(r"Element name '', |,? ?(id \d+, )?line \d+", " ", words).strip(" ,.")
    fix = ""
    if "mjMINVAL" in words:
        fix = "Give the body a geom with mass, or an <inertial>."
    elif "opening file" in words or "not found" in words:
        fix = "Meshes are looked for in the compiler's `meshdir`, seen from the file."
    number = int(line[1]) if line and int(line[1]) > 0 else None
    return FormatError(f"MuJoCo refuses it: {words}.", file=file, line=number, fix=fix)


@dataclass(frozen=True)
class UnnamedParts:
    """How joints and sites without a name are called, by the name of their `body` and their `number` on it.

    Attributes:
        joint: The names of joints.
        free_joint: The names of free joints.
        site: The names of sites; where it is empty, they are left out.
    """

    joint: str = "{body}_joint"
    free_joint: str = "{body}_free"
    site: str = ""


def names_of(model: Any, unnamed: UnnamedParts = UnnamedParts()) -> tuple[list[str], list[str]]:
    """The names of links and of joints.

    Args:
        model: MuJoCo's model.
        unnamed: How joints without a name are called.

    Returns:
        The names of links, of which the world is the first, and of joints.
    """
    names = [model.body(b).name for b in range(1, model.nbody)]
    taken = {"world", *names}
    links = ["world", *(name or unused_name(f"body_{b}", taken) for b, name in enumerate(names, 1))]
    joints = [model.joint(j).name for j in range(model.njnt)]
    taken = set(joints)
    for j, name in enumerate(joints):
        if not name:
            body = int(model.jnt_bodyid[j])
            pattern = unnamed.free_joint if model.jnt_type[j] == FREE else unnamed.joint
            called = pattern.format(body=links[body], number=j - int(model.body_jntadr[body]))
            joints[j] = unused_name(called, taken)
    return links, joints


def pose_of(position: Any, wxyz: Any) -> SE3:
    """A pose from MuJoCo's position and quaternion.

    Args:
        position: Position, shape (3,) [m].
        wxyz: Quaternion w, x, y, z, shape (4,) [-].

    Returns:
        The pose.
    """
    return SE3.from_quat_xyzw(np.roll(np.asarray(wxyz), -1), np.asarray(position))


def unused_name(name: str, taken: set[str]) -> str:
    """A name that is not taken yet.

    Args:
        name: The name that is wanted; a number is appended where it is taken.
        taken: The names that are taken; the new one is added.

    Returns:
        The name.
    """
    candidate, number = name, 2
    while candidate in taken:
        candidate, number = f"{name}_{number}", number + 1
    taken.add(candidate)
    return candidate
