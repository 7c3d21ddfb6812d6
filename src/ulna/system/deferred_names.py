"""Names of a package whose files are imported when a name is first used."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable, Mapping
from typing import Any

from ulna.errors import UnknownAttribute


def deferred_names(package: str, files: Mapping[str, str]) -> Callable[[str], Any]:
    """The `__getattr__` of a package that imports each public name from its file.

    Args:
        package: The name of the package.
        files: The file of each public name, relative to the package.

    Returns:
        The function; it keeps in the package what it has found, and raises `UnknownAttribute`, which names the closest
        of these names.
    """

    def __getattr__(name: str) -> Any:
        if name not in files:
            if name.startswith("_"):  # asked for by Python, never by a user
                raise AttributeError(f"module {package!r} has no attribute {name!r}")
            raise UnknownAttribute(f"module {package}", name, files)
        value = getattr(importlib.import_module(f"{package}.{files[name]}"), name)
        setattr(sys.modules[package], name, value)
        return value

    return __getattr__
