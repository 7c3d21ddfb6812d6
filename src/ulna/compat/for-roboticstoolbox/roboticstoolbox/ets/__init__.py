"""Elementary transforms where scripts import them from: roboticstoolbox.ets and its modules, one for a class."""

from __future__ import annotations

from typing import Any

from roboticstoolbox._common.module_aliases import add_module_aliases, public_name

__all__ = ["ET", "ET2", "ETS", "ETS2"]
add_module_aliases(__name__, __all__)


def __getattr__(name: str) -> Any:
    return public_name(__name__, name)
