"""Robots by elementary transforms."""

from __future__ import annotations

from typing import Any

from roboticstoolbox._common.module_aliases import add_module_aliases
from roboticstoolbox._ets.elementary_transform import ET2
from roboticstoolbox._ets.ets import ETS2
from roboticstoolbox._links.link import Link2
from roboticstoolbox._robots.planar_robot import Robot2
from roboticstoolbox._robots.robot import Robot
from roboticstoolbox.models._from_tables import table, tree_class

__all__ = list(dict.fromkeys(["Planar2", *table("ets")]))

for _each in table("ets"):
    globals()[_each] = tree_class("ets", _each, Robot, __name__)


class Planar2(Robot2):
    """Two links of one metre in the plane."""

    def __init__(self) -> None:
        first = Link2(ETS2(ET2.R()), jindex=0, name="link0")
        second = Link2(ETS2([ET2.tx(1), ET2.R()]), jindex=1, name="link1", parent=first)
        super().__init__(
            [first, second, Link2(ETS2(ET2.tx(1)), name="ee", parent=second)],
            name="Planar2",
            comment="Planar 2D manipulator",
        )
        self.addconfiguration_attr("qz", [0, 0])
        self.addconfiguration_attr("qb", [0, 90], "deg")


add_module_aliases(__name__, (name for name in __all__ if name != "URDFRobot"))


def __getattr__(name: str) -> Any:
    if name.startswith("__"):
        raise AttributeError(name)
    raise AttributeError(f"There is no models.ETS.{name}; there are {', '.join(__all__)}.")
