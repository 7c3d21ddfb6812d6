"""The robots that come with the face: models.Panda(), models.DH.Puma560(), models.ETS.Planar2() ..."""

from __future__ import annotations

import importlib
from typing import Any

_ROOMS = ("DH", "ETS", "URDF")


def __getattr__(name: str) -> Any:
    if name in _ROOMS:
        return importlib.import_module(f"roboticstoolbox.models.{name}")
    if name.startswith("_"):
        raise AttributeError(name)
    urdf = importlib.import_module("roboticstoolbox.models.URDF")
    return getattr(urdf, name)
