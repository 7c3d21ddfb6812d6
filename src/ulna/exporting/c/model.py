"""What controllers need of the robot beside its functions: sizes, limits, names of joints, named configurations."""

from __future__ import annotations

import re

import numpy as np

from ulna.exporting.c.expressions import number, wrapped
from ulna.exporting.c.header import comment, real_of
from ulna.exporting.record import Export
from ulna.model import Model
from ulna.typing import Floats

_LIMITS = {
    "lower_position": "NQ",
    "upper_position": "NQ",
    "velocity_limit": "NV",
    "effort_limit": "NV",
}
"""Arrays of a model by name, and their sizes."""


def constants(model: Model) -> dict[str, tuple[str, Floats]]:
    """The arrays of numbers, each with the name of its size.

    Args:
        model: The robot.

    Returns:
        Size and numbers by name.
    """
    made = {name: (size, getattr(model, name)) for name, size in _LIMITS.items()}
    for name, key in configuration_keys(model).items():
        made[key] = ("NQ", np.asarray(model.configurations[name]))
    return made


def configuration_keys(model: Model) -> dict[str, str]:
    """The names in C of the named configurations, by their names; equal ones have a number behind.

    Args:
        model: The robot.

    Returns:
        A different identifier for each.
    """
    plain = {name: f"configuration_{re.sub(r'[^A-Za-z0-9]+', '_', name)}" for name in model.configurations}
    keys = {name: key for name, key in plain.items() if key == f"configuration_{name}"}
    for name, key in plain.items():
        number, free = 2, key
        while name not in keys and free in keys.values():
            free, number = f"{key}_{number}", number + 1
        keys.setdefault(name, free)
    return {name: keys[name] for name in plain}


def declarations(export: Export, model: Model) -> str:
    """The part of the header that declares them.

    Args:
        export: The export.
        model: The robot.

    Returns:
        The text.
    """
    upper = export.name.upper()
    header = (
        "Sizes of configurations and velocities; limits of positions [rad or m], speeds [rad/s or m/s] and torques "
        "[N m or N], HUGE_VAL where there is none; names of the movable joints; named configurations [rad or m]."
    )
    heads = [f"{_head(export, key, size, x)}" for key, (size, x) in constants(model).items()]
    sizes = [f"#define {upper}_NQ {model.nq}", f"#define {upper}_NV {model.nv}"]
    lines = [*sizes, *(f"extern {head};" for head in (*heads, _names_head(export, model)))]
    return "\n".join([comment([header, *_renamed(model)]), *lines, ""])


def _renamed(model: Model) -> list[str]:
    """The configurations whose names in C are others, as lines of a comment."""
    renamed = {key: name for name, key in configuration_keys(model).items() if key != f"configuration_{name}"}
    return [f"  {key}  is the configuration {name!a}" for key, name in renamed.items()]


def source(export: Export, model: Model) -> str:
    """The source that defines them.

    Args:
        export: The export.
        model: The robot.

    Returns:
        The text.
    """
    name, real = export.name, real_of(export)
    lines = [comment([f"Constants of the robot {model.name}. Written by Ulna; do not edit."])]
    lines += ["#include <math.h>", "", f'#include "{name}.h"', ""]
    for key, (size, values) in constants(model).items():
        words = [f"{number(x, real)}," for x in values] or ["0,"]
        lines += [f"{_head(export, key, size, values)} = {{", *wrapped(words, "    "), "};", ""]
    quoted = [f'"{_escaped(joint)}",' for joint in model.joint_names] or ['"",']
    return "\n".join([*lines, f"{_names_head(export, model)} = {{", *wrapped(quoted, "    "), "};", ""])


def _head(export: Export, key: str, size: str, values: Floats) -> str:
    """The declaration of an array; C has no empty ones, so those of a robot without joints have one number."""
    count = f"{export.name.upper()}_{size}" if len(values) else "1"
    return f"const {real_of(export)} {export.name}_{key}[{count}]"


def _names_head(export: Export, model: Model) -> str:
    """The declaration of the joints' names: characters, because pointers would have to be written by a loader."""
    names = [name.encode() for name in model.joint_names] or [b""]
    return f"const char {export.name}_joint_names[{len(names)}][{max(map(len, names)) + 1}]"


def _escaped(text: str) -> str:
    """A text inside quotes: other than plain letters as octal numbers of their bytes."""
    return "".join(chr(b) if 32 <= b < 127 and chr(b) not in '"\\?' else f"\\{b:03o}" for b in text.encode())
