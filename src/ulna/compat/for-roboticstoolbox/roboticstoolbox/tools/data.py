"""Data files, of the user or of the toolbox's package `rtb-data`, and the toolbox's settings."""

from __future__ import annotations

import importlib.util
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from roboticstoolbox._common.errors import UnknownKey
from ulna.errors import FormatError, MissingExtra

_PARAMETERS: dict[str, Any] = {"unicode": True}


def rtb_set_param(param: str, value: Any) -> None:
    """Stores a setting, on which nothing depends.

    Args:
        param: Name of the setting.
        value: Its value.
    """
    _PARAMETERS[param] = value


def rtb_get_param(param: str) -> Any:
    """The value of a setting.

    Raises:
        UnknownKey: It was not set.
    """
    if param not in _PARAMETERS:
        raise UnknownKey("setting", param, _PARAMETERS)
    return _PARAMETERS[param]


def rtb_path_to_datafile(*filename: Any, local: bool = True) -> Path:
    """The absolute path of a file of the user, or of the package `rtb-data`.

    Args:
        *filename: Parts of the path.
        local: Whether a file of the user comes first.

    Returns:
        The path.

    Raises:
        FormatError: It is in neither place.
    """
    name = Path(*filename)
    if local and name.expanduser().exists():
        return name.expanduser().resolve()
    spec = importlib.util.find_spec("rtbdata")
    folders = [] if spec is None else list(spec.submodule_search_locations or ())
    for folder in folders:
        if (Path(folder) / name).exists():
            return (Path(folder) / name).resolve()
    hint = "" if folders else " The toolbox's files come with the package `rtb-data`, which is not installed."
    raise FormatError(f"There is no data file {str(name)!r}.{hint}", file=str(name))


def rtb_load_data(filename: Any, handler: Callable[..., Any], **options: Any) -> Any:
    """Reads a data file of the package `rtb-data` by a function.

    Args:
        filename: Path of the file in the package.
        handler: Called as `handler(path, **options)`.
        **options: Passed to `handler`.

    Returns:
        What `handler` returned.
    """
    return handler(rtb_path_to_datafile(filename, local=False), **options)


def rtb_load_jsonfile(filename: Any) -> Any:
    """The contents of a JSON file of the package `rtb-data`."""
    return rtb_load_data(filename, lambda path: json.loads(Path(path).read_text(encoding="utf-8")))


def rtb_load_matfile(filename: Any) -> dict[str, Any]:
    """The variables in a MATLAB file of the package `rtb-data`; structures are dicts.

    Raises:
        MissingExtra: scipy is not installed.
    """
    try:
        from scipy.io import loadmat
    except ImportError:
        raise MissingExtra("scipy", "toolbox", "Reading .mat files") from None
    return rtb_load_data(filename, loadmat, simplify_cells=True)
