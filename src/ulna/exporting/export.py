"""The function `ulna.export`."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from ulna.checks.values import short_repr
from ulna.compiler import KernelBase, element_of
from ulna.errors import DtypeError, InputError, UnknownName
from ulna.exporting.folder import atomic_folder, check_replaceable
from ulna.exporting.record import Export, ExportTarget, Option
from ulna.exporting.selection import (
    Entry,
    check_identifier,
    entries,
    identifier,
    options_of,
    records,
)
from ulna.exporting.targets import TARGETS
from ulna.robot import Robot


def export(
    robot: Robot | None,
    kernels: Any,
    to: str,
    path: str | os.PathLike[str],
    *,
    name: str | None = None,
    dtype: Any = None,
    **options: Any,
) -> Path:
    """Writes compiled functions of a robot, or your own, as files for other programs and processors.

    All files are made in a temporary folder, which takes the place of `path` at the end: an error leaves nothing
    half-written. A folder that is there is replaced if nothing but an earlier export is in it.

    Args:
        robot: The robot; None where all functions are your own and need none.
        kernels: What to export: names of quantities ("fk", "jacobian", ..., as for `robot.kernel`) and "ik",
            functions made by `ulna.compile` or `robot.kernel`, pairs ("fk", {"frame": "panda_hand"}); one, a list, or
            a dictionary with the names that the functions are to have.
        to: The target: `ulna.exporting.TARGETS` is the table; docs/export.md describes them.
        path: The folder to write.
        name: What names of functions and files begin with; None for the robot's name.
        dtype: The type to compute in, float64 or float32; None for that of the compiled functions among `kernels`, or
            float64.
        **options: Options of the target, and of quantities (`frame`, `reference`, ...), which hold for all of
            `kernels` that know them; those of "ik" are `frame`, `mask`, `joints` and `seed`.

    Returns:
        The folder.

    Raises:
        UnknownName: For an unknown kernel, target, option, frame or reference; names the nearest.
        InputError: If `path` holds other files, or an argument means nothing.
        DtypeError: If `dtype` is neither float64 nor float32, or that of the compiled functions differs.
        OSError: If the folder cannot be written.

    Example:
        >>> robot = ulna.load("panda")
        >>> folder = ulna.export(robot, ["fk", "jacobian"], to="c", path="panda_c")
        >>> sorted(file.name for file in folder.glob("panda_*.c"))
        ['panda_fk.c', 'panda_jacobian.c', 'panda_model.c']
    """
    if robot is not None and not isinstance(robot, Robot):
        raise InputError(
            f"`robot` is {short_repr(robot)}; expected a Robot, such as ulna.load(...) returns, or None."
        )
    target = target_of(to)
    chosen = entries(kernels)
    model = None if robot is None else robot.model
    of_target, of_kernels = split_options(target, chosen, options)
    if name is None:
        name = identifier(robot.name) if robot is not None else identifier(chosen[0][0])
    check_identifier("`name`", name, 'name="panda"')
    place = _checked_path(path)
    element = _dtype(dtype, chosen)
    functions, searches = records(model, chosen, of_kernels, element.name)
    made = Export(name, model, functions, searches, element, MappingProxyType(of_target))
    manifest = {"target": to, "name": name, "kernels": [entry[0] for entry in chosen]}
    with atomic_folder(place, manifest) as folder:
        target.write(made, folder)
    return place


def target_of(name: Any) -> ExportTarget:
    """The target of a name.

    Args:
        name: The name.

    Returns:
        Its record.

    Raises:
        UnknownName: If there is no such target.
    """
    if not isinstance(name, str) or name not in TARGETS:
        raise UnknownName("export target", name, TARGETS)
    return TARGETS[name]


def split_options(
    target: ExportTarget, chosen: Sequence[Entry], options: Mapping[str, Any]
) -> tuple[dict[str, Any], dict[str, Any]]:
    """The options of the target, with default values, and those of the quantities.

    Args:
        target: The target.
        chosen: What is to be exported.
        options: All options that were given.

    Returns:
        Options of the target, and of quantities.

    Raises:
        UnknownName: If nothing knows an option.
        InputError: If an option of the target has a value that it cannot have.
    """
    known = dict.fromkeys(key for _, item, _ in chosen for key in options_of(item))
    of_target = {key: option.default for key, option in target.options.items()}
    of_kernels = {}
    for key, value in options.items():
        if key in target.options:
            of_target[key] = _checked_option(key, target.options[key], value)
        elif key in known:
            of_kernels[key] = value
        else:
            names = [*target.options, *known, "name", "dtype"]
            raise UnknownName(f"option of target {target.name!r} or of its kernels", key, names)
    return of_target, of_kernels


def _checked_option(key: str, option: Option, value: Any) -> Any:
    if option.choices and value not in option.choices:
        if isinstance(value, str):
            raise UnknownName(f"value of option {key!r}", value, [str(c) for c in option.choices])
        raise InputError(f"`{key}` is {short_repr(value)}; expected {option.text}.")
    if isinstance(option.default, bool) and not isinstance(value, bool | np.bool_):
        raise InputError(f"`{key}` is {short_repr(value)}; expected True or False: {option.text}.")
    return value


def _dtype(dtype: Any, chosen: Sequence[Entry]) -> np.dtype[Any]:
    """The type to compute in."""
    compiled = {str(item.dtype): name for name, item, _ in chosen if isinstance(item, KernelBase)}
    if dtype is not None:
        return element_of(dtype)
    if len(compiled) > 1:
        raise DtypeError(
            compiled["float32"], "float32", "one type for all functions", "Choose it: dtype=numpy.float64."
        )
    return element_of(next(iter(compiled), np.float64))


def _checked_path(path: Any) -> Path:
    try:
        place = Path(path)
    except TypeError:
        raise InputError(f"`path` is {short_repr(path)}; expected the path of a folder.") from None
    if not str(path).strip():
        raise InputError("`path` is empty; expected the path of a folder.")
    check_replaceable(Path(os.path.realpath(place)))
    return place


__all__ = ["export", "split_options", "target_of"]
