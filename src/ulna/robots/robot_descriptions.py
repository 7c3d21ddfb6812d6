"""The robots of the package robot_descriptions, by module name; it fetches them on first use."""

from __future__ import annotations

import importlib
import importlib.util
import pkgutil
from dataclasses import field
from functools import cache
from pathlib import Path
from typing import Any

from ulna.data_classes import dataclass
from ulna.errors import ModelError, UnknownName

_PACKAGE = "robot_descriptions"
_ENDING = "_description"


@dataclass(frozen=True)
class Checkout:
    """A robot description on disk.

    Attributes:
        file: its URDF, xacro or MJCF file.
        package_dirs: where its packages lie.
        xacro_args: values for the arguments of a xacro file.
    """

    file: Path
    package_dirs: tuple[Path, ...]
    xacro_args: dict[str, str] = field(default_factory=dict)


@cache
def names() -> tuple[str, ...]:
    """The names of the descriptions; () where the package is not installed."""
    try:
        spec = importlib.util.find_spec(_PACKAGE)
    except (ImportError, ValueError):
        spec = None
    if spec is None or not spec.submodule_search_locations:
        return ()
    modules = (m.name for m in pkgutil.iter_modules(spec.submodule_search_locations))
    return tuple(sorted(m for m in modules if m.endswith(_ENDING) and not m.startswith("_")))


def module_name(name: str) -> str | None:
    """The module that `name` ("panda_description", or "panda" for short) means, or None."""
    for candidate in (name, name + _ENDING):
        if candidate in names():
            return candidate
    return None


def fetch(name: str) -> Checkout:
    """The description on disk; the package downloads it when it is not there yet.

    Raises:
        UnknownName: there is no such description.
        ModelError: the package is not installed, could not download it, or has no file for it that can be read.
    """
    if not names():
        raise ModelError(
            f"The robot {name!r} needs the package {_PACKAGE!r}. Install it with: pip install {_PACKAGE}"
        )
    module = module_name(name)
    if module is None:
        raise UnknownName("description of robot_descriptions", name, names())
    try:
        description: Any = importlib.import_module(f"{_PACKAGE}.{module}")
    except Exception as error:  # whatever git, the network or the file system come up with
        lines = str(error).strip().splitlines() or [type(error).__name__]
        raise ModelError(
            f"robot_descriptions could not provide {module!r}: {lines[-1].strip()} "
            "It downloads a robot on first use; look at the network, or load the robot from a file."
        ) from error
    files = (getattr(description, kind, None) for kind in ("URDF_PATH", "XACRO_PATH", "MJCF_PATH"))
    file = next((file for file in files if file is not None), None)
    if file is None:
        raise ModelError(f"{module!r} of robot_descriptions has neither a URDF, a xacro nor an MJCF file.")
    folders = [
        Path(getattr(description, attribute))
        for attribute in ("PACKAGE_PATH", "REPOSITORY_PATH")
        if hasattr(description, attribute)
    ]
    folders += [folder.parent for folder in folders]
    return Checkout(Path(file), tuple(folders), dict(getattr(description, "XACRO_ARGS", {}) or {}))
