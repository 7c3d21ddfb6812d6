"""Elementary transforms where scripts import them from: roboticstoolbox.ets and its modules, one for a class."""

from __future__ import annotations

from typing import Any

from roboticstoolbox._common.module_aliases import furnish, offered

__all__ = ["ET", "ET2", "ETS", "ETS2"]
furnish(__name__, __all__)


def __getattr__(name: str) -> Any:
    return offered(__name__, name)
