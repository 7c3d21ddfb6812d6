"""Arms by Denavit and Hartenberg's parameters."""

from __future__ import annotations

from typing import Any

from roboticstoolbox._common.module_aliases import add_module_aliases
from roboticstoolbox._ik.puma_branches import PumaBranches
from roboticstoolbox.models._from_tables import dh_class, table
from roboticstoolbox.models._two_link import TwoLink

__all__ = list(table("dh"))

for _each in __all__:
    if _each == "TwoLink":
        continue
    globals()[_each] = dh_class(_each, __name__, *((PumaBranches,) if _each == "Puma560" else ()))

TwoLink.__module__ = __name__

add_module_aliases(__name__, (name for name in __all__ if name != "URDFRobot"))


def __getattr__(name: str) -> Any:
    if name.startswith("__"):
        raise AttributeError(name)
    raise AttributeError(f"There is no models.DH.{name}; there are {', '.join(__all__)}.")
